/* The loops of particle_kernels.h: a source for each instruction set includes this and defines its
 * table by GZ_PARTICLE_LOOPS. */
#include <math.h>

#include "render/particles/particle_kernels.h"

enum { ROW_LANES = 8 }; /* voxels that are computed together */

/* A run of voxels of a row, and the squared distance of the row from the particle. */
struct row_run {
	int first, last; /* voxels that may be within reach */
	float squared;
};

/* The whole numbers from x - reach to x + reach that are in [least, end). There are no such numbers
 * if *out_first is greater than *out_last. */
static inline void bound_rows(float x, float reach, const int limits[2], int *out_first,
			      int *out_last)
{
	const float from = x - reach, to = x + reach;
	*out_first = limits[0];
	*out_last = limits[1] - 1;
	/* Truncation rounds up and down as needed, for neither is negative. */
	if (from > (float)limits[0])
		*out_first =
			from < (float)limits[1] ? (int)from + ((float)(int)from < from) : limits[1];
	if (to < (float)*out_last)
		*out_last = to >= (float)limits[0] ? (int)to : limits[0] - 1;
}

/* The voxels of a row within reach; a hair more, because of rounding. */
static inline bool find_run(const struct gz_particle_splat *splat, int y, int z,
			    struct row_run *out_run)
{
	const float dy = (float)y - splat->at[1], dz = (float)z - splat->at[2];
	const float limit = splat->reach * splat->reach;
	const int ends[2] = { 0, splat->length };
	out_run->squared = dy * dy + dz * dz;
	if (out_run->squared > limit)
		return false;
	bound_rows(splat->at[0], sqrtf(limit - out_run->squared) + 1e-3F, ends, &out_run->first,
		   &out_run->last);
	return out_run->first <= out_run->last;
}

/* Where whole lanes can begin so that they cover a run; below 0 if the row is too short for that.
 * More voxels than the run has do no harm: they are out of reach. */
static inline int start_of_lanes(const struct row_run *run, int length, int *out_lanes)
{
	const int lanes = (run->last - run->first + ROW_LANES) / ROW_LANES * ROW_LANES;
	*out_lanes = lanes;
	return run->first + lanes <= length ? run->first : length - lanes;
}

/* (1 - q)+^3 - 4 (1/2 - q)+^3 is half of the cubic spline. */
static inline float half_spline(float squared, float per_reach)
{
	const float q = sqrtf(squared) * per_reach;
	const float outer = 1 - q > 0 ? 1 - q : 0;
	const float inner = 0.5F - q > 0 ? 0.5F - q : 0;
	return outer * outer * outer - 4 * (inner * inner * inner);
}

/* Add the spline of a particle to a run of a row. */
static inline void add_to_row(float *row, const struct gz_particle_splat *splat,
			      const struct row_run *run)
{
	static const float steps[ROW_LANES] = { 0, 1, 2, 3, 4, 5, 6, 7 };
	const float twice = 2 * splat->weight, per_reach = 1 / splat->reach;
	const float px = splat->at[0], away = run->squared;
	int lanes;
	const int start = start_of_lanes(run, splat->length, &lanes);
	for (int x = run->first; start < 0 && x <= run->last; x++) {
		const float dx = (float)x - px;
		row[x] += twice * half_spline(dx * dx + away, per_reach);
	}
	for (int x = start; start >= 0 && x < start + lanes; x += ROW_LANES) {
		const float from = (float)x;
		float *voxels = row + x;
		for (int k = 0; k < ROW_LANES; k++) {
			const float dx = (from + steps[k]) - px;
			voxels[k] += twice * half_spline(dx * dx + away, per_reach);
		}
	}
}

/* See struct gz_particle_kernels, add. */
static void add_splat(const struct gz_particle_splat *splat, float *voxels)
{
	int first[2], last[2];
	struct row_run run;
	for (int i = 0; i < 2; i++) {
		const int limits[2] = { splat->least[i], splat->end[i] };
		bound_rows(splat->at[i + 1], splat->reach, limits, &first[i], &last[i]);
	}
	for (int z = first[1]; z <= last[1]; z++)
		for (int y = first[0]; y <= last[0]; y++)
			if (find_run(splat, y, z, &run))
				add_to_row(
					voxels + (size_t)(y - splat->least[0]) * splat->stride[0] +
						(size_t)(z - splat->least[1]) * splat->stride[1],
					splat, &run);
}

/* Of particles that are equally near, the one that comes first in the file counts. */
static inline void take_nearer(float *squared, uint32_t *number, float distance, uint32_t candidate)
{
	const bool nearer =
		(distance < *squared) | ((distance == *squared) & (candidate < *number));
	*squared = nearer ? distance : *squared;
	*number = nearer ? candidate : *number;
}

/* Take a particle as the nearest where it is, in a run of a row. */
static inline void compare_row(float *squared, uint32_t *number,
			       const struct gz_particle_splat *splat, const struct row_run *run)
{
	static const float steps[ROW_LANES] = { 0, 1, 2, 3, 4, 5, 6, 7 };
	const float px = splat->at[0], away = run->squared;
	const uint32_t candidate = splat->number;
	int lanes;
	const int start = start_of_lanes(run, splat->length, &lanes);
	for (int x = run->first; start < 0 && x <= run->last; x++) {
		const float dx = (float)x - px;
		take_nearer(&squared[x], &number[x], dx * dx + away, candidate);
	}
	for (int x = start; start >= 0 && x < start + lanes; x += ROW_LANES) {
		const float from = (float)x;
		for (int k = 0; k < ROW_LANES; k++) {
			const float dx = (from + steps[k]) - px;
			take_nearer(&squared[x + k], &number[x + k], dx * dx + away, candidate);
		}
	}
}

/* See struct gz_particle_kernels, compare. */
static void compare_splat(const struct gz_particle_splat *splat, float *squared, uint32_t *number)
{
	int first[2], last[2];
	struct row_run run;
	for (int i = 0; i < 2; i++) {
		const int limits[2] = { splat->least[i], splat->end[i] };
		bound_rows(splat->at[i + 1], splat->reach, limits, &first[i], &last[i]);
	}
	for (int z = first[1]; z <= last[1]; z++)
		for (int y = first[0]; y <= last[0]; y++) {
			const size_t row = (size_t)(y - splat->least[0]) * splat->stride[0] +
					   (size_t)(z - splat->least[1]) * splat->stride[1];
			if (find_run(splat, y, z, &run))
				compare_row(squared + row, number + row, splat, &run);
		}
}

/* See struct gz_particle_kernels, sum. */
static double sum_splines(float *const at[3], size_t count, const float point[3], float per_support)
{
	float sums[GZ_PARTICLE_SUM_LANES] = { 0 };
	const float px = point[0], py = point[1], pz = point[2];
	for (size_t i = 0; i < count; i += GZ_PARTICLE_SUM_LANES) {
		const float *x = at[0] + i, *y = at[1] + i, *z = at[2] + i;
		for (size_t k = 0; k < GZ_PARTICLE_SUM_LANES; k++) {
			const float dx = x[k] - px, dy = y[k] - py, dz = z[k] - pz;
			sums[k] += half_spline(dx * dx + dy * dy + dz * dz, per_support);
		}
	}
	double sum = 0;
	for (size_t k = 0; k < GZ_PARTICLE_SUM_LANES; k++)
		sum += (double)sums[k];
	return 2 * sum;
}

#define GZ_PARTICLE_LOOPS                             \
	{                                             \
		add_splat, compare_splat, sum_splines \
	}
