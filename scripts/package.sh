# scripts/check package: Debian packages as a user gets them. Sourced by scripts/check.
# It makes them by cpack, asks lintian, installs them in a Debian 12 root made by debootstrap, lets an ordinary
# user work with them (package_use.sh), and purges them. It needs root, for mounts and chroot, and 4 GB.
. scripts/fresh.sh

new_root=$fresh/package-root
package_build=$root/build/package

make_packages() {
	rm -f "$package_build"/*.deb
	(cd "$package_build" && cpack)
}

ask_lintian() {
	lintian --allow-root --tag-display-limit 0 --fail-on error,warning "$package_build"/*.deb
}

make_package_root() {
	make_root && mkdir -p "$new_root/root/gazecast" "$new_root/packages" &&
		cp "$package_build"/*.deb "$new_root/packages" &&
		cp -a scripts "$new_root/root/gazecast" &&
		mkdir -p "$new_root/root/gazecast/tests" && cp -a tests/python "$new_root/root/gazecast/tests"
}

check_package() {
	install_packages build demo package
	make_base_once package
	count_one configure package build/package || true
	count_one build build/package && count_one run_step package-cpack make_packages || {
		finish
		return
	}
	count_one run_step package-lintian ask_lintian || true
	run_step package-root make_package_root || die "the new root cannot be made; see $logs/package-root.log"
	count_one run_step package-use in_root "bash scripts/package_use.sh" || true
	grep -h '^package: ' "$logs/package-use.log" || true
	stage_times+=("package $((SECONDS - started)) s,")
	finish
}
