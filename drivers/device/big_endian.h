/**
 * @file
 * Big-endian numbers in reports and requests. The caller has checked that the bytes are there.
 */
#ifndef GZ_DRIVERS_DEVICE_BIG_ENDIAN_H
#define GZ_DRIVERS_DEVICE_BIG_ENDIAN_H

#include <stdint.h>
#include <string.h>

/** The unsigned number in 4 bytes. */
static inline uint32_t gz_read_u32be(const unsigned char *bytes)
{
	return (uint32_t)bytes[0] << 24 | (uint32_t)bytes[1] << 16 | (uint32_t)bytes[2] << 8 |
	       (uint32_t)bytes[3];
}

/** The signed number in 4 bytes. */
static inline int32_t gz_read_i32be(const unsigned char *bytes)
{
	uint32_t bits = gz_read_u32be(bytes);
	int32_t value;
	memcpy(&value, &bits, sizeof value);
	return value;
}

/** The signed number in 8 bytes. */
static inline int64_t gz_read_i64be(const unsigned char *bytes)
{
	uint64_t bits = (uint64_t)gz_read_u32be(bytes) << 32 | gz_read_u32be(bytes + 4);
	int64_t value;
	memcpy(&value, &bits, sizeof value);
	return value;
}

/** Write 4 bytes. */
static inline void gz_write_u32be(unsigned char *bytes, uint32_t value)
{
	for (int i = 0; i < 4; i++)
		bytes[i] = (unsigned char)(value >> (24 - 8 * i));
}

/** Write 8 bytes. */
static inline void gz_write_i64be(unsigned char *bytes, int64_t value)
{
	gz_write_u32be(bytes, (uint32_t)((uint64_t)value >> 32));
	gz_write_u32be(bytes + 4, (uint32_t)value);
}

#endif
