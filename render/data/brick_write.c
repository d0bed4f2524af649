/* Writing files of bricks. */
#include "render/data/format.h"

#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "base/file.h"
#include "render/data/brick_file.h"
#include "render/data/levels.h"

#define GZ_LOG_MODULE "volume"

static int nearest_index(int value, int last)
{
	return value < 0 ? 0 : value > last ? last : value;
}

/* Copy a row of a brick, from voxel `from` on; outside the volume its end voxels are repeated. */
static void copy_brick_row(const char *row, int from, int last, size_t size, char *out)
{
	for (int i = 0; i < GZ_BRICK_STORED_EDGE;) {
		const int x = from + i;
		int run = 1;
		if (x >= 0 && x < last) {
			run = last - x;
			run = run < GZ_BRICK_STORED_EDGE - i ? run : GZ_BRICK_STORED_EDGE - i;
		}
		memcpy(out + (size_t)i * size, row + (size_t)nearest_index(x, last) * size,
		       (size_t)run * size);
		i += run;
	}
}

void gz_brick_cut(const struct gz_volume *volume, const int brick[3], void *out_voxels)
{
	const size_t size = gz_voxel_size(volume->type);
	const int *dims = volume->dims;
	const int from[3] = { brick[0] * GZ_BRICK_EDGE - 1, brick[1] * GZ_BRICK_EDGE - 1,
			      brick[2] * GZ_BRICK_EDGE - 1 };
	char *to = out_voxels;
	for (int k = 0; k < GZ_BRICK_STORED_EDGE; k++) {
		const size_t z = (size_t)nearest_index(from[2] + k, dims[2] - 1);
		for (int j = 0; j < GZ_BRICK_STORED_EDGE; j++) {
			const size_t y = (size_t)nearest_index(from[1] + j, dims[1] - 1);
			const size_t row = (z * (size_t)dims[1] + y) * (size_t)dims[0];
			copy_brick_row((const char *)volume->voxels + row * size, from[0],
				       dims[0] - 1, size, to);
			to += GZ_BRICK_STORED_EDGE * size;
		}
	}
}

struct writer {
	const char *path;
	struct gz_part_file file;
	const struct gz_loading *loading;
	const struct gz_log *log;
	size_t voxel_size, brick_bytes;
	struct gz_brick_layout layout;
	struct gz_brick_entry *entries;
	uint8_t *cells;  /* of all bricks of level 0: least and greatest of each cell */
	uint8_t *voxels; /* of one brick, and zeros up to a multiple of GZ_BRICK_ALIGN */
	uint64_t offset; /* of the next brick in the file, bytes */
	size_t done;     /* bricks written */
};

/* Least and greatest voxel of a box of `edge` voxels a side within a brick. */
#define DEFINE_BOX_RANGE(name, type)                                                      \
	static void name(const void *voxels, size_t first, int edge, void *out_range)     \
	{                                                                                 \
		const type *from = (const type *)voxels + first;                          \
		type *range = out_range, low = from[0], high = from[0];                   \
		for (int k = 0; k < edge; k++)                                            \
			for (int j = 0; j < edge; j++) {                                  \
				const type *row = from + (k * GZ_BRICK_STORED_EDGE + j) * \
								 GZ_BRICK_STORED_EDGE;    \
				for (int i = 0; i < edge; i++) {                          \
					low = row[i] < low ? row[i] : low;                \
					high = row[i] > high ? row[i] : high;             \
				}                                                         \
			}                                                                 \
		range[0] = low;                                                           \
		range[1] = high;                                                          \
	}

DEFINE_BOX_RANGE(box_range_u8, uint8_t)
DEFINE_BOX_RANGE(box_range_u16, uint16_t)
DEFINE_BOX_RANGE(box_range_f32, float)

typedef void box_range(const void *voxels, size_t first, int edge, void *out_range);

static box_range *const box_ranges[GZ_VOXEL_TYPE_COUNT] = {
	[GZ_VOXEL_U8] = box_range_u8,
	[GZ_VOXEL_U16] = box_range_u16,
	[GZ_VOXEL_F32] = box_range_f32,
};

/* The ranges of the cells: of a cell's voxels and one more on every side, like macrocells. */
static void find_cells(struct writer *writer, enum gz_voxel_type type, size_t number)
{
	enum { ALONG = GZ_BRICK_EDGE / GZ_BRICK_CELL_EDGE };
	uint8_t *out = writer->cells + number * GZ_BRICK_CELLS * 2 * writer->voxel_size;
	for (int cell = 0; cell < GZ_BRICK_CELLS; cell++) {
		const int x = cell % ALONG * GZ_BRICK_CELL_EDGE;
		const int y = cell / ALONG % ALONG * GZ_BRICK_CELL_EDGE;
		const int z = cell / (ALONG * ALONG) * GZ_BRICK_CELL_EDGE;
		const int first = (z * GZ_BRICK_STORED_EDGE + y) * GZ_BRICK_STORED_EDGE + x;
		box_ranges[type](writer->voxels, (size_t)first, GZ_BRICK_CELL_EDGE + 2, out);
		gz_brick_host_order(type, 2, out);
		out += 2 * writer->voxel_size;
	}
}

/* The range of a brick's voxels and of the finer bricks under it. */
static void find_brick_range(const struct writer *writer, enum gz_voxel_type type, int level,
			     const int brick[3], struct gz_brick_entry *entry)
{
	float own[2];
	int first[3], end[3];
	box_ranges[type](writer->voxels, 0, GZ_BRICK_STORED_EDGE, own);
	entry->least = (float)gz_voxel_stored(type, own, 0);
	entry->greatest = (float)gz_voxel_stored(type, own, 1);
	if (level == 0)
		return;
	gz_brick_children(&writer->layout, level, brick, first, end);
	for (int z = first[2]; z < end[2]; z++)
		for (int y = first[1]; y < end[1]; y++)
			for (int x = first[0]; x < end[0]; x++) {
				const int place[3] = { x, y, z };
				const struct gz_brick_entry *child =
					&writer->entries[gz_brick_number(&writer->layout, level - 1,
									 place)];
				entry->least =
					child->least < entry->least ? child->least : entry->least;
				entry->greatest = child->greatest > entry->greatest
							  ? child->greatest
							  : entry->greatest;
			}
}

static enum gz_result write_brick(struct writer *writer, const struct gz_volume *volume, int level,
				  const int brick[3])
{
	const size_t number = gz_brick_number(&writer->layout, level, brick);
	struct gz_brick_entry *entry = &writer->entries[number];
	gz_brick_cut(volume, brick, writer->voxels);
	find_brick_range(writer, volume->type, level, brick, entry);
	if (level == 0)
		find_cells(writer, volume->type, number);
	if (entry->least == entry->greatest)
		return GZ_OK;
	const size_t bytes = GZ_BRICK_VOXELS * writer->voxel_size;
	gz_brick_host_order(volume->type, GZ_BRICK_VOXELS, writer->voxels);
	entry->crc = (uint32_t)crc32(0, writer->voxels, (uInt)bytes);
	entry->offset = writer->offset;
	writer->offset += writer->brick_bytes;
	return gz_part_file_write(&writer->file, writer->voxels, writer->brick_bytes,
				  entry->offset);
}

static enum gz_result write_level(struct writer *writer, const struct gz_volume *volume, int number)
{
	const struct gz_brick_level *level = &writer->layout.levels[number];
	for (int z = 0; z < level->bricks[2]; z++)
		for (int y = 0; y < level->bricks[1]; y++)
			for (int x = 0; x < level->bricks[0]; x++) {
				const double total = (double)writer->layout.brick_count;
				if (!gz_loading_goes_on(writer->loading,
							(double)writer->done++ / total,
							writer->path))
					return GZ_ERR_CANCELLED;
				const int brick[3] = { x, y, z };
				const enum gz_result result =
					write_brick(writer, volume, number, brick);
				if (result != GZ_OK)
					return result;
			}
	return GZ_OK;
}

/* Make the next coarser level of `volume`, in memory or in a scratch file. */
static enum gz_result halve_for_bricks(const struct writer *writer, const struct gz_volume *volume,
				       int level, struct gz_volume *out_half)
{
	struct gz_volume half = *volume;
	for (int axis = 0; axis < 3; axis++)
		if (half.dims[axis] != writer->layout.levels[level].dims[axis]) {
			half.dims[axis] = writer->layout.levels[level].dims[axis];
			half.spacing[axis] *= 2;
		}
	const enum gz_result result = gz_volume_allocate_in(&half, writer->loading);
	if (result != GZ_OK) {
		gz_err(writer->log, "%s: no room for the volume at half its resolution: %s",
		       writer->path, gz_result_text(result));
		return result;
	}
	for (int z = 0; z < half.dims[2]; z++)
		gz_volume_halve_slice(volume, &half, z);
	*out_half = half;
	return GZ_OK;
}

static enum gz_result write_levels(struct writer *writer, const struct gz_volume *volume)
{
	struct gz_volume at = *volume;
	enum gz_result result = write_level(writer, &at, 0);
	for (int level = 1; level < writer->layout.level_count && result == GZ_OK; level++) {
		struct gz_volume half;
		result = halve_for_bricks(writer, &at, level, &half);
		if (level > 1)
			gz_volume_free(&at);
		if (result != GZ_OK)
			return result;
		at = half;
		result = write_level(writer, &at, level);
	}
	if (at.voxels != volume->voxels)
		gz_volume_free(&at);
	return result;
}

static enum gz_result write_index(struct writer *writer, struct gz_brick_header *header)
{
	const size_t size = writer->layout.brick_count * GZ_BRICK_ENTRY_BYTES;
	uint8_t *index = malloc(size);
	if (!index)
		return GZ_ERR_NO_MEM;
	for (size_t i = 0; i < writer->layout.brick_count; i++)
		gz_brick_entry_encode(&writer->entries[i], index + i * GZ_BRICK_ENTRY_BYTES);
	header->index_crc = (uint32_t)crc32_z(0, index, size);
	const enum gz_result result =
		gz_part_file_write(&writer->file, index, size, GZ_BRICK_HEADER_BYTES);
	free(index);
	return result;
}

static enum gz_result write_rest(struct writer *writer, const struct gz_volume *volume)
{
	const size_t cells =
		gz_brick_number(&writer->layout, 0,
				(const int[3]) { 0, 0, writer->layout.levels[0].bricks[2] }) *
		GZ_BRICK_CELLS * 2 * writer->voxel_size;
	struct gz_brick_header header = {
		.type = volume->type,
		.oriented = volume->oriented,
		.spacing_assumed = volume->spacing_assumed,
		.modality = volume->modality,
		.slope = volume->slope,
		.intercept = volume->intercept,
		.stored_min = volume->stored_min,
		.stored_max = volume->stored_max,
		.brick_count = writer->layout.brick_count,
		.file_size = writer->offset,
		.cells_crc = (uint32_t)crc32_z(0, writer->cells, cells),
	};
	memcpy(header.dims, volume->dims, sizeof header.dims);
	memcpy(header.spacing, volume->spacing, sizeof header.spacing);
	uint8_t bytes[GZ_BRICK_HEADER_BYTES];
	enum gz_result result = write_index(writer, &header);
	if (result == GZ_OK)
		result = gz_part_file_write(&writer->file, writer->cells, cells,
					    gz_brick_cells_offset(header.brick_count));
	/* A volume of one value has no bricks after its cells. */
	if (result == GZ_OK)
		result = gz_part_file_resize(&writer->file, header.file_size);
	gz_brick_header_encode(&header, bytes);
	return result == GZ_OK ? gz_part_file_write(&writer->file, bytes, sizeof bytes, 0) : result;
}

static enum gz_result begin_bricks(struct writer *writer, const struct gz_volume *volume)
{
	gz_brick_layout_make(volume->dims, volume->spacing, &writer->layout);
	const struct gz_brick_level *finest = &writer->layout.levels[0];
	const size_t bricks =
		(size_t)finest->bricks[0] * (size_t)finest->bricks[1] * (size_t)finest->bricks[2];
	writer->voxel_size = gz_voxel_size(volume->type);
	writer->brick_bytes = (GZ_BRICK_VOXELS * writer->voxel_size + GZ_BRICK_ALIGN - 1) /
			      GZ_BRICK_ALIGN * GZ_BRICK_ALIGN;
	writer->offset = gz_brick_data_offset(writer->layout.brick_count, bricks, volume->type);
	writer->entries = calloc(writer->layout.brick_count, sizeof *writer->entries);
	writer->cells = malloc(bricks * GZ_BRICK_CELLS * 2 * writer->voxel_size);
	writer->voxels = calloc(1, writer->brick_bytes);
	if (!writer->entries || !writer->cells || !writer->voxels) {
		gz_err(writer->log, "%s: no memory to write %zu bricks", writer->path,
		       writer->layout.brick_count);
		return GZ_ERR_NO_MEM;
	}
	return gz_part_file_open(&writer->file, writer->path, writer->log);
}

static enum gz_result finish_bricks(struct writer *writer, enum gz_result result)
{
	result = gz_part_file_close(&writer->file, result);
	free(writer->entries);
	free(writer->cells);
	free(writer->voxels);
	return result;
}

enum gz_result gz_bricks_write(const struct gz_volume *volume, const char *path,
			       const struct gz_loading *loading, const struct gz_log *log)
{
	struct writer writer = {
		.path = path, .loading = loading, .log = log, .file = { .fd = -1 }
	};
	if (!volume->voxels)
		return GZ_ERR_INVAL;
	if (volume->colour != GZ_COLOUR_NONE) {
		gz_err(log, "%s: bricks hold no colours; write the volume as .nrrd", path);
		return GZ_ERR_UNSUPPORTED;
	}
	enum gz_result result = begin_bricks(&writer, volume);
	if (result == GZ_OK)
		result = write_levels(&writer, volume);
	if (result == GZ_OK)
		result = write_rest(&writer, volume);
	return finish_bricks(&writer, result);
}
