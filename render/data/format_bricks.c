/* Files of bricks: volumes whose voxels are read when they are visible. */
#include <string.h>

#include "render/data/brick_file.h"
#include "render/data/brick_pool.h"
#include "render/data/format.h"

static bool bricks_know_start(const struct gz_file_start *start)
{
	return start->coding == GZ_CODING_PLAIN &&
	       gz_file_start_has(start, 0, GZ_BRICK_MAGIC, sizeof GZ_BRICK_MAGIC - 1);
}

static enum gz_result load_bricks(const struct gz_volume_file *file, struct gz_volume *out_volume)
{
	struct gz_brick_pool *pool = NULL;
	const enum gz_result result = gz_brick_pool_open(
		file->path, file->loading ? file->loading->brick_bytes : 0, file->log, &pool);
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
		.spacing_assumed = header->spacing_assumed,
		.modality = header->modality,
		.oriented = header->oriented,
	};
	memcpy(volume.dims, header->dims, sizeof volume.dims);
	memcpy(volume.spacing, header->spacing, sizeof volume.spacing);
	*out_volume = volume;
	return GZ_OK;
}

const struct gz_volume_format gz_format_bricks = {
	.name = "bricks",
	.endings = { ".gzb" },
	.layout = GZ_LAYOUT_IN_FILE,
	.knows_start = bricks_know_start,
	.load = load_bricks,
	.write = gz_bricks_write,
	.limits = "version 1 of the format only",
};
