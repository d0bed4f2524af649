/**
 * @file
 * The scene keys that can change while a scene is shown: those of the tables that name neither the
 * data nor the display. The command line accepts them and the settings panel shows them.
 */
#ifndef GZ_VIEW_SETTINGS_SCENE_KEYS_H
#define GZ_VIEW_SETTINGS_SCENE_KEYS_H

#include <stdbool.h>
#include <stddef.h>

#include "base/option.h"
#include "render/scene/scene.h"

/** Number of tables whose keys can change. */
#define GZ_VIEW_SCENE_TABLES 16

/** Upper limit of the number of keys in these tables; gz_view_scene_key_count() stays below it. */
#define GZ_VIEW_SCENE_KEYS_MAX 256

/** The tables. gz_view_pick_scene_tables() fills them. */
struct gz_view_scene_tables {
	struct gz_option_binding bindings[GZ_VIEW_SCENE_TABLES]; /**< given is NULL */
};

/** Bind the tables to @p settings, which is borrowed and must outlive @p out_tables. */
void gz_view_pick_scene_tables(struct gz_scene_settings *settings,
			       struct gz_view_scene_tables *out_tables);

/** Most tables of struct gz_view_live_tables. */
#define GZ_VIEW_LIVE_TABLES_MAX (GZ_VIEW_SCENE_TABLES + GZ_SCENE_REGIONS_MAX + GZ_SCENE_OBJECTS_MAX)

/** All that can change while a scene is shown: the tables of struct gz_view_scene_tables first,
 *  then those of regions, then what objects are shown by. */
struct gz_view_live_tables {
	struct gz_option_binding bindings[GZ_VIEW_LIVE_TABLES_MAX]; /**< given is NULL */
	size_t count;
	struct gz_scene_region_table regions[GZ_SCENE_REGIONS_MAX];
	struct gz_scene_object_table objects[GZ_SCENE_OBJECTS_MAX];
};

/** Bind all tables to @p settings, which is borrowed and must outlive @p out_tables. Call it again
 *  when the settings have other objects. */
void gz_view_pick_live_tables(struct gz_scene_settings *settings,
			      struct gz_view_live_tables *out_tables);

/** The number of keys in all tables together. */
size_t gz_view_scene_key_count(const struct gz_view_scene_tables *tables);

/**
 * Whether a scene key has any effect given the other settings. For example, "camera.height" has an
 * effect in an orthographic view only.
 *
 * @param key  a key of the scene's tables; keys without a condition always have an effect
 */
bool gz_setting_applies(const struct gz_scene_settings *settings, const char *key);

/** Whether importance, transparency and template of an object and its regions have any effect.
 *  @param object  NULL: the volume of section [volume] */
bool gz_object_style_applies(const struct gz_scene_settings *settings,
			     const struct gz_scene_object *object);

#endif
