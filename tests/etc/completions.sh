#!/bin/bash
# usage: completions.sh FOLDER
# bash, zsh and fish complete commands, options and choices by the files that the build makes. A shell that is
# not there is left out.
set -eu
folder=$1
fail() { echo "$*" >&2; exit 1; }

# complete_bash WORD...: what bash offers for the last word.
complete_bash() {
	bash -c '. "$1/$2.bash"; shift; program=$1
		COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); "_$program"; echo "${COMPREPLY[*]}"' _ "$folder" "$@"
}
expect() {
	local wanted=$1 got=$2
	[ "$got" = "$wanted" ] || fail "expected \"$wanted\", got \"$got\""
}
expect convert "$(complete_bash gazectl con)"
expect --table.time-unit "$(complete_bash gazectl convert --table.ti)"
expect "ms" "$(complete_bash gazectl convert --table.time-unit = m)"
expect "off loopback curve" "$(complete_bash gazed --tcp "")"
expect "mdc mdc3" "$(complete_bash gazeview --method m)"
expect "suggest" "$(complete_bash gazebench su)"
expect "$folder/gazed.bash" "$(complete_bash gazeview "$folder/gazed.ba")"

if command -v zsh >/dev/null; then
	for file in "$folder"/*.zsh; do
		zsh -n "$file" || fail "zsh does not read $file"
		grep -q "^#compdef $(basename "$file" .zsh)\$" "$file" || fail "$file names no program"
	done
fi
if command -v fish >/dev/null; then
	HOME=$(mktemp -d)
	export HOME
	trap 'rm -rf "$HOME"' EXIT
	offered=$(fish --no-config -c "source $folder/gazectl.fish; complete -C 'gazectl conv'; complete -C 'gazectl convert --table.time-unit m'")
	expect $'convert\tconvert recordings from and to gaze logs\nms\tfor --from table' "$offered"
fi
