/**
 * @file
 * A folder for the files of a fuzz target: in memory where there is such a file system.
 */
#ifndef GZ_TESTS_FUZZ_FUZZ_FOLDER_H
#define GZ_TESTS_FUZZ_FUZZ_FOLDER_H

#include <stdlib.h>
#include <string.h>

/** Make an empty folder and write its path. Aborts if there is no place for one. */
static inline void fuzz_folder_make(char out_path[64])
{
	strcpy(out_path, "/dev/shm/gazecast-fuzz-XXXXXX");
	if (mkdtemp(out_path))
		return;
	strcpy(out_path, "/tmp/gazecast-fuzz-XXXXXX");
	if (!mkdtemp(out_path))
		abort();
}

#endif
