#!/bin/sh
# usage: manual.sh PAGES MAP
# The manual pages are well-formed mdoc, refer to pages that exist, and gazecast(3) describes
# every function of the library.
set -eu
pages=$1 map=$2
command -v mandoc >/dev/null || { echo "no mandoc"; exit 77; }
status=0
mandoc -Tlint -Wwarning "$pages"/*.[135] || status=1
for reference in $(sed -n 's/^\.Xr \(g[a-z.]*\) \([0-9]\).*/\1.\2/p; s/^.* Xr \(g[a-z.]*\) \([0-9]\).*/\1.\2/p' "$pages"/*.[135] | sort -u); do
	[ -f "$pages/$reference" ] || { echo "there is no $reference"; status=1; }
done
for name in $(grep -oE 'gz_(client|stream|control|gaze_age)_[a-z_]+' "$map"); do
	grep -q "^\.Nm $name\b" "$pages/gazecast.3" || { echo "gazecast(3) leaves out $name"; status=1; }
	grep -qE "^\.F[no] $name\b" "$pages/gazecast.3" || { echo "gazecast(3) does not declare $name"; status=1; }
done
exit $status
