/**
 * @file
 * The panel of illustrations: template and combined settings, a gallery of the parameters that make
 * up a shading map, and the curve of the haze. Inside a frame of panels/widgets.h.
 */
#ifndef GZ_VIEW_PANELS_ILLUSTRATION_PANEL_H
#define GZ_VIEW_PANELS_ILLUSTRATION_PANEL_H

#include <stdbool.h>

#include "render/scene/scene_settings.h"
#include "view/panels/settings_panel.h"

/** Most pictures of the gallery. Chosen: more than illustration.show has values. */
enum { GZ_GALLERY_MAX = 24 };

/** Size of a picture of the gallery, px at scale 1. */
enum { GZ_GALLERY_WIDTH = 86, GZ_GALLERY_HEIGHT = 54 };

/** The panel. Zero-initialised is closed and has no pictures. */
struct gz_illustration_panel {
	bool open;
	float margin_top;
	unsigned pictures[GZ_GALLERY_MAX]; /**< textures, by illustration.show; 0: none yet */
	int handle;                        /**< of the curve, that is dragged, from 1; 0: none */
};

/** How many values illustration.show has, each a picture of the gallery. */
int gz_illustration_gallery_count(void);

/**
 * Draw the panel at the right of the window.
 *
 * @param rows  the settings' rows
 * @param[in,out] settings  the target of @p rows
 * @return whether settings were changed
 */
bool gz_illustration_panel_draw(struct gz_illustration_panel *panel,
				const struct gz_settings_panel *rows,
				struct gz_scene_settings *settings);

#endif
