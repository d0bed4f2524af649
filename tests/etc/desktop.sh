#!/bin/sh
# usage: desktop.sh ETC BUILD
# What a desktop reads of us is understood without a complaint. Validators that are not there are left out.
set -eu
etc=$1 build=$2
ran=0
if command -v desktop-file-validate >/dev/null; then
	said=$(desktop-file-validate "$etc"/desktop/*.desktop 2>&1) || { echo "$said"; exit 1; }
	[ -z "$said" ] || { echo "$said"; exit 1; }
	ran=1
fi
if command -v appstreamcli >/dev/null; then
	appstreamcli validate --no-net "$build"/etc/*.metainfo.xml || exit 1
	ran=1
fi
if command -v update-mime-database >/dev/null; then
	folder=$(mktemp -d)
	trap 'rm -rf "$folder"' EXIT
	mkdir -p "$folder/mime/packages"
	cp "$etc"/desktop/*.mime.xml "$folder/mime/packages"
	said=$(XDG_DATA_DIRS=$folder update-mime-database "$folder/mime" 2>&1) || { echo "$said"; exit 1; }
	[ -z "$said" ] || { echo "$said"; exit 1; }
	for ending in scene tf gzl; do
		grep -q ":\*\.$ending\$" "$folder/mime/globs2" || { echo "no type for .$ending"; exit 1; }
	done
	ran=1
fi
# Every type that an entry names has an icon or is another's.
for name in $(sed -n 's/.*<icon name="\([^"]*\)".*/\1/p' "$etc"/desktop/*.mime.xml) \
	$(sed -n 's/^Icon=//p' "$etc"/desktop/*.desktop); do
	[ -f "$etc/desktop/$name.svg" ] || { echo "no icon $name.svg"; exit 1; }
done
[ $ran -eq 1 ] || { echo "no validator"; exit 77; }
