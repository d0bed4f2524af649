/**
 * @file
 * A transfer function as a table over a volume's stored values, for one step length or any: both
 * backends look it up along a ray.
 */
#ifndef GZ_RENDER_TRANSFER_TRANSFER_TABLE_H
#define GZ_RENDER_TRANSFER_TRANSFER_TABLE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/result.h"
#include "render/data/volume.h"
#include "render/transfer/transfer.h"
#include "render/transfer/transfer_constants.h"

/** One entry of a table. */
struct gz_transfer_entry {
	/** Which one it is depends on the table: the opacity of one step, [0, 1], or the
	 * extinction: log2 of the transparency of one voxel length, 0 or less. A step of d voxel
	 * lengths then has the opacity 1 - exp2(d * extinction). */
	union {
		float opacity;
		float extinction;
	};
	uint32_t colour; /**< 11 bits of red, 11 of green, 10 of blue, from the top */
};

/**
 * Entry i stands for the stored value low + i * (high - low) / (count - 1); values outside [low,
 * high] take the first or last entry.
 *
 * The arrays have room for the finest table. What is beyond `count` is never touched, so a
 * zero-initialised table takes no more memory than it uses.
 */
struct gz_transfer_table {
	/** Entries in use: GZ_TRANSFER_TABLE_SIZE, or for a function with a peak that would fall
	 *  between two of these, that times a power of two, up to GZ_TRANSFER_TABLE_MOST. */
	int count;
	double scale, bias;      /**< entry = stored * scale + bias */
	double value_per_stored; /**< growth of the function's value (0 to 1 over its range)
				    per stored value; 0 for a range without width */
	double rounding; /**< by which kernels, in single precision, may miss an entry, entries */
	struct gz_transfer_entry entries[GZ_TRANSFER_TABLE_MOST]; /**< with extinction */
	/** Number of entries before i with any opacity: a range of values is visible if and only
	 *  if the number grows over it. */
	uint32_t visible_before[GZ_TRANSFER_TABLE_MOST + 1];
};

/** Whether single precision can divide the part of the function's range that the data have. If it
 * cannot, the table spans the least range that it can, and the function looks like a step there. */
bool gz_transfer_range_divides(const struct gz_transfer *transfer, const struct gz_volume *volume);

/** Make the table of @p transfer for the stored values of @p volume; entries hold extinction. */
void gz_transfer_table_bake(const struct gz_transfer *transfer, const struct gz_volume *volume,
			    struct gz_transfer_table *out_table);

/** The entries with the opacity of a step of @p length voxel lengths: as many as the table has. */
void gz_transfer_table_step(const struct gz_transfer_table *table, double length,
			    struct gz_transfer_entry *out_entries);

/** The entry nearest to a stored value. */
int gz_transfer_table_nearest(const struct gz_transfer_table *table, float stored);

/** Whether any stored value from @p least to @p greatest has opacity. */
bool gz_transfer_table_shows(const struct gz_transfer_table *table, double least, double greatest);

#endif
