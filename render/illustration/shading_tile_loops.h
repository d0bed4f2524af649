/*
 * The steps of shading_tile.h, compiled once for each instruction set (plane_kernels.h), row by
 * row, so that what is between them stays in the first-level cache. Nothing in them is fused, so
 * the bits are the same.
 */
#ifndef GZ_RENDER_ILLUSTRATION_SHADING_TILE_LOOPS_H
#define GZ_RENDER_ILLUSTRATION_SHADING_TILE_LOOPS_H

#include <stddef.h>
#include <string.h>

#include "render/illustration/depth_blur_loops.h"
#include "render/illustration/feature_lines_loops.h"
#include "render/illustration/shading_map_loops.h"
#include "render/illustration/shading_parameter_loops.h"
#include "render/illustration/shading_tile.h"
#include "render/illustration/tone_loops.h"

enum { TILE_COLUMNS = GZ_SHADING_TILE_COLUMNS };

/* How much farther than a pixel its neighbours are at an inner line, share of the scene's depth.
 * Chosen: folds of a bone show, and its round sides do not. */
#define LINE_THRESHOLD 0.004F

/* The part of a tile that lies in the picture. */
struct tile_place {
	int x, y, columns, rows;
};

/* Planes of one row of a tile. */
struct tile_row {
	const uint32_t *ids; /* of the window, as are depths */
	const float *depth;
	float map[TILE_COLUMNS], scene[TILE_COLUMNS], haze[TILE_COLUMNS];
	float edge[TILE_COLUMNS], shadow[TILE_COLUMNS], apart[TILE_COLUMNS];
};

/* The place of the tile whose first pixel is (x, y). */
static inline struct tile_place place_of_tile(const struct gz_shading_frame *frame, int x, int y)
{
	const int columns = frame->width - x, rows = frame->height - y;
	return (struct tile_place) { x, y, columns < TILE_COLUMNS ? columns : TILE_COLUMNS,
				     rows < GZ_SHADING_TILE_ROWS ? rows : GZ_SHADING_TILE_ROWS };
}

/* The number of a pixel in a plane. */
static inline size_t pixel_at(const struct gz_shading_frame *frame, int x, int y)
{
	return (size_t)y * (size_t)frame->width + (size_t)x;
}

/* Whether none of some pixels shows an object. */
static inline bool all_are_empty(const uint32_t *ids, int count)
{
	uint32_t any = 0;
	for (int i = 0; i < count; i++)
		any |= ids[i];
	return any == 0;
}

/* Survey the pixels of a row that lie in one tile. */
static inline bool survey_block(const struct gz_shading_frame *frame, size_t from, int count,
				const struct gz_depth_range *range, float *restrict shares)
{
	const bool empty = all_are_empty(frame->ids + from, count);
	for (int i = 0; i < count && shares && empty; i++)
		shares[i] = 1;
	if (shares && !empty)
		share_depth((const char *)frame->depth + from * sizeof(float), frame->ids + from,
			    count, range, shares);
	return !empty;
}

/* gz_shading_row_survey() */
static void survey_row(const struct gz_shading_frame *frame, int y,
		       const struct gz_depth_range *range, uint8_t *filled, float *out_shares)
{
	const size_t row = pixel_at(frame, 0, y);
	for (int x = 0, k = 0; x < frame->width; x += TILE_COLUMNS, k++) {
		const int rest = frame->width - x;
		float *shares = out_shares ? out_shares + x : NULL;
		if (rest >= TILE_COLUMNS)
			filled[k] |=
				survey_block(frame, row + (size_t)x, TILE_COLUMNS, range, shares);
		else
			filled[k] |= survey_block(frame, row + (size_t)x, rest, range, shares);
	}
}

/* A row of the window, where it reaches beyond the left or right border. */
static inline void fill_border_row(const struct gz_shading_shared *shared, int x, int y,
				   uint32_t *ids, float *depth)
{
	const struct gz_shading_frame *frame = shared->frame;
	uint32_t words[WINDOW_COLUMNS];
	for (int i = 0; i < WINDOW_COLUMNS; i++) {
		const size_t pixel = pixel_at(frame, clamp_index(x - REACH + i, frame->width), y);
		ids[i] = frame->ids[pixel];
		memcpy(&words[i], (const char *)frame->depth + pixel * sizeof *words,
		       sizeof *words);
	}
	share_depth(words, ids, WINDOW_COLUMNS, &shared->range, depth);
}

/* Ids and depth of a tile and what surrounds it; beyond the picture its border repeats. */
static inline void fill_window(const struct gz_shading_shared *shared,
			       const struct tile_place *place, struct gz_line_window *window)
{
	const struct gz_shading_frame *frame = shared->frame;
	const int x = place->x;
	const bool inside = x >= REACH && x + TILE_COLUMNS + REACH <= frame->width;
	for (int row = 0; row < place->rows + 2 * REACH; row++) {
		const int y = clamp_index(place->y - REACH + row, frame->height);
		if (!inside) {
			fill_border_row(shared, x, y, window->ids[row], window->depth[row]);
			continue;
		}
		const size_t from = pixel_at(frame, x - REACH, y);
		memcpy(window->ids[row], frame->ids + from, sizeof window->ids[row]);
		share_depth((const char *)frame->depth + from * sizeof(float), window->ids[row],
			    WINDOW_COLUMNS, &shared->range, window->depth[row]);
	}
}

/* Copy a row of a tile from a plane of words or floats; beyond the picture's right border there is
 * 0. */
static inline void copy_row(const void *plane, size_t from, int columns,
			    float out_pixels[TILE_COLUMNS])
{
	const char *pixels = (const char *)plane + from * sizeof *out_pixels;
	if (columns == TILE_COLUMNS) {
		memcpy(out_pixels, pixels, TILE_COLUMNS * sizeof *out_pixels);
		return;
	}
	memset(out_pixels, 0, TILE_COLUMNS * sizeof *out_pixels);
	memcpy(out_pixels, pixels, (size_t)columns * sizeof *out_pixels);
}

/* Gather what scene information takes away: 1 - scene = product of all 1 - w P. */
static inline void gather_information(const float *restrict values, double weight,
				      float *restrict scene)
{
	for (int i = 0; i < TILE_COLUMNS; i++)
		scene[i] = 1 - (1 - scene[i]) * (1 - (float)weight * values[i]);
}

/* Whether scene information counts, and the distance to an object with it. */
static inline bool wants_scene(const struct gz_shading_shared *shared, bool *out_by_object)
{
	const struct gz_shading_settings *settings = shared->settings;
	*out_by_object = settings->object_distance > 0 && shared->frame->object_distance_mm;
	return settings->importance > 0 || settings->viewer_distance > 0 || *out_by_object;
}

/* @param from  the row's first pixel in the frame's planes @return whether it counts */
static inline bool fill_scene(const struct gz_shading_shared *shared, size_t from, int columns,
			      struct tile_row *row)
{
	const struct gz_shading_frame *frame = shared->frame;
	const struct gz_shading_settings *settings = shared->settings;
	float room[TILE_COLUMNS], distances[TILE_COLUMNS];
	bool by_object;
	if (!wants_scene(shared, &by_object))
		return false;
	memset(row->scene, 0, sizeof row->scene);
	if (settings->importance > 0) {
		unimportance_loop(row->ids, TILE_COLUMNS, frame->importances, frame->objects, room);
		gather_information(room, settings->importance, row->scene);
	}
	if (settings->viewer_distance > 0)
		gather_information(row->depth, settings->viewer_distance, row->scene);
	if (by_object) {
		copy_row(frame->object_distance_mm, from, columns, distances);
		object_distance_loop(distances, TILE_COLUMNS, (float)settings->object_distance_mm,
				     room);
		gather_information(room, settings->object_distance, row->scene);
	}
	return true;
}

/* A row of blurred depth; NULL if it is not wanted. */
static inline const float *enlarge_blurred(const struct gz_blurred_cells *blurred, int x, int y,
					   float *out_pixels)
{
	if (!blurred->cells)
		return NULL;
	enlarge_cells(blurred->cells, blurred->width, blurred->height, blurred->level, x, y,
		      out_pixels);
	return out_pixels;
}

/* What lines a tile has: NULL where there are none of a kind. */
struct tile_lines {
	const float *strong, *thin;
};

/* Find the lines of a tile whose window is filled. */
static inline struct tile_lines fill_lines(const struct gz_shading_shared *shared, int rows,
					   struct gz_shading_tile *tile)
{
	const int width = shared->settings->line_width;
	bool by_object;
	if (!(shared->settings->lines > 0) ||
	    !find_lines(&tile->window, rows, (enum gz_line_filter)(GZ_LINES_4 + width - 1),
			LINE_THRESHOLD, tile->strong))
		return (struct tile_lines) { 0 };
	if (width == 1 && !wants_scene(shared, &by_object))
		return (struct tile_lines) { tile->strong, NULL };
	(void)find_lines(&tile->window, rows, GZ_LINES_4, LINE_THRESHOLD, tile->thin);
	return (struct tile_lines) { tile->strong, tile->thin };
}

/* Write what is wanted of a row, from number @p to on in the planes. */
static inline void write_row(const struct gz_shading_shared *shared, size_t to, int columns,
			     const float *map, const float *apart)
{
	if (shared->map)
		memcpy(shared->map + to, map, (size_t)columns * sizeof *map);
	if (shared->frame->lines_apart)
		memcpy(shared->frame->lines_apart + to, apart, (size_t)columns * sizeof *apart);
	if (!shared->out_pixels)
		return;
	if (columns == TILE_COLUMNS)
		grey_loop(map, TILE_COLUMNS, shared->out_pixels + to);
	else
		grey_loop(map, (size_t)columns, shared->out_pixels + to);
}

/* Without objects a row is white. */
static inline void write_empty_row(const struct gz_shading_shared *shared, size_t to, int columns)
{
	float white[TILE_COLUMNS];
	for (int i = 0; i < TILE_COLUMNS; i++)
		white[i] = 1;
	write_row(shared, to, columns, white, white);
}

/* Compose a row of a tile, whose window and lines are made. */
static inline void compose_row(const struct gz_shading_shared *shared,
			       const struct tile_place *place, int y,
			       const struct gz_shading_tile *tile, const struct tile_lines *lines)
{
	const struct gz_shading_frame *frame = shared->frame;
	const size_t at = pixel_at(frame, place->x, place->y + y);
	const bool own = frame->weights && frame->objects > 0;
	const struct gz_plane_band whole = { TILE_COLUMNS, 1, 0, 1 };
	struct tile_row row; /* planes that are not wanted stay undefined */
	row.ids = &tile->window.ids[REACH + y][REACH];
	row.depth = &tile->window.depth[REACH + y][REACH];
	if (all_are_empty(row.ids, TILE_COLUMNS)) {
		write_empty_row(shared, at, place->columns);
		return;
	}
	struct gz_shading_layers layers = { .ids = row.ids, .depth = row.depth };
	copy_row(frame->tone, at, place->columns, row.map);
	if (fill_scene(shared, at, place->columns, &row))
		layers.scene = row.scene;
	layers.blurred_edge = enlarge_blurred(&shared->edge, place->x, place->y + y, row.edge);
	layers.blurred_shadow =
		enlarge_blurred(&shared->shadow, place->x, place->y + y, row.shadow);
	if (shared->settings->haze > 0) {
		haze_loop(row.depth, TILE_COLUMNS, shared->haze, row.haze);
		layers.haze = row.haze;
	}
	layers.strong_lines = lines->strong ? lines->strong + (ptrdiff_t)y * TILE_COLUMNS : NULL;
	layers.thin_lines = lines->thin ? lines->thin + (ptrdiff_t)y * TILE_COLUMNS : NULL;
	for (int i = 0; i < TILE_COLUMNS && frame->lines_apart; i++)
		row.apart[i] = 1;
	layers.apart = frame->lines_apart ? row.apart : NULL;
	tone_apply_loop(shared->curve, row.ids, TILE_COLUMNS, row.map);
	map_compose_loop(&layers, &whole, own ? frame->weights : &shared->weights,
			 own ? frame->objects : 1, row.map);
	write_row(shared, at, place->columns, row.map, row.apart);
}

/* gz_shading_tile_compose() */
static void compose_tile(const struct gz_shading_shared *shared, int x, int y,
			 struct gz_shading_tile *tile)
{
	const struct tile_place place = place_of_tile(shared->frame, x, y);
	if (!shared->filled[y / GZ_SHADING_TILE_ROWS * shared->tile_columns + x / TILE_COLUMNS]) {
		for (int row = 0; row < place.rows; row++)
			write_empty_row(shared, pixel_at(shared->frame, x, y + row), place.columns);
		return;
	}
	fill_window(shared, &place, &tile->window);
	const struct tile_lines lines = fill_lines(shared, place.rows, tile);
	for (int row = 0; row < place.rows; row++)
		compose_row(shared, &place, row, tile, &lines);
}

#endif
