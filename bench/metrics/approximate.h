/**
 * @file
 * Roots and powers that a compiler can do many at a time: without branches, tables and calls. Not
 * for users of the metrics.
 */
#ifndef GZ_BENCH_METRICS_APPROXIMATE_H
#define GZ_BENCH_METRICS_APPROXIMATE_H

#include <stdint.h>
#include <string.h>

/** The bits of a float as a number. */
static inline int32_t gz_bits_of_float(float value)
{
	int32_t bits;
	memcpy(&bits, &value, sizeof bits);
	return bits;
}

/** The float that has these bits. */
static inline float gz_float_of_bits(int32_t bits)
{
	float value;
	memcpy(&value, &bits, sizeof value);
	return value;
}

/** Cube root of a normal number above 0, to 3e-7 of it. A third of the exponent to begin with, then
 *  twice Halley's method. */
static inline float gz_cube_root(float x)
{
	/* Within a twentieth: 2/3 of the exponent's bias, and a little less, chosen. */
	float y = gz_float_of_bits(gz_bits_of_float(x) / 3 + 709921077);
	for (int i = 0; i < 2; i++) {
		const float cube = y * y * y;
		y *= (cube + 2 * x) / (2 * cube + x);
	}
	return y;
}

/** Logarithm to base 2 of a normal number above 0, to 2e-7 of 1 or of it. The mantissa's is that of
 *  [sqrt(1/2), sqrt 2) by the series of artanh. */
static inline float gz_log2(float x)
{
	const int32_t root_half = 0x3f3504f3;
	const int32_t bits = gz_bits_of_float(x) - root_half;
	const float m = gz_float_of_bits((bits & 0x007fffff) + root_half);
	const float s = (m - 1) / (m + 1), z = s * s;
	/* 2 / (k ln 2), k = 1, 3, 5, 7, 9. */
	const float series =
		s *
		(2.88539008F +
		 z * (0.961796694F + z * (0.577078016F + z * (0.412198583F + z * 0.320598898F))));
	return (float)(bits >> 23) + series;
}

/** 2 to the power of @p x, [-126, 126], to 2e-7 of it: the nearest whole power, and the series of
 *  the rest. */
static inline float gz_exp2(float x)
{
	const int32_t whole = (int32_t)(x + 1024.5F) - 1024;
	const float rest = x - (float)whole;
	/* (ln 2)^k / k! */
	const float series =
		1 +
		rest * (0.693147181F +
			rest * (0.240226507F +
				rest * (0.0555041087F + rest * (0.00961812911F +
								rest * (0.00133335581F +
									rest * 0.000154035304F)))));
	return gz_float_of_bits((whole + 127) * (1 << 23)) * series;
}

/** @p x to the power of @p exponent, [0, 1], to 3e-6 of it, x not above 2^100; 0 where x is 0 or
 *  less than a normal number. */
static inline float gz_power(float x, float exponent)
{
	const float power = gz_exp2(exponent * gz_log2(x));
	return x >= 1.17549435e-38F ? power : 0;
}

#endif
