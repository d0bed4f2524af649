/**
 * @file
 * Little-endian numbers in frames that tests make.
 */
#ifndef GZ_TESTS_DRIVERS_FRAME_BYTES_H
#define GZ_TESTS_DRIVERS_FRAME_BYTES_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

/** Write the low @p size bytes of @p value. @return the byte behind them */
static inline unsigned char *frame_put(unsigned char *bytes, size_t size, uint64_t value)
{
	for (size_t i = 0; i < size; i++)
		*bytes++ = (unsigned char)(value >> (8 * i));
	return bytes;
}

/** Write a float. @return the byte behind it */
static inline unsigned char *frame_put_f32(unsigned char *bytes, float value)
{
	uint32_t bits;
	memcpy(&bits, &value, sizeof bits);
	return frame_put(bytes, 4, bits);
}

#endif
