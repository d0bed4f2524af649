#include "render/raycast/shared/brick_source.h"

#include <math.h>
#include <stdlib.h>

#include "render/data/brick_cut.h"

_Static_assert(GZ_BRICK_EDGE % GZ_MACROCELL_EDGE == 0, "a brick is whole macrocells");

/* The levels there are, cut from their first voxel on. */
static void lay_out(const struct gz_levels *levels, struct gz_brick_layout *out_layout)
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

static void widen(struct gz_brick_entry *entry, float least, float greatest)
{
	entry->least = fminf(entry->least, least);
	entry->greatest = fmaxf(entry->greatest, greatest);
}

/* The range of a brick's macrocells. */
static void take_cells(const struct gz_macrocells *cells, const int brick[3],
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
				widen(entry, cells->least[row + (size_t)x],
				      cells->greatest[row + (size_t)x]);
		}
}

/* That of all finer bricks under it. */
static void take_children(const struct gz_brick_source *source, int level, const int brick[3],
			  struct gz_brick_entry *entry)
{
	int first[3], end[3];
	gz_brick_children(source->layout, level, brick, first, end);
	for (int z = first[2]; z < end[2]; z++)
		for (int y = first[1]; y < end[1]; y++)
			for (int x = first[0]; x < end[0]; x++) {
				const size_t child = gz_brick_number(source->layout, level - 1,
								     (const int[3]) { x, y, z });
				widen(entry, source->entries[child].least,
				      source->entries[child].greatest);
			}
}

/* Finest first, as they are numbered. */
static void find_ranges(struct gz_brick_source *source)
{
	for (size_t i = 0; i < source->layout->brick_count; i++) {
		struct gz_brick_entry entry = { .least = INFINITY, .greatest = -INFINITY };
		int level, brick[3];
		gz_brick_place(source->layout, i, &level, brick);
		take_cells(&source->detail->cells[level], brick, &entry);
		if (level > 0)
			take_children(source, level, brick, &entry);
		source->cut_entries[i] = entry;
	}
}

static enum gz_result open_memory(struct gz_brick_source *source, const struct gz_detail *detail)
{
	lay_out(&detail->levels, &source->cut_layout);
	const size_t count = source->cut_layout.brick_count;
	if (count == 0)
		return GZ_ERR_INVAL;
	source->detail = detail;
	source->cut_entries = malloc(count * sizeof *source->cut_entries);
	source->cut = malloc(GZ_BRICK_VOXELS * gz_voxel_size(detail->levels.level[0].volume.type));
	if (!source->cut_entries || !source->cut) {
		gz_brick_source_close(source);
		return GZ_ERR_NO_MEM;
	}
	source->layout = &source->cut_layout;
	source->entries = source->cut_entries;
	source->rooms_useful = count;
	find_ranges(source);
	return GZ_OK;
}

enum gz_result gz_brick_source_open(struct gz_brick_source *source, const struct gz_detail *detail)
{
	struct gz_brick_pool *pool = detail->levels.level[0].volume.bricks;
	gz_brick_source_close(source);
	if (!pool)
		return open_memory(source, detail);
	source->pool = pool;
	source->layout = &gz_brick_pool_file(pool)->layout;
	source->entries = gz_brick_pool_file(pool)->entries;
	source->rooms_useful = gz_brick_pool_rooms(pool);
	gz_brick_source_turn(source, NULL, 0, false);
	return GZ_OK;
}

size_t gz_brick_source_turn(struct gz_brick_source *source, const struct gz_brick_want *wants,
			    size_t count, bool wait)
{
	if (!source->pool)
		return 0;
	gz_brick_pool_turn(source->pool, wants, count, wait, &source->view);
	return source->view.coming;
}

const void *gz_brick_source_read(struct gz_brick_source *source, size_t brick)
{
	int level, place[3];
	gz_brick_place(source->layout, brick, &level, place);
	if (!source->pool) {
		gz_brick_cut(&source->detail->levels.level[level].volume, place, source->cut);
		return source->cut;
	}
	const int32_t entry = source->view.table[brick];
	if (entry < 0 || (entry & ((1 << GZ_BRICK_LEVEL_BITS) - 1)) != level)
		return NULL; /* a coarser one stands in */
	const size_t bytes =
		GZ_BRICK_VOXELS * gz_voxel_size(gz_brick_pool_file(source->pool)->header.type);
	return (const char *)source->view.voxels + (size_t)(entry >> GZ_BRICK_LEVEL_BITS) * bytes;
}

void gz_brick_source_close(struct gz_brick_source *source)
{
	free(source->cut_entries);
	free(source->cut);
	*source = (struct gz_brick_source) { 0 };
}
