#include "render/illustration/shading_template.h"

#include <stddef.h>
#include <string.h>

#define AT(field) offsetof(struct gz_shading_template, field)

static const char *const level_names[] = { "-", "0", "+", "model", NULL };

const struct gz_option gz_template_options[] = {
	{ "template.title", GZ_OPTION_STRING, AT(title), .max = GZ_NAME_SIZE, .preset = "",
	  .help = "what it is for" },
	{ "template.edge_emphasis", GZ_OPTION_CHOICE, AT(edge_emphasis), .choices = level_names,
	  .preset = "model", .help = "how much the edges of objects stand out" },
	{ "template.detail_amplitude", GZ_OPTION_CHOICE, AT(detail_amplitude),
	  .choices = level_names, .preset = "model", .help = "how strong details are" },
	{ "template.detail_frequency", GZ_OPTION_CHOICE, AT(detail_frequency),
	  .choices = level_names, .preset = "model", .help = "which details show: + fine ones" },
	{ "template.spatial_effect", GZ_OPTION_CHOICE, AT(spatial_effect), .choices = level_names,
	  .preset = "model", .help = "how much depth shows" },
	{ "template.foreground", GZ_OPTION_CHOICE, AT(foreground), .choices = level_names,
	  .preset = "model", .help = "how far the foreground reaches" },
	{ "template.edge_light", GZ_OPTION_CHOICE, AT(edge_light), .choices = level_names,
	  .preset = "model", .help = "weight of edge light, instead of that of spatial_effect" },
};
const size_t gz_template_option_count = sizeof gz_template_options / sizeof gz_template_options[0];

/* A template that names nothing. */
static enum gz_result begin_template(struct gz_shading_template *empty,
				     struct gz_option_binding *out_binding)
{
	*empty = (struct gz_shading_template) { 0 };
	*out_binding = (struct gz_option_binding) { gz_template_options, gz_template_option_count,
						    empty, NULL };
	return gz_options_preset(out_binding);
}

enum gz_result gz_shading_template_read(const char *path, const struct gz_log *log,
					struct gz_shading_template *out_template)
{
	struct gz_shading_template read;
	struct gz_option_binding binding;
	enum gz_result result = begin_template(&read, &binding);
	if (result == GZ_OK)
		result = gz_options_read_file(&binding, 1, path, log);
	if (result == GZ_OK)
		*out_template = read;
	return result;
}

enum gz_result gz_shading_template_parse(const char *name, const char *text, size_t size,
					 const struct gz_log *log,
					 struct gz_shading_template *out_template)
{
	struct gz_shading_template read;
	struct gz_option_binding binding;
	enum gz_result result = begin_template(&read, &binding);
	if (result == GZ_OK)
		result = gz_options_read_text(&binding, 1, name, text, size, log);
	if (result == GZ_OK)
		*out_template = read;
	return result;
}

struct gz_shading_template gz_shading_template_empty(void)
{
	struct gz_shading_template empty;
	struct gz_option_binding binding;
	(void)begin_template(&empty, &binding);
	return empty;
}

extern const char gz_template_bone_structures_template[], gz_template_highlight_template[],
	gz_template_information_template[], gz_template_organs_template[],
	gz_template_single_bones_template[], gz_template_vessel_trees_template[],
	gz_template_vessels_template[], gz_template_whole_scene_template[];

/* The files of etc/illustration/, as they were when the program was built. */
static const struct {
	const char *name, *text;
} named_templates[] = {
	{ "bone-structures", gz_template_bone_structures_template },
	{ "highlight", gz_template_highlight_template },
	{ "information", gz_template_information_template },
	{ "organs", gz_template_organs_template },
	{ "single-bones", gz_template_single_bones_template },
	{ "vessel-trees", gz_template_vessel_trees_template },
	{ "vessels", gz_template_vessels_template },
	{ "whole-scene", gz_template_whole_scene_template },
};

const char gz_shading_template_names[] =
	"bone-structures, highlight, information, organs, single-bones, vessel-trees, vessels, "
	"whole-scene";

const char *gz_shading_template_name(size_t index)
{
	return index < sizeof named_templates / sizeof named_templates[0]
		       ? named_templates[index].name
		       : NULL;
}

enum gz_result gz_shading_template_named(const char *name, struct gz_shading_template *out_template)
{
	for (size_t i = 0; i < sizeof named_templates / sizeof named_templates[0]; i++)
		if (strcmp(named_templates[i].name, name) == 0)
			return gz_shading_template_parse(name, named_templates[i].text,
							 strlen(named_templates[i].text), NULL,
							 out_template);
	return GZ_ERR_NOT_FOUND;
}

static void apply_level(int level, double *value)
{
	if (level != GZ_TEMPLATE_KEEP)
		*value = level / 2.0;
}

void gz_shading_template_apply(const struct gz_shading_template *shading_template,
			       struct gz_illustration_settings *combined)
{
	apply_level(shading_template->edge_emphasis, &combined->edge_emphasis);
	apply_level(shading_template->detail_amplitude, &combined->detail_amplitude);
	apply_level(shading_template->detail_frequency, &combined->detail_frequency);
	apply_level(shading_template->spatial_effect, &combined->spatial_effect);
	apply_level(shading_template->foreground, &combined->foreground);
}

void gz_shading_template_apply_single(const struct gz_shading_template *shading_template,
				      struct gz_shading_settings *settings)
{
	if (shading_template->edge_light != GZ_TEMPLATE_KEEP)
		settings->edge_light =
			GZ_TEMPLATE_EDGE_LIGHT_MOST * shading_template->edge_light / 2.0;
}
