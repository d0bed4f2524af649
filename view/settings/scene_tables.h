/**
 * @file
 * The keys of a scene that can be changed while it is shown: those of its tables that say neither
 * what is shown nor what the display is. The command line takes them, and the panel shows them.
 */
#ifndef GZ_VIEW_SETTINGS_SCENE_TABLES_H
#define GZ_VIEW_SETTINGS_SCENE_TABLES_H

#include "base/option.h"
#include "render/scene/scene.h"

/** Tables whose keys can be changed. */
#define GZ_VIEW_SCENE_TABLES 9

/** Most keys that these tables have together; gz_view_scene_key_count() stays below it. */
#define GZ_VIEW_SCENE_KEYS_MAX 256

/** Filled by gz_view_pick_scene_tables(). */
struct gz_view_scene_tables {
	struct gz_option_binding bindings[GZ_VIEW_SCENE_TABLES]; /**< no flags of what was given */
};

/** The tables over @p settings, borrowed, which must outlive @p out_tables. */
void gz_view_pick_scene_tables(struct gz_scene_settings *settings,
			       struct gz_view_scene_tables *out_tables);

/** How many keys the tables have together. */
size_t gz_view_scene_key_count(const struct gz_view_scene_tables *tables);

#endif
