/**
 * @file
 * The volume formats: one const row and one source file each. A new format is a file format_NAME.c
 * with its row, and the row's place in gz_volume_formats[].
 */
#ifndef GZ_RENDER_DATA_FORMAT_H
#define GZ_RENDER_DATA_FORMAT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "base/log.h"
#include "base/result.h"
#include "render/data/file_start.h"
#include "render/data/volume.h"
#include "render/data/volume_import.h"

/** Where the layout of the voxels comes from: dims, type, byte order and spacing. */
enum gz_layout_source {
	GZ_LAYOUT_IN_FILE,  /**< the file has a header; giving a layout is an error */
	GZ_LAYOUT_GIVEN,    /**< the user must give it */
	GZ_LAYOUT_IF_GIVEN, /**< the file is of this format only if the user gives a layout */
};

/** Most endings of a format's file names. */
#define GZ_FORMAT_ENDINGS_MAX 10

/** Writes a volume to @p path; as gz_bricks_write(). */
typedef enum gz_result gz_volume_writer(const struct gz_volume *volume, const char *path,
					const struct gz_loading *loading, const struct gz_log *log);

/** One format. Rows are const and have static storage. */
struct gz_volume_format {
	const char *name; /**< "NIfTI-1" */
	/** Endings of file names, ".nii"; unused ones are NULL. Case does not matter. */
	const char *endings[GZ_FORMAT_ENDINGS_MAX];
	enum gz_layout_source layout;

	/** Optional: whether a file that begins so is of the format. Must be sure: it decides
	 * before the name does. */
	bool (*knows_start)(const struct gz_file_start *start);

	/** Optional, of rows for several formats: which of them a start is that knows_start has
	 *  accepted, "NIfTI-2". Static storage. */
	const char *(*name_start)(const struct gz_file_start *start);

	/** Optional: whether @p path is of the format, for what its first bytes do not tell: a
	 *  folder, a file beside it, a guess. Called if no format knows the start. */
	bool (*recognise)(const char *path);

	/**
	 * Load a volume. On failure it logs the reason, except for GZ_ERR_CANCELLED.
	 *
	 * @param file             its raw layout is set only if the format needs one
	 * @param[out] out_volume  written on GZ_OK
	 */
	enum gz_result (*load)(const struct gz_volume_file *file, struct gz_volume *out_volume);

	/** Optional: writes files that end in endings[0]. */
	gz_volume_writer *write;

	const char *limits; /**< what is not read, for people: gz_volume_formats_print() */
};

/** All formats. If several have an ending of a name, the first counts: ".nii.gz" before ".gz". */
extern const struct gz_volume_format *const gz_volume_formats[];
extern const size_t gz_volume_format_count;

/** The format of a file by the ending of its name; NULL if no format has it. */
const struct gz_volume_format *gz_volume_format_by_name(const char *path);

/** The format of a file by its content; NULL if no format recognises it. Opens the file. Logs
 *  nothing. */
const struct gz_volume_format *gz_volume_format_by_content(const char *path);

/** Print all formats for people: names, endings and what is not read of each. */
void gz_volume_formats_print(FILE *out);

/** The writer for files that end as @p path does; NULL if there is none. */
gz_volume_writer *gz_volume_writer_by_name(const char *path);

/** The rows. */
extern const struct gz_volume_format gz_format_bricks, gz_format_dicom, gz_format_foreign,
	gz_format_inv3, gz_format_metaimage, gz_format_mgh, gz_format_minc, gz_format_nifti,
	gz_format_nrrd, gz_format_raw, gz_format_raw_by_layout;

/**
 * Write @p volume and its coarser levels as a file of bricks. It gets its name when it is complete.
 *
 * @param volume   must have voxels
 * @param path     replaced if it exists
 * @param loading  progress and cancelling; coarser levels are kept in its scratch folder, or in
 * memory without one: an eighth of the volume, and an eighth of that; may be NULL
 * @retval GZ_ERR_INVAL      @p volume has no voxels
 * @retval GZ_ERR_UNSUPPORTED  it has colours, which bricks do not hold; logged
 * @retval GZ_ERR_IO         @p path cannot be written; logged
 * @retval GZ_ERR_FULL       the disk is full; logged
 * @retval GZ_ERR_NO_MEM     no memory for the levels; logged
 * @retval GZ_ERR_CANCELLED  @p loading stopped it; not logged
 *
 * On failure no file remains.
 */
enum gz_result gz_bricks_write(const struct gz_volume *volume, const char *path,
			       const struct gz_loading *loading, const struct gz_log *log);

/**
 * Write @p volume as NRRD, encoding raw. The file gets its name when it is complete. NRRD cannot
 * store a slope and an intercept, so data values are written: as integers of 8 or 16 bits, or of 32
 * where floats would round them, if all of them are such, signed if the intercept is negative,
 * otherwise as floats. Colours are written as
 * RGB, with alpha if that is what the values are.
 *
 * @param loading  progress and cancelling; may be NULL
 * @retval GZ_ERR_INVAL        @p volume has no voxels
 * @retval GZ_ERR_IO           @p path cannot be written; logged
 * @retval GZ_ERR_FULL         the disk is full; logged
 * @retval GZ_ERR_CANCELLED    @p loading stopped it; not logged
 *
 * On failure no file remains.
 */
enum gz_result gz_nrrd_write(const struct gz_volume *volume, const char *path,
			     const struct gz_loading *loading, const struct gz_log *log);

#endif
