# Compiler settings and the three kinds of target: a folder's library, a program, a test.
set(CMAKE_C_STANDARD 17)
set(CMAKE_C_STANDARD_REQUIRED ON)
set(CMAKE_C_EXTENSIONS OFF)
set(CMAKE_CXX_STANDARD 17)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
	set(CMAKE_BUILD_TYPE RelWithDebInfo CACHE STRING "Build type" FORCE)
endif()

add_library(gz_settings INTERFACE)
target_compile_definitions(gz_settings INTERFACE _GNU_SOURCE)
target_compile_options(gz_settings INTERFACE -Wall -Wextra -Wshadow -Wpointer-arith -Wundef
	-Wwrite-strings -Wvla
	$<$<COMPILE_LANGUAGE:C>:-Wstrict-prototypes -Wmissing-prototypes>
	$<$<BOOL:${GAZECAST_WERROR}>:-Werror>
	# Results must not depend on how the compiler fuses or reorders floating point.
	-ffp-contract=off -fno-math-errno)
if(GAZECAST_SANITIZE)
	target_compile_options(gz_settings INTERFACE -fsanitize=${GAZECAST_SANITIZE}
		-fno-omit-frame-pointer -fno-sanitize-recover=all)
	target_link_options(gz_settings INTERFACE -fsanitize=${GAZECAST_SANITIZE})
endif()
if(GAZECAST_FUZZ)
	target_compile_options(gz_settings INTERFACE -fsanitize=fuzzer-no-link)
endif()

# gz_embed_texts(OUT PREFIX file...): each file as a C source that defines PREFIX<name>, an array of bytes with
# a final NUL; <name> is the file's without folder, its dots and dashes underscores. OUT lists the sources.
function(gz_embed_texts out prefix)
	set(sources "")
	foreach(file ${ARGN})
		get_filename_component(name "${file}" NAME)
		string(REGEX REPLACE "[.-]" "_" symbol "${prefix}${name}")
		add_custom_command(
			OUTPUT "${CMAKE_CURRENT_BINARY_DIR}/${name}.c"
			COMMAND "${CMAKE_COMMAND}" "-DIN=${CMAKE_CURRENT_SOURCE_DIR}/${file}"
				"-DOUT=${CMAKE_CURRENT_BINARY_DIR}/${name}.c" "-DNAME=${symbol}"
				-P "${PROJECT_SOURCE_DIR}/cmake/embed_text.cmake"
			DEPENDS "${file}" "${PROJECT_SOURCE_DIR}/cmake/embed_text.cmake"
			VERBATIM)
		list(APPEND sources "${CMAKE_CURRENT_BINARY_DIR}/${name}.c")
	endforeach()
	set(${out} "${sources}" PARENT_SCOPE)
endfunction()

# Note that this folder is the room NAME, which names the rooms in USES: what tests/layering checks the
# includes against.
function(gz_note_room name)
	set(uses ${ARGN})
	list(FILTER uses INCLUDE REGEX "^gz_")
	list(REMOVE_ITEM uses gz_nifti gz_gdcm)
	list(JOIN uses "," uses)
	if(uses STREQUAL "")
		set(uses -)
	endif()
	file(RELATIVE_PATH folder "${PROJECT_SOURCE_DIR}" "${CMAKE_CURRENT_SOURCE_DIR}")
	set_property(GLOBAL APPEND PROPERTY GZ_ROOMS "gz_${name} ${folder} ${uses}")
endfunction()

# gz_module(NAME SOURCES file... [USES target...] [PRIVATE_USES target...]): the library gz_NAME, a room.
# It uses only the rooms that it names. Headers are included by their path from the top:
# "protocol/gaze.h".
function(gz_module name)
	cmake_parse_arguments(M "" "" "SOURCES;USES;PRIVATE_USES" ${ARGN})
	gz_note_room(${name} ${M_USES} ${M_PRIVATE_USES})
	add_library(gz_${name} STATIC ${M_SOURCES})
	target_include_directories(gz_${name} PUBLIC "${PROJECT_SOURCE_DIR}")
	target_link_libraries(gz_${name} PUBLIC ${M_USES} PRIVATE ${M_PRIVATE_USES} gz_settings)
endfunction()

# gz_program(NAME [IN_LIBEXEC] SOURCES file... [USES target...]): an installed program. IN_LIBEXEC: it is
# not for users; other programs start it, and find it in the tree of a build as in an installation.
function(gz_program name)
	cmake_parse_arguments(P "IN_LIBEXEC" "" "SOURCES;USES" ${ARGN})
	gz_note_room(${name} ${P_USES})
	add_executable(${name} ${P_SOURCES})
	target_include_directories(${name} PRIVATE "${PROJECT_SOURCE_DIR}")
	target_link_libraries(${name} PRIVATE ${P_USES} gz_settings)
	target_compile_definitions(${name} PRIVATE GAZECAST_VERSION="${PROJECT_VERSION}")
	if(P_IN_LIBEXEC)
		set_target_properties(${name} PROPERTIES
			RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/${CMAKE_INSTALL_LIBEXECDIR}/gazecast")
		install(TARGETS ${name} RUNTIME DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/gazecast)
	else()
		install(TARGETS ${name} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
	endif()
endfunction()

# gz_shared_library(NAME SOURCES file... EXPORTS map COMPONENT name [USES target...]): libNAME.so, which exports the
# documented functions only: those of the version script EXPORTS. Each is marked as undefined, because a static
# library gives the linker only what is asked for. The link for developers belongs to another component.
function(gz_shared_library name)
	cmake_parse_arguments(L "" "EXPORTS;COMPONENT" "SOURCES;USES" ${ARGN})
	set(exports "${CMAKE_CURRENT_SOURCE_DIR}/${L_EXPORTS}")
	file(STRINGS "${exports}" exported_lines REGEX "^[ \t]*gz_[a-z0-9_]+;")
	set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${exports}")
	list(TRANSFORM exported_lines REPLACE "^[ \t]*(gz_[a-z0-9_]+);.*" "LINKER:--undefined=\\1")
	add_library(${name} SHARED ${L_SOURCES})
	target_include_directories(${name} PRIVATE "${PROJECT_SOURCE_DIR}")
	target_link_libraries(${name} PRIVATE ${L_USES} gz_settings)
	target_link_options(${name} PRIVATE ${exported_lines} "LINKER:--version-script=${exports}" LINKER:--as-needed)
	set_target_properties(${name} PROPERTIES VERSION ${PROJECT_VERSION}
		SOVERSION ${PROJECT_VERSION_MAJOR} LINK_DEPENDS "${exports}")
	install(TARGETS ${name} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
		COMPONENT ${L_COMPONENT} NAMELINK_COMPONENT development)
endfunction()

# gz_pkg_config(FILE): install what FILE, ending in .pc.in, becomes. The prefix is written relative to the file,
# because "cmake --install --prefix" may change it.
function(gz_pkg_config file)
	string(REGEX REPLACE "\\.in$" "" made "${file}")
	file(RELATIVE_PATH GAZECAST_PC_PREFIX "/x/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/x")
	configure_file("${file}" "${made}" @ONLY)
	install(FILES "${CMAKE_CURRENT_BINARY_DIR}/${made}"
		DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)
endfunction()

# gz_probe(NAME SOURCES file... [USES target...]): a program that measures, not installed.
function(gz_probe name)
	cmake_parse_arguments(P "" "" "SOURCES;USES" ${ARGN})
	gz_note_room(${name} ${P_USES})
	add_executable(${name} ${P_SOURCES})
	target_include_directories(${name} PRIVATE "${PROJECT_SOURCE_DIR}")
	target_link_libraries(${name} PRIVATE ${P_USES} gz_settings)
endfunction()

# The longest wait for a condition in a test (tests/suite.h); a busy machine is several times slower. CTest
# ends a test that hangs.
if(GAZECAST_SANITIZE)
	set(gz_test_patience_s 120)
else()
	set(gz_test_patience_s 60)
endif()
math(EXPR gz_test_timeout_s "10 * ${gz_test_patience_s}")

# What tests make of meshes is not kept in the folder of who runs them.
set(gz_test_environment "GZ_TEST_PATIENCE_S=${gz_test_patience_s}" "XDG_CACHE_HOME=${PROJECT_BINARY_DIR}/tests/cache")
if(GAZECAST_SANITIZE MATCHES thread)
	list(APPEND gz_test_environment "TSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/tests/tsan.supp:die_after_fork=0")
endif()

# gz_test_program(NAME SUITES suite... [FOLDER folder] [USES target...] [SOURCES more...]
# [DEFINES NAME=value...] [NEEDS target...]): the program test_NAME of all tests/FOLDER/test_<suite>.c, each
# of which is the test FOLDER.<suite>, labelled quick. FOLDER is NAME if it is not given.
# NEEDS are programs that the suites start. A test that cannot run where it is exits 77 and counts as skipped.
function(gz_test_program name)
	cmake_parse_arguments(T "" "FOLDER" "SUITES;USES;SOURCES;DEFINES;NEEDS" ${ARGN})
	if(NOT T_FOLDER)
		set(T_FOLDER ${name})
	endif()
	set(target test_${name})
	set(sources "")
	foreach(suite ${T_SUITES})
		list(APPEND sources test_${suite}.c)
	endforeach()
	create_test_sourcelist(sources ${target}_suites.c ${sources})
	add_executable(${target} ${sources} ${T_SOURCES})
	target_include_directories(${target} PRIVATE "${PROJECT_SOURCE_DIR}" "${PROJECT_SOURCE_DIR}/tests")
	target_compile_definitions(${target} PRIVATE ${T_DEFINES})
	target_link_libraries(${target} PRIVATE ${T_USES} PkgConfig::CMOCKA gz_settings)
	if(T_NEEDS)
		add_dependencies(${target} ${T_NEEDS})
	endif()
	foreach(suite ${T_SUITES})
		add_test(NAME ${T_FOLDER}.${suite} COMMAND ${target} test_${suite})
		set_tests_properties(${T_FOLDER}.${suite} PROPERTIES TIMEOUT ${gz_test_timeout_s} SKIP_RETURN_CODE 77
			LABELS quick ENVIRONMENT "${gz_test_environment}")
	endforeach()
endfunction()

# gz_test_properties(FOLDER SUITES suite... PROPERTIES name value...): as set_tests_properties().
function(gz_test_properties folder)
	cmake_parse_arguments(T "" "" "SUITES;PROPERTIES" ${ARGN})
	list(TRANSFORM T_SUITES PREPEND ${folder}.)
	set_tests_properties(${T_SUITES} PROPERTIES ${T_PROPERTIES})
endfunction()

# gz_fuzz(NAME [USES target...]): tests/fuzz/fuzz_NAME.c defines LLVMFuzzerTestOneInput. With
# GAZECAST_FUZZ it becomes a libFuzzer program; always, its corpus tests/fuzz/corpus/NAME/ is run as
# the test fuzz.NAME.
function(gz_fuzz name)
	cmake_parse_arguments(F "" "" "USES" ${ARGN})
	set(target fuzz_${name})
	add_executable(${target} fuzz_${name}.c)
	target_include_directories(${target} PRIVATE "${PROJECT_SOURCE_DIR}" "${PROJECT_SOURCE_DIR}/tests")
	target_link_libraries(${target} PRIVATE ${F_USES} gz_settings)
	if(GAZECAST_FUZZ)
		target_link_options(${target} PRIVATE -fsanitize=fuzzer)
		set(arguments -runs=0 "${CMAKE_CURRENT_SOURCE_DIR}/corpus/${name}")
	else()
		target_sources(${target} PRIVATE corpus_main.c)
		set(arguments "${CMAKE_CURRENT_SOURCE_DIR}/corpus/${name}")
	endif()
	add_test(NAME fuzz.${name} COMMAND ${target} ${arguments})
	set_tests_properties(fuzz.${name} PROPERTIES TIMEOUT ${gz_test_timeout_s} LABELS "fuzz;quick")
endfunction()

# Whether the processor may have AVX2 or AVX-512: their kernels are compiled, and chosen at run time.
if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64)$")
	set(GAZECAST_X86 ON)
endif()

# gz_cast_flags(FILE SET): compile FILE of this folder for one instruction set of the cpu backend.
function(gz_cast_flags file set)
	if(set STREQUAL avx2)
		set(flags -mavx2 -mfma)
	elseif(set STREQUAL avx512)
		set(flags -mavx512f -mavx512bw -mavx512dq -mavx512vl -mfma -mprefer-vector-width=512)
	else() # wide vectors are passed only between functions that are inlined into each other
		set(flags -Wno-psabi)
	endif()
	# gcc's frames for AddressSanitizer's use after return are not aligned as wide vectors need (its
	# bug 110027). Guarded arrays on the stack, all of constant size and index range, would take two
	# thirds of the time to compile a kernel; what a kernel reads and writes elsewhere is checked.
	# The preset's -Og compiles faster, but kernels take most of the time of the tests.
	if(GAZECAST_SANITIZE MATCHES address AND CMAKE_C_COMPILER_ID STREQUAL GNU)
		list(APPEND flags --param=asan-use-after-return=0 --param=asan-stack=0 -O1)
	endif()
	set_source_files_properties(${file} PROPERTIES COMPILE_OPTIONS "${flags}")
endfunction()

# gz_kernels(TARGET file... DEFINES NAME [PUBLIC] [CHOOSES]): add kernels of this folder to TARGET, each
# file compiled for the instruction set that its name ends in (_avx2.c, _avx512.c; any other: portable). The
# processor chooses at run time. Where it may have AVX, NAME is defined; elsewhere only portable files
# are added. PUBLIC: NAME is defined for those who use TARGET, too. CHOOSES: loops with a choice become
# SIMD, because no one asks which comparison met NaN; values stay the same.
function(gz_kernels target)
	cmake_parse_arguments(K "PUBLIC;CHOOSES" "DEFINES" "" ${ARGN})
	set(scope PRIVATE)
	if(K_PUBLIC)
		set(scope PUBLIC)
	endif()
	foreach(file ${K_UNPARSED_ARGUMENTS})
		if(file MATCHES "_(avx[0-9]+)\\.c$")
			if(NOT GAZECAST_X86)
				continue()
			endif()
			gz_cast_flags(${file} ${CMAKE_MATCH_1})
			target_compile_definitions(${target} ${scope} ${K_DEFINES})
		else()
			gz_cast_flags(${file} portable)
		endif()
		target_sources(${target} PRIVATE ${file})
		if(K_CHOOSES)
			set_property(SOURCE ${file} APPEND PROPERTY COMPILE_OPTIONS -fno-trapping-math)
		endif()
	endforeach()
endfunction()

# gz_system_directory(NAME PACKAGE VARIABLE FOLDER TEXT): the setting NAME, a folder of the system. Under /usr it
# is what pkg-config knows as VARIABLE of PACKAGE, because distributions differ; otherwise FOLDER.
function(gz_system_directory name package variable folder text)
	if(CMAKE_INSTALL_PREFIX STREQUAL "/usr")
		pkg_get_variable(known ${package} ${variable})
		if(known)
			set(folder "${known}")
		endif()
	endif()
	set(${name} "${folder}" CACHE STRING "${text}")
endfunction()
