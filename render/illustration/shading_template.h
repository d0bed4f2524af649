/**
 * @file
 * Templates: combined settings that suit a kind of structure (Pfisterer 2007, section 3.3.3 and
 * table 3.1). A template is an INI file:
 *
 *     [template]
 *     title = blood vessels
 *     edge_emphasis = +
 *     detail_amplitude = -
 *     spatial_effect = -
 *
 * `-`, `0` and `+` are small, medium and large values. What a template does not name depends on the
 * model and stays as it is. etc/illustration/ has those of the thesis. A template may name a single
 * setting besides, the weight of edge light, which lifts an object out of the others (figure 3.20).
 */
#ifndef GZ_RENDER_ILLUSTRATION_SHADING_TEMPLATE_H
#define GZ_RENDER_ILLUSTRATION_SHADING_TEMPLATE_H

#include "base/log.h"
#include "base/option.h"
#include "base/result.h"
#include "base/sizes.h"
#include "render/illustration/shading_settings.h"

/** What a template says of one combined setting. */
enum gz_template_level {
	GZ_TEMPLATE_SMALL,  /**< written - : 0 */
	GZ_TEMPLATE_MEDIUM, /**< written 0 : 1/2 */
	GZ_TEMPLATE_LARGE,  /**< written + : 1 */
	GZ_TEMPLATE_KEEP,   /**< written model, or not at all: it depends on the model */
};

/** Weight of edge light that a template's + means, six times the most of a scene's. Chosen by eye:
 *  organs beside each other differ in depth by a few hundredths of the scene's. */
#define GZ_TEMPLATE_EDGE_LIGHT_MOST 6.0

/** A template; the levels are enum gz_template_level. */
struct gz_shading_template {
	char title[GZ_NAME_SIZE]; /**< for people */
	int edge_emphasis, detail_amplitude, detail_frequency, spatial_effect, foreground;
	/** A single setting, whatever spatial_effect makes of it: 0, half of
	 *  GZ_TEMPLATE_EDGE_LIGHT_MOST, or all of it. */
	int edge_light;
};

/** The table of struct gz_shading_template. */
extern const struct gz_option gz_template_options[];
/** Its rows. */
extern const size_t gz_template_option_count;

/**
 * Read a template.
 *
 * @param log  may be NULL
 * @param[out] out_template  written on GZ_OK
 * @retval GZ_ERR_NOT_FOUND  no such file; logged
 * @retval GZ_ERR_IO         the file cannot be read; logged
 * @retval GZ_ERR_FORMAT     an unknown key or a wrong value; logged with file, line and remedy
 * @retval GZ_ERR_NO_MEM     out of memory
 */
enum gz_result gz_shading_template_read(const char *path, const struct gz_log *log,
					struct gz_shading_template *out_template);

/** gz_shading_template_read() of @p size bytes of text; messages call it @p name. */
enum gz_result gz_shading_template_parse(const char *name, const char *text, size_t size,
					 const struct gz_log *log,
					 struct gz_shading_template *out_template);

/** A template that names nothing. */
struct gz_shading_template gz_shading_template_empty(void);

/** The names of gz_shading_template_named(), separated by commas. */
extern const char gz_shading_template_names[];

/** The name with an index, in their order; NULL behind the last one. Static. */
const char *gz_shading_template_name(size_t index);

/**
 * A template of etc/illustration/, which the program holds, by its name without ending.
 *
 * @retval GZ_ERR_NOT_FOUND  there is none; not logged
 */
enum gz_result gz_shading_template_named(const char *name,
					 struct gz_shading_template *out_template);

/** Set the combined settings that a template names. */
void gz_shading_template_apply(const struct gz_shading_template *shading_template,
			       struct gz_illustration_settings *combined);

/** Set the single settings that a template names; after gz_illustration_apply(). */
void gz_shading_template_apply_single(const struct gz_shading_template *shading_template,
				      struct gz_shading_settings *settings);

#endif
