/**
 * @file
 * A frame maker over a small scene, as the window has one, without the window.
 */
#ifndef GZ_TESTS_VIEW_MADE_FRAMES_H
#define GZ_TESTS_VIEW_MADE_FRAMES_H

#include "suite.h"

#include <string.h>

#include "base/captured_log.h"
#include "protocol/display.h"
#include "view/frame/frame.h"

/** Size of a picture, and its bytes. */
enum { WIDTH = 64, HEIGHT = 48, BYTES = 4 * WIDTH * HEIGHT };

/** A frame maker and what it is told and tells. */
struct made_frames {
	struct captured_log captured; /**< warnings and errors */
	struct gz_view_options options;
	struct gz_frame_maker *maker;
	struct gz_scene_settings settings; /**< of the next frame; the scene's at first */
	struct gz_frame_record record;     /**< of the last frame */
};

/** Open the scene file @p scene for @p backend; nothing is drawn before gz_frame_maker_start(). End
 *  it by gz_frame_maker_destroy(). */
static inline void create_frames(struct made_frames *made, const char *scene, const char *backend)
{
	captured_log_init(&made->captured, "*:warn");
	const char *const arguments[] = { "gazeview", "--headless", "--backend", backend,
					  "--size",   "64x48",      scene,       NULL };
	assert_int_equal(gz_view_options_read(7, (char *const *)arguments, NULL, &made->options),
			 GZ_OK);
	const struct gz_frame_scene source = gz_frame_scene_of_options(&made->options);
	assert_int_equal(gz_frame_maker_create(&made->options, &source, NULL, &made->captured.log,
					       &made->maker),
			 GZ_OK);
	made->settings = gz_frame_maker_scene(made->maker)->settings;
}

/** Draw a frame by the present settings. @param[out] out_pixels  NULL: not kept */
static inline void draw_frame(struct made_frames *made, uint8_t out_pixels[BYTES])
{
	const struct gz_display display = gz_display_default(WIDTH, HEIGHT);
	const struct gz_frame_request request = {
		.settings = &made->settings,
		.display = &display,
		.width = WIDTH,
		.height = HEIGHT,
	};
	struct gz_image *image = NULL;
	assert_int_equal(gz_frame_make(made->maker, &request, &image, &made->record), GZ_OK);
	if (out_pixels)
		memcpy(out_pixels, image->pixels, BYTES);
}

#endif
