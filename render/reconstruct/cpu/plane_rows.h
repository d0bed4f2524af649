/*
 * The row filters (struct gz_row_filters) of planes other than colours, point by point.
 * plane_loops.h includes this once for each kind of plane, after it defines:
 *
 *   POINT                        the C type of a point, 32 bits
 *   PLANE(name)                  the name of a function of this kind
 *   PLANE(mean_of_2)(a, b)       between two points, the nearer first
 *   PLANE(mean_of_4)(a, b, c, d) between four
 *   PLANE(cubic)(a, b, c, d)     halfway between b and c
 *   PLANE(mix)(a, b, share)      b with a share in [0, 1], and a
 */
#include <string.h>

#include "render/reconstruct/cpu/reconstruct.h"

static POINT PLANE(load)(const uint32_t *point)
{
	POINT value;
	memcpy(&value, point, sizeof value);
	return value;
}

static void PLANE(store)(uint32_t *point, POINT value)
{
	memcpy(point, &value, sizeof value);
}

/* Some points of the four rows around a row that is made, and what is between them. The loops over
 * whole blocks become SIMD. */
struct PLANE(cubic_block) {
	POINT rows[4][CUBIC_BLOCK + 3]; /* from one point before the first */
	POINT below[CUBIC_BLOCK + 3];   /* the row halfway between rows 1 and 2 */
	POINT even[2 * CUBIC_BLOCK], odd[2 * CUBIC_BLOCK];
};

static void PLANE(double_block)(const uint32_t *row, ptrdiff_t stride, int points,
				struct PLANE(cubic_block) * block)
{
	for (int k = 0; k < 4; k++)
		memcpy(&block->rows[k][0], row + (k - 1) * stride - 1,
		       (size_t)(points + 3) * sizeof(POINT));
	for (int i = 0; i < points + 3; i++)
		block->below[i] = PLANE(cubic)(block->rows[0][i], block->rows[1][i],
					       block->rows[2][i], block->rows[3][i]);
	for (int i = 0; i < points; i++) {
		const POINT *here = block->rows[1] + i, *below = block->below + i;
		block->even[2 * i] = here[1];
		block->even[2 * i + 1] = PLANE(cubic)(here[0], here[1], here[2], here[3]);
		block->odd[2 * i] = below[1];
		block->odd[2 * i + 1] = PLANE(cubic)(below[0], below[1], below[2], below[3]);
	}
}

static void PLANE(double_cubic)(const uint32_t *row, ptrdiff_t stride, uint32_t *even,
				uint32_t *odd, int count, bool stream)
{
	(void)stream;
	struct PLANE(cubic_block) block;
	for (int first = 0; first < count; first += 2 * CUBIC_BLOCK) {
		const int made = gz_least(count - first, 2 * CUBIC_BLOCK);
		PLANE(double_block)(row + first / 2, stride, (made + 1) / 2, &block);
		memcpy(even + first, block.even, (size_t)made * sizeof(POINT));
		memcpy(odd + first, block.odd, (size_t)made * sizeof(POINT));
	}
}

static void PLANE(double_mean)(const uint32_t *row, ptrdiff_t stride, uint32_t *even, uint32_t *odd,
			       int count, bool stream)
{
	(void)stream;
	for (int i = 0; 2 * i < count; i++) {
		const POINT here = PLANE(load)(row + i), right = PLANE(load)(row + i + 1);
		const POINT below = PLANE(load)(row + i + stride);
		const POINT across = PLANE(load)(row + i + stride + 1);
		PLANE(store)(even + 2 * i, here);
		PLANE(store)(odd + 2 * i, PLANE(mean_of_2)(here, below));
		if (2 * i + 1 < count) {
			PLANE(store)(even + 2 * i + 1, PLANE(mean_of_2)(here, right));
			PLANE(store)(odd + 2 * i + 1, PLANE(mean_of_4)(here, right, below, across));
		}
	}
}

/* Make points first, first + 2, ... of a row and, with two rows, the others of the next. */
static void PLANE(quincunx)(uint32_t *row, ptrdiff_t stride, int first, int rows, int count,
			    bool is_cubic)
{
	for (int r = 0; r < rows; r++, row += stride)
		for (int i = r == 0 ? first : 1 - first; i < count; i += 2) {
			uint32_t *at = row + i;
			const POINT left = PLANE(load)(at - 1), right = PLANE(load)(at + 1);
			const POINT above = PLANE(load)(at - stride);
			const POINT below = PLANE(load)(at + stride);
			POINT made = PLANE(mean_of_4)(left, right, above, below);
			if (is_cubic)
				made = PLANE(mean_of_2)(PLANE(cubic)(PLANE(load)(at - 3), left,
								     right, PLANE(load)(at + 3)),
							PLANE(cubic)(PLANE(load)(at - 3 * stride),
								     above, below,
								     PLANE(load)(at + 3 * stride)));
			PLANE(store)(at, made);
		}
}

static void PLANE(quincunx_cubic)(uint32_t *row, ptrdiff_t stride, int first, int rows, int count)
{
	PLANE(quincunx)(row, stride, first, rows, count, true);
}

static void PLANE(quincunx_mean)(uint32_t *row, ptrdiff_t stride, int first, int rows, int count)
{
	PLANE(quincunx)(row, stride, first, rows, count, false);
}

static void PLANE(span)(const struct gz_lattice *lattice, int y, int x0, int x1, uint32_t *out)
{
	const int spacing = lattice->spacing, row = y / spacing;
	const float down = (float)(y - row * spacing) / (float)spacing;
	const uint32_t *above = lattice->points + (size_t)row * lattice->stride;
	const uint32_t *below = row + 1 < lattice->rows ? above + lattice->stride : above;
	for (int x = x0; x < x1; x++) {
		const int i = x / spacing, next = i + 1 < lattice->columns ? i + 1 : i;
		const float right = (float)(x - i * spacing) / (float)spacing;
		const POINT top =
			PLANE(mix)(PLANE(load)(above + i), PLANE(load)(above + next), right);
		const POINT bottom =
			PLANE(mix)(PLANE(load)(below + i), PLANE(load)(below + next), right);
		PLANE(store)(out + (x - x0), PLANE(mix)(top, bottom, down));
	}
}

static void PLANE(blend)(const uint32_t *behind, const uint32_t *shares, uint32_t *points,
			 int count)
{
	for (int i = 0; i < count; i++) {
		const float share = (float)shares[i] / 256.0F;
		const POINT mixed =
			PLANE(mix)(PLANE(load)(behind + i), PLANE(load)(points + i), share);
		PLANE(store)(points + i, mixed);
	}
}

static const struct gz_row_filters PLANE(filters) = {
	.double_cubic = PLANE(double_cubic),
	.double_mean = PLANE(double_mean),
	.quincunx_cubic = PLANE(quincunx_cubic),
	.quincunx_mean = PLANE(quincunx_mean),
	.span = PLANE(span),
	.blend = PLANE(blend),
};

#undef POINT
#undef PLANE
