# Every external part, found once. Each becomes an imported target; folders name the targets they use.
find_package(PkgConfig REQUIRED)
find_package(Threads REQUIRED)
find_package(ZLIB REQUIRED)
find_package(PNG REQUIRED)
pkg_check_modules(ZMQ REQUIRED IMPORTED_TARGET libzmq)
pkg_check_modules(ZSTD REQUIRED IMPORTED_TARGET libzstd)
pkg_check_modules(INIH REQUIRED IMPORTED_TARGET inih)
pkg_check_modules(GLFW REQUIRED IMPORTED_TARGET glfw3)
pkg_check_modules(GLEW REQUIRED IMPORTED_TARGET glew)
pkg_check_modules(IMGUI REQUIRED IMPORTED_TARGET imgui)
# msgpack-c is "msgpack" up to version 4 and "msgpack-c" from 5 on.
pkg_search_module(MSGPACK REQUIRED IMPORTED_TARGET msgpack-c msgpack)
if(BUILD_TESTING)
	pkg_check_modules(CMOCKA REQUIRED IMPORTED_TARGET cmocka)
endif()

# nifticlib ships no pkg-config file.
find_path(NIFTI_INCLUDE_DIR nifti1_io.h PATH_SUFFIXES nifti REQUIRED)
find_library(NIFTI_IO_LIBRARY niftiio REQUIRED)
find_library(NIFTI_ZNZ_LIBRARY znz REQUIRED)
add_library(gz_nifti INTERFACE)
target_include_directories(gz_nifti SYSTEM INTERFACE "${NIFTI_INCLUDE_DIR}")
target_link_libraries(gz_nifti INTERFACE "${NIFTI_IO_LIBRARY}" "${NIFTI_ZNZ_LIBRARY}" ZLIB::ZLIB m)
