#include "render/view_settings.h"

#include <stddef.h>

const char *const gz_view_overlay_names[] = { "none", "spacing", "step", NULL };

#define AT(field) offsetof(struct gz_view_settings, field)

const struct gz_option gz_view_setting_options[] = {
	{ .key = "view.gaze_cursor",
	  .type = GZ_OPTION_BOOL,
	  .offset = AT(gaze_cursor),
	  .preset = "no",
	  .help = "a cross at the gaze" },
	{ .key = "view.letters",
	  .type = GZ_OPTION_BOOL,
	  .offset = AT(letters),
	  .preset = "no",
	  .help = "at the picture's edges, which side is there: R L A P S I" },
	{ .key = "view.overlay",
	  .type = GZ_OPTION_CHOICE,
	  .offset = AT(overlay),
	  .choices = gz_view_overlay_names,
	  .preset = "none",
	  .help = "in a window: tint the plan's tiles by the spacing of their rays or by their "
		  "step" },
	{ .key = "view.trail",
	  .type = GZ_OPTION_BOOL,
	  .offset = AT(trail),
	  .preset = "no",
	  .help = "the last second of the gaze, in a window" },
	{ .key = "view.vsync",
	  .type = GZ_OPTION_BOOL,
	  .offset = AT(vsync),
	  .preset = "yes",
	  .help = "the window waits for the display's refresh" },
	{ .key = "view.gaze",
	  .type = GZ_OPTION_STRING,
	  .offset = AT(gaze),
	  .max = GZ_PATH_SIZE,
	  .help = "where the gaze comes from in a window, as --gaze has it; without it as it is" },
	{ .key = "view.tracker_display",
	  .type = GZ_OPTION_STRING,
	  .offset = AT(tracker_display),
	  .max = GZ_NAME_SIZE,
	  .help = "the monitor that a tracker's gaze is on, by its name or its number from 1; "
		  "without it the one that the daemon describes, else the window's" },
};
const size_t gz_view_setting_option_count =
	sizeof gz_view_setting_options / sizeof gz_view_setting_options[0];
