#!/bin/bash
# kernel.sh FOLDER: puts the distribution's kernel and the modules that the guest needs into FOLDER,
# once. Any user can run it: the package is downloaded and unpacked, never installed. Exits 77 with
# one line that says why if it cannot be downloaded.
set -euo pipefail
folder=$1
# The package that depends on the newest kernel of the distribution.
meta=linux-image-amd64
# The modules that guest/init loads; their dependencies are added.
wanted='dummy_hcd|usb_f_hid|usb_f_fs|gadgetfs|usbhid|hid-generic'

skip() {
	echo "usb tests are skipped: $*"
	exit 77
}

# reason: the error of apt, in one line.
reason() {
	grep -m 1 -E '^(W|E): Failed|^E:' "$folder/apt.log" || tail -n 1 "$folder/apt.log"
}

# The package lists of this system may be missing or old: the second attempt uses its own lists.
private=(-o "Dir::State::Lists=$folder/apt/lists" -o "Dir::Cache=$folder/apt/cache"
	-o APT::Sandbox::User= -o Debug::NoLocking=1)

# download APT-OPTION...: the kernel's package into FOLDER.
download() {
	local package
	package=$(apt-cache "$@" depends --important "$meta" 2>"$folder/apt.log" |
		sed -n 's/^ *Depends: //p' | grep -m 1 '^linux-image-') || return 1
	(cd "$folder" && apt-get "$@" download "$package") >"$folder/apt.log" 2>&1
}

[ ! -f "$folder/vmlinuz" ] || exit 0
for tool in apt-get dpkg-deb busybox; do
	command -v $tool >/dev/null || skip "no $tool here"
done
rm -rf "$folder"
mkdir -p "$folder/apt/lists/partial" "$folder/apt/cache/archives/partial"
if ! download -o APT::Sandbox::User=; then
	apt-get "${private[@]}" --error-on=any update >"$folder/apt.log" 2>&1 && download "${private[@]}" ||
		skip "the kernel behind $meta cannot be downloaded: $(reason)"
fi
dpkg-deb --fsys-tarfile "$folder"/linux-image-*.deb | tar -x -C "$folder" --wildcards \
	'./boot/vmlinuz-*' './lib/modules/*/modules.*' './lib/modules/*/kernel/drivers/usb/*' \
	'./lib/modules/*/kernel/drivers/hid/*' './lib/modules/*/kernel/fs/configfs/*'
version=$(basename "$folder"/lib/modules/*)
busybox depmod -b "$folder" "$version"
(
	cd "$folder/lib/modules/$version"
	grep -E "/($wanted)\.ko:" modules.dep | tr -d : | tr ' ' '\n' | sort -u >needed
	find kernel -name '*.ko' | grep -vxFf needed | xargs rm
)
busybox depmod -b "$folder" "$version"
rm -rf "$folder"/linux-image-*.deb "$folder/apt" "$folder/apt.log"
mv "$folder/boot/vmlinuz-$version" "$folder/vmlinuz"
echo "linux $version"
