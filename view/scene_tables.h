/**
 * @file
 * The keys of a scene that can be changed while it is shown: those of its tables that say neither
 * what is shown nor what the display is. The command line takes them, and the panel shows them.
 */
#ifndef GZ_VIEW_SCENE_TABLES_H
#define GZ_VIEW_SCENE_TABLES_H

#include "base/option.h"
#include "render/scene.h"

/** Most keys of one scene table that are taken. */
#define GZ_VIEW_SCENE_KEYS_MAX 64

/** Filled in place by gz_view_pick_scene_tables(): its bindings point into it. */
struct gz_view_scene_tables {
	struct gz_option options[GZ_SCENE_BINDINGS][GZ_VIEW_SCENE_KEYS_MAX];
	struct gz_option_binding bindings[GZ_SCENE_BINDINGS]; /**< no flags of what was given */
};

/** The tables over @p settings, borrowed, which must outlive @p out_tables. */
void gz_view_pick_scene_tables(struct gz_scene_settings *settings,
			       struct gz_view_scene_tables *out_tables);

#endif
