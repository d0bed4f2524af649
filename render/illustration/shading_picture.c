#include "render/illustration/shading_picture.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "render/illustration/shading_map_loops.h"
#include "render/illustration/shading_tile.h"

/* Rows that are reduced to cells at once: whole cells of every level. */
enum { REDUCED_ROWS = 1 << GZ_BLUR_LEVELS_MAX, LEVELS = GZ_BLUR_LEVELS_MAX + 1 };

/* Both uses of blurred depth. */
enum blur_use { BLUR_EDGE, BLUR_SHADOW, BLURS };

/* What a worker has for itself. */
struct worker_room {
	struct gz_tone_histogram histogram;
	struct gz_shading_tile tile;
};

struct gz_shading_picture {
	float *memory;
	size_t capacity; /* floats */
	struct worker_room *rooms;
	int room_count;
	float *map;
	float *levels[LEVELS]; /* depth as shares; NULL: not needed. Level 0 is that of the pixels
				*/
	float *rows[BLURS], *blurred[BLURS]; /* cells; NULL: not wanted */
	float *row_room;                     /* two rows of each worker */
	uint8_t *filled;                     /* whether tiles show objects, row by row */
	size_t filled_room;
	struct gz_depth_blur blurs[BLURS];
	int levels_most; /* the highest level that is needed; -1: no blur is wanted */
	struct gz_tone_curve curve;
	struct gz_haze_table haze;
};

/* What the workers of a frame share. */
struct picture_job {
	struct gz_shading_picture *picture;
	const struct gz_shading_frame *frame;
	struct gz_shading_shared shared;
};

enum gz_result gz_shading_picture_create(struct gz_shading_picture **out_picture)
{
	*out_picture = calloc(1, sizeof **out_picture);
	return *out_picture ? GZ_OK : GZ_ERR_NO_MEM;
}

void gz_shading_picture_destroy(struct gz_shading_picture **picture)
{
	if (!*picture)
		return;
	free((*picture)->memory);
	free((*picture)->rooms);
	free((*picture)->filled);
	free(*picture);
	*picture = NULL;
}

/* Which blurs and levels a frame needs. */
static void plan_blurs(struct gz_shading_picture *picture, const struct gz_shading_frame *frame,
		       const struct gz_shading_settings *settings, bool wanted[BLURS])
{
	const double widths[BLURS] = { settings->edge_light_width, settings->overlap_shadow_width };
	wanted[BLUR_EDGE] = settings->edge_light > 0;
	wanted[BLUR_SHADOW] = settings->overlap_shadow > 0;
	picture->levels_most = -1;
	for (int i = 0; i < BLURS; i++) {
		gz_depth_blur_make(widths[i] * frame->height, &picture->blurs[i]);
		if (wanted[i] && picture->blurs[i].level > picture->levels_most)
			picture->levels_most = picture->blurs[i].level;
	}
}

static size_t cells_of_level(const struct gz_shading_frame *frame, int level)
{
	return (size_t)gz_blur_cells(frame->width, level) *
	       (size_t)gz_blur_cells(frame->height, level);
}

/* Give out @p count floats from @p used on, whole lines of the caches. */
static float *take_floats(float *memory, size_t count, size_t *used)
{
	float *taken = memory ? memory + *used : NULL;
	*used += (count + 15) / 16 * 16;
	return taken;
}

/* What there must be room for besides what settings ask for. */
struct picture_needs {
	int threads;
	bool map;
};

/* Lay all planes of a frame out one after the other. @param memory  NULL: only to count
 * @return floats in all */
static size_t lay_planes_out(struct gz_shading_picture *picture,
			     const struct gz_shading_frame *frame, const bool wanted[BLURS],
			     const struct picture_needs *needs, float *memory)
{
	size_t used = 0;
	const size_t threads = (size_t)needs->threads;
	picture->map = needs->map ? take_floats(memory, cells_of_level(frame, 0), &used) : NULL;
	picture->row_room = take_floats(memory, threads * 2 * (size_t)frame->width, &used);
	for (int level = 0; level < LEVELS; level++) {
		bool needed = level > 0 && level <= picture->levels_most;
		for (int i = 0; i < BLURS; i++)
			needed |= wanted[i] && picture->blurs[i].level == level;
		picture->levels[level] = NULL;
		if (needed)
			picture->levels[level] =
				take_floats(memory, cells_of_level(frame, level), &used);
	}
	for (int i = 0; i < BLURS; i++) {
		const size_t cells = cells_of_level(frame, picture->blurs[i].level);
		picture->rows[i] = wanted[i] ? take_floats(memory, cells, &used) : NULL;
		picture->blurred[i] = wanted[i] ? take_floats(memory, cells, &used) : NULL;
	}
	return used;
}

static enum gz_result make_picture_room(struct gz_shading_picture *picture,
					const struct gz_shading_frame *frame,
					const struct gz_shading_settings *settings,
					const struct picture_needs *needs)
{
	const int threads = needs->threads;
	bool wanted[BLURS];
	if (picture->room_count < threads) {
		free(picture->rooms);
		picture->room_count = 0;
		picture->rooms = calloc((size_t)threads, sizeof *picture->rooms);
		if (!picture->rooms)
			return GZ_ERR_NO_MEM;
		picture->room_count = threads;
	}
	const size_t tiles = (size_t)gz_shading_tiles(frame->width, GZ_SHADING_TILE_COLUMNS) *
			     (size_t)gz_shading_tiles(frame->height, GZ_SHADING_TILE_ROWS);
	if (picture->filled_room < tiles) {
		free(picture->filled);
		picture->filled_room = 0;
		picture->filled = malloc(tiles);
		if (!picture->filled)
			return GZ_ERR_NO_MEM;
		picture->filled_room = tiles;
	}
	memset(picture->filled, 0, tiles);
	plan_blurs(picture, frame, settings, wanted);
	const size_t floats = lay_planes_out(picture, frame, wanted, needs, NULL);
	if (picture->capacity < floats) {
		free(picture->memory);
		picture->capacity = 0;
		picture->memory = aligned_alloc(64, floats * sizeof *picture->memory);
		if (!picture->memory)
			return GZ_ERR_NO_MEM;
		picture->capacity = floats;
	}
	(void)lay_planes_out(picture, frame, wanted, needs, picture->memory);
	return GZ_OK;
}

/* Look at a row. Returns its depth as shares of the scene's: in its plane if there is one,
 * otherwise in the room; NULL if no blur is wanted. */
static float *survey_row(const struct picture_job *job, int y, float *room)
{
	const struct gz_shading_picture *picture = job->picture;
	const size_t width = (size_t)job->frame->width;
	float *pixels = picture->levels[0], *shares = NULL;
	if (picture->levels_most >= 0)
		shares = pixels ? pixels + (size_t)y * width : room;
	gz_shading_row_survey(job->frame, y, &job->shared.range,
			      picture->filled + (ptrdiff_t)(y / GZ_SHADING_TILE_ROWS) *
							job->shared.tile_columns,
			      shares);
	return shares;
}

/* Rows [first, end) of a level that lie in a part. */
static struct gz_plane_band band_of_level(const struct gz_shading_frame *frame, int level,
					  size_t part)
{
	const int height = gz_blur_cells(frame->height, level), rows = REDUCED_ROWS >> level;
	const int first = (int)part * rows, rest = height - first;
	return (struct gz_plane_band) { gz_blur_cells(frame->width, level), height, first,
					first + (rest < rows ? rest : rows) };
}

/* Look at the rows of a part, and make the first rows of cells. */
static void reduce_pixels(const struct picture_job *job, size_t part, int worker)
{
	const struct gz_shading_picture *picture = job->picture;
	const int width = job->frame->width;
	const struct gz_plane_band band = band_of_level(job->frame, 0, part);
	float *room = picture->row_room + (size_t)worker * 2 * (size_t)width;
	for (int y = band.first; y < band.end; y += 2) {
		const float *upper = survey_row(job, y, room);
		const float *lower =
			y + 1 < band.end ? survey_row(job, y + 1, room + width) : upper;
		if (picture->levels_most > 0)
			gz_depth_halve(upper, lower, width,
				       picture->levels[1] +
					       (ptrdiff_t)(y / 2) * gz_blur_cells(width, 1));
	}
}

/* Cells of a level from those of the level before it. */
static void reduce_cells(const struct picture_job *job, int level, size_t part)
{
	const struct gz_shading_picture *picture = job->picture;
	const struct gz_plane_band band = band_of_level(job->frame, level, part);
	const int width = gz_blur_cells(job->frame->width, level - 1);
	const int height = gz_blur_cells(job->frame->height, level - 1);
	for (int y = band.first; y < band.end; y++) {
		const float *upper = picture->levels[level - 1] + (ptrdiff_t)(2 * y) * width;
		const float *lower = 2 * y + 1 < height ? upper + width : upper;
		gz_depth_halve(upper, lower, width,
			       picture->levels[level] + (ptrdiff_t)y * band.width);
	}
}

/* Count the tone of every second pixel of every second row: what is between is like it. */
static void count_tones(const struct picture_job *job, size_t part, int worker)
{
	const struct gz_shading_frame *frame = job->frame;
	const struct gz_plane_band band = band_of_level(frame, 0, part);
	for (int y = band.first; y < band.end; y += 2) {
		const size_t from = (size_t)y * (size_t)frame->width;
		gz_tone_count((const char *)frame->tone + from * sizeof(float), frame->ids + from,
			      (size_t)frame->width, 2, &job->picture->rooms[worker].histogram);
	}
}

/* Before the histogram is complete: count tones, reduce depth, and blur it along rows. */
static void reduce_part(void *user, size_t part, int worker)
{
	const struct picture_job *job = user;
	const struct gz_shading_picture *picture = job->picture;
	count_tones(job, part, worker);
	reduce_pixels(job, part, worker);
	for (int level = 2; level <= picture->levels_most; level++)
		reduce_cells(job, level, part);
	for (int i = 0; i < BLURS; i++) {
		const struct gz_depth_blur *blur = &picture->blurs[i];
		const struct gz_plane_band band = band_of_level(job->frame, blur->level, part);
		if (picture->rows[i])
			gz_blur_along_rows(&blur->gaussian, &band, picture->levels[blur->level],
					   picture->rows[i]);
	}
}

static void blur_part(void *user, size_t part, int worker)
{
	const struct picture_job *job = user;
	const struct gz_shading_picture *picture = job->picture;
	(void)worker;
	for (int i = 0; i < BLURS; i++) {
		const struct gz_depth_blur *blur = &picture->blurs[i];
		const struct gz_plane_band band = band_of_level(job->frame, blur->level, part);
		if (picture->blurred[i])
			gz_blur_along_columns(&blur->gaussian, &band, picture->rows[i],
					      picture->blurred[i]);
	}
}

static void compose_part(void *user, size_t part, int worker)
{
	const struct picture_job *job = user;
	for (int x = 0; x < job->frame->width; x += GZ_SHADING_TILE_COLUMNS)
		gz_shading_tile_compose(&job->shared, x, (int)part * GZ_SHADING_TILE_ROWS,
					&job->picture->rooms[worker].tile);
}

static struct gz_blurred_cells blurred_cells(const struct picture_job *job, enum blur_use use)
{
	const int level = job->picture->blurs[use].level;
	return (struct gz_blurred_cells) { level, gz_blur_cells(job->frame->width, level),
					   gz_blur_cells(job->frame->height, level),
					   job->picture->blurred[use] };
}

struct gz_shading_weights gz_shading_weights_of(const struct gz_shading_settings *settings)
{
	return (struct gz_shading_weights) {
		.scene = 1,
		.edge_light = (float)settings->edge_light,
		.overlap_shadow = (float)settings->overlap_shadow,
		.haze = (float)settings->haze,
		.lines = (float)settings->lines,
		.background = (float)settings->haze_background,
	};
}

static void begin_frame(struct picture_job *job, const struct gz_shading_settings *settings)
{
	struct gz_shading_picture *picture = job->picture;
	gz_haze_table_make(settings->haze_near, settings->haze_far, settings->haze_exponent,
			   &picture->haze);
	for (int i = 0; i < picture->room_count; i++)
		picture->rooms[i].histogram = (struct gz_tone_histogram) { 0 };
	job->shared = (struct gz_shading_shared) {
		.frame = job->frame,
		.settings = settings,
		.range = { job->frame->near, job->frame->far },
		.edge = blurred_cells(job, BLUR_EDGE),
		.shadow = blurred_cells(job, BLUR_SHADOW),
		.curve = &picture->curve,
		.haze = &picture->haze,
		.map = picture->map,
		.filled = picture->filled,
		.tile_columns = gz_shading_tiles(job->frame->width, GZ_SHADING_TILE_COLUMNS),
		.weights = gz_shading_weights_of(settings),
	};
}

/* The curve of all workers' counts. */
static void make_curve(struct gz_shading_picture *picture, float equalisation)
{
	struct gz_tone_histogram *all = &picture->rooms[0].histogram;
	for (int i = 1; i < picture->room_count; i++)
		for (size_t bin = 0; bin < GZ_TONE_BINS; bin++)
			all->counts[bin] += picture->rooms[i].histogram.counts[bin];
	gz_tone_curve_make(all, 1, &picture->curve);
	gz_tone_curve_steady(&picture->curve);
	gz_tone_curve_soften(equalisation, &picture->curve);
}

enum gz_result gz_shading_picture_compose(struct gz_shading_picture *picture,
					  const struct gz_shading_frame *frame,
					  const struct gz_shading_settings *settings,
					  struct gz_workers *workers, uint32_t *out_pixels,
					  const float **out_map)
{
	struct picture_job job = { .picture = picture, .frame = frame };
	if (frame->width < 1 || frame->height < 1 || !(frame->near < frame->far) ||
	    !gz_options_hold(gz_shading_options, gz_shading_option_count, settings))
		return GZ_ERR_INVAL;
	const struct picture_needs needs = { gz_workers_count(workers), out_map };
	const enum gz_result result = make_picture_room(picture, frame, settings, &needs);
	if (result != GZ_OK)
		return result;
	const size_t height = (size_t)frame->height;
	const size_t reduced = (height + REDUCED_ROWS - 1) / REDUCED_ROWS;
	begin_frame(&job, settings);
	job.shared.out_pixels = out_pixels;
	gz_workers_run(workers, reduce_part, &job, reduced);
	if (!frame->keeps_curve)
		make_curve(picture, (float)settings->equalisation);
	if (picture->levels_most >= 0)
		gz_workers_run(workers, blur_part, &job, reduced);
	gz_workers_run(workers, compose_part, &job,
		       (height + GZ_SHADING_TILE_ROWS - 1) / GZ_SHADING_TILE_ROWS);
	if (out_map)
		*out_map = picture->map;
	return GZ_OK;
}

void gz_shading_grey(const float *map, size_t count, uint32_t *out_pixels)
{
	grey_loop(map, count, out_pixels);
}
