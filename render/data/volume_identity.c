#include "render/data/volume_identity.h"

#include <string.h>
#include <zlib.h>

enum { RUNS = 4096, RUN_BYTES = 64 };

static uint32_t sum(const struct gz_volume *volume)
{
	const unsigned char *bytes = volume->voxels;
	const size_t size = gz_volume_voxel_count(volume) * gz_voxel_size(volume->type);
	const size_t stride = size / RUNS > RUN_BYTES ? size / RUNS : RUN_BYTES;
	uLong crc = crc32(0, NULL, 0);
	for (size_t at = 0; at < size; at += stride) {
		const size_t left = size - at;
		crc = crc32(crc, bytes + at, (uInt)(left < RUN_BYTES ? left : RUN_BYTES));
	}
	return (uint32_t)crc;
}

struct gz_volume_identity gz_volume_identify(const struct gz_volume *volume)
{
	const double a = volume->slope * volume->stored_min + volume->intercept;
	const double b = volume->slope * volume->stored_max + volume->intercept;
	struct gz_volume_identity identity = {
		.type = volume->type,
		.least = a < b ? a : b,
		.greatest = a < b ? b : a,
		.has_crc = volume->voxels != NULL,
		.crc = volume->voxels ? sum(volume) : 0,
	};
	memcpy(identity.dims, volume->dims, sizeof identity.dims);
	memcpy(identity.spacing, volume->spacing, sizeof identity.spacing);
	return identity;
}

bool gz_volume_identity_same(const struct gz_volume_identity *a, const struct gz_volume_identity *b)
{
	for (int axis = 0; axis < 3; axis++)
		if (a->dims[axis] != b->dims[axis] || a->spacing[axis] != b->spacing[axis])
			return false;
	return a->type == b->type && a->least == b->least && a->greatest == b->greatest &&
	       (!a->has_crc || !b->has_crc || a->crc == b->crc);
}
