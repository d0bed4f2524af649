#include "oracle.h"

#include "base/vector.h"
#include "oracle_light.h"

#include <math.h>
#include <stdint.h>

static double voxel(const struct gz_volume *volume, int x, int y, int z)
{
	const int *dims = volume->dims;
	x = x < 0 ? 0 : x >= dims[0] ? dims[0] - 1 : x;
	y = y < 0 ? 0 : y >= dims[1] ? dims[1] - 1 : y;
	z = z < 0 ? 0 : z >= dims[2] ? dims[2] - 1 : z;
	const size_t index =
		((size_t)z * (size_t)dims[1] + (size_t)y) * (size_t)dims[0] + (size_t)x;
	return gz_voxel_stored(volume->type, volume->voxels, index);
}

double oracle_sample(const struct gz_volume *volume, int interpolation, const double at[3])
{
	if (interpolation == GZ_INTERPOLATION_NEAREST)
		return voxel(volume, (int)floor(at[0]), (int)floor(at[1]), (int)floor(at[2]));
	const double x = at[0] - 0.5, y = at[1] - 0.5, z = at[2] - 0.5;
	const int i = (int)floor(x), j = (int)floor(y), k = (int)floor(z);
	double sum = 0;
	for (int corner = 0; corner < 8; corner++) {
		const int di = corner & 1, dj = corner >> 1 & 1, dk = corner >> 2;
		const double wx = di ? x - i : 1 - (x - i);
		const double wy = dj ? y - j : 1 - (y - j);
		const double wz = dk ? z - k : 1 - (z - k);
		sum += wx * wy * wz * voxel(volume, i + di, j + dj, k + dk);
	}
	return sum;
}

static void make_ray(const struct gz_camera *camera, int width, int height, int x, int y,
		     double origin[3], double direction[3])
{
	double forward[3], right[3], up[3];
	for (int axis = 0; axis < 3; axis++)
		forward[axis] = camera->look_at[axis] - camera->eye[axis];
	(void)gz_normalise3(forward);
	gz_cross3(forward, camera->up, right);
	(void)gz_normalise3(right);
	gz_cross3(right, forward, up);
	const bool flat = camera->projection == GZ_PROJECTION_ORTHOGRAPHIC;
	const double view = flat ? camera->height : 2 * tan(camera->fov_deg * M_PI / 360);
	const double u = (x + 0.5 - 0.5 * width) / height * view;
	const double v = (0.5 * height - y - 0.5) / height * view;
	for (int axis = 0; axis < 3; axis++) {
		const double aside = u * right[axis] + v * up[axis];
		origin[axis] = camera->eye[axis] + (flat ? aside : 0);
		direction[axis] = forward[axis] + (flat ? 0 : aside);
	}
	(void)gz_normalise3(direction);
}

/* Shorten out_span to where a coordinate of the ray lies between two values. */
static void cut(double origin, double direction, double low, double high, double out_span[2])
{
	if (direction == 0) {
		if (origin < low || origin > high)
			out_span[1] = -1;
		return;
	}
	const double a = (low - origin) / direction, b = (high - origin) / direction;
	out_span[0] = fmax(out_span[0], fmin(a, b));
	out_span[1] = fmin(out_span[1], fmax(a, b));
}

/* pcg3d of Jarzynski and Olano, as they print it. */
static double jitter(int x, int y, int seed)
{
	if (seed == 0)
		return 0;
	uint32_t v[3] = { (uint32_t)x, (uint32_t)y, (uint32_t)seed };
	for (int i = 0; i < 3; i++)
		v[i] = v[i] * 1664525U + 1013904223U;
	v[0] += v[1] * v[2];
	v[1] += v[2] * v[0];
	v[2] += v[0] * v[1];
	for (int i = 0; i < 3; i++)
		v[i] ^= v[i] >> 16;
	v[0] += v[1] * v[2];
	return floor(v[0] / 256.0) / 16777216;
}

/* One ray as it goes through the volume. */
struct oracle_ray {
	const struct gz_level *level;
	const struct gz_transfer *transfer;
	const struct gz_ray_params *rays;
	double low, high; /* of the transfer function, data values */
	double origin[3], direction[3];
	double half[3];      /* of the box, world units */
	double per_world[3]; /* voxels of the level */
	double voxel_length; /* world units */
	const struct gz_volume *volume;
	const struct gz_camera *camera;
	const struct oracle_occlusion *occlusion;
	double through, rgb[3];
};

/* Voxel coordinates of the level at a distance along the ray. */
static void place_at(const struct oracle_ray *ray, double distance, double at[3])
{
	for (int axis = 0; axis < 3; axis++)
		at[axis] = (ray->origin[axis] + distance * ray->direction[axis] + ray->half[axis]) *
			   ray->per_world[axis];
}

/* What the transfer function is asked for, at a distance along the ray. */
static double value_at(const struct oracle_ray *ray, double distance)
{
	double at[3];
	place_at(ray, distance, at);
	const struct gz_volume *volume = &ray->level->volume;
	const double stored = oracle_sample(volume, ray->rays->interpolation, at);
	const double value = volume->slope * stored + volume->intercept;
	return ray->high > ray->low ? (value - ray->low) / (ray->high - ray->low) : 0;
}

static void blend(struct oracle_ray *ray, double value, double length)
{
	double rgba[4];
	gz_transfer_evaluate(ray->transfer, value, rgba);
	const double opacity = 1 - pow(1 - rgba[3], length / ray->voxel_length);
	for (int channel = 0; channel < 3; channel++)
		ray->rgb[channel] += ray->through * opacity * rgba[channel];
	ray->through *= 1 - opacity;
}

/* The colour of a segment of one opacity, lit by what lies at a distance along the ray. */
static void light_segment(const struct oracle_ray *ray, double distance, double rgb[3])
{
	double at[3];
	place_at(ray, distance, at);
	if (ray->rays->shading == GZ_SHADING_GRADIENT || ray->rays->light.shadow_steps > 0)
		oracle_shade(ray->volume, ray->level, ray->transfer, ray->camera, ray->rays,
			     ray->occlusion, at, ray->direction, rgb);
}

/* The colour of the voxels at a distance along the ray, each by its weight. */
static void own_colour_at(const struct oracle_ray *ray, double distance, double rgb[3])
{
	const struct gz_volume *volume = &ray->level->volume;
	const bool nearest = ray->rays->interpolation == GZ_INTERPOLATION_NEAREST;
	double at[3], sums[4] = { 0 };
	int low[3];
	place_at(ray, distance, at);
	for (int axis = 0; axis < 3; axis++)
		low[axis] = (int)floor(nearest ? at[axis] : at[axis] - 0.5);
	for (int corner = 0; corner < (nearest ? 1 : 8); corner++) {
		size_t index = 0;
		double share = 1;
		for (int axis = 2; axis >= 0; axis--) {
			const int dim = volume->dims[axis], upper = corner >> axis & 1;
			const int i = low[axis] + upper;
			const double beyond = at[axis] - 0.5 - low[axis];
			index = index * (size_t)dim + (size_t)(i < 0 ? 0 : i < dim ? i : dim - 1);
			share *= nearest ? 1 : upper ? beyond : 1 - beyond;
		}
		const uint32_t word = volume->colours[index];
		const double weight = share * ((word >> 24) + 1.0 / 64);
		for (int channel = 0; channel < 3; channel++)
			sums[channel] += weight * (word >> 8 * channel & 255);
		sums[3] += weight;
	}
	for (int channel = 0; channel < 3; channel++)
		rgb[channel] = sums[channel] / sums[3] / 255;
}

/* From one distance along the ray to another: by the value in the middle, or by all between those
 * at both ends; light is that of the middle. */
static void integrate(struct oracle_ray *ray, double from, double to)
{
	struct oracle_ray segment = *ray; /* alone, as if nothing was before it */
	segment.through = 1;
	segment.rgb[0] = segment.rgb[1] = segment.rgb[2] = 0;
	if (ray->rays->integration == GZ_INTEGRATION_SAMPLED) {
		blend(&segment, value_at(ray, (from + to) / 2), to - from);
	} else {
		enum { PARTS = 128 };
		const double front = value_at(ray, from), back = value_at(ray, to);
		for (int i = 0; i < PARTS; i++)
			blend(&segment, front + (back - front) * (i + 0.5) / PARTS,
			      (to - from) / PARTS);
	}
	const double opacity = 1 - segment.through;
	if (opacity <= 0)
		return;
	double rgb[3];
	for (int channel = 0; channel < 3; channel++)
		rgb[channel] = segment.rgb[channel] / opacity;
	if (ray->level->volume.colours)
		own_colour_at(ray, (from + to) / 2, rgb);
	light_segment(ray, (from + to) / 2, rgb);
	for (int channel = 0; channel < 3; channel++)
		ray->rgb[channel] += ray->through * opacity * rgb[channel];
	ray->through *= segment.through;
}

static void trace(const struct gz_volume *volume, const struct gz_level *level,
		  const struct gz_transfer *transfer, const struct gz_camera *camera,
		  const struct gz_ray_params *rays, const struct oracle_occlusion *occlusion,
		  int width, int height, int x, int y, double out_rgb[3])
{
	double longest = 0, least = INFINITY;
	for (int axis = 0; axis < 3; axis++) {
		longest = fmax(longest, volume->dims[axis] * volume->spacing[axis]);
		least = fmin(least, volume->spacing[axis]);
	}
	const double step = least / longest / rays->ray_sampling_rate;

	double origin[3], direction[3];
	make_ray(camera, width, height, x, y, origin, direction);
	double box[2] = { 0, INFINITY }, shown[2] = { 0, INFINITY };
	for (int axis = 0; axis < 3; axis++) {
		const double size = volume->dims[axis] * volume->spacing[axis] / longest;
		cut(origin[axis], direction[axis], -size / 2, size / 2, box);
		cut(origin[axis], direction[axis], (rays->clip.least[axis] - 0.5) * size,
		    (rays->clip.greatest[axis] - 0.5) * size, shown);
	}
	double normal[3];
	const double greatest = oracle_plane(volume, rays, normal);
	cut(gz_dot3(normal, origin), gz_dot3(normal, direction), -1e9, greatest, shown);

	const double first = volume->slope * volume->stored_min + volume->intercept;
	const double second = volume->slope * volume->stored_max + volume->intercept;
	struct oracle_ray ray = {
		.level = level,
		.transfer = transfer,
		.rays = rays,
		.low = transfer->has_range ? transfer->range[0] : fmin(first, second),
		.high = transfer->has_range ? transfer->range[1] : fmax(first, second),
		.voxel_length = least / longest,
		.volume = volume,
		.camera = camera,
		.occlusion = occlusion,
		.through = 1,
	};
	for (int axis = 0; axis < 3; axis++) {
		ray.origin[axis] = origin[axis];
		ray.direction[axis] = direction[axis];
		ray.half[axis] = volume->dims[axis] * volume->spacing[axis] / longest / 2;
		ray.per_world[axis] = longest / volume->spacing[axis] / level->factor[axis];
	}
	const double start = box[0] - jitter(x, y, rays->jitter) * step;
	for (int k = 0; start + k * step < shown[1] && ray.through >= 1.0 / 1024; k++) {
		const double from = fmax(start + k * step, shown[0]);
		const double to = fmin(start + (k + 1) * step, shown[1]);
		if (from < to)
			integrate(&ray, from, to);
	}
	double behind[3];
	oracle_surroundings(volume, camera, rays, origin, direction, behind);
	for (int channel = 0; channel < 3; channel++)
		out_rgb[channel] = ray.rgb[channel] + ray.through * behind[channel];
}

void oracle_pixel(const struct gz_volume *volume, const struct gz_transfer *transfer,
		  const struct gz_camera *camera, const struct gz_ray_params *rays, int width,
		  int height, int x, int y, double out_rgb[3])
{
	oracle_pixel_occluded(volume, transfer, camera, rays, NULL, width, height, x, y, out_rgb);
}

void oracle_pixel_occluded(const struct gz_volume *volume, const struct gz_transfer *transfer,
			   const struct gz_camera *camera, const struct gz_ray_params *rays,
			   const struct oracle_occlusion *occlusion, int width, int height, int x,
			   int y, double out_rgb[3])
{
	const struct gz_level level = { .volume = *volume, .factor = { 1, 1, 1 } };
	trace(volume, &level, transfer, camera, rays, occlusion, width, height, x, y, out_rgb);
}

void oracle_level_pixel(const struct gz_volume *volume, const struct gz_level *level,
			const struct gz_transfer *transfer, const struct gz_camera *camera,
			const struct gz_ray_params *rays, int width, int height, int x, int y,
			double out_rgb[3])
{
	trace(volume, level, transfer, camera, rays, NULL, width, height, x, y, out_rgb);
}
