#!/bin/bash
# result.sh SCRATCH TEST: tells what TEST said in the guest that boot.sh has run, and exits as it did.
set -euo pipefail
console=$1/console.log
test=$2

if grep '^usb tests are skipped: ' "$console"; then
	exit 77
fi
sed -n "/^guest: runs $test\$/,/^guest: $test ended with /p" "$console"
status=$(sed -n "s/^guest: $test ended with //p" "$console")
if [ "$status" != 0 ]; then
	echo "last lines of the kernel, from $1/kernel.log:"
	tail -n 20 "$1/kernel.log"
	exit 1
fi
