#include "render/section/section.h"

#include <math.h>
#include <string.h>

#include "render/data/brick_value.h"
#include "render/data/voxel_colour.h"

/* Steps of a ray in a voxel length (chosen: a surface is found to half a voxel). */
#define HIT_STEPS 2.0

/* Opacity at which a look ends, and the least one with which something is seen. Chosen. */
#define SEEN_WHOLLY 0.999
#define SEEN_LEAST  0.05

/* How far behind the border of something its matter is looked for, voxel lengths. Chosen: twice
 * what interpolation spreads a border over, and a half. */
#define SEEN_ON 3.0

/* A position along one axis: two neighbouring voxels, as steps in memory, and the share of the
 * second. */
struct between {
	size_t first, second;
	double share;
};

struct gz_section_axes gz_section_axes_of(enum gz_section_plane plane, bool oriented)
{
	static const struct gz_section_axes axes[GZ_SECTION_COUNT] = {
		[GZ_SECTION_AXIAL] = { .across = 0, .upward = 1, .normal = 2 },
		[GZ_SECTION_CORONAL] = { .across = 0, .upward = 2, .normal = 1 },
		[GZ_SECTION_SAGITTAL] = { .across = 1, .upward = 2, .normal = 0 },
	};
	struct gz_section_axes found = axes[plane];
	found.mirrored = oriented;
	return found;
}

bool gz_section_possible(const struct gz_volume *volume)
{
	return volume->voxels != NULL;
}

void gz_section_fit(const struct gz_volume *volume, enum gz_section_plane plane,
		    const double room[2], double out_size[2])
{
	const struct gz_section_axes axes = gz_section_axes_of(plane, volume->oriented);
	const double width_mm = volume->dims[axes.across] * volume->spacing[axes.across];
	const double height_mm = volume->dims[axes.upward] * volume->spacing[axes.upward];
	const double per_mm = fmin(room[0] / width_mm, room[1] / height_mm);
	out_size[0] = width_mm * per_mm;
	out_size[1] = height_mm * per_mm;
}

static double within_box(double share)
{
	return fmin(1, fmax(0, share));
}

void gz_section_place(struct gz_section_axes axes, const double point[2], double place[3])
{
	place[axes.across] = within_box(axes.mirrored ? 1 - point[0] : point[0]);
	place[axes.upward] = within_box(1 - point[1]);
}

void gz_section_point(struct gz_section_axes axes, const double place[3], double out_point[2])
{
	out_point[0] = axes.mirrored ? 1 - place[axes.across] : place[axes.across];
	out_point[1] = 1 - place[axes.upward];
}

static int voxel_at(int dim, double share)
{
	const double voxel = floor(within_box(share) * dim);
	return voxel < dim ? (int)voxel : dim - 1;
}

void gz_section_voxel(const struct gz_volume *volume, const double place[3], int out_voxel[3])
{
	for (int axis = 0; axis < 3; axis++)
		out_voxel[axis] = voxel_at(volume->dims[axis], place[axis]);
}

void gz_section_step(const struct gz_volume *volume, int axis, int steps, double place[3])
{
	const int dim = volume->dims[axis];
	const int voxel = voxel_at(dim, place[axis]) + steps;
	place[axis] = ((voxel < 0 ? 0 : voxel < dim ? voxel : dim - 1) + 0.5) / dim;
}

static size_t axis_stride(const struct gz_volume *volume, int axis)
{
	size_t stride = 1;
	for (int i = 0; i < axis; i++)
		stride *= (size_t)volume->dims[i];
	return stride;
}

static struct between between_voxels(const struct gz_volume *volume, int axis, double share)
{
	const int dim = volume->dims[axis];
	const size_t stride = axis_stride(volume, axis);
	const double at = fmin(dim - 1, fmax(0, share * dim - 0.5));
	const int first = (int)at;
	const int second = first + 1 < dim ? first + 1 : first;
	return (struct between) { (size_t)first * stride, (size_t)second * stride, at - first };
}

static struct between nearest_voxel(const struct gz_volume *volume, int axis, double share)
{
	const size_t step = (size_t)voxel_at(volume->dims[axis], share) * axis_stride(volume, axis);
	return (struct between) { step, step, 0 };
}

static bool takes_nearest(const struct gz_volume *volume)
{
	return volume->labels || volume->colours;
}

static struct between find_between(const struct gz_volume *volume, int axis, double share)
{
	return takes_nearest(volume) ? nearest_voxel(volume, axis, share)
				     : between_voxels(volume, axis, share);
}

/* Between two voxels; the second is not read where it has no share. */
static double mix_line(const struct gz_volume *volume, size_t at, struct between line)
{
	const double first = gz_voxel_stored(volume->type, volume->voxels, at + line.first);
	if (line.share == 0)
		return first;
	const double second = gz_voxel_stored(volume->type, volume->voxels, at + line.second);
	return first + (second - first) * line.share;
}

static double mix_face(const struct gz_volume *volume, size_t at, struct between row,
		       struct between line)
{
	const double first = mix_line(volume, at + row.first, line);
	if (row.share == 0)
		return first;
	return first + (mix_line(volume, at + row.second, line) - first) * row.share;
}

/* The data value between voxels along three axes. */
static double mix_value(const struct gz_volume *volume, struct between depth, struct between row,
			struct between line)
{
	double stored = mix_face(volume, depth.first, row, line);
	if (depth.share != 0)
		stored += (mix_face(volume, depth.second, row, line) - stored) * depth.share;
	return volume->slope * stored + volume->intercept;
}

double gz_section_value(const struct gz_volume *volume, const double place[3])
{
	return mix_value(volume, nearest_voxel(volume, 2, place[2]),
			 nearest_voxel(volume, 1, place[1]), nearest_voxel(volume, 0, place[0]));
}

/* The data values that 0 and 1 of a function stand for: the volume's range unless it has its own.
 */
static void ends_of(const struct gz_transfer *transfer, const struct gz_volume *volume,
		    double out_ends[2])
{
	const double ends[2] = { volume->slope * volume->stored_min + volume->intercept,
				 volume->slope * volume->stored_max + volume->intercept };
	out_ends[0] = transfer->has_range ? transfer->range[0] : fmin(ends[0], ends[1]);
	out_ends[1] = transfer->has_range ? transfer->range[1] : fmax(ends[0], ends[1]);
}

/* From a data value to one of a function. */
static double value_of_function(const double ends[2], double value)
{
	return ends[1] > ends[0] ? (value - ends[0]) / (ends[1] - ends[0]) : 0;
}

/* Colour and opacity of a data value. */
static void look_up(const struct gz_transfer *transfer, const struct gz_volume *volume,
		    double value, double out_rgba[4])
{
	double ends[2];
	ends_of(transfer, volume, ends);
	gz_transfer_evaluate(transfer, value_of_function(ends, value), out_rgba);
}

static uint8_t byte_of(double share)
{
	return (uint8_t)lround(255 * within_box(share));
}

static void paint_value(const struct gz_section_request *request, double value, uint8_t pixel[4])
{
	const double grey = within_box((value - request->level) / request->width + 0.5);
	double rgba[4] = { 0 };
	if (request->transfer)
		look_up(request->transfer, request->volume, value, rgba);
	for (int i = 0; i < 3; i++)
		pixel[i] = byte_of(grey + (rgba[i] - grey) * rgba[3]);
}

static void paint_colour(const struct gz_volume *volume, size_t at, uint8_t pixel[4])
{
	for (int i = 0; i < 3; i++)
		pixel[i] = gz_colour_byte(volume->colours[at], i);
}

static void draw_row(const struct gz_section_request *request, struct between depth,
		     struct between row, int width, uint8_t *pixels)
{
	const struct gz_volume *volume = request->volume;
	const struct gz_section_axes axes = gz_section_axes_of(request->plane, volume->oriented);
	for (int x = 0; x < width; x++, pixels += 4) {
		const double share = (x + 0.5) / width;
		const struct between line =
			find_between(volume, axes.across, axes.mirrored ? 1 - share : share);
		if (volume->colours)
			paint_colour(volume, depth.first + row.first + line.first, pixels);
		else
			paint_value(request, mix_value(volume, depth, row, line), pixels);
		pixels[3] = 255;
	}
}

enum gz_result gz_section_draw(const struct gz_section_request *request, int width, int height,
			       struct gz_image *image)
{
	const struct gz_volume *volume = request->volume;
	const struct gz_section_axes axes = gz_section_axes_of(request->plane, volume->oriented);
	const struct between depth = find_between(volume, axes.normal, request->place[axes.normal]);
	const enum gz_result r = gz_image_resize(image, width, height);
	for (int y = 0; r == GZ_OK && y < height; y++)
		draw_row(request, depth, find_between(volume, axes.upward, 1 - (y + 0.5) / height),
			 width, image->pixels + (size_t)y * (size_t)width * 4);
	return r;
}

/* ---- what a ray meets ---- */

/* From the world to fractions of the box. */
static void box_ray(const struct gz_volume *volume, const double origin[3],
		    const double direction[3], double from[3], double along[3])
{
	double longest = 0;
	for (int i = 0; i < 3; i++)
		longest = fmax(longest, volume->dims[i] * volume->spacing[i]);
	for (int i = 0; i < 3; i++) {
		const double edge = volume->dims[i] * volume->spacing[i] / longest;
		from[i] = origin[i] / edge + 0.5;
		along[i] = direction[i] / edge;
	}
}

/* Steps along a ray through a volume. */
struct walk {
	const struct gz_volume *volume;
	const struct gz_transfer *transfer;
	double from[3], along[3]; /* the ray, in fractions of the box */
	double begin, step;       /* multiples of its direction */
	long count;
};

/* @return false: the ray misses what is shown */
static bool begin_walk(const struct gz_volume *volume, const struct gz_transfer *transfer,
		       const struct gz_section_ray *ray, struct walk *out_walk)
{
	struct walk walk = { .volume = volume, .transfer = transfer };
	static const double one[3] = { 1, 1, 1 }, none[3] = { 0, 0, 0 };
	struct gz_clip_bounds bounds;
	double ends[2], voxels = 0;
	box_ray(volume, ray->origin, ray->direction, walk.from, walk.along);
	gz_clip_region_place(&ray->clip, volume, one, none, &bounds);
	if (!gz_clip_bounds_cross(&bounds, walk.from, walk.along, ends) || ends[0] >= ray->until)
		return false;
	const double voxel_mm =
		fmin(volume->spacing[0], fmin(volume->spacing[1], volume->spacing[2]));
	for (int i = 0; i < 3; i++)
		voxels += pow(walk.along[i] * volume->dims[i] * volume->spacing[i] / voxel_mm, 2);
	walk.begin = ends[0];
	walk.step = 1 / (HIT_STEPS * sqrt(voxels));
	walk.count = lround(ceil((fmin(ends[1], ray->until) - ends[0]) / walk.step));
	*out_walk = walk;
	return true;
}

static double depth_of_step(const struct walk *walk, long n)
{
	return walk->begin + ((double)n + 0.5) * walk->step;
}

static void place_of_step(const struct walk *walk, long n, double out_place[3])
{
	for (int i = 0; i < 3; i++)
		out_place[i] = within_box(walk->from[i] + walk->along[i] * depth_of_step(walk, n));
}

static double value_of_step(const struct walk *walk, long n)
{
	const struct gz_volume *volume = walk->volume;
	double place[3];
	place_of_step(walk, n, place);
	if (volume->bricks)
		return volume->slope *
			       gz_brick_value(volume->bricks, place, takes_nearest(volume)) +
		       volume->intercept;
	return mix_value(volume, find_between(volume, 2, place[2]),
			 find_between(volume, 1, place[1]), find_between(volume, 0, place[0]));
}

/* The opacity of a voxel length where a step is. */
static double opacity_of_step(const struct walk *walk, long n)
{
	double rgba[4];
	look_up(walk->transfer, walk->volume, value_of_step(walk, n), rgba);
	return rgba[3];
}

/* Go on until the steps have some opacity together. @return the last one; count: they have less */
static long walk_until(const struct walk *walk, double opacity, double *out_passed)
{
	double clear = 1;
	long n = 0;
	for (; n < walk->count; n++) {
		clear *= 1 - gz_transfer_opacity_over(opacity_of_step(walk, n), 1 / HIT_STEPS);
		if (1 - clear >= opacity)
			break;
	}
	*out_passed = 1 - clear;
	return n;
}

bool gz_section_hit(const struct gz_volume *volume, const struct gz_transfer *transfer,
		    const double origin[3], const double direction[3], double out_place[3])
{
	struct gz_section_ray ray = { .until = INFINITY, .clip = gz_clip_whole };
	struct walk walk;
	double passed;
	memcpy(ray.origin, origin, sizeof ray.origin);
	memcpy(ray.direction, direction, sizeof ray.direction);
	if (!begin_walk(volume, transfer, &ray, &walk))
		return false;
	const long n = walk_until(&walk, 0.5, &passed);
	if (n == walk.count)
		return false;
	place_of_step(&walk, n, out_place);
	return true;
}

bool gz_section_look(const struct gz_volume *volume, const struct gz_transfer *transfer,
		     const struct gz_section_ray *ray, struct gz_section_seen *out_seen)
{
	struct walk walk;
	double opacity, passed, ends[2];
	if (!begin_walk(volume, transfer, ray, &walk))
		return false;
	(void)walk_until(&walk, SEEN_WHOLLY, &opacity);
	if (opacity < SEEN_LEAST)
		return false;
	long n = walk_until(&walk, opacity / 2, &passed);
	const long last = n + (long)(SEEN_ON * HIT_STEPS);
	while (n + 1 < walk.count && n < last &&
	       opacity_of_step(&walk, n + 1) > opacity_of_step(&walk, n))
		n++;
	ends_of(transfer, volume, ends);
	*out_seen = (struct gz_section_seen) {
		.value = value_of_function(ends, value_of_step(&walk, n)),
		.unit = ends[1] > ends[0] ? 1 / (ends[1] - ends[0]) : 0,
		.depth = depth_of_step(&walk, n),
		.opacity = opacity,
	};
	return true;
}
