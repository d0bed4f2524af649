/**
 * @file
 * Transfer functions to begin with, fitted to any volume by its histogram.
 */
#ifndef GZ_RENDER_TRANSFER_TRANSFER_PRESETS_H
#define GZ_RENDER_TRANSFER_TRANSFER_PRESETS_H

#include "render/transfer/histogram.h"
#include "render/transfer/transfer.h"

/** The looks there are. */
enum gz_transfer_preset {
	GZ_PRESET_TISSUE,  /**< what is soft as a veil, what is dense solid */
	GZ_PRESET_SURFACE, /**< one surface where object and background part */
	GZ_PRESET_GLASS,   /**< two see-through surfaces */
	GZ_PRESET_GREY,
	GZ_PRESET_HEAT,
	GZ_PRESET_INVERSE, /**< as grey, for data whose background is bright */
	GZ_PRESET_XRAY,
	GZ_PRESET_COUNT,
};

/** What shows something of every volume: for those that come without a transfer function. */
#define GZ_PRESET_DEFAULT GZ_PRESET_TISSUE

/** "tissue", "surface", …: what is written in commands and files. NULL-terminated. */
extern const char *const gz_transfer_preset_names[];

/** How a preset presents itself in a list. */
struct gz_transfer_preset_text {
	const char *title; /**< "Soft tissue and bone" */
	const char *about; /**< one line: what it shows */
};

/** The texts of a preset, static. */
const struct gz_transfer_preset_text *gz_transfer_preset_text(enum gz_transfer_preset which);

/**
 * Make a transfer function that shows a volume.
 *
 * @param histogram  of the volume
 * @param volume     its size tells how opaque a voxel length may be: a large volume is as
 *                   see-through as a small one
 * @param[out] out_transfer  with a range: the data's, without a far tail of few voxels (the top
 *                           0.01 %) where that takes up more than half of it
 */
void gz_transfer_preset_make(enum gz_transfer_preset which, const struct gz_histogram *histogram,
			     const struct gz_volume *volume, struct gz_transfer *out_transfer);

#endif
