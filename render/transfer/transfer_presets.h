/**
 * @file
 * Preset transfer functions, fitted to any volume by its histogram.
 */
#ifndef GZ_RENDER_TRANSFER_TRANSFER_PRESETS_H
#define GZ_RENDER_TRANSFER_TRANSFER_PRESETS_H

#include <stdbool.h>

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
	GZ_PRESET_FIELD,     /**< far from the most frequent value is dense */
	GZ_PRESET_CT_TISSUE, /**< this and those below: for Hounsfield units */
	GZ_PRESET_CT_BONE,
	GZ_PRESET_CT_VESSELS, /**< filled with contrast medium, and bone */
	GZ_PRESET_CT_SKIN,
	GZ_PRESET_CT_LUNG,
	GZ_PRESET_MRI, /**< dim tissue as a veil, bright tissue solid */
	GZ_PRESET_COUNT,
};

/** "auto", which leaves it to gz_transfer_preset_for(), then the names: "tissue", "surface", …
 *  NULL-terminated. */
extern const char *const gz_transfer_preset_choices[];

/** How a preset is described in a list. */
struct gz_transfer_preset_text {
	const char *title; /**< "Soft tissue and bone" */
	const char *about; /**< one line: what it shows */
	bool lit; /**< it shows surfaces, which need lighting (render.shading = gradient) */
};

/** The texts of a preset, static. */
const struct gz_transfer_preset_text *gz_transfer_preset_text(enum gz_transfer_preset which);

/**
 * Whether values are Hounsfield units of a body in air: many voxels lie around air (-1000) and
 * around water (0), and few lie between.
 */
bool gz_histogram_is_hounsfield(const struct gz_histogram *histogram);

/** Whether a preset makes sense: those for Hounsfield units and for MRI do not for other values.
 *  CT that was rescaled has Hounsfield units; where the file does not say what made the volume, the
 *  histogram tells, and MRI is possible. */
bool gz_transfer_preset_fits(enum gz_transfer_preset which, const struct gz_histogram *histogram,
			     enum gz_modality modality);

/** The preset for a volume without a transfer function: bone in soft tissue if values are
 * Hounsfield units; GZ_PRESET_INVERSE in front of a bright ground, and GZ_PRESET_FIELD if the most
 * frequent value lies in the middle of the others; GZ_PRESET_MRI if the file says so; else
 * GZ_PRESET_TISSUE, which shows something of every volume. */
enum gz_transfer_preset gz_transfer_preset_for(const struct gz_histogram *histogram,
					       enum gz_modality modality);

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
