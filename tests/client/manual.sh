#!/bin/sh
# usage: manual.sh PAGES MAP RENDER-MAP
# The manual pages are well-formed mdoc, refer to pages that exist, and gazecast(3) and gazecast-render(3)
# describe every function of the libraries.
set -eu
pages=$1 map=$2 render_map=$3
command -v mandoc >/dev/null || { echo "no mandoc"; exit 77; }
status=0
# Of the notes on style, those left out are of lines of the source, which nobody reads as they are, of pages that mandoc looks
# for among those installed, and of the brackets of sections of a file.
notes=$(mandoc -Tlint -Wstyle "$pages"/*.[135] |
	grep -v 'STYLE: \(input text line longer\|referenced manual not found\|trailing delimiter: Ss \[\)\|outdated mandoc.db') || true
[ -z "$notes" ] || { echo "$notes"; status=1; }
for reference in $(sed -n 's/^\.Xr \(g[a-z.]*\) \([0-9]\).*/\1.\2/p; s/^.* Xr \(g[a-z.]*\) \([0-9]\).*/\1.\2/p' "$pages"/*.[135] | sort -u); do
	[ -f "$pages/$reference" ] || { echo "there is no $reference"; status=1; }
done
# describes PAGE NAME...: the page has each function.
describes() {
	page=$1
	shift
	for name in "$@"; do
		grep -q "^\.Nm $name\b" "$pages/$page" || { echo "$page leaves out $name"; status=1; }
		grep -qE "^\.F[no] $name\b" "$pages/$page" || { echo "$page does not declare $name"; status=1; }
	done
}
# shellcheck disable=SC2046 # names
describes gazecast.3 $(grep -oE 'gz_(client|stream|control|gaze_age)_[a-z_]+' "$map")
# shellcheck disable=SC2046
describes gazecast-render.3 $(grep -oE 'gz_renderer_[a-z_]+' "$render_map")
exit $status
