#include "bench/comparison/effects.h"

#include "render/raycast/shared/ray_params.h"

/* Steps of a shadow through a volume. Chosen: twice the 8 of the Dutch comparison's in-scattering,
 * because fewer leave visible bands. */
#define SHADOW_STEPS "16"

/* clang-format off */
#define MATTE { "isosurface.material", "matte" }
#define NO_REFLECTION { "light.reflection", "0" }, { "environment.kind", "none" }, MATTE
#define REFLECTION { "light.reflection", "0.25" }, { "environment.kind", "sky" }, MATTE
#define GLASS { "isosurface.material", "glass" }, { "environment.kind", "sky" }
#define NO_SHADOW { "isosurface.shadows", "no" }, { "light.shadow_steps", "0" }
#define SHADOW { "isosurface.shadows", "yes" }, { "light.shadow_steps", SHADOW_STEPS }

const struct gz_effect gz_effects[GZ_EFFECT_COUNT] = {
	{ "none", "no effect", NULL, { NO_REFLECTION, NO_SHADOW, { NULL, NULL } } },
	{ "reflection", "reflection", NULL, { REFLECTION, NO_SHADOW, { NULL, NULL } } },
	{ "shadow", "shadow", NULL, { NO_REFLECTION, SHADOW, { NULL, NULL } } },
	{ "both", "reflection and shadow", NULL, { REFLECTION, SHADOW, { NULL, NULL } } },
	{ "glass",
	  "reflection and refraction of glass",
	  "isosurface.material",
	  { GLASS, NO_SHADOW, { NULL, NULL } } },
};
/* clang-format on */

static const struct gz_option *find_key(const struct gz_technique *technique, void *settings,
					const char *key, void **out_target)
{
	struct gz_option_binding bindings[GZ_TECHNIQUE_BINDINGS_MAX];
	size_t which = 0;
	const size_t count = technique->bind(settings, bindings, GZ_TECHNIQUE_BINDINGS_MAX);
	const struct gz_option *option = gz_options_find(bindings, count, key, &which);
	if (option)
		*out_target = bindings[which].target;
	return option;
}

bool gz_technique_has_key(const struct gz_technique *technique, const char *key)
{
	struct gz_ray_params settings; /* the one struct that techniques have */
	void *target;
	return technique->settings_size == sizeof settings &&
	       find_key(technique, &settings, key, &target) != NULL;
}

enum gz_result gz_technique_set(const struct gz_technique *technique, void *settings,
				const char *key, const char *value)
{
	void *target = NULL;
	const struct gz_option *option = find_key(technique, settings, key, &target);
	return option ? gz_option_parse(option, value, target, NULL, 0) : GZ_OK;
}

enum gz_result gz_effect_apply(const struct gz_effect *effect, const struct gz_technique *technique,
			       void *settings)
{
	enum gz_result result = GZ_OK;
	for (int i = 0; effect->settings[i].key && result == GZ_OK; i++)
		result = gz_technique_set(technique, settings, effect->settings[i].key,
					  effect->settings[i].value);
	return result;
}
