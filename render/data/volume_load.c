/* Which loader reads a file, by its name. */
#include <stddef.h>

#include "base/file.h"
#include "render/data/dicom_series.h"
#include "render/data/volume.h"
#include "render/data/volume_loaders.h"

#define GZ_LOG_MODULE "volume"

/* The loaders of files that have a header. */
static const struct {
	const char *ending;
	enum gz_result (*load)(const char *path, const struct gz_loading *loading,
			       const struct gz_log *log, struct gz_volume *out_volume);
} with_header[] = {
	{ ".nii", gz_volume_load_nifti },     { ".nii.gz", gz_volume_load_nifti },
	{ ".nrrd", gz_volume_load_nrrd },     { ".nhdr", gz_volume_load_nrrd },
	{ ".mhd", gz_volume_load_metaimage }, { ".mha", gz_volume_load_metaimage },
	{ ".gzb", gz_volume_load_bricks },    { ".dcm", gz_volume_load_dicom },
};

/* Headerless ones; the header kinds have been tried before. */
static const struct {
	const char *ending;
	enum gz_coding coding;
} headerless[] = {
	{ ".zst", GZ_CODING_ZSTD },
	{ ".gz", GZ_CODING_ZLIB },
	{ ".raw", GZ_CODING_PLAIN },
};

/* Raw data where a layout is given; else they may be anything. */
static const char *const perhaps_headerless[] = { ".bin", ".dat", ".vol", ".img" };

enum gz_result gz_volume_load(const char *path, const struct gz_raw_layout *raw,
			      const struct gz_loading *loading, const struct gz_log *log,
			      struct gz_volume *out_volume)
{
	for (size_t i = 0; i < sizeof with_header / sizeof with_header[0]; i++) {
		if (!gz_path_ends(path, with_header[i].ending))
			continue;
		if (!raw)
			return with_header[i].load(path, loading, log, out_volume);
		gz_err(log, "%s: has a header; leave out dims, type, endian and spacing", path);
		return GZ_ERR_INVAL;
	}
	for (size_t i = 0; i < sizeof headerless / sizeof headerless[0]; i++) {
		if (!gz_path_ends(path, headerless[i].ending))
			continue;
		if (raw)
			return gz_volume_load_raw(path, headerless[i].coding, raw, loading, log,
						  out_volume);
		gz_err(log, "%s: has no header; give dims, type, endian and spacing", path);
		return GZ_ERR_INVAL;
	}
	for (size_t i = 0; i < sizeof perhaps_headerless / sizeof perhaps_headerless[0]; i++)
		if (raw && gz_path_ends(path, perhaps_headerless[i]))
			return gz_volume_load_raw(path, GZ_CODING_PLAIN, raw, loading, log,
						  out_volume);
	/* Names of DICOM files often say nothing. */
	if (!raw && gz_dicom_is(path))
		return gz_volume_load_dicom(path, loading, log, out_volume);
	gz_err(log,
	       "%s: unknown kind of volume; .nii, .nii.gz, .nrrd, .nhdr, .mhd, .mha, .raw, "
	       ".raw.zst, .raw.gz, .gzb and DICOM (.dcm, or its folder) are read",
	       path);
	return GZ_ERR_UNSUPPORTED;
}
