#include "render/illustration/gl/illustrate_points.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/reconstruct/cpu/reconstruct.h"

/* Points that filters may read after the last one (struct gz_lattice), as whole cache lines. */
enum { POINTS_BEYOND = 32, WORDS_A_LINE = 16 };

/* Rows of a part of the work. Chosen: a part takes some 50 us. */
enum { ROWS_A_PART = 16 };

/* A thread's rows of the picture: a finer lattice, the shares of its pixels. */
enum { ROW_FINER, ROW_SHARES, ROWS };

/* What the workers of a picture share. */
struct making_planes {
	const struct gz_illustrate_points *points;
	struct gz_plane *planes;
	struct gz_row_filters filters[GZ_ILLUSTRATE_FOUND];
	int width, height;
};

static size_t points_of(const struct gz_raster_layer *layer)
{
	return (size_t)layer->points[0] * (size_t)layer->points[1];
}

/* Give out @p count words from @p used on, whole lines of the caches. */
static uint32_t *take_words(uint32_t *memory, size_t count, size_t *used)
{
	uint32_t *taken = memory ? memory + *used : NULL;
	*used += (count + WORDS_A_LINE - 1) / WORDS_A_LINE * WORDS_A_LINE;
	return taken;
}

/* Lay out all there is. @param memory  NULL: only to count @return words in all */
static size_t lay_out(struct gz_illustrate_points *points, int width, int threads, uint32_t *memory)
{
	size_t used = 0;
	points->rows = take_words(memory, (size_t)threads * ROWS * (size_t)width, &used);
	for (int i = 0; i < points->count; i++) {
		struct gz_illustrate_lattice *lattice = &points->lattices[i];
		const size_t count = points_of(&lattice->layer);
		lattice->vectors = (float(*)[GZ_ILLUSTRATE_VECTOR_SIZE])take_words(
			memory, GZ_ILLUSTRATE_VECTOR_SIZE * count, &used);
		for (int k = 0; k < points->plane_count; k++)
			lattice->planes[k] = take_words(memory, count + POINTS_BEYOND, &used);
	}
	return used;
}

enum gz_result gz_illustrate_points_prepare(struct gz_illustrate_points *points,
					    const struct gz_plan *plan, int plane_count,
					    int threads)
{
	struct gz_raster_layer layers[GZ_PLAN_RECTANGLES_MAX];
	points->count = gz_raster_layers_make(plan, layers);
	points->plane_count = plane_count;
	for (int i = 0; i < points->count; i++)
		points->lattices[i].layer = layers[i];
	const size_t words = lay_out(points, plan->width, threads, NULL);
	if (words > points->capacity) {
		free(points->memory);
		points->capacity = 0;
		points->memory = aligned_alloc(WORDS_A_LINE * sizeof *points->memory,
					       words * sizeof *points->memory);
		if (!points->memory)
			return GZ_ERR_NO_MEM;
		points->capacity = words;
	}
	(void)lay_out(points, plan->width, threads, points->memory);
	return GZ_OK;
}

void gz_illustrate_points_free(struct gz_illustrate_points *points)
{
	free(points->memory);
	*points = (struct gz_illustrate_points) { 0 };
}

/* Part the numbers of a point, as struct gz_illustrate_picture has them. */
static void split_vector(const float vector[GZ_ILLUSTRATE_VECTOR_SIZE],
			 const struct gz_illustrate_lattice *lattice, size_t at, int plane_count)
{
	const float object = vector[GZ_ILLUSTRATE_VECTOR_OBJECT];
	const bool any = object != 0;
	const float tone = any ? vector[GZ_ILLUSTRATE_VECTOR_TONE] : INFINITY;
	const float depth = any ? vector[GZ_ILLUSTRATE_VECTOR_DEPTH] : INFINITY;
	const float distance = vector[GZ_ILLUSTRATE_VECTOR_DISTANCE];
	const float known = any && distance <= FLT_MAX ? distance : INFINITY; /* nor NaN */
	lattice->planes[GZ_ILLUSTRATE_IDS][at] = (uint32_t)fabsf(object);
	memcpy(&lattice->planes[GZ_ILLUSTRATE_TONE][at], &tone, sizeof tone);
	memcpy(&lattice->planes[GZ_ILLUSTRATE_DEPTH][at], &depth, sizeof depth);
	if (plane_count > GZ_ILLUSTRATE_DISTANCE)
		memcpy(&lattice->planes[GZ_ILLUSTRATE_DISTANCE][at], &known, sizeof known);
}

static size_t parts_of(int rows)
{
	return (size_t)((rows + ROWS_A_PART - 1) / ROWS_A_PART);
}

/* Split rows of one lattice; parts count through all lattices. */
static void split_part(void *user, size_t part, int worker)
{
	const struct making_planes *making = user;
	const struct gz_illustrate_lattice *lattice = making->points->lattices;
	(void)worker;
	for (; part >= parts_of(lattice->layer.points[1]); lattice++)
		part -= parts_of(lattice->layer.points[1]);
	const size_t columns = (size_t)lattice->layer.points[0];
	const size_t end = points_of(&lattice->layer);
	const size_t last = (part + 1) * ROWS_A_PART * columns;
	for (size_t i = part * ROWS_A_PART * columns; i < last && i < end; i++)
		split_vector(lattice->vectors[i], lattice, i, making->points->plane_count);
}

/* Pixels [x0, x1) of a row from one lattice. */
static void span_lattice(const struct making_planes *making,
			 const struct gz_illustrate_lattice *lattice, int plane, int y,
			 const int x[2], uint32_t *out)
{
	const struct gz_raster_layer *layer = &lattice->layer;
	const int row = y - layer->from[1], first = x[0] - layer->from[0];
	const struct gz_lattice points = {
		.points = lattice->planes[plane],
		.stride = (size_t)layer->points[0],
		.spacing = layer->spacing,
		.columns = layer->points[0],
		.rows = layer->points[1],
	};
	if (layer->spacing == 1)
		memcpy(out, points.points + (size_t)row * points.stride + first,
		       (size_t)(x[1] - x[0]) * sizeof *out);
	else
		making->filters[plane].span(&points, row, first, x[1] - layer->from[0], out);
}

/* Pixels in which a lattice fades into what is there. */
static void fade_lattice(const struct making_planes *making,
			 const struct gz_illustrate_lattice *lattice, int y, const int x[2],
			 uint32_t *rows)
{
	uint32_t *finer = rows + (ptrdiff_t)ROW_FINER * making->width;
	uint32_t *shares = rows + (ptrdiff_t)ROW_SHARES * making->width;
	const int count = x[1] - x[0];
	if (count <= 0)
		return;
	for (int i = 0; i < count; i++)
		shares[i] =
			(uint32_t)lrintf(256 * gz_raster_layer_share(&lattice->layer, x[0] + i, y));
	for (int plane = 0; plane < making->points->plane_count; plane++) {
		uint32_t *out = making->planes[plane].words + (ptrdiff_t)y * making->width + x[0];
		span_lattice(making, lattice, plane, y, x, finer);
		making->filters[plane].blend(out, shares, finer, count);
		memcpy(out, finer, (size_t)count * sizeof *out);
	}
}

/* Pixels that show one lattice alone. */
static void show_lattice(const struct making_planes *making,
			 const struct gz_illustrate_lattice *lattice, int y, const int x[2])
{
	for (int plane = 0; plane < making->points->plane_count && x[0] < x[1]; plane++)
		span_lattice(making, lattice, plane, y, x,
			     making->planes[plane].words + (ptrdiff_t)y * making->width + x[0]);
}

static int between_ints(int value, int least, int most)
{
	const int low = value < least ? least : value;
	return low < most ? low : most;
}

/* Add a lattice to a row: alone where it is solid, fading beside that, not where the next finer one
 * is solid. */
static void add_lattice(const struct making_planes *making, int index, int y, uint32_t *rows)
{
	const struct gz_illustrate_lattice *lattice = &making->points->lattices[index];
	const struct gz_raster_layer *layer = &lattice->layer;
	const struct gz_raster_layer *finer =
		index + 1 < making->points->count ? &lattice[1].layer : NULL;
	const int from =
		index > 0 ? between_ints(layer->solid[0][0] - layer->band, 0, making->width) : 0;
	const int to = index > 0 ? between_ints(layer->solid[1][0] + layer->band, 0, making->width)
				 : making->width;
	if (index > 0 &&
	    (y < layer->solid[0][1] - layer->band || y >= layer->solid[1][1] + layer->band))
		return;
	if (index > 0 && (y < layer->solid[0][1] || y >= layer->solid[1][1])) {
		fade_lattice(making, lattice, y, (const int[2]) { from, to }, rows);
		return;
	}
	const int solid_from = index > 0 ? between_ints(layer->solid[0][0], from, to) : from;
	const int solid_to = index > 0 ? between_ints(layer->solid[1][0], solid_from, to) : to;
	const bool hidden = finer && y >= finer->solid[0][1] && y < finer->solid[1][1];
	const int left = hidden ? between_ints(finer->solid[0][0], solid_from, solid_to) : solid_to;
	const int right = hidden ? between_ints(finer->solid[1][0], left, solid_to) : solid_to;
	fade_lattice(making, lattice, y, (const int[2]) { from, solid_from }, rows);
	show_lattice(making, lattice, y, (const int[2]) { solid_from, left });
	show_lattice(making, lattice, y, (const int[2]) { right, solid_to });
	fade_lattice(making, lattice, y, (const int[2]) { solid_to, to }, rows);
}

static void join_part(void *user, size_t part, int worker)
{
	const struct making_planes *making = user;
	uint32_t *rows = making->points->rows + (ptrdiff_t)worker * ROWS * making->width;
	const int first = (int)part * ROWS_A_PART;
	for (int y = first; y < first + ROWS_A_PART && y < making->height; y++)
		for (int i = 0; i < making->points->count; i++)
			add_lattice(making, i, y, rows);
}

void gz_illustrate_points_to_planes(struct gz_illustrate_points *points, struct gz_workers *workers,
				    struct gz_plane planes[GZ_ILLUSTRATE_FOUND])
{
	struct making_planes making = {
		.points = points,
		.planes = planes,
		.width = planes[0].width,
		.height = planes[0].height,
	};
	size_t parts = 0;
	for (int i = 0; i < GZ_ILLUSTRATE_FOUND; i++)
		making.filters[i] = gz_row_filters_of_plane(gz_illustrate_found_kinds[i],
							    &gz_row_filters_portable);
	for (int i = 0; i < points->count; i++)
		parts += parts_of(points->lattices[i].layer.points[1]);
	gz_workers_run(workers, split_part, &making, parts);
	gz_workers_run(workers, join_part, &making, parts_of(making.height));
}
