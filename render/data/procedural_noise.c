#include "render/data/procedural_noise.h"

#include <math.h>
#include <stdint.h>

/* One of 12 directions at a lattice point, by an integer hash, times the offset from it: Perlin,
 * "Improving noise", SIGGRAPH 2002; the hash is the finaliser of MurmurHash3. */
static double gradient(int32_t x, int32_t y, int32_t z, const double d[3])
{
	uint32_t h =
		(uint32_t)x * 0x9e3779b1u ^ (uint32_t)y * 0x85ebca77u ^ (uint32_t)z * 0xc2b2ae3du;
	h ^= h >> 16;
	h *= 0x85ebca6bu;
	h ^= h >> 13;
	h *= 0xc2b2ae35u;
	h ^= h >> 16;
	uint32_t edge = h % 12;
	double a = d[edge >> 2], b = d[((edge >> 2) + 1) % 3];
	return ((edge & 1) ? -a : a) + ((edge & 2) ? -b : b);
}

static double fade(double t)
{
	return t * t * t * (t * (t * 6 - 15) + 10);
}

static double mix(double a, double b, double t)
{
	return a + t * (b - a);
}

double gz_noise(const double p[3])
{
	int32_t cell[3];
	double d[3], w[3], corner[8];
	for (int i = 0; i < 3; i++) {
		double whole = floor(p[i]);
		cell[i] = (int32_t)whole;
		d[i] = p[i] - whole;
		w[i] = fade(d[i]);
	}
	for (int c = 0; c < 8; c++) {
		int dx = c & 1, dy = c >> 1 & 1, dz = c >> 2;
		double offset[3] = { d[0] - dx, d[1] - dy, d[2] - dz };
		corner[c] = gradient(cell[0] + dx, cell[1] + dy, cell[2] + dz, offset);
	}
	double low = mix(mix(corner[0], corner[1], w[0]), mix(corner[2], corner[3], w[0]), w[1]);
	double high = mix(mix(corner[4], corner[5], w[0]), mix(corner[6], corner[7], w[0]), w[1]);
	return mix(low, high, w[2]);
}
