#include "render/gl/gl_frame.h"

#include <string.h>

#include <GL/glew.h>

#define GZ_LOG_MODULE "gl"

/* From one level's block to the next: a multiple of what any implementation demands of such places
 * (GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT is at most 256). */
enum { BLOCK_STRIDE = (sizeof(struct gz_gl_frame_block) + 255) / 256 * 256 };

enum { COUNTS_SIZE = GZ_GL_COUNT_SLOTS * sizeof(uint32_t) };

_Static_assert(GZ_GL_TILE_POINTS == GZ_TILE_PATTERN_COUNT * GZ_TILE_EDGE * GZ_TILE_EDGE,
	       "the block has a point for each ray of each pattern");
_Static_assert(GZ_PLAN_LAYERS_MAX <= 8 && GZ_TILE_PATTERN_COUNT <= 4 && GZ_LEVELS_MAX <= 8 &&
		       GZ_PLAN_STEPS_MAX <= 256,
	       "a tile's numbers fit the bits they are packed into");

/* Make room for @p size bytes; what was there is lost. */
static void reserve(struct gz_gl_buffer *buffer, size_t size, GLenum usage)
{
	if (!buffer->name)
		glGenBuffers(1, &buffer->name);
	if (size <= buffer->size)
		return;
	glBindBuffer(GL_SHADER_STORAGE_BUFFER, buffer->name);
	glBufferData(GL_SHADER_STORAGE_BUFFER, (GLsizeiptr)size, NULL, usage);
	buffer->size = size;
}

/* Memory to write @p size bytes into; what was there is lost, and frames that still read it keep
 * theirs. NULL where the device has none. Until glUnmapBuffer(GL_SHADER_STORAGE_BUFFER). */
static void *map_new(struct gz_gl_buffer *buffer, size_t size)
{
	reserve(buffer, size, GL_STATIC_DRAW); /* the device's own: many frames may read it */
	glBindBuffer(GL_SHADER_STORAGE_BUFFER, buffer->name);
	return glMapBufferRange(GL_SHADER_STORAGE_BUFFER, 0, (GLsizeiptr)size,
				GL_MAP_WRITE_BIT | GL_MAP_INVALIDATE_BUFFER_BIT);
}

/* Room for the points, and their texture where shaders read them by it (frame.glsl). */
static void reserve_points(struct gz_gl_frame *frame, const struct gz_gl_device *device,
			   size_t size)
{
	const bool grows = size > frame->points.size;
	reserve(&frame->points, size, GL_DYNAMIC_COPY);
	if (!device->software || !grows)
		return;
	if (!frame->point_texels)
		glGenTextures(1, &frame->point_texels);
	glBindTexture(GL_TEXTURE_BUFFER, frame->point_texels);
	glTexBuffer(GL_TEXTURE_BUFFER, GL_R32UI, frame->points.name);
	glBindTexture(GL_TEXTURE_BUFFER, 0);
}

/* The first layer of spacing 1 is the picture itself. A second one, by odd parameters, has room of
 * its own, so that no two rays write one pixel. */
static size_t lay_out(const struct gz_plan *plan, struct gz_gl_frame_block *block)
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

/* Counting sort by layer and pattern keeps the plan's order within each: neighbours stay together,
 * and a pass over one kind takes one range. */
static void sort_ranges(struct gz_gl_frame *frame, const struct gz_plan *plan)
{
	memset(frame->ranges, 0, sizeof frame->ranges);
	for (size_t i = 0; i < plan->tile_count; i++)
		frame->ranges[plan->tiles[i].layer][plan->tiles[i].pattern].count++;
	size_t first = 0;
	for (int layer = 0; layer < GZ_PLAN_LAYERS_MAX; layer++)
		for (int pattern = 0; pattern < GZ_TILE_PATTERN_COUNT; pattern++) {
			frame->ranges[layer][pattern].first = first;
			first += frame->ranges[layer][pattern].count;
		}
}

/* Make a range hold an item. */
static void widen(struct gz_gl_tile_range *range, size_t item)
{
	const size_t end = range->first + range->count;
	const size_t first = range->count == 0 || item < range->first ? item : range->first;
	range->count = (range->count > 0 && end > item ? end : item + 1) - first;
	range->first = first;
}

/* Tiles into their ranges, each with the level of detail that it takes. */
static void pack_tiles(struct gz_gl_frame *frame, const struct gz_plan *plan,
		       const struct gz_gl_tile_levels *levels, uint32_t (*out_words)[2])
{
	size_t next[GZ_PLAN_LAYERS_MAX][GZ_TILE_PATTERN_COUNT];
	for (int layer = 0; layer < GZ_PLAN_LAYERS_MAX; layer++)
		for (int pattern = 0; pattern < GZ_TILE_PATTERN_COUNT; pattern++)
			next[layer][pattern] = frame->ranges[layer][pattern].first;
	memset(frame->level_ranges, 0, sizeof frame->level_ranges);
	for (size_t i = 0; i < plan->tile_count; i++) {
		const struct gz_tile *tile = &plan->tiles[i];
		const size_t place = next[tile->layer][tile->pattern]++;
		const unsigned level = levels->of[tile->layer][tile->pattern][tile->step];
		uint32_t *words = out_words[place];
		words[0] = (uint32_t)tile->x | (uint32_t)tile->y << 16;
		words[1] = (uint32_t)tile->layer | (uint32_t)tile->pattern << 3 | level << 5 |
			   (uint32_t)tile->step << 8 | gz_plan_tile_active(plan, tile) << 16;
		widen(&frame->level_ranges[level], place);
	}
}

static enum gz_result no_room(enum gz_result result, const struct gz_plan *plan,
			      const struct gz_log *log)
{
	gz_err(log, "the graphics device has no room for a picture of %d x %d px", plan->width,
	       plan->height);
	return result;
}

/* Whether the device has these tiles: the same request makes the same plan. */
static bool has_tiles(const struct gz_gl_frame *frame, const struct gz_plan *plan,
		      const struct gz_gl_tile_levels *levels)
{
	const struct gz_plan *packed = &frame->packed.plan;
	return frame->packed.valid && plan->made_for.valid && packed->serial == plan->serial &&
	       packed->tile_count == plan->tile_count &&
	       memcmp(&packed->made_for, &plan->made_for, sizeof plan->made_for) == 0 &&
	       memcmp(&frame->packed.levels, levels, sizeof *levels) == 0;
}

/* Give the device the tiles of a plan, unless it has them. */
static enum gz_result give_tiles(struct gz_gl_frame *frame, const struct gz_gl_device *device,
				 const struct gz_plan *plan, const struct gz_gl_tile_levels *levels,
				 const struct gz_log *log)
{
	if (plan->tile_count == 0 || has_tiles(frame, plan, levels))
		return GZ_OK;
	frame->packed.valid = false;
	frame->packed.spans_valid = false;
	void *words = map_new(&frame->tiles, plan->tile_count * sizeof(uint32_t[2]));
	if (!words) {
		frame->tiles.size = 0;
		gz_gl_device_errors(device);
		return no_room(GZ_ERR_NO_MEM, plan, log);
	}
	sort_ranges(frame, plan);
	pack_tiles(frame, plan, levels, words);
	glUnmapBuffer(GL_SHADER_STORAGE_BUFFER);
	memcpy(&frame->packed.plan, plan, sizeof *plan); /* its padding too: it is compared */
	frame->packed.levels = *levels;
	frame->packed.valid = true;
	return GZ_OK;
}

enum gz_result gz_gl_frame_prepare(struct gz_gl_frame *frame, const struct gz_gl_device *device,
				   const struct gz_plan *plan,
				   const struct gz_gl_tile_levels *levels,
				   struct gz_gl_frame_block *block, const struct gz_log *log)
{
	const size_t bytes = lay_out(plan, block) * sizeof(uint32_t);
	if ((int64_t)bytes > device->storage_max) {
		gz_err(log,
		       "a picture of %d x %d px takes %zu MiB, beyond the %zu MiB of this OpenGL's "
		       "storage buffers; take a smaller one, or --backend cpu",
		       plan->width, plan->height, bytes >> 20, (size_t)device->storage_max >> 20);
		return GZ_ERR_UNSUPPORTED;
	}
	reserve(&frame->block, GZ_LEVELS_MAX * BLOCK_STRIDE, GL_STREAM_DRAW);
	reserve_points(frame, device, bytes);
	reserve(&frame->counts, COUNTS_SIZE, GL_DYNAMIC_COPY);
	enum gz_result result = gz_gl_device_errors(device);
	if (result != GZ_OK) {
		frame->points.size = 0;
		return no_room(result, plan, log);
	}
	return give_tiles(frame, device, plan, levels, log);
}

enum gz_result gz_gl_frame_spans(struct gz_gl_frame *frame, const struct gz_gl_device *device,
				 const struct gz_plan *plan, const struct gz_log *log)
{
	const size_t rows = (size_t)plan->layer_count * (size_t)plan->height;
	if (!frame->packed.spans_valid) {
		int32_t(*span)[2] = map_new(&frame->spans, rows * sizeof *span);
		if (!span) {
			frame->spans.size = 0;
			gz_gl_device_errors(device);
			return no_room(GZ_ERR_NO_MEM, plan, log);
		}
		for (int layer = 0; layer < plan->layer_count; layer++)
			for (int y = 0; y < plan->height; y++, span++)
				gz_region_columns(&plan->layers[layer].region, y, plan->width,
						  &(*span)[0], &(*span)[1]);
		glUnmapBuffer(GL_SHADER_STORAGE_BUFFER);
		frame->packed.spans_valid = frame->packed.valid;
	}
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, GZ_GL_STORAGE_SPANS, frame->spans.name);
	return GZ_OK;
}

void gz_gl_frame_set_block(struct gz_gl_frame *frame, int level,
			   const struct gz_gl_frame_block *block)
{
	glBindBuffer(GL_UNIFORM_BUFFER, frame->block.name);
	glBufferSubData(GL_UNIFORM_BUFFER, (GLintptr)level * BLOCK_STRIDE, sizeof *block, block);
}

void gz_gl_frame_use_block(const struct gz_gl_frame *frame, int level)
{
	glBindBufferRange(GL_UNIFORM_BUFFER, 0, frame->block.name, (GLintptr)level * BLOCK_STRIDE,
			  sizeof(struct gz_gl_frame_block));
}

void gz_gl_frame_begin(struct gz_gl_frame *frame)
{
	glBindBuffer(GL_SHADER_STORAGE_BUFFER, frame->counts.name);
	glClearBufferData(GL_SHADER_STORAGE_BUFFER, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT,
			  NULL);
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, GZ_GL_STORAGE_TILES, frame->tiles.name);
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, GZ_GL_STORAGE_POINTS, frame->points.name);
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, GZ_GL_STORAGE_COUNTS, frame->counts.name);
	if (frame->point_texels)
		glBindImageTexture(GZ_GL_IMAGE_POINTS, frame->point_texels, 0, GL_FALSE, 0,
				   GL_READ_ONLY, GL_R32UI);
}

/* The first bytes of a buffer of the device's, where it is quick to read them, bound to
 * GL_COPY_READ_BUFFER: memory that both can reach. A processor's buffers are there already. */
static void bring(struct gz_gl_frame *frame, const struct gz_gl_device *device,
		  const struct gz_gl_buffer *source, size_t bytes)
{
	if (!device->software) {
		reserve(&frame->staging, bytes, GL_STREAM_READ);
		glBindBuffer(GL_COPY_READ_BUFFER, source->name);
		glBindBuffer(GL_COPY_WRITE_BUFFER, frame->staging.name);
		glCopyBufferSubData(GL_COPY_READ_BUFFER, GL_COPY_WRITE_BUFFER, 0, 0,
				    (GLsizeiptr)bytes);
		source = &frame->staging;
	}
	glBindBuffer(GL_COPY_READ_BUFFER, source->name);
}

enum gz_result gz_gl_frame_read(struct gz_gl_frame *frame, const struct gz_gl_device *device,
				struct gz_image *image)
{
	const size_t bytes = (size_t)image->width * (size_t)image->height * 4;
	bring(frame, device, &frame->points, bytes);
	const void *points =
		glMapBufferRange(GL_COPY_READ_BUFFER, 0, (GLsizeiptr)bytes, GL_MAP_READ_BIT);
	if (!points) {
		const enum gz_result result = gz_gl_device_errors(device);
		return result == GZ_OK ? GZ_ERR_NO_MEM : result;
	}
	memcpy(image->pixels, points, bytes);
	glUnmapBuffer(GL_COPY_READ_BUFFER);
	return GZ_OK;
}

void gz_gl_frame_to_texture(struct gz_gl_frame *frame, int width, int height)
{
	if (frame->picture_width != width || frame->picture_height != height) {
		if (frame->picture)
			glDeleteTextures(1, &frame->picture);
		frame->picture = gz_gl_texture(GL_TEXTURE_2D);
		glTexStorage2D(GL_TEXTURE_2D, 1, GL_RGBA8, width, height);
		frame->picture_width = width;
		frame->picture_height = height;
	}
	glBindBuffer(GL_PIXEL_UNPACK_BUFFER, frame->points.name);
	glBindTexture(GL_TEXTURE_2D, frame->picture);
	glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, NULL);
	glBindTexture(GL_TEXTURE_2D, 0);
	glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
}

uint64_t gz_gl_frame_samples(struct gz_gl_frame *frame, const struct gz_gl_device *device)
{
	uint32_t counts[GZ_GL_COUNT_SLOTS] = { 0 };
	uint64_t sum = 0;
	bring(frame, device, &frame->counts, COUNTS_SIZE);
	glGetBufferSubData(GL_COPY_READ_BUFFER, 0, sizeof counts, counts);
	for (int i = 0; i < GZ_GL_COUNT_SLOTS; i++)
		sum += counts[i];
	return sum;
}

void gz_gl_frame_free(struct gz_gl_frame *frame)
{
	const GLuint buffers[] = { frame->block.name,  frame->tiles.name, frame->points.name,
				   frame->counts.name, frame->spans.name, frame->staging.name };
	/* The block's is made before all others; without it GLEW may have no functions yet. */
	if (frame->block.name)
		glDeleteBuffers(sizeof buffers / sizeof buffers[0], buffers);
	if (frame->picture)
		glDeleteTextures(1, &frame->picture);
	if (frame->point_texels)
		glDeleteTextures(1, &frame->point_texels);
	*frame = (struct gz_gl_frame) { 0 };
}
