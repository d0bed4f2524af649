/**
 * @file
 * Where a header says that its voxels are, and the import from there.
 */
#ifndef GZ_RENDER_DATA_VOXEL_SOURCE_H
#define GZ_RENDER_DATA_VOXEL_SOURCE_H

#include <stdint.h>

#include "protocol/gaze.h"
#include "render/data/byte_stream.h"
#include "render/data/volume_import.h"

/** Skip that puts the voxels at the end of the file. */
#define GZ_SKIP_TO_END (-1)

/** A place in a file. */
struct gz_voxel_source {
	char path[GZ_PATH_SIZE];
	enum gz_coding coding;
	uint64_t offset; /**< bytes of the file before the coded data */
	int64_t skip;    /**< bytes to pass over behind that, after decoding; or GZ_SKIP_TO_END,
			    for plain data only */
};

/** Open the source and import the voxels: errors of gz_byte_stream_open(), gz_byte_stream_skip()
 * and gz_volume_import(), all logged. */
enum gz_result gz_voxel_source_import(const struct gz_voxel_source *source,
				      const struct gz_import_layout *layout,
				      const struct gz_loading *loading, const struct gz_log *log,
				      struct gz_volume *out_volume);

#endif
