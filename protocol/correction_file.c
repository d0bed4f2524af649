#include "protocol/correction_file.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/option.h"
#include "base/text.h"
#include "protocol/key.h"

#define GZ_LOG_MODULE "correction"

#define AT(field) offsetof(struct gz_correction_file, field)

/* Relative difference up to which two sizes are equal: a wire or a text may change the last digits.
 */
static const double SIZE_TOLERANCE = 1e-6;

static const struct gz_option keys[] = {
	{ "correction.tracker", GZ_OPTION_STRING, AT(tracker), .max = GZ_NAME_SIZE,
	  .help = "name of the tracker" },
	{ "correction.serial", GZ_OPTION_STRING, AT(serial), .max = GZ_NAME_SIZE,
	  .help = "serial number of the tracker" },
	{ "correction.display_px", GZ_OPTION_SIZE, AT(display_px), 1, GZ_DISPLAY_SIDE_MAX_PX,
	  .help = "size of the display, px" },
	{ "correction.display_mm", GZ_OPTION_DOUBLE, AT(display_mm), 1e-3, 1e9, .count = 2,
	  .help = "width and height of the display, mm" },
	{ "correction.distance_mm", GZ_OPTION_DOUBLE, AT(distance_mm), 1e-3, 1e9,
	  .help = "distance from the eyes to the centre of the display, mm" },
	{ "correction.x", GZ_OPTION_DOUBLE, AT(x), -10, 10, .count = 3,
	  .help = "a b c of x' = a + b x + c y, display sides" },
	{ "correction.y", GZ_OPTION_DOUBLE, AT(y), -10, 10, .count = 3,
	  .help = "a b c of y' = a + b x + c y, display sides" },
	{ "correction.measured", GZ_OPTION_STRING, AT(measured), .max = GZ_NAME_SIZE,
	  .help = "time of the measurement, UTC" },
	{ "correction.before_deg", GZ_OPTION_DOUBLE, AT(before_deg), 0, 360,
	  .help = "mean error of the targets before the correction, degrees" },
	{ "correction.after_deg", GZ_OPTION_DOUBLE, AT(after_deg), 0, 360,
	  .help = "mean error after it, by leave-one-out cross-validation, degrees" },
};

enum { KEY_COUNT = sizeof keys / sizeof keys[0] };

void gz_correction_name(const char *name, char out_name[GZ_NAME_SIZE])
{
	size_t i = 0;
	for (; i < GZ_NAME_SIZE - 1 && name[i]; i++) {
		unsigned char c = (unsigned char)name[i];
		bool plain = c < 128 && (isalnum(c) || c == '-' || (c == '.' && i > 0));
		out_name[i] = plain ? (char)c : '_';
	}
	out_name[i] = '\0';
}

enum gz_result gz_correction_directory(char *text, size_t size)
{
	char directory[GZ_PATH_SIZE + 64];
	enum gz_result result = gz_key_directory(directory, sizeof directory);
	return result == GZ_OK ? gz_text_print(text, size, "%s/corrections", directory) : result;
}

enum gz_result gz_correction_path(const char *directory, const char *tracker, const char *serial,
				  const struct gz_display *display, char *text, size_t size)
{
	char name[GZ_NAME_SIZE], number[GZ_NAME_SIZE];
	gz_correction_name(tracker, name);
	gz_correction_name(serial, number);
	return gz_text_print(text, size, "%s/%s%s%s-%dx%d-%.0fx%.0fmm-%.0fmm.ini", directory, name,
			     number[0] ? "-" : "", number, display->px[0], display->px[1],
			     display->mm[0], display->mm[1], display->distance_mm);
}

/* Check that every key is given. */
static enum gz_result check_all_given(const bool *given, const char *name, const struct gz_log *log)
{
	for (size_t i = 0; i < KEY_COUNT; i++) {
		if (given[i])
			continue;
		gz_err(log, "%s: %s is missing; measure again with gazectl validate --correct",
		       name, keys[i].key);
		return GZ_ERR_FORMAT;
	}
	return GZ_OK;
}

enum gz_result gz_correction_read(const char *path, const struct gz_log *log,
				  struct gz_correction_file *out_file)
{
	struct gz_correction_file file = { .before_deg = 0 };
	bool given[KEY_COUNT] = { false };
	const struct gz_option_binding binding = { keys, KEY_COUNT, &file, given };
	if (access(path, F_OK) != 0)
		return GZ_ERR_NOT_FOUND;
	enum gz_result result = gz_options_read_file(&binding, 1, path, log);
	if (result == GZ_OK)
		result = check_all_given(given, path, log);
	if (result == GZ_OK)
		*out_file = file;
	return result;
}

enum gz_result gz_correction_parse(const char *name, const char *text, size_t size,
				   const struct gz_log *log, struct gz_correction_file *out_file)
{
	struct gz_correction_file file = { .before_deg = 0 };
	bool given[KEY_COUNT] = { false };
	const struct gz_option_binding binding = { keys, KEY_COUNT, &file, given };
	enum gz_result result = gz_options_read_text(&binding, 1, name, text, size, log);
	if (result == GZ_OK)
		result = check_all_given(given, name, log);
	if (result == GZ_OK)
		*out_file = file;
	return result;
}

static bool is_same_size(double a, double b)
{
	return fabs(a - b) <= SIZE_TOLERANCE * fmax(fabs(a), fabs(b));
}

bool gz_correction_fits(const struct gz_correction_file *file, const char *tracker,
			const char *serial, const struct gz_display *display)
{
	char name[GZ_NAME_SIZE], number[GZ_NAME_SIZE];
	gz_correction_name(tracker, name);
	gz_correction_name(serial, number);
	return strcmp(file->tracker, name) == 0 && strcmp(file->serial, number) == 0 &&
	       file->display_px[0] == display->px[0] && file->display_px[1] == display->px[1] &&
	       is_same_size(file->display_mm[0], display->mm[0]) &&
	       is_same_size(file->display_mm[1], display->mm[1]) &&
	       is_same_size(file->distance_mm, display->distance_mm);
}

/* Make all directories in @p path. A user's configuration is private; what root writes is for
 * services that do not run as root. */
static bool make_correction_directories(const char *path)
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

static bool print_correction_file(FILE *out, const struct gz_correction_file *file)
{
	fputs("; A correction of a tracker's gaze, measured by gazectl validate. gazed applies it "
	      "to\n; this tracker on this display; gazectl validate --forget removes it.\n"
	      "[correction]\n",
	      out);
	for (size_t i = 0; i < KEY_COUNT; i++) {
		char text[128];
		if (gz_option_format(&keys[i], file, text, sizeof text) != GZ_OK)
			return false;
		fprintf(out, "%s = %s\n", strchr(keys[i].key, '.') + 1, text);
	}
	return fflush(out) == 0 && !ferror(out) && fsync(fileno(out)) == 0;
}

/* Write a new file beside @p path and rename it. On failure errno says why. */
static bool write_correction(const char *path, const struct gz_correction_file *file)
{
	char beside[GZ_PATH_SIZE + 64];
	if (gz_text_print(beside, sizeof beside, "%s.new", path) != GZ_OK) {
		errno = ENAMETOOLONG;
		return false;
	}
	FILE *out = fopen(beside, "w");
	if (!out)
		return false;
	bool good = print_correction_file(out, file);
	good = fclose(out) == 0 && good;
	good = good && rename(beside, path) == 0;
	if (!good) {
		int reason = errno;
		unlink(beside);
		errno = reason;
	}
	return good;
}

enum gz_result gz_correction_write(const char *path, const struct gz_correction_file *file,
				   const struct gz_log *log)
{
	if (make_correction_directories(path) && write_correction(path, file))
		return GZ_OK;
	bool refused = errno == EACCES || errno == EPERM || errno == EROFS;
	gz_err(log, "cannot write %s: %s; name another directory with --corrections", path,
	       strerror(errno));
	return refused ? GZ_ERR_ACCESS : GZ_ERR_IO;
}
