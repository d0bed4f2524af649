#!/bin/sh
# usage: check.sh BUILD SOURCE CC CXX PUBLISHER
# Installs the library into an empty directory, builds a program against it like a user, with
# pkg-config only, and lets it read from a publisher.
set -eu
build=$1 source=$2 cc=$3 cxx=$4 publisher=$5
command -v pkg-config >/dev/null || { echo "no pkg-config"; exit 77; }
place=$(mktemp -d /tmp/gazecast-install-XXXXXX)
publisher_id=
trap '[ -z "$publisher_id" ] || kill "$publisher_id"; rm -rf "$place"' EXIT
fail() { echo "$*" >&2; exit 1; }

# Once under a prefix that differs from the configured one, once staged like a package.
for component in library development; do
	cmake --install "$build" --component $component --prefix "$place/prefix" >/dev/null
	DESTDIR=$place/stage cmake --install "$build" --component $component --prefix /usr >/dev/null
done
[ -n "$(find "$place/stage/usr" -name 'libgazecast.so.0')" ] || fail "DESTDIR: no libgazecast.so.0"

PKG_CONFIG_PATH=$(dirname "$(find "$place/prefix" -name gazecast.pc)")
export PKG_CONFIG_PATH
flags=$(pkg-config --cflags --libs gazecast)
program=$source/tests/client/install/latest.c
# shellcheck disable=SC2086
"$cc" -std=c17 -Wall -Wextra -Werror -o "$place/reader" "$program" $flags
# shellcheck disable=SC2086
"$cxx" -x c++ -std=c++17 -Wall -Wextra -Werror -fsyntax-only "$program" $flags

# The library exports all documented functions and no others.
library=$(find "$place/prefix" -name libgazecast.so)
nm -D --defined-only "$library" | sed -n 's/.* T //p' | sort >"$place/shown"
sed -n 's/^[ \t]*\(gz_[a-z0-9_]*\);.*/\1/p' "$source/client/gazecast.map" | sort >"$place/listed"
cat "$(dirname "$(find "$place/prefix" -name gazecast.h)")"/*/*.h |
	sed -n 's/^[a-z].*[ *]\(gz_[a-z0-9_]*\)(.*/\1/p' | grep -v '^gz_log_sink$' | sort -u >"$place/declared"
diff "$place/listed" "$place/shown" || fail "gazecast.map lists (<) other than the library shows (>)"
# Functions defined in a header need no library.
for name in $(cat "$place/declared"); do
	grep -qx "$name" "$place/shown" || grep -rq "^static inline.*$name(" "$place/prefix/include" ||
		fail "$name is declared in an installed header and not in the library: list it in client/gazecast.map"
done

# The renderer's library alone has what its header declares.
cmake --install "$build" --component render --prefix "$place/prefix" >/dev/null
# shellcheck disable=SC2046
"$cc" -std=c17 -Wall -Wextra -Werror -o "$place/draw" "$source/tests/client/install/draw.c" \
	$(pkg-config --cflags --libs gazecast-render)
drawn=$(LD_LIBRARY_PATH=$(dirname "$(find "$place/prefix" -name libgazecast-render.so)") "$place/draw")
[ "$drawn" = "64 x 48, 3072 rays" ] || fail "the program drew \"$drawn\""
header=$(find "$place/prefix" -name render.h)
sed -n 's/^[a-z].*[ *]\(gz_renderer_[a-z_]*\)(.*/\1/p' "$header" | sort >"$place/declared"
nm -D --defined-only "$(find "$place/prefix" -name libgazecast-render.so)" | sed -n 's/.* T //p' |
	grep -v '^gz_result_text$' | sort >"$place/shown"
diff "$place/declared" "$place/shown" || fail "render.h declares (<) other than the library shows (>)"

"$publisher" "ipc://$place/latest" &
publisher_id=$!
LD_LIBRARY_PATH=$(dirname "$library") timeout "${GZ_TEST_PATIENCE_S:-60}" "$place/reader" "ipc://$place/latest" >"$place/out"
cat "$place/out"
grep -q '^0.250 0.750, [0-9.]* ms ago$' "$place/out" || fail "the program did not print the gaze"
