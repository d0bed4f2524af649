#include "render/reconstruct/gl/gl_plan.h"

#include <math.h>
#include <string.h>

#include <GL/glew.h>

#define GZ_LOG_MODULE "gl"

_Static_assert(GZ_GL_TILE_POINTS == GZ_TILE_PATTERN_COUNT * GZ_TILE_EDGE * GZ_TILE_EDGE,
	       "the block has a point for each ray of each pattern");
_Static_assert(GZ_PLAN_LAYERS_MAX <= 8 && GZ_TILE_PATTERN_COUNT <= 4 &&
		       GZ_GL_TILE_LEVELS_MAX <= 8 && GZ_PLAN_STEPS_MAX <= 256,
	       "a tile's numbers fit the bits they are packed into");

/* Place the lattices one after the other. The first layer of spacing 1 is the picture itself.
 * Unusual parameters give a second one, which has room of its own so that no two rays write one
 * pixel. */
static size_t lay_out_lattices(const struct gz_plan *plan, struct gz_gl_plan_block *block)
{
	size_t next = (size_t)plan->width * (size_t)plan->height;
	bool picture_taken = false;
	for (int i = 0; i < plan->layer_count; i++) {
		const struct gz_plan_layer *layer = &plan->layers[i];
		uint32_t *out = block->layers[i];
		const bool is_picture = layer->spacing == 1 && !picture_taken;
		out[0] = is_picture ? 0 : (uint32_t)next;
		out[1] = (uint32_t)layer->columns;
		out[2] = (uint32_t)layer->rows;
		out[3] = (uint32_t)layer->spacing;
		if (!is_picture)
			next += (size_t)layer->columns * (size_t)layer->rows;
		picture_taken |= is_picture;
	}
	return next;
}

static void fill_region_block(const struct gz_region *region, float place[4], float fade[4])
{
	for (int axis = 0; axis < 2; axis++) {
		place[axis] = (float)region->centre_px[axis];
		place[2 + axis] = (float)region->half_px[axis];
	}
	if (region->shape != GZ_REGION_ALL && region->blend_px > 0)
		fade[0] = (float)(fmin(region->half_px[0], region->half_px[1]) / region->blend_px);
	fade[1] = region->shape == GZ_REGION_ELLIPSE;
}

static void fill_plan_block(const struct gz_plan *plan, struct gz_gl_plan_block *block)
{
	block->plan[0] = (uint32_t)plan->layer_count;
	block->plan[1] = plan->reconstruction == GZ_RECONSTRUCT_PYRAMID;
	block->plan[2] = (uint32_t)plan->width;
	block->plan[3] = (uint32_t)plan->height;
	for (int i = 0; i < plan->layer_count; i++)
		fill_region_block(&plan->layers[i].region, block->region_places[i],
				  block->region_fades[i]);
	enum { RAYS = GZ_TILE_EDGE * GZ_TILE_EDGE };
	for (int i = 0; i < GZ_GL_TILE_POINTS; i++) {
		block->tile_points[i][0] = gz_tile_columns[i / RAYS][i % RAYS];
		block->tile_points[i][1] = gz_tile_rows[i % RAYS];
		block->tile_points[i][2] = gz_tile_phases[i / RAYS][i % RAYS];
	}
}

/* Find the ranges of a counting sort by layer and pattern. It keeps the plan's order within each,
 * so neighbours stay together, and a pass over one kind takes one range. */
static void find_tile_ranges(struct gz_gl_plan *gl_plan, const struct gz_plan *plan)
{
	memset(gl_plan->ranges, 0, sizeof gl_plan->ranges);
	for (size_t i = 0; i < plan->tile_count; i++)
		gl_plan->ranges[plan->tiles[i].layer][plan->tiles[i].pattern].count++;
	size_t first = 0;
	for (int layer = 0; layer < GZ_PLAN_LAYERS_MAX; layer++)
		for (int pattern = 0; pattern < GZ_TILE_PATTERN_COUNT; pattern++) {
			gl_plan->ranges[layer][pattern].first = first;
			first += gl_plan->ranges[layer][pattern].count;
		}
}

/* Extend a range to hold an item. */
static void extend_tile_range(struct gz_gl_tile_range *range, size_t item)
{
	const size_t end = range->first + range->count;
	const size_t first = range->count == 0 || item < range->first ? item : range->first;
	range->count = (range->count > 0 && end > item ? end : item + 1) - first;
	range->first = first;
}

size_t gz_gl_plan_place(const struct gz_gl_plan *gl_plan, const struct gz_tile *tile,
			struct gz_gl_tiles_placed *placed)
{
	return gl_plan->ranges[tile->layer][tile->pattern].first +
	       placed->count[tile->layer][tile->pattern]++;
}

/* Pack tiles into their ranges, each with its level of detail. */
static void pack_tiles(struct gz_gl_plan *gl_plan, const struct gz_plan *plan,
		       const struct gz_gl_tile_levels *levels, uint32_t (*out_words)[2])
{
	struct gz_gl_tiles_placed placed = { 0 };
	memset(gl_plan->level_ranges, 0, sizeof gl_plan->level_ranges);
	for (size_t i = 0; i < plan->tile_count; i++) {
		const struct gz_tile *tile = &plan->tiles[i];
		const size_t place = gz_gl_plan_place(gl_plan, tile, &placed);
		const unsigned level = levels->of[tile->layer][tile->pattern][tile->step];
		uint32_t *words = out_words[place];
		words[0] = (uint32_t)tile->x | (uint32_t)tile->y << 16;
		words[1] = (uint32_t)tile->layer | (uint32_t)tile->pattern << 3 | level << 5 |
			   (uint32_t)tile->step << 8 | gz_plan_tile_active(plan, tile) << 16;
		extend_tile_range(&gl_plan->level_ranges[level], place);
	}
}

static enum gz_result refuse_plan(const struct gz_plan *plan, const struct gz_log *log)
{
	gz_err(log, "the graphics device has no room for a picture of %d x %d px", plan->width,
	       plan->height);
	return GZ_ERR_NO_MEM;
}

static bool device_has_tiles(const struct gz_gl_plan *gl_plan, const struct gz_plan *plan,
			     const struct gz_gl_tile_levels *levels)
{
	return gl_plan->packed.valid && gz_plan_same(&gl_plan->packed.plan, plan) &&
	       memcmp(&gl_plan->packed.levels, levels, sizeof *levels) == 0;
}

/* Upload the tiles of a plan, unless the device has them. */
static enum gz_result upload_tiles(struct gz_gl_plan *gl_plan, const struct gz_gl_device *device,
				   const struct gz_plan *plan,
				   const struct gz_gl_tile_levels *levels, const struct gz_log *log)
{
	if (plan->tile_count == 0 || device_has_tiles(gl_plan, plan, levels))
		return GZ_OK;
	gl_plan->packed.valid = false;
	gl_plan->packed.spans_valid = false;
	void *words = gz_gl_buffer_map_new(&gl_plan->tiles, plan->tile_count * sizeof(uint32_t[2]));
	if (!words) {
		gz_gl_device_errors(device);
		return refuse_plan(plan, log);
	}
	find_tile_ranges(gl_plan, plan);
	pack_tiles(gl_plan, plan, levels, words);
	glUnmapBuffer(GL_SHADER_STORAGE_BUFFER);
	gl_plan->packed.plan = *plan;
	gl_plan->packed.levels = *levels;
	gl_plan->packed.valid = true;
	return GZ_OK;
}

static void upload_plan_block(struct gz_gl_plan *gl_plan, const struct gz_gl_plan_block *block)
{
	gz_gl_buffer_reserve(&gl_plan->block, sizeof *block, GL_STREAM_DRAW);
	glBindBuffer(GL_UNIFORM_BUFFER, gl_plan->block.name);
	glBufferSubData(GL_UNIFORM_BUFFER, 0, sizeof *block, block);
}

enum gz_result gz_gl_plan_prepare(struct gz_gl_plan *gl_plan, const struct gz_gl_device *device,
				  const struct gz_plan *plan,
				  const struct gz_gl_tile_levels *levels, const struct gz_log *log)
{
	struct gz_gl_plan_block block = { 0 };
	gl_plan->point_count = lay_out_lattices(plan, &block);
	for (int i = 0; i < plan->layer_count; i++)
		gl_plan->layer_first[i] = block.layers[i][0];
	const size_t bytes = gl_plan->point_count * sizeof(uint32_t);
	if ((int64_t)bytes > device->storage_max) {
		gz_err(log,
		       "a picture of %d x %d px takes %zu MiB, but a storage buffer of this OpenGL "
		       "holds %zu MiB; take a smaller picture, or use --backend cpu",
		       plan->width, plan->height, bytes >> 20, (size_t)device->storage_max >> 20);
		return GZ_ERR_UNSUPPORTED;
	}
	fill_plan_block(plan, &block);
	upload_plan_block(gl_plan, &block);
	return upload_tiles(gl_plan, device, plan, levels, log);
}

void gz_gl_plan_bind(const struct gz_gl_plan *gl_plan)
{
	glBindBufferBase(GL_UNIFORM_BUFFER, GZ_GL_BLOCK_PLAN, gl_plan->block.name);
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, GZ_GL_STORAGE_TILES, gl_plan->tiles.name);
}

enum gz_result gz_gl_plan_bind_spans(struct gz_gl_plan *gl_plan, const struct gz_plan *plan,
				     const struct gz_log *log)
{
	const size_t rows = (size_t)plan->layer_count * (size_t)plan->height;
	if (!gl_plan->packed.spans_valid) {
		int32_t(*span)[2] = gz_gl_buffer_map_new(&gl_plan->spans, rows * sizeof *span);
		if (!span)
			return refuse_plan(plan, log);
		for (int layer = 0; layer < plan->layer_count; layer++)
			for (int y = 0; y < plan->height; y++, span++)
				gz_region_columns(&plan->layers[layer].region, y, plan->width,
						  &(*span)[0], &(*span)[1]);
		glUnmapBuffer(GL_SHADER_STORAGE_BUFFER);
		gl_plan->packed.spans_valid = gl_plan->packed.valid;
	}
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, GZ_GL_STORAGE_SPANS, gl_plan->spans.name);
	return GZ_OK;
}

void gz_gl_plan_free(struct gz_gl_plan *gl_plan)
{
	gz_gl_buffer_free(&gl_plan->block);
	gz_gl_buffer_free(&gl_plan->tiles);
	gz_gl_buffer_free(&gl_plan->spans);
	*gl_plan = (struct gz_gl_plan) { 0 };
}
