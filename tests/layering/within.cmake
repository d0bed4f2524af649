# Fails if a folder of render/ includes what it must not know of.
#   cmake -DROOT=folder-with-render -P within.cmake
cmake_minimum_required(VERSION 3.25)
# Each folder may use itself, render/ itself and these:
set(volume_may "")
set(plan_may "")
set(attention_may "")
set(cpu_may volume plan)
set(gl_may volume plan)

set(includes 0)
set(faults 0)
foreach(folder volume plan attention cpu gl)
	file(GLOB sources RELATIVE "${ROOT}" "${ROOT}/render/${folder}/*.[ch]"
		"${ROOT}/render/${folder}/*.cpp" "${ROOT}/render/${folder}/*.hpp")
	foreach(source IN LISTS sources)
		file(STRINGS "${ROOT}/${source}" found
			REGEX "^[ \t]*#[ \t]*include[ \t]*\"render/[a-z_]+/")
		foreach(line IN LISTS found)
			string(REGEX REPLACE "^[^\"]*\"render/([a-z_]+)/.*" "\\1" used "${line}")
			math(EXPR includes "${includes} + 1")
			if(NOT used STREQUAL folder AND NOT used IN_LIST ${folder}_may)
				message("${source}: uses render/${used}/, which render/${folder}/ must not "
					"know of; move what both need to render/ itself")
				math(EXPR faults "${faults} + 1")
			endif()
		endforeach()
	endforeach()
endforeach()

if(faults GREATER 0)
	message(FATAL_ERROR "${faults} of ${includes} includes point sideways")
elseif(includes EQUAL 0)
	message(FATAL_ERROR "no include found under ${ROOT}/render; this test checks nothing")
endif()
message("${includes} includes within render/, none sideways")
