/**
 * @file
 * Little-endian numbers in reports. The caller has checked that the bytes are there.
 */
#ifndef GZ_DRIVERS_DEVICE_LITTLE_ENDIAN_H
#define GZ_DRIVERS_DEVICE_LITTLE_ENDIAN_H

#include <stdint.h>
#include <string.h>

/** The unsigned number in 4 bytes. */
static inline uint32_t gz_read_u32le(const unsigned char *bytes)
{
	return (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 |
	       (uint32_t)bytes[3] << 24;
}

/** The signed number in 8 bytes. */
static inline int64_t gz_read_i64le(const unsigned char *bytes)
{
	return (int64_t)((uint64_t)gz_read_u32le(bytes) | (uint64_t)gz_read_u32le(bytes + 4) << 32);
}

/** The IEEE 754 number in 4 bytes; may be NaN or infinite. */
static inline float gz_read_f32le(const unsigned char *bytes)
{
	uint32_t bits = gz_read_u32le(bytes);
	float value;
	memcpy(&value, &bits, sizeof value);
	return value;
}

/** Write 2 bytes. */
static inline void gz_write_u16le(unsigned char *bytes, uint16_t value)
{
	bytes[0] = (unsigned char)value;
	bytes[1] = (unsigned char)(value >> 8);
}

/** Write 4 bytes. */
static inline void gz_write_u32le(unsigned char *bytes, uint32_t value)
{
	gz_write_u16le(bytes, (uint16_t)value);
	gz_write_u16le(bytes + 2, (uint16_t)(value >> 16));
}

#endif
