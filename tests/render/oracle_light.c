#include "oracle_light.h"

#include "base/vector.h"
#include <math.h>
#include <stdlib.h>

#include "oracle.h"

static double clamp(double x, double least, double greatest)
{
	return fmin(fmax(x, least), greatest);
}

static double least_spacing(const struct gz_volume *volume)
{
	return fmin(fmin(volume->spacing[0], volume->spacing[1]), volume->spacing[2]);
}

/* Ends of the transfer function's range, in stored values. */
static double range_width(const struct gz_volume *volume, const struct gz_transfer *transfer)
{
	if (transfer->has_range)
		return (transfer->range[1] - transfer->range[0]) / volume->slope;
	return (volume->stored_max - volume->stored_min) * (volume->slope < 0 ? -1 : 1);
}

static double value_of(const struct gz_volume *volume, const struct gz_transfer *transfer,
		       double stored)
{
	const double a = volume->slope * volume->stored_min + volume->intercept;
	const double b = volume->slope * volume->stored_max + volume->intercept;
	const double low = transfer->has_range ? transfer->range[0] : fmin(a, b);
	const double high = transfer->has_range ? transfer->range[1] : fmax(a, b);
	const double value = volume->slope * stored + volume->intercept;
	return high > low ? (value - low) / (high - low) : 0;
}

static void towards_light(const struct gz_camera *camera, const struct gz_light *light,
			  double out[3])
{
	double forward[3], right[3], up[3];
	for (int axis = 0; axis < 3; axis++)
		forward[axis] = camera->look_at[axis] - camera->eye[axis];
	(void)gz_normalise3(forward);
	gz_cross3(forward, camera->up, right);
	(void)gz_normalise3(right);
	gz_cross3(right, forward, up);
	for (int axis = 0; axis < 3; axis++)
		out[axis] = light->frame == GZ_LIGHT_WORLD
				    ? light->direction[axis]
				    : light->direction[0] * right[axis] +
					      light->direction[1] * up[axis] -
					      light->direction[2] * forward[axis];
	(void)gz_normalise3(out);
}

static void gradient(const struct gz_volume *volume, const struct gz_level *level,
		     const struct gz_transfer *transfer, int interpolation, const double at[3],
		     double out[3])
{
	const double width = range_width(volume, transfer);
	for (int axis = 0; axis < 3; axis++) {
		double before[3] = { at[0], at[1], at[2] }, behind[3] = { at[0], at[1], at[2] };
		before[axis] -= 1;
		behind[axis] += 1;
		const double change = oracle_sample(&level->volume, interpolation, behind) -
				      oracle_sample(&level->volume, interpolation, before);
		const double voxel_lengths =
			2 * level->factor[axis] * volume->spacing[axis] / least_spacing(volume);
		out[axis] = width != 0 ? change / width / voxel_lengths : 0;
	}
}

static double occlusion_at(const struct gz_level *level, const struct oracle_occlusion *grid,
			   const double at[3])
{
	double share[3];
	int index[3];
	for (int axis = 0; axis < 3; axis++) {
		const double place = at[axis] * level->factor[axis] / grid->edge[axis] - 0.5;
		index[axis] = (int)floor(place);
		share[axis] = place - index[axis];
	}
	double sum = 0;
	for (int corner = 0; corner < 8; corner++) {
		double weight = 1;
		int cell[3];
		for (int axis = 0; axis < 3; axis++) {
			const int up = corner >> axis & 1;
			weight *= up ? share[axis] : 1 - share[axis];
			cell[axis] = (int)clamp(index[axis] + up, 0, grid->dims[axis] - 1);
		}
		sum += weight *
		       grid->cells[(cell[2] * grid->dims[1] + cell[1]) * grid->dims[0] + cell[0]];
	}
	return clamp(2 * sum - 1, 0, 1);
}

/* Powers of two that a voxel length keeps back at a place in voxel coordinates of the level. */
static double kept_by_volume(const struct gz_volume *volume, const struct gz_level *level,
			     const struct gz_transfer *transfer, int interpolation,
			     const double at[3])
{
	double rgba[4];
	const double stored = oracle_sample(&level->volume, interpolation, at);
	gz_transfer_evaluate(transfer, value_of(volume, transfer, stored), rgba);
	return -log2(fmax(1 - rgba[3], 1e-9));
}

/* What cells of a grid around the volume say at a place in voxel coordinates of the level. */
static double in_cells(const double *cells, const int dims[3], const int edge[3],
		       const struct gz_level *level, const double at[3])
{
	double place[3], sum = 0;
	for (int axis = 0; axis < 3; axis++)
		place[axis] = at[axis] * level->factor[axis] / edge[axis] - 0.5;
	for (int corner = 0; corner < 8; corner++) {
		double weight = 1;
		int cell[3];
		for (int axis = 0; axis < 3; axis++) {
			const double up = place[axis] - floor(place[axis]);
			weight *= corner >> axis & 1 ? up : 1 - up;
			cell[axis] = (int)clamp(floor(place[axis]) + (corner >> axis & 1), 0,
						dims[axis] - 1);
		}
		sum += weight * cells[(cell[2] * dims[1] + cell[1]) * dims[0] + cell[0]];
	}
	return sum;
}

double oracle_plane(const struct gz_volume *volume, const struct gz_ray_params *rays,
		    double out_normal[3])
{
	double longest = 0, length2 = 0, least = INFINITY, greatest = -INFINITY;
	for (int axis = 0; axis < 3; axis++) {
		longest = fmax(longest, volume->dims[axis] * volume->spacing[axis]);
		length2 += pow(rays->clip.normal[axis], 2);
		out_normal[axis] = 0;
	}
	if (!rays->clip.plane)
		return 1;
	for (int axis = 0; axis < 3; axis++)
		out_normal[axis] = rays->clip.normal[axis] / sqrt(length2);
	for (int corner = 0; corner < 8; corner++) {
		double along = 0;
		for (int axis = 0; axis < 3; axis++)
			along += out_normal[axis] * ((corner >> axis & 1) - 0.5) *
				 volume->dims[axis] * volume->spacing[axis] / longest;
		least = fmin(least, along);
		greatest = fmax(greatest, along);
	}
	return least + rays->clip.offset * (greatest - least);
}

/* How far beyond the clip plane a place in voxel coordinates of a level lies. */
static double beyond_plane(const struct gz_volume *volume, const int factor[3],
			   const struct gz_ray_params *rays, const double at[3])
{
	double normal[3], longest = 0;
	for (int axis = 0; axis < 3; axis++)
		longest = fmax(longest, volume->dims[axis] * volume->spacing[axis]);
	double along = -oracle_plane(volume, rays, normal);
	for (int axis = 0; axis < 3; axis++)
		along += normal[axis] * (at[axis] * factor[axis] - volume->dims[axis] / 2.0) *
			 volume->spacing[axis] / longest;
	return along;
}

/* The share of light that arrives at a place in voxel coordinates of the level. */
static double arriving(const struct gz_volume *volume, const struct gz_level *level,
		       const struct gz_transfer *transfer, const struct gz_ray_params *rays,
		       const struct oracle_occlusion *shadows, const double to_light[3],
		       const double at[3])
{
	const double start = 3, direct = 3;
	double towards[3], leave = INFINITY, across = INFINITY, kept = 0;
	for (int axis = 0; axis < 3; axis++) {
		const double size = (double)volume->dims[axis] / level->factor[axis];
		const double end =
			(to_light[axis] > 0 ? rays->clip.greatest : rays->clip.least)[axis];
		towards[axis] = to_light[axis] * least_spacing(volume) / volume->spacing[axis] /
				level->factor[axis];
		if (fabs(towards[axis]) < 1e-9)
			continue;
		leave = fmin(leave, (end * size - at[axis]) / towards[axis]);
		across = fmin(across, size / fabs(towards[axis]));
	}
	const double here = beyond_plane(volume, level->factor, rays, at);
	const double next[3] = { at[0] + towards[0], at[1] + towards[1], at[2] + towards[2] };
	const double nearing = beyond_plane(volume, level->factor, rays, next) - here;
	if (nearing > 1e-12)
		leave = fmin(leave, -here / nearing);
	const double reach = fmax(fmin(rays->light.shadow_reach, across), start);
	const int steps = shadows->exact_shadows ? 2000 : rays->light.shadow_steps;
	for (int i = 0; i < steps; i++) {
		const double from = start + (reach - start) * i * i / steps / steps;
		const double planned = (reach - start) * (2 * i + 1) / steps / steps;
		const double length = fmin(planned, leave - from);
		if (length <= 0)
			break;
		double there[3];
		for (int axis = 0; axis < 3; axis++)
			there[axis] = at[axis] + (from + length / 2) * towards[axis];
		const int number = (int)fmin(floor(log2(planned / direct)), shadows->levels - 1);
		kept += length *
			(planned < direct
				 ? kept_by_volume(volume, level, transfer, rays->interpolation,
						  there)
				 : in_cells(shadows->kept[number], shadows->level_dims[number],
					    shadows->level_edge[number], level, there) /
					   exp2(number + 1));
	}
	return exp2(-kept);
}

/* The same from the grid, or by many small steps. */
static double find_share(const struct gz_volume *volume, const struct gz_level *level,
			 const struct gz_transfer *transfer, const struct gz_ray_params *rays,
			 const struct oracle_occlusion *shadows, const double to_light[3],
			 const double at[3])
{
	if (shadows->exact_shadows)
		return arriving(volume, level, transfer, rays, shadows, to_light, at);
	return in_cells(shadows->arriving, shadows->level_dims[0], shadows->level_edge[0], level,
			at);
}

/* The floor, if the ray meets it. */
static void see_floor(const struct gz_volume *volume, const struct gz_ray_params *rays,
		      const double to_light[3], const double place[3], const double direction[3],
		      double rgb[3])
{
	const struct gz_environment *around = &rays->environment;
	double axes[3][3], half[3], there[3], lowest = 0;
	gz_environment_axes(around, axes);
	gz_volume_half_extent(volume, half);
	for (int axis = 0; axis < 3; axis++)
		lowest -= fabs(axes[0][axis]) * half[axis];
	const double above = gz_dot3(place, axes[0]) - lowest, falls = -gz_dot3(direction, axes[0]);
	if (above <= 0 || falls <= 1e-6)
		return;
	for (int axis = 0; axis < 3; axis++)
		there[axis] = place[axis] + above / falls * direction[axis];
	const double lamp =
		rays->light.ambient + rays->light.diffuse * fmax(gz_dot3(to_light, axes[0]), 0);
	const bool odd = fmod(floor(gz_dot3(there, axes[1]) / around->tile) +
				      floor(gz_dot3(there, axes[2]) / around->tile),
			      2) != 0;
	for (int i = 0; i < 3; i++) {
		const double tile = (odd ? around->dark : around->bright)[i] * lamp;
		rgb[i] =
			around->horizon[i] + exp2(-above / falls / 3) * (tile - around->horizon[i]);
	}
}

void oracle_surroundings(const struct gz_volume *volume, const struct gz_camera *camera,
			 const struct gz_ray_params *rays, const double place[3],
			 const double direction[3], double out_rgb[3])
{
	const struct gz_environment *around = &rays->environment;
	double up[3] = { around->up[0], around->up[1], around->up[2] }, to_light[3];
	(void)gz_normalise3(up);
	towards_light(camera, &rays->light, to_light);
	const double height = fmax(gz_dot3(direction, up), 0);
	const double sun = clamp((gz_dot3(direction, to_light) - 0.9962) / 0.0032, 0, 1);
	for (int i = 0; i < 3; i++) {
		const double sky = around->horizon[i] +
				   height * (2 - height) * (around->zenith[i] - around->horizon[i]);
		out_rgb[i] = around->kind == GZ_SURROUNDINGS_SKY ? sky + sun * sun * (1 - sky)
								 : rays->background[i];
	}
	if (around->kind == GZ_SURROUNDINGS_SKY && around->floor)
		see_floor(volume, rays, to_light, place, direction, out_rgb);
}

/* What a surface at voxel coordinates of the level mirrors, and its share. */
static double mirror(const struct gz_volume *volume, const struct gz_level *level,
		     const struct gz_camera *camera, const struct gz_ray_params *rays,
		     const double at[3], const double normal[3], const double to_eye[3],
		     double out_rgb[3])
{
	const double r = rays->light.reflection, cosine = gz_dot3(normal, to_eye);
	double half[3], place[3], direction[3];
	gz_volume_half_extent(volume, half);
	for (int axis = 0; axis < 3; axis++) {
		place[axis] =
			(2 * at[axis] * level->factor[axis] / volume->dims[axis] - 1) * half[axis];
		direction[axis] = 2 * cosine * normal[axis] - to_eye[axis];
	}
	oracle_surroundings(volume, camera, rays, place, direction, out_rgb);
	return r > 0 ? r + (1 - r) * pow(1 - fmin(fabs(cosine), 1), 5) : 0;
}

void oracle_shade(const struct gz_volume *volume, const struct gz_level *level,
		  const struct gz_transfer *transfer, const struct gz_camera *camera,
		  const struct gz_ray_params *rays, const struct oracle_occlusion *occlusion,
		  const double at[3], const double direction[3], double rgb[3])
{
	const struct gz_light *light = &rays->light;
	double g[3], normal[3], to_light[3], to_eye[3], half[3];
	gradient(volume, level, transfer, rays->interpolation, at, g);
	towards_light(camera, light, to_light);
	for (int axis = 0; axis < 3; axis++) {
		normal[axis] = g[axis];
		to_eye[axis] = -direction[axis];
		half[axis] = to_eye[axis] + to_light[axis];
	}
	(void)gz_normalise3(normal);
	(void)gz_normalise3(half);
	const double edge = 0.0625, weak = 0.02;
	const double facing = clamp(gz_dot3(normal, to_eye) / edge, -1, 1);
	const double d = fmax(facing * gz_dot3(normal, to_light), 0);
	const double s = pow(fabs(gz_dot3(normal, half)), light->shininess) * fmin(d / edge, 1);
	const double o = occlusion && occlusion->cells
				 ? light->occlusion * occlusion_at(level, occlusion, at)
				 : 0;
	const double t =
		light->shadow_steps > 0 && occlusion
			? find_share(volume, level, transfer, rays, occlusion, to_light, at)
			: 1;
	const double weight = rays->shading == GZ_SHADING_GRADIENT
				      ? gz_dot3(g, g) / (gz_dot3(g, g) + weak * weak)
				      : 0;
	double seen[3];
	const double mirrored = mirror(volume, level, camera, rays, at, normal, to_eye, seen);
	for (int channel = 0; channel < 3; channel++) {
		double lit = rgb[channel] * (light->ambient * (1 - o) + light->diffuse * d * t) +
			     light->specular * s * t;
		lit = clamp(lit, 0, 1) + mirrored * (seen[channel] - clamp(lit, 0, 1));
		rgb[channel] *=
			light->shadow_steps > 0 ? light->ambient + (1 - light->ambient) * t : 1;
		rgb[channel] += weight * (lit - rgb[channel]);
	}
}

/* What one voxel fills. */
static double voxel_fills(const struct gz_volume *volume, const struct gz_transfer *transfer,
			  const struct gz_ray_params *rays, const int voxel[3])
{
	double middle[3], rgba[4];
	for (int axis = 0; axis < 3; axis++) {
		if (voxel[axis] < 0 || voxel[axis] >= volume->dims[axis])
			return 0;
		middle[axis] = voxel[axis] + 0.5;
		const double share = middle[axis] / volume->dims[axis];
		if (share < rays->clip.least[axis] || share > rays->clip.greatest[axis])
			return 0;
	}
	if (beyond_plane(volume, (const int[3]) { 1, 1, 1 }, rays, middle) > 0)
		return 0;
	const double stored = oracle_sample(volume, GZ_INTERPOLATION_NEAREST, middle);
	gz_transfer_evaluate(transfer, value_of(volume, transfer, stored), rgba);
	return 1 - pow(1 - rgba[3], rays->light.occlusion_radius / 2);
}

static double cell_fills(const struct gz_volume *volume, const struct gz_transfer *transfer,
			 const struct gz_ray_params *rays, const int edge[3], const int cell[3])
{
	double sum = 0;
	for (int z = 0; z < edge[2]; z++)
		for (int y = 0; y < edge[1]; y++)
			for (int x = 0; x < edge[0]; x++)
				sum += voxel_fills(volume, transfer, rays,
						   (const int[3]) { cell[0] * edge[0] + x,
								    cell[1] * edge[1] + y,
								    cell[2] * edge[2] + z });
	return sum / (edge[0] * edge[1] * edge[2]);
}

/* Mean of what cells fill around one of them; filled is 0 beyond the grid. */
static double mean_around(const struct oracle_occlusion *grid, const double *filled,
			  const double lengths[3], double radius, const int cell[3])
{
	double sum = 0, weights = 0;
	const int reach = (int)radius;
	for (int z = -reach; z <= reach; z++)
		for (int y = -reach; y <= reach; y++)
			for (int x = -reach; x <= reach; x++) {
				const int away[3] = { x, y, z };
				double weight = 1;
				bool within = true;
				int there[3];
				for (int axis = 0; axis < 3; axis++) {
					const double distance = abs(away[axis]) * lengths[axis];
					weight *= fmax(0, 1 - distance / radius);
					there[axis] = cell[axis] + away[axis];
					within = within && there[axis] >= 0 &&
						 there[axis] < grid->dims[axis];
				}
				weights += weight;
				if (within)
					sum += weight *
					       filled[(there[2] * grid->dims[1] + there[1]) *
							      grid->dims[0] +
						      there[0]];
			}
	return sum / weights;
}

/* The share of light that comes through the nominal length of a voxel (number -1) or a cell. */
static double comes_through(const struct gz_volume *volume, const struct gz_transfer *transfer,
			    const struct gz_ray_params *rays,
			    const struct oracle_occlusion *shadows, int number, const int at[3])
{
	for (int axis = 0; axis < 3; axis++) {
		const int dim = number < 0 ? volume->dims[axis] : shadows->level_dims[number][axis];
		const double share = (at[axis] + 0.5) / dim;
		if (at[axis] >= dim || (number < 0 && (share < rays->clip.least[axis] ||
						       share > rays->clip.greatest[axis])))
			return 1;
	}
	if (number >= 0) {
		const int *dims = shadows->level_dims[number];
		return exp2(-shadows->kept[number][(at[2] * dims[1] + at[1]) * dims[0] + at[0]]);
	}
	const double middle[3] = { at[0] + 0.5, at[1] + 0.5, at[2] + 0.5 };
	if (beyond_plane(volume, (const int[3]) { 1, 1, 1 }, rays, middle) > 0)
		return 1;
	const struct gz_level whole = { .volume = *volume, .factor = { 1, 1, 1 } };
	return exp2(-kept_by_volume(volume, &whole, transfer, GZ_INTERPOLATION_NEAREST, middle));
}

static double cell_keeps(const struct gz_volume *volume, const struct gz_transfer *transfer,
			 const struct gz_ray_params *rays, const struct oracle_occlusion *shadows,
			 int number, const int cell[3])
{
	double through[2][2][2], sum = 0;
	for (int i = 0; i < 8; i++) {
		const int up[3] = { i & 1, i >> 1 & 1, i >> 2 };
		int child[3];
		for (int axis = 0; axis < 3; axis++) {
			const int edge = shadows->level_edge[number][axis];
			const int before = number > 0 ? shadows->level_edge[number - 1][axis] : 1;
			child[axis] = edge == before ? cell[axis] : 2 * cell[axis] + up[axis];
		}
		through[up[2]][up[1]][up[0]] =
			comes_through(volume, transfer, rays, shadows, number - 1, child);
	}
	for (int a = 0; a < 2; a++)
		for (int b = 0; b < 2; b++)
			sum += through[a][b][0] * through[a][b][1] +
			       through[a][0][b] * through[a][1][b] +
			       through[0][a][b] * through[1][a][b];
	return fmin(-log2(sum / 12), 16);
}

/* The share of light that arrives in the middles of the cells of level 0. */
static void fill_arriving(const struct gz_volume *volume, const struct gz_transfer *transfer,
			  const struct gz_camera *camera, const struct gz_ray_params *rays,
			  struct oracle_occlusion *occlusion)
{
	const struct gz_level full = { .volume = *volume, .factor = { 1, 1, 1 }, .scale = 1 };
	const int *dims = occlusion->level_dims[0], *edge = occlusion->level_edge[0];
	const int count = dims[0] * dims[1] * dims[2];
	double to_light[3];
	towards_light(camera, &rays->light, to_light);
	occlusion->arriving = malloc((size_t)count * sizeof *occlusion->arriving);
	for (int i = 0; i < count; i++) {
		const double at[3] = { (i % dims[0] + 0.5) * edge[0],
				       (i / dims[0] % dims[1] + 0.5) * edge[1],
				       (i / dims[0] / dims[1] + 0.5) * edge[2] };
		occlusion->arriving[i] =
			arriving(volume, &full, transfer, rays, occlusion, to_light, at);
	}
}

void oracle_shadows_make(const struct gz_volume *volume, const struct gz_transfer *transfer,
			 const struct gz_camera *camera, const struct gz_ray_params *rays,
			 struct oracle_occlusion *occlusion)
{
	int cells = 0;
	for (int n = 0; n < ORACLE_SHADOW_LEVELS && cells != 1; n++) {
		int *dims = occlusion->level_dims[n];
		for (int axis = 0; axis < 3; axis++) {
			const double ratio = volume->spacing[axis] / least_spacing(volume);
			const int edge = (int)fmax(1, exp2(floor(log2(exp2(n + 1) / ratio))));
			occlusion->level_edge[n][axis] = edge;
			dims[axis] = (volume->dims[axis] - 1) / edge + 1;
		}
		cells = dims[0] * dims[1] * dims[2];
		occlusion->kept[n] = malloc((size_t)cells * sizeof *occlusion->kept[n]);
		for (int i = 0; i < cells; i++)
			occlusion->kept[n][i] =
				cell_keeps(volume, transfer, rays, occlusion, n,
					   (const int[3]) { i % dims[0], i / dims[0] % dims[1],
							    i / dims[0] / dims[1] });
		occlusion->levels = n + 1;
	}
	fill_arriving(volume, transfer, camera, rays, occlusion);
}

void oracle_occlusion_free(struct oracle_occlusion *occlusion)
{
	free(occlusion->cells);
	free(occlusion->arriving);
	for (int n = 0; n < occlusion->levels; n++)
		free(occlusion->kept[n]);
	*occlusion = (struct oracle_occlusion) { 0 };
}

struct oracle_occlusion oracle_occlusion_make(const struct gz_volume *volume,
					      const struct gz_transfer *transfer,
					      const struct gz_ray_params *rays)
{
	struct oracle_occlusion grid = { 0 };
	const double radius = rays->light.occlusion_radius;
	double lengths[3];
	for (int axis = 0; axis < 3; axis++) {
		/* powers of two: R / 2 at most, but 2 of the finest voxels at least, else 1 */
		const double ratio = volume->spacing[axis] / least_spacing(volume);
		const double longest = fmax(2, exp2(floor(log2(radius / 2))));
		grid.edge[axis] = (int)fmax(1, exp2(floor(log2(longest / ratio))));
		grid.dims[axis] = (volume->dims[axis] - 1) / grid.edge[axis] + 1;
		lengths[axis] = grid.edge[axis] * ratio;
	}
	const int *dims = grid.dims;
	const size_t count = (size_t)dims[0] * (size_t)dims[1] * (size_t)dims[2];
	double *filled = malloc(count * sizeof *filled);
	grid.cells = malloc(count * sizeof *grid.cells);
	for (int i = 0; i < (int)count; i++) {
		const int cell[3] = { i % dims[0], i / dims[0] % dims[1], i / dims[0] / dims[1] };
		filled[i] = cell_fills(volume, transfer, rays, grid.edge, cell);
	}
	for (int i = 0; i < (int)count; i++) {
		const int cell[3] = { i % dims[0], i / dims[0] % dims[1], i / dims[0] / dims[1] };
		grid.cells[i] = mean_around(&grid, filled, lengths, radius, cell);
	}
	free(filled);
	return grid;
}
