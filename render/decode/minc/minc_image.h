/**
 * @file
 * The image of a MINC 2 file, slice by slice: HDF5 behind an interface of the project.
 *
 * MINC 2 is a layout of HDF5: the image is /minc-2.0/image/0/image, its axes are named by its
 * attribute dimorder, and /minc-2.0/dimensions has an object for each (en.wikibooks.org/wiki/MINC,
 * "MINC 2.0 File Format Reference"). HDF5 is asked directly and not through libminc, because that
 * reads what one object holds into memory sized by what another one states, converts files that it
 * cannot open into a file in /tmp, and follows links to other files.
 */
#ifndef GZ_RENDER_DECODE_MINC_IMAGE_H
#define GZ_RENDER_DECODE_MINC_IMAGE_H

#include <stdint.h>

#include "base/result.h"
#include "render/data/volume_import.h"

/** An open image. */
struct gz_minc_image;

/**
 * Open a file and read all but its voxels.
 *
 * @param file  borrowed until the image is closed
 * @param[out] out_image  owned by the caller: gz_minc_image_close()
 * @retval GZ_ERR_NOT_FOUND    no such file; logged
 * @retval GZ_ERR_FORMAT       no HDF5, no MINC in it, or damaged; logged
 * @retval GZ_ERR_UNSUPPORTED  several numbers a voxel, 64-bit integers, irregular samples, voxels
 * in other files, a filter that HDF5 lacks here; logged with the remedy
 * @retval GZ_ERR_NO_MEM       logged
 */
enum gz_result gz_minc_image_open(const struct gz_volume_file *file,
				  struct gz_minc_image **out_image);

/** The layout of the slices: dims[2] of each time point. Numbers are in the host's byte order.
 * Where the file scales slices apart, they are floats with that applied. */
const struct gz_import_layout *gz_minc_image_layout(const struct gz_minc_image *image);

/** The most bytes that the voxels can have in memory, by the size of the file. */
uint64_t gz_minc_image_bytes_bound(const struct gz_minc_image *image);

/**
 * Read a slice.
 *
 * @param index  of the slice, time points one behind the other; below dims[2] times time points
 * @param[out] numbers  dims[0] * dims[1] of the layout's type. Integers outside the file's valid
 * range are at its ends.
 * @retval GZ_ERR_FORMAT  the file is damaged there; logged
 * @retval GZ_ERR_NO_MEM  logged
 */
enum gz_result gz_minc_image_read(struct gz_minc_image *image, uint64_t index, void *numbers);

/** Close and set to NULL. Accepts a pointer to NULL. */
void gz_minc_image_close(struct gz_minc_image **image);

#endif
