#!/bin/bash
# Runs as root in the new root of scripts/check package: installs the packages in /packages, lets an ordinary
# user work with them, and purges them. Fails with a line that says what is wrong.
set -euo pipefail

export DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8
ours=()
for deb in /packages/*.deb; do
	ours+=("$(dpkg-deb -f "$deb" Package)")
done

note() { printf 'package: %s\n' "$*"; }
fail() {
	note "$*"
	exit 1
}

# field NAME: a field of all our packages, joined by commas, without our own packages.
field() {
	local deb
	for deb in /packages/*.deb; do
		dpkg-deb -f "$deb" "$1"
	done | tr ',' '\n' | sed 's/^ *//; /^$/d' |
		grep -vE "^($(IFS='|' && echo "${ours[*]}"))( |$)" | sort -u | paste -sd,
}

# Every file of the system, but for what a system's own bookkeeping changes.
list_files() {
	find / -xdev \( -path /proc -o -path /sys -o -path /dev -o -path /tmp -o -path /root -o -path /home \
		-o -path /packages -o -path /data -o -path /var/cache -o -path /var/log -o -path /var/lib/apt \
		-o -path /var/lib/dpkg \) -prune -o -printf '%p %M %u %g\n' | grep -v '^/run/' | sort
	getent passwd | cut -d: -f1 | sed 's/^/user /'
	getent group | cut -d: -f1 | sed 's/^/group /'
}

# as_visitor COMMAND...: as an ordinary user, in a home of their own.
as_visitor() {
	(cd /home/visitor && setpriv --reuid visitor --regid visitor --init-groups \
		env -i HOME=/home/visitor USER=visitor LC_ALL=C.UTF-8 PATH=/usr/bin:/bin "$@")
}

# What a scene that must open shows is a picture that is not of one colour.
open_scene() {
	local scene=/usr/share/gazecast/scenes/$1.scene
	as_visitor gazeview --headless --scene "$scene" --size 320x180 --out "$1.png" >"/tmp/$1.log" 2>&1 ||
		fail "$1.scene does not open: $(cat "/tmp/$1.log")"
	[ "$(stat -c %s "/home/visitor/$1.png")" -gt 2000 ] || fail "$1.scene shows nothing"
}

# A scene of data that one must fetch says where they are to be had.
ask_scene() {
	local scene=/usr/share/gazecast/scenes/$1.scene said
	! said=$(as_visitor gazeview --headless --scene "$scene" --out "${1##*/}.png" 2>&1) ||
		fail "$1.scene opens without its data"
	grep -q https:// <<<"$said" || fail "$1.scene does not say where its data are: $said"
}

apt-get update -q >/dev/null
useradd --create-home visitor
# What the packages need and recommend, and what the demo and this script call.
apt-get satisfy -q -y --no-install-recommends "$(field Depends), $(field Recommends)" \
	jq fonts-dejavu-core >/dev/null
list_files >/tmp/before

dpkg -i /packages/*.deb || fail "the packages do not install"
dpkg --verify "${ours[@]}" || fail "files differ from the packages' sums"
getent passwd gazecast >/dev/null || fail "there is no user gazecast"
note "installed ${ours[*]}"

cp -a /root/gazecast /home/visitor/gazecast
chown -R visitor: /home/visitor/gazecast
as_visitor gazecast/scripts/demo --installed --headless --size 640x360 --frames 8 ||
	fail "the demo fails"
[ -s /home/visitor/gazecast/demo-output/animation.mp4 ] || fail "the demo made no animation"
note "the demo ran: $(sed -n 's/^ *ratio *//p' /home/visitor/gazecast/demo-output/summary.txt)"

# All but macaque, which needs OpenGL.
for scene in atlas brain chameleon face head hippocampus shells splash supernova tracts; do
	open_scene $scene
done
note "scenes open without other data"
for scene in bone bonsai cranium dam_break engine frog skin skull tooth vessels water; do
	ask_scene fetched/$scene
done
words=$(bash -c '. /usr/share/bash-completion/completions/gazectl; COMP_WORDS=(gazectl con); COMP_CWORD=1
	_gazectl; echo "${COMPREPLY[*]}"')
[ "$words" = convert ] || fail "bash does not complete gazectl"

# As root first: what it compiles must go with the package.
python3 -c "import gazecast" || fail "Python does not find the module"
as_visitor python3 gazecast/tests/python/test_gazecast.py - /usr/share/gazecast/scenes ||
	fail "the Python module fails its tests"
note "the Python module passed its tests"

dpkg --purge "${ours[@]}" || fail "the packages cannot be purged"
list_files >/tmp/after
diff /tmp/before /tmp/after || fail "purging left or took something (above)"
note "purged without remains"
