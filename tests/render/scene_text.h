/**
 * @file
 * Settings from the text of a scene, for tests.
 */
#ifndef GZ_TESTS_RENDER_SCENE_TEXT_H
#define GZ_TESTS_RENDER_SCENE_TEXT_H

#include "suite.h"

#include <string.h>

#include "base/captured_log.h"
#include "render/scene/scene_settings.h"

/** Read a scene's text; the test fails if it is refused. @p out_has_display may be NULL. */
static inline struct gz_scene_settings scene_of_text(const char *text, bool *out_has_display)
{
	struct gz_scene_settings settings;
	struct captured_log log;
	bool display = false;
	captured_log_init(&log, NULL);
	if (gz_scene_parse("s.scene", text, strlen(text), &log.log, &settings, &display) != GZ_OK)
		fail_msg("refused: %s\n%s", log.last, text);
	if (out_has_display)
		*out_has_display = display;
	return settings;
}

#endif
