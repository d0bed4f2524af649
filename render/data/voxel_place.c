#include "render/data/voxel_place.h"

#include <string.h>

static uint16_t swap16(uint16_t v)
{
	return __builtin_bswap16(v);
}

static uint32_t swap32(uint32_t v)
{
	return __builtin_bswap32(v);
}

static uint64_t swap64(uint64_t v)
{
	return __builtin_bswap64(v);
}

static float float_of(uint32_t bits)
{
	float value;
	memcpy(&value, &bits, sizeof value);
	return value;
}

static float float_of_double(uint64_t bits)
{
	double value;
	memcpy(&value, &bits, sizeof value);
	return (float)value;
}

static void convert_u8(const uint8_t *source, size_t count, bool swap, void *target)
{
	(void)swap;
	memcpy(target, source, count);
}

static void convert_i8(const uint8_t *source, size_t count, bool swap, void *target)
{
	(void)swap;
	uint8_t *out = target;
	for (size_t i = 0; i < count; i++)
		out[i] = source[i] ^ 0x80;
}

/* Flipping the sign bit adds half the range: -32768 becomes 0. */
#define DEFINE_CONVERT(name, bits, out_type, expression)                               \
	static void name(const uint8_t *source, size_t count, bool swap, void *target) \
	{                                                                              \
		out_type *out = target;                                                \
		for (size_t i = 0; i < count; i++) {                                   \
			uint##bits##_t raw;                                            \
			memcpy(&raw, source + i * sizeof raw, sizeof raw);             \
			raw = swap ? swap##bits(raw) : raw;                            \
			out[i] = (expression);                                         \
		}                                                                      \
	}

DEFINE_CONVERT(convert_u16, 16, uint16_t, raw)
DEFINE_CONVERT(convert_i16, 16, uint16_t, raw ^ 0x8000u)
DEFINE_CONVERT(convert_u32, 32, float, (float)raw)
DEFINE_CONVERT(convert_i32, 32, float, (float)(int32_t)raw)
DEFINE_CONVERT(convert_f32, 32, float, float_of(raw))
DEFINE_CONVERT(convert_f64, 64, float, float_of_double(raw))

const struct gz_voxel_conversion gz_voxel_conversions[GZ_RAW_TYPE_COUNT] = {
	[GZ_RAW_UINT8] = { 1, GZ_VOXEL_U8, 0, convert_u8 },
	[GZ_RAW_INT8] = { 1, GZ_VOXEL_U8, -128, convert_i8 },
	[GZ_RAW_UINT16] = { 2, GZ_VOXEL_U16, 0, convert_u16 },
	[GZ_RAW_INT16] = { 2, GZ_VOXEL_U16, -32768, convert_i16 },
	[GZ_RAW_UINT32] = { 4, GZ_VOXEL_F32, 0, convert_u32 },
	[GZ_RAW_INT32] = { 4, GZ_VOXEL_F32, 0, convert_i32 },
	[GZ_RAW_FLOAT32] = { 4, GZ_VOXEL_F32, 0, convert_f32 },
	[GZ_RAW_FLOAT64] = { 8, GZ_VOXEL_F32, 0, convert_f64 },
};

#define DEFINE_SCATTER(name, type)                                                         \
	static void name(const void *source, size_t count, void *target, ptrdiff_t stride) \
	{                                                                                  \
		const type *in = source;                                                   \
		type *out = target;                                                        \
		for (size_t i = 0; i < count; i++)                                         \
			out[(ptrdiff_t)i * stride] = in[i];                                \
	}

DEFINE_SCATTER(scatter_1, uint8_t)
DEFINE_SCATTER(scatter_2, uint16_t)
DEFINE_SCATTER(scatter_4, uint32_t)

void gz_voxel_scatter(enum gz_voxel_type type, const void *source, size_t count, void *target,
		      ptrdiff_t stride)
{
	size_t size = gz_voxel_size(type);
	if (stride == 1)
		memcpy(target, source, count * size);
	else if (size == 1)
		scatter_1(source, count, target, stride);
	else if (size == 2)
		scatter_2(source, count, target, stride);
	else
		scatter_4(source, count, target, stride);
}

enum {
	LINE_BYTES = 64, /* of a cache line */
	TILE_COLUMNS =
		32, /* of the file's fastest axis; chosen: a tile fills a few lines of each */
};

/* Voxels of a slab if no axis is turned. Chosen: fits a second-level cache. */
#define RUN_VOXELS ((size_t)16384)

/* Size of a slab, bytes. Chosen: 16 slices of 256 x 256 voxels of 16 bits; for large volumes a
 * share of the volume, so that loading needs little memory beside it. */
#define SLAB_BYTES ((size_t)2 << 20)
#define SLAB_SHARE 128

/* The axis of the file that becomes the volume's fastest axis. */
static int fastest_axis(const struct gz_voxel_place *place)
{
	int fastest = 0;
	for (int axis = 1; axis < 3; axis++) {
		const bool steps_one = place->stride[axis] == 1 || place->stride[axis] == -1;
		/* An axis of one voxel may have the same step. */
		if (steps_one && place->dims[axis] > 1)
			fastest = axis;
	}
	return fastest;
}

/* Voxels of the file in a row (axis 1) or slice (axis 2). */
static size_t axis_unit(const struct gz_voxel_place *place, int axis)
{
	const size_t row = (size_t)place->dims[0];
	return axis == 1 ? row : row * (size_t)place->dims[1];
}

/* Rows or slices in a slab. */
static size_t slab_thickness(const struct gz_voxel_place *place, int axis, enum gz_voxel_type type)
{
	const size_t size = gz_voxel_size(type), unit = axis_unit(place, axis) * size;
	const size_t whole = axis_unit(place, 2) * (size_t)place->dims[2] * size;
	const size_t room = whole / SLAB_SHARE > SLAB_BYTES ? whole / SLAB_SHARE : SLAB_BYTES;
	const size_t line = LINE_BYTES / size, fit = room / unit;
	return fit < 1 ? 1 : fit < line ? fit : line;
}

static size_t smaller_of(size_t a, size_t b)
{
	return a < b ? a : b;
}

size_t gz_voxel_place_next(const struct gz_voxel_place *place, enum gz_voxel_type type,
			   uint64_t index)
{
	const int axis = fastest_axis(place);
	if (axis == 0) {
		const uint64_t left = axis_unit(place, 2) * (uint64_t)place->dims[2] - index;
		return left < RUN_VOXELS ? (size_t)left : RUN_VOXELS;
	}
	const size_t unit = axis_unit(place, axis), along = (size_t)place->dims[axis];
	const size_t at = (size_t)(index / unit % along);
	return smaller_of(slab_thickness(place, axis, type), along - at) * unit;
}

size_t gz_voxel_place_most(const struct gz_voxel_place *place, enum gz_voxel_type type)
{
	const int axis = fastest_axis(place);
	return axis == 0 ? RUN_VOXELS : slab_thickness(place, axis, type) * axis_unit(place, axis);
}

static char *voxel_address(const struct gz_voxel_place *place, const struct gz_volume *volume,
			   size_t x, size_t y, size_t z)
{
	const ptrdiff_t at = place->first + (ptrdiff_t)x * place->stride[0] +
			     (ptrdiff_t)y * place->stride[1] + (ptrdiff_t)z * place->stride[2];
	return (char *)volume->voxels + at * (ptrdiff_t)gz_voxel_size(volume->type);
}

/* Place rows whose voxels are neighbours in the volume too, possibly in reverse order. */
static void place_runs(const struct gz_voxel_place *place, const struct gz_volume *volume,
		       const char *from, uint64_t index, size_t count)
{
	const size_t width = (size_t)place->dims[0], height = (size_t)place->dims[1];
	const size_t size = gz_voxel_size(volume->type);
	size_t x = (size_t)(index % width), row = (size_t)(index / width);
	while (count > 0) {
		const size_t run = smaller_of(count, width - x);
		gz_voxel_scatter(volume->type, from, run,
				 voxel_address(place, volume, x, row % height, row / height),
				 place->stride[0]);
		from += run * size;
		count -= run;
		x = 0;
		row++;
	}
}

/* A tile: columns of the file's fastest axis by rows or slices that are neighbours in the volume.
 */
struct tile {
	const char *from;
	size_t pitch; /* voxels of the file from one row to the next */
	size_t rows, columns;
	bool backwards; /* the first row is the last in the volume */
};

#define DEFINE_TURN(name, type)                                                          \
	static void name(const struct tile *tile, type *out)                             \
	{                                                                                \
		for (size_t row = 0; row < tile->rows; row++) {                          \
			const type *in = (const type *)tile->from + row * tile->pitch;   \
			type *to = out + (tile->backwards ? tile->rows - 1 - row : row); \
			for (size_t i = 0; i < tile->columns; i++)                       \
				to[i * (LINE_BYTES / sizeof(type))] = in[i];             \
		}                                                                        \
	}

DEFINE_TURN(turn_1, uint8_t)
DEFINE_TURN(turn_2, uint16_t)
DEFINE_TURN(turn_4, uint32_t)

/* Transpose a tile: each column becomes a line of `lines`. */
static void turn_tile(const struct tile *tile, size_t size, void *lines)
{
	if (size == 1)
		turn_1(tile, lines);
	else if (size == 2)
		turn_2(tile, lines);
	else
		turn_4(tile, lines);
}

/* Place one row of tiles, whose first voxel is (0, y, z) of the file. */
static void place_tiles(const struct gz_voxel_place *place, const struct gz_volume *volume,
			struct tile *tile, size_t y, size_t z, int axis)
{
	_Alignas(LINE_BYTES) char lines[TILE_COLUMNS * LINE_BYTES];
	const size_t size = gz_voxel_size(volume->type), width = (size_t)place->dims[0];
	const size_t last = tile->backwards ? tile->rows - 1 : 0;
	for (size_t x = 0; x < width; x += TILE_COLUMNS) {
		tile->columns = smaller_of(TILE_COLUMNS, width - x);
		turn_tile(tile, size, lines);
		tile->from += tile->columns * size;
		for (size_t i = 0; i < tile->columns; i++)
			memcpy(voxel_address(place, volume, x + i, y + (axis == 1 ? last : 0),
					     z + (axis == 2 ? last : 0)),
			       lines + i * LINE_BYTES, tile->rows * size);
	}
}

void gz_voxel_place(const struct gz_voxel_place *place, const struct gz_volume *volume,
		    const void *voxels, uint64_t index, size_t count)
{
	const int axis = fastest_axis(place);
	if (axis == 0) {
		place_runs(place, volume, voxels, index, count);
		return;
	}
	const size_t width = (size_t)place->dims[0], height = (size_t)place->dims[1];
	const size_t unit = axis_unit(place, axis);
	const size_t z = (size_t)(index / width / height), y = (size_t)(index / width % height);
	for (size_t row = 0; row < unit / width; row++) {
		struct tile tile = {
			.from = (const char *)voxels + row * width * gz_voxel_size(volume->type),
			.pitch = unit,
			.rows = count / unit,
			.backwards = place->stride[axis] < 0,
		};
		place_tiles(place, volume, &tile, y + row, z, axis);
	}
}
