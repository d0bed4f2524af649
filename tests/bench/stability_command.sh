#!/bin/bash
# gazebench stability: a table that holds, one that does not, and what is refused.
set -euo pipefail
gazebench=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

fail() {
	echo "$1" >&2
	cat "$folder"/said "$folder"/errors >&2
	exit 1
}

# expect STATUS ARGUMENT...: what gazebench stability ends with; its output in said and errors.
expect() {
	local wanted=$1 status=0
	shift
	"$gazebench" stability "$@" >said 2>errors || status=$?
	[ "$status" -eq "$wanted" ] || fail "gazebench stability $*: $status, not $wanted"
}

cat >small.scene <<-END
	[volume]
	procedural = shells
	dims = 24 24 24
	[transfer]
	file = small.tf
	[camera]
	eye = 0.8 1.3 0.35
	[foveation]
	table = coarse.table
END
printf '0 0 0 0 0\n0.5 1 0.5 0 0.2\n1 1 1 1 0.5\n' >small.tf
printf 'unit px\n0 4 1\n' >coarse.table
small="small.scene --backend cpu --size 160x120"

expect 0 $small --methods standard,acuity --rows brightness,saccade,tremble
[ "$(grep -c ' holds .*(at most' said)" -eq 6 ] || fail "six rows should hold"
grep -q '^6 held, 0 failed' said || fail "no sum"
grep -Eq '^cpu +standard  acuity$' said && grep -Eq '^  tremble +holds +holds$' said ||
	fail "no table of what held"
[ ! -e small-stability ] || fail "a folder of pictures without failures"

expect 4 $small --methods table --rows saccade
grep -q ' fails ' said && grep -q 'worst at [0-9]' said || fail "no failure, or no worst pixel"
[ -s small-stability/cpu-saccade-table.png ] || fail "no picture beside the failure"
grep -Eq '^  saccade +FAILS$' said || fail "the table does not show the failure"
expect 4 $small --methods table --rows saccade --out elsewhere --json
[ -s elsewhere/cpu-saccade-table.png ] || fail "no picture in --out"
/usr/bin/python3 - <<-'END' || fail "not the JSON that was promised"
	import json
	rows = json.load(open("said"))
	assert len(rows) == 1 and rows[0]["verdict"] == "fails", rows
	assert rows[0]["picture"] == "elsewhere/cpu-saccade-table.png", rows
	assert rows[0]["numbers"][0]["value"] > rows[0]["numbers"][0]["bound"], rows
	assert len(rows[0]["worst"]["got"]) == 3, rows
END

expect 4 $small --methods standard,table:step_rule=none --rows saccade,gaze --json
/usr/bin/python3 - <<-'END' || fail "variants are not rows of their own"
	import json
	rows = [(r["row"], r["method"], r["verdict"]) for r in json.load(open("said"))]
	assert rows == [("gaze", "standard", "holds"), ("gaze", "table:step_rule=none", "fails"),
	                ("saccade", "standard", "holds"), ("saccade", "table:step_rule=none", "fails")], rows
END

expect 2 $small --rows nothing
grep -q 'there are brightness, thin' errors || fail "no list of rows"
expect 2 $small --methods fast
grep -q 'acuity' errors || fail "no list of methods"
expect 2 $small --methods acuity:no_such_option=1
expect 2 small.scene --backend quantum
expect 2
expect 2 small.scene --size 16385x10
grep -q 16384 errors || fail "the limit of the size is not named"
expect 1 missing.scene
touch file
expect 1 $small --methods table --rows saccade --out file/folder
grep -q -- --out errors || fail "no remedy for a folder that cannot be made"
