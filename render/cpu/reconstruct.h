/**
 * @file
 * From lattice points to the picture.
 */
#ifndef GZ_RENDER_CPU_RECONSTRUCT_H
#define GZ_RENDER_CPU_RECONSTRUCT_H

#include "render/cpu/lattice.h"
#include "render/workers.h"

/** Fill every pixel of @p image that was not cast. The same bits for any number of threads. */
void gz_reconstruct(const struct gz_plan *plan, const struct gz_lattices *lattices,
		    struct gz_workers *workers, struct gz_image *image);

/** Fill a block of the finer lattice from the one of twice its spacing.
 *
 *  @param coarse, fine  neighbours in a pyramid: point i of coarse is point 2i of fine
 *  @param x, y          first point of the block in @p fine; even
 *  @param edge          points to fill along each side; even; cut off at the edge of @p fine
 */
void gz_reconstruct_block(const struct gz_lattice *coarse, const struct gz_lattice *fine, int x,
			  int y, int edge);

/** Fill every second point of a block, those between the points of quincunx tiles, from their four
 *  neighbours in the same lattice. Parameters as above. */
void gz_reconstruct_quincunx(const struct gz_lattice *lattice, int x, int y, int width, int height);

/** Pixels from @p x0 up to, not including, @p x1 of row @p y, bilinearly from one lattice.
 *
 *  @param x0, x1    within the lattice's span; x0 < x1
 *  @param[out] out  the first pixel's place
 */
void gz_reconstruct_span(const struct gz_lattice *lattice, int y, int x0, int x1, uint32_t *out);

#endif
