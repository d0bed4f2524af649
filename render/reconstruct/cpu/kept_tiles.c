#include "render/reconstruct/cpu/kept_tiles.h"

#include <stdlib.h>
#include <string.h>

/* A tile's points of one plane fill a line of the caches. */
enum { LINE_BYTES = 64 };

_Static_assert(GZ_KEPT_TILE_WORDS * sizeof(uint32_t) == LINE_BYTES, "tiles are lines");

static struct gz_kept_layout layout_of(const struct gz_plan *plan, int planes)
{
	struct gz_kept_layout layout = {
		.width = plan->width,
		.height = plan->height,
		.layer_count = plan->layer_count,
		.planes = planes,
		.reconstruction = plan->reconstruction,
	};
	for (int i = 0; i < plan->layer_count; i++)
		layout.spacings[i] = plan->layers[i].spacing;
	return layout;
}

static bool same_layout(const struct gz_kept_layout *a, const struct gz_kept_layout *b)
{
	return a->width == b->width && a->height == b->height && a->layer_count == b->layer_count &&
	       a->planes == b->planes && a->reconstruction == b->reconstruction &&
	       memcmp(a->spacings, b->spacings, sizeof a->spacings) == 0;
}

/* Where the last tile of any layer ends, px. */
static void find_extent(const struct gz_plan *plan, int extent_px[2])
{
	extent_px[0] = extent_px[1] = 0;
	for (int i = 0; i < plan->layer_count; i++) {
		const struct gz_plan_layer *layer = &plan->layers[i];
		const int tile_px = GZ_TILE_EDGE * layer->spacing;
		const int right = ((layer->columns - 1) / GZ_TILE_EDGE + 1) * tile_px;
		const int below = ((layer->rows - 1) / GZ_TILE_EDGE + 1) * tile_px;
		extent_px[0] = right > extent_px[0] ? right : extent_px[0];
		extent_px[1] = below > extent_px[1] ? below : extent_px[1];
	}
}

static bool make_shelf(struct gz_kept_shelf *shelf, int spacing, int pattern,
		       const int extent_px[2], int planes)
{
	shelf->height_px = GZ_TILE_EDGE * spacing;
	shelf->width_px = pattern == GZ_TILE_QUINCUNX ? 2 * shelf->height_px : shelf->height_px;
	shelf->columns = (extent_px[0] + shelf->width_px - 1) / shelf->width_px;
	const size_t rows = (size_t)((extent_px[1] + shelf->height_px - 1) / shelf->height_px);
	const size_t tiles = (size_t)shelf->columns * rows;
	shelf->stamps = calloc(tiles, sizeof *shelf->stamps);
	/* Not zeroed: the system gives memory where tiles are stored. */
	shelf->words = aligned_alloc(LINE_BYTES, tiles * (size_t)planes * LINE_BYTES);
	return shelf->stamps && shelf->words;
}

static bool make_shelves(struct gz_kept_tiles *kept, const struct gz_plan *plan)
{
	/* Only pyramids have quincunx tiles. */
	const bool pyramid = plan->reconstruction == GZ_RECONSTRUCT_PYRAMID;
	const int patterns = pyramid ? GZ_TILE_PATTERN_COUNT : GZ_TILE_SQUARE + 1;
	int extent_px[2];
	find_extent(plan, extent_px);
	for (int layer = 0; layer < plan->layer_count; layer++)
		for (int pattern = 0; pattern < patterns; pattern++)
			if (!make_shelf(&kept->shelves[layer][pattern], plan->layers[layer].spacing,
					pattern, extent_px, kept->layout.planes))
				return false;
	return true;
}

static void free_shelves(struct gz_kept_tiles *kept)
{
	for (int layer = 0; layer < GZ_PLAN_LAYERS_MAX; layer++)
		for (int pattern = 0; pattern < GZ_TILE_PATTERN_COUNT; pattern++) {
			struct gz_kept_shelf *shelf = &kept->shelves[layer][pattern];
			free(shelf->stamps);
			free(shelf->words);
			*shelf = (struct gz_kept_shelf) { 0 };
		}
	kept->generation = 0;
}

bool gz_kept_tiles_begin(struct gz_kept_tiles *kept, const struct gz_plan *plan, uint64_t content,
			 int planes)
{
	const struct gz_kept_layout layout = layout_of(plan, planes);
	const bool other_content = kept->content != content;
	const bool other_layout = !same_layout(&kept->layout, &layout);
	kept->content = content;
	kept->layout = layout;
	if (other_layout)
		free_shelves(kept);
	else if (other_content && kept->generation > 0)
		kept->generation++; /* if it comes round to 0, shelves are made anew */
	if (other_content || other_layout)
		return false;
	if (kept->generation > 0)
		return true;
	free_shelves(kept);
	if (!make_shelves(kept, plan)) {
		free_shelves(kept);
		return false;
	}
	kept->generation = 1;
	return true;
}

uint32_t *gz_kept_tiles_take(struct gz_kept_tiles *kept, const struct gz_plan *plan,
			     const struct gz_tile *tile, bool *out_known)
{
	struct gz_kept_shelf *shelf = &kept->shelves[tile->layer][tile->pattern];
	const size_t index = (size_t)(tile->y / shelf->height_px) * (size_t)shelf->columns +
			     (size_t)(tile->x / shelf->width_px);
	struct gz_kept_stamp *stamp = &shelf->stamps[index];
	const float step = plan->steps[tile->step];
	*out_known = stamp->generation == kept->generation && stamp->step == step;
	*stamp = (struct gz_kept_stamp) { kept->generation, step };
	return shelf->words + index * (size_t)kept->layout.planes * GZ_KEPT_TILE_WORDS;
}

void gz_kept_tiles_free(struct gz_kept_tiles *kept)
{
	free_shelves(kept);
	*kept = (struct gz_kept_tiles) { 0 };
}
