/**
 * @file
 * A transfer function baked for a volume's stored values and a set of step lengths: what both
 * backends look up along a ray.
 */
#ifndef GZ_RENDER_TRANSFER_TABLE_H
#define GZ_RENDER_TRANSFER_TABLE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/result.h"
#include "render/transfer.h"
#include "render/volume.h"

/** Entries of a table. Chosen: 16 between two grey levels of 8-bit data; opacity and colour at the
 *  nearest entry, 16 KiB each, so that the used part stays in the first-level cache. */
#define GZ_TRANSFER_TABLE_SIZE 4096

/** Entry i stands for the stored value low + i * (high - low) / (SIZE - 1); values beyond are
 * clamped. */
struct gz_transfer_table {
	double scale, bias; /**< entry = stored * scale + bias */
	/** log2 of the transparency of one voxel length, 0 or less; a step of length d (in voxel
	 * lengths) has the opacity 1 - exp2(d * extinction): architecture's correction, in a form
	 * without powers. */
	float extinction[GZ_TRANSFER_TABLE_SIZE];
	/** 11 bits of red, 11 of green, 10 of blue, from the top. */
	uint32_t colour[GZ_TRANSFER_TABLE_SIZE];
	/** Number of entries before i with any opacity: a range of values shows iff the count grows
	 * over it. */
	uint16_t visible_before[GZ_TRANSFER_TABLE_SIZE + 1];
};

/** Bake @p transfer for the stored values of @p volume. */
void gz_transfer_table_bake(const struct gz_transfer *transfer, const struct gz_volume *volume,
			    struct gz_transfer_table *out_table);

/** Opacities of a step of @p length voxel lengths, one an entry. */
void gz_transfer_table_opacities(const struct gz_transfer_table *table, double length,
				 float out_opacity[GZ_TRANSFER_TABLE_SIZE]);

/** Whether any stored value from @p least to @p greatest has opacity. */
bool gz_transfer_table_shows(const struct gz_transfer_table *table, double least, double greatest);

#endif
