# Debian packages by `cpack` in the folder of a build that was configured with --preset package. What is
# installed belongs to components, each of which is a package.
set(GAZECAST_MAINTAINER "Gazecast contributors <contributors@gazecast.invalid>" CACHE STRING
	"Who answers for the packages: name and address")
set(debian "${PROJECT_SOURCE_DIR}/etc/debian")

# gz_deb(COMPONENT PACKAGE SECTION SUMMARY TEXT): a component and its package. TEXT says more, in lines of
# at most 79 characters.
function(gz_deb component package section summary text)
	string(TOUPPER "${component}" upper)
	set_property(GLOBAL APPEND PROPERTY GZ_DEB_COMPONENTS ${component})
	set(CPACK_DEBIAN_${upper}_PACKAGE_NAME "${package}" PARENT_SCOPE)
	set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION "${section}" PARENT_SCOPE)
	set(CPACK_DEBIAN_${upper}_DESCRIPTION "${summary}\n${text}" PARENT_SCOPE)
	set(folder "${CMAKE_INSTALL_DATAROOTDIR}/doc/${package}")
	install(FILES "${debian}/copyright" DESTINATION "${folder}" COMPONENT ${component})
	install(FILES "${PROJECT_BINARY_DIR}/debian/changelog" DESTINATION "${folder}" COMPONENT ${component})
endfunction()

# gz_deb_symbols(TARGET PACKAGE MAP): the symbols and shlibs files of a shared library, from the list of what
# it exports. A symbol that a later version brings has that version behind it: "gz_name; /* since 0.2 */".
function(gz_deb_symbols target package map)
	get_target_property(soversion ${target} SOVERSION)
	get_target_property(name ${target} OUTPUT_NAME)
	if(NOT name)
		set(name ${target})
	endif()
	file(STRINGS "${map}" lines REGEX "^[ \t]*gz_[a-z0-9_]+;")
	set(symbols "")
	foreach(line IN LISTS lines)
		string(REGEX REPLACE "^[ \t]*(gz_[a-z0-9_]+);.*" "\\1" symbol "${line}")
		set(since 0.1.0)
		if(line MATCHES "since ([0-9.]+)")
			set(since ${CMAKE_MATCH_1})
		endif()
		list(APPEND symbols " ${symbol}@Base ${since}")
	endforeach()
	list(SORT symbols)
	list(JOIN symbols "\n" symbols)
	set(folder "${PROJECT_BINARY_DIR}/debian/${package}")
	file(WRITE "${folder}/symbols"
		"lib${name}.so.${soversion} ${package} #MINVER#\n* Build-Depends-Package: libgazecast-dev\n${symbols}\n")
	file(WRITE "${folder}/shlibs" "lib${name} ${soversion} ${package} (>= ${PROJECT_VERSION})\n")
	file(COPY "${debian}/triggers" DESTINATION "${folder}")
endfunction()

configure_file("${debian}/changelog.in" "${PROJECT_BINARY_DIR}/debian/changelog" @ONLY)
gz_deb(programs gazecast science "gaze daemon and foveated volume renderer"
"Gazecast makes a screen sharp only where someone looks. A daemon, gazed, reads
an eye tracker, filters its samples and publishes where the eye rests. A volume
renderer, gazeview, follows the gaze: it casts one ray for every pixel near the
gaze point, and fewer rays farther out, where the eye resolves less.
.
A simulated viewer, a recording and the mouse are trackers like any other, and
no graphics card is needed. Recordings of other eye trackers are converted by
gazectl, and gazebench measures what foveation saves and what it costs.")
gz_deb(library libgazecast${PROJECT_VERSION_MAJOR} libs "latest gaze of an eye tracker, for programs"
"Programs that draw what somebody looks at link this library: it gives the
latest gaze of the eye tracker that the daemon gazed reads, every message of
its stream, and requests to the daemon.")
gz_deb(development libgazecast-dev libdevel "latest gaze of an eye tracker, for programs: development files"
"Programs that draw what somebody looks at link the library libgazecast: it
gives the latest gaze of the eye tracker that the daemon gazed reads, every
message of its stream, and requests to the daemon. Those that show volumes
link libgazecast-render, whose pictures are sharp where somebody looks.
.
This package holds the headers, the pkg-config files and the manual page.")
gz_deb(render libgazecast-render${PROJECT_VERSION_MAJOR} libs "foveated volume renderer, for programs"
"Programs that show volumes link this library: a volume, a transfer function, a
camera and a gaze become a picture that is sharp where somebody looks. It runs
on the processor and on graphics cards (OpenGL 4.3), without a window.")
gz_deb(python python3-gazecast python "gaze, recordings and foveated rendering in Python"
"Gives programs in Python the latest gaze of an eye tracker and the stream of
the daemon gazed, recordings of many eye trackers as numpy record arrays with
labels and events, and pictures of volumes that are sharp where somebody looks.
.
The module calls the libraries of Gazecast and has no compiled code of its own.")
gz_deb_symbols(gazecast-render libgazecast-render${PROJECT_VERSION_MAJOR} "${PROJECT_SOURCE_DIR}/render/library/render.map")
gz_deb_symbols(gazecast libgazecast${PROJECT_VERSION_MAJOR} "${PROJECT_SOURCE_DIR}/client/gazecast.map")
set(debian_files "${PROJECT_BINARY_DIR}/debian")

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME gazecast)
set(CPACK_PACKAGE_CONTACT "${GAZECAST_MAINTAINER}")
set(CPACK_PACKAGE_VERSION "${PROJECT_VERSION}")
set(CPACK_PACKAGING_INSTALL_PREFIX "${CMAKE_INSTALL_PREFIX}")
set(CPACK_SET_DESTDIR ON) # some folders, such as /etc, are outside the prefix
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
get_property(CPACK_COMPONENTS_ALL GLOBAL PROPERTY GZ_DEB_COMPONENTS)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ
	GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_PRE_BUILD_SCRIPTS "${CMAKE_CURRENT_LIST_DIR}/deb_files.cmake")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
if(GAZECAST_HOMEPAGE)
	set(CPACK_DEBIAN_PACKAGE_HOMEPAGE "${GAZECAST_HOMEPAGE}")
endif()
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_SHLIBDEPS ON)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "") # each package has its own

set(CPACK_DEBIAN_PROGRAMS_PACKAGE_DEPENDS "systemd | systemd-standalone-sysusers | systemd-sysusers")
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_RECOMMENDS "mricron-data, invesalius-examples, ffmpeg, gnuplot-nox | gnuplot")
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_SUGGESTS "invesalius-examples")
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_CONTROL_EXTRA "${debian}/postinst;${debian}/prerm;${debian}/postrm;${debian}/conffiles")
set(CPACK_DEBIAN_PYTHON_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3 (>= 3.9), python3-numpy, libgazecast${PROJECT_VERSION_MAJOR} (>= ${PROJECT_VERSION}), libgazecast-render${PROJECT_VERSION_MAJOR} (>= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "gazecast")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-matplotlib, python3-nibabel")
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA "${debian}/python/postinst;${debian}/python/prerm")
set(CPACK_DEBIAN_RENDER_PACKAGE_CONTROL_EXTRA "${debian_files}/libgazecast-render${PROJECT_VERSION_MAJOR}/symbols"
	"${debian_files}/libgazecast-render${PROJECT_VERSION_MAJOR}/shlibs" "${debian_files}/libgazecast-render${PROJECT_VERSION_MAJOR}/triggers")
set(CPACK_DEBIAN_RENDER_PACKAGE_MULTIARCH same)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA "${debian_files}/libgazecast${PROJECT_VERSION_MAJOR}/symbols"
	"${debian_files}/libgazecast${PROJECT_VERSION_MAJOR}/shlibs" "${debian_files}/libgazecast${PROJECT_VERSION_MAJOR}/triggers")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_MULTIARCH same)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_MULTIARCH same)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libgazecast${PROJECT_VERSION_MAJOR} (= ${PROJECT_VERSION}), libgazecast-render${PROJECT_VERSION_MAJOR} (= ${PROJECT_VERSION})")
set(CPACK_PROJECT_CONFIG_FILE "${CMAKE_CURRENT_BINARY_DIR}/deb_settings.cmake")
file(WRITE "${CPACK_PROJECT_CONFIG_FILE}" "set(GAZECAST_LIBRARY_COMPONENTS library render)\n")
include(CPack)
