/**
 * @file
 * Which settings count with the others as they are, for a panel that shows them all.
 */
#ifndef GZ_VIEW_SETTINGS_SETTING_APPLIES_H
#define GZ_VIEW_SETTINGS_SETTING_APPLIES_H

#include <stdbool.h>

#include "render/scene/scene.h"

/**
 * Whether a key of the scene makes a difference while the others are as in @p settings: the height
 * of the view does in an orthographic one only.
 *
 * @param key  as in the scene's tables; one that is not known here always counts
 */
bool gz_setting_applies(const struct gz_scene_settings *settings, const char *key);

#endif
