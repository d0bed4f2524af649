#!/bin/bash
# boot.sh SCRATCH KERNEL RULES TEST PROGRAM...: boots the guest by pure emulation and runs TEST in it.
# Exits with the status of TEST, or with 77 if the guest cannot be made here. RULES is the folder with
# the udev rules, PROGRAM what the test starts.
set -euo pipefail
scratch=$1
kernel=$2
rules=$3
shift 3
here=$(cd "$(dirname "$0")" && pwd)
name=$(basename "$1")

for tool in qemu-system-x86_64 busybox cpio strip udevadm; do
	if ! command -v $tool >/dev/null; then
		echo "usb tests are skipped: no $tool here"
		exit 77
	fi
done
if [ ! -f "$kernel/vmlinuz" ]; then
	echo "usb tests are skipped: no kernel; the test usb.kernel says why"
	exit 77
fi
mkdir -p "$scratch"
console=$scratch/console.log
"$here/initramfs.sh" "$kernel" "$scratch/root" "$rules" "$@" >"$scratch/initramfs"
rm -rf "$scratch/root"

# The first serial line belongs to the test, the second one to the kernel. The kernel must not compare
# its timers at the start: on a busy machine the emulated ones stand still for too long.
timeout -k 5 200 qemu-system-x86_64 -accel tcg,thread=multi -cpu max -smp 2 -m 512 \
	-nodefaults -display none -nic none -no-reboot \
	-kernel "$kernel/vmlinuz" -initrd "$scratch/initramfs" \
	-append "console=ttyS1 no_timer_check rdinit=/init panic=-1 test=/usr/bin/$name" \
	-serial stdio -serial "file:$scratch/kernel.log" </dev/null 2>&1 | tee "$console" || true
rm -f "$scratch/initramfs"

status=$(sed -n 's/^guest: exit status //p' "$console" | tail -n 1)
if [ "$status" != 0 ]; then
	[ -n "$status" ] || echo "the guest did not finish"
	echo "last lines of the kernel, from $scratch/kernel.log:"
	tail -n 20 "$scratch/kernel.log"
	exit 1
fi
