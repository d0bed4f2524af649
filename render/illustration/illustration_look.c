#include "render/illustration/illustration_look.h"

#include <string.h>

static const char *const source_names[] = { "combined", "single", NULL };

/* In the order of alone[] below. */
static const char *const show_names[] = {
	"shading",    "plain",          "main-light", "plateau-light",   "grazing-light",
	"shape",      "curvature",      "importance", "viewer-distance", "object-distance",
	"edge-light", "overlap-shadow", "haze",       "lines",           NULL,
};

/* In the order of enum gz_illustration_drawing. */
static const char *const drawing_names[] = { "grey", "stipples", "hatches", NULL };

/* In the order of enum gz_hatch_direction. */
static const char *const direction_names[] = { "along", "around", NULL };

const char *const gz_illustration_said_drawings[] = { "scene", "grey", "stipples", "hatches",
						      NULL };
const char *const gz_illustration_said_directions[] = { "scene", "along", "around", NULL };

#define AT(field) offsetof(struct gz_illustration_look, field)

const struct gz_option gz_illustration_look_options[] = {
	{ "illustration.show", GZ_OPTION_CHOICE, AT(show), .choices = show_names,
	  .preset = "shading",
	  .help = "the shading map, the surface under a plain lamp, or one parameter alone" },
	{ "illustration.drawing", GZ_OPTION_CHOICE, AT(drawing), .choices = drawing_names,
	  .preset = "grey",
	  .help = "how the shading map is drawn: as grey, by points, or by strokes" },
	{ "illustration.hatch_direction", GZ_OPTION_CHOICE, AT(hatch_direction),
	  .choices = direction_names, .preset = "along",
	  .help = "hatches: strokes run along tubes and ridges, or around them" },
	{ "illustration.pen_width", GZ_OPTION_DOUBLE, AT(pen_width), 0.5, 64, .preset = "2",
	  .help = "stipples, hatches: width of strokes and diameter of points where one looks, "
		  "px" },
	{ "illustration.settings", GZ_OPTION_CHOICE, AT(source), .choices = source_names,
	  .preset = "combined",
	  .help = "which settings count: the six combined ones, or the single ones of "
		  "[shading_map]" },
	{ "illustration.template", GZ_OPTION_STRING, AT(template_name), .max = GZ_PATH_SIZE,
	  .preset = "",
	  .help = "template that replaces combined settings: a name, or a file beside the scene or "
		  "under $GAZECAST_DATA" },
	{ "illustration.automatic", GZ_OPTION_BOOL, AT(automatic), .preset = "no",
	  .help = "let the combined settings follow what each view shows, a little" },
	{ "illustration.chosen_object", GZ_OPTION_STRING, AT(chosen_object), .max = GZ_NAME_SIZE,
	  .preset = "", .help = "name of the object or label from which distances count" },
};
const size_t gz_illustration_look_option_count =
	sizeof gz_illustration_look_options / sizeof gz_illustration_look_options[0];

void gz_illustration_look_bind(struct gz_illustration_look *look,
			       struct gz_option_binding out_bindings[GZ_ILLUSTRATION_BINDINGS])
{
	out_bindings[GZ_ILLUSTRATION_BINDING_LOOK] =
		(struct gz_option_binding) { gz_illustration_look_options,
					     gz_illustration_look_option_count, look, NULL };
	out_bindings[GZ_ILLUSTRATION_BINDING_COMBINED] =
		(struct gz_option_binding) { gz_illustration_options, gz_illustration_option_count,
					     &look->combined, NULL };
	out_bindings[GZ_ILLUSTRATION_BINDING_SINGLE] =
		(struct gz_option_binding) { gz_shading_options, gz_shading_option_count,
					     &look->single, NULL };
}

bool gz_illustration_look_valid(const struct gz_illustration_look *look)
{
	return gz_options_hold(gz_illustration_look_options, gz_illustration_look_option_count,
			       look) &&
	       gz_options_hold(gz_illustration_options, gz_illustration_option_count,
			       &look->combined) &&
	       gz_options_hold(gz_shading_options, gz_shading_option_count, &look->single);
}

bool gz_illustration_look_same(const struct gz_illustration_look *a,
			       const struct gz_illustration_look *b)
{
	return gz_options_same(gz_illustration_look_options, gz_illustration_look_option_count, a,
			       b) &&
	       gz_options_same(gz_illustration_options, gz_illustration_option_count, &a->combined,
			       &b->combined) &&
	       gz_options_same(gz_shading_options, gz_shading_option_count, &a->single, &b->single);
}

enum gz_illustration_drawing gz_illustration_look_drawing(const struct gz_illustration_look *look,
							  int said)
{
	const int drawing = said > 0 ? said - 1 : look->drawing;
	return look->show == GZ_SHOW_SHADING ? (enum gz_illustration_drawing)drawing
					     : GZ_DRAWING_GREY;
}

void gz_illustration_look_show_plain(struct gz_illustration_look *look)
{
	look->show = GZ_SHOW_PLAIN;
	look->drawing = GZ_DRAWING_GREY;
}

bool gz_illustration_said(int drawing, int direction)
{
	return drawing >= 0 && drawing <= 1 + (int)GZ_DRAWING_HATCHES && direction >= 0 &&
	       direction <= 1 + (int)GZ_HATCH_AROUND;
}

#define WEIGHT(field) offsetof(struct gz_shading_settings, field)

/* The weight of what is shown alone, and the brightness that the parameter changes: light is added
 * to black, shadow and lines are taken from white. */
static const struct {
	size_t weight;
	double flat;
} alone[] = {
	{ WEIGHT(plain_light), 0 },     { WEIGHT(main_light), 0 },
	{ WEIGHT(plateau_light), 0 },   { WEIGHT(grazing_light), 0 },
	{ WEIGHT(surface_shape), 0 },   { WEIGHT(curvature), 0 },
	{ WEIGHT(importance), 0 },      { WEIGHT(viewer_distance), 0 },
	{ WEIGHT(object_distance), 0 }, { WEIGHT(edge_light), 0 },
	{ WEIGHT(overlap_shadow), 1 },  { WEIGHT(haze), 0 },
	{ WEIGHT(lines), 1 },
};

enum { ALONE = sizeof alone / sizeof alone[0] };

_Static_assert(sizeof show_names / sizeof show_names[0] == 1 + ALONE + 1,
	       "a name for each, after the map and before the end");

static void set_weight(struct gz_shading_settings *settings, size_t which, double weight)
{
	memcpy((char *)settings + alone[which].weight, &weight, sizeof weight);
}

void gz_illustration_look_resolve(const struct gz_illustration_look *look,
				  const struct gz_shading_template *of_object,
				  struct gz_shading_settings *out_settings)
{
	*out_settings = look->single;
	if (look->source == GZ_ILLUSTRATION_COMBINED) {
		struct gz_illustration_settings combined = look->combined;
		if (look->template_name[0])
			gz_shading_template_apply(&look->shading_template, &combined);
		if (of_object)
			gz_shading_template_apply(of_object, &combined);
		gz_illustration_apply(&combined, out_settings);
		if (look->template_name[0])
			gz_shading_template_apply_single(&look->shading_template, out_settings);
		if (of_object)
			gz_shading_template_apply_single(of_object, out_settings);
	}
	if (look->show == GZ_SHOW_SHADING)
		return;
	for (size_t i = 0; i < ALONE; i++)
		set_weight(out_settings, i, 0);
	set_weight(out_settings, (size_t)look->show - GZ_SHOW_PLAIN, 1);
	out_settings->flat = alone[look->show - GZ_SHOW_PLAIN].flat;
	out_settings->equalisation = 0;
	out_settings->haze_background = 1;
}
