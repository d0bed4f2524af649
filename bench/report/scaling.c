/* How time grows with pixels, voxels and threads. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/report/summary_parts.h"

static bool several_x(const struct gz_scaling_point *points, size_t count)
{
	for (size_t i = 1; i < count; i++)
		if (points[i].x != points[0].x)
			return true;
	return false;
}

bool gz_scaling_fit(const struct gz_scaling_point *points, size_t count, double *out_exponent,
		    double *out_factor, double *out_r2)
{
	for (size_t i = 0; i < count; i++)
		if (!(points[i].x > 0) || !(points[i].ms > 0))
			return false;
	if (!several_x(points, count))
		return false;
	double mean_x = 0, mean_y = 0, xx = 0, xy = 0, yy = 0;
	for (size_t i = 0; i < count; i++) {
		mean_x += log(points[i].x) / (double)count;
		mean_y += log(points[i].ms) / (double)count;
	}
	for (size_t i = 0; i < count; i++) {
		const double x = log(points[i].x) - mean_x, y = log(points[i].ms) - mean_y;
		xx += x * x;
		xy += x * y;
		yy += y * y;
	}
	*out_exponent = xy / xx;
	*out_factor = exp(mean_y - *out_exponent * mean_x);
	*out_r2 = yy > 0 ? xy * xy / (xx * yy) : 1;
	return true;
}

/* "cpu:threads=2,simd=avx2" is the stem "cpu:,simd=avx2" with 2 threads; 0 where the text does not
 * say how many. */
static int threads_of(const char *backend, char stem[GZ_NAME_SIZE])
{
	static const char key[] = "threads=";
	const char *at = strstr(backend, key);
	snprintf(stem, GZ_NAME_SIZE, "%s", backend);
	if (!at)
		return 0;
	const char *digits = at + sizeof key - 1;
	const size_t length = strspn(digits, "0123456789");
	if (length == 0 || length > 4)
		return 0;
	snprintf(stem, GZ_NAME_SIZE, "%.*s%s", (int)(at - backend), backend, digits + length);
	return (int)strtol(digits, NULL, 10);
}

static double x_of(const struct gz_study *study, const struct gz_group *group,
		   enum gz_scaling_kind kind)
{
	char stem[GZ_NAME_SIZE];
	const int *dims = study->scenes[group->scene].dims, *size = study->sizes[group->size];
	switch (kind) {
	case GZ_SCALING_PIXELS:
		return (double)size[0] * size[1];
	case GZ_SCALING_VOXELS:
		return (double)dims[0] * dims[1] * dims[2];
	case GZ_SCALING_THREADS:
		return threads_of(study->backends[group->backend], stem);
	}
	return 0;
}

/* Whether two groups differ in nothing but what @p kind is about. */
static bool alike_but(const struct gz_study *study, const struct gz_group *a,
		      const struct gz_group *b, enum gz_scaling_kind kind)
{
	char stems[2][GZ_NAME_SIZE];
	switch (kind) {
	case GZ_SCALING_PIXELS:
		return a->scene == b->scene && a->backend == b->backend;
	case GZ_SCALING_VOXELS:
		return a->size == b->size && a->backend == b->backend;
	case GZ_SCALING_THREADS:
		threads_of(study->backends[a->backend], stems[0]);
		threads_of(study->backends[b->backend], stems[1]);
		return a->scene == b->scene && a->size == b->size &&
		       strcmp(stems[0], stems[1]) == 0;
	}
	return false;
}

static const struct gz_series *series_of(const struct gz_group *group, size_t variant)
{
	for (size_t i = 0; i < group->series_count; i++)
		if (group->series[i].variant == variant)
			return &group->series[i];
	return NULL;
}

static int compare_points(const void *a, const void *b)
{
	const struct gz_scaling_point *p = a, *q = b;
	return (p->x > q->x) - (p->x < q->x);
}

/* One variant from the groups that are like @p first, of which it is the first; a fit that cannot
 * be made leaves nothing. */
static enum gz_result fit_variant(struct gz_summary *summary, size_t first, size_t variant,
				  enum gz_scaling_kind kind)
{
	const struct gz_group *group = &summary->groups[first];
	struct gz_scaling scaling = { .kind = kind,
				      .variant = variant,
				      .scene = group->scene,
				      .size = group->size,
				      .backend = group->backend };
	scaling.points = calloc(summary->group_count, sizeof scaling.points[0]);
	if (!scaling.points)
		return GZ_ERR_NO_MEM;
	for (size_t i = first; i < summary->group_count; i++) {
		const struct gz_group *other = &summary->groups[i];
		const struct gz_series *series = series_of(other, variant);
		const double x = x_of(summary->study, other, kind);
		if (series && x > 0 && alike_but(summary->study, group, other, kind))
			scaling.points[scaling.point_count++] =
				(struct gz_scaling_point) { x, series->typical_ms };
	}
	qsort(scaling.points, scaling.point_count, sizeof scaling.points[0], compare_points);
	struct gz_scaling *grown = NULL;
	if (gz_scaling_fit(scaling.points, scaling.point_count, &scaling.exponent, &scaling.factor,
			   &scaling.r2)) {
		grown = realloc(summary->scalings, (summary->scaling_count + 1) * sizeof grown[0]);
		if (!grown) {
			free(scaling.points);
			return GZ_ERR_NO_MEM;
		}
		summary->scalings = grown;
		summary->scalings[summary->scaling_count++] = scaling;
	} else {
		free(scaling.points);
	}
	return GZ_OK;
}

static bool is_first_of_its_like(const struct gz_summary *summary, size_t place,
				 enum gz_scaling_kind kind)
{
	for (size_t i = 0; i < place; i++)
		if (alike_but(summary->study, &summary->groups[i], &summary->groups[place], kind))
			return false;
	return true;
}

enum gz_result gz_summary_find_scalings(struct gz_summary *summary)
{
	for (int kind = GZ_SCALING_PIXELS; kind <= GZ_SCALING_THREADS; kind++)
		for (size_t i = 0; i < summary->group_count; i++) {
			if (!is_first_of_its_like(summary, i, kind))
				continue;
			for (size_t v = 0; v < summary->study->variant_count; v++) {
				const enum gz_result result = fit_variant(summary, i, v, kind);
				if (result != GZ_OK)
					return result;
			}
		}
	return GZ_OK;
}
