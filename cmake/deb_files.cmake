# What cpack does to the files of the packages before it packs them; it reads this file among its settings.

# Manual pages and changelogs are compressed, as Debian's policy wants.
file(GLOB_RECURSE plain "${CPACK_TEMPORARY_DIRECTORY}/*/usr/share/man/man*/*.[1-9]"
	"${CPACK_TEMPORARY_DIRECTORY}/*/usr/share/doc/*/changelog")
foreach(file IN LISTS plain)
	execute_process(COMMAND gzip -9nf "${file}" COMMAND_ERROR_IS_FATAL ANY)
endforeach()

# What shared libraries need. cpack can ask dpkg-shlibdeps itself, but then it also adds scripts that call
# ldconfig, where the policy wants a trigger.
foreach(component IN LISTS GAZECAST_LIBRARY_COMPONENTS)
	string(TOUPPER "${component}" upper)
	file(GLOB libraries "${CPACK_TEMPORARY_DIRECTORY}/${component}/usr/lib/*/lib*.so.*.*")
	set(folder "${CPACK_TOPLEVEL_DIRECTORY}/${component}")
	file(WRITE "${folder}/debian/control" "Source: gazecast\n\nPackage: ${CPACK_DEBIAN_${upper}_PACKAGE_NAME}\nArchitecture: any\n")
	execute_process(COMMAND dpkg-shlibdeps -O ${libraries} WORKING_DIRECTORY "${folder}"
		OUTPUT_VARIABLE needs OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
	string(REGEX REPLACE "^shlibs:Depends=" "" CPACK_DEBIAN_${upper}_PACKAGE_DEPENDS "${needs}")
endforeach()
