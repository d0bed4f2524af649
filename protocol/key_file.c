#include "protocol/key_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define GZ_LOG_MODULE "key"

/* As long as Linux takes them. */
enum { PATH_SIZE = 4096 };

static enum gz_result fits(int length, size_t size)
{
	return length >= 0 && (size_t)length < size ? GZ_OK : GZ_ERR_FULL;
}

enum gz_result gz_key_directory(char *text, size_t size)
{
	const char *configuration = getenv("XDG_CONFIG_HOME");
	const char *home = getenv("HOME");
	if (configuration && configuration[0] == '/')
		return fits(snprintf(text, size, "%s/gazecast", configuration), size);
	if (home && home[0] == '/')
		return fits(snprintf(text, size, "%s/.config/gazecast", home), size);
	return GZ_ERR_NOT_FOUND;
}

enum gz_result gz_key_file_find(const char *directory, const char *name, char *path, size_t size)
{
	char user[PATH_SIZE], system[PATH_SIZE];
	if (directory && directory[0]) {
		if (fits(snprintf(path, size, "%s/%s", directory, name), size) != GZ_OK)
			return GZ_ERR_FULL;
		return access(path, F_OK) == 0 ? GZ_OK : GZ_ERR_NOT_FOUND;
	}
	snprintf(system, sizeof system, "%s/gazecast/%s", GAZECAST_SYSCONFDIR, name);
	bool has_user = gz_key_directory(user, sizeof user) == GZ_OK;
	if (has_user) {
		if (fits(snprintf(path, size, "%s/%s", user, name), size) != GZ_OK)
			return GZ_ERR_FULL;
		if (access(path, F_OK) == 0)
			return GZ_OK;
	}
	bool in_system = access(system, F_OK) == 0;
	if ((in_system || !has_user) && fits(snprintf(path, size, "%s", system), size) != GZ_OK)
		return GZ_ERR_FULL;
	return in_system ? GZ_OK : GZ_ERR_NOT_FOUND;
}

static enum gz_result refuse(const char *path, const char *what, const char *remedy,
			     const struct gz_log *log)
{
	gz_err(log, "%s %s: run %s", path, what, remedy);
	return GZ_ERR_ACCESS;
}

/* Whoever may write the directory may put another file in the place of the one that was checked. */
static enum gz_result check_directory(const char *path, const struct gz_log *log)
{
	char directory[PATH_SIZE], remedy[PATH_SIZE + 32];
	struct stat status;
	const char *slash = strrchr(path, '/');
	if (!slash)
		snprintf(directory, sizeof directory, ".");
	else
		snprintf(directory, sizeof directory, "%.*s",
			 slash > path ? (int)(slash - path) : 1, path);
	if (stat(directory, &status) != 0) {
		gz_err(log, "cannot look at %s: %s", directory, strerror(errno));
		return GZ_ERR_IO;
	}
	snprintf(remedy, sizeof remedy, "chmod 700 %s", directory);
	bool open = (status.st_mode & (S_IWGRP | S_IWOTH)) != 0;
	if (!open && (status.st_uid == 0 || status.st_uid == geteuid()))
		return GZ_OK;
	if (!open)
		snprintf(remedy, sizeof remedy, "chown %ld %s", (long)geteuid(), directory);
	return refuse(directory, open ? "can be written by others" : "is another user's", remedy,
		      log);
}

static enum gz_result check_file(const char *path, const struct stat *status, bool secret,
				 const struct gz_log *log)
{
	char remedy[PATH_SIZE + 16];
	if (!S_ISREG(status->st_mode))
		return refuse(path, "is no regular file", "gazectl keygen", log);
	snprintf(remedy, sizeof remedy, "chmod %s %s", secret ? "600" : "go-w", path);
	if (secret && (status->st_mode & (S_IRWXG | S_IRWXO)))
		return refuse(path, "is a secret key that others can read", remedy, log);
	if (status->st_mode & (S_IWGRP | S_IWOTH))
		return refuse(path, "can be written by others", remedy, log);
	snprintf(remedy, sizeof remedy, "chown %ld %s", (long)geteuid(), path);
	if (status->st_uid != 0 && status->st_uid != geteuid())
		return refuse(path, "is another user's", remedy, log);
	return GZ_OK;
}

static enum gz_result read_whole(int fd, const char *path, const struct gz_log *log, char *text,
				 size_t *out_size)
{
	size_t size = 0;
	ssize_t n;
	do {
		n = read(fd, text + size, GZ_KEY_FILE_SIZE_MAX + 1 - size);
		size += n > 0 ? (size_t)n : 0;
	} while ((n > 0 && size <= GZ_KEY_FILE_SIZE_MAX) || (n < 0 && errno == EINTR));
	if (n < 0) {
		gz_err(log, "cannot read %s: %s", path, strerror(errno));
		return GZ_ERR_IO;
	}
	if (size > GZ_KEY_FILE_SIZE_MAX) {
		gz_err(log, "%s is longer than %d bytes, so no file of keys; check the path", path,
		       GZ_KEY_FILE_SIZE_MAX);
		return GZ_ERR_FORMAT;
	}
	*out_size = size;
	return GZ_OK;
}

static enum gz_result read_checked(int fd, const char *path, bool secret, const struct gz_log *log,
				   char **out_text, size_t *out_size)
{
	struct stat status;
	if (fstat(fd, &status) != 0) {
		gz_err(log, "cannot look at %s: %s", path, strerror(errno));
		return GZ_ERR_IO;
	}
	enum gz_result result = check_file(path, &status, secret, log);
	if (result == GZ_OK)
		result = check_directory(path, log);
	if (result != GZ_OK)
		return result;
	char *text = malloc(GZ_KEY_FILE_SIZE_MAX + 1);
	if (!text)
		return GZ_ERR_NO_MEM;
	result = read_whole(fd, path, log, text, out_size);
	if (result != GZ_OK) {
		free(text);
		return result;
	}
	*out_text = text;
	return GZ_OK;
}

enum gz_result gz_key_file_read(const char *path, bool secret, const struct gz_log *log,
				char **out_text, size_t *out_size)
{
	/* Not to wait where somebody has put a FIFO in its place. */
	int fd = open(path, O_RDONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK);
	if (fd < 0 && errno == ENOENT)
		return GZ_ERR_NOT_FOUND;
	if (fd < 0) {
		gz_err(log, "cannot open %s: %s; it must be readable by user %ld", path,
		       strerror(errno), (long)geteuid());
		return errno == EACCES ? GZ_ERR_ACCESS : GZ_ERR_IO;
	}
	enum gz_result result = read_checked(fd, path, secret, log, out_text, out_size);
	close(fd);
	return result;
}

enum gz_result gz_key_file_read_secret(const char *path, const struct gz_log *log,
				       char out_key[GZ_KEY_TEXT_SIZE])
{
	char *text;
	size_t size;
	enum gz_result result = gz_key_file_read(path, true, log, &text, &size);
	if (result != GZ_OK)
		return result;
	result = gz_key_parse(path, text, size, log, out_key);
	explicit_bzero(text, size);
	free(text);
	return result;
}

enum gz_result gz_key_file_read_list(const char *path, enum gz_key_list_kind kind,
				     const struct gz_log *log, struct gz_key_list *out_list)
{
	char *text;
	size_t size;
	enum gz_result result = gz_key_file_read(path, false, log, &text, &size);
	if (result != GZ_OK)
		return result;
	result = gz_key_list_parse(path, text, size, kind, log, out_list);
	free(text);
	return result;
}

enum gz_result gz_key_file_find_server(const char *directory, const char *host,
				       const struct gz_log *log, char out_key[GZ_KEY_TEXT_SIZE])
{
	char path[PATH_SIZE];
	enum gz_result result =
		gz_key_file_find(directory, GZ_KNOWN_SERVERS_FILE, path, sizeof path);
	if (result != GZ_OK)
		return result;
	struct gz_key_list *list = malloc(sizeof *list); /* large */
	if (!list)
		return GZ_ERR_NO_MEM;
	result = gz_key_file_read_list(path, GZ_KEY_LIST_SERVERS, log, list);
	if (result == GZ_OK) {
		const struct gz_known_key *known = gz_key_list_find_host(list, host);
		if (known)
			memcpy(out_key, known->key, GZ_KEY_TEXT_SIZE);
		else
			result = GZ_ERR_NOT_FOUND;
	}
	free(list);
	return result;
}

enum gz_result gz_key_directory_make(const char *directory, const struct gz_log *log)
{
	char path[PATH_SIZE];
	if (fits(snprintf(path, sizeof path, "%s", directory), sizeof path) != GZ_OK)
		return GZ_ERR_FULL;
	for (char *slash = strchr(path + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
		*slash = '\0';
		mkdir(path, 0700); /* where that fails, the last one does */
		*slash = '/';
	}
	if (mkdir(path, 0700) == 0 || errno == EEXIST)
		return GZ_OK;
	gz_err(log, "cannot make %s: %s; name another directory", directory, strerror(errno));
	return GZ_ERR_IO;
}

static bool write_whole(int fd, const char *text)
{
	size_t size = strlen(text);
	while (size > 0) {
		ssize_t n = write(fd, text, size);
		if (n < 0 && errno != EINTR)
			return false;
		text += n > 0 ? n : 0;
		size -= n > 0 ? (size_t)n : 0;
	}
	return fsync(fd) == 0;
}

enum gz_result gz_key_file_write(const char *path, bool secret, const char *text,
				 const struct gz_log *log)
{
	int fd = open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW,
		      secret ? 0600 : 0644);
	if (fd < 0 && errno == EEXIST) {
		gz_err(log,
		       "%s exists and is kept: whoever knows that key would be locked out; to "
		       "replace it, move it away first",
		       path);
		return GZ_ERR_BUSY;
	}
	bool written = fd >= 0 && write_whole(fd, text);
	if (!written)
		gz_err(log, "cannot write %s: %s", path, strerror(errno));
	if (fd >= 0)
		close(fd);
	if (fd >= 0 && !written)
		unlink(path);
	return written ? GZ_OK : GZ_ERR_IO;
}
