#include "sim/targets.h"

#include <errno.h>
#include <math.h>
#include <png.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define GZ_LOG_MODULE "sim"

/* Longest line with its NUL, and longest file, bytes. Chosen: far more than GZ_TARGETS_MAX places
 * need. */
enum { LINE_SIZE = 256, FILE_SIZE_MAX = 65536 };

static const double PLACE_MIN = -0.5;
static const double PLACE_MAX = 1.5;
static const double WEIGHT_MAX = 1000;

/* Read up to four numbers of @p line. @return how many; -1 if the line contains anything else */
static int read_target_numbers(const char *line, double out_number[4])
{
	int count = 0;
	for (;;) {
		line += strspn(line, " \t\r");
		if (*line == '\0' || *line == '#')
			return count;
		char *end;
		double number = strtod(line, &end);
		bool ended = strchr(" \t\r#", *end) != NULL; /* also at the final NUL */
		if (end == line || !ended || !isfinite(number) || count == 4)
			return -1;
		out_number[count++] = number;
		line = end;
	}
}

static bool is_target_coordinate(double x)
{
	return x >= PLACE_MIN && x <= PLACE_MAX;
}

/* Parse one line. An empty line gives a weight of 0. */
static enum gz_result parse_target_line(const char *line, struct gz_target *out_target)
{
	double number[4] = { 0, 0, 1, 0 };
	int count = read_target_numbers(line, number);
	if (count == 0) {
		*out_target = (struct gz_target) { .weight = 0 };
		return GZ_OK;
	}
	if ((count != 2 && count != 3) || !is_target_coordinate(number[0]) ||
	    !is_target_coordinate(number[1]) || number[2] <= 0 || number[2] > WEIGHT_MAX)
		return GZ_ERR_FORMAT;
	*out_target = (struct gz_target) {
		.point = { (float)number[0], (float)number[1] },
		.weight = number[2],
	};
	return GZ_OK;
}

enum gz_result gz_targets_parse(const char *name, const char *text, size_t size,
				const struct gz_log *log, struct gz_targets *out_targets)
{
	struct gz_targets targets = { .count = 0 };
	int number = 0;
	for (size_t at = 0; at < size;) {
		const char *end = memchr(text + at, '\n', size - at);
		size_t length = end ? (size_t)(end - text) - at : size - at;
		char line[LINE_SIZE];
		struct gz_target target;
		number++;
		bool fits = length < sizeof line && !memchr(text + at, '\0', length);
		if (fits) {
			memcpy(line, text + at, length);
			line[length] = '\0';
		}
		if (!fits || parse_target_line(line, &target) != GZ_OK) {
			gz_err(log,
			       "%s:%d: not a target; write \"x y\" or \"x y weight\", x and y "
			       "%g to %g, weight above 0 up to %g",
			       name, number, PLACE_MIN, PLACE_MAX, WEIGHT_MAX);
			return GZ_ERR_FORMAT;
		}
		if (target.weight > 0 && targets.count == GZ_TARGETS_MAX) {
			gz_err(log, "%s:%d: more than %d targets; remove some", name, number,
			       GZ_TARGETS_MAX);
			return GZ_ERR_FORMAT;
		}
		if (target.weight > 0)
			targets.target[targets.count++] = target;
		at += length + 1;
	}
	if (targets.count == 0) {
		gz_err(log, "%s: no targets; write a line \"x y\" for each", name);
		return GZ_ERR_FORMAT;
	}
	*out_targets = targets;
	return GZ_OK;
}

/* Read a file whole. */
static enum gz_result read_target_file(FILE *file, const char *path, const struct gz_log *log,
				       char *text, size_t *out_size)
{
	*out_size = fread(text, 1, FILE_SIZE_MAX + 1, file);
	if (ferror(file)) {
		gz_err(log, "cannot read %s: %s; check sim.targets", path, strerror(errno));
		return GZ_ERR_IO;
	}
	if (*out_size > FILE_SIZE_MAX) {
		gz_err(log,
		       "%s: longer than %d bytes, too long for a target list; check sim.targets",
		       path, FILE_SIZE_MAX);
		return GZ_ERR_FORMAT;
	}
	return GZ_OK;
}

enum gz_result gz_targets_load(const char *path, const struct gz_log *log,
			       struct gz_targets *out_targets)
{
	FILE *file = fopen(path, "rb");
	if (!file) {
		enum gz_result missing = errno == ENOENT ? GZ_ERR_NOT_FOUND : GZ_ERR_IO;
		gz_err(log, "cannot open %s: %s; check sim.targets", path, strerror(errno));
		return missing;
	}
	size_t size = 0;
	char *text = malloc(FILE_SIZE_MAX + 1);
	enum gz_result r = text ? read_target_file(file, path, log, text, &size) : GZ_ERR_NO_MEM;
	if (r == GZ_OK)
		r = gz_targets_parse(path, text, size, log, out_targets);
	free(text);
	fclose(file);
	return r;
}

/* The salient points of a picture. */

enum {
	SIDE_MAX_PX = 16384,
	MAP_SIDE_CELLS = 128, /* cells along the longer side of the picture */
	POINTS_MAX = 24,
};

static const uint64_t PIXELS_MAX = UINT64_C(64) << 20;

/* Half widths of centre and surround, cells: about the scales 2-5 and 3-7 of Itti et al. */
static const int SCALES[][2] = { { 1, 6 }, { 2, 10 }, { 3, 16 } };

/* A point inhibits its neighbourhood up to this fraction of the longer side. Points weaker than
 * WEAKEST times the strongest are not salient. Both chosen. */
static const double INHIBITION = 0.08;
static const double WEAKEST = 0.1;

/* The picture as a map of cells. */
struct salience_map {
	int width, height;
	double *cell;     /* mean luminance */
	double *salience; /* contrast of centre and surround */
	double *sum;      /* summed-area table, with one more row and column */
};

static void free_salience_map(struct salience_map *map)
{
	free(map->cell);
	free(map->salience);
	free(map->sum);
}

static enum gz_result make_salience_map(struct salience_map *map, int width, int height)
{
	int longer = width > height ? width : height;
	int cell_px = (longer + MAP_SIDE_CELLS - 1) / MAP_SIDE_CELLS;
	map->width = (width + cell_px - 1) / cell_px;
	map->height = (height + cell_px - 1) / cell_px;
	size_t cells = (size_t)map->width * (size_t)map->height;
	map->cell = calloc(cells, sizeof *map->cell);
	map->salience = calloc(cells, sizeof *map->salience);
	map->sum = calloc((size_t)(map->width + 1) * (size_t)(map->height + 1), sizeof *map->sum);
	return map->cell && map->salience && map->sum ? GZ_OK : GZ_ERR_NO_MEM;
}

static int smaller_int(int a, int b)
{
	return a < b ? a : b;
}

/* Compute the mean luminance of each cell. */
static void fill_cell_luminance(struct salience_map *map, const float *luminance, int width,
				int height)
{
	int longer = width > height ? width : height;
	int cell_px = (longer + MAP_SIDE_CELLS - 1) / MAP_SIDE_CELLS;
	for (int v = 0; v < map->height; v++) {
		for (int u = 0; u < map->width; u++) {
			int right = smaller_int((u + 1) * cell_px, width);
			int bottom = smaller_int((v + 1) * cell_px, height);
			double sum = 0;
			for (int y = v * cell_px; y < bottom; y++)
				for (int x = u * cell_px; x < right; x++)
					sum += luminance[(size_t)y * (size_t)width + (size_t)x];
			int pixels = (right - u * cell_px) * (bottom - v * cell_px);
			map->cell[v * map->width + u] = sum / pixels;
		}
	}
}

static void fill_summed_area(struct salience_map *map)
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

/* The mean of the cells within @p half of (u, v) that are in the map. */
static double mean_around_cell(const struct salience_map *map, int u, int v, int half)
{
	int left = u > half ? u - half : 0, top = v > half ? v - half : 0;
	int right = smaller_int(u + half + 1, map->width),
	    bottom = smaller_int(v + half + 1, map->height);
	int stride = map->width + 1;
	const double *s = map->sum;
	double sum = s[bottom * stride + right] - s[top * stride + right] -
		     s[bottom * stride + left] + s[top * stride + left];
	return sum / ((right - left) * (bottom - top));
}

static void fill_salience(struct salience_map *map)
{
	for (int v = 0; v < map->height; v++) {
		for (int u = 0; u < map->width; u++) {
			double contrast = 0;
			for (size_t i = 0; i < sizeof SCALES / sizeof SCALES[0]; i++) {
				double d = mean_around_cell(map, u, v, SCALES[i][0]) -
					   mean_around_cell(map, u, v, SCALES[i][1]);
				contrast += d < 0 ? -d : d;
			}
			map->salience[v * map->width + u] = contrast;
		}
	}
}

static int strongest_cell(const struct salience_map *map)
{
	int best = 0;
	for (int i = 1; i < map->width * map->height; i++)
		if (map->salience[i] > map->salience[best])
			best = i;
	return best;
}

static void inhibit_around(struct salience_map *map, int cell)
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

static void pick_salient_points(struct salience_map *map, struct gz_targets *out_targets)
{
	double first = 0;
	while (out_targets->count < POINTS_MAX) {
		int cell = strongest_cell(map);
		double strength = map->salience[cell];
		if (out_targets->count == 0)
			first = strength;
		/* A millionth of a grey level is a rounding error, not contrast. */
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
	struct salience_map map = { .cell = NULL };
	enum gz_result r = make_salience_map(&map, width, height);
	if (r == GZ_OK) {
		struct gz_targets targets = { .count = 0 };
		fill_cell_luminance(&map, luminance, width, height);
		fill_summed_area(&map);
		fill_salience(&map);
		pick_salient_points(&map, &targets);
		*out_targets = targets;
	}
	free_salience_map(&map);
	return r;
}

/* Read the grey values of the opened picture, scaled to [0, 1]. */
static enum gz_result read_grey_values(png_image *image, const char *path, const struct gz_log *log,
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
		gz_err(log, "%s: damaged PNG picture: %s; check sim.picture", path, image->message);
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

static enum gz_result read_salient_points(FILE *file, const char *path, const struct gz_log *log,
					  struct gz_targets *out_targets)
{
	png_image image = { .version = PNG_IMAGE_VERSION };
	float *luminance = NULL;
	enum gz_result r = GZ_ERR_FORMAT;
	if (!png_image_begin_read_from_stdio(&image, file)) {
		gz_err(log, "%s: not a PNG picture: %s; check sim.picture", path, image.message);
	} else if (image.width > SIDE_MAX_PX || image.height > SIDE_MAX_PX ||
		   (uint64_t)image.width * image.height > PIXELS_MAX) {
		gz_err(log, "%s: too large, %u x %u pixels; scale it to at most %d a side", path,
		       image.width, image.height, SIDE_MAX_PX / 2);
		r = GZ_ERR_UNSUPPORTED;
	} else {
		r = read_grey_values(&image, path, log, &luminance);
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
	enum gz_result r = read_salient_points(file, path, log, out_targets);
	fclose(file);
	return r;
}
