#include "render/transfer/content.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* Most voxels that are looked at. Chosen: a moment's work; an object that the grid misses is a
 * speck. */
#define LOOKED_AT_MOST (1 << 22)

/* A voxel is seen if a stretch of such voxels, this share of the volume's longest edge, would hide
 * this share of what is behind. Chosen: veils count, noise that shows faintly does not. */
#define SEEN_STRETCH 0.05
#define SEEN_HIDES   0.1

/* Share of the seen voxels that may lie outside at each side. Chosen: specks. */
#define SPECKS 0.001

/* Values that are told apart. */
enum { VALUES = 1024 };

/* The search; the grid's cells are `step` voxels wide. */
struct search {
	const struct gz_volume *volume;
	bool seen[VALUES];
	double low, scale; /* entry of seen = (stored value - low) * scale */
	int step;
	int from[3], to[3];                    /* cells of the grid: from is in, to is not */
	struct gz_clip_bounds shown;           /* fractions of the box */
	uint64_t count;                        /* seen */
	uint64_t at[3][GZ_VOLUME_DIM_MAX + 1]; /* of them, in each cell along an axis */
};

static void prepare_seen(struct search *search, const struct gz_transfer *transfer)
{
	const struct gz_volume *volume = search->volume;
	const double data[2] = { volume->slope * volume->stored_min + volume->intercept,
				 volume->slope * volume->stored_max + volume->intercept };
	double range[2] = { fmin(data[0], data[1]), fmax(data[0], data[1]) };
	if (transfer->has_range)
		memcpy(range, transfer->range, sizeof range);
	const double stretch =
		fmax(SEEN_STRETCH * gz_volume_edge_lengths(volume->dims, volume->spacing), 1);
	const double least = 1 - pow(1 - SEEN_HIDES, 1 / stretch);
	const double width = volume->stored_max - volume->stored_min;
	search->low = volume->stored_min;
	search->scale = width > 0 ? (VALUES - 1) / width : 0;
	for (int i = 0; i < VALUES; i++) {
		double rgba[4];
		const double stored = volume->stored_min + width * i / (VALUES - 1);
		const double value = volume->slope * stored + volume->intercept;
		gz_transfer_evaluate(transfer,
				     (value - range[0]) / fmax(range[1] - range[0], 1e-300), rgba);
		search->seen[i] = rgba[3] >= least;
	}
}

static double stored_at(const struct gz_volume *volume, size_t voxel)
{
	if (volume->type == GZ_VOXEL_U8)
		return ((const uint8_t *)volume->voxels)[voxel];
	if (volume->type == GZ_VOXEL_U16)
		return ((const uint16_t *)volume->voxels)[voxel];
	return ((const float *)volume->voxels)[voxel];
}

static bool is_seen(const struct search *search, const int cell[3])
{
	const int *dims = search->volume->dims;
	double middle[3]; /* of the voxel that stands for the cell */
	for (int axis = 0; axis < 3; axis++)
		middle[axis] = (cell[axis] * search->step + 0.5) / dims[axis];
	if (gz_clip_beyond(&search->shown, middle) > 0)
		return false;
	const size_t at[3] = { (size_t)(cell[0] * search->step), (size_t)(cell[1] * search->step),
			       (size_t)(cell[2] * search->step) };
	const size_t voxel = (at[2] * (size_t)dims[1] + at[1]) * (size_t)dims[0] + at[0];
	const double entry = (stored_at(search->volume, voxel) - search->low) * search->scale;
	return search->seen[(int)fmin(fmax(entry, 0), VALUES - 1)];
}

static void count_seen(struct search *search)
{
	int cell[3];
	for (cell[2] = search->from[2]; cell[2] < search->to[2]; cell[2]++)
		for (cell[1] = search->from[1]; cell[1] < search->to[1]; cell[1]++)
			for (cell[0] = search->from[0]; cell[0] < search->to[0]; cell[0]++) {
				if (!is_seen(search, cell))
					continue;
				search->count++;
				for (int axis = 0; axis < 3; axis++)
					search->at[axis][cell[axis]]++;
			}
}

/* Let cells be so wide that there are not too many, and leave out those outside. */
static void choose_grid(struct search *search, const struct gz_clip_region *within)
{
	static const double one[3] = { 1, 1, 1 }, none[3] = { 0, 0, 0 };
	const int *dims = search->volume->dims;
	gz_clip_region_place(within, search->volume, one, none, &search->shown);
	search->step = 1;
	while (gz_volume_voxel_count(search->volume) /
		       ((size_t)search->step * (size_t)search->step * (size_t)search->step) >
	       LOOKED_AT_MOST)
		search->step++;
	for (int axis = 0; axis < 3; axis++) {
		const double cells = (double)dims[axis] / search->step;
		const int count = (dims[axis] + search->step - 1) / search->step;
		search->from[axis] = (int)fmin(within->least[axis] * cells, count - 1);
		search->to[axis] = (int)fmin(ceil(within->greatest[axis] * cells), count);
	}
}

/* The first or last cell along an axis that has more than specks before it. */
static int content_end(const struct search *search, int axis, bool first)
{
	uint64_t before = 0;
	const int from = search->from[axis], to = search->to[axis];
	for (int i = 0; i < to - from; i++) {
		const int cell = first ? from + i : to - 1 - i;
		before += search->at[axis][cell];
		if ((double)before > SPECKS * (double)search->count)
			return cell;
	}
	return first ? from : to - 1;
}

void gz_content_find(const struct gz_volume *volume, const struct gz_transfer *transfer,
		     const struct gz_clip_region *within, struct gz_clip_region *out_content)
{
	*out_content = *within;
	struct search *search = volume->bricks ? NULL : calloc(1, sizeof *search);
	if (!search)
		return;
	search->volume = volume;
	prepare_seen(search, transfer);
	choose_grid(search, within);
	count_seen(search);
	for (int axis = 0; axis < 3 && search->count > 0; axis++) {
		const double cell = (double)search->step / volume->dims[axis];
		out_content->least[axis] =
			fmax(content_end(search, axis, true) * cell, within->least[axis]);
		out_content->greatest[axis] =
			fmin((content_end(search, axis, false) + 1) * cell, within->greatest[axis]);
	}
	free(search);
}
