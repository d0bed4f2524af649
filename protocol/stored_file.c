#include "protocol/stored_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/sizes.h"
#include "base/text.h"

#define GZ_LOG_MODULE "stored"

/* Check that every key is given. */
static enum gz_result check_all_given(const struct gz_stored_form *form, const bool *given,
				      const char *name, const struct gz_log *log)
{
	for (size_t i = 0; i < form->count; i++) {
		if (given[i])
			continue;
		gz_err(log, "%s: %s is missing; %s", name, form->keys[i].key, form->remedy);
		return GZ_ERR_FORMAT;
	}
	return GZ_OK;
}

enum gz_result gz_stored_read(const struct gz_stored_form *form, const char *path,
			      const struct gz_log *log, void *target)
{
	bool given[GZ_STORED_KEYS_MAX] = { false };
	const struct gz_option_binding binding = { form->keys, form->count, target, given };
	if (access(path, F_OK) != 0)
		return GZ_ERR_NOT_FOUND;
	enum gz_result result = gz_options_read_file(&binding, 1, path, log);
	return result == GZ_OK ? check_all_given(form, given, path, log) : result;
}

enum gz_result gz_stored_parse(const struct gz_stored_form *form, const char *name,
			       const char *text, size_t size, const struct gz_log *log,
			       void *target)
{
	bool given[GZ_STORED_KEYS_MAX] = { false };
	const struct gz_option_binding binding = { form->keys, form->count, target, given };
	enum gz_result result = gz_options_read_text(&binding, 1, name, text, size, log);
	return result == GZ_OK ? check_all_given(form, given, name, log) : result;
}

/* Make all directories in @p path. A user's configuration is private; what root writes is for
 * services that do not run as root. */
static bool make_stored_directories(const char *path)
{
	char text[GZ_PATH_SIZE + 64];
	mode_t mode = geteuid() == 0 ? 0755 : 0700;
	if (strlen(path) >= sizeof text)
		return false;
	memcpy(text, path, strlen(path) + 1);
	for (char *slash = strchr(text + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
		*slash = '\0';
		if (mkdir(text, mode) != 0 && errno != EEXIST)
			return false;
		*slash = '/';
	}
	return true;
}

static bool print_stored_file(FILE *out, const struct gz_stored_form *form, const void *target)
{
	fprintf(out, "%s[%s]\n", form->comment, form->section);
	for (size_t i = 0; i < form->count; i++) {
		char text[128];
		if (gz_option_format(&form->keys[i], target, text, sizeof text) != GZ_OK)
			return false;
		fprintf(out, "%s = %s\n", strchr(form->keys[i].key, '.') + 1, text);
	}
	return fflush(out) == 0 && !ferror(out) && fsync(fileno(out)) == 0;
}

/* Write a new file beside @p path and rename it. On failure errno says why. */
static bool replace_stored_file(const struct gz_stored_form *form, const char *path,
				const void *target)
{
	char beside[GZ_PATH_SIZE + 64];
	if (gz_text_print(beside, sizeof beside, "%s.new", path) != GZ_OK) {
		errno = ENAMETOOLONG;
		return false;
	}
	FILE *out = fopen(beside, "w");
	if (!out)
		return false;
	bool good = print_stored_file(out, form, target);
	good = fclose(out) == 0 && good;
	good = good && rename(beside, path) == 0;
	if (!good) {
		int reason = errno;
		unlink(beside);
		errno = reason;
	}
	return good;
}

enum gz_result gz_stored_write(const struct gz_stored_form *form, const char *path,
			       const void *target, const struct gz_log *log)
{
	if (make_stored_directories(path) && replace_stored_file(form, path, target))
		return GZ_OK;
	bool refused = errno == EACCES || errno == EPERM || errno == EROFS;
	gz_err(log, "cannot write %s: %s; name another directory with --corrections", path,
	       strerror(errno));
	return refused ? GZ_ERR_ACCESS : GZ_ERR_IO;
}
