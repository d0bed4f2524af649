# Writes a C source that names the commit of a working tree, if it names another than it did.
#   cmake -DROOT=working-tree -DOUT=commit.c -P commit.cmake
set(commit unknown)
find_program(GIT git)
if(GIT)
	execute_process(COMMAND "${GIT}" -C "${ROOT}" describe --always --dirty --abbrev=12 --exclude=*
		OUTPUT_VARIABLE described RESULT_VARIABLE status ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
	if(status EQUAL 0 AND described MATCHES "^[0-9a-f]+(-dirty)?$")
		set(commit "${described}")
	endif()
endif()
set(text "/* Made by cmake/commit.cmake. */\nextern const char gazebench_commit[];\nconst char gazebench_commit[] = \"${commit}\";\n")
set(before "")
if(EXISTS "${OUT}")
	file(READ "${OUT}" before)
endif()
if(NOT before STREQUAL text)
	file(WRITE "${OUT}" "${text}")
endif()
