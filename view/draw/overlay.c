#include "view/draw/overlay.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <GL/glew.h>

/* Made from shaders/ when the program is built. */
extern const char gz_glsl_overlay_frag[];

void gz_viridis(double share, uint8_t out_rgb[3])
{
	static const uint8_t places[][3] = {
		{ 68, 1, 84 },    { 72, 40, 120 },  { 62, 74, 137 },  { 49, 104, 142 },
		{ 38, 130, 142 }, { 31, 158, 137 }, { 53, 183, 121 }, { 109, 205, 89 },
		{ 180, 222, 44 }, { 253, 231, 37 },
	};
	const int last = (int)(sizeof places / sizeof places[0]) - 1;
	const double at = last * fmin(1, fmax(0, share));
	const int from = at < last ? (int)at : last - 1;
	for (int i = 0; i < 3; i++)
		out_rgb[i] = (uint8_t)lround(places[from][i] +
					     (at - from) * (places[from + 1][i] - places[from][i]));
}

double gz_plan_cells_value(const struct gz_plan *plan, const struct gz_tile *tile,
			   enum gz_view_overlay overlay)
{
	if (overlay == GZ_OVERLAY_STEP)
		return (double)plan->steps[tile->step];
	const double spacing = plan->layers[tile->layer].spacing;
	return tile->pattern == GZ_TILE_QUINCUNX ? spacing * sqrt(2) : spacing;
}

double gz_plan_cells_share(double value, double end)
{
	return fmin(1, fmax(0, log2(value) / log2(end)));
}

static void paint_block(struct gz_plan_cells *cells, int column, int row, const int size[2],
			const uint8_t colour[4])
{
	const int right = column + size[0] < cells->columns ? column + size[0] : cells->columns;
	const int bottom = row + size[1] < cells->rows ? row + size[1] : cells->rows;
	for (int y = row; y < bottom; y++) {
		uint8_t *at = cells->rgba + 4 * ((size_t)y * (size_t)cells->columns);
		for (int x = column; x < right; x++)
			memcpy(at + 4 * (size_t)x, colour, 4);
	}
}

static void paint_tile(struct gz_plan_cells *cells, const struct gz_plan *plan,
		       const struct gz_tile *tile, enum gz_view_overlay overlay)
{
	const int spacing = plan->layers[tile->layer].spacing;
	/* A row of a diagonal lattice has every second point only. */
	const int size[2] = { tile->pattern == GZ_TILE_QUINCUNX ? 2 * spacing : spacing, spacing };
	uint8_t colour[4] = { 0, 0, 0, 255 };
	gz_viridis(gz_plan_cells_share(gz_plan_cells_value(plan, tile, overlay), cells->end),
		   colour);
	paint_block(cells, tile->x / GZ_TILE_EDGE, tile->y / GZ_TILE_EDGE, size, colour);
}

static enum gz_result resize_cells(struct gz_plan_cells *cells, const struct gz_plan *plan)
{
	const int columns = (plan->width + GZ_TILE_EDGE - 1) / GZ_TILE_EDGE;
	const int rows = (plan->height + GZ_TILE_EDGE - 1) / GZ_TILE_EDGE;
	const size_t size = 4 * (size_t)columns * (size_t)rows;
	if (size > cells->capacity) {
		uint8_t *grown = realloc(cells->rgba, size);
		if (!grown)
			return GZ_ERR_NO_MEM;
		cells->rgba = grown;
		cells->capacity = size;
	}
	cells->columns = columns;
	cells->rows = rows;
	for (size_t i = 0; i < size; i++)
		cells->rgba[i] = i % 4 == 3 ? 255 : 0;
	return GZ_OK;
}

static void find_span(struct gz_plan_cells *cells, const struct gz_plan *plan,
		      enum gz_view_overlay overlay)
{
	cells->least = INFINITY;
	cells->most = 0;
	for (size_t i = 0; i < plan->tile_count; i++) {
		if (plan->tiles[i].replaced)
			continue;
		const double value = gz_plan_cells_value(plan, &plan->tiles[i], overlay);
		cells->least = fmin(cells->least, value);
		cells->most = fmax(cells->most, value);
	}
	cells->end = GZ_PLAN_CELLS_SCALE_LEAST;
	while (cells->end < cells->most)
		cells->end *= 2;
}

/* Where tiles overlap, the first layer is shown, and within a layer the square tile, which is
 * finer: these are painted last. */
enum gz_result gz_plan_cells_make(struct gz_plan_cells *cells, const struct gz_plan *plan,
				  enum gz_view_overlay overlay)
{
	const enum gz_result r = resize_cells(cells, plan);
	if (r != GZ_OK)
		return r;
	find_span(cells, plan, overlay);
	for (int layer = plan->layer_count - 1; layer >= 0; layer--)
		for (int pattern = GZ_TILE_PATTERN_COUNT - 1; pattern >= 0; pattern--)
			for (size_t i = 0; i < plan->tile_count; i++)
				if (plan->tiles[i].layer == layer &&
				    plan->tiles[i].pattern == pattern)
					paint_tile(cells, plan, &plan->tiles[i], overlay);
	return GZ_OK;
}

void gz_plan_cells_free(struct gz_plan_cells *cells)
{
	free(cells->rgba);
	*cells = (struct gz_plan_cells) { 0 };
}

enum gz_result gz_overlay_init(struct gz_overlay *overlay, const struct gz_log *log)
{
	*overlay = (struct gz_overlay) { 0 };
	const enum gz_result r =
		gz_fill_init(&overlay->fill, "overlay.frag", gz_glsl_overlay_frag, log);
	if (r != GZ_OK)
		return r;
	const unsigned program = overlay->fill.program;
	overlay->cells_per_picture = glGetUniformLocation(program, "cells_per_picture");
	overlay->cells_before = glGetUniformLocation(program, "cells_before");
	overlay->opacity = glGetUniformLocation(program, "opacity");
	return GZ_OK;
}

enum gz_result gz_overlay_follow(struct gz_overlay *overlay, const struct gz_plan *plan,
				 enum gz_view_overlay kind)
{
	if (overlay->serial == plan->serial && overlay->shown == (int)kind)
		return GZ_OK;
	const struct gz_plan_cells *cells = &overlay->cells;
	const enum gz_result r = gz_plan_cells_make(&overlay->cells, plan, kind);
	if (r != GZ_OK)
		return r;
	gz_fill_upload(&overlay->fill, cells->rgba, cells->columns, cells->rows);
	overlay->serial = plan->serial;
	overlay->shown = kind;
	return GZ_OK;
}

enum gz_result gz_overlay_draw(struct gz_overlay *overlay, const struct gz_plan *plan,
			       enum gz_view_overlay kind, double share, int width, int height)
{
	const enum gz_result r = gz_overlay_follow(overlay, plan, kind);
	if (r != GZ_OK)
		return r;
	const float cell = GZ_TILE_EDGE;
	gz_fill_use(&overlay->fill, width, height);
	glEnable(GL_SCISSOR_TEST);
	glScissor(0, 0, (int)lround(share * width), height);
	glEnable(GL_BLEND);
	glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
	glUniform2f(overlay->cells_per_picture, (float)plan->view.width / cell,
		    (float)plan->view.height / cell);
	glUniform2f(overlay->cells_before, (float)plan->view.shift[0] / cell,
		    (float)plan->view.shift[1] / cell);
	glUniform1f(overlay->opacity, GZ_OVERLAY_OPACITY);
	gz_fill_draw(&overlay->fill, overlay->fill.texture);
	glDisable(GL_BLEND);
	glDisable(GL_SCISSOR_TEST);
	return GZ_OK;
}

void gz_overlay_free(struct gz_overlay *overlay)
{
	gz_fill_free(&overlay->fill);
	gz_plan_cells_free(&overlay->cells);
	*overlay = (struct gz_overlay) { 0 };
}
