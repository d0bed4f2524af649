#include "render/raycast/shared/step_errors.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>

/* As multiples of the finest steps: odd, so that a value lies in the middle of each step. */
static const int strides[GZ_STEP_ERROR_LENGTHS] = { 3, 5, 7, 9, 13, 17, 25, 33 };

#define LENGTH(stride) ((double)(stride) / GZ_STEP_ERROR_FINEST)

const double gz_step_error_lengths[GZ_STEP_ERROR_LENGTHS] = {
	LENGTH(3), LENGTH(5), LENGTH(7), LENGTH(9), LENGTH(13), LENGTH(17), LENGTH(25), LENGTH(33),
};

/* A ray sees something from this opacity on. Chosen: fainter ones would dilute the mean. */
#define SEEN_OPACITY 0.02

/* Fewer rays that see something tell nothing. Chosen. */
enum { SEEING_RAYS = 16 };

/* A ray: a place on it and its direction, in voxels of each axis for a voxel length. */
struct probe_ray {
	double place[3], direction[3];
	double from, to; /* where the box begins and ends, voxel lengths from the place */
};

/* Number @p axis of the point @p i that fills the unit cube of five dimensions evenly (Roberts, The
 * unreasonable effectiveness of quasirandom sequences, 2018). */
static double even_point(int i, int axis)
{
	static const double root = 1.1347241384015194; /* of x⁶ = x + 1 */
	const double value = 0.5 + (i + 1) / pow(root, axis + 1);
	return value - floor(value);
}

static void make_probe_ray(const struct gz_volume *volume, int i, struct probe_ray *out_ray)
{
	const double *spacing = volume->spacing;
	const double voxel_length = fmin(spacing[0], fmin(spacing[1], spacing[2]));
	const double up = 2 * even_point(i, 3) - 1, turn = 2 * M_PI * even_point(i, 4);
	const double level = sqrt(1 - up * up);
	const double towards[3] = { level * cos(turn), level * sin(turn), up };
	out_ray->from = -INFINITY;
	out_ray->to = INFINITY;
	for (int axis = 0; axis < 3; axis++) {
		/* Data lie at the centres of voxels. */
		const double begin = -0.5, end = volume->dims[axis] - 0.5;
		const double place = begin + (end - begin) * even_point(i, axis);
		const double direction = towards[axis] * voxel_length / spacing[axis];
		out_ray->place[axis] = place;
		out_ray->direction[axis] = direction;
		if (direction == 0)
			continue;
		const double one = (begin - place) / direction;
		const double other = (end - place) / direction;
		out_ray->from = fmax(out_ray->from, fmin(one, other));
		out_ray->to = fmin(out_ray->to, fmax(one, other));
	}
}

static size_t count_values(const struct probe_ray *ray)
{
	return (size_t)((ray->to - ray->from) * GZ_STEP_ERROR_FINEST) + 1;
}

static float nearest_value(const struct gz_volume *volume, const double place[3])
{
	size_t index = 0;
	for (int axis = 2; axis >= 0; axis--) {
		const double last = volume->dims[axis] - 1;
		const double at = fmin(fmax(floor(place[axis] + 0.5), 0), last);
		index = index * (size_t)volume->dims[axis] + (size_t)at;
	}
	return (float)gz_voxel_stored(volume->type, volume->voxels, index);
}

static float interpolated_value(const struct gz_volume *volume, const double place[3])
{
	size_t base = 0, step[3], stride = 1;
	double share[3], value = 0;
	for (int axis = 0; axis < 3; axis++) {
		const double last = volume->dims[axis] - 1;
		const double at = fmin(fmax(place[axis], 0), last), whole = floor(at);
		share[axis] = at - whole;
		step[axis] = whole < last ? stride : 0;
		base += (size_t)whole * stride;
		stride *= (size_t)volume->dims[axis];
	}
	for (int corner = 0; corner < 8; corner++) {
		size_t index = base;
		double weight = 1;
		for (int axis = 0; axis < 3; axis++) {
			const bool far = corner >> axis & 1;
			index += far ? step[axis] : 0;
			weight *= far ? share[axis] : 1 - share[axis];
		}
		value += weight * gz_voxel_stored(volume->type, volume->voxels, index);
	}
	return (float)value;
}

static void take_ray(const struct gz_volume *volume, const struct probe_ray *ray, bool nearest,
		     size_t count, float *out_stored)
{
	for (size_t i = 0; i < count; i++) {
		const double along = ray->from + ((double)i + 0.5) / GZ_STEP_ERROR_FINEST;
		double place[3];
		for (int axis = 0; axis < 3; axis++)
			place[axis] = ray->place[axis] + along * ray->direction[axis];
		out_stored[i] =
			nearest ? nearest_value(volume, place) : interpolated_value(volume, place);
	}
}

enum gz_result gz_ray_values_take(const struct gz_volume *volume, bool nearest,
				  struct gz_ray_values *values)
{
	struct probe_ray rays[GZ_STEP_ERROR_RAYS];
	gz_ray_values_free(values);
	size_t count = 0;
	for (int i = 0; i < GZ_STEP_ERROR_RAYS; i++) {
		make_probe_ray(volume, i, &rays[i]);
		values->first[i] = count;
		count += count_values(&rays[i]);
	}
	values->first[GZ_STEP_ERROR_RAYS] = count;
	values->stored = malloc(count * sizeof *values->stored);
	values->entries = malloc(count * sizeof *values->entries);
	if (!values->stored || !values->entries) {
		gz_ray_values_free(values);
		return GZ_ERR_NO_MEM;
	}
	for (int i = 0; i < GZ_STEP_ERROR_RAYS; i++)
		take_ray(volume, &rays[i], nearest, values->first[i + 1] - values->first[i],
			 values->stored + values->first[i]);
	return GZ_OK;
}

void gz_ray_values_free(struct gz_ray_values *values)
{
	free(values->stored);
	free(values->entries);
	*values = (struct gz_ray_values) { 0 };
}

/* What a ray sees in front of black. */
struct ray_sight {
	double light, opacity;
};

/* A table's entry for steps of one length. */
struct step_entry {
	float opacity, light; /* the light that it adds */
};

/* BT.709. */
static double luminance(double red, double green, double blue)
{
	return 0.2126 * red + 0.7152 * green + 0.0722 * blue;
}

/* Of a colour of struct gz_transfer_entry. */
static double light_of(uint32_t colour)
{
	return luminance((double)(colour >> 21) / 0x7ff, (double)(colour >> 10 & 0x7ff) / 0x7ff,
			 (double)(colour & 0x3ff) / 0x3ff);
}

static void fill_step_entries(const struct gz_transfer_table *table, double length,
			      struct step_entry *out_entries)
{
	for (int i = 0; i < table->count; i++) {
		const struct gz_transfer_entry *entry = &table->entries[i];
		const double opacity = 1 - exp2(length * (double)entry->extinction);
		out_entries[i] = (struct step_entry) {
			.opacity = (float)opacity,
			.light = (float)(opacity * light_of(entry->colour)),
		};
	}
}

/* Steps as the ray caster takes them: each has the value in its middle, and the last one takes the
 * rest of the ray. */
static struct ray_sight see(const int *entries, size_t count, size_t stride,
			    const struct step_entry *steps)
{
	/* What is left of the light from there changes no luminance by half a level. */
	static const float dark = 1.F / 512;
	const size_t whole = count / stride * stride, rest = count - whole;
	float transmittance = 1, light = 0;
	for (size_t i = stride / 2; i < whole && transmittance > dark; i += stride) {
		const struct step_entry *step = &steps[entries[i]];
		light += transmittance * step->light;
		transmittance *= 1 - step->opacity;
	}
	if (rest > 0 && transmittance > dark) {
		const struct step_entry *step = &steps[entries[whole + rest / 2]];
		const float part = powf(1 - step->opacity, (float)rest / (float)stride);
		light += step->opacity > 0
				 ? transmittance * step->light * (1 - part) / step->opacity
				 : 0;
		transmittance *= part;
	}
	return (struct ray_sight) { (double)light, 1 - (double)transmittance };
}

static void find_entries(const struct gz_ray_values *values, const struct gz_transfer_table *table)
{
	for (size_t i = 0; i < values->first[GZ_STEP_ERROR_RAYS]; i++)
		values->entries[i] = gz_transfer_table_nearest(table, values->stored[i]);
}

/* What all rays see by the finest steps. @return how many see something */
static int see_finely(const struct gz_ray_values *values, const struct step_entry *steps,
		      struct ray_sight out_sights[GZ_STEP_ERROR_RAYS],
		      struct gz_step_errors *out_errors)
{
	int seeing = 0;
	for (int i = 0; i < GZ_STEP_ERROR_RAYS; i++) {
		const size_t first = values->first[i], count = values->first[i + 1] - first;
		out_sights[i] = see(values->entries + first, count, 1, steps);
		if (out_sights[i].opacity < SEEN_OPACITY)
			continue;
		seeing++;
		out_errors->light += out_sights[i].light;
		out_errors->opacity += out_sights[i].opacity;
	}
	if (seeing > 0) {
		out_errors->light /= seeing;
		out_errors->opacity /= seeing;
	}
	return seeing;
}

static struct gz_step_error measure_length(const struct gz_ray_values *values, size_t stride,
					   const struct step_entry *steps,
					   const struct ray_sight fine[GZ_STEP_ERROR_RAYS])
{
	struct gz_step_error error = { 0 };
	int count = 0;
	for (int i = 0; i < GZ_STEP_ERROR_RAYS; i++) {
		const size_t first = values->first[i];
		if (fine[i].opacity < SEEN_OPACITY)
			continue;
		const struct ray_sight coarse =
			see(values->entries + first, values->first[i + 1] - first, stride, steps);
		const double light = coarse.light - fine[i].light;
		const double opacity = coarse.opacity - fine[i].opacity;
		error.light += light * light;
		error.opacity += opacity * opacity;
		error.light_opacity += light * opacity;
		count++;
	}
	error.light /= count;
	error.opacity /= count;
	error.light_opacity /= count;
	return error;
}

enum gz_result gz_step_errors_measure(struct gz_ray_values *values,
				      const struct gz_transfer_table *table,
				      struct gz_step_errors *out_errors)
{
	struct ray_sight fine[GZ_STEP_ERROR_RAYS];
	struct gz_step_errors errors = { 0 };
	struct step_entry *steps = malloc((size_t)table->count * sizeof *steps);
	if (!steps)
		return GZ_ERR_NO_MEM;
	find_entries(values, table);
	fill_step_entries(table, 1.0 / GZ_STEP_ERROR_FINEST, steps);
	errors.known = see_finely(values, steps, fine, &errors) >= SEEING_RAYS;
	for (int i = 0; i < GZ_STEP_ERROR_LENGTHS && errors.known; i++) {
		fill_step_entries(table, gz_step_error_lengths[i], steps);
		errors.at[i] = measure_length(values, (size_t)strides[i], steps, fine);
	}
	free(steps);
	*out_errors = errors;
	return GZ_OK;
}

static double relative_error(const struct gz_step_errors *errors, int i, double behind)
{
	const struct gz_step_error *at = &errors->at[i];
	const double mean = errors->light + (1 - errors->opacity) * behind;
	const double square =
		at->light - 2 * behind * at->light_opacity + behind * behind * at->opacity;
	/* Nothing can be seen of a black volume in front of black. */
	return mean > 0 ? sqrt(fmax(square, 0)) / mean : 0;
}

/* An error's logarithm. */
static double logarithm_at(const struct gz_step_errors *errors, int i, double behind)
{
	static const double least = 1e-9;
	return log(fmax(relative_error(errors, i, behind), least));
}

/* How the logarithm of errors rises with that of lengths, from the length @p i to the next. */
static double slope_at(const struct gz_step_errors *errors, int i, double behind)
{
	const double rise = logarithm_at(errors, i + 1, behind) - logarithm_at(errors, i, behind);
	return rise / log(gz_step_error_lengths[i + 1] / gz_step_error_lengths[i]);
}

/* Likewise for steps that are shorter than those that are measured: they change less, in
 * proportion at least. */
static double slope_before(const struct gz_step_errors *errors, double behind)
{
	return fmax(slope_at(errors, 0, behind), 1);
}

double gz_step_error_at(const struct gz_step_errors *errors, double length,
			const double background[3])
{
	const double behind = luminance(background[0], background[1], background[2]);
	const int last = GZ_STEP_ERROR_LENGTHS - 1;
	int i = 0;
	while (i < last && gz_step_error_lengths[i + 1] < length)
		i++;
	const double at = logarithm_at(errors, i, behind);
	const double more = log(length / gz_step_error_lengths[i]);
	if (more < 0)
		return exp(at + slope_before(errors, behind) * more);
	return i < last ? exp(at + slope_at(errors, i, behind) * more) : exp(at);
}

double gz_step_errors_longest(const struct gz_step_errors *errors, const double background[3],
			      double limit)
{
	const double behind = luminance(background[0], background[1], background[2]);
	const double wanted = log(limit);
	const int last = GZ_STEP_ERROR_LENGTHS - 1;
	int i = 0;
	while (i < last && logarithm_at(errors, i + 1, behind) <= wanted)
		i++;
	const double left = wanted - logarithm_at(errors, i, behind);
	if (left < 0)
		return gz_step_error_lengths[0] * exp(left / slope_before(errors, behind));
	if (i == last)
		return INFINITY;
	return gz_step_error_lengths[i] * exp(left / slope_at(errors, i, behind));
}
