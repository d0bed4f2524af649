#include "bench/report/child.h"

#include <errno.h>
#include <fcntl.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include "protocol/gaze.h"

/* Variables that a child needs to find its parts. */
static const char *const kept[] = { "PATH", "HOME", "LD_LIBRARY_PATH", "XDG_CACHE_HOME" };

enum { KEPT = sizeof kept / sizeof kept[0], VARIABLE_SIZE = 8192 };

static enum gz_result start(const char *folder, char *const *arguments, const char *output,
			    char *const *environment, pid_t *out_pid)
{
	posix_spawn_file_actions_t actions;
	if (posix_spawn_file_actions_init(&actions) != 0)
		return GZ_ERR_NO_MEM;
	posix_spawn_file_actions_addchdir_np(&actions, folder);
	posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
	posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, output,
					 O_WRONLY | O_CREAT | O_TRUNC, 0666);
	posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
	const int error =
		posix_spawnp(out_pid, arguments[0], &actions, NULL, arguments, environment);
	posix_spawn_file_actions_destroy(&actions);
	if (error == 0)
		return GZ_OK;
	return error == ENOENT || error == EACCES || error == ENOTDIR ? GZ_ERR_NOT_FOUND
								      : GZ_ERR_IO;
}

enum gz_result gz_child_run(const char *folder, char *const *arguments, const char *output,
			    int *out_status)
{
	char variables[KEPT][VARIABLE_SIZE], locale[] = "LC_ALL=C.UTF-8";
	char *environment[KEPT + 2] = { locale };
	int count = 1;
	for (int i = 0; i < KEPT; i++) {
		const char *value = getenv(kept[i]);
		if (value &&
		    snprintf(variables[i], VARIABLE_SIZE, "%s=%s", kept[i], value) < VARIABLE_SIZE)
			environment[count++] = variables[i];
	}
	pid_t pid;
	int status;
	const enum gz_result result = start(folder, arguments, output, environment, &pid);
	if (result != GZ_OK)
		return result;
	while (waitpid(pid, &status, 0) < 0)
		if (errno != EINTR)
			return GZ_ERR_IO;
	*out_status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
	return GZ_OK;
}
