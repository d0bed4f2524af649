/**
 * @file
 * The loaders, one a format; gz_volume_load() chooses among them.
 */
#ifndef GZ_RENDER_DATA_VOLUME_LOADERS_H
#define GZ_RENDER_DATA_VOLUME_LOADERS_H

#include "base/log.h"
#include "base/result.h"
#include "render/data/byte_stream.h"
#include "render/data/volume.h"

/** NIfTI-1 in one file, .nii or .nii.gz. sform before qform; of a series, the first volume. */
enum gz_result gz_volume_load_nifti(const char *path, const struct gz_loading *loading,
				    const struct gz_log *log, struct gz_volume *out_volume);

/** NRRD, attached (.nrrd) or detached (.nhdr); encodings raw and gzip. */
enum gz_result gz_volume_load_nrrd(const char *path, const struct gz_loading *loading,
				   const struct gz_log *log, struct gz_volume *out_volume);

/** MetaImage, .mha or .mhd; plain or zlib. */
enum gz_result gz_volume_load_metaimage(const char *path, const struct gz_loading *loading,
					const struct gz_log *log, struct gz_volume *out_volume);

/** A DICOM series: a folder, one file of it, or a file of several frames. */
enum gz_result gz_volume_load_dicom(const char *path, const struct gz_loading *loading,
				    const struct gz_log *log, struct gz_volume *out_volume);

/** Numbers without a header. */
enum gz_result gz_volume_load_raw(const char *path, enum gz_coding coding,
				  const struct gz_raw_layout *raw, const struct gz_loading *loading,
				  const struct gz_log *log, struct gz_volume *out_volume);

/** Bricks, .gzb: the coarse levels are read, the rest when it is looked at. */
enum gz_result gz_volume_load_bricks(const char *path, const struct gz_loading *loading,
				     const struct gz_log *log, struct gz_volume *out_volume);

#endif
