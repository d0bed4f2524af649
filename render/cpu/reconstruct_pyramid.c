/*
 * Pyramid reconstruction: the lattice of spacing s is filled from that of 2s, coarse to fine, where
 * nothing was cast. Points are 8 bits a channel; means are rounded to nearest, so that levels add
 * no drift.
 */
#include "render/cpu/reconstruct.h"

#include <stdbool.h>

/* Channels of a point, two to a word with 8 bits of room above each. */
#define EVEN_CHANNELS 0x00FF00FFU

static inline uint32_t even_of(uint32_t point)
{
	return point & EVEN_CHANNELS;
}

static inline uint32_t odd_of(uint32_t point)
{
	return point >> 8 & EVEN_CHANNELS;
}

static inline uint32_t mean_of_2(uint32_t a, uint32_t b)
{
	const uint32_t even = even_of(a) + even_of(b) + 0x00010001U;
	const uint32_t odd = odd_of(a) + odd_of(b) + 0x00010001U;
	return (even >> 1 & EVEN_CHANNELS) | (odd >> 1 & EVEN_CHANNELS) << 8;
}

static inline uint32_t mean_of_4(uint32_t a, uint32_t b, uint32_t c, uint32_t d)
{
	const uint32_t even = even_of(a) + even_of(b) + even_of(c) + even_of(d) + 0x00020002U;
	const uint32_t odd = odd_of(a) + odd_of(b) + odd_of(c) + odd_of(d) + 0x00020002U;
	return (even >> 2 & EVEN_CHANNELS) | (odd >> 2 & EVEN_CHANNELS) << 8;
}

/* A row that lies on a coarse one. Pairs, so that the loop has no branch. */
static void fill_row_on(const uint32_t *coarse, uint32_t *fine, int pairs)
{
	for (int i = 0; i < pairs; i++) {
		fine[2 * i] = coarse[i];
		fine[2 * i + 1] = mean_of_2(coarse[i], coarse[i + 1]);
	}
}

/* A row between two coarse ones. */
static void fill_row_between(const uint32_t *above, const uint32_t *below, uint32_t *fine,
			     int pairs)
{
	for (int i = 0; i < pairs; i++) {
		fine[2 * i] = mean_of_2(above[i], below[i]);
		fine[2 * i + 1] = mean_of_4(above[i], above[i + 1], below[i], below[i + 1]);
	}
}

void gz_reconstruct_block(const struct gz_lattice *coarse, const struct gz_lattice *fine, int x,
			  int y, int edge)
{
	const int right = x + edge < fine->columns ? x + edge : fine->columns;
	const int bottom = y + edge < fine->rows ? y + edge : fine->rows;
	const int pairs = (right - x) / 2;
	for (int row = y; row < bottom; row++) {
		const uint32_t *above =
			coarse->points + (size_t)(row / 2) * coarse->stride + (size_t)(x / 2);
		uint32_t *out = fine->points + (size_t)row * fine->stride + (size_t)x;
		const uint32_t *below = above + coarse->stride;
		if (row % 2 == 0)
			fill_row_on(above, out, pairs);
		else
			fill_row_between(above, below, out, pairs);
		/* The last point of a lattice of odd width lies on a coarse column. */
		if (right > x && (right - x) % 2 != 0)
			out[2 * pairs] =
				row % 2 == 0 ? above[pairs] : mean_of_2(above[pairs], below[pairs]);
	}
}

/* A point on the rim of the lattice has only some of its neighbours: opposite ones, where there
 * are. */
static uint32_t mean_on_rim(const struct gz_lattice *lattice, int x, int y)
{
	const uint32_t *point = lattice->points + (size_t)y * lattice->stride + (size_t)x;
	const bool left = x > 0, right = x + 1 < lattice->columns;
	const bool above = y > 0, below = y + 1 < lattice->rows;
	if (left && right)
		return mean_of_2(point[-1], point[1]);
	if (above && below)
		return mean_of_2(point[-(ptrdiff_t)lattice->stride], point[lattice->stride]);
	if (left || right)
		return left ? point[-1] : point[1];
	return above ? point[-(ptrdiff_t)lattice->stride] : point[lattice->stride];
}

void gz_reconstruct_quincunx(const struct gz_lattice *lattice, int x, int y, int width, int height)
{
	const ptrdiff_t stride = (ptrdiff_t)lattice->stride;
	for (int row = y; row < y + height && row < lattice->rows; row++)
		for (int column = x + (row % 2 == 0);
		     column < x + width && column < lattice->columns; column += 2) {
			uint32_t *point = lattice->points + (ptrdiff_t)row * stride + column;
			const bool inside = row > 0 && row + 1 < lattice->rows && column > 0 &&
					    column + 1 < lattice->columns;
			*point = inside ? mean_of_4(point[-1], point[1], point[-stride],
						    point[stride])
					: mean_on_rim(lattice, column, row);
		}
}
