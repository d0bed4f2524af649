#!/bin/sh
# usage: systemd_unit.sh UNIT PROGRAM SYSUSERS USER-UNIT USER-SOCKET
# systemd understands the units without a warning, finds the sandbox of the system's tight, and makes its user.
set -eu
unit=$1 program=$2 sysusers=$3 user_unit=$4 user_socket=$5
command -v systemd-analyze >/dev/null || { echo "no systemd-analyze"; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# As installed, but with a program that is there.
sed "s#^ExecStart=.*#ExecStart=$program#" "$unit" >"$folder/gazed.service"
grep -q "^ExecStart=/.*/gazed\$" "$unit" || { echo "$unit starts no gazed"; exit 1; }
said=$(systemd-analyze verify --man=no "$folder/gazed.service" 2>&1) || { echo "$said"; exit 1; }
[ -z "$said" ] || { echo "$said"; exit 1; }
mkdir "$folder/user"
sed "s#^ExecStart=.*#ExecStart=$program#" "$user_unit" >"$folder/user/gazed.service"
cp "$user_socket" "$folder/user/gazed.socket"
said=$(XDG_RUNTIME_DIR=$folder systemd-analyze --user verify --man=no "$folder/user/gazed.socket" 2>&1) || { echo "$said"; exit 1; }
[ -z "$said" ] || { echo "$said"; exit 1; }
# Exposure in tenths: 2.0 of 10. What is left is the network, USB and the group's sockets.
systemd-analyze security --offline=true --threshold=20 --no-pager "$folder/gazed.service" \
	>"$folder/exposure" 2>&1 || { cat "$folder/exposure"; exit 1; }
tail -n 1 "$folder/exposure"
# The user of the unit is the one that is made.
user=$(sed -n 's/^User=//p' "$unit")
grep -q "^u $user " "$sysusers" || { echo "$sysusers makes no $user"; exit 1; }
command -v systemd-sysusers >/dev/null || exit 0
mkdir -p "$folder/root/etc"
systemd-sysusers --root="$folder/root" "$sysusers" 2>/dev/null
grep -q "^$user:" "$folder/root/etc/passwd" || { echo "no user $user was made"; exit 1; }
