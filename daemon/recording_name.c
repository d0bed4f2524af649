#include "daemon/recording_name.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "protocol/gaze.h"

#define SUFFIX ".gzl"

/* Longest name, characters. */
enum { NAME_MAX_LENGTH = 64 };

/* Recordings begun within one second get numbers; more than these do not happen. */
enum { NUMBERS = 100 };

bool gz_recording_name_valid(const char *name)
{
	static const char allowed[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"
				      "0123456789._-";
	size_t length = strlen(name);
	return length >= 1 && length <= NAME_MAX_LENGTH && strspn(name, allowed) == length;
}

static bool ends_in_suffix(const char *name)
{
	size_t length = strlen(name), suffix = strlen(SUFFIX);
	return length > suffix && strcmp(name + length - suffix, SUFFIX) == 0;
}

static enum gz_result create_file(const char *directory, const char *name, int *out_fd,
				  char *out_path, char *message, size_t message_size)
{
	char path[GZ_PATH_SIZE];
	int length = snprintf(path, sizeof path, "%s/%s%s", directory, name,
			      ends_in_suffix(name) ? "" : SUFFIX);
	if (length < 0 || (size_t)length >= sizeof path) {
		snprintf(message, message_size, "%s: the path is too long; choose a shorter one",
			 directory);
		return GZ_ERR_FULL;
	}
	int fd = open(path, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
	if (fd >= 0) {
		*out_fd = fd;
		memcpy(out_path, path, sizeof path);
		return GZ_OK;
	}
	if (errno == EEXIST) {
		snprintf(message, message_size, "%s exists; choose another name", path);
		return GZ_ERR_BUSY;
	}
	snprintf(message, message_size, "cannot make %s: %s; see recording.directory", path,
		 strerror(errno));
	return errno == EACCES || errno == EPERM ? GZ_ERR_ACCESS : GZ_ERR_IO;
}

static void name_by_time(int number, char *name, size_t size)
{
	char text[32];
	time_t now = time(NULL);
	struct tm utc;
	gmtime_r(&now, &utc);
	strftime(text, sizeof text, "gaze-%Y%m%dT%H%M%SZ", &utc);
	if (number == 0)
		snprintf(name, size, "%s", text);
	else
		snprintf(name, size, "%s-%d", text, number + 1);
}

enum gz_result gz_recording_create(const char *directory, const char *name, int *out_fd,
				   char *out_path, char *message, size_t message_size)
{
	if (name[0] && !gz_recording_name_valid(name)) {
		snprintf(message, message_size,
			 "that is no name for a recording; allowed: 1 to %d of A-Z a-z 0-9 . _ -",
			 NAME_MAX_LENGTH);
		return GZ_ERR_INVAL;
	}
	if (name[0])
		return create_file(directory, name, out_fd, out_path, message, message_size);
	enum gz_result result = GZ_ERR_BUSY;
	for (int i = 0; i < NUMBERS && result == GZ_ERR_BUSY; i++) {
		char chosen[NAME_MAX_LENGTH];
		name_by_time(i, chosen, sizeof chosen);
		result = create_file(directory, chosen, out_fd, out_path, message, message_size);
	}
	return result;
}
