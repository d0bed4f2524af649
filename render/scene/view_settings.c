#include "render/scene/view_settings.h"

#include <stddef.h>

const char *const gz_view_overlay_names[] = { "none", "spacing", "step", NULL };

const char *const gz_view_compare_names[] = { "none", "split", "difference", NULL };

#define AT(field) offsetof(struct gz_view_settings, field)

#define SAVED(number)                                                                        \
	{                                                                                    \
		.key = "views." #number, .type = GZ_OPTION_STRING,                           \
		.offset = AT(saved[(number)-1]), .max = GZ_SAVED_VIEW_SIZE, .preset = "",    \
		.help = "a view that F" #number " shows: eye X Y Z look_at X Y Z up X Y Z, " \
			"then fov_deg F or height H",                                        \
	}

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
	{ .key = "view.compare",
	  .type = GZ_OPTION_CHOICE,
	  .offset = AT(compare),
	  .choices = gz_view_compare_names,
	  .preset = "none",
	  .help = "in a window: the picture by method standard beside the one shown, or what both "
		  "differ by" },
	{ .key = "view.split",
	  .type = GZ_OPTION_DOUBLE,
	  .offset = AT(split),
	  .min = 0,
	  .max = 1,
	  .preset = "0.5",
	  .help = "where the standard picture begins, as a share of the width; with split" },
	{ .key = "view.difference_gain",
	  .type = GZ_OPTION_DOUBLE,
	  .offset = AT(difference_gain),
	  .min = 1,
	  .max = GZ_DIFFERENCE_GAIN_MAX,
	  .preset = "8",
	  .help = "how many times the difference is shown; with difference" },
	{ .key = "view.frame_times",
	  .type = GZ_OPTION_BOOL,
	  .offset = AT(frame_times),
	  .preset = "no",
	  .help = "in a window: a plot of what frames cost" },
	SAVED(1),
	SAVED(2),
	SAVED(3),
	SAVED(4),
	SAVED(5),
	SAVED(6),
	SAVED(7),
	SAVED(8),
};
const size_t gz_view_setting_option_count =
	sizeof gz_view_setting_options / sizeof gz_view_setting_options[0];
