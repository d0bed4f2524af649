/**
 * @file
 * From the numbers of a file to a volume: what every loader does once it knows the layout.
 *
 * Voxels are turned to RAS+ by the permutation and flips of the file's axes that lie nearest to its
 * directions. An oblique volume is not resampled: it is shown along the anatomical axes nearest to
 * its own, and the log says by how much they differ.
 */
#ifndef GZ_RENDER_DATA_VOLUME_IMPORT_H
#define GZ_RENDER_DATA_VOLUME_IMPORT_H

#include <stdbool.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "render/data/byte_stream.h"
#include "render/data/volume.h"

/** A file that is loaded, as the loaders pass it on. */
struct gz_volume_file {
	const char *path;                 /**< borrowed */
	const struct gz_raw_layout *raw;  /**< of files without a header; else NULL */
	const struct gz_loading *loading; /**< see gz_volume_load(); may be NULL */
	const struct gz_log *log;         /**< may be NULL */
};

/** The layout of a file's voxels. Axes are the file's own, the fastest first. */
struct gz_import_layout {
	int dims[3];
	double spacing[3];
	bool spacing_assumed;   /**< see struct gz_volume */
	double direction[3][3]; /**< [axis][x, y, z]: where each axis points in RAS+; any length */
	bool oriented;          /**< direction is anatomical */
	bool labels;            /**< numbers name things; see struct gz_volume */
	enum gz_modality modality;
	enum gz_raw_type type;
	bool big_endian;
	int channels; /**< numbers of a voxel: 0 or 1 its value, 3 red, green and blue, 4 and alpha;
			 interleaved */
	double slope, intercept; /**< data value = slope * number in the file + intercept; colours
				    are not scaled */
	int time_points;         /**< volumes of this layout, one behind the other; 0 means 1 */
	bool more_follows;       /**< more bytes after the voxels are no reason for a warning */
};

/** A loader's starting point: one voxel, spacing 1, unsigned bytes, axes as stored, slope 1. */
struct gz_import_layout gz_import_layout_default(void);

/** Bytes of one number of @p type in a file. */
size_t gz_raw_type_size(enum gz_raw_type type);

/** Bytes of one voxel of @p layout in a file. */
size_t gz_import_voxel_size(const struct gz_import_layout *layout);

/**
 * Read the voxels of a file into a volume. Signed integers become unsigned ones with an offset in
 * the intercept; doubles become float, and 32-bit integers too: where floats do not hold them
 * exactly, with an offset in the intercept, and where that does not help, rounded with a warning.
 * Of a series, the time point that the file's loading names is kept, and unless the range of the
 * series is known, all are read for it. Of colours, which may have 8 or 16 bits, 8 are kept; the
 * file's loading says what their values are.
 *
 * @param stream  at the first voxel of the first time point
 * @param layout  all of it is checked here
 * @param file    its path is for messages and progress
 * @param[out] out_volume  the caller frees it with gz_volume_free()
 * @retval GZ_ERR_INVAL   there is no such time point, or values are to be alpha and there is none;
 *                        logged
 * @retval GZ_ERR_UNSUPPORTED  colours of another type, or another number of channels; logged
 * @retval GZ_ERR_FORMAT  wrong dims, spacing, directions, slope or length of the data; logged
 * @retval GZ_ERR_IO      logged
 * @retval GZ_ERR_NO_MEM  logged with the size asked for
 * @retval GZ_ERR_CANCELLED  the file's loading says so; not logged
 */
enum gz_result gz_volume_import(struct gz_byte_stream *stream,
				const struct gz_import_layout *layout,
				const struct gz_volume_file *file, struct gz_volume *out_volume);

#endif
