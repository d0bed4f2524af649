/*
 * Bilinear interpolation of one lattice, in whole numbers: weights are multiples of 1 / spacing
 * along each axis, their products sum to spacing^2 <= 256, and 255 * 256 fits 16 bits.
 */
#include "render/cpu/reconstruct.h"

static inline uint32_t channel(uint32_t point, int index)
{
	return point >> (8 * index) & 0xFF;
}

void gz_reconstruct_span(const struct gz_lattice *lattice, int y, int x0, int x1, uint32_t *row)
{
	const uint32_t spacing = (uint32_t)lattice->spacing;
	const uint32_t area = spacing * spacing;
	/* floor(n / area) = n * reciprocal >> 24, exact for n < 2^16 and area <= 256 */
	const uint64_t reciprocal = ((1U << 24) + area - 1) / area;
	const uint32_t down = (uint32_t)y % spacing;
	const uint32_t *above = lattice->points + (size_t)((uint32_t)y / spacing) * lattice->stride;
	/* On a lattice row the row below has no weight and may not exist. */
	const uint32_t *below = down ? above + lattice->stride : above;
	for (int x = x0; x < x1;) {
		const uint32_t column = (uint32_t)x / spacing;
		uint32_t along = (uint32_t)x % spacing;
		const uint32_t next = column + 1 < (uint32_t)lattice->columns ? column + 1 : column;
		uint32_t left[4], right[4];
		for (int c = 0; c < 4; c++) {
			left[c] = channel(above[column], c) * (spacing - down) +
				  channel(below[column], c) * down;
			right[c] = channel(above[next], c) * (spacing - down) +
				   channel(below[next], c) * down;
		}
		for (; along < spacing && x < x1; along++, x++) {
			uint32_t pixel = 0;
			for (int c = 0; c < 4; c++) {
				const uint32_t sum = left[c] * (spacing - along) + right[c] * along;
				pixel |= (uint32_t)((sum + area / 2) * reciprocal >> 24) << (8 * c);
			}
			row[x] = pixel;
		}
	}
}
