#include "kept_files.h"

#include "suite.h"

#include <dirent.h>
#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static char folder[64];

const char *kept_files_open(void)
{
	strcpy(folder, "/tmp/gazecast-kept-XXXXXX");
	assert_non_null(mkdtemp(folder));
	assert_int_equal(setenv("XDG_CACHE_HOME", folder, 1), 0);
	return folder;
}

int kept_files_count(void)
{
	char meshes[96];
	int count = 0;
	snprintf(meshes, sizeof meshes, "%s/gazecast/meshes", folder);
	DIR *directory = opendir(meshes);
	const struct dirent *entry = directory ? readdir(directory) : NULL;
	for (; entry; entry = readdir(directory))
		count += entry->d_name[0] != '.';
	if (directory)
		closedir(directory);
	return count;
}

static int remove_entry(const char *path, const struct stat *status, int kind, struct FTW *at)
{
	(void)status;
	(void)kind;
	(void)at;
	return remove(path);
}

void kept_files_close(void)
{
	assert_int_equal(nftw(folder, remove_entry, 8, FTW_DEPTH | FTW_PHYS), 0);
	assert_int_equal(unsetenv("XDG_CACHE_HOME"), 0);
}
