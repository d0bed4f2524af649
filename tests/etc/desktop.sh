#!/bin/sh
# usage: desktop.sh ETC BUILD GAZEVIEW
# What a desktop reads of us is understood without a complaint, and its command makes thumbnails. Validators that are
# not there are left out.
set -eu
etc=$1 build=$2 gazeview=$3
ran=0
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
if command -v desktop-file-validate >/dev/null; then
	said=$(desktop-file-validate "$etc"/desktop/*.desktop 2>&1) || { echo "$said"; exit 1; }
	[ -z "$said" ] || { echo "$said"; exit 1; }
	ran=1
fi
if command -v appstreamcli >/dev/null; then
	appstreamcli validate --no-net "$build"/etc/*.metainfo.xml || exit 1
	# With a page, and without one.
	sed 's,@GAZECAST_HOMEPAGE@,https://example.org,' "$etc"/desktop/*.pages.xml.in >"$folder/pages"
	for pages in "$folder/pages" /dev/null; do
		sed -e "/@pages@/r $pages" -e '/@pages@/d' -e 's/@PROJECT_VERSION@/0.1.0/;s/@[A-Za-z_]*@/2024-01-01/' \
			"$etc"/desktop/*.metainfo.xml.in >"$folder/org.gazecast.gazeview.metainfo.xml"
		appstreamcli validate --no-net "$folder/org.gazecast.gazeview.metainfo.xml" || exit 1
	done
	ran=1
fi
if command -v update-mime-database >/dev/null; then
	mkdir -p "$folder/mime/packages"
	cp "$etc"/desktop/*.mime.xml "$folder/mime/packages"
	said=$(XDG_DATA_DIRS=$folder update-mime-database "$folder/mime" 2>&1) || { echo "$said"; exit 1; }
	[ -z "$said" ] || { echo "$said"; exit 1; }
	for ending in scene tf gzl; do
		grep -q ":\*\.$ending\$" "$folder/mime/globs2" || { echo "no type for .$ending"; exit 1; }
	done
	ran=1
fi
# The command of the entry, its %i a scene, %o the thumbnail and %s its size.
PATH=$(dirname "$gazeview"):$PATH
export PATH
"$(sed -n 's/^TryExec=//p' "$etc"/desktop/gazeview.thumbnailer)" --version >"$folder/version"
$(sed -n 's/^Exec=//p' "$etc"/desktop/gazeview.thumbnailer |
	sed "s,%i,$etc/scenes/shells.scene,;s,%o,$folder/thumbnail.png,;s,%s,128,g") >"$folder/said" ||
	{ echo "no thumbnail"; exit 1; }
# A PNG of 128 x 128 pixels, some kilobytes long, since it shows something.
[ "$(od -An -tx1 -N24 "$folder/thumbnail.png" | tr -d ' \n')" = \
	89504e470d0a1a0a0000000d494844520000008000000080 ] || { echo "no PNG of 128 x 128"; exit 1; }
[ "$(wc -c <"$folder/thumbnail.png")" -gt 4000 ] || { echo "an empty thumbnail"; exit 1; }
# Every type that an entry names has an icon or is another's.
for name in $(sed -n 's/.*<icon name="\([^"]*\)".*/\1/p' "$etc"/desktop/*.mime.xml) \
	$(sed -n 's/^Icon=//p' "$etc"/desktop/*.desktop); do
	[ -f "$etc/desktop/$name.svg" ] || { echo "no icon $name.svg"; exit 1; }
done
[ $ran -eq 1 ] || { echo "no validator"; exit 77; }
