/* Layout, format and reading of files of bricks. */
#include "render/data/brick_file.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

#include "render/data/byte_stream.h"
#include "render/data/levels.h"
#include "render/data/voxel_place.h"

#define GZ_LOG_MODULE "volume"

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
		/* Extreme spacings could need more levels than there is room for. */
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

/* How many times an axis of a level is halved for the next coarser level. */
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

/* Offsets of the header's fields, bytes. */
enum {
	AT_VERSION = 8,
	AT_TYPE = 12,
	AT_EDGE = 16,
	AT_ORIENTED = 20,
	AT_DIMS = 24,
	AT_INDEX_CRC = 36,
	AT_CELLS_CRC = 40,
	AT_SPACING_ASSUMED = 44,
	AT_SPACING = 48,
	AT_SLOPE = 72,
	AT_INTERCEPT = 80,
	AT_LEAST = 88,
	AT_GREATEST = 96,
	AT_BRICKS = 104,
	AT_SIZE = 112,
	AT_MODALITY = 120,
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
	put32(out_bytes + AT_SPACING_ASSUMED, header->spacing_assumed);
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
	put32(out_bytes + AT_MODALITY, (uint32_t)header->modality);
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

/* Whether the range is possible for the type of voxel, and finite as data values. */
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
		.spacing_assumed = get32(bytes + AT_SPACING_ASSUMED) == 1,
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
		return "not a file of bricks";
	if (get32(bytes + AT_VERSION) != GZ_BRICK_VERSION)
		return "a version of the format that is not read; write it again";
	if (get32(bytes + AT_CRC) != header_crc(bytes))
		return "damaged header; write it again";
	if (get32(bytes + AT_TYPE) >= GZ_VOXEL_TYPE_COUNT ||
	    get32(bytes + AT_EDGE) != GZ_BRICK_EDGE || get32(bytes + AT_ORIENTED) > 1 ||
	    get32(bytes + AT_SPACING_ASSUMED) > 1 ||
	    get32(bytes + AT_MODALITY) >= GZ_MODALITY_COUNT)
		return "an unknown type, edge or flag in its header";
	header.type = (enum gz_voxel_type)get32(bytes + AT_TYPE);
	header.modality = (enum gz_modality)get32(bytes + AT_MODALITY);
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
	if (gz_host_big_endian())
		gz_voxel_conversions[raw[type]].convert(voxels, count, true, voxels);
}

static enum gz_result refuse_bricks(const struct gz_brick_file *file, const char *what)
{
	gz_err(file->log, "%s: %s", file->path, what);
	return GZ_ERR_FORMAT;
}

/* GZ_ERR_IO also if the file is too short; errno is 0 then. */
static enum gz_result read_at(int fd, void *bytes, size_t size, uint64_t offset)
{
	char *to = bytes;
	while (size > 0) {
		errno = 0;
		const ssize_t n = pread(fd, to, size, (off_t)offset);
		if (n < 0 && errno == EINTR)
			continue;
		if (n <= 0)
			return GZ_ERR_IO;
		to += n;
		offset += (uint64_t)n;
		size -= (size_t)n;
	}
	return GZ_OK;
}

static enum gz_result open_brick_file(struct gz_brick_file *file, uint64_t *out_size)
{
	const enum gz_result result = gz_file_open(file->path, file->log, &file->fd, out_size);
	if (result == GZ_OK)
		(void)posix_fadvise(file->fd, 0, 0, POSIX_FADV_RANDOM); /* only a hint */
	return result;
}

static enum gz_result refuse_truncated_bricks(const struct gz_brick_file *file, uint64_t size,
					      uint64_t needed)
{
	gz_err(file->log, "%s: truncated: it ends at byte %llu of %llu; write or fetch it again",
	       file->path, (unsigned long long)size, (unsigned long long)needed);
	return GZ_ERR_FORMAT;
}

static enum gz_result read_brick_part(const struct gz_brick_file *file, void *bytes, size_t size,
				      uint64_t offset)
{
	const enum gz_result result = read_at(file->fd, bytes, size, offset);
	if (result != GZ_OK)
		gz_err(file->log, "%s: cannot read %zu bytes at byte %llu: %s", file->path, size,
		       (unsigned long long)offset, errno ? strerror(errno) : "the file ends");
	return result;
}

static size_t finest_count(const struct gz_brick_file *file)
{
	return file->layout.level_count > 1 ? file->layout.levels[1].first
					    : file->layout.brick_count;
}

static enum gz_result read_brick_header(struct gz_brick_file *file, uint64_t size)
{
	uint8_t bytes[GZ_BRICK_HEADER_BYTES];
	if (size < sizeof bytes)
		return refuse_truncated_bricks(file, size, sizeof bytes);
	const enum gz_result result = read_brick_part(file, bytes, sizeof bytes, 0);
	if (result != GZ_OK)
		return result;
	const char *wrong = gz_brick_header_decode(bytes, &file->header);
	if (wrong)
		return refuse_bricks(file, wrong);
	const struct gz_brick_header *header = &file->header;
	gz_brick_layout_make(header->dims, header->spacing, &file->layout);
	if (header->brick_count != file->layout.brick_count)
		return refuse_bricks(file,
				     "its number of bricks does not fit its dims; write it again");
	const uint64_t least =
		gz_brick_data_offset(header->brick_count, finest_count(file), header->type);
	if (header->file_size < least)
		return refuse_bricks(file, "the size in its header is too small for its index");
	/* Checked before memory is allocated for the index. */
	return size < header->file_size ? refuse_truncated_bricks(file, size, header->file_size)
					: GZ_OK;
}

static const char *check_entry(const struct gz_brick_file *file, const struct gz_brick_entry *entry,
			       uint64_t data)
{
	const struct gz_brick_header *header = &file->header;
	const uint64_t bytes = GZ_BRICK_VOXELS * gz_voxel_size(header->type);
	if (!(entry->least <= entry->greatest) ||
	    !((double)entry->least >= header->stored_min - 0.5) ||
	    !((double)entry->greatest <= header->stored_max + 0.5))
		return "a brick has an invalid range of values";
	if (entry->offset == 0)
		return entry->least == entry->greatest ? NULL : "a brick has no voxels";
	if (entry->offset < data || entry->offset % GZ_BRICK_ALIGN != 0 ||
	    entry->offset > header->file_size || header->file_size - entry->offset < bytes)
		return "a brick is outside the file";
	return NULL;
}

static enum gz_result read_brick_index(struct gz_brick_file *file)
{
	const size_t count = file->layout.brick_count, size = count * GZ_BRICK_ENTRY_BYTES;
	const uint64_t data = gz_brick_data_offset(count, finest_count(file), file->header.type);
	uint8_t *bytes = malloc(size);
	file->entries = malloc(count * sizeof *file->entries);
	enum gz_result result = bytes && file->entries ? GZ_OK : GZ_ERR_NO_MEM;
	if (result == GZ_OK)
		result = read_brick_part(file, bytes, size, GZ_BRICK_HEADER_BYTES);
	if (result == GZ_OK && (uint32_t)crc32_z(0, bytes, size) != file->header.index_crc)
		result = refuse_bricks(file, "damaged index; write or fetch it again");
	for (size_t i = 0; i < count && result == GZ_OK; i++) {
		file->entries[i] = gz_brick_entry_decode(bytes + i * GZ_BRICK_ENTRY_BYTES);
		const char *wrong = check_entry(file, &file->entries[i], data);
		if (wrong)
			result = refuse_bricks(file, wrong);
	}
	free(bytes);
	return result;
}

void gz_brick_file_cell(const struct gz_brick_file *file, size_t brick, int cell, float *out_least,
			float *out_greatest)
{
	const size_t at = (brick * GZ_BRICK_CELLS + (size_t)cell) * 2;
	*out_least = (float)gz_voxel_stored(file->header.type, file->cells, at);
	*out_greatest = (float)gz_voxel_stored(file->header.type, file->cells, at + 1);
}

static enum gz_result check_cells(const struct gz_brick_file *file)
{
	for (size_t i = 0; i < finest_count(file) * GZ_BRICK_CELLS; i++) {
		float least, greatest;
		gz_brick_file_cell(file, i / GZ_BRICK_CELLS, (int)(i % GZ_BRICK_CELLS), &least,
				   &greatest);
		if (!(least <= greatest) || !isfinite(least) || !isfinite(greatest))
			return refuse_bricks(file, "a cell has an invalid range of values");
	}
	return GZ_OK;
}

static enum gz_result read_cells(struct gz_brick_file *file)
{
	const enum gz_voxel_type type = file->header.type;
	const size_t values = finest_count(file) * GZ_BRICK_CELLS * 2;
	const size_t size = values * gz_voxel_size(type);
	file->cells = malloc(size);
	if (!file->cells)
		return GZ_ERR_NO_MEM;
	const enum gz_result result = read_brick_part(
		file, file->cells, size, gz_brick_cells_offset(file->layout.brick_count));
	if (result != GZ_OK)
		return result;
	if ((uint32_t)crc32_z(0, file->cells, size) != file->header.cells_crc)
		return refuse_bricks(file, "damaged ranges of cells; write or fetch it again");
	gz_brick_host_order(type, values, file->cells);
	return check_cells(file);
}

/* Scale what is in memory if kernels cannot draw the values as they are; bricks follow when they
 * are read. */
static void scale_brick_file(struct gz_brick_file *file)
{
	struct gz_brick_header *header = &file->header;
	file->scaled =
		header->type == GZ_VOXEL_F32 &&
		gz_float_scaling_find(header->stored_min, header->stored_max, &file->scaling);
	if (!file->scaled)
		return;
	for (size_t i = 0; i < file->layout.brick_count; i++) {
		struct gz_brick_entry *entry = &file->entries[i];
		entry->least = gz_float_scaled(&file->scaling, entry->least);
		entry->greatest = gz_float_scaled(&file->scaling, entry->greatest);
	}
	gz_float_scaling_apply(&file->scaling, file->cells,
			       finest_count(file) * GZ_BRICK_CELLS * 2);
	const struct gz_stored_values values = { &header->slope, &header->intercept,
						 &header->stored_min, &header->stored_max };
	gz_float_scaling_take_back(&file->scaling, &values);
}

enum gz_result gz_brick_file_open(const char *path, const struct gz_log *log,
				  struct gz_brick_file **out_file)
{
	struct gz_brick_file *file = calloc(1, sizeof *file);
	if (!file)
		return GZ_ERR_NO_MEM;
	file->log = log;
	file->fd = -1;
	const int length = snprintf(file->path, sizeof file->path, "%s", path);
	uint64_t size = 0;
	enum gz_result result = GZ_OK;
	if (length < 0 || (size_t)length >= sizeof file->path)
		result = refuse_bricks(file, "the path is too long; move it");
	if (result == GZ_OK)
		result = open_brick_file(file, &size);
	if (result == GZ_OK)
		result = read_brick_header(file, size);
	if (result == GZ_OK)
		result = read_brick_index(file);
	if (result == GZ_OK)
		result = read_cells(file);
	if (result == GZ_OK)
		scale_brick_file(file);
	if (result == GZ_ERR_NO_MEM)
		gz_err(log, "%s: no memory for the index of %zu bricks", path,
		       file->layout.brick_count);
	if (result != GZ_OK) {
		gz_brick_file_close(&file);
		return result;
	}
	*out_file = file;
	return GZ_OK;
}

static void fill_brick(const struct gz_brick_file *file, float value, void *out_voxels)
{
	if (file->header.type == GZ_VOXEL_U8)
		memset(out_voxels, (int)value, GZ_BRICK_VOXELS);
	else if (file->header.type == GZ_VOXEL_U16)
		for (size_t i = 0; i < GZ_BRICK_VOXELS; i++)
			((uint16_t *)out_voxels)[i] = (uint16_t)value;
	else
		for (size_t i = 0; i < GZ_BRICK_VOXELS; i++)
			((float *)out_voxels)[i] = value;
}

/* Kernels rely on finite floats, see volume.h. */
static bool brick_all_finite(const float *voxels)
{
	bool finite = true;
	for (size_t i = 0; i < GZ_BRICK_VOXELS; i++)
		finite &= isfinite(voxels[i]) != 0;
	return finite;
}

enum gz_result gz_brick_file_read(const struct gz_brick_file *file, size_t brick, void *out_voxels)
{
	const struct gz_brick_entry *entry = &file->entries[brick];
	const enum gz_voxel_type type = file->header.type;
	const size_t bytes = GZ_BRICK_VOXELS * gz_voxel_size(type);
	if (entry->offset == 0) {
		fill_brick(file, entry->least, out_voxels);
		return GZ_OK;
	}
	const enum gz_result result = read_at(file->fd, out_voxels, bytes, entry->offset);
	if (result != GZ_OK)
		return result;
	if ((uint32_t)crc32_z(0, out_voxels, bytes) != entry->crc)
		return GZ_ERR_FORMAT;
	gz_brick_host_order(type, GZ_BRICK_VOXELS, out_voxels);
	if (type == GZ_VOXEL_F32 && !brick_all_finite(out_voxels))
		return GZ_ERR_FORMAT;
	if (file->scaled)
		gz_float_scaling_apply(&file->scaling, out_voxels, GZ_BRICK_VOXELS);
	return GZ_OK;
}

void gz_brick_file_complain(const struct gz_brick_file *file, size_t brick, enum gz_result why)
{
	gz_err(file->log,
	       "%s: %s at byte %llu; a coarser level is shown there; write or fetch it again",
	       file->path, why == GZ_ERR_FORMAT ? "damaged brick" : "cannot read the brick",
	       (unsigned long long)file->entries[brick].offset);
}

void gz_brick_file_close(struct gz_brick_file **file_pointer)
{
	struct gz_brick_file *file = *file_pointer;
	if (!file)
		return;
	if (file->fd >= 0)
		close(file->fd);
	free(file->entries);
	free(file->cells);
	free(file);
	*file_pointer = NULL;
}
