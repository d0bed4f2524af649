#include "render/data/float_scaling.h"

#include <math.h>

/* Magnitudes from here to there are drawn as they are. Chosen: 2^17 table entries over the least
 * range that is left, 2^-90, and the square of a sum of such values stay finite. */
#define MAGNITUDE_LEAST 0x1p-80
#define MAGNITUDE_MOST  0x1p100

/* Above MAGNITUDE_MOST values are scaled by this. It is no less, because the rest of such a volume
 * may be ordinary numbers beside a mark for missing data. */
#define SCALE_DOWN 0x1p-30

/* Greatest magnitude, in ranges, without an offset. Chosen: rounding then moves a value by half an
 * entry of a table of 4096 at most. */
#define RANGES_MOST 1024

bool gz_float_scaling_find(double least, double greatest, struct gz_float_scaling *out_scaling)
{
	const double range = greatest - least;
	double magnitude = fmax(fabs(least), fabs(greatest));
	struct gz_float_scaling scaling = { 0, 1 };
	if (!(range > 0))
		return false;
	if (magnitude > RANGES_MOST * range) {
		scaling.offset = least;
		magnitude = range;
	}
	if (magnitude < MAGNITUDE_LEAST) {
		int exponent;
		(void)frexp(magnitude, &exponent);
		scaling.scale = ldexp(1, -exponent);
	} else if (magnitude > MAGNITUDE_MOST) {
		scaling.scale = SCALE_DOWN;
	}
	if (scaling.offset == 0 && scaling.scale == 1)
		return false;
	*out_scaling = scaling;
	return true;
}

float gz_float_scaled(const struct gz_float_scaling *scaling, float value)
{
	return (float)(((double)value - scaling->offset) * scaling->scale);
}

void gz_float_scaling_apply(const struct gz_float_scaling *scaling, float *values, size_t count)
{
	for (size_t i = 0; i < count; i++)
		values[i] = gz_float_scaled(scaling, values[i]);
}

void gz_float_scaling_take_back(const struct gz_float_scaling *scaling,
				const struct gz_stored_values *values)
{
	*values->intercept += *values->slope * scaling->offset;
	*values->slope /= scaling->scale;
	/* rounded as the voxels are */
	*values->stored_min = (double)gz_float_scaled(scaling, (float)*values->stored_min);
	*values->stored_max = (double)gz_float_scaled(scaling, (float)*values->stored_max);
}

void gz_volume_scale_floats(struct gz_volume *volume)
{
	struct gz_float_scaling scaling;
	if (volume->type != GZ_VOXEL_F32 || !volume->voxels ||
	    !gz_float_scaling_find(volume->stored_min, volume->stored_max, &scaling))
		return;
	gz_float_scaling_apply(&scaling, volume->voxels, gz_volume_voxel_count(volume));
	const struct gz_stored_values values = { &volume->slope, &volume->intercept,
						 &volume->stored_min, &volume->stored_max };
	gz_float_scaling_take_back(&scaling, &values);
}
