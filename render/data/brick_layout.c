#include "render/data/brick_layout.h"

#include <math.h>
#include <string.h>
#include <zlib.h>

#include "render/data/halve.h"
#include "render/data/voxel_convert.h"

static int bricks_along(int voxels)
{
	return (voxels + GZ_BRICK_EDGE - 1) / GZ_BRICK_EDGE;
}

static bool one_brick(const struct gz_brick_level *level)
{
	return level->bricks[0] == 1 && level->bricks[1] == 1 && level->bricks[2] == 1;
}

void gz_brick_layout_make(const int dims[3], const double spacing[3],
			  struct gz_brick_layout *out_layout)
{
	struct gz_brick_layout layout = { 0 };
	struct gz_brick_level level = { .dims = { dims[0], dims[1], dims[2] } };
	double apart[3] = { spacing[0], spacing[1], spacing[2] };
	for (;;) {
		bool halve[3];
		level.first = layout.brick_count;
		for (int axis = 0; axis < 3; axis++)
			level.bricks[axis] = bricks_along(level.dims[axis]);
		layout.brick_count +=
			(size_t)level.bricks[0] * (size_t)level.bricks[1] * (size_t)level.bricks[2];
		layout.levels[layout.level_count++] = level;
		gz_halve_axes(level.dims, apart, halve);
		/* Spacings beyond all reason could take more halvings than there is room for. */
		if (one_brick(&level) || layout.level_count == GZ_BRICK_LEVELS_MAX)
			break;
		for (int axis = 0; axis < 3; axis++) {
			if (!halve[axis])
				continue;
			level.dims[axis] = (level.dims[axis] + 1) / 2;
			level.halvings[axis]++;
			apart[axis] *= 2;
		}
	}
	*out_layout = layout;
}

size_t gz_brick_number(const struct gz_brick_layout *layout, int level, const int brick[3])
{
	const struct gz_brick_level *l = &layout->levels[level];
	return l->first +
	       ((size_t)brick[2] * (size_t)l->bricks[1] + (size_t)brick[1]) * (size_t)l->bricks[0] +
	       (size_t)brick[0];
}

void gz_brick_place(const struct gz_brick_layout *layout, size_t number, int *out_level,
		    int out_brick[3])
{
	int level = 0;
	while (level + 1 < layout->level_count && number >= layout->levels[level + 1].first)
		level++;
	const struct gz_brick_level *l = &layout->levels[level];
	size_t rest = number - l->first;
	out_brick[0] = (int)(rest % (size_t)l->bricks[0]);
	rest /= (size_t)l->bricks[0];
	out_brick[1] = (int)(rest % (size_t)l->bricks[1]);
	out_brick[2] = (int)(rest / (size_t)l->bricks[1]);
	*out_level = level;
}

/* How often a level's axis is halved to make the next one. */
static int halvings(const struct gz_brick_layout *layout, int level, int axis)
{
	return layout->levels[level + 1].halvings[axis] - layout->levels[level].halvings[axis];
}

void gz_brick_parent(const struct gz_brick_layout *layout, int level, const int brick[3],
		     int out_parent[3])
{
	for (int axis = 0; axis < 3; axis++)
		out_parent[axis] = brick[axis] >> halvings(layout, level, axis);
}

void gz_brick_children(const struct gz_brick_layout *layout, int level, const int brick[3],
		       int out_first[3], int out_end[3])
{
	const struct gz_brick_level *finer = &layout->levels[level - 1];
	for (int axis = 0; axis < 3; axis++) {
		const int times = halvings(layout, level - 1, axis);
		const int end = (brick[axis] + 1) << times;
		out_first[axis] = brick[axis] << times;
		out_end[axis] = end < finer->bricks[axis] ? end : finer->bricks[axis];
	}
}

void gz_brick_lookup_make(const struct gz_brick_layout *layout, int level,
			  struct gz_brick_lookup *out_lookup)
{
	const struct gz_brick_level *own = &layout->levels[level];
	struct gz_brick_lookup lookup = {
		.first = own->first,
		.stride = { 1, own->bricks[0], own->bricks[0] * own->bricks[1] },
	};
	for (int axis = 0; axis < 3; axis++) {
		lookup.last[axis] = (float)(own->bricks[axis] - 1);
		for (int other = 0; other < layout->level_count; other++)
			lookup.scale[axis][other] = ldexpf(
				1, own->halvings[axis] - layout->levels[other].halvings[axis]);
	}
	*out_lookup = lookup;
}

/* Little-endian numbers, whatever the machine. */
static void put32(uint8_t *at, uint32_t value)
{
	for (int i = 0; i < 4; i++)
		at[i] = (uint8_t)(value >> (8 * i));
}

static void put64(uint8_t *at, uint64_t value)
{
	put32(at, (uint32_t)value);
	put32(at + 4, (uint32_t)(value >> 32));
}

static void put_double(uint8_t *at, double value)
{
	uint64_t bits;
	memcpy(&bits, &value, sizeof bits);
	put64(at, bits);
}

static void put_float(uint8_t *at, float value)
{
	uint32_t bits;
	memcpy(&bits, &value, sizeof bits);
	put32(at, bits);
}

static uint32_t get32(const uint8_t *at)
{
	return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 |
	       (uint32_t)at[3] << 24;
}

static uint64_t get64(const uint8_t *at)
{
	return get32(at) | (uint64_t)get32(at + 4) << 32;
}

static double get_double(const uint8_t *at)
{
	const uint64_t bits = get64(at);
	double value;
	memcpy(&value, &bits, sizeof value);
	return value;
}

static float get_float(const uint8_t *at)
{
	const uint32_t bits = get32(at);
	float value;
	memcpy(&value, &bits, sizeof value);
	return value;
}

/* Where the header has what. */
enum {
	AT_VERSION = 8,
	AT_TYPE = 12,
	AT_EDGE = 16,
	AT_ORIENTED = 20,
	AT_DIMS = 24,
	AT_INDEX_CRC = 36,
	AT_CELLS_CRC = 40,
	AT_ZERO = 44,
	AT_SPACING = 48,
	AT_SLOPE = 72,
	AT_INTERCEPT = 80,
	AT_LEAST = 88,
	AT_GREATEST = 96,
	AT_BRICKS = 104,
	AT_SIZE = 112,
	AT_ZERO_TOO = 120,
	AT_CRC = 124,
};

static uint32_t header_crc(const uint8_t *bytes)
{
	return (uint32_t)crc32(0, bytes, AT_CRC);
}

void gz_brick_header_encode(const struct gz_brick_header *header,
			    uint8_t out_bytes[GZ_BRICK_HEADER_BYTES])
{
	memset(out_bytes, 0, GZ_BRICK_HEADER_BYTES);
	memcpy(out_bytes, GZ_BRICK_MAGIC, sizeof GZ_BRICK_MAGIC - 1);
	put32(out_bytes + AT_VERSION, GZ_BRICK_VERSION);
	put32(out_bytes + AT_TYPE, (uint32_t)header->type);
	put32(out_bytes + AT_EDGE, GZ_BRICK_EDGE);
	put32(out_bytes + AT_ORIENTED, header->oriented);
	put32(out_bytes + AT_INDEX_CRC, header->index_crc);
	put32(out_bytes + AT_CELLS_CRC, header->cells_crc);
	for (size_t axis = 0; axis < 3; axis++) {
		put32(out_bytes + AT_DIMS + 4 * axis, (uint32_t)header->dims[axis]);
		put_double(out_bytes + AT_SPACING + 8 * axis, header->spacing[axis]);
	}
	put_double(out_bytes + AT_SLOPE, header->slope);
	put_double(out_bytes + AT_INTERCEPT, header->intercept);
	put_double(out_bytes + AT_LEAST, header->stored_min);
	put_double(out_bytes + AT_GREATEST, header->stored_max);
	put64(out_bytes + AT_BRICKS, header->brick_count);
	put64(out_bytes + AT_SIZE, header->file_size);
	put32(out_bytes + AT_CRC, header_crc(out_bytes));
}

static bool sizes_valid(const struct gz_brick_header *header)
{
	for (int axis = 0; axis < 3; axis++) {
		const double spacing = header->spacing[axis];
		if (header->dims[axis] < 1 || header->dims[axis] > GZ_VOLUME_DIM_MAX ||
		    !isfinite(header->dims[axis] * spacing) || !(spacing > 0))
			return false;
	}
	return gz_volume_edge_lengths(header->dims, header->spacing) <= GZ_VOLUME_EDGE_LENGTHS_MAX;
}

/* The values that voxels of a type can have; and scaled they are finite. */
static bool values_valid(const struct gz_brick_header *header)
{
	static const double greatest[GZ_VOXEL_TYPE_COUNT] = { 255, 65535, 3.5e38 };
	const double low = header->slope * header->stored_min + header->intercept;
	const double high = header->slope * header->stored_max + header->intercept;
	const double least = header->type == GZ_VOXEL_F32 ? -greatest[GZ_VOXEL_F32] : 0;
	return header->slope != 0 && isfinite(low) && isfinite(high) &&
	       header->stored_min >= least && header->stored_min <= header->stored_max &&
	       header->stored_max <= greatest[header->type];
}

const char *gz_brick_header_decode(const uint8_t bytes[GZ_BRICK_HEADER_BYTES],
				   struct gz_brick_header *out_header)
{
	struct gz_brick_header header = {
		.oriented = get32(bytes + AT_ORIENTED) == 1,
		.slope = get_double(bytes + AT_SLOPE),
		.intercept = get_double(bytes + AT_INTERCEPT),
		.stored_min = get_double(bytes + AT_LEAST),
		.stored_max = get_double(bytes + AT_GREATEST),
		.brick_count = get64(bytes + AT_BRICKS),
		.file_size = get64(bytes + AT_SIZE),
		.index_crc = get32(bytes + AT_INDEX_CRC),
		.cells_crc = get32(bytes + AT_CELLS_CRC),
	};
	if (memcmp(bytes, GZ_BRICK_MAGIC, sizeof GZ_BRICK_MAGIC - 1) != 0)
		return "no file of bricks";
	if (get32(bytes + AT_VERSION) != GZ_BRICK_VERSION)
		return "a version of the format that is not read; write it anew";
	if (get32(bytes + AT_CRC) != header_crc(bytes))
		return "damaged header; write it anew";
	if (get32(bytes + AT_TYPE) >= GZ_VOXEL_TYPE_COUNT ||
	    get32(bytes + AT_EDGE) != GZ_BRICK_EDGE || get32(bytes + AT_ORIENTED) > 1 ||
	    get32(bytes + AT_ZERO) != 0 || get32(bytes + AT_ZERO_TOO) != 0)
		return "a type, an edge or a flag in its header that does not exist";
	header.type = (enum gz_voxel_type)get32(bytes + AT_TYPE);
	for (size_t axis = 0; axis < 3; axis++) {
		const uint32_t dim = get32(bytes + AT_DIMS + 4 * axis);
		header.dims[axis] = dim <= GZ_VOLUME_DIM_MAX ? (int)dim : 0;
		header.spacing[axis] = get_double(bytes + AT_SPACING + 8 * axis);
	}
	if (!sizes_valid(&header))
		return "dims or spacing out of range in its header";
	if (!values_valid(&header))
		return "values out of range in its header";
	*out_header = header;
	return NULL;
}

void gz_brick_entry_encode(const struct gz_brick_entry *entry,
			   uint8_t out_bytes[GZ_BRICK_ENTRY_BYTES])
{
	put64(out_bytes, entry->offset);
	put32(out_bytes + 8, entry->crc);
	put_float(out_bytes + 12, entry->least);
	put_float(out_bytes + 16, entry->greatest);
	put32(out_bytes + 20, 0);
}

struct gz_brick_entry gz_brick_entry_decode(const uint8_t bytes[GZ_BRICK_ENTRY_BYTES])
{
	return (struct gz_brick_entry) {
		.offset = get64(bytes),
		.crc = get32(bytes + 8),
		.least = get_float(bytes + 12),
		.greatest = get_float(bytes + 16),
	};
}

uint64_t gz_brick_cells_offset(uint64_t brick_count)
{
	return GZ_BRICK_HEADER_BYTES + GZ_BRICK_ENTRY_BYTES * brick_count;
}

uint64_t gz_brick_data_offset(uint64_t brick_count, uint64_t finest, enum gz_voxel_type type)
{
	const uint64_t end = gz_brick_cells_offset(brick_count) +
			     finest * GZ_BRICK_CELLS * 2 * gz_voxel_size(type);
	return (end + GZ_BRICK_ALIGN - 1) / GZ_BRICK_ALIGN * GZ_BRICK_ALIGN;
}

void gz_brick_host_order(enum gz_voxel_type type, size_t count, void *voxels)
{
	static const enum gz_raw_type raw[GZ_VOXEL_TYPE_COUNT] = { GZ_RAW_UINT8, GZ_RAW_UINT16,
								   GZ_RAW_FLOAT32 };
	const uint16_t one = 1;
	if (*(const uint8_t *)&one == 0)
		gz_voxel_conversions[raw[type]].convert(voxels, count, true, voxels);
}
