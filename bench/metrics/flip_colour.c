#include "bench/metrics/flip_colour.h"

#include <math.h>

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

/* Tristimulus values as shares of white's. */
static void white_shares(const float rgb[3], double out[3])
{
	const double white[3] = { 1, 1, 1 },
		     linear[3] = { (double)rgb[0], (double)rgb[1], (double)rgb[2] };
	double xyz[3], of_white[3];
	multiply(xyz_of_rgb, linear, xyz);
	multiply(xyz_of_rgb, white, of_white);
	for (int i = 0; i < 3; i++)
		out[i] = xyz[i] / of_white[i];
}

float gz_linear_of_srgb(uint8_t channel)
{
	const double c = channel / 255.0;
	return (float)(c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4));
}

void gz_opponent_of_linear(const float rgb[3], float out_opponent[3])
{
	double share[3];
	white_shares(rgb, share);
	out_opponent[0] = (float)(116 * share[1] - 16);
	out_opponent[1] = (float)(500 * (share[0] - share[1]));
	out_opponent[2] = (float)(200 * (share[1] - share[2]));
}

void gz_linear_of_opponent(const float opponent[3], float out_rgb[3])
{
	const double white[3] = { 1, 1, 1 };
	double of_white[3], rgb[3];
	multiply(xyz_of_rgb, white, of_white);
	const double y = ((double)opponent[0] + 16) / 116;
	const double xyz[3] = {
		(y + (double)opponent[1] / 500) * of_white[0],
		y * of_white[1],
		(y - (double)opponent[2] / 200) * of_white[2],
	};
	multiply(rgb_of_xyz, xyz, rgb);
	for (int i = 0; i < 3; i++)
		out_rgb[i] = (float)fmin(fmax(rgb[i], 0), 1);
}

static float lab_root(double share)
{
	const double delta = 6.0 / 29;
	return share > delta * delta * delta ? cbrtf((float)share)
					     : (float)(share / (3 * delta * delta) + 4.0 / 29);
}

void gz_hunt_lab_of_linear(const float rgb[3], float out_lab[3])
{
	double share[3];
	white_shares(rgb, share);
	const float x = lab_root(share[0]), y = lab_root(share[1]), z = lab_root(share[2]);
	const float lightness = 116 * y - 16;
	out_lab[0] = lightness;
	out_lab[1] = 0.01F * lightness * 500 * (x - y);
	out_lab[2] = 0.01F * lightness * 200 * (y - z);
}

float gz_hyab(const float a[3], const float b[3])
{
	const float green_red = a[1] - b[1], blue_yellow = a[2] - b[2];
	return fabsf(a[0] - b[0]) + sqrtf(green_red * green_red + blue_yellow * blue_yellow);
}
