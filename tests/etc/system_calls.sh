#!/bin/bash
# usage: system_calls.sh UNIT GAZED GAZECTL
# All system calls that the daemon makes, serving a client with keys and recording, are among those
# that the unit's filter lets through. Skipped where strace or systemd's lists of calls are not.
set -eu
unit=$1 gazed=$2 gazectl=$3
command -v strace >/dev/null && command -v systemd-analyze >/dev/null || { echo "no strace or systemd-analyze"; exit 77; }
folder=$(mktemp -d)
daemon=
trap '[ -z "$daemon" ] || kill "$daemon" 2>/dev/null; wait; rm -rf "$folder"' EXIT
export GAZECAST_RUNTIME_DIR=$folder/run XDG_CONFIG_HOME=$folder/config
mkdir -m 700 "$folder/run" "$folder/config"
strace -qq -o /dev/null true 2>/dev/null || { echo "strace may not trace"; exit 77; }

# expand NAME...: system calls, groups of them resolved.
expand() {
	local name line
	for name in "$@"; do
		case $name in
		@*) systemd-analyze syscall-filter --no-pager "$name" | sed 's/#.*//' | tail -n +2 |
			while read -r line; do [ -z "$line" ] || expand "$line"; done ;;
		*) echo "$name" ;;
		esac
	done
}
# As systemd reads them: in order, those behind "~" taken out.
: >"$folder/allowed"
while read -r line; do
	# shellcheck disable=SC2086 # words
	case $line in
	"~"*) expand ${line#"~"} | sort -u >"$folder/words" && comm -23 "$folder/allowed" "$folder/words" >"$folder/next" ;;
	*) { cat "$folder/allowed" && expand $line; } | sort -u >"$folder/next" ;;
	esac
	mv "$folder/next" "$folder/allowed"
done < <(sed -n 's/^SystemCallFilter=//p' "$unit")
[ "$(wc -l <"$folder/allowed")" -gt 100 ] || { echo "the filter lets nothing through"; exit 1; }

"$gazectl" keygen --server >/dev/null
"$gazectl" keygen --client test >/dev/null
cp "$XDG_CONFIG_HOME/gazecast/client_key.pub" "$XDG_CONFIG_HOME/gazecast/authorized_keys"
port=$((20000 + $$ % 10000))
strace -f -qq -o "$folder/trace" "$gazed" --config /dev/null --driver sim --tcp curve \
	--control tcp://127.0.0.1:$port --recording.directory "$folder" 2>"$folder/said" &
daemon=$!
for ((i = 0; i < 200; i++)); do
	"$gazectl" status >/dev/null 2>&1 && break
	sleep 0.1
done
"$gazectl" record traced >/dev/null
"$gazectl" status --endpoint tcp://127.0.0.1:$port --server-key "$(cat "$XDG_CONFIG_HOME/gazecast/server_key.pub")" >/dev/null
"$gazectl" stop >/dev/null
read -r pid _ <"$folder/trace"
kill "$pid"
wait "$daemon" || { cat "$folder/said"; exit 1; }
daemon=
# strace names the architecture's own calls; execve is systemd's, before the filter.
sed -E 's/^[0-9]+ +//; s/\(.*//' "$folder/trace" | grep -xE '[a-z0-9_]+' | sort -u >"$folder/used"
[ "$(wc -l <"$folder/used")" -gt 30 ] || { echo "too few calls were seen"; exit 1; }
comm -23 "$folder/used" "$folder/allowed" >"$folder/refused"
[ ! -s "$folder/refused" ] || { echo "the unit would refuse: $(tr '\n' ' ' <"$folder/refused")"; exit 1; }
echo "$(wc -l <"$folder/used") system calls, all of them allowed"
