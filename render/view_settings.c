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
};
const size_t gz_view_setting_option_count =
	sizeof gz_view_setting_options / sizeof gz_view_setting_options[0];
