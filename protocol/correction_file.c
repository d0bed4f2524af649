#include "protocol/correction_file.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

#include "base/text.h"
#include "protocol/key.h"
#include "protocol/stored_file.h"

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

static const struct gz_stored_form correction_form = {
	.keys = keys,
	.count = sizeof keys / sizeof *keys,
	.comment =
		"; A correction of a tracker's gaze, measured by gazectl validate. gazed applies "
		"it to\n; this tracker on this display; gazectl validate --forget removes it.\n",
	.section = "correction",
	.remedy = "measure again with gazectl validate --correct",
};

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

enum gz_result gz_correction_read(const char *path, const struct gz_log *log,
				  struct gz_correction_file *out_file)
{
	struct gz_correction_file file = { .before_deg = 0 };
	enum gz_result result = gz_stored_read(&correction_form, path, log, &file);
	if (result == GZ_OK)
		*out_file = file;
	return result;
}

enum gz_result gz_correction_parse(const char *name, const char *text, size_t size,
				   const struct gz_log *log, struct gz_correction_file *out_file)
{
	struct gz_correction_file file = { .before_deg = 0 };
	enum gz_result result = gz_stored_parse(&correction_form, name, text, size, log, &file);
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

enum gz_result gz_correction_write(const char *path, const struct gz_correction_file *file,
				   const struct gz_log *log)
{
	return gz_stored_write(&correction_form, path, file, log);
}
