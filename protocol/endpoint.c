#include "protocol/endpoint.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "base/text.h"

#define GZ_LOG_MODULE "endpoint"

static bool is_existing_directory(const char *path)
{
	struct stat status;
	return stat(path, &status) == 0 && S_ISDIR(status.st_mode);
}

enum gz_result gz_runtime_directory(char *text, size_t size)
{
	const char *chosen = getenv("GAZECAST_RUNTIME_DIR");
	if (chosen && *chosen)
		return gz_text_print(text, size, "%s", chosen);
	/* The XDG base directory specification asks to ignore a path that is not absolute. */
	const char *session = getenv("XDG_RUNTIME_DIR");
	if (session && session[0] == '/')
		return gz_text_print(text, size, "%s/gazecast", session);
	if (is_existing_directory(GZ_SYSTEM_RUNTIME_DIRECTORY))
		return gz_text_print(text, size, "%s", GZ_SYSTEM_RUNTIME_DIRECTORY);
	return gz_text_print(text, size, "/tmp/gazecast-%ld", (long)getuid());
}

bool gz_runtime_directory_is_shared(const char *path)
{
	return strcmp(path, GZ_SYSTEM_RUNTIME_DIRECTORY) == 0;
}

static bool has_socket(const char *directory, const char *name)
{
	char path[sizeof((struct sockaddr_un *)NULL)->sun_path];
	struct stat status;
	return gz_text_print(path, sizeof path, "%s/%s", directory, name) == GZ_OK &&
	       stat(path, &status) == 0 && S_ISSOCK(status.st_mode);
}

/* Check that /tmp/gazecast-UID is not another user's: anybody can make a directory in /tmp. */
static enum gz_result check_owner(const char *path, const struct gz_log *log)
{
	struct stat status;
	bool others =
		lstat(path, &status) == 0 &&
		(!S_ISDIR(status.st_mode) || (status.st_uid != geteuid() && status.st_uid != 0));
	if (!others)
		return GZ_OK;
	gz_err(log,
	       "%s belongs to another user, who may impersonate the daemon: remove it, or name the "
	       "daemon's directory in GAZECAST_RUNTIME_DIR",
	       path);
	return GZ_ERR_ACCESS;
}

enum gz_result gz_endpoint_find(const char *name, const struct gz_log *log, char *text, size_t size)
{
	char directory[GZ_ENDPOINT_SIZE], own[64];
	const char *chosen = getenv("GAZECAST_RUNTIME_DIR");
	enum gz_result result = gz_runtime_directory(directory, sizeof directory);
	if (result != GZ_OK)
		return result;
	if ((chosen && *chosen) || has_socket(directory, name))
		return gz_endpoint_ipc(directory, name, text, size);
	snprintf(own, sizeof own, "/tmp/gazecast-%ld", (long)getuid());
	if (has_socket(GZ_SYSTEM_RUNTIME_DIRECTORY, name))
		snprintf(directory, sizeof directory, "%s", GZ_SYSTEM_RUNTIME_DIRECTORY);
	else if (has_socket(own, name))
		snprintf(directory, sizeof directory, "%s", own);
	if (strcmp(directory, own) == 0)
		result = check_owner(own, log);
	return result == GZ_OK ? gz_endpoint_ipc(directory, name, text, size) : result;
}

/* Check that nobody else can reach the content of the directory that @p status describes. */
static enum gz_result check_runtime_directory(const char *path, const struct stat *status,
					      const struct gz_log *log)
{
	/* Only root can make /run/gazecast, so its owner does not matter, and its group may read.
	 */
	bool system = gz_runtime_directory_is_shared(path);
	mode_t refused = system ? S_IWGRP | S_IRWXO : S_IRWXG | S_IRWXO;
	if (!system && status->st_uid != geteuid()) {
		gz_err(log,
		       "%s belongs to user %ld, not to this user (%ld): remove it, or name another "
		       "directory in GAZECAST_RUNTIME_DIR",
		       path, (long)status->st_uid, (long)geteuid());
		return GZ_ERR_ACCESS;
	}
	if (status->st_mode & refused) {
		gz_err(log, "%s is open to others (mode %03o): run chmod %s %s", path,
		       (unsigned)(status->st_mode & 0777), system ? "750" : "700", path);
		return GZ_ERR_ACCESS;
	}
	return GZ_OK;
}

enum gz_result gz_runtime_directory_prepare(const char *path, const struct gz_log *log)
{
	if (mkdir(path, 0700) != 0 && errno != EEXIST) {
		gz_err(log, "cannot make %s: %s; name another directory in GAZECAST_RUNTIME_DIR",
		       path, strerror(errno));
		return GZ_ERR_IO;
	}
	/* lstat: a link could be changed to point elsewhere after this check. */
	struct stat status;
	if (lstat(path, &status) != 0) {
		gz_err(log, "cannot inspect %s: %s", path, strerror(errno));
		return GZ_ERR_IO;
	}
	if (!S_ISDIR(status.st_mode)) {
		gz_err(log,
		       "%s is not a directory: remove it, or name another in GAZECAST_RUNTIME_DIR",
		       path);
		return GZ_ERR_ACCESS;
	}
	return check_runtime_directory(path, &status, log);
}

enum gz_result gz_endpoint_ipc(const char *directory, const char *name, char *text, size_t size)
{
	/* sun_path holds the path and its NUL. */
	size_t path_size = sizeof((struct sockaddr_un *)NULL)->sun_path;
	if (strlen(directory) + 1 + strlen(name) + 1 > path_size)
		return GZ_ERR_FULL;
	return gz_text_print(text, size, "ipc://%s/%s", directory, name);
}
