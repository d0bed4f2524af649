#!/bin/bash
# boot.sh SCRATCH KERNEL RULES TEST... -- PROGRAM...: boots the guest by pure emulation and runs each
# TEST in it, one after another. SCRATCH/console.log then has what they said and how they ended, which
# result.sh tells. Exits with 77 if the guest cannot be made here, and with 1 if it did not finish.
# RULES is the folder with the udev rules, PROGRAM what the tests start.
set -euo pipefail
scratch=$1
kernel=$2
rules=$3
shift 3
here=$(cd "$(dirname "$0")" && pwd)
mkdir -p "$scratch"
console=$scratch/console.log
names=
programs=()
while [ "$1" != -- ]; do
	names=$names${names:+,}$(basename "$1")
	programs+=("$1")
	shift
done
shift
programs+=("$@")

skip() {
	echo "usb tests are skipped: $*" | tee "$console"
	exit 77
}

for tool in qemu-system-x86_64 busybox cpio strip udevadm; do
	command -v $tool >/dev/null || skip "no $tool here"
done
[ -f "$kernel/vmlinuz" ] || skip "no kernel; the test usb.kernel says why"
"$here/initramfs.sh" "$kernel" "$scratch/root" "$rules" "${programs[@]}" >"$scratch/initramfs"
rm -rf "$scratch/root"

# The first serial line belongs to the tests, the second one to the kernel. The kernel must not compare
# its timers at the start: on a busy machine the emulated ones stand still for too long. Its guards
# against processors that leak would be emulated as well.
timeout -k 5 1200 qemu-system-x86_64 -accel tcg,thread=multi -cpu max -smp 2 -m 512 \
	-nodefaults -display none -nic none -no-reboot \
	-kernel "$kernel/vmlinuz" -initrd "$scratch/initramfs" \
	-append "console=ttyS1 no_timer_check mitigations=off rdinit=/init panic=-1 tests=$names" \
	-serial stdio -serial "file:$scratch/kernel.log" </dev/null 2>&1 | tee "$console" || true
rm -f "$scratch/initramfs"

if ! grep -qx 'guest: finished' "$console"; then
	echo "the guest did not finish; last lines of the kernel, from $scratch/kernel.log:"
	tail -n 20 "$scratch/kernel.log"
	exit 1
fi
