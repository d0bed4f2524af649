/**
 * @file
 * How a scene's surfaces are illustrated: the combined settings or the single ones, and what of a
 * shading map a picture shows.
 */
#ifndef GZ_RENDER_ILLUSTRATION_ILLUSTRATION_LOOK_H
#define GZ_RENDER_ILLUSTRATION_ILLUSTRATION_LOOK_H

#include <stdbool.h>
#include <stddef.h>

#include "base/option.h"
#include "base/sizes.h"
#include "render/illustration/shading_settings.h"
#include "render/illustration/shading_template.h"

/** Which settings count. */
enum gz_illustration_source {
	GZ_ILLUSTRATION_COMBINED, /**< the six, and the single ones for which they do not stand */
	GZ_ILLUSTRATION_SINGLE,   /**< the single ones alone */
};

/** What a picture shows. */
enum gz_illustration_show {
	GZ_SHOW_SHADING,         /**< the shading map */
	GZ_SHOW_PLAIN,           /**< the surface under a lamp, without any other step */
	GZ_SHOW_FIRST_PARAMETER, /**< from here on one parameter alone, by the names' order */
};

/** How the shading map is drawn. */
enum gz_illustration_drawing {
	GZ_DRAWING_GREY,     /**< as it is */
	GZ_DRAWING_STIPPLES, /**< by points: stipple_points.h */
	GZ_DRAWING_HATCHES,  /**< by strokes: hatch_lines.h */
};

/** Which way the strokes of hatches run. A second layer crosses them in shadows. */
enum gz_hatch_direction {
	GZ_HATCH_ALONG,  /**< where the surface bends least: along a tube */
	GZ_HATCH_AROUND, /**< where it bends most: around a tube */
};

/** What an object can say of its drawing and of its strokes: "scene", then the names above. */
extern const char *const gz_illustration_said_drawings[];
extern const char *const gz_illustration_said_directions[];

/** Sections [illustration] and [shading_map] of a scene. */
struct gz_illustration_look {
	int source;          /**< enum gz_illustration_source */
	int show;            /**< enum gz_illustration_show, or a parameter */
	int drawing;         /**< enum gz_illustration_drawing */
	int hatch_direction; /**< enum gz_hatch_direction */
	bool automatic;      /**< combined settings follow what is seen: illustration_automatic.h */
	double pen_width;    /**< width of strokes, diameter of points, px */
	char chosen_object[GZ_NAME_SIZE]; /**< from which distances count; empty: none */
	char template_name[GZ_PATH_SIZE]; /**< gz_shading_template_named(), or a file; empty: none
					   */
	struct gz_shading_template shading_template; /**< what it names, once it is found */
	struct gz_illustration_settings combined;
	struct gz_shading_settings single;
};

/** Table over the first members of struct gz_illustration_look: "illustration.…". */
extern const struct gz_option gz_illustration_look_options[];
/** Its rows. */
extern const size_t gz_illustration_look_option_count;

/** The tables of gz_illustration_look_bind(). */
enum gz_illustration_binding {
	GZ_ILLUSTRATION_BINDING_LOOK,
	GZ_ILLUSTRATION_BINDING_COMBINED,
	GZ_ILLUSTRATION_BINDING_SINGLE,
	GZ_ILLUSTRATION_BINDINGS,
};

/** How a look draws an object: grey where it shows one parameter alone. @param said  of the object:
 *  0: as the look says; otherwise one more than enum gz_illustration_drawing */
enum gz_illustration_drawing gz_illustration_look_drawing(const struct gz_illustration_look *look,
							  int said);

/** Whether an object can say these: numbers of the names above. */
bool gz_illustration_said(int drawing, int direction);

/** Bind all tables to @p look, which is borrowed. */
void gz_illustration_look_bind(struct gz_illustration_look *look,
			       struct gz_option_binding out_bindings[GZ_ILLUSTRATION_BINDINGS]);

/** Whether every field is within its range, as the tables would have it. */
bool gz_illustration_look_valid(const struct gz_illustration_look *look);

/** Whether every option has equal values. */
bool gz_illustration_look_same(const struct gz_illustration_look *a,
			       const struct gz_illustration_look *b);

/** Show surfaces under a plain lamp, as grey, whatever the look says. */
void gz_illustration_look_show_plain(struct gz_illustration_look *look);

/**
 * The single settings of an object: what the look's settings make. Templates replace combined
 * settings, that of the look first, then the object's. If one parameter is shown, it is alone over
 * a flat surface, neither equalised nor with any other step.
 *
 * @param of_object  NULL: the object has no template
 */
void gz_illustration_look_resolve(const struct gz_illustration_look *look,
				  const struct gz_shading_template *of_object,
				  struct gz_shading_settings *out_settings);

#endif
