#include "render/picture/image.h"

#include <math.h>
#include <stdlib.h>

#define PIXEL_ALIGN 64

enum gz_result gz_image_resize(struct gz_image *image, int width, int height)
{
	if (width < 1 || height < 1 || width > GZ_IMAGE_SIDE_MAX || height > GZ_IMAGE_SIDE_MAX)
		return GZ_ERR_INVAL;
	size_t count = (size_t)width * (size_t)height;
	if (!image->pixels || count != (size_t)image->width * (size_t)image->height) {
		size_t bytes = (count * 4 + PIXEL_ALIGN - 1) / PIXEL_ALIGN * PIXEL_ALIGN;
		uint8_t *pixels = aligned_alloc(PIXEL_ALIGN, bytes);
		if (!pixels)
			return GZ_ERR_NO_MEM;
		free(image->pixels);
		image->pixels = pixels;
	}
	image->width = width;
	image->height = height;
	return GZ_OK;
}

void gz_image_free(struct gz_image *image)
{
	free(image->pixels);
	*image = (struct gz_image) { 0 };
}

/* The source pixels that one target pixel covers along one axis, in source pixels. */
struct footprint {
	double begin, end; /* equal: interpolate at begin */
	int first, last;
};

static int clamp_index(double x, int count)
{
	return x < 0 ? 0 : x > count - 1 ? count - 1 : (int)x;
}

static struct footprint footprint_of(int target, int target_count, int source_count)
{
	double scale = (double)source_count / target_count;
	struct footprint f = { .begin = target * scale, .end = (target + 1) * scale };
	if (scale <= 1) /* interpolate between the centres of two source pixels */
		f.begin = f.end = (target + 0.5) * scale - 0.5;
	f.first = clamp_index(floor(f.begin), source_count);
	f.last = clamp_index(scale <= 1 ? floor(f.begin) + 1 : ceil(f.end) - 1, source_count);
	return f;
}

static double source_weight(const struct footprint *f, int i)
{
	if (f->end > f->begin)
		return fmin(f->end, i + 1) - fmax(f->begin, i);
	return f->first == f->last ? 1 : 1 - fabs(f->begin - i);
}

static void resample_pixel(const struct gz_image *source, const struct footprint *fx,
			   const struct footprint *fy, uint8_t out[4])
{
	double sum[3] = { 0 }, total = 0;
	for (int y = fy->first; y <= fy->last; y++) {
		const uint8_t *row = source->pixels + (size_t)y * (size_t)source->width * 4;
		double wy = source_weight(fy, y);
		for (int x = fx->first; x <= fx->last; x++) {
			double w = wy * source_weight(fx, x);
			total += w;
			for (int c = 0; c < 3; c++)
				sum[c] += w * row[(size_t)x * 4 + (size_t)c];
		}
	}
	for (int c = 0; c < 3; c++)
		out[c] = (uint8_t)(sum[c] / total + 0.5);
	out[3] = 255;
}

void gz_image_resample(const struct gz_image *source, struct gz_image *target)
{
	if (!source->pixels || !target->pixels)
		return;
	for (int y = 0; y < target->height; y++) {
		struct footprint fy = footprint_of(y, target->height, source->height);
		uint8_t *row = target->pixels + (size_t)y * (size_t)target->width * 4;
		for (int x = 0; x < target->width; x++) {
			struct footprint fx = footprint_of(x, target->width, source->width);
			resample_pixel(source, &fx, &fy, row + (size_t)x * 4);
		}
	}
}
