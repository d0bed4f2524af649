#include "render/raycast/cpu/volume_shade.h"

#include <math.h>

#include "render/light/light_constants.h"

_Static_assert(GZ_SHADE_PLACES == GZ_TILE_RAYS, "kernels take as many places");

/* Where steps from a place begin, such that the first one begins in the volume: lengths of voxels
 * from the place. INFINITY: the way misses the volume. */
static float find_begin(const struct gz_volume_shade *shade, const float at[3], float from)
{
	const struct gz_cast_shadow *shadow = &shade->walk.cast.light.shadow;
	double origin[3], towards[3], ends[2];
	for (int axis = 0; axis < 3; axis++) {
		origin[axis] = (double)at[axis];
		towards[axis] = (double)shadow->towards[axis];
	}
	const bool any = gz_clip_bounds_cross(&shade->shown, origin, towards, ends);
	const float begin = fmaxf(fmaxf(from, GZ_SHADOW_START), (float)ends[0]);
	return any && begin < (float)ends[1] ? begin : INFINITY;
}

/* struct gz_shade, find */
static void find_share_of_light(const void *user, const struct gz_shade_places *places,
				float out_shares[GZ_SHADE_PLACES])
{
	const struct gz_volume_shade *shade = user;
	const struct gz_light_walk *walk = &shade->walk;
	const float *towards = walk->cast.light.shadow.towards;
	struct gz_cast_places starts = { .longer = fmaxf(places->step, 1) };
	float shares[GZ_SHADE_PLACES];
	for (int i = 0; i < GZ_SHADE_PLACES; i++) {
		float at[3];
		for (int axis = 0; axis < 3; axis++)
			at[axis] = places->at[axis][i] * shade->scale[axis] + shade->bias[axis];
		const bool active = places->active >> i & 1;
		const float begin =
			active ? find_begin(shade, at, places->from * shade->lengths_per_world)
			       : INFINITY;
		out_shares[i] = 1;
		/* Steps begin GZ_SHADOW_START from where kernels start. */
		const float moved = begin < INFINITY ? begin - GZ_SHADOW_START : 0;
		for (int axis = 0; axis < 3; axis++)
			starts.at[axis][i] = moved * towards[axis] + at[axis];
		starts.active |= (uint32_t)(begin < INFINITY) << i;
	}
	if (starts.active == 0)
		return;
	walk->arriving(&walk->cast, walk->type, walk->nearest, &starts, shares);
	for (int i = 0; i < GZ_SHADE_PLACES; i++)
		if (starts.active >> i & 1)
			out_shares[i] = shares[i];
}

enum gz_result gz_volume_shade_make(const struct gz_lighting *lighting,
				    gz_cast_arriving_function *arriving,
				    const struct gz_ray_params *rays,
				    const struct gz_ray_frame *ray_frame, const struct gz_log *log,
				    struct gz_volume_shade *shade, struct gz_shade *out_shade)
{
	const struct gz_volume *volume = lighting->volume;
	const enum gz_result result =
		gz_light_walk_make(lighting, arriving, rays, ray_frame, log, &shade->walk);
	if (result != GZ_OK)
		return result;
	static const double first_datum[3] = { -0.5, -0.5, -0.5 };
	const double dims[3] = { volume->dims[0], volume->dims[1], volume->dims[2] };
	double half[3];
	gz_volume_half_extent(volume, half);
	gz_clip_region_place(&rays->clip, volume, dims, first_datum, &shade->shown);
	for (int axis = 0; axis < 3; axis++) {
		shade->scale[axis] = (float)(dims[axis] / (2 * half[axis]));
		shade->bias[axis] = (float)(dims[axis] / 2 - 0.5);
	}
	shade->lengths_per_world = (float)(1 / gz_volume_voxel_length(volume));
	/* The whole way through the box counts, though steps begin before it. */
	shade->walk.cast.light.shadow.reach += GZ_SHADOW_START;
	*out_shade = (struct gz_shade) { .find = find_share_of_light, .user = shade };
	return GZ_OK;
}
