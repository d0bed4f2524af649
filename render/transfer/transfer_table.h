/**
 * @file
 * A transfer function baked for a volume's stored values and a set of step lengths: what both
 * backends look up along a ray.
 */
#ifndef GZ_RENDER_TRANSFER_TRANSFER_TABLE_H
#define GZ_RENDER_TRANSFER_TRANSFER_TABLE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/result.h"
#include "render/data/volume.h"
#include "render/transfer/transfer.h"
#include "render/transfer/transfer_constants.h"

/** What one look-up brings. */
struct gz_transfer_entry {
	/** By table: the opacity of one step, [0, 1], or log2 of the transparency of one voxel
	 * length, 0 or less, from which a step of length d (in voxel lengths) has the opacity 1 -
	 * exp2(d * extinction): the correction for the step in a form without powers. */
	union {
		float opacity;
		float extinction;
	};
	uint32_t colour; /**< 11 bits of red, 11 of green, 10 of blue, from the top */
};

/** Entry i stands for the stored value low + i * (high - low) / (SIZE - 1); values beyond are
 * clamped. */
struct gz_transfer_table {
	double scale, bias;      /**< entry = stored * scale + bias */
	double value_per_stored; /**< by what the function's value, 0 to 1 over its range, grows
				    with the stored one; 0 for a range without width */
	struct gz_transfer_entry entries[GZ_TRANSFER_TABLE_SIZE]; /**< with extinction */
	/** Number of entries before i with any opacity: a range of values shows iff the count grows
	 *  over it. */
	uint16_t visible_before[GZ_TRANSFER_TABLE_SIZE + 1];
};

/** Bake @p transfer for the stored values of @p volume. */
void gz_transfer_table_bake(const struct gz_transfer *transfer, const struct gz_volume *volume,
			    struct gz_transfer_table *out_table);

/** The entries with the opacity of a step of @p length voxel lengths. */
void gz_transfer_table_step(const struct gz_transfer_table *table, double length,
			    struct gz_transfer_entry out_entries[GZ_TRANSFER_TABLE_SIZE]);

/** Whether any stored value from @p least to @p greatest has opacity. */
bool gz_transfer_table_shows(const struct gz_transfer_table *table, double least, double greatest);

#endif
