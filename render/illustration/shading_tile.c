#include "render/illustration/shading_tile.h"

#include <stddef.h>
#include <string.h>

enum {
	COLUMNS = GZ_SHADING_TILE_COLUMNS,
	PIXELS = GZ_SHADING_TILE_PIXELS,
	REACH = GZ_LINE_REACH,
	WINDOW_COLUMNS = COLUMNS + 2 * REACH,
};

/* How much farther than a pixel its neighbours are at an inner line, share of the scene's depth.
 * Chosen: folds of a bone show, and its round sides do not. */
#define LINE_THRESHOLD 0.004F

/* The part of a tile that lies in the picture. */
struct tile_place {
	int x, y, columns, rows;
};

static struct tile_place place_of_tile(const struct gz_shading_frame *frame, int x, int y)
{
	const int columns = frame->width - x, rows = frame->height - y;
	return (struct tile_place) { x, y, columns < COLUMNS ? columns : COLUMNS,
				     rows < GZ_SHADING_TILE_ROWS ? rows : GZ_SHADING_TILE_ROWS };
}

static size_t pixel_at(const struct gz_shading_frame *frame, int x, int y)
{
	return (size_t)y * (size_t)frame->width + (size_t)x;
}

static bool tile_is_empty(const struct gz_shading_frame *frame, const struct tile_place *place)
{
	uint32_t any = 0;
	for (int row = 0; row < place->rows; row++) {
		const uint32_t *ids = frame->ids + pixel_at(frame, place->x, place->y + row);
		for (int i = 0; i < place->columns; i++)
			any |= ids[i];
	}
	return any == 0;
}

/* An index of a row or column whose border repeats. */
static int clamp_to(int index, int count)
{
	if (index < 0)
		return 0;
	return index < count ? index : count - 1;
}

/* A row of the window, where it reaches beyond the left or right border. */
static void fill_border_row(const struct gz_shading_shared *shared, int x, int y, uint32_t *ids,
			    float *depth)
{
	const struct gz_shading_frame *frame = shared->frame;
	uint32_t words[WINDOW_COLUMNS];
	for (int i = 0; i < WINDOW_COLUMNS; i++) {
		const size_t pixel = pixel_at(frame, clamp_to(x - REACH + i, frame->width), y);
		ids[i] = frame->ids[pixel];
		memcpy(&words[i], (const char *)frame->depth + pixel * sizeof *words,
		       sizeof *words);
	}
	gz_depth_share(words, ids, WINDOW_COLUMNS, &shared->range, depth);
}

static void fill_window(const struct gz_shading_shared *shared, const struct tile_place *place,
			struct gz_line_window *window)
{
	const struct gz_shading_frame *frame = shared->frame;
	const int x = place->x;
	const bool inside = x >= REACH && x + COLUMNS + REACH <= frame->width;
	for (int row = 0; row < place->rows + 2 * REACH; row++) {
		const int y = clamp_to(place->y - REACH + row, frame->height);
		if (!inside) {
			fill_border_row(shared, x, y, window->ids[row], window->depth[row]);
			continue;
		}
		const size_t from = pixel_at(frame, x - REACH, y);
		memcpy(window->ids[row], frame->ids + from, sizeof window->ids[row]);
		gz_depth_share((const char *)frame->depth + from * sizeof(float), window->ids[row],
			       WINDOW_COLUMNS, &shared->range, window->depth[row]);
	}
}

/* Copy the pixels of a tile from a plane of words or floats. */
static void copy_tile(const struct gz_shading_frame *frame, const struct tile_place *place,
		      const void *plane, void *out_pixels)
{
	for (int row = 0; row < place->rows; row++)
		memcpy((char *)out_pixels + (size_t)row * COLUMNS * sizeof(uint32_t),
		       (const char *)plane +
			       pixel_at(frame, place->x, place->y + row) * sizeof(uint32_t),
		       (size_t)place->columns * sizeof(uint32_t));
}

/* Ids, depth and tone; beyond the picture's right border there is background. */
static void fill_tile(const struct gz_shading_shared *shared, const struct tile_place *place,
		      struct gz_shading_tile *tile)
{
	fill_window(shared, place, &tile->window);
	for (int row = 0; row < place->rows; row++) {
		const size_t bytes = COLUMNS * sizeof *tile->depth;
		memcpy(tile->ids + (size_t)row * COLUMNS, &tile->window.ids[REACH + row][REACH],
		       bytes);
		memcpy(tile->depth + (size_t)row * COLUMNS, &tile->window.depth[REACH + row][REACH],
		       bytes);
		for (int i = place->columns; i < COLUMNS; i++)
			tile->ids[row * COLUMNS + i] = 0;
	}
	copy_tile(shared->frame, place, shared->frame->tone, tile->map);
}

/* Gather what scene information takes away: 1 - scene = product of all 1 - w P. */
static void gather_information(const float *restrict values, size_t count, double weight,
			       float *restrict scene)
{
	for (size_t i = 0; i < count; i++)
		scene[i] = 1 - (1 - scene[i]) * (1 - (float)weight * values[i]);
}

static bool fill_scene(const struct gz_shading_shared *shared, const struct tile_place *place,
		       struct gz_shading_tile *tile)
{
	const struct gz_shading_frame *frame = shared->frame;
	const struct gz_shading_settings *settings = shared->settings;
	const size_t count = (size_t)place->rows * COLUMNS;
	const bool by_object = settings->object_distance > 0 && frame->object_distance_mm;
	if (!(settings->importance > 0) && !(settings->viewer_distance > 0) && !by_object)
		return false;
	memset(tile->scene, 0, count * sizeof *tile->scene);
	if (settings->importance > 0) {
		gz_shading_unimportance(tile->ids, count, frame->importances, frame->objects,
					tile->room);
		gather_information(tile->room, count, settings->importance, tile->scene);
	}
	if (settings->viewer_distance > 0)
		gather_information(tile->depth, count, settings->viewer_distance, tile->scene);
	if (by_object) {
		copy_tile(frame, place, frame->object_distance_mm, tile->other_room);
		gz_shading_object_distance(tile->other_room, count,
					   (float)settings->object_distance_mm, tile->room);
		gather_information(tile->room, count, settings->object_distance, tile->scene);
	}
	return true;
}

/* The tile of blurred depth; NULL if it is not wanted. */
static const float *enlarge_tile(const struct gz_blurred_cells *blurred,
				 const struct tile_place *place, float *out_pixels)
{
	if (!blurred->cells)
		return NULL;
	for (int row = 0; row < place->rows; row++)
		gz_depth_enlarge(blurred->cells, blurred->width, blurred->height, blurred->level,
				 place->x, place->y + row, out_pixels + (size_t)row * COLUMNS);
	return out_pixels;
}

static void fill_lines(const struct gz_shading_settings *settings, int rows,
		       struct gz_shading_tile *tile, struct gz_shading_layers *layers)
{
	const int width = settings->line_width;
	gz_feature_lines(&tile->window, rows, (enum gz_line_filter)(GZ_LINES_4 + width - 1),
			 LINE_THRESHOLD, tile->strong);
	layers->strong_lines = tile->strong;
	if (width == 1 && !layers->scene)
		return;
	gz_feature_lines(&tile->window, rows, GZ_LINES_4, LINE_THRESHOLD, tile->thin);
	layers->thin_lines = tile->thin;
}

/* A tile without objects is white. */
static void write_empty_tile(const struct gz_shading_shared *shared, const struct tile_place *place)
{
	for (int row = 0; row < place->rows; row++) {
		const size_t to = pixel_at(shared->frame, place->x, place->y + row);
		for (int i = 0; i < place->columns; i++)
			shared->map[to + (size_t)i] = 1;
		for (int i = 0; shared->frame->lines_apart && i < place->columns; i++)
			shared->frame->lines_apart[to + (size_t)i] = 1;
		if (shared->out_pixels)
			memset(shared->out_pixels + to, 0xFF,
			       (size_t)place->columns * sizeof *shared->out_pixels);
	}
}

static void write_tile(const struct gz_shading_shared *shared, const struct tile_place *place,
		       const float *map, const float *apart)
{
	const struct gz_shading_frame *frame = shared->frame;
	for (int row = 0; row < place->rows; row++) {
		const size_t to = pixel_at(frame, place->x, place->y + row);
		const float *from = map + (size_t)row * COLUMNS;
		memcpy(shared->map + to, from, (size_t)place->columns * sizeof *map);
		if (frame->lines_apart)
			memcpy(frame->lines_apart + to, apart + (size_t)row * COLUMNS,
			       (size_t)place->columns * sizeof *apart);
		if (shared->out_pixels)
			gz_shading_grey(from, (size_t)place->columns, shared->out_pixels + to);
	}
}

void gz_shading_tile_compose(const struct gz_shading_shared *shared, int x, int y,
			     struct gz_shading_tile *tile)
{
	const struct tile_place place = place_of_tile(shared->frame, x, y);
	const struct gz_plane_band all = { COLUMNS, place.rows, 0, place.rows };
	const size_t count = (size_t)place.rows * COLUMNS;
	if (tile_is_empty(shared->frame, &place)) {
		write_empty_tile(shared, &place);
		return;
	}
	fill_tile(shared, &place, tile);
	struct gz_shading_layers layers = { .ids = tile->ids, .depth = tile->depth };
	if (fill_scene(shared, &place, tile))
		layers.scene = tile->scene;
	layers.blurred_edge = enlarge_tile(&shared->edge, &place, tile->edge);
	layers.blurred_shadow = enlarge_tile(&shared->shadow, &place, tile->shadow);
	if (shared->settings->haze > 0) {
		gz_shading_haze(tile->depth, count, shared->haze, tile->haze);
		layers.haze = tile->haze;
	}
	if (shared->settings->lines > 0)
		fill_lines(shared->settings, place.rows, tile, &layers);
	if (shared->frame->lines_apart) {
		for (size_t i = 0; i < count; i++)
			tile->apart[i] = 1;
		layers.apart = tile->apart;
	}
	gz_tone_apply(shared->curve, tile->ids, count, tile->map);
	const bool own = shared->frame->weights && shared->frame->objects > 0;
	gz_shading_map_compose(&layers, &all, own ? shared->frame->weights : &shared->weights,
			       own ? shared->frame->objects : 1, tile->map);
	write_tile(shared, &place, tile->map, tile->apart);
}
