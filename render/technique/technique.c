#include "render/technique/technique.h"

#include <string.h>

const struct gz_object_style gz_object_style_plain = { .importance = 0.5, .transparency = 0 };

bool gz_technique_has_backend(const struct gz_technique *technique, const char *name)
{
	for (size_t i = 0; technique->backends[i]; i++)
		if (strcmp(technique->backends[i], name) == 0)
			return true;
	return false;
}

void gz_drawer_destroy(struct gz_drawer **drawer)
{
	if (*drawer)
		(*drawer)->ops->destroy(*drawer);
	*drawer = NULL;
}

bool gz_technique_settings_same(const struct gz_technique *technique, const void *a, const void *b)
{
	struct gz_option_binding of_a[GZ_TECHNIQUE_BINDINGS_MAX], of_b[GZ_TECHNIQUE_BINDINGS_MAX];
	/* Bindings can set what they are bound to; here they only read. */
	const size_t count = technique->bind((void *)a, of_a, GZ_TECHNIQUE_BINDINGS_MAX);
	technique->bind((void *)b, of_b, GZ_TECHNIQUE_BINDINGS_MAX);
	for (size_t i = 0; i < count; i++)
		if (!gz_options_same(of_a[i].options, of_a[i].count, of_a[i].target,
				     of_b[i].target))
			return false;
	return true;
}

uint32_t gz_pick_most_seen(const struct gz_pick *pick)
{
	size_t most = 0;
	for (size_t i = 1; i < pick->count; i++)
		if (pick->shares[i] > pick->shares[most])
			most = i;
	return pick->count > 0 ? pick->ids[most] : 0;
}
