#include "render/raycast/gl/gl_bricks.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <GL/glew.h>

#include "render/data/brick_file.h"

/* Bytes uploaded for one picture that does not wait. Chosen: some milliseconds of a slow bus, yet
 * all bricks near a new gaze within a few pictures. */
#define PICTURE_BYTES ((size_t)16 << 20)

/* Bits of a room's place along each axis in an entry of the table, above those of the level. */
enum { PLACE_BITS = 9, PLACE_MAX = 1 << PLACE_BITS };

_Static_assert(GZ_BRICK_LEVEL_BITS + 3 * PLACE_BITS <= 32, "an entry is 32 bits");
_Static_assert(GZ_BRICK_LEVEL_BITS == GZ_GL_BRICK_LEVEL_BITS &&
		       GZ_BRICK_LEVELS_MAX == GZ_GL_BRICK_LEVELS &&
		       GZ_BRICK_EDGE == GZ_GL_BRICK_EDGE &&
		       GZ_BRICK_STORED_EDGE == GZ_GL_BRICK_STORED_EDGE &&
		       PLACE_BITS == GZ_GL_BRICK_PLACE_BITS,
	       "the shaders have the constants of C");

_Static_assert(GZ_BRICK_EDGE % GZ_MACROCELL_EDGE == 0, "a brick is whole macrocells");

static void close_brick_source(struct gz_brick_source *source)
{
	free(source->cut_entries);
	free(source->cut);
	*source = (struct gz_brick_source) { 0 };
}

/* The layout of bricks cut out of a volume in memory and its levels. */
static void lay_out_cut_bricks(const struct gz_levels *levels, struct gz_brick_layout *out_layout)
{
	struct gz_brick_layout layout = { .level_count = levels->count };
	for (int i = 0; i < levels->count; i++) {
		struct gz_brick_level *level = &layout.levels[i];
		level->first = layout.brick_count;
		size_t bricks = 1;
		for (int axis = 0; axis < 3; axis++) {
			const int dim = levels->level[i].volume.dims[axis];
			level->dims[axis] = dim;
			level->bricks[axis] = (dim + GZ_BRICK_EDGE - 1) / GZ_BRICK_EDGE;
			level->halvings[axis] = ilogb(levels->level[i].factor[axis]);
			bricks *= (size_t)level->bricks[axis];
		}
		layout.brick_count += bricks;
	}
	*out_layout = layout;
}

static void widen_entry(struct gz_brick_entry *entry, float least, float greatest)
{
	entry->least = fminf(entry->least, least);
	entry->greatest = fmaxf(entry->greatest, greatest);
}

/* Widen an entry by the ranges of a brick's macrocells. */
static void widen_by_cells(const struct gz_macrocells *cells, const int brick[3],
			   struct gz_brick_entry *entry)
{
	enum { ALONG = GZ_BRICK_EDGE / GZ_MACROCELL_EDGE };
	int first[3], end[3];
	for (int axis = 0; axis < 3; axis++) {
		const int last = (brick[axis] + 1) * ALONG;
		first[axis] = brick[axis] * ALONG;
		end[axis] = last < cells->dims[axis] ? last : cells->dims[axis];
	}
	for (int z = first[2]; z < end[2]; z++)
		for (int y = first[1]; y < end[1]; y++) {
			const size_t row = ((size_t)z * (size_t)cells->dims[1] + (size_t)y) *
					   (size_t)cells->dims[0];
			for (int x = first[0]; x < end[0]; x++)
				widen_entry(entry, cells->least[row + (size_t)x],
					    cells->greatest[row + (size_t)x]);
		}
}

/* Widen an entry by the ranges of the finer bricks under it. */
static void widen_by_children(const struct gz_brick_source *source, int level, const int brick[3],
			      struct gz_brick_entry *entry)
{
	int first[3], end[3];
	gz_brick_children(source->layout, level, brick, first, end);
	for (int z = first[2]; z < end[2]; z++)
		for (int y = first[1]; y < end[1]; y++)
			for (int x = first[0]; x < end[0]; x++) {
				const size_t child = gz_brick_number(source->layout, level - 1,
								     (const int[3]) { x, y, z });
				widen_entry(entry, source->entries[child].least,
					    source->entries[child].greatest);
			}
}

/* Find the ranges of all bricks, finest first, as they are numbered. */
static void find_cut_ranges(struct gz_brick_source *source)
{
	for (size_t i = 0; i < source->layout->brick_count; i++) {
		struct gz_brick_entry entry = { .least = INFINITY, .greatest = -INFINITY };
		int level, brick[3];
		gz_brick_place(source->layout, i, &level, brick);
		widen_by_cells(&source->detail->cells[level], brick, &entry);
		if (level > 0)
			widen_by_children(source, level, brick, &entry);
		source->cut_entries[i] = entry;
	}
}

static enum gz_result open_cut_source(struct gz_brick_source *source,
				      const struct gz_detail *detail)
{
	lay_out_cut_bricks(&detail->levels, &source->cut_layout);
	const size_t count = source->cut_layout.brick_count;
	if (count == 0)
		return GZ_ERR_INVAL;
	source->detail = detail;
	source->cut_entries = malloc(count * sizeof *source->cut_entries);
	source->cut = malloc(GZ_BRICK_VOXELS * gz_voxel_size(detail->levels.level[0].volume.type));
	if (!source->cut_entries || !source->cut) {
		close_brick_source(source);
		return GZ_ERR_NO_MEM;
	}
	source->layout = &source->cut_layout;
	source->entries = source->cut_entries;
	source->rooms_useful = count;
	find_cut_ranges(source);
	return GZ_OK;
}

/* Between two pictures: ask for wanted bricks. Returns how many are coming; 0 for a volume in
 * memory, which has all. */
static size_t turn_brick_source(struct gz_brick_source *source, const struct gz_brick_want *wants,
				size_t count, bool wait)
{
	if (!source->pool)
		return 0;
	gz_brick_pool_turn(source->pool, wants, count, wait, &source->view);
	return source->view.coming;
}

/* Open the bricks of a volume; GZ_ERR_INVAL without one. */
static enum gz_result open_brick_source(struct gz_brick_source *source,
					const struct gz_detail *detail)
{
	struct gz_brick_pool *pool = detail->levels.level[0].volume.bricks;
	close_brick_source(source);
	if (!pool)
		return open_cut_source(source, detail);
	source->pool = pool;
	source->layout = &gz_brick_pool_file(pool)->layout;
	source->entries = gz_brick_pool_file(pool)->entries;
	source->rooms_useful = gz_brick_pool_rooms(pool);
	turn_brick_source(source, NULL, 0, false);
	return GZ_OK;
}

/* GZ_BRICK_VOXELS voxels of a brick, valid until the next call; NULL while they are not loaded. */
static const void *read_source_brick(struct gz_brick_source *source, size_t brick)
{
	int level, place[3];
	gz_brick_place(source->layout, brick, &level, place);
	if (!source->pool) {
		gz_brick_cut(&source->detail->levels.level[level].volume, place, source->cut);
		return source->cut;
	}
	const int32_t entry = source->view.table[brick];
	if (entry < 0 || (entry & ((1 << GZ_BRICK_LEVEL_BITS) - 1)) != level)
		return NULL; /* a coarser brick stands in */
	const size_t bytes =
		GZ_BRICK_VOXELS * gz_voxel_size(gz_brick_pool_file(source->pool)->header.type);
	return (const char *)source->view.voxels + (size_t)(entry >> GZ_BRICK_LEVEL_BITS) * bytes;
}

static size_t brick_bytes(enum gz_voxel_type type)
{
	return GZ_BRICK_VOXELS * gz_voxel_size(type);
}

/* Shape a block of about @p count rooms as near to a cube as the device allows; with @p round_up of
 * no fewer if possible. */
static void shape_atlas(size_t count, bool round_up, int most_along, int out_along[3])
{
	const int side = (int)floor(cbrt((double)count) + 1e-6);
	out_along[0] = side < 1 ? 1 : side > most_along ? most_along : side;
	size_t left = count / (size_t)out_along[0];
	const int next = (int)floor(sqrt((double)left) + 1e-6);
	out_along[1] = next < 1 ? 1 : next > most_along ? most_along : next;
	const size_t layer = (size_t)out_along[0] * (size_t)out_along[1];
	left = round_up ? (count + layer - 1) / layer : count / layer;
	out_along[2] = left < 1 ? 1 : left > (size_t)most_along ? most_along : (int)left;
}

static size_t room_count(const int along[3])
{
	return (size_t)along[0] * (size_t)along[1] * (size_t)along[2];
}

static enum gz_result try_atlas(struct gz_gl_bricks *bricks, const struct gz_gl_device *device)
{
	const int edge = GZ_BRICK_STORED_EDGE;
	bricks->atlas = gz_gl_texture(GL_TEXTURE_3D);
	glTexStorage3D(GL_TEXTURE_3D, 1,
		       gz_gl_texel_format(GZ_GL_TEXELS_BRICKS, bricks->type)->internal,
		       bricks->along[0] * edge, bricks->along[1] * edge, bricks->along[2] * edge);
	glBindTexture(GL_TEXTURE_3D, 0);
	const enum gz_result result = gz_gl_device_errors(device);
	if (result != GZ_OK) {
		glDeleteTextures(1, &bricks->atlas);
		bricks->atlas = 0;
	}
	return result;
}

/* Make room for all bricks; halve that until the device has enough memory. */
static enum gz_result make_atlas(struct gz_gl_bricks *bricks, const struct gz_gl_device *device)
{
	const struct gz_brick_layout *layout = bricks->source.layout;
	const struct gz_brick_level *last = &layout->levels[layout->level_count - 1];
	const size_t least = layout->brick_count - last->first;
	const size_t all = layout->brick_count < bricks->source.rooms_useful
				   ? layout->brick_count
				   : bricks->source.rooms_useful;
	const size_t affordable = (size_t)device->memory_max / brick_bytes(bricks->type);
	size_t count = affordable < all ? affordable : all;
	int most_along = device->volume_edge_max / GZ_BRICK_STORED_EDGE;
	most_along = most_along < PLACE_MAX ? most_along : PLACE_MAX;
	enum gz_result result = GZ_ERR_NO_MEM;
	for (; count >= least && most_along > 0 && result != GZ_OK; count /= 2) {
		shape_atlas(count, true, most_along, bricks->along);
		if (count < all || room_count(bricks->along) > affordable)
			shape_atlas(count, false, most_along, bricks->along);
		if (room_count(bricks->along) < least)
			return GZ_ERR_NO_MEM;
		result = try_atlas(bricks, device);
		if (result == GZ_ERR_NO_DEVICE)
			return result;
	}
	return result == GZ_OK ? GZ_OK : GZ_ERR_NO_MEM;
}

static enum gz_result make_table(struct gz_gl_bricks *bricks, const struct gz_gl_device *device)
{
	const size_t bytes = bricks->source.layout->brick_count * sizeof *bricks->entries;
	if ((int64_t)bytes > device->storage_max)
		return GZ_ERR_NO_MEM;
	bricks->entries = malloc(bytes);
	if (!bricks->entries)
		return GZ_ERR_NO_MEM;
	glGenBuffers(1, &bricks->table);
	glBindBuffer(GL_SHADER_STORAGE_BUFFER, bricks->table);
	glBufferData(GL_SHADER_STORAGE_BUFFER, (GLsizeiptr)bytes, NULL, GL_DYNAMIC_DRAW);
	return gz_gl_device_errors(device);
}

static void atlas_place(const struct gz_gl_bricks *bricks, int32_t room, int out_place[3])
{
	out_place[0] = room % bricks->along[0];
	out_place[1] = room / bricks->along[0] % bricks->along[1];
	out_place[2] = room / bricks->along[0] / bricks->along[1];
}

/* Upload a brick's voxels to its room. */
static void upload_brick(const struct gz_gl_bricks *bricks, int32_t room, const void *voxels)
{
	const struct gz_gl_texel_format *format =
		gz_gl_texel_format(GZ_GL_TEXELS_BRICKS, bricks->type);
	const int edge = GZ_BRICK_STORED_EDGE;
	int place[3];
	atlas_place(bricks, room, place);
	glTexSubImage3D(GL_TEXTURE_3D, 0, place[0] * edge, place[1] * edge, place[2] * edge, edge,
			edge, edge, format->external, format->type, voxels);
}

/* Uploads to the atlas happen between these two. */
static void begin_uploads(const struct gz_gl_bricks *bricks)
{
	glBindTexture(GL_TEXTURE_3D, bricks->atlas);
	glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
}

static void end_uploads(void)
{
	glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
	glBindTexture(GL_TEXTURE_3D, 0);
}

/* Upload the coarse levels for good, coarsest first; where a finer brick is missing the coarser one
 * is shown. */
static void pin_coarse_textures(struct gz_gl_bricks *bricks)
{
	const struct gz_brick_layout *layout = bricks->source.layout;
	const int finest = gz_brick_rooms_pinned_level(layout, bricks->rooms.count);
	begin_uploads(bricks);
	for (int level = layout->level_count - 1; level >= finest; level--) {
		const size_t end = level + 1 < layout->level_count ? layout->levels[level + 1].first
								   : layout->brick_count;
		for (size_t i = layout->levels[level].first; i < end; i++) {
			const void *voxels = read_source_brick(&bricks->source, i);
			if (!voxels)
				continue;
			const int32_t room = gz_brick_rooms_pin(&bricks->rooms, (uint32_t)i);
			upload_brick(bricks, room, voxels);
			gz_brick_rooms_let_in(&bricks->rooms, room);
		}
	}
	end_uploads();
}

enum gz_result gz_gl_bricks_open(struct gz_gl_bricks *bricks, const struct gz_gl_device *device,
				 const struct gz_detail *detail)
{
	gz_gl_bricks_free(bricks);
	bricks->type = detail->levels.level[0].volume.type;
	enum gz_result result = open_brick_source(&bricks->source, detail);
	if (result == GZ_OK)
		result = make_atlas(bricks, device);
	if (result == GZ_OK) {
		const size_t all = bricks->source.layout->brick_count;
		const size_t there = room_count(bricks->along);
		result = gz_brick_rooms_init(&bricks->rooms, bricks->source.layout,
					     there < all ? there : all);
	}
	if (result == GZ_OK)
		result = make_table(bricks, device);
	if (result == GZ_OK) {
		pin_coarse_textures(bricks);
		result = gz_gl_device_errors(device);
	}
	if (result != GZ_OK)
		gz_gl_bricks_free(bricks);
	return result;
}

/* Upload the wanted bricks that are loaded. Returns whether some are left for the next picture. */
static bool upload_wanted(struct gz_gl_bricks *bricks, bool wait)
{
	const struct gz_brick_wants *wants = &bricks->stream.wants;
	const size_t each = brick_bytes(bricks->type);
	bool later = false;
	size_t given = 0;
	for (size_t i = 0; i < wants->count && !later; i++) {
		const struct gz_brick_want *want = &wants->want[i];
		if (bricks->rooms.room_of[want->brick] != GZ_BRICK_NOWHERE)
			continue;
		if (!gz_brick_rooms_has(&bricks->rooms, want->weight))
			break;
		const void *voxels = read_source_brick(&bricks->source, want->brick);
		if (!voxels)
			continue;
		later = !wait && given + each > PICTURE_BYTES && given > 0;
		if (later)
			break;
		const int32_t room = gz_brick_rooms_take(&bricks->rooms, want->brick, want->weight);
		upload_brick(bricks, room, voxels);
		gz_brick_rooms_let_in(&bricks->rooms, room);
		given += each;
	}
	return later;
}

/* Upload the table: from rooms by number to places in the atlas. */
static void upload_table(struct gz_gl_bricks *bricks)
{
	const uint32_t level_mask = (1U << GZ_BRICK_LEVEL_BITS) - 1;
	const size_t count = bricks->source.layout->brick_count;
	if (bricks->table_changes == bricks->rooms.changes)
		return;
	for (size_t i = 0; i < count; i++) {
		const int32_t entry = bricks->rooms.table[i];
		int place[3];
		atlas_place(bricks, entry >> GZ_BRICK_LEVEL_BITS, place);
		bricks->entries[i] = ((uint32_t)entry & level_mask) |
				     (uint32_t)place[0] << GZ_BRICK_LEVEL_BITS |
				     (uint32_t)place[1] << (GZ_BRICK_LEVEL_BITS + PLACE_BITS) |
				     (uint32_t)place[2] << (GZ_BRICK_LEVEL_BITS + 2 * PLACE_BITS);
	}
	glBindBuffer(GL_SHADER_STORAGE_BUFFER, bricks->table);
	glBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, (GLsizeiptr)(count * sizeof *bricks->entries),
			bricks->entries);
	bricks->table_changes = bricks->rooms.changes;
}

enum gz_result gz_gl_bricks_turn(struct gz_gl_bricks *bricks, struct gz_brick_stream_frame frame,
				 bool wait)
{
	frame.layout = bricks->source.layout;
	frame.entries = bricks->source.entries;
	const enum gz_result result = gz_brick_stream_find(&bricks->stream, &frame);
	if (result != GZ_OK)
		return result;
	const struct gz_brick_wants *wants = &bricks->stream.wants;
	bricks->coming = turn_brick_source(&bricks->source, wants->want, wants->count, wait);
	gz_brick_rooms_turn(&bricks->rooms, wants->want, wants->count);
	begin_uploads(bricks);
	bricks->coming += upload_wanted(bricks, wait);
	end_uploads();
	upload_table(bricks);
	return GZ_OK;
}

void gz_gl_bricks_fill(const struct gz_gl_bricks *bricks, int level, struct gz_gl_cast_block *block)
{
	struct gz_brick_lookup lookup;
	gz_brick_lookup_make(bricks->source.layout, level, &lookup);
	block->brick_table[0] = (uint32_t)lookup.first;
	block->brick_table[1] = (uint32_t)lookup.stride[1];
	block->brick_table[2] = (uint32_t)lookup.stride[2];
	for (int axis = 0; axis < 3; axis++) {
		block->brick_last[axis] = lookup.last[axis];
		for (int i = 0; i < GZ_BRICK_LEVELS_MAX; i++)
			block->brick_scales[i][axis] = lookup.scale[axis][i];
	}
}

void gz_gl_bricks_bind(const struct gz_gl_bricks *bricks)
{
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, GZ_GL_STORAGE_BRICKS, bricks->table);
}

void gz_gl_bricks_forget(struct gz_gl_bricks *bricks)
{
	gz_brick_stream_forget(&bricks->stream);
}

void gz_gl_bricks_abandon(struct gz_gl_bricks *bricks)
{
	close_brick_source(&bricks->source);
	gz_brick_rooms_free(&bricks->rooms);
	gz_brick_stream_free(&bricks->stream);
	free(bricks->entries);
	*bricks = (struct gz_gl_bricks) { 0 };
}

void gz_gl_bricks_free(struct gz_gl_bricks *bricks)
{
	/* GLEW has no functions before a context was opened, and then there is nothing to delete.
	 */
	if (bricks->atlas)
		glDeleteTextures(1, &bricks->atlas);
	if (bricks->table)
		glDeleteBuffers(1, &bricks->table);
	gz_gl_bricks_abandon(bricks);
}
