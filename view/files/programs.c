#include "view/files/programs.h"

#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

/* Find what one of several patterns names, each relative to the folder of this program. */
static enum gz_result find_beside(const char *const patterns[], size_t count, const char *what,
				  char out_path[GZ_PATH_SIZE])
{
	char folder[GZ_PATH_SIZE], path[2 * GZ_PATH_SIZE];
	const ssize_t length = readlink("/proc/self/exe", folder, sizeof folder - 1);
	out_path[0] = '\0';
	if (length <= 0)
		return GZ_ERR_NOT_FOUND;
	folder[length] = '\0';
	char *slash = strrchr(folder, '/');
	if (slash)
		*slash = '\0';
	for (size_t i = 0; i < count; i++) {
		const int size = snprintf(path, sizeof path, "%s/%s/%s", folder, patterns[i], what);
		if (size < GZ_PATH_SIZE && access(path, R_OK) == 0) {
			memcpy(out_path, path, (size_t)size + 1);
			return GZ_OK;
		}
	}
	return GZ_ERR_NOT_FOUND;
}

enum gz_result gz_shipped_path(const char *what, char out_path[GZ_PATH_SIZE])
{
	/* Installed, and in build/PRESET/view of a clone. */
	static const char *const patterns[] = { "../share/gazecast", "../../../etc" };
	return find_beside(patterns, sizeof patterns / sizeof patterns[0], what, out_path);
}

enum gz_result gz_program_path(const char *name, char out_path[GZ_PATH_SIZE])
{
	static const char *const patterns[] = { ".", "../daemon", "../view" };
	return find_beside(patterns, sizeof patterns / sizeof patterns[0], name, out_path);
}

enum gz_result gz_program_start(char *const arguments[], pid_t *out_child)
{
	const pid_t parent = getpid(), child = fork();
	if (child < 0)
		return GZ_ERR_IO;
	if (child == 0) { /* only calls that are safe beside threads */
		prctl(PR_SET_PDEATHSIG, SIGTERM);
		if (getppid() == parent)
			execv(arguments[0], arguments);
		_exit(127);
	}
	*out_child = child;
	return GZ_OK;
}

bool gz_program_runs(pid_t *child)
{
	if (*child > 0 && waitpid(*child, NULL, WNOHANG) != 0)
		*child = 0;
	return *child > 0;
}

void gz_program_stop(pid_t *child)
{
	if (!gz_program_runs(child))
		return;
	kill(*child, SIGTERM);
	waitpid(*child, NULL, 0);
	*child = 0;
}
