#include "view/capture/fit.h"

#include <math.h>
#include <string.h>

static size_t row_bytes(const struct gz_image *image)
{
	return (size_t)image->width * 4;
}

static int scaled_side(int side, double scale)
{
	const int scaled = (int)lround(side * scale);
	return scaled > 0 ? scaled : 1;
}

static void blacken(struct gz_image *image)
{
	static const uint8_t black[4] = { 0, 0, 0, 255 };
	const size_t count = (size_t)image->width * (size_t)image->height;
	for (size_t i = 0; i < count; i++)
		memcpy(image->pixels + 4 * i, black, sizeof black);
}

/* @p source fits into @p target. */
static void place_in_middle(const struct gz_image *source, struct gz_image *target)
{
	const size_t left = (size_t)(target->width - source->width) / 2 * 4;
	const int top = (target->height - source->height) / 2;
	for (int y = 0; y < source->height; y++)
		memcpy(target->pixels + (size_t)(top + y) * row_bytes(target) + left,
		       source->pixels + (size_t)y * row_bytes(source), row_bytes(source));
}

enum gz_result gz_image_fit(struct gz_image_fit *fit, const struct gz_image *source,
			    struct gz_image *target)
{
	if (source->width == target->width && source->height == target->height) {
		memcpy(target->pixels, source->pixels, row_bytes(source) * (size_t)source->height);
		return GZ_OK;
	}
	const double scale = fmin((double)target->width / source->width,
				  (double)target->height / source->height);
	const int width = scaled_side(source->width, scale);
	const int height = scaled_side(source->height, scale);
	const enum gz_result r = gz_image_resize(&fit->scaled, width, height);
	if (r != GZ_OK)
		return r;
	gz_image_resample(source, &fit->scaled);
	blacken(target);
	place_in_middle(&fit->scaled, target);
	return GZ_OK;
}

void gz_image_fit_free(struct gz_image_fit *fit)
{
	gz_image_free(&fit->scaled);
}
