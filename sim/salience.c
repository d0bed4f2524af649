#define GZ_LOG_MODULE "sim"

#include <errno.h>
#include <png.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim/targets.h"

enum {
	SIDE_MAX_PX = 16384,
	MAP_SIDE = 128, /* the picture is looked at in this many cells along its longer side */
	POINTS_MAX = 24,
};

static const uint64_t PIXELS_MAX = UINT64_C(64) << 20;

/* Half widths of centre and surround, cells; about the scales 2-5 and 3-7 of Itti et al. */
static const int SCALES[][2] = { { 1, 6 }, { 2, 10 }, { 3, 16 } };

/* A point inhibits its neighbourhood up to this part of the longer side, and points weaker than
 * this part of the strongest are not salient: both chosen. */
static const double INHIBITION = 0.08;
static const double WEAKEST = 0.1;

/** A map of cells. */
struct map {
	int width, height;
	double *cell;     /**< mean luminance */
	double *salience; /**< centre against surround */
	double *sum;      /**< summed-area table, one row and column more */
};

static void map_free(struct map *map)
{
	free(map->cell);
	free(map->salience);
	free(map->sum);
}

static enum gz_result map_make(struct map *map, int width, int height)
{
	int longer = width > height ? width : height;
	int cell_px = (longer + MAP_SIDE - 1) / MAP_SIDE;
	map->width = (width + cell_px - 1) / cell_px;
	map->height = (height + cell_px - 1) / cell_px;
	size_t cells = (size_t)map->width * (size_t)map->height;
	map->cell = calloc(cells, sizeof *map->cell);
	map->salience = calloc(cells, sizeof *map->salience);
	map->sum = calloc((size_t)(map->width + 1) * (size_t)(map->height + 1), sizeof *map->sum);
	return map->cell && map->salience && map->sum ? GZ_OK : GZ_ERR_NO_MEM;
}

static int smaller(int a, int b)
{
	return a < b ? a : b;
}

/** Mean luminance of each cell. */
static void fill_cells(struct map *map, const float *luminance, int width, int height)
{
	int longer = width > height ? width : height;
	int cell_px = (longer + MAP_SIDE - 1) / MAP_SIDE;
	for (int v = 0; v < map->height; v++) {
		for (int u = 0; u < map->width; u++) {
			int right = smaller((u + 1) * cell_px, width);
			int bottom = smaller((v + 1) * cell_px, height);
			double sum = 0;
			for (int y = v * cell_px; y < bottom; y++)
				for (int x = u * cell_px; x < right; x++)
					sum += luminance[(size_t)y * (size_t)width + (size_t)x];
			int pixels = (right - u * cell_px) * (bottom - v * cell_px);
			map->cell[v * map->width + u] = sum / pixels;
		}
	}
}

static void fill_sums(struct map *map)
{
	int stride = map->width + 1;
	for (int v = 0; v < map->height; v++) {
		double row = 0;
		for (int u = 0; u < map->width; u++) {
			row += map->cell[v * map->width + u];
			map->sum[(v + 1) * stride + u + 1] = map->sum[v * stride + u + 1] + row;
		}
	}
}

/** Mean of the cells within @p half of (u, v), as far as there are any. */
static double mean_around(const struct map *map, int u, int v, int half)
{
	int left = u > half ? u - half : 0, top = v > half ? v - half : 0;
	int right = smaller(u + half + 1, map->width), bottom = smaller(v + half + 1, map->height);
	int stride = map->width + 1;
	const double *s = map->sum;
	double sum = s[bottom * stride + right] - s[top * stride + right] -
		     s[bottom * stride + left] + s[top * stride + left];
	return sum / ((right - left) * (bottom - top));
}

static void fill_salience(struct map *map)
{
	for (int v = 0; v < map->height; v++) {
		for (int u = 0; u < map->width; u++) {
			double contrast = 0;
			for (size_t i = 0; i < sizeof SCALES / sizeof SCALES[0]; i++) {
				double d = mean_around(map, u, v, SCALES[i][0]) -
					   mean_around(map, u, v, SCALES[i][1]);
				contrast += d < 0 ? -d : d;
			}
			map->salience[v * map->width + u] = contrast;
		}
	}
}

static int strongest_cell(const struct map *map)
{
	int best = 0;
	for (int i = 1; i < map->width * map->height; i++)
		if (map->salience[i] > map->salience[best])
			best = i;
	return best;
}

static void inhibit_around(struct map *map, int cell)
{
	double reach = INHIBITION * (map->width > map->height ? map->width : map->height);
	int at_u = cell % map->width, at_v = cell / map->width;
	for (int v = 0; v < map->height; v++) {
		for (int u = 0; u < map->width; u++) {
			double du = u - at_u, dv = v - at_v;
			if (du * du + dv * dv <= reach * reach)
				map->salience[v * map->width + u] = 0;
		}
	}
}

static void pick_points(struct map *map, struct gz_targets *out_targets)
{
	double first = 0;
	while (out_targets->count < POINTS_MAX) {
		int cell = strongest_cell(map);
		double strength = map->salience[cell];
		if (out_targets->count == 0)
			first = strength;
		/* A millionth of a grey level is rounding, not contrast. */
		if (strength <= 1e-6 || strength < WEAKEST * first)
			break;
		out_targets->target[out_targets->count++] = (struct gz_target) {
			.point = { ((float)(cell % map->width) + 0.5f) / (float)map->width,
				   ((float)(cell / map->width) + 0.5f) / (float)map->height },
			.weight = strength / first,
		};
		inhibit_around(map, cell);
	}
	if (out_targets->count == 0) {
		out_targets->target[0] =
			(struct gz_target) { .point = { 0.5f, 0.5f }, .weight = 1 };
		out_targets->count = 1;
	}
}

enum gz_result gz_targets_from_luminance(const float *luminance, int width, int height,
					 struct gz_targets *out_targets)
{
	if (width < 1 || width > SIDE_MAX_PX || height < 1 || height > SIDE_MAX_PX)
		return GZ_ERR_INVAL;
	struct map map = { .cell = NULL };
	enum gz_result r = map_make(&map, width, height);
	if (r == GZ_OK) {
		struct gz_targets targets = { .count = 0 };
		fill_cells(&map, luminance, width, height);
		fill_sums(&map);
		fill_salience(&map);
		pick_points(&map, &targets);
		*out_targets = targets;
	}
	map_free(&map);
	return r;
}

/** Read the opened picture's grey values, scaled to [0, 1]. */
static enum gz_result read_grey(png_image *image, const char *path, const struct gz_log *log,
				float **out_luminance)
{
	static const png_color black = { 0, 0, 0 };
	size_t pixels = (size_t)image->width * (size_t)image->height;
	enum gz_result r = GZ_ERR_NO_MEM;
	float *luminance = malloc(pixels * sizeof *luminance);
	png_byte *grey = malloc(pixels);
	if (!luminance || !grey)
		goto done;
	image->format = PNG_FORMAT_GRAY;
	if (!png_image_finish_read(image, &black, grey, 0, NULL)) {
		gz_err(log, "%s: not a whole PNG picture: %s", path, image->message);
		r = GZ_ERR_FORMAT;
		goto done;
	}
	for (size_t i = 0; i < pixels; i++)
		luminance[i] = (float)grey[i] / 255.0f;
	*out_luminance = luminance;
	luminance = NULL;
	r = GZ_OK;
done:
	free(luminance);
	free(grey);
	return r;
}

static enum gz_result read_picture(FILE *file, const char *path, const struct gz_log *log,
				   struct gz_targets *out_targets)
{
	png_image image = { .version = PNG_IMAGE_VERSION };
	float *luminance = NULL;
	enum gz_result r = GZ_ERR_FORMAT;
	if (!png_image_begin_read_from_stdio(&image, file)) {
		gz_err(log, "%s: not a PNG picture: %s", path, image.message);
	} else if (image.width > SIDE_MAX_PX || image.height > SIDE_MAX_PX ||
		   (uint64_t)image.width * image.height > PIXELS_MAX) {
		gz_err(log, "%s: %u x %u pixels are too many; scale it to at most %d a side", path,
		       image.width, image.height, SIDE_MAX_PX / 2);
		r = GZ_ERR_UNSUPPORTED;
	} else {
		r = read_grey(&image, path, log, &luminance);
	}
	if (r == GZ_OK)
		r = gz_targets_from_luminance(luminance, (int)image.width, (int)image.height,
					      out_targets);
	free(luminance);
	png_image_free(&image);
	return r;
}

enum gz_result gz_targets_from_png(const char *path, const struct gz_log *log,
				   struct gz_targets *out_targets)
{
	FILE *file = fopen(path, "rb");
	if (!file) {
		enum gz_result missing = errno == ENOENT ? GZ_ERR_NOT_FOUND : GZ_ERR_IO;
		gz_err(log, "cannot open %s: %s; check sim.picture", path, strerror(errno));
		return missing;
	}
	enum gz_result r = read_picture(file, path, log, out_targets);
	fclose(file);
	return r;
}
