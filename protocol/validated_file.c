#include "protocol/validated_file.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/text.h"
#include "protocol/correction_file.h"
#include "protocol/stored_file.h"

#define AT(field) offsetof(struct gz_validated, field)

/* Relative differences up to which two sizes and two scales are equal: a wire or a text may change
 * the last digits; desktops round scales. */
#define SIZE_TOLERANCE  1e-6
#define SCALE_TOLERANCE 1e-3

static const struct gz_option validated_keys[] = {
	{ "validated.tracker", GZ_OPTION_STRING, AT(tracker), .max = GZ_NAME_SIZE,
	  .help = "name of the tracker" },
	{ "validated.serial", GZ_OPTION_STRING, AT(serial), .max = GZ_NAME_SIZE,
	  .help = "serial number of the tracker" },
	{ "validated.display_px", GZ_OPTION_SIZE, AT(display.px), 1, GZ_DISPLAY_SIDE_MAX_PX,
	  .help = "size of the display, px" },
	{ "validated.display_mm", GZ_OPTION_DOUBLE, AT(display.mm), 1e-3, 1e9, .count = 2,
	  .help = "width and height of the display, mm" },
	{ "validated.distance_mm", GZ_OPTION_DOUBLE, AT(display.distance_mm), 1e-3, 1e9,
	  .help = "distance from the eyes to the centre of the display, mm" },
	{ "validated.monitor_at", GZ_OPTION_INT, AT(monitor.at), -GZ_MONITOR_PLACE_MAX_PX,
	  GZ_MONITOR_PLACE_MAX_PX, .count = 2,
	  .help = "upper left corner of the monitor on the desktop, px" },
	{ "validated.monitor_px", GZ_OPTION_INT, AT(monitor.px), 0, GZ_DISPLAY_SIDE_MAX_PX,
	  .count = 2, .help = "width and height of the monitor, px; 0 0: unknown" },
	{ "validated.monitor_scale", GZ_OPTION_DOUBLE, AT(monitor.scale), 0, GZ_MONITOR_SCALE_MAX,
	  .help = "scale of the desktop on the monitor; 0: unknown" },
	{ "validated.measured", GZ_OPTION_STRING, AT(measured), .max = GZ_NAME_SIZE,
	  .help = "time of the measurement, UTC" },
	{ "validated.accuracy_deg", GZ_OPTION_DOUBLE, AT(accuracy_deg), 0, 360,
	  .help = "mean distance between target and gaze, degrees" },
};

static const struct gz_stored_form validated_form = {
	.keys = validated_keys,
	.count = sizeof validated_keys / sizeof *validated_keys,
	.comment = "; The display on which gazectl validate last checked this tracker. gazed says\n"
		   "; when it has changed.\n",
	.section = "validated",
	.remedy = "run gazectl validate again",
};

enum gz_result gz_validated_path(const char *directory, const char *tracker, const char *serial,
				 char *text, size_t size)
{
	char name[GZ_NAME_SIZE], number[GZ_NAME_SIZE];
	gz_correction_name(tracker, name);
	gz_correction_name(serial, number);
	return gz_text_print(text, size, "%s/validated-%s%s%s.ini", directory, name,
			     number[0] ? "-" : "", number);
}

enum gz_result gz_validated_read(const char *path, const struct gz_log *log,
				 struct gz_validated *out_validated)
{
	struct gz_validated validated = { .accuracy_deg = 0 };
	enum gz_result result = gz_stored_read(&validated_form, path, log, &validated);
	if (result == GZ_OK)
		*out_validated = validated;
	return result;
}

enum gz_result gz_validated_parse(const char *name, const char *text, size_t size,
				  const struct gz_log *log, struct gz_validated *out_validated)
{
	struct gz_validated validated = { .accuracy_deg = 0 };
	enum gz_result result = gz_stored_parse(&validated_form, name, text, size, log, &validated);
	if (result == GZ_OK)
		*out_validated = validated;
	return result;
}

enum gz_result gz_validated_write(const char *path, const struct gz_validated *validated,
				  const struct gz_log *log)
{
	return gz_stored_write(&validated_form, path, validated, log);
}

bool gz_validated_fits(const struct gz_validated *validated, const char *tracker,
		       const char *serial)
{
	char name[GZ_NAME_SIZE], number[GZ_NAME_SIZE];
	gz_correction_name(tracker, name);
	gz_correction_name(serial, number);
	return strcmp(validated->tracker, name) == 0 && strcmp(validated->serial, number) == 0;
}

static bool differs(double a, double b, double tolerance)
{
	return fabs(a - b) > tolerance * fmax(fabs(a), fabs(b));
}

/* @return whether the display of the daemon has changed; it then is told in @p out */
static bool tell_display_changed(const struct gz_display *was, const struct gz_display *is,
				 char out[GZ_REASON_SIZE])
{
	if (was->px[0] != is->px[0] || was->px[1] != is->px[1])
		snprintf(out, GZ_REASON_SIZE, "%dx%d px, was %dx%d px", is->px[0], is->px[1],
			 was->px[0], was->px[1]);
	else if (differs(was->mm[0], is->mm[0], SIZE_TOLERANCE) ||
		 differs(was->mm[1], is->mm[1], SIZE_TOLERANCE))
		snprintf(out, GZ_REASON_SIZE, "%gx%g mm, was %gx%g mm", is->mm[0], is->mm[1],
			 was->mm[0], was->mm[1]);
	else if (differs(was->distance_mm, is->distance_mm, SIZE_TOLERANCE))
		snprintf(out, GZ_REASON_SIZE, "%g mm away, was %g mm", is->distance_mm,
			 was->distance_mm);
	return out[0] != '\0';
}

static bool tell_monitor_changed(const struct gz_monitor_place *was,
				 const struct gz_monitor_place *is, char out[GZ_REASON_SIZE])
{
	bool known = was->px[0] > 0 && was->px[1] > 0 && is->px[0] > 0 && is->px[1] > 0;
	bool scales = known && was->scale > 0 && is->scale > 0;
	if (known && (was->px[0] != is->px[0] || was->px[1] != is->px[1]))
		snprintf(out, GZ_REASON_SIZE, "monitor of %dx%d px, was %dx%d px", is->px[0],
			 is->px[1], was->px[0], was->px[1]);
	else if (scales && differs(was->scale, is->scale, SCALE_TOLERANCE))
		snprintf(out, GZ_REASON_SIZE, "scale of the desktop %g, was %g", is->scale,
			 was->scale);
	else if (known && (was->at[0] != is->at[0] || was->at[1] != is->at[1]))
		snprintf(out, GZ_REASON_SIZE, "monitor at %d %d of the desktop, was at %d %d",
			 is->at[0], is->at[1], was->at[0], was->at[1]);
	return out[0] != '\0';
}

bool gz_validated_changed(const struct gz_validated *validated, const struct gz_display *display,
			  const struct gz_monitor_place *monitor, char out[GZ_REASON_SIZE])
{
	out[0] = '\0';
	return tell_display_changed(&validated->display, display, out) ||
	       tell_monitor_changed(&validated->monitor, monitor, out);
}
