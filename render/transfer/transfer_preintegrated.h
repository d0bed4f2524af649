/**
 * @file
 * Pre-integrated transfer functions (Engel, Kraus and Ertl, High-Quality Pre-Integrated Volume
 * Rendering Using Hardware-Accelerated Pixel Shading, 2001): colour and opacity of a segment of a
 * ray by the values at its two ends, all values between taken in as if the data went linearly from
 * one to the other. What both backends look up with `integration = preintegrated`.
 *
 * Cell c of GZ_PREINTEGRATED_SIZE stands for the entries [c * S, (c + 1) * S) of the transfer
 * table, S = GZ_PREINTEGRATED_STRIDE, and for the place in their middle where it is the end of a
 * segment that begins elsewhere. A segment within one cell has the mean of that cell's entries. So
 * no entry lies between cells: a ray that goes from one side of a spike to the other takes it in,
 * and a segment that ends in the spike's cell shares it with the next, which begins there.
 *
 * Opacity comes from the integral of the extinction over the values, exact to the entry: 1 -
 * exp2(length * mean extinction). The order of colours within a segment is kept to a quarter: each
 * quarter has the mean colour of its values by their extinction, and quarters are blended front to
 * back.
 */
#ifndef GZ_RENDER_TRANSFER_TRANSFER_PREINTEGRATED_H
#define GZ_RENDER_TRANSFER_TRANSFER_PREINTEGRATED_H

#include <stddef.h>

#include "base/result.h"
#include "base/workers.h"
#include "render/transfer/transfer_constants.h"
#include "render/transfer/transfer_table.h"

/** Entries of the transfer table a cell. */
#define GZ_PREINTEGRATED_STRIDE (GZ_TRANSFER_TABLE_SIZE / GZ_PREINTEGRATED_SIZE)

/** Entries of one table: that of front cell f and back cell b is f * GZ_PREINTEGRATED_SIZE + b. */
#define GZ_PREINTEGRATED_ENTRIES ((size_t)GZ_PREINTEGRATED_SIZE * GZ_PREINTEGRATED_SIZE)

/** Sums of extinction, and of extinction times colour, over the entries before i. Extinction is
 *  -log2 of the transparency of a voxel length, 0 or more, here. */
struct gz_transfer_sums {
	double sum[GZ_TRANSFER_TABLE_SIZE + 1][4]; /**< extinction; red, green, blue times it */
};

/** Sum over a table: what all step lengths are made of. Opaque entries count as an extinction so
 *  large that a segment through nothing but one of them is opaque at every step. */
void gz_transfer_sums_make(const struct gz_transfer_table *table,
			   struct gz_transfer_sums *out_sums);

/**
 * The table of segments of @p length voxel lengths.
 *
 * @param workers      who share out the rows; NULL for the calling thread alone. The same bits for
 * any number
 * @param[out] out_entries  GZ_PREINTEGRATED_ENTRIES of them, with opacity
 */
void gz_transfer_preintegrate(const struct gz_transfer_sums *sums, double length,
			      struct gz_workers *workers, struct gz_transfer_entry *out_entries);

/**
 * The table for segments of any length, for what is left at the ends of a ray: the mean extinction
 * as gz_transfer_table_bake() has it (log2 of the transparency, 0 or less), and the mean colour by
 * extinction, whatever its order.
 */
void gz_transfer_preintegrate_extinction(const struct gz_transfer_sums *sums,
					 struct gz_workers *workers,
					 struct gz_transfer_entry *out_entries);

#endif
