#include "render/data/halve.h"

#include <math.h>

static int halved(int count)
{
	return (count + 1) / 2;
}

void gz_halve_axes(const int dims[3], const double spacing[3], bool out_axes[3])
{
	double least = INFINITY;
	for (int axis = 0; axis < 3; axis++)
		if (dims[axis] > 1)
			least = fmin(least, spacing[axis]);
	for (int axis = 0; axis < 3; axis++)
		out_axes[axis] = dims[axis] > 1 && spacing[axis] < M_SQRT2 * least;
}

/*
 * Mean of eight voxels, two of each of four rows; a row that has no partner comes twice, and so
 * does a voxel. Floats are divided before they are added: the sum of the greatest would be
 * infinite.
 */
#define SUM_WHOLE(r, a, b)                                                                 \
	((unsigned)(r)[0][a] + (r)[0][b] + (r)[1][a] + (r)[1][b] + (r)[2][a] + (r)[2][b] + \
	 (r)[3][a] + (r)[3][b])
#define MEAN_WHOLE(r, a, b)    ((SUM_WHOLE(r, a, b) + 4) >> 3)
#define PAIR_EIGHTH(row, a, b) (0.125F * (row)[a] + 0.125F * (row)[b])
#define MEAN_FLOAT(r, a, b)                                        \
	((PAIR_EIGHTH((r)[0], a, b) + PAIR_EIGHTH((r)[1], a, b)) + \
	 (PAIR_EIGHTH((r)[2], a, b) + PAIR_EIGHTH((r)[3], a, b)))

#define DEFINE_HALVE_ROW(name, type, MEAN)                                            \
	static void name(const void *const rows[4], int count, bool halve, void *out) \
	{                                                                             \
		const type *const r[4] = { rows[0], rows[1], rows[2], rows[3] };      \
		type *restrict half = out;                                            \
		if (!halve) {                                                         \
			for (int i = 0; i < count; i++)                               \
				half[i] = (type)MEAN(r, i, i);                        \
			return;                                                       \
		}                                                                     \
		for (int i = 0; i < count / 2; i++)                                   \
			half[i] = (type)MEAN(r, 2 * i, 2 * i + 1);                    \
		if (count % 2)                                                        \
			half[count / 2] = (type)MEAN(r, count - 1, count - 1);        \
	}

DEFINE_HALVE_ROW(halve_row_u8, uint8_t, MEAN_WHOLE)
DEFINE_HALVE_ROW(halve_row_u16, uint16_t, MEAN_WHOLE)
DEFINE_HALVE_ROW(halve_row_f32, float, MEAN_FLOAT)

typedef void halve_row(const void *const rows[4], int count, bool halve, void *out);

static halve_row *const halve_rows[GZ_VOXEL_TYPE_COUNT] = {
	[GZ_VOXEL_U8] = halve_row_u8,
	[GZ_VOXEL_U16] = halve_row_u16,
	[GZ_VOXEL_F32] = halve_row_f32,
};

/* The one or two rows or slices that become number i; twice the same where there is but one. */
static void partners(int i, int count, bool halves, int out[2])
{
	out[0] = halves ? 2 * i : i;
	out[1] = halves && 2 * i + 1 < count ? 2 * i + 1 : out[0];
}

void gz_halve_slices(enum gz_voxel_type type, const int dims[2], const bool halves[2],
		     const void *lower, const void *upper, void *out_slice)
{
	const size_t size = gz_voxel_size(type), row = (size_t)dims[0] * size;
	const size_t out_row = (size_t)(halves[0] ? halved(dims[0]) : dims[0]) * size;
	const int out_rows = halves[1] ? halved(dims[1]) : dims[1];
	for (int y = 0; y < out_rows; y++) {
		int pair[2];
		partners(y, dims[1], halves[1], pair);
		const size_t first = (size_t)pair[0] * row, second = (size_t)pair[1] * row;
		const void *const rows[4] = {
			(const char *)lower + first,
			(const char *)lower + second,
			(const char *)upper + first,
			(const char *)upper + second,
		};
		halve_rows[type](rows, dims[0], halves[0], (char *)out_slice + (size_t)y * out_row);
	}
}

enum gz_result gz_volume_halve_begin(const struct gz_volume *volume, const bool axes[3],
				     struct gz_volume *out_half)
{
	bool chosen[3];
	gz_halve_axes(volume->dims, volume->spacing, chosen);
	struct gz_volume half = *volume;
	bool any = false;
	for (int axis = 0; axis < 3; axis++) {
		if (!(axes ? axes[axis] : chosen[axis]) || volume->dims[axis] < 2)
			continue;
		half.dims[axis] = halved(volume->dims[axis]);
		half.spacing[axis] = 2 * volume->spacing[axis];
		any = true;
	}
	half.voxels = NULL;
	if (!any)
		return GZ_ERR_INVAL;
	const enum gz_result result = gz_volume_allocate(&half);
	if (result != GZ_OK)
		return result;
	half.slope = volume->slope;
	half.intercept = volume->intercept;
	*out_half = half;
	return GZ_OK;
}

void gz_volume_halve_slice(const struct gz_volume *volume, const struct gz_volume *half, int z)
{
	const size_t size = gz_voxel_size(volume->type);
	const size_t slice = (size_t)volume->dims[0] * (size_t)volume->dims[1] * size;
	const size_t out_slice = (size_t)half->dims[0] * (size_t)half->dims[1] * size;
	const bool halves[2] = {
		half->dims[0] != volume->dims[0],
		half->dims[1] != volume->dims[1],
	};
	int pair[2];
	partners(z, volume->dims[2], half->dims[2] != volume->dims[2], pair);
	gz_halve_slices(volume->type, volume->dims, halves,
			(const char *)volume->voxels + (size_t)pair[0] * slice,
			(const char *)volume->voxels + (size_t)pair[1] * slice,
			(char *)half->voxels + (size_t)z * out_slice);
}

enum gz_result gz_volume_halve(const struct gz_volume *volume, const bool axes[3],
			       struct gz_volume *out_half)
{
	const enum gz_result result = gz_volume_halve_begin(volume, axes, out_half);
	if (result != GZ_OK)
		return result;
	for (int z = 0; z < out_half->dims[2]; z++)
		gz_volume_halve_slice(volume, out_half, z);
	return GZ_OK;
}
