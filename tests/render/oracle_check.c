#include "oracle_check.h"

/* cmocka.h wants these before it */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>

#include "oracle.h"
#include "oracle_light.h"
#include "render/plan/method.h"

/* The first channel of a pixel that is off, or 3. Half a grey level is rounding, the other half the
 * tables'. */
static int channel_off(const uint8_t pixel[4], const double rgb[3])
{
	int channel = 0;
	while (channel < 3 && fabs(pixel[channel] - 255 * rgb[channel]) <= 1)
		channel++;
	return channel;
}

static void check_set(const struct small_scene *scene, const struct oracle_occlusion *occlusion,
		      const char *set, int width, int height, int pixels_off)
{
	struct gz_raycaster *renderer = small_scene_renderer(scene, 2, set);
	struct gz_image image = { 0 };
	small_scene_render(renderer, scene, width, height, &image, NULL);
	int off = 0;
	for (int y = 0; y < height; y++)
		for (int x = 0; x < width; x++) {
			const uint8_t *pixel = image.pixels + 4 * (y * width + x);
			double rgb[3];
			oracle_pixel_occluded(&scene->volume, &scene->transfer, &scene->camera,
					      &scene->rays, occlusion, width, height, x, y, rgb);
			const int channel = channel_off(pixel, rgb);
			if (channel < 3 && ++off > pixels_off)
				fail_msg("%s: pixel %d %d channel %d: %d, oracle %.3f", set, x, y,
					 channel, pixel[channel], 255 * rgb[channel]);
			assert_int_equal(pixel[3], 255);
		}
	gz_raycaster_destroy(&renderer);
	gz_image_free(&image);
}

void oracle_check_but(struct small_scene *scene, int width, int height, int pixels_off)
{
	scene->foveation.method = GZ_METHOD_STANDARD;
	const bool occluded = scene->rays.light.occlusion > 0;
	const bool shadowed = scene->rays.light.shadow_steps > 0;
	struct oracle_occlusion occlusion = { 0 };
	if (occluded)
		occlusion = oracle_occlusion_make(&scene->volume, &scene->transfer, &scene->rays);
	if (shadowed)
		oracle_shadows_make(&scene->volume, &scene->transfer, &scene->camera, &scene->rays,
				    &occlusion);
	for (const char *const *set = small_scene_simd_sets(); *set; set++)
		check_set(scene, occluded || shadowed ? &occlusion : NULL, *set, width, height,
			  pixels_off);
	oracle_occlusion_free(&occlusion);
}

void oracle_check(struct small_scene *scene, int width, int height)
{
	oracle_check_but(scene, width, height, 0);
	small_scene_free(scene);
}
