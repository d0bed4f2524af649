#include "view/capture/output.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "base/text.h"

#define GZ_LOG_MODULE "gazeview"

void gz_output_folder(const char *path, char *out, size_t size)
{
	const char *slash = strrchr(path, '/');
	const int length = slash ? (int)(slash - path) + (slash == path) : 1;
	snprintf(out, size, "%.*s", length, slash ? path : ".");
}

static enum gz_result check_folder(const char *option, const char *path, const struct gz_log *log)
{
	char folder[GZ_PATH_SIZE];
	struct stat status;
	if (!path[0])
		return GZ_OK;
	gz_output_folder(path, folder, sizeof folder);
	errno = ENOTDIR;
	if (stat(folder, &status) == 0 && S_ISDIR(status.st_mode) &&
	    access(folder, W_OK | X_OK) == 0)
		return GZ_OK;
	gz_err(log, "--%s %s: cannot be written: %s: %s; create that folder or name another",
	       option, path, folder, strerror(errno));
	return GZ_ERR_IO;
}

/* An existing file may be writable in a folder that is not. Pictures may go to devices and pipes,
 * statistics to a regular file only. */
static bool is_writable_file(const char *path, bool plain)
{
	struct stat status;
	return stat(path, &status) == 0 && !S_ISDIR(status.st_mode) &&
	       S_ISREG(status.st_mode) == plain && access(path, W_OK) == 0;
}

enum gz_result gz_output_check(const struct gz_view_options *options, const struct gz_log *log)
{
	char picture[GZ_PATH_SIZE] = "";
	/* The options have checked the pattern. */
	if (options->out[0])
		(void)gz_pattern_format(options->out, 0, picture, sizeof picture);
	enum gz_result r = GZ_OK;
	if (!is_writable_file(picture, false))
		r = check_folder("out", picture, log);
	if (r == GZ_OK && !is_writable_file(options->video, true))
		r = check_folder("video", options->video, log);
	if (r == GZ_OK && !is_writable_file(options->stats, true))
		r = check_folder("stats", options->stats, log);
	if (r == GZ_OK && !is_writable_file(options->print, true))
		r = check_folder("print", options->print, log);
	if (r == GZ_OK && !is_writable_file(options->write_mesh, false))
		r = check_folder("write-mesh", options->write_mesh, log);
	return r == GZ_OK ? check_folder("write-volume", options->write_volume, log) : r;
}

/* Most names of one second. Chosen: more do not happen. */
enum { NUMBERS = 100 };

enum gz_result gz_capture_name(const char *folder, const char *ending, char out_path[GZ_PATH_SIZE])
{
	char when[32], number[8] = "", path[GZ_PATH_SIZE];
	const time_t now = time(NULL);
	struct tm local;
	localtime_r(&now, &local);
	strftime(when, sizeof when, "%Y%m%d-%H%M%S", &local);
	for (int i = 1; i <= NUMBERS; i++) {
		if (i > 1)
			snprintf(number, sizeof number, "_%d", i);
		if (gz_text_print(path, sizeof path, "%s/gazeview-%s%s%s", folder, when, number,
				  ending) != GZ_OK)
			return GZ_ERR_FULL;
		if (access(path, F_OK) != 0) {
			snprintf(out_path, GZ_PATH_SIZE, "%s", path);
			return GZ_OK;
		}
	}
	return GZ_ERR_FULL;
}
