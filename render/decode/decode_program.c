/* Where the decoder program is. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/sizes.h"
#include "render/decode/decode.h"

/* Folders above that of the running program that are looked into: the first is for an installed
 * program, the others for one in the tree of a build. */
#define FOLDERS_UP 3

static bool is_program_of(const char *path, const struct stat *running)
{
	struct stat found;
	return stat(path, &found) == 0 && S_ISREG(found.st_mode) && access(path, X_OK) == 0 &&
	       (found.st_uid == 0 || found.st_uid == running->st_uid) && !(found.st_mode & S_IWOTH);
}

static bool cut_last_part(char *path)
{
	char *slash = strrchr(path, '/');
	if (!slash)
		return false;
	*slash = 0;
	return true;
}

enum gz_result gz_decode_find_program(char *out_path, size_t size)
{
	const char *named = secure_getenv("GAZECAST_DECODER");
	if (named && named[0])
		return (size_t)snprintf(out_path, size, "%s", named) < size ? GZ_OK
									    : GZ_ERR_NOT_FOUND;
	char folder[GZ_PATH_SIZE], path[GZ_PATH_SIZE + sizeof GZ_LIBEXEC_FOLDER + 16];
	struct stat running;
	const ssize_t length = readlink("/proc/self/exe", folder, sizeof folder - 1);
	if (length <= 0 || stat("/proc/self/exe", &running) != 0)
		return GZ_ERR_NOT_FOUND;
	folder[length] = 0;
	if (!cut_last_part(folder))
		return GZ_ERR_NOT_FOUND;
	for (int up = 0; up < FOLDERS_UP && cut_last_part(folder); up++) {
		snprintf(path, sizeof path, "%s/" GZ_LIBEXEC_FOLDER "/gazedecode", folder);
		if (is_program_of(path, &running))
			return (size_t)snprintf(out_path, size, "%s", path) < size
				       ? GZ_OK
				       : GZ_ERR_NOT_FOUND;
	}
	return GZ_ERR_NOT_FOUND;
}
