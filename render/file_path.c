#include "render/file_path.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

bool gz_path_ends(const char *path, const char *ending)
{
	size_t length = strlen(path), tail = strlen(ending);
	return length >= tail && strcasecmp(path + length - tail, ending) == 0;
}

enum gz_result gz_path_beside(const char *file, const char *name, char *out_path, size_t size)
{
	const char *slash = strrchr(file, '/');
	int folder = slash && name[0] != '/' ? (int)(slash + 1 - file) : 0;
	int length = snprintf(out_path, size, "%.*s%s", folder, file, name);
	if (length >= 0 && (size_t)length < size)
		return GZ_OK;
	out_path[0] = '\0';
	return GZ_ERR_FULL;
}
