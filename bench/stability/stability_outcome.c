/* How an outcome is filled: numbers, the worst pixel and what lies around it. */
#include "bench/stability/stability_bench.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void gz_stability_name(struct gz_stability_outcome *outcome, int number, const char *what,
		       double bound)
{
	outcome->numbers[number].what = what;
	outcome->numbers[number].bound = bound;
	if (number >= outcome->number_count)
		outcome->number_count = number + 1;
}

int gz_stability_apart(const struct gz_image *a, const struct gz_image *b, size_t pixel)
{
	int most = 0;
	for (size_t i = 4 * pixel; i < 4 * pixel + 3; i++) {
		const int apart = abs(a->pixels[i] - b->pixels[i]);
		most = apart > most ? apart : most;
	}
	return most;
}

static enum gz_result crop(const struct gz_image *image, int x, int y, struct gz_image *out)
{
	const int width =
		image->width - x < GZ_STABILITY_CROP_PX ? image->width - x : GZ_STABILITY_CROP_PX;
	const int height =
		image->height - y < GZ_STABILITY_CROP_PX ? image->height - y : GZ_STABILITY_CROP_PX;
	const enum gz_result result = gz_image_resize(out, width, height);
	for (int row = 0; row < height && result == GZ_OK; row++)
		memcpy(out->pixels + (size_t)row * (size_t)width * 4,
		       image->pixels + ((size_t)(y + row) * (size_t)image->width + (size_t)x) * 4,
		       (size_t)width * 4);
	return result;
}

static int crop_start(int at, int size)
{
	const int most = size > GZ_STABILITY_CROP_PX ? size - GZ_STABILITY_CROP_PX : 0;
	const int start = at - GZ_STABILITY_CROP_PX / 2;
	return start < 0 ? 0 : start > most ? most : start;
}

static enum gz_result keep_pixel(struct gz_stability_outcome *outcome,
				 struct gz_stability_place place, bool fails)
{
	struct gz_stability_pixel *worst = &outcome->worst;
	const size_t width = (size_t)place.got->width;
	worst->known = true;
	worst->x = (int)(place.pixel % width);
	worst->y = (int)(place.pixel / width);
	memcpy(worst->got, place.got->pixels + 4 * place.pixel, 3);
	memcpy(worst->wanted, place.wanted->pixels + 4 * place.pixel, 3);
	if (!fails)
		return GZ_OK;
	worst->crop_x = crop_start(worst->x, place.got->width);
	worst->crop_y = crop_start(worst->y, place.got->height);
	enum gz_result result = crop(place.got, worst->crop_x, worst->crop_y, &worst->got_crop);
	if (result == GZ_OK)
		result = crop(place.wanted, worst->crop_x, worst->crop_y, &worst->wanted_crop);
	return result;
}

/* By how much a number is over its bound: what the worst pixel is chosen by. */
static double excess(const struct gz_stability_number *number)
{
	return (number->value - number->bound) / fmax(fabs(number->bound), 1e-3);
}

enum gz_result gz_stability_take(struct gz_stability_outcome *outcome, int number, double value,
				 struct gz_stability_place place, const char *format, ...)
{
	struct gz_stability_number *taken = &outcome->numbers[number];
	const bool first = taken->where[0] == '\0';
	if (!first && !(value > taken->value))
		return GZ_OK;
	taken->value = value;
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(taken->where, sizeof taken->where, format, arguments);
	va_end(arguments);
	for (int i = 0; i < outcome->number_count; i++)
		if (excess(&outcome->numbers[i]) > excess(taken) && outcome->worst.known)
			return GZ_OK;
	return place.got ? keep_pixel(outcome, place, value > taken->bound) : GZ_OK;
}
