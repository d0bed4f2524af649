#include "render/particles/particle_grid.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/order.h"
#include "base/vector.h"
#include "render/particles/particle_cells.h"
#include "render/particles/particle_series.h"

#define GZ_LOG_MODULE "particles"

/* Particles that the radius is estimated from. Chosen: the median is stable to a per cent. */
#define RADIUS_SAMPLE 1024

/* Least reach of a particle in edges of the box: squares of it are normal floats. */
#define SUPPORT_MIN 1e-6

/* The integral of a kernel that is 1 at its centre and reaches to 1. */
#define KERNEL_INTEGRAL 0.39269908169872415 /* pi / 8 */

/* The sum of kernels exceeds the greatest value where particles are closer than at rest. A series
 * has room for that: twice, chosen. */
#define SUM_HEADROOM 2

const char *const gz_particle_gridding_names[] = { "sph", "nearest", NULL };

_Static_assert(sizeof(enum gz_particle_gridding) == sizeof(int) &&
		       sizeof(enum gz_particle_value) == sizeof(int),
	       "a CHOICE option writes an int");

#define AT(field) offsetof(struct gz_particle_grid, field)

const struct gz_option gz_particle_grid_options[GZ_PARTICLE_GRID_OPTIONS] = {
	{ "particles.grid", GZ_OPTION_CHOICE, AT(gridding), .choices = gz_particle_gridding_names,
	  .preset = "sph",
	  .help = "how particles become voxels: sph, a sum of smooth kernels, or the value of the "
		  "nearest particle" },
	{ "particles.value", GZ_OPTION_CHOICE, AT(value), .choices = gz_particle_value_names,
	  .preset = "fill",
	  .help = "what voxels hold: fill (1 in the liquid, 0 outside), or the particles' density, "
		  "pressure or speed" },
	{ "particles.cells", GZ_OPTION_INT, AT(cells), GZ_PARTICLE_CELLS_MIN, GZ_PARTICLE_CELLS_MAX,
	  .preset = "256", .help = "voxels along the longest edge" },
	{ "particles.radius", GZ_OPTION_DOUBLE, AT(radius), 0, 1e30, .preset = "0",
	  .help = "radius of a particle, in the file's unit; 0: estimated from the particles" },
	{ "particles.smoothing", GZ_OPTION_DOUBLE, AT(smoothing), 0.1, 100, .preset = "2",
	  .help = "sph: smoothing length, in radii; a kernel reaches twice as far" },
	{ "particles.reach", GZ_OPTION_DOUBLE, AT(reach), 0, 1000, .preset = "0",
	  .help = "nearest: voxels farther than this from every particle are empty, in voxels; 0: "
		  "one, or two radii if that is more" },
};

struct gz_particle_grid gz_particle_grid_preset(void)
{
	return (struct gz_particle_grid) { .cells = 256, .smoothing = 2 };
}

/* The box in the file's unit, and the scale that makes its longest edge 1. */
struct particle_box {
	double least[3], extent[3];
	double scale;
};

static struct particle_box find_box(const struct gz_particles *particles)
{
	struct particle_box box = { .scale = 0 };
	for (int axis = 0; axis < 3; axis++) {
		double least = particles->positions[0][axis], greatest = least;
		for (size_t i = 1; i < particles->count && !particles->has_box; i++) {
			least = fmin(least, particles->positions[i][axis]);
			greatest = fmax(greatest, particles->positions[i][axis]);
		}
		if (particles->has_box) {
			least = particles->box_least[axis];
			greatest = particles->box_greatest[axis];
		}
		box.least[axis] = least;
		box.extent[axis] = greatest - least;
		box.scale = fmax(box.scale, box.extent[axis]);
	}
	/* Denormal differences are none. */
	if (!(box.scale > 1e-300))
		box.scale = 0;
	return box;
}

/* The tree of all particles in the unit cube. */
static enum gz_result build_tree(const struct gz_particles *particles,
				 const struct particle_box *box, double least_edge,
				 struct gz_octree *out_tree)
{
	float(*points)[3] = malloc(particles->count * sizeof *points);
	if (!points)
		return GZ_ERR_NO_MEM;
	for (size_t i = 0; i < particles->count; i++)
		for (int axis = 0; axis < 3; axis++)
			points[i][axis] = box->scale > 0 ? (float)((particles->positions[i][axis] -
								    box->least[axis]) /
								   box->scale)
							 : 0;
	const enum gz_result result =
		gz_octree_build((const float(*)[3])points, particles->count, least_edge, out_tree);
	free(points);
	return result;
}

/* Particles of a sample, evenly by their numbers in the file, whatever the order of the tree. */
static bool is_sampled(const struct gz_octree *tree, uint32_t index)
{
	const uint64_t sample = tree->count < RADIUS_SAMPLE ? tree->count : RADIUS_SAMPLE;
	return tree->order[index] * sample % tree->count < sample;
}

static double median_of(double *numbers, size_t count)
{
	qsort(numbers, count, sizeof numbers[0], gz_compare_doubles);
	return numbers[count / 2];
}

/* The median distance of particles to their nearest neighbours; 0 if no two of them lie apart. */
static double usual_distance(const struct gz_octree *tree)
{
	double distances[RADIUS_SAMPLE];
	size_t count = 0;
	for (uint32_t i = 0; i < tree->count; i++) {
		const double squared =
			is_sampled(tree, i) ? (double)gz_octree_nearest_other(tree, i) : 0;
		if (squared > 0 && isfinite(squared))
			distances[count++] = sqrt(squared);
	}
	return count > 0 ? median_of(distances, count) : 0;
}

/* The edge of a cube as large as the volume of a particle, which is 1 / sum of kernels. */
static double edge_of_particle(const struct gz_octree *tree, uint32_t index, double support)
{
	struct gz_octree_walk walk;
	float least[3], greatest[3];
	uint32_t first, count;
	double sum = 0;
	for (int axis = 0; axis < 3; axis++) {
		least[axis] = tree->at[axis][index] - (float)support;
		greatest[axis] = tree->at[axis][index] + (float)support;
	}
	gz_octree_walk_begin(&walk, tree, least, greatest);
	while (gz_octree_walk_next(&walk, &first, &count))
		for (uint32_t i = first; i < first + count; i++) {
			double away[3];
			for (int axis = 0; axis < 3; axis++)
				away[axis] =
					(double)tree->at[axis][i] - (double)tree->at[axis][index];
			const double q = fmin(gz_length3(away) / support, 1);
			const double inner = fmax(0.5 - q, 0);
			sum += 2 * ((1 - q) * (1 - q) * (1 - q) - 4 * inner * inner * inner);
		}
	return support * cbrt(KERNEL_INTEGRAL / sum);
}

/* The radius of particles in edges of the box; 0 if no two of them lie apart. */
static double usual_radius(const struct gz_octree *tree)
{
	double edges[RADIUS_SAMPLE];
	size_t count = 0;
	const double distance = usual_distance(tree);
	if (!(distance > 0))
		return 0;
	for (uint32_t i = 0; i < tree->count; i++)
		if (is_sampled(tree, i))
			edges[count++] = edge_of_particle(tree, i, 2 * distance);
	return median_of(edges, count) / 2;
}

/* A cube of this edge holds about one particle if they lie evenly. */
static double edge_of_one(const struct gz_particles *particles)
{
	return 0.5 / cbrt((double)particles->count);
}

enum gz_result gz_particles_find_radius(const struct gz_particles *particles, double *out_radius)
{
	const struct particle_box box = find_box(particles);
	struct gz_octree tree;
	const enum gz_result result = build_tree(particles, &box, edge_of_one(particles), &tree);
	if (result != GZ_OK)
		return result;
	*out_radius = usual_radius(&tree) * box.scale;
	gz_octree_free(&tree);
	return GZ_OK;
}

/* A volume that is being made. */
struct gridding {
	const struct gz_particles *particles;
	const struct gz_particle_grid *grid;
	const char *name;
	const struct gz_loading *loading;
	const struct gz_log *log;
	struct particle_box box;
	struct gz_particle_cells cells;
	double radius; /* in edges of the box */
	struct gz_volume volume;
};

bool gz_particle_cells_go_on(struct gz_particle_cells *cells, int worker)
{
	if (worker == 0 && cells->parts > 0) {
		const double share = (double)atomic_load(&cells->parts_done) / (double)cells->parts;
		if (!gz_loading_goes_on(cells->loading,
					cells->share_from +
						share * (cells->share_to - cells->share_from),
					cells->name))
			atomic_store(&cells->result, GZ_ERR_CANCELLED);
	}
	return atomic_load(&cells->result) == GZ_OK;
}

/* Without a neighbour nothing tells how large a particle is. */
static void choose_radius(struct gridding *making)
{
	const double scale = making->box.scale > 0 ? making->box.scale : 1;
	making->radius = making->grid->radius > 0 ? making->grid->radius / scale
						  : usual_radius(&making->cells.tree);
	if (making->radius > 0)
		return;
	making->radius = 0.01;
	gz_info(making->log,
		"%s: no two particles lie apart, so their radius is taken as %g; particles.radius "
		"sets it",
		making->name, making->radius * scale);
}

/* The edge of a voxel, how far a particle reaches, and the number of voxels. */
static enum gz_result plan_voxels(struct gridding *making)
{
	const struct gz_particle_grid *grid = making->grid;
	struct gz_particle_cells *cells = &making->cells;
	const double scale = making->box.scale > 0 ? making->box.scale : 1;
	const double longest = making->box.scale > 0 ? 1 : 0;
	double support = 2 * grid->smoothing * making->radius;
	double voxel = (longest + 2 * support) / grid->cells;
	if (grid->gridding == GZ_GRIDDING_NEAREST) {
		/* The margin is as wide as the reach, which may be in voxels. */
		support = 2 * making->radius;
		voxel = (longest + 2 * support) / grid->cells;
		if (grid->reach > 0 || support < voxel) {
			const double reach = grid->reach > 0 ? grid->reach : 1;
			const double inner = fmax(grid->cells - 2 * reach, 1);
			voxel = longest > 0 ? longest / inner : 2 * making->radius / inner;
			support = reach * voxel;
		}
	}
	if (support < SUPPORT_MIN) {
		gz_err(making->log,
		       "%s: a particle of radius %g is less than a millionth of the box, %g; "
		       "choose a greater particles.radius",
		       making->name, making->radius * scale, scale);
		return GZ_ERR_FORMAT;
	}
	if (grid->gridding == GZ_GRIDDING_SPH && support < voxel)
		gz_warn(making->log,
			"%s: particles reach only %.2g voxels, so some may not be seen; choose "
			"more particles.cells or a greater particles.radius",
			making->name, support / voxel);
	cells->support = (float)support;
	cells->voxel = (float)voxel;
	for (int axis = 0; axis < 3; axis++) {
		const double extent =
			making->box.scale > 0 ? making->box.extent[axis] / making->box.scale : 0;
		const double wanted = ceil((extent + 2 * support) / voxel - 1e-6);
		cells->dims[axis] = (int)fmin(fmax(wanted, GZ_PARTICLE_CELLS_MIN), grid->cells);
		cells->origin[axis] = (float)(extent / 2 - (cells->dims[axis] - 1) / 2.0 * voxel);
		making->volume.dims[axis] = cells->dims[axis];
		making->volume.spacing[axis] = voxel * scale;
	}
	return GZ_OK;
}

static enum gz_result allocate_voxels(struct gridding *making)
{
	struct gz_volume *volume = &making->volume;
	volume->type = GZ_VOXEL_F32;
	const enum gz_result result = gz_volume_allocate_in(volume, making->loading);
	if (result != GZ_OK) {
		gz_err(making->log,
		       "%s: cannot make %d x %d x %d voxels: %s; choose fewer "
		       "particles.cells",
		       making->name, volume->dims[0], volume->dims[1], volume->dims[2],
		       gz_result_text(result));
		return result;
	}
	volume->slope = 1;
	volume->intercept = 0;
	making->cells.voxels = volume->voxels;
	return GZ_OK;
}

static enum gz_result fill_voxels(struct gridding *making)
{
	struct gz_particle_cells *cells = &making->cells;
	struct gz_workers *workers = NULL;
	enum gz_result result = gz_workers_create(making->grid->threads, &workers);
	if (result == GZ_OK && making->grid->gridding == GZ_GRIDDING_NEAREST) {
		cells->share_to = 1;
		result = gz_particle_nearest_fill(cells, workers);
	} else if (result == GZ_OK) {
		cells->share_to = 0.3;
		result = gz_particle_weights_find(cells, workers);
		cells->share_from = cells->share_to;
		cells->share_to = 1;
		if (result == GZ_OK)
			result = gz_particle_sum_fill(cells, workers);
	}
	gz_workers_destroy(&workers);
	if (result == GZ_ERR_NO_MEM)
		gz_err(making->log, "%s: no memory to grid %zu particles", making->name,
		       making->particles->count);
	if (result == GZ_ERR_FULL) {
		gz_err(making->log,
		       "%s: too many particles lie within reach of each other; choose a smaller "
		       "particles.radius than %g",
		       making->name,
		       making->radius * (making->box.scale > 0 ? making->box.scale : 1));
		result = GZ_ERR_FORMAT;
	}
	return result;
}

/* The range of all time points: that of their values and 0, with headroom for sums. */
static void find_series_range(const struct gridding *making, double out_range[2])
{
	const double *values = making->particles->value_range;
	const double room = making->grid->gridding == GZ_GRIDDING_SPH ? SUM_HEADROOM : 1;
	const double *known = making->loading ? making->loading->number_range : NULL;
	out_range[0] = known ? known[0] : room * fmin(0, values[0]);
	out_range[1] = known ? known[1] : room * fmax(0, values[1]);
}

/* Keep the voxels within the range of the series. */
static void limit_to_series(struct gridding *making)
{
	struct gz_volume *volume = &making->volume;
	float *voxels = volume->voxels;
	const size_t count = gz_volume_voxel_count(volume);
	size_t cut = 0;
	find_series_range(making, volume->number_range);
	const float least = (float)volume->number_range[0];
	const float greatest = (float)volume->number_range[1];
	for (size_t i = 0; i < count; i++) {
		const float value = voxels[i];
		voxels[i] = value < least ? least : value > greatest ? greatest : value;
		cut += voxels[i] != value;
	}
	if (cut > 0)
		gz_warn(making->log,
			"%s: %zu voxels lie outside %g to %g, the range of all time "
			"points, and were cut off",
			making->name, cut, volume->number_range[0], volume->number_range[1]);
	volume->stored_min = volume->number_range[0];
	volume->stored_max = volume->number_range[1];
}

static enum gz_result make_voxels(struct gridding *making)
{
	enum gz_result result = plan_voxels(making);
	if (result == GZ_OK)
		result = allocate_voxels(making);
	if (result == GZ_OK)
		result = fill_voxels(making);
	if (result != GZ_OK)
		return result;
	making->volume.time_points = making->particles->time_points;
	making->volume.time_point = making->particles->time_point;
	if (making->particles->time_points > 1)
		limit_to_series(making);
	else
		gz_volume_find_range(&making->volume);
	return gz_loading_goes_on(making->loading, 1, making->name) ? GZ_OK : GZ_ERR_CANCELLED;
}

static bool grid_valid(const struct gz_particle_grid *grid)
{
	return (unsigned)grid->gridding < GZ_GRIDDING_COUNT &&
	       (unsigned)grid->value < GZ_PARTICLE_VALUE_COUNT &&
	       grid->cells >= GZ_PARTICLE_CELLS_MIN && grid->cells <= GZ_PARTICLE_CELLS_MAX &&
	       grid->radius >= 0 && isfinite(grid->radius) && grid->smoothing > 0 &&
	       isfinite(grid->smoothing) && grid->reach >= 0 && isfinite(grid->reach);
}

enum gz_result gz_particles_to_volume(const struct gz_particles *particles,
				      const struct gz_particle_grid *grid, const char *name,
				      const struct gz_loading *loading, const struct gz_log *log,
				      struct gz_volume *out_volume)
{
	if (!grid_valid(grid) || particles->count == 0)
		return GZ_ERR_INVAL;
	struct gridding making = {
		.particles = particles,
		.grid = grid,
		.name = name,
		.loading = loading,
		.log = log,
		.box = find_box(particles),
		.cells = { .particles = particles,
			   .name = name,
			   .loading = loading,
			   .kernels = gz_particle_kernels_find(grid->portable) },
	};
	const double least_edge = fmin(1.0 / grid->cells, edge_of_one(particles));
	enum gz_result result = build_tree(particles, &making.box, least_edge, &making.cells.tree);
	if (result == GZ_OK) {
		choose_radius(&making);
		result = make_voxels(&making);
	} else {
		gz_err(log, "%s: no memory for the tree of %zu particles", name, particles->count);
	}
	gz_octree_free(&making.cells.tree);
	free(making.cells.weights);
	if (result != GZ_OK) {
		if (making.volume.voxels)
			gz_volume_free(&making.volume);
		return result;
	}
	*out_volume = making.volume;
	return GZ_OK;
}

/* The radius that all time points have: that of the first. */
static enum gz_result find_radius_of_series(const struct gz_particle_request *request,
					    double *out_radius)
{
	struct gz_particle_request first = *request;
	struct gz_particles particles;
	first.value = GZ_PARTICLE_FILL;
	first.time_point = 0;
	enum gz_result result = gz_particles_load(&first, &particles);
	if (result != GZ_OK)
		return result;
	result = gz_particles_find_radius(&particles, out_radius);
	if (result == GZ_ERR_NO_MEM)
		gz_err(request->log, "%s: no memory for the tree of %zu particles", request->path,
		       particles.count);
	gz_particles_free(&particles);
	return result;
}

static enum gz_result load_one_file(const struct gz_particle_request *request,
				    const struct gz_particle_grid *grid,
				    struct gz_volume *out_volume)
{
	struct gz_particle_grid of_series = *grid;
	struct gz_particles particles;
	enum gz_result result = gz_particles_load(request, &particles);
	if (result != GZ_OK)
		return result;
	if (particles.time_point > 0 && !(grid->radius > 0))
		result = find_radius_of_series(request, &of_series.radius);
	if (result == GZ_OK)
		result = gz_particles_to_volume(&particles, &of_series, request->path,
						request->loading, request->log, out_volume);
	gz_particles_free(&particles);
	return result;
}

/* Load the file of a time point into the box of all. */
static enum gz_result load_of_series(const struct gz_particle_series *series,
				     const struct gz_particle_request *request,
				     const struct gz_particle_grid *grid,
				     const struct gz_particle_frame *frame,
				     struct gz_volume *out_volume)
{
	struct gz_particle_grid of_series = *grid;
	struct gz_particle_request own = *request;
	struct gz_particles particles;
	const int shown = request->time_point;
	const int count = frame->count < (int)series->count ? frame->count : (int)series->count;
	if (shown >= count) {
		gz_err(request->log, "%s: has no time point %d; the series has %d", request->path,
		       shown + 1, count);
		return GZ_ERR_INVAL;
	}
	own.path = series->paths[shown];
	own.time_point = 0;
	enum gz_result result = gz_particles_load(&own, &particles);
	if (result != GZ_OK)
		return result;
	particles.has_box = true;
	memcpy(particles.box_least, frame->least, sizeof particles.box_least);
	memcpy(particles.box_greatest, frame->greatest, sizeof particles.box_greatest);
	memcpy(particles.value_range, frame->value_range, sizeof particles.value_range);
	particles.time_points = frame->count;
	particles.time_point = shown;
	if (!(grid->radius > 0))
		of_series.radius = frame->radius;
	result = gz_particles_to_volume(&particles, &of_series, own.path, request->loading,
					request->log, out_volume);
	gz_particles_free(&particles);
	return result;
}

enum gz_result gz_particle_volume_load(const char *path, const struct gz_particle_grid *grid,
				       struct gz_particle_frame *frame,
				       const struct gz_loading *loading, const struct gz_log *log,
				       struct gz_volume *out_volume)
{
	struct gz_particle_frame found = frame ? *frame : (struct gz_particle_frame) { 0 };
	struct gz_particle_series series;
	const struct gz_particle_request request = {
		.path = path,
		.value = grid->value,
		.time_point = loading ? loading->time_point : 0,
		.range_known = loading && loading->number_range,
		.loading = loading,
		.log = log,
	};
	enum gz_result result = gz_particle_series_find(path, &series);
	if (result != GZ_OK)
		gz_err(log, "%s: no memory to list the files of its series", path);
	if (result == GZ_OK && series.count > 0 && found.count == 0)
		result = gz_particle_series_measure(&series, grid->value, loading, log, &found);
	if (result == GZ_OK)
		result = series.count > 0
				 ? load_of_series(&series, &request, grid, &found, out_volume)
				 : load_one_file(&request, grid, out_volume);
	if (result == GZ_OK && frame)
		*frame = found;
	gz_particle_series_free(&series);
	return result;
}
