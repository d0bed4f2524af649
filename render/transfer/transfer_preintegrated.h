/**
 * @file
 * Pre-integrated transfer functions (Engel, Kraus and Ertl, High-Quality Pre-Integrated Volume
 * Rendering Using Hardware-Accelerated Pixel Shading, 2001): colour and opacity of a segment of a
 * ray, looked up by the values at its two ends; between them the data are taken to be linear. Both
 * backends use them with `integration = preintegrated`.
 *
 * Cell c of GZ_PREINTEGRATED_SIZE stands for the entries [c * S, (c + 1) * S) of the transfer
 * table, S = GZ_PREINTEGRATED_STRIDE(its count). A segment between two cells runs from the middle
 * of one to the middle of the other; a segment within one cell has the mean of that cell's entries.
 * No entry is left out between cells: a ray that passes a spike includes it, and a segment that
 * ends in the spike's cell shares it with the next segment, which begins there. With a finer
 * transfer table than usual, the backends take segments within a few entries from the table of
 * samples instead (GZ_CLOSE_ENTRIES).
 *
 * Opacity comes from the integral of the extinction over the values, exact to the entry: 1 -
 * exp2(length * mean extinction). The order of colours is kept in quarters of a segment: each
 * quarter has the mean colour of its values, weighted by extinction, and the quarters are blended
 * front to back.
 */
#ifndef GZ_RENDER_TRANSFER_TRANSFER_PREINTEGRATED_H
#define GZ_RENDER_TRANSFER_TRANSFER_PREINTEGRATED_H

#include <stddef.h>

#include "base/result.h"
#include "base/workers.h"
#include "render/transfer/transfer_constants.h"
#include "render/transfer/transfer_table.h"

/** Entries in a cell, for a transfer table of @p count entries. A power of two. */
#define GZ_PREINTEGRATED_STRIDE(count) ((count) / GZ_PREINTEGRATED_SIZE)

/** Entries of one table: the entry of front cell f and back cell b is number f *
 * GZ_PREINTEGRATED_SIZE + b. */
#define GZ_PREINTEGRATED_ENTRIES ((size_t)GZ_PREINTEGRATED_SIZE * GZ_PREINTEGRATED_SIZE)

/** Sums over the entries before i: extinction, and extinction times colour. Extinction is -log2 of
 *  the transparency of a voxel length here, 0 or more. */
struct gz_transfer_sums {
	int count; /**< entries of the table; the rest of the array is not touched */
	double sum[GZ_TRANSFER_TABLE_MOST + 1]
		  [4]; /**< extinction; extinction times red, green, blue */
};

/** Sum up a table; the sums serve every step length. Opaque entries get an extinction so large that
 * a segment through a single one of them is opaque at every step length. */
void gz_transfer_sums_make(const struct gz_transfer_table *table,
			   struct gz_transfer_sums *out_sums);

/**
 * The tables of segments of @p count lengths, voxel lengths. Together they take less time than one
 * by one.
 *
 * @param workers          share the rows; NULL for the calling thread alone. The result has the
 * same bits for any number and on any processor
 * @param[out] out_tables  for each length GZ_PREINTEGRATED_ENTRIES entries, with opacity
 */
void gz_transfer_preintegrate(const struct gz_transfer_sums *sums, const double lengths[],
			      int count, struct gz_workers *workers,
			      struct gz_transfer_entry *const out_tables[]);

/**
 * The table for segments of any length, used for the rest of a step at the end of a ray: the mean
 * extinction in the form of gz_transfer_table_bake() (log2 of the transparency, 0 or less) and the
 * mean colour weighted by extinction, whatever the order of the colours.
 */
void gz_transfer_preintegrate_extinction(const struct gz_transfer_sums *sums,
					 struct gz_workers *workers,
					 struct gz_transfer_entry *out_entries);

#endif
