# What scripts/check and scripts/demo share. Sourced by bash with `set -euo pipefail`.
# Sets root (the repository) and started (seconds), and changes into the repository.

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root"
started=$SECONDS
logs=$root/build/logs
mkdir -p "$logs"
jobs=$(nproc)

# say TEXT: one line of progress, with the time since the start.
say() {
	printf '[%3d s] %s\n' $((SECONDS - started)) "$*"
}

# die TEXT: one line that says what is wrong and what to do, and the end.
die() {
	printf 'error: %s\n' "$*" >&2
	exit 1
}

do_step=run_step # how steps are done
child=           # the process group of the step that runs now
lane=            # the process group of the steps beside it

# start_child COMMAND...: start it in a process group of its own, so that stop_children ends all of it.
start_child() {
	set -m
	"$@" &
	child=$!
	set +m
}

stop_children() {
	local group
	for group in $child $lane; do
		kill -TERM -- "-$group" 2>/dev/null || true
	done
	child=
	lane=
}

trap stop_children EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

# watch_step NAME SECONDS COMMAND...: while COMMAND succeeds, show the last line of build/logs/NAME.log
# now and then; NAME began at SECONDS.
watch_step() {
	local name=$1 log=$logs/$1.log every=10 begin=$2 last
	shift 2
	[ -t 1 ] && every=1
	local next=$((SECONDS + every))
	while "$@" 2>/dev/null; do
		sleep 0.2
		[ $SECONDS -ge $next ] || continue
		next=$((SECONDS + every))
		last=$(tail -n 1 "$log" 2>/dev/null | tr -d '\r' | cut -c 1-90)
		if [ -t 1 ]; then
			printf '\r\033[K[%3d s] %s: %s' $((SECONDS - started)) "$name" "$last"
		else
			say "$name: $last"
		fi
	done
	[ -t 1 ] && printf '\r\033[K'
	return 0
}

# end_step NAME STATUS TEXT: say that a step is done; on failure show the end of its log. Returns STATUS.
end_step() {
	local name=$1 log=$logs/$1.log status=$2
	if [ "$status" -eq 0 ]; then
		say "$name: done $3"
	else
		say "$name: failed (status $status) $3; the end of $log:"
		grep -nE '([Ee]rror|ERROR|warning|FAIL|Failed|\*\*\*)' "$log" | tail -n 20 || true
		tail -n 30 "$log"
	fi
	return "$status"
}

# run_step NAME COMMAND...: run a long command with its output in build/logs/NAME.log, showing the last
# line now and then; on failure show the end of the log and return the command's status.
run_step() {
	local name=$1 begin=$SECONDS status=0
	shift
	start_child "$@" >"$logs/$name.log" 2>&1 </dev/null
	watch_step "$name" $begin kill -0 "$child"
	wait "$child" || status=$?
	child=
	end_step "$name" $status "in $((SECONDS - begin)) s"
}

# package_list: the file of this distribution: ID-VERSION, else ID, else one of its family.
package_list() {
	local ID="" VERSION_ID="" ID_LIKE="" name
	[ -r /etc/os-release ] && . /etc/os-release
	for name in "$ID-$VERSION_ID" "$ID" $ID_LIKE debian; do
		if [ -r "scripts/packages/$name.txt" ]; then
			echo "scripts/packages/$name.txt"
			return
		fi
	done
}

# install_packages USE...: install what the list names for these uses and is missing.
install_packages() {
	local list missing=() package use as_root=()
	if ! command -v dpkg-query >/dev/null; then
		say "no dpkg here: install the equivalents of scripts/packages/debian.txt yourself"
		return
	fi
	list=$(package_list)
	while read -r package use; do
		case $package in '' | '#'*) continue ;; esac
		for wanted in "$@"; do
			[[ " ${use:-build} " == *" $wanted "* ]] || continue
			dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null |
				grep -qx installed || missing+=("$package")
			break
		done
	done <"$list"
	if [ ${#missing[@]} -eq 0 ]; then
		say "packages: all of $list are here"
		return
	fi
	if [ "$(id -u)" -ne 0 ]; then
		command -v sudo >/dev/null ||
			die "packages are missing (${missing[*]}); install them as root and run this again"
		as_root=(sudo)
		sudo -v || die "packages are missing (${missing[*]}); run this again as root"
	fi
	as_root+=(env DEBIAN_FRONTEND=noninteractive)
	# A new Ubuntu installs updates by itself for some minutes, and holds the lock meanwhile.
	local apt=(apt-get -o DPkg::Lock::Timeout=600)
	say "packages: installing ${#missing[@]} of $list: ${missing[*]}"
	run_step apt-update "${as_root[@]}" "${apt[@]}" update ||
		die "apt-get update failed; check the network and /etc/apt/sources.list"
	run_step apt-install "${as_root[@]}" "${apt[@]}" install -y --no-install-recommends \
		"${missing[@]}" ||
		die "apt-get install failed; see $logs/apt-install.log"
}

# configure PRESET FOLDER [-DNAME=VALUE...]: configure FOLDER by a preset.
configure() {
	local preset=$1 folder=$2
	shift 2
	"$do_step" "configure-$(basename "$folder")" cmake --preset "$preset" -B "$folder" "$@"
}

# build FOLDER [TARGET...]: build all or some targets.
build() {
	local folder=$1
	shift
	"$do_step" "build-$(basename "$folder")" cmake --build "$folder" -j "$jobs" \
		${1:+--target "$@"}
}
