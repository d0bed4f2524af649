#include "view/settings/scene_tables.h"

static const enum gz_scene_table picked[GZ_VIEW_SCENE_TABLES] = {
	GZ_SCENE_CAMERA,    GZ_SCENE_IMAGE,     GZ_SCENE_RAYS,     GZ_SCENE_LIGHT, GZ_SCENE_CLIP,
	GZ_SCENE_FOVEATION, GZ_SCENE_ATTENTION, GZ_SCENE_TEMPORAL, GZ_SCENE_VIEW,
};

void gz_view_pick_scene_tables(struct gz_scene_settings *settings,
			       struct gz_view_scene_tables *out_tables)
{
	struct gz_option_binding all[GZ_SCENE_TABLE_COUNT];
	gz_scene_bind(settings, all);
	for (size_t i = 0; i < GZ_VIEW_SCENE_TABLES; i++)
		out_tables->bindings[i] = all[picked[i]];
}

size_t gz_view_scene_key_count(const struct gz_view_scene_tables *tables)
{
	size_t count = 0;
	for (size_t i = 0; i < GZ_VIEW_SCENE_TABLES; i++)
		count += tables->bindings[i].count;
	return count;
}
