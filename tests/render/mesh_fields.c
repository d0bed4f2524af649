#include "suite.h"

#include "mesh_fields.h"

#include <math.h>
#include <string.h>

double field_ball(const double place[3])
{
	return 20 - sqrt(place[0] * place[0] + place[1] * place[1] + place[2] * place[2]);
}

double field_ring(const double place[3])
{
	const double across = sqrt(place[0] * place[0] + place[1] * place[1]) - 18;
	return 7 - sqrt(across * across + place[2] * place[2]);
}

static struct gz_volume field_allocate(const int dims[3], const double spacing[3],
				       enum gz_voxel_type type)
{
	struct gz_volume volume = { .type = type };
	memcpy(volume.dims, dims, sizeof volume.dims);
	memcpy(volume.spacing, spacing, sizeof volume.spacing);
	assert_int_equal(gz_volume_allocate(&volume), GZ_OK);
	return volume;
}

static void field_put(struct gz_volume *volume, size_t index, double stored)
{
	if (volume->type == GZ_VOXEL_U8)
		((uint8_t *)volume->voxels)[index] = (uint8_t)lround(stored);
	else if (volume->type == GZ_VOXEL_U16)
		((uint16_t *)volume->voxels)[index] = (uint16_t)lround(stored);
	else
		((float *)volume->voxels)[index] = (float)stored;
}

struct gz_volume field_volume(field_formula *formula, const int dims[3], const double spacing[3],
			      enum gz_voxel_type type)
{
	struct gz_volume volume = field_allocate(dims, spacing, type);
	const double most = type == GZ_VOXEL_U8 ? 255 : 65535;
	if (type != GZ_VOXEL_F32) {
		volume.slope = 16 / most;
		volume.intercept = -8;
	}
	size_t index = 0;
	for (int z = 0; z < dims[2]; z++)
		for (int y = 0; y < dims[1]; y++)
			for (int x = 0; x < dims[0]; x++) {
				const double place[3] = { (x + 0.5 - 0.5 * dims[0]) * spacing[0],
							  (y + 0.5 - 0.5 * dims[1]) * spacing[1],
							  (z + 0.5 - 0.5 * dims[2]) * spacing[2] };
				double value = formula(place);
				if (type != GZ_VOXEL_F32)
					value = fmin(fmax(value, -8), 8);
				field_put(&volume, index++,
					  (value - volume.intercept) / volume.slope);
			}
	gz_volume_find_range(&volume);
	return volume;
}

double field_random(uint32_t *seed)
{
	*seed = *seed * 1664525U + 1013904223U;
	return (*seed >> 8) / (double)(1 << 24);
}

struct gz_volume field_noise(const int dims[3], enum gz_voxel_type type, uint32_t seed, int walled)
{
	static const double even[3] = { 1, 1, 1 };
	struct gz_volume volume = field_allocate(dims, even, type);
	size_t index = 0;
	for (int z = 0; z < dims[2]; z++)
		for (int y = 0; y < dims[1]; y++)
			for (int x = 0; x < dims[0]; x++) {
				const int at[3] = { x, y, z };
				double value = field_random(&seed);
				for (int axis = 0; axis < 3 && walled; axis++)
					if (at[axis] == 0 || at[axis] == dims[axis] - 1)
						value = 0;
				field_put(&volume, index++,
					  type == GZ_VOXEL_F32 ? value : floor(255.99 * value));
			}
	gz_volume_find_range(&volume);
	return volume;
}
