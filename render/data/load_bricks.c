/* A file of bricks as a volume whose voxels are fetched when they are looked at. */
#include <string.h>

#include "render/data/brick_pool.h"
#include "render/data/volume_loaders.h"

enum gz_result gz_volume_load_bricks(const char *path, const struct gz_loading *loading,
				     const struct gz_log *log, struct gz_volume *out_volume)
{
	struct gz_brick_pool *pool = NULL;
	const enum gz_result result =
		gz_brick_pool_open(path, loading ? loading->brick_bytes : 0, log, &pool);
	if (result != GZ_OK)
		return result;
	const struct gz_brick_header *header = &gz_brick_pool_file(pool)->header;
	struct gz_volume volume = {
		.type = header->type,
		.bricks = pool,
		.slope = header->slope,
		.intercept = header->intercept,
		.stored_min = header->stored_min,
		.stored_max = header->stored_max,
		.oriented = header->oriented,
	};
	memcpy(volume.dims, header->dims, sizeof volume.dims);
	memcpy(volume.spacing, header->spacing, sizeof volume.spacing);
	*out_volume = volume;
	return GZ_OK;
}
