/**
 * @file
 * Volumes whose voxels come slice by slice from a library that can give any slice.
 */
#ifndef GZ_RENDER_DATA_SLICE_IMPORT_H
#define GZ_RENDER_DATA_SLICE_IMPORT_H

#include "render/data/volume_import.h"

/** Gives slices. */
struct gz_slice_source {
	/**
	 * Give one slice. Called with indices in order; the first is 0 or the first slice of a time
	 * point, because slices that are not needed are passed over.
	 *
	 * @param index  of the slice, time points one behind the other
	 * @param[out] numbers  of dims[0] * dims[1] voxels, as the layout has them
	 * @return GZ_OK; another result ends the import and is logged by the source
	 */
	enum gz_result (*read)(void *user, uint64_t index, void *numbers);
	void *user;
	uint64_t bytes_bound; /**< the most bytes that all slices can have, by the size of the file
			       */
};

/**
 * Read slices into a volume, one slice in memory.
 *
 * @param[out] out_volume  the caller frees it with gz_volume_free()
 * @retval GZ_ERR_NO_MEM  logged
 * @return otherwise as gz_volume_import(), and what the source returns
 */
enum gz_result gz_volume_import_slices(const struct gz_slice_source *source,
				       const struct gz_import_layout *layout,
				       const struct gz_volume_file *file,
				       struct gz_volume *out_volume);

#endif
