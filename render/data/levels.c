#include "render/data/levels.h"

#include <math.h>

#include "render/data/voxel_colour.h"

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

/* Mean of eight voxels, two from each of four rows; a row or voxel without a partner is used twice.
 * Floats are divided before they are added, because the sum of the greatest would be infinite. */
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

/* The two rows or slices that become number i; the same one twice if there is only one. */
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

/* Halve one slice of colours, as gz_halve_slices() halves one of values. */
static void halve_colours(const struct gz_volume *volume, const bool halves[2], const int pair[2],
			  uint32_t *out)
{
	const size_t width = (size_t)volume->dims[0], height = (size_t)volume->dims[1];
	const int out_dims[2] = { halves[0] ? halved(volume->dims[0]) : volume->dims[0],
				  halves[1] ? halved(volume->dims[1]) : volume->dims[1] };
	for (int y = 0; y < out_dims[1]; y++)
		for (int x = 0; x < out_dims[0]; x++) {
			int columns[2], rows[2];
			uint32_t eight[8];
			partners(x, volume->dims[0], halves[0], columns);
			partners(y, volume->dims[1], halves[1], rows);
			for (int i = 0; i < 8; i++) {
				const size_t row =
					(size_t)pair[i >> 2] * height + (size_t)rows[i >> 1 & 1];
				eight[i] = volume->colours[row * width + (size_t)columns[i & 1]];
			}
			*out++ = gz_colour_mean(eight);
		}
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
	if (volume->colours)
		halve_colours(volume, halves, pair,
			      half->colours +
				      (size_t)z * (size_t)half->dims[0] * (size_t)half->dims[1]);
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

void gz_levels_start(struct gz_levels *levels, const struct gz_volume *volume)
{
	gz_levels_free(levels);
	levels->level[0] = (struct gz_level) {
		.volume = *volume,
		.factor = { 1, 1, 1 },
		.scale = 1,
	};
	levels->count = 1;
}

/* The job that the workers share. */
struct halving {
	const struct gz_volume *volume, *half;
};

static void halve_part(void *user, size_t part, int worker)
{
	(void)worker;
	const struct halving *job = user;
	gz_volume_halve_slice(job->volume, job->half, (int)part);
}

/* Edge of a level's voxels, in voxel lengths of the full volume. An axis of one voxel does not
 * count: its spacing separates nothing. */
static double level_scale(const struct gz_volume *full, const struct gz_volume *coarse)
{
	double least = INFINITY, full_least = INFINITY;
	for (int axis = 0; axis < 3; axis++) {
		full_least = fmin(full_least, full->spacing[axis]);
		if (full->dims[axis] > 1)
			least = fmin(least, coarse->spacing[axis]);
	}
	return least / full_least;
}

/* Make the next coarser level. */
static enum gz_result halve_level(const struct gz_volume *full, const struct gz_level *fine,
				  struct gz_workers *workers, struct gz_level *out_coarse)
{
	struct gz_level coarse = *fine;
	const enum gz_result result = gz_volume_halve_begin(&fine->volume, NULL, &coarse.volume);
	if (result != GZ_OK)
		return result;
	struct halving job = { &fine->volume, &coarse.volume };
	if (workers)
		gz_workers_run(workers, halve_part, &job, (size_t)coarse.volume.dims[2]);
	else
		for (int z = 0; z < coarse.volume.dims[2]; z++)
			halve_part(&job, (size_t)z, 0);
	for (int axis = 0; axis < 3; axis++)
		if (coarse.volume.dims[axis] != fine->volume.dims[axis])
			coarse.factor[axis] *= 2;
	coarse.scale = level_scale(full, &coarse.volume);
	*out_coarse = coarse;
	return GZ_OK;
}

/* A volume whose edges are no longer than this is not halved, voxels. Chosen: nothing left to save.
 */
enum { LEAST_EDGE = 8 };

static bool worth_halving(const struct gz_volume *volume)
{
	return volume->dims[0] > LEAST_EDGE || volume->dims[1] > LEAST_EDGE ||
	       volume->dims[2] > LEAST_EDGE;
}

/* Whether a level is an eighth of the one before, apart from rounding up. */
static bool is_an_eighth(const struct gz_level *coarse, const struct gz_level *before)
{
	int factor = 1;
	for (int axis = 0; axis < 3; axis++)
		factor *= coarse->factor[axis] / before->factor[axis];
	return factor >= 8;
}

static void free_above(struct gz_levels *levels, int count)
{
	for (int i = count; i < levels->count; i++)
		gz_volume_free(&levels->level[i].volume);
	levels->count = count < levels->count ? count : levels->count;
}

enum gz_result gz_levels_build(struct gz_levels *levels, struct gz_workers *workers)
{
	if (levels->count != 1)
		return GZ_OK;
	struct gz_level skipped = { .scale = 0 }; /* the finer level, if it was not kept */
	enum gz_result result = GZ_OK;
	while (levels->count < GZ_LEVELS_MAX && result == GZ_OK) {
		const struct gz_level *before = &levels->level[levels->count - 1];
		const struct gz_level *fine = skipped.scale > 0 ? &skipped : before;
		if (!worth_halving(&fine->volume))
			break;
		struct gz_level coarse;
		result = halve_level(&levels->level[0].volume, fine, workers, &coarse);
		gz_volume_free(&skipped.volume);
		skipped.scale = 0;
		if (result == GZ_OK && is_an_eighth(&coarse, before))
			levels->level[levels->count++] = coarse;
		else if (result == GZ_OK)
			skipped = coarse;
	}
	gz_volume_free(&skipped.volume);
	if (result != GZ_OK)
		free_above(levels, 1);
	return result;
}

bool gz_levels_add(struct gz_levels *levels, const struct gz_brick_level *brick_level)
{
	const struct gz_volume *full = &levels->level[0].volume;
	struct gz_level level = { .volume = *full };
	level.volume.bricks = NULL; /* the full volume owns them */
	for (int axis = 0; axis < 3; axis++) {
		level.factor[axis] = 1 << brick_level->halvings[axis];
		level.volume.dims[axis] = brick_level->dims[axis];
		level.volume.spacing[axis] = full->spacing[axis] * level.factor[axis];
	}
	if (levels->count == GZ_LEVELS_MAX ||
	    !is_an_eighth(&level, &levels->level[levels->count - 1]))
		return false;
	level.scale = level_scale(full, &level.volume);
	levels->level[levels->count++] = level;
	return true;
}

void gz_levels_free(struct gz_levels *levels)
{
	free_above(levels, 1);
	*levels = (struct gz_levels) { 0 };
}

/* Distance from a point to the box, world units. */
static double distance_to_box(const struct gz_volume *volume, const double from[3])
{
	double half[3], squares = 0;
	gz_volume_half_extent(volume, half);
	for (int axis = 0; axis < 3; axis++) {
		const double outside = fmax(fabs(from[axis]) - half[axis], 0);
		squares += outside * outside;
	}
	return sqrt(squares);
}

double gz_levels_pixel_lengths(const struct gz_volume *volume, const struct gz_camera *camera,
			       int height)
{
	const double view = camera->projection == GZ_PROJECTION_ORTHOGRAPHIC
				    ? camera->height
				    : 2 * tan(camera->fov_deg * M_PI / 360) *
					      distance_to_box(volume, camera->eye);
	return view / height / gz_volume_voxel_length(volume);
}

int gz_levels_choose(const struct gz_levels *levels, double across, double along)
{
	const double widest = M_SQRT2 * fmin(across, along);
	int level = 0;
	while (level + 1 < levels->count && levels->level[level + 1].scale <= widest)
		level++;
	return level;
}
