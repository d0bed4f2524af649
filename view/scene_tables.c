#include "view/scene_tables.h"

#include <string.h>

static bool is_taken(const char *key)
{
	static const char *const others[] = { "volume.", "transfer.", "display." };
	for (size_t i = 0; i < sizeof others / sizeof others[0]; i++)
		if (strncmp(key, others[i], strlen(others[i])) == 0)
			return false;
	return true;
}

void gz_view_pick_scene_tables(struct gz_scene_settings *settings,
			       struct gz_view_scene_tables *out_tables)
{
	gz_scene_bindings(settings, out_tables->bindings, GZ_SCENE_BINDINGS);
	for (size_t i = 0; i < GZ_SCENE_BINDINGS; i++) {
		struct gz_option_binding *binding = &out_tables->bindings[i];
		size_t picked = 0;
		for (size_t k = 0; k < binding->count && picked < GZ_VIEW_SCENE_KEYS_MAX; k++)
			if (is_taken(binding->options[k].key))
				out_tables->options[i][picked++] = binding->options[k];
		binding->options = out_tables->options[i];
		binding->count = picked;
	}
}
