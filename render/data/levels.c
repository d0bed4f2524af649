#include "render/data/levels.h"

#include <math.h>

#include "render/data/halve.h"

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

/* What the workers are given. */
struct halving {
	const struct gz_volume *volume, *half;
};

static void halve_part(void *user, size_t part, int worker)
{
	(void)worker;
	const struct halving *job = user;
	gz_volume_halve_slice(job->volume, job->half, (int)part);
}

/* Edge of a level's voxels, in voxel lengths of the full volume. An axis of one voxel has no
 * neighbours to be apart from. */
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

/* The next level of fine. */
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

/* Edge of a volume that is not halved further, voxels. Chosen: there is nothing left to save. */
enum { LEAST_EDGE = 8 };

static bool worth_halving(const struct gz_volume *volume)
{
	return volume->dims[0] > LEAST_EDGE || volume->dims[1] > LEAST_EDGE ||
	       volume->dims[2] > LEAST_EDGE;
}

/* Whether a level is an eighth of the one before or, sizes being rounded up, would be. */
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
	struct gz_level skipped = { .scale = 0 }; /* the finer one, where it was not kept */
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
	level.volume.bricks = NULL; /* closed with the full volume */
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

/* From a point to the nearest of the box, world units. */
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
