# scripts/check fresh: what a newcomer sees on a new machine. Sourced by scripts/check.
# It makes a Debian 12 root by debootstrap in build/fresh/root, puts a clone of the committed state there,
# runs scripts/demo --headless and scripts/check in it, and lists what was missing. It needs root, for
# mounts and chroot, and 10 GB. The base system and downloaded packages are kept for the next time.

fresh=$root/build/fresh
new_root=$fresh/root
suite=bookworm

# debian_sites: "SITE RELEASE" of each Debian archive of the suite that this machine uses.
debian_sites() {
	apt-get indextargets --format '$(ORIGIN) $(SITE) $(RELEASE) $(COMPONENT)' \
		'Created-By: Packages' 2>/dev/null |
		awk -v suite="$suite" '$1 == "Debian" && $3 ~ "^" suite "(-updates|-security)?$" &&
			$4 == "main" { print $2, $3 }' | sort -u
}

# Without such an archive here, as on Ubuntu, Debian's own address.
find_sites() {
	sites=$(debian_sites)
	grep -q " $suite\$" <<<"$sites" || sites="http://deb.debian.org/debian $suite"
	mirror=$(awk -v suite="$suite" '$2 == suite { print $1; exit }' <<<"$sites")
}

make_base() {
	local folder=$fresh/base
	rm -rf --one-file-system "$folder"
	debootstrap --variant=minbase "$suite" "$folder" "$mirror" &&
		tar -C "$folder" -cf "$fresh/base.tar.part" . &&
		mv "$fresh/base.tar.part" "$fresh/base.tar" || return
	rm -rf --one-file-system "$folder"
}

# The new machine reaches the network as this one does: same mirror, proxy and name server.
make_root() {
	rm -rf --one-file-system "$new_root"
	mkdir -p "$new_root" "$fresh/archives/partial"
	tar -C "$new_root" -xf "$fresh/base.tar" || return
	sed 's/^/deb /; s/$/ main/' <<<"$sites" >"$new_root/etc/apt/sources.list"
	apt-config dump | grep -E '^Acquire::(http|https|Check-[A-Za-z-]+)(::[A-Za-z]+)* "' \
		>"$new_root/etc/apt/apt.conf.d/99host" || true
	cp -L /etc/resolv.conf "$new_root/etc/resolv.conf"
	printf '127.0.0.1 localhost\n127.0.1.1 %s\n' "$(uname -n)" >"$new_root/etc/hosts"
}

# A root with a clone of the committed state.
make_clone_root() {
	make_root && git clone -q --no-hardlinks "$root" "$new_root/root/gazecast"
}

# make_base_once: the base system, kept for the next time.
make_base_once() {
	[ "$(id -u)" -eq 0 ] || die "this needs root, for chroot and mounts: sudo scripts/check $1"
	install_packages fresh
	mkdir -p "$fresh"
	find_sites
	[ -s "$fresh/base.tar" ] || run_step fresh-base make_base ||
		die "debootstrap failed; see $logs/fresh-base.log"
}

# in_root COMMAND: run COMMAND by bash in the clone. Its mounts are in a namespace of their own: they and
# every process end with it.
in_root() {
	local data=${GAZECAST_DATA:-}
	unshare --mount --pid --fork --kill-child --propagation private \
		bash -c '
		root=$1 archives=$2 data=$3 command=$4
		try() { "$@" || echo "fresh: not permitted here: $*"; }
		# A root that is a mount point permits tests to make mount namespaces of their own.
		try mount --bind "$root" "$root"
		try mount -t proc proc "$root/proc"
		try mount --rbind /sys "$root/sys"
		try mount --rbind /dev "$root/dev"
		try mount -t tmpfs -o mode=1777 tmpfs "$root/dev/shm"
		try mount --bind "$archives" "$root/var/cache/apt/archives"
		variables=()
		if [ -n "$data" ]; then
			mkdir -p "$root/data"
			mount --bind "$data" "$root/data" && mount -o remount,bind,ro "$root/data" &&
				variables+=(GAZECAST_DATA=/data)
		fi
		for name in http_proxy https_proxy no_proxy; do
			[ -z "${!name:-}" ] || variables+=("$name=${!name}")
		done
		exec chroot "$root" env -i HOME=/root LANG=C.UTF-8 PATH=/usr/sbin:/usr/bin:/sbin:/bin \
			"${variables[@]}" bash -c "cd /root/gazecast && $command"' \
		in_root "$new_root" "$fresh/archives" "$data" "$1"
}

# skipped_tests FILE: "TEST: reason" of each skipped test in a JUnit file.
skipped_tests() {
	awk 'BEGIN { RS = "<testcase " } /<skipped/ {
		name = $0; sub(/^name="/, "", name); sub(/".*/, "", name)
		text = $0; sub(/.*<system-out>/, "", text); sub(/<\/system-out>.*/, "", text)
		sub(/[ \n]+$/, "", text); sub(/.*\n/, "", text)
		print "  " name ": " text }' "$1"
}

# What programs, loaders and configuration say of programs, libraries and modules that they lack.
lacks='command not found|: not found$|cannot open shared object file|cannot be preloaded'
lacks+='|No module named|No package .* found|Could NOT find|is required to|CMake Error'

tell_missing() {
	local clone=$new_root/root/gazecast junit list
	junit=$clone/build/check/junit.xml
	list=$(cat "$clone"/build/logs/*.log "$logs"/fresh-*.log 2>/dev/null | tr -d '\r' |
		grep -aE "$lacks" | grep -v '^-- ' | sort -u | head -n 40 || true)
	[ -z "$list" ] || printf 'missing programs, libraries or modules:\n%s\n' "$list"
	missing=$list
	list=""
	[ ! -s "$junit" ] || list=$(skipped_tests "$junit")
	[ -z "$list" ] || printf 'skipped tests:\n%s\n' "$list"
	[ -n "$missing$list" ] || echo "missing: nothing"
}

check_fresh() {
	make_base_once fresh
	run_step fresh-root make_clone_root || die "the new root cannot be made; see $logs/fresh-root.log"
	count_one run_step fresh-demo in_root "scripts/demo --headless" || true
	count_one run_step fresh-check in_root scripts/check || true
	grep -hE '(packages: installing|stages:|[0-9]+ passed)' "$logs/fresh-demo.log" \
		"$logs/fresh-check.log" | cut -c 1-200 || true
	tell_missing
	stage_times+=("fresh $((SECONDS - started)) s,")
	finish
}
