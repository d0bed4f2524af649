#!/bin/bash
# usage: two_machines.sh GAZED GAZECTL
# docs/security.md, step by step, on two machines that are network namespaces: keys, refusals, a
# cable that is pulled. Skipped if namespaces are not allowed.
set -u
gazed=$1 gazectl=$2
name=gz$$
place=$(mktemp -d)
clean_up() {
	local left
	left=$(jobs -p)
	[ -z "$left" ] || kill $left 2>/dev/null
	wait
	ip netns del "$name-d" 2>/dev/null
	ip netns del "$name-c" 2>/dev/null
	rm -rf "$place"
}
fail() {
	echo "FAILED: $*"
	cat "$place/said" 2>/dev/null
	exit 1
}
command -v ip >/dev/null && ip netns add "$name-d" 2>/dev/null || { echo "no namespaces"; rm -rf "$place"; exit 77; }
trap clean_up EXIT
ip netns add "$name-c" && ip link add "${name}d" netns "$name-d" type veth peer name "${name}c" netns "$name-c" &&
	ip -n "$name-d" addr add 10.77.0.1/24 dev "${name}d" && ip -n "$name-c" addr add 10.77.0.2/24 dev "${name}c" &&
	ip -n "$name-d" link set "${name}d" up && ip -n "$name-c" link set "${name}c" up || { echo "no network"; exit 77; }

# on MACHINE COMMAND...: each machine has its own home directory.
on() {
	local machine=$1
	shift
	mkdir -p -m 700 "$place/$machine/run"
	ip netns exec "$name-$machine" env -u XDG_CONFIG_HOME -u XDG_DATA_HOME -u GAZECAST_RUNTIME_DIR \
		HOME="$place/$machine" XDG_RUNTIME_DIR="$place/$machine/run" "$@"
}
status() {
	on c "$gazectl" status --endpoint tcp://10.77.0.1:50020 >"$place/status" 2>&1
}
# wait_until COMMAND...: at most 20 s.
wait_until() {
	for ((i = 0; i < 10 * ${GZ_TEST_PATIENCE_S:-60}; i++)); do
		"$@" && return
		sleep 0.1
	done
	fail "never: $*"
}

umask 077
# 1. the daemon's machine
on d "$gazectl" keygen --server >"$place/server" || fail keygen --server
cat >"$place/d/.config/gazecast/gazed.conf" <<CONF
[network]
tcp = curve
address = 10.77.0.1
stream_port = 50021
latest_port = 50022
inlet_port = 50023
CONF
# 2. the client's machine, with the line that was printed and the address for the host's name
on c "$gazectl" keygen --client anna@desk >"$place/client" || fail keygen --client
key=$(grep -E '^[^ ]+ [^ ]{40}$' "$place/server" | cut -d ' ' -f 2)
[ "$key" = "$(cat "$place/d/.config/gazecast/server_key.pub")" ] || fail "printed key $key"
echo "10.77.0.1 $key" >"$place/c/.config/gazecast/known_servers"
# 3. start; nobody is let in yet
ip netns exec "$name-d" env -u XDG_CONFIG_HOME -u XDG_DATA_HOME -u GAZECAST_RUNTIME_DIR HOME="$place/d" \
	XDG_RUNTIME_DIR="$place/d/run" "$gazed" 2>"$place/said" &
wait_until on d "$gazectl" status >/dev/null 2>&1
status && fail "an unknown key was let in"
grep -q "refuses our key; add this line" "$place/status" || fail "$(cat "$place/status")"
grep -q "10.77.0.2 is refused: its key is not in" "$place/said" || fail "the refusal is not logged"
# 4. authorise, while it runs
grep -E ' anna@desk$' "$place/client" >"$place/d/.config/gazecast/authorized_keys"
status || fail "the key is not taken: $(cat "$place/status")"
grep -q "10.77.0.2 is let in with the key of \"anna@desk\"" "$place/said" || fail "not logged"
on c "$gazectl" watch --count 5 --endpoint tcp://10.77.0.1:50020 >"$place/watch" || fail watch
[ "$(wc -l <"$place/watch")" = 5 ] || fail "$(cat "$place/watch")"
on c "$gazectl" record --endpoint tcp://10.77.0.1:50020 remote >/dev/null || fail record
on c "$gazectl" stop --endpoint tcp://10.77.0.1:50020 >/dev/null || fail stop
# no socket is bound that was not asked for
[ "$(on d ss -Hltn | grep -cv 10.77.0.1:5002)" = 0 ] || fail "$(on d ss -Hltn)"
rm "$place/watch"
# 5. the cable is pulled and put back
ip netns exec "$name-c" env -u XDG_CONFIG_HOME -u GAZECAST_RUNTIME_DIR HOME="$place/c" "$gazectl" watch \
	--endpoint tcp://10.77.0.1:50020 >"$place/watch" 2>"$place/watch-said" &
watch=$!
wait_until test -s "$place/watch"
ip -n "$name-c" link set "${name}c" down
wait_until grep -q "tcp://10.77.0.1:50021: connection lost" "$place/watch-said"
on d "$gazectl" status >/dev/null || fail "the daemon suffers from a cable"
ip -n "$name-c" link set "${name}c" up
wait_until grep -q "connected again" "$place/watch-said"
kill $watch
wait $watch || fail "watch does not end well"
echo "two machines: all steps done"
