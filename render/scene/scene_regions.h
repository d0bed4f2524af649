/**
 * @file
 * Regions of labels that are shown in a way of their own: sections [region 1] to [region 128] of a
 * scene. Each names a label of an object. The sections are numbered so that settings always have
 * the same keys.
 */
#ifndef GZ_RENDER_SCENE_SCENE_REGIONS_H
#define GZ_RENDER_SCENE_SCENE_REGIONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/option.h"
#include "base/result.h"
#include "base/sizes.h"
#include "render/scene/scene_objects.h"

/** Most regions of a scene with a way of their own. Chosen: all of an atlas of the brain. */
#define GZ_SCENE_REGIONS_MAX 128

/** One region. */
struct gz_scene_region {
	char object[GZ_SCENE_SECTION_SIZE]; /**< name of the object; empty: the section is not used
					     */
	int label;                          /**< number of the label */
	bool visible;
	struct gz_object_style style;
	char template_name[GZ_NAME_SIZE]; /**< as of struct gz_scene_object; empty: none */
	struct gz_shading_template shading_template; /**< what it names, once it is found */
};

/** All regions of a scene. Set it by gz_scene_regions_preset(). */
struct gz_scene_regions {
	struct gz_scene_region items[GZ_SCENE_REGIONS_MAX];
};

/** Options of a region. */
#define GZ_SCENE_REGION_OPTIONS 8

/** Table over struct gz_scene_region. Its keys are "region.<name>"; those of one region are
 *  "region NUMBER.<name>". */
extern const struct gz_option gz_scene_region_options[GZ_SCENE_REGION_OPTIONS];

/** The table of one region, under its own keys. */
struct gz_scene_region_table {
	struct gz_option options[GZ_SCENE_REGION_OPTIONS];
	char keys[GZ_SCENE_REGION_OPTIONS][32];
};

/** Set every section to its presets: it is not used. */
void gz_scene_regions_preset(struct gz_scene_regions *out_regions);

/** Fill @p table with the options of section @p index (from 0), under its own keys. The binding
 *  borrows both. */
struct gz_option_binding gz_scene_region_bind(struct gz_scene_region *region, size_t index,
					      struct gz_scene_region_table *table);

/** The region that is a label of an object; NULL: it is shown as the object. Borrowed. */
const struct gz_scene_region *gz_scene_region_of(const struct gz_scene_regions *regions,
						 const struct gz_scene_object *object,
						 int32_t label);

/**
 * The region that is a label of an object. If there is none, an unused section becomes it, with
 * what the object says.
 *
 * @return NULL if all sections are used; else borrowed from @p regions
 */
struct gz_scene_region *gz_scene_region_take(struct gz_scene_regions *regions,
					     const struct gz_scene_object *object, int32_t label);

/** Whether both have the same regions with equal values. */
bool gz_scene_regions_same(const struct gz_scene_regions *a, const struct gz_scene_regions *b);

#endif
