#include "render/data/voxel_convert.h"

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

/* The sign bit turned round adds half the range: -32768 becomes 0. */
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
