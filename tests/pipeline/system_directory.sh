#!/bin/bash
# usage: system_directory.sh GAZED GAZECTL
# If root starts the daemon for a user of its own, it serves the members of that user's group in
# /run/gazecast, and nobody else. Runs in a mount namespace with its own /run; skipped if that is not
# allowed.
set -u
gazed=$1 gazectl=$2
if [ "${3:-}" != inside ]; then
	command -v setpriv >/dev/null && [ "$(id -u)" = 0 ] && unshare -m true 2>/dev/null ||
		{ echo "needs root and a mount namespace"; exit 77; }
	exec unshare -m "$0" "$gazed" "$gazectl" inside
fi
fail() {
	echo "FAILED: $*"
	cat /run/said
	exit 1
}
mount -t tmpfs -o mode=755 tmpfs /run || exit 77
# The users of this test may not reach the build folder, as below /root.
cp "$gazed" "$gazectl" /run/
gazed=/run/gazed gazectl=/run/gazectl
mkdir -m 777 /run/recordings /run/session
trap 'kill $(jobs -p) 2>/dev/null; wait' EXIT
unset GAZECAST_RUNTIME_DIR XDG_CONFIG_HOME
# root's own session must not matter once the daemon is another user
export XDG_RUNTIME_DIR=/run/session HOME=/run
"$gazed" --config /dev/null --driver sim --tcp off --daemon.user nobody \
	--recording.directory /run/recordings 2>/run/said &
daemon=$!
user=$(id -u nobody) group=$(id -g nobody)

# as GROUP COMMAND...: an ordinary user with a session of its own, in which no daemon runs.
as() {
	local group=$1
	shift
	setpriv --reuid 54321 --regid "$group" --clear-groups --no-new-privs "$@"
}
for ((i = 0; i < 10 * ${GZ_TEST_PATIENCE_S:-60}; i++)); do
	as "$group" "$gazectl" status >/run/status 2>&1 && grep -q "sim, running" /run/status && break
	kill -0 $daemon 2>/dev/null || fail "the daemon has ended"
	sleep 0.1
done
grep -q "sim, running" /run/status || fail "a member of the group cannot read: $(cat /run/status)"
[ "$(stat -c '%a %u %g' /run/gazecast)" = "750 $user $group" ] || fail "$(stat /run/gazecast)"
for name in stream latest control inlet; do
	[ "$(stat -c '%a %u %g' /run/gazecast/$name)" = "660 $user $group" ] || fail "$(stat /run/gazecast/$name)"
done
as 54321 "$gazectl" status >/run/status 2>&1 && fail "somebody else can read"
[ ! -e /run/session/gazecast ] || fail "root's session was used"
kill -TERM $daemon
wait $daemon || fail "exit status $?"
# a directory that others may enter is closed by root, who owns it, and refused by anyone else
chmod 755 /run/gazecast
setpriv --reuid "$user" --regid "$group" --clear-groups env -u XDG_RUNTIME_DIR "$gazed" --config /dev/null \
	--tcp off 2>/run/said && fail "an open directory was taken"
grep -q "is open to others (mode 755): run chmod 750" /run/said || fail "no remedy"
echo "a group reads, others do not"
