/**
 * @file
 * Preset transfer functions, fitted to any volume by its histogram.
 */
#ifndef GZ_RENDER_TRANSFER_TRANSFER_PRESETS_H
#define GZ_RENDER_TRANSFER_TRANSFER_PRESETS_H

#include "render/transfer/histogram.h"
#include "render/transfer/transfer.h"

/** The presets. */
enum gz_transfer_preset {
	GZ_PRESET_TISSUE,  /**< soft parts as a veil, dense parts solid */
	GZ_PRESET_SURFACE, /**< one surface, between object and background */
	GZ_PRESET_GLASS,   /**< two transparent surfaces */
	GZ_PRESET_GREY,
	GZ_PRESET_HEAT,
	GZ_PRESET_INVERSE, /**< like grey, for data with a bright background */
	GZ_PRESET_XRAY,
	GZ_PRESET_COUNT,
};

/** The preset for volumes without a transfer function: it shows something of every volume. */
#define GZ_PRESET_DEFAULT GZ_PRESET_TISSUE

/** Names in command lines and files: "tissue", "surface", … NULL-terminated. */
extern const char *const gz_transfer_preset_names[];

/** How a preset is described in a list. */
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
 * @param volume     its size sets the opacity of a voxel length, so that a large volume is as
 *                   transparent as a small one
 * @param[out] out_transfer  its range is that of the data; if the top 0.01 % of the voxels take up
 *                           more than half of it, they are left out
 */
void gz_transfer_preset_make(enum gz_transfer_preset which, const struct gz_histogram *histogram,
			     const struct gz_volume *volume, struct gz_transfer *out_transfer);

#endif
