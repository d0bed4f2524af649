#!/bin/bash
# initramfs.sh KERNEL STAGE RULES PROGRAM...: writes the whole file system of the guest to standard
# output. KERNEL is the folder of kernel.sh, STAGE a scratch folder, RULES the folder with the udev rules
# of the project. Programs go to /usr/bin, with the shared libraries that they need.
set -euo pipefail
kernel=$1
stage=$2
rules=$3
shift 3
here=$(cd "$(dirname "$0")" && pwd)

rm -rf "$stage"
mkdir -p "$stage"/{bin,dev,etc,lib/modules,lib/systemd,lib/udev/rules.d,etc/udev/rules.d,usr/share/gazecast/udev,proc,root,run,sys,tmp,usr/bin}
cp "$here/guest/init" "$stage/init"
cp "$here/guest/passwd" "$here/guest/group" "$stage/etc/"
cp "$(command -v busybox)" "$stage/bin/busybox"
cp -r "$kernel"/lib/modules/* "$stage/lib/modules/"
udevadm=$(command -v udevadm)
cp "$udevadm" "$stage/usr/bin/udevadm"
ln -s /usr/bin/udevadm "$stage/bin/udevadm"
ln -s /usr/bin/udevadm "$stage/lib/systemd/systemd-udevd"
cp /lib/udev/rules.d/50-udev-default.rules "$stage/lib/udev/rules.d/"
find "$rules" -name '*.rules' -exec cp {} "$stage/usr/share/gazecast/udev/" \;

for program in "$@"; do
	cp "$program" "$stage/usr/bin/"
done
{ ldd "$(command -v busybox)" "$udevadm" "$@" || true; } 2>/dev/null | grep -oE '/[^ ]+\.so[^ ]*' | grep -v ':$' | sort -u |
	while read -r library; do
		mkdir -p "$stage$(dirname "$library")"
		cp -L "$library" "$stage$library"
	done
find "$stage/usr/bin" -type f -exec strip --strip-debug {} + 2>/dev/null || true
cd "$stage"
find . | cpio --quiet -o -H newc -R 0:0
