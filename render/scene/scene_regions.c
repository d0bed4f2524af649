#include "render/scene/scene_regions.h"

#include <limits.h>
#include <stdio.h>
#include <string.h>

#include "render/illustration/illustration_look.h"

#define AT(field) offsetof(struct gz_scene_region, field)

const struct gz_option gz_scene_region_options[GZ_SCENE_REGION_OPTIONS] = {
	{ "region.object", GZ_OPTION_STRING, AT(object), .max = GZ_SCENE_SECTION_SIZE, .preset = "",
	  .help = "name of the object of labels" },
	{ "region.label", GZ_OPTION_INT, AT(label), INT_MIN, INT_MAX, .preset = "0",
	  .help = "number of the label" },
	{ "region.visible", GZ_OPTION_BOOL, AT(visible), .preset = "yes",
	  .help = "whether the region is shown, if its object is" },
	{ "region.importance", GZ_OPTION_DOUBLE, AT(style.importance), 0, 1, .preset = "0.5",
	  .help = "importance of the region in illustrations, 0 to 1" },
	{ "region.transparency", GZ_OPTION_DOUBLE, AT(style.transparency), 0, 1, .preset = "0",
	  .help = "how much of what is behind the region shows in illustrations, 0 to 1" },
	{ "region.drawing", GZ_OPTION_CHOICE, AT(style.drawing),
	  .choices = gz_illustration_said_drawings, .preset = "scene",
	  .help = "how illustrations draw the region; scene: as illustration.drawing says" },
	{ "region.hatch_direction", GZ_OPTION_CHOICE, AT(style.hatch_direction),
	  .choices = gz_illustration_said_directions, .preset = "scene",
	  .help = "hatches: strokes run along the region's ridges, or around them; scene: as "
		  "illustration.hatch_direction says" },
	{ "region.template", GZ_OPTION_STRING, AT(template_name), .max = GZ_NAME_SIZE, .preset = "",
	  .help = "template of illustrative settings: a name, or a file, searched as volume.file "
		  "is" },
};

void gz_scene_regions_preset(struct gz_scene_regions *out_regions)
{
	struct gz_scene_region preset = { 0 };
	const struct gz_option_binding binding = { gz_scene_region_options, GZ_SCENE_REGION_OPTIONS,
						   &preset, NULL };
	/* Tests check that every preset parses. */
	(void)gz_options_preset(&binding);
	for (size_t i = 0; i < GZ_SCENE_REGIONS_MAX; i++)
		out_regions->items[i] = preset;
}

struct gz_option_binding gz_scene_region_bind(struct gz_scene_region *region, size_t index,
					      struct gz_scene_region_table *table)
{
	for (size_t i = 0; i < GZ_SCENE_REGION_OPTIONS; i++) {
		table->options[i] = gz_scene_region_options[i];
		snprintf(table->keys[i], sizeof table->keys[i], "region %u%s", (unsigned)index + 1,
			 strchr(gz_scene_region_options[i].key, '.'));
		table->options[i].key = table->keys[i];
	}
	return (struct gz_option_binding) { table->options, GZ_SCENE_REGION_OPTIONS, region, NULL };
}

const struct gz_scene_region *gz_scene_region_of(const struct gz_scene_regions *regions,
						 const struct gz_scene_object *object,
						 int32_t label)
{
	for (size_t i = 0; i < GZ_SCENE_REGIONS_MAX; i++) {
		const struct gz_scene_region *item = &regions->items[i];
		if (item->object[0] && item->label == label &&
		    strcmp(item->object, gz_scene_object_name(object)) == 0)
			return item;
	}
	return NULL;
}

struct gz_scene_region *gz_scene_region_take(struct gz_scene_regions *regions,
					     const struct gz_scene_object *object, int32_t label)
{
	const struct gz_scene_region *known = gz_scene_region_of(regions, object, label);
	if (known)
		return &regions->items[known - regions->items];
	for (size_t i = 0; i < GZ_SCENE_REGIONS_MAX; i++) {
		struct gz_scene_region *item = &regions->items[i];
		if (item->object[0])
			continue;
		*item = (struct gz_scene_region) {
			.label = label,
			.visible = true,
			.style = object->style,
		};
		snprintf(item->object, sizeof item->object, "%s", gz_scene_object_name(object));
		/* A longer name is that of a file, and the region begins without a template. */
		if (strlen(object->template_name) < sizeof item->template_name) {
			memcpy(item->template_name, object->template_name,
			       strlen(object->template_name) + 1);
			item->shading_template = object->shading_template;
		}
		return item;
	}
	return NULL;
}

bool gz_scene_regions_same(const struct gz_scene_regions *a, const struct gz_scene_regions *b)
{
	for (size_t i = 0; i < GZ_SCENE_REGIONS_MAX; i++) {
		const struct gz_scene_region *one = &a->items[i], *other = &b->items[i];
		/* Most sections are not used. */
		if (!one->object[0] && !other->object[0])
			continue;
		if (!gz_options_same(gz_scene_region_options, GZ_SCENE_REGION_OPTIONS, one, other))
			return false;
	}
	return true;
}
