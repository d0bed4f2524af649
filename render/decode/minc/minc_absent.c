/* In place of the reader where HDF5 was not found when the project was built. */
#include "render/decode/minc/minc_load.h"

#define GZ_LOG_MODULE "minc"

enum gz_result gz_minc_load(const struct gz_volume_file *file, const char *choice,
			    struct gz_volume *out_volume)
{
	(void)choice;
	(void)out_volume;
	gz_err(file->log,
	       "%s: MINC 2 is not read, because this build was made without HDF5; install it "
	       "(libhdf5-dev) and build again, or convert the file with: mnc2nii FILE out.nii "
	       "(minc-tools)",
	       file->path);
	return GZ_ERR_UNSUPPORTED;
}
