#include "bench/metrics/flip_colour.h"

#include <math.h>

#include "bench/metrics/approximate.h"

/* sRGB to XYZ, from the primaries and white of ITU-R BT.709, as exact fractions. */
static const double xyz_of_rgb[3][3] = {
	{ 10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794 },
	{ 2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897 },
	{ 1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382 },
};

/* Its inverse. */
static const double rgb_of_xyz[3][3] = {
	{ 3.241003275, -1.537398934, -0.498615861 },
	{ -0.969224334, 1.875930071, 0.041554224 },
	{ 0.055639423, -0.204011202, 1.057148933 },
};

static void multiply(const double matrix[3][3], const double in[3], double out[3])
{
	for (int row = 0; row < 3; row++)
		out[row] = matrix[row][0] * in[0] + matrix[row][1] * in[1] + matrix[row][2] * in[2];
}

static float linear_of_srgb(int channel)
{
	const double c = channel / 255.0;
	return (float)(c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4));
}

/* What takes linear RGB to shares of white's X, Y and Z. */
static void shares_of_rgb(double out[3][3])
{
	static const double white[3] = { 1, 1, 1 };
	double of_white[3];
	multiply(xyz_of_rgb, white, of_white);
	for (int row = 0; row < 3; row++)
		for (int column = 0; column < 3; column++)
			out[row][column] = xyz_of_rgb[row][column] / of_white[row];
}

static void set_opponents(const double shares[3][3], struct gz_flip_colours *colours)
{
	for (int i = 0; i < 3; i++) {
		colours->opponent[0][i] = (float)(116 * shares[1][i]);
		colours->opponent[1][i] = (float)(500 * (shares[0][i] - shares[1][i]));
		colours->opponent[2][i] = (float)(200 * (shares[1][i] - shares[2][i]));
	}
}

/* The way back, from each opponent colour and, last, from 1. */
static void set_linear(struct gz_flip_colours *colours)
{
	static const double white[3] = { 1, 1, 1 };
	static const double shares[4][3] = {
		{ 1.0 / 116, 1.0 / 116, 1.0 / 116 },
		{ 1.0 / 500, 0, 0 },
		{ 0, 0, -1.0 / 200 },
		{ 16.0 / 116, 16.0 / 116, 16.0 / 116 },
	};
	double of_white[3];
	multiply(xyz_of_rgb, white, of_white);
	for (int i = 0; i < 4; i++) {
		double xyz[3], rgb[3];
		for (int k = 0; k < 3; k++)
			xyz[k] = shares[i][k] * of_white[k];
		multiply(rgb_of_xyz, xyz, rgb);
		for (int k = 0; k < 3; k++)
			colours->linear[k][i] = (float)rgb[k];
	}
}

void gz_flip_colours_set(struct gz_flip_colours *colours)
{
	double shares[3][3];
	shares_of_rgb(shares);
	set_opponents(shares, colours);
	set_linear(colours);
	for (int i = 0; i < 3; i++)
		for (int k = 0; k < 3; k++)
			colours->share[i][k] = (float)shares[i][k];
	for (int i = 0; i < 256; i++)
		colours->linear_of_srgb[i] = linear_of_srgb(i);
}

void gz_opponents_of_srgb(const struct gz_flip_colours *colours, const uint8_t *pixels,
			  size_t count, float *const out_opponents[3])
{
	const float *linear = colours->linear_of_srgb;
	for (size_t i = 0; i < count; i++, pixels += 4) {
		const float r = linear[pixels[0]], g = linear[pixels[1]], b = linear[pixels[2]];
		for (int k = 0; k < 3; k++) {
			const float *row = colours->opponent[k];
			const float sum = row[0] * r + row[1] * g + row[2] * b;
			out_opponents[k][i] = k == 0 ? sum - 16 : sum;
		}
	}
}

static inline float unit(float value)
{
	const float above = value > 0 ? value : 0;
	return above < 1 ? above : 1;
}

static inline float lab_root(float share)
{
	const float delta = 6.0F / 29, cube = delta * delta * delta;
	/* Of what is not below the bound, so that it is a normal number. */
	const float root = gz_cube_root(share > cube ? share : cube);
	const float line = share * (1 / (3 * delta * delta)) + 4.0F / 29;
	return share > cube ? root : line;
}

void gz_hunt_labs_of_linear(const struct gz_flip_colours *colours, size_t count,
			    float *const rgb[3])
{
	const float(*share)[3] = colours->share;
	float *restrict red = rgb[0], *restrict green = rgb[1], *restrict blue = rgb[2];
	for (size_t i = 0; i < count; i++) {
		const float r = red[i], g = green[i], b = blue[i];
		const float x = lab_root(share[0][0] * r + share[0][1] * g + share[0][2] * b);
		const float y = lab_root(share[1][0] * r + share[1][1] * g + share[1][2] * b);
		const float z = lab_root(share[2][0] * r + share[2][1] * g + share[2][2] * b);
		const float lightness = 116 * y - 16;
		red[i] = lightness;
		green[i] = 0.01F * lightness * 500 * (x - y);
		blue[i] = 0.01F * lightness * 200 * (y - z);
	}
}

void gz_linear_of_opponents(const struct gz_flip_colours *colours, const float *const opponents[3],
			    size_t count, float *const out_rgb[3])
{
	const float *restrict a = opponents[0], *restrict b = opponents[1],
			      *restrict c = opponents[2];
	for (int k = 0; k < 3; k++) {
		const float *row = colours->linear[k];
		float *restrict out = out_rgb[k];
		for (size_t i = 0; i < count; i++)
			out[i] = unit(row[0] * a[i] + row[1] * b[i] + row[2] * c[i] + row[3]);
	}
}
