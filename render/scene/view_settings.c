#include "render/scene/view_settings.h"

#include <ctype.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"

#define GZ_LOG_MODULE "scene"

const char *const gz_view_overlay_names[] = { "none", "spacing", "step", NULL };

const char *const gz_view_compare_names[] = { "none", "split", "difference", NULL };

const char *const gz_view_compare_with_names[] = { "standard", "plain", NULL };

const char *const gz_view_layout_names[] = { "picture", "slices", NULL };

const char *const gz_view_follows_names[] = { "none", "mouse", "gaze", NULL };

#define AT(field) offsetof(struct gz_view_settings, field)

#define SAVED(number)                                                                    \
	{                                                                                \
		"views." #number, GZ_OPTION_STRING, AT(saved[(number)-1]),               \
			.max = GZ_SAVED_VIEW_SIZE, .preset = "",                         \
			.help = "view on F" #number                                      \
				": eye X Y Z look_at X Y Z up X Y Z, then fov_deg F or " \
				"height H"                                               \
	}

const struct gz_option gz_view_setting_options[] = {
	{ "view.gaze_cursor", GZ_OPTION_BOOL, AT(gaze_cursor), .preset = "no",
	  .help = "a cross at the gaze point" },
	{ "view.letters", GZ_OPTION_BOOL, AT(letters), .preset = "no",
	  .help = "letters at the picture's edges for the body's sides: R L A P S I" },
	{ "view.overlay", GZ_OPTION_CHOICE, AT(overlay), .choices = gz_view_overlay_names,
	  .preset = "none", .help = "window: tint the plan's tiles by ray spacing or step length" },
	{ "view.trail", GZ_OPTION_BOOL, AT(trail), .preset = "no",
	  .help = "window: the gaze of the last second" },
	{ "view.vsync", GZ_OPTION_BOOL, AT(vsync), .preset = "yes",
	  .help = "window: wait for the display's refresh" },
	{ "view.gaze", GZ_OPTION_STRING, AT(gaze), .max = GZ_PATH_SIZE,
	  .help = "window: source of the gaze, as for --gaze; without it the source stays" },
	{ "view.tracker_display", GZ_OPTION_STRING, AT(tracker_display), .max = GZ_NAME_SIZE,
	  .help = "monitor of the tracker's gaze, by its name or number from 1; without it the one "
		  "that the daemon describes, else the window's" },
	{ "view.compare", GZ_OPTION_CHOICE, AT(compare), .choices = gz_view_compare_names,
	  .preset = "none",
	  .help = "the picture by method standard beside the present one, or their difference" },
	{ "view.compare_with", GZ_OPTION_CHOICE, AT(compare_with),
	  .choices = gz_view_compare_with_names, .preset = "standard",
	  .help = "illustrations: what is beside them, method standard or the surfaces under a "
		  "plain lamp" },
	{ "view.split", GZ_OPTION_DOUBLE, AT(split), 0, 1, .preset = "0.5",
	  .help = "split: where the standard picture begins, as a fraction of the width" },
	{ "view.difference_gain", GZ_OPTION_DOUBLE, AT(difference_gain), 1, GZ_DIFFERENCE_GAIN_MAX,
	  .preset = "8", .help = "difference: factor by which it is amplified" },
	{ "view.frame_times", GZ_OPTION_BOOL, AT(frame_times), .preset = "no",
	  .help = "window: a plot of the frame times" },
	{ "view.gaze_mark", GZ_OPTION_BOOL, AT(gaze_mark), .preset = "yes",
	  .help = "window: a circle at the gaze in comparisons" },
	{ "view.refine", GZ_OPTION_BOOL, AT(refine), .preset = "yes",
	  .help = "window: full quality everywhere once camera and gaze rest for half a second" },
	{ "view.layout", GZ_OPTION_CHOICE, AT(layout), .choices = gz_view_layout_names,
	  .preset = "picture",
	  .help = "window: the picture alone, or beside axial, coronal and sagittal slices" },
	{ "view.crosshair", GZ_OPTION_DOUBLE, AT(crosshair), 0, 1, 3, .preset = "0.5 0.5 0.5",
	  .help = "where slices lie, as fractions of the box along x y z" },
	{ "view.crosshair_follows", GZ_OPTION_CHOICE, AT(crosshair_follows),
	  .choices = gz_view_follows_names, .preset = "none",
	  .help = "what moves the crosshair of slices besides clicks: a mouse over a slice, or a "
		  "gaze that rests there" },
	{ "view.slice_colours", GZ_OPTION_BOOL, AT(slice_colours), .preset = "no",
	  .help = "slices: colours of the transfer function over the grey" },
	{ "view.slice_level", GZ_OPTION_DOUBLE, AT(slice_level), -GZ_SLICE_VALUE_MAX,
	  GZ_SLICE_VALUE_MAX, .preset = "0",
	  .help = "slices: value shown as middle grey, if slice_width is above 0" },
	{ "view.slice_width", GZ_OPTION_DOUBLE, AT(slice_width), 0, GZ_SLICE_VALUE_MAX,
	  .preset = "0",
	  .help = "slices: values from black to white; 0 takes level and width from the volume" },
	{ "view.distances", GZ_OPTION_STRING, AT(distances), .max = GZ_DISTANCES_SIZE, .preset = "",
	  .help = "lines measured in slices: x y z of either end, as fractions of the box; up to "
		  "eight lines" },
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

static size_t print_view_number(char *text, size_t used, double number)
{
	char shortest[GZ_NUMBER_SIZE];
	gz_number_print(number, shortest);
	return used + (size_t)snprintf(text + used, GZ_SAVED_VIEW_SIZE - used, " %s", shortest);
}

static size_t print_view_place(char *text, size_t used, const char *word, const double place[3])
{
	used += (size_t)snprintf(text + used, GZ_SAVED_VIEW_SIZE - used, "%s%s", used ? " " : "",
				 word);
	for (int i = 0; i < 3; i++)
		used = print_view_number(text, used, place[i]);
	return used;
}

void gz_saved_view_print(const struct gz_camera *camera, char out_text[GZ_SAVED_VIEW_SIZE])
{
	const bool parallel = camera->projection == GZ_PROJECTION_ORTHOGRAPHIC;
	size_t used = print_view_place(out_text, 0, "eye", camera->eye);
	used = print_view_place(out_text, used, "look_at", camera->look_at);
	used = print_view_place(out_text, used, "up", camera->up);
	used += (size_t)snprintf(out_text + used, GZ_SAVED_VIEW_SIZE - used, " %s",
				 parallel ? "height" : "fov_deg");
	print_view_number(out_text, used, parallel ? camera->height : camera->fov_deg);
}

static void skip_blanks(const char **text)
{
	while (isspace((unsigned char)**text))
		(*text)++;
}

/* Whether the text goes on with this word and a blank; moves *text past the word. */
static bool take_word(const char **text, const char *word)
{
	const size_t length = strlen(word);
	skip_blanks(text);
	if (strncmp(*text, word, length) != 0 || !isspace((unsigned char)(*text)[length]))
		return false;
	*text += length;
	return true;
}

static bool take_number(const char **text, double *out_number)
{
	char *end;
	*out_number = strtod(*text, &end);
	const bool whole = end != *text && (!*end || isspace((unsigned char)*end));
	*text = end;
	return whole;
}

static bool take_place(const char **text, const char *word, double out_place[3])
{
	return take_word(text, word) && take_number(text, &out_place[0]) &&
	       take_number(text, &out_place[1]) && take_number(text, &out_place[2]);
}

static bool take_projection(const char **text, struct gz_camera *camera)
{
	if (take_word(text, "fov_deg")) {
		camera->projection = GZ_PROJECTION_PERSPECTIVE;
		return take_number(text, &camera->fov_deg);
	}
	camera->projection = GZ_PROJECTION_ORTHOGRAPHIC;
	return take_word(text, "height") && take_number(text, &camera->height);
}

enum gz_result gz_saved_view_parse(const char *text, struct gz_camera *camera)
{
	struct gz_camera read = *camera;
	struct gz_ray_frame rays;
	if (!take_place(&text, "eye", read.eye) || !take_place(&text, "look_at", read.look_at) ||
	    !take_place(&text, "up", read.up) || !take_projection(&text, &read))
		return GZ_ERR_FORMAT;
	skip_blanks(&text);
	if (*text || gz_camera_rays(&read, 1, 1, &rays) != GZ_OK)
		return GZ_ERR_FORMAT;
	*camera = read;
	return GZ_OK;
}

enum gz_result gz_saved_views_check(const char views[GZ_SAVED_VIEWS][GZ_SAVED_VIEW_SIZE],
				    const char *name, const struct gz_log *log)
{
	for (int i = 0; i < GZ_SAVED_VIEWS; i++) {
		struct gz_camera camera = { .fov_deg = 1, .height = 1 };
		if (!views[i][0] || gz_saved_view_parse(views[i], &camera) == GZ_OK)
			continue;
		gz_err(log,
		       "%s: views.%d: not a view; write eye X Y Z look_at X Y Z up X Y Z fov_deg "
		       "F, or "
		       "height H at the end; eye and look_at must differ",
		       name, i + 1);
		return GZ_ERR_FORMAT;
	}
	return GZ_OK;
}
