/**
 * @file
 * One DICOM series as a stack of slices in order: GDCM behind a C interface.
 *
 * The slices are the files of one series in one folder, or the frames of one file. They are ordered
 * by where they lie along the normal of their planes (DICOM PS3.3, C.7.6.2.1.1), not by name or
 * number. Slices that do not lie evenly are resampled if that is asked for (slice_grid.h).
 */
#ifndef GZ_RENDER_DECODE_DICOM_SERIES_H
#define GZ_RENDER_DECODE_DICOM_SERIES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#include "base/log.h"
#include "base/result.h"
#include "render/data/volume_import.h"

struct gz_dicom_series;

/** What the slices have in common. */
struct gz_dicom_geometry {
	int dims[3];            /**< columns, rows, slices */
	double spacing[3];      /**< mm between columns, rows, slices */
	bool spacing_assumed;   /**< the files do not tell the first two, which are 1 */
	double direction[3][3]; /**< [axis][x, y, z] in RAS+ */
	bool oriented;          /**< the files told where they lie */
	bool labels;            /**< they are a segmentation */
	enum gz_modality modality;
	enum gz_raw_type type; /**< of what gz_dicom_series_read() gives, in host byte order */
	int channels;          /**< numbers of a voxel: 1, or 3 for red, green and blue */
	double slope, intercept;
	int time_points;      /**< stacks of slices, one behind the other; 1 or more */
	uint64_t bytes_bound; /**< the most bytes that the files' pixel data can hold */
};

/**
 * Find the slices.
 *
 * @param file  its path is a folder that holds one series, or one file of a series (its folder is
 * looked through for the others), a file with several frames, or a DICOMDIR, which stands for all
 * that lies in its folder and below. A folder without images stands for its sub-folders. Borrowed
 * until the series is closed. Its loading is asked after each file of a folder whether to go on,
 * and says whether slices that do not lie evenly are resampled.
 * @param choice  UID of the series wanted; NULL: the file's, or the only one
 * @param[out] out_series  owned by the caller: gz_dicom_series_close()
 * @retval GZ_ERR_NOT_FOUND    no such file, folder or series; logged
 * @retval GZ_ERR_FORMAT       no DICOM image there, several series, slices that do not fit
 *                             together, are missing or lie unevenly; logged with the remedy
 * @retval GZ_ERR_UNSUPPORTED  a kind of colour or a compression that is not read; logged with the
 *                             remedy
 * @retval GZ_ERR_NO_MEM       logged
 * @retval GZ_ERR_CANCELLED    not logged
 */
enum gz_result gz_dicom_series_open(const struct gz_volume_file *file, const char *choice,
				    struct gz_dicom_series **out_series);

/** What was found. */
const struct gz_dicom_geometry *gz_dicom_series_geometry(const struct gz_dicom_series *series);

/**
 * Get a slice. Threads decode a few ahead. If slices are moved within their planes, the first call
 * decodes those of the first time point for their least number before.
 *
 * @param index  of all time points, one behind the other: any first; then the one behind that of
 * the call before
 * @param[out] voxels  columns * rows voxels, of the geometry's type and channels
 * @retval GZ_ERR_FORMAT, GZ_ERR_IO  its pixels are damaged, or the file is gone; logged
 * @retval GZ_ERR_NO_MEM             logged
 * @retval GZ_ERR_CANCELLED          the file's loading says so; not logged
 */
enum gz_result gz_dicom_series_read(struct gz_dicom_series *series, uint64_t index, void *voxels);

/** Close and set to NULL. Accepts a pointer to NULL. */
void gz_dicom_series_close(struct gz_dicom_series **series);

#ifdef __cplusplus
}
#endif

#endif
