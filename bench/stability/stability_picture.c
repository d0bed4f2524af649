/* The picture beside a failure. */
#include <stdlib.h>

#include "bench/stability/stability_bench.h"

enum { ENLARGED = 10, GAP = 8, STRONGER = 4 };

static void fill(struct gz_image *image, uint8_t grey)
{
	for (size_t i = 0; i < (size_t)image->width * (size_t)image->height * 4; i++)
		image->pixels[i] = i % 4 == 3 ? 255 : grey;
}

/* A pixel of panel 0, 1 or 2. */
static void colour_of(const struct gz_stability_pixel *worst, int panel, int x, int y,
		      uint8_t out[3])
{
	const size_t at = 4 * ((size_t)y * (size_t)worst->got_crop.width + (size_t)x);
	for (size_t c = 0; c < 3; c++) {
		const int got = worst->got_crop.pixels[at + c],
			  wanted = worst->wanted_crop.pixels[at + c];
		const int difference = STRONGER * abs(got - wanted);
		out[c] = (uint8_t)(panel == 0   ? got
				   : panel == 1 ? wanted
						: (difference > 255 ? 255 : difference));
	}
}

static void put_panel(const struct gz_stability_pixel *worst, int panel, struct gz_image *target)
{
	const int left = panel * (worst->got_crop.width * ENLARGED + GAP) + GAP;
	for (int y = 0; y < worst->got_crop.height * ENLARGED; y++)
		for (int x = 0; x < worst->got_crop.width * ENLARGED; x++)
			colour_of(worst, panel, x / ENLARGED, y / ENLARGED,
				  target->pixels + 4 * ((size_t)(y + GAP) * (size_t)target->width +
							(size_t)(left + x)));
}

/* A frame round the worst pixel, outside of it. */
static void put_frame(const struct gz_stability_pixel *worst, int panel, struct gz_image *target)
{
	const int left = panel * (worst->got_crop.width * ENLARGED + GAP) + GAP +
			 (worst->x - worst->crop_x) * ENLARGED;
	const int top = GAP + (worst->y - worst->crop_y) * ENLARGED;
	for (int y = top - 2; y < top + ENLARGED + 2; y++)
		for (int x = left - 2; x < left + ENLARGED + 2; x++) {
			const bool inside =
				x >= left && x < left + ENLARGED && y >= top && y < top + ENLARGED;
			uint8_t *pixel = target->pixels +
					 4 * ((size_t)y * (size_t)target->width + (size_t)x);
			if (!inside) {
				pixel[0] = 255;
				pixel[1] = 220;
				pixel[2] = 0;
			}
		}
}

enum gz_result gz_stability_write_picture(const struct gz_stability_outcome *outcome,
					  const char *path, const struct gz_log *log)
{
	const struct gz_stability_pixel *worst = &outcome->worst;
	struct gz_image picture = { 0 };
	if (!worst->known || !worst->got_crop.pixels)
		return GZ_ERR_INVAL;
	enum gz_result result =
		gz_image_resize(&picture, 3 * worst->got_crop.width * ENLARGED + 4 * GAP,
				worst->got_crop.height * ENLARGED + 2 * GAP);
	if (result != GZ_OK)
		return result;
	fill(&picture, 64);
	for (int panel = 0; panel < 3; panel++) {
		put_panel(worst, panel, &picture);
		put_frame(worst, panel, &picture);
	}
	result = gz_image_write_png(&picture, path, log);
	gz_image_free(&picture);
	return result;
}
