#include "bench/report/summary.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Distribution of a column of @p rows; @p room for all of them. */
static struct gz_distribution join_column(const struct gz_study_row *const *rows, size_t count,
					  enum gz_study_column_id column, double *room)
{
	for (size_t i = 0; i < count; i++)
		room[i] = gz_study_column_value(column, rows[i]);
	return gz_distribution_of(room, count);
}

/* Frame time besides casting. */
static struct gz_distribution join_overhead(const struct gz_study_row *const *rows, size_t count,
					    double *room)
{
	for (size_t i = 0; i < count; i++)
		room[i] = rows[i]->frame_ms - rows[i]->cast_ms;
	return gz_distribution_of(room, count);
}

static double mean_column(const struct gz_study_row *const *rows, size_t count,
			  enum gz_study_column_id column)
{
	double mean = 0;
	for (size_t i = 0; i < count; i++)
		mean += gz_study_column_value(column, rows[i]) / (double)count;
	return mean;
}

static struct gz_series_point point_of(const struct gz_study_row *const *rows, size_t count,
				       double *room)
{
	const struct gz_study_row *first = rows[0];
	struct gz_series_point point = {
		.point = first->point,
		.gaze = first->gaze,
		.errors = { [GZ_AGAINST_CONVERGED] = first->converged,
			    [GZ_AGAINST_STANDARD] = first->standard },
		.flicker = first->flicker,
		.turning_error = first->turning_error,
		.camera_path_error = first->camera_path_error,
	};
	point.frame_ms = join_column(rows, count, GZ_COLUMN_FRAME, room).median;
	point.cast_ms = join_column(rows, count, GZ_COLUMN_CAST, room).median;
	point.rays = mean_column(rows, count, GZ_COLUMN_RAYS);
	point.samples = mean_column(rows, count, GZ_COLUMN_SAMPLES);
	return point;
}

static enum gz_result find_points(struct gz_series *series, const struct gz_study_row *const *rows,
				  size_t count, double *room)
{
	size_t points = 0;
	for (size_t i = 0; i < count; i++)
		points += i == 0 || rows[i]->point != rows[i - 1]->point;
	series->points = calloc(points > 0 ? points : 1, sizeof series->points[0]);
	if (!series->points)
		return GZ_ERR_NO_MEM;
	for (size_t i = 0, end; i < count; i = end) {
		for (end = i + 1; end < count && rows[end]->point == rows[i]->point;)
			end++;
		series->points[series->point_count++] = point_of(rows + i, end - i, room);
	}
	return GZ_OK;
}

static void average_points(struct gz_series *series)
{
	const double share = 1 / (double)series->point_count;
	for (size_t i = 0; i < series->point_count; i++) {
		series->typical_ms += series->points[i].frame_ms * share;
		series->rays += series->points[i].rays * share;
		series->samples += series->points[i].samples * share;
	}
}

static struct gz_error_summary summarise_errors(const struct gz_series *series,
						enum gz_error_reference reference,
						enum gz_error_measure measure, double *room)
{
	const enum gz_error_kind kind = gz_error_metrics[measure].kind;
	for (size_t i = 0; i < series->point_count; i++)
		room[i] = gz_error_cost(
			kind, gz_error_value(measure, &series->points[i].errors[reference]));
	const struct gz_distribution cost = gz_distribution_of(room, series->point_count);
	return (struct gz_error_summary) {
		.count = cost.count,
		.mean = gz_error_of_cost(kind, cost.mean),
		.p95 = gz_error_of_cost(kind, cost.p95),
		.worst = gz_error_of_cost(kind, cost.greatest),
	};
}

static enum gz_result fill_series(struct gz_series *series, const struct gz_study_row *const *rows,
				  size_t count, double *room)
{
	series->row_count = count;
	for (int id = 0; id < GZ_STUDY_COLUMNS; id++)
		if (gz_study_columns[id].join == GZ_JOIN_FRAMES)
			series->columns[id] = join_column(rows, count, id, room);
	series->overhead_ms = join_overhead(rows, count, room);
	const enum gz_result result = find_points(series, rows, count, room);
	if (result != GZ_OK)
		return result;
	average_points(series);
	for (int reference = 0; reference < GZ_ERROR_REFERENCES; reference++)
		for (int measure = 0; measure < GZ_ERROR_MEASURES; measure++)
			series->errors[reference][measure] =
				summarise_errors(series, reference, measure, room);
	for (size_t i = 0; i < series->point_count; i++)
		room[i] = series->points[i].flicker;
	series->flicker = gz_distribution_of(room, series->point_count);
	for (size_t i = 0; i < series->point_count; i++)
		room[i] = series->points[i].turning_error;
	series->turning_error = gz_distribution_of(room, series->point_count);
	for (size_t i = 0; i < series->point_count; i++)
		room[i] = series->points[i].camera_path_error;
	series->camera_path_error = gz_distribution_of(room, series->point_count);
	return GZ_OK;
}

/* Against standard, over the points that both have; points are sorted. @p room for two times of
 * each point. */
static void compare_with_standard(const struct gz_series *standard, struct gz_series *series,
				  double *room)
{
	double of_standard = 0, of_series = 0, ratios = 0, least = INFINITY;
	double *over = room, *under = room + series->point_count;
	size_t common = 0;
	for (size_t i = 0, k = 0; i < series->point_count; i++) {
		while (k < standard->point_count &&
		       standard->points[k].point < series->points[i].point)
			k++;
		if (k == standard->point_count ||
		    standard->points[k].point != series->points[i].point)
			continue;
		const double ratio = standard->points[k].frame_ms / series->points[i].frame_ms;
		of_standard += standard->points[k].frame_ms;
		of_series += series->points[i].frame_ms;
		ratios += ratio;
		least = fmin(least, ratio);
		over[common] = standard->points[k].frame_ms;
		under[common++] = series->points[i].frame_ms;
	}
	if (common == 0)
		return;
	series->ratio_interval = gz_ratio_interval(over, under, common);
	series->ratio_of_means = of_standard / of_series;
	series->mean_ratio = ratios / (double)common;
	series->least_ratio = least;
}

/* Mean share of the bound over the points of @p series; NaN if the study has none. */
static double mean_bound(const struct gz_study *study, const struct gz_group *group,
			 const struct gz_series *series)
{
	if (!study->bound_rays)
		return NAN;
	const double *bound = study->bound_rays +
			      (group->scene * study->size_count + group->size) * study->point_count;
	double sum = 0;
	for (size_t i = 0; i < series->point_count; i++)
		sum += bound[series->points[i].point];
	return sum / (double)series->point_count;
}

/* Of standard: the noise of the times of its points by camera. NaN if all cameras differ. */
static double noise_of_points(const struct gz_study *study, const struct gz_series *standard)
{
	struct gz_kind_time *times = calloc(standard->point_count, sizeof times[0]);
	if (!times)
		return NAN;
	for (size_t i = 0; i < standard->point_count; i++)
		times[i] = (struct gz_kind_time) {
			study->points[standard->points[i].point].camera,
			standard->points[i].frame_ms,
		};
	const double noise = gz_noise_of(times, standard->point_count);
	free(times);
	return noise;
}

/* The same of the frames of each point. */
static double noise_of_frames(const struct gz_study_row *const *rows, size_t count)
{
	struct gz_kind_time *times = calloc(count, sizeof times[0]);
	if (!times)
		return NAN;
	for (size_t i = 0; i < count; i++)
		times[i] = (struct gz_kind_time) { rows[i]->point, rows[i]->frame_ms };
	const double noise = gz_noise_of(times, count);
	free(times);
	return noise;
}

/* @p rows are those of standard. */
static void find_noise(const struct gz_study *study, struct gz_group *group,
		       const struct gz_study_row *const *rows, size_t count)
{
	group->noise = noise_of_points(study, &group->series[group->standard]);
	group->noise_of_frames = isnan(group->noise);
	if (group->noise_of_frames)
		group->noise = noise_of_frames(rows, count);
}

static void relate(const struct gz_study *study, struct gz_group *group, double *room)
{
	const int *size = study->sizes[group->size];
	const double pixels = (double)size[0] * size[1];
	for (size_t i = 0; i < group->series_count; i++) {
		struct gz_series *series = &group->series[i];
		series->ratio_of_means = series->mean_ratio = series->least_ratio = NAN;
		series->ratio_interval = (struct gz_interval) { NAN, NAN };
		if (group->standard != GZ_SERIES_NONE)
			compare_with_standard(&group->series[group->standard], series, room);
		series->bound_share = series->rays / (mean_bound(study, group, series) * pixels);
	}
	group->bound_share = mean_bound(study, group, &group->series[0]);
	group->bound_ms = group->standard == GZ_SERIES_NONE
				  ? NAN
				  : group->series[group->standard].typical_ms * group->bound_share;
	for (size_t i = 0; i < group->series_count; i++)
		group->series[i].efficiency =
			(study->machine.copy_ms[group->size] + group->bound_ms) /
			group->series[i].typical_ms;
}

/* The rows of one variant among those of a group; they stay sorted. */
static size_t pick(const struct gz_study_row *rows, size_t count, size_t variant,
		   const struct gz_study_row **picked)
{
	size_t found = 0;
	for (size_t i = 0; i < count; i++)
		if (rows[i].variant == variant)
			picked[found++] = &rows[i];
	return found;
}

/* ---- fronts and curves ---- */

/* Mean cost of a series; NaN where it was not measured. */
static double mean_cost(const struct gz_series *series, enum gz_error_reference reference,
			enum gz_error_measure measure)
{
	return gz_error_cost(gz_error_metrics[measure].kind,
			     series->errors[reference][measure].mean);
}

static bool on_front(const struct gz_group *group, size_t place, enum gz_error_reference reference,
		     enum gz_error_measure measure)
{
	const double ms = group->series[place].typical_ms;
	const double cost = mean_cost(&group->series[place], reference, measure);
	if (isnan(cost))
		return false;
	for (size_t i = 0; i < group->series_count; i++) {
		const double other_ms = group->series[i].typical_ms;
		const double other = mean_cost(&group->series[i], reference, measure);
		if (other_ms <= ms && other <= cost && (other_ms < ms || other < cost))
			return false;
	}
	return true;
}

static void find_fronts(struct gz_group *group)
{
	for (size_t i = 0; i < group->series_count; i++)
		for (int reference = 0; reference < GZ_ERROR_REFERENCES; reference++)
			for (int measure = 0; measure < GZ_ERROR_MEASURES; measure++)
				group->series[i].front[reference][measure] =
					on_front(group, i, reference, measure);
}

static struct gz_curve *curve_of(struct gz_group *group, const char *method)
{
	for (size_t i = 0; i < group->curve_count; i++)
		if (group->curves[i].method && strcmp(group->curves[i].method, method) == 0)
			return &group->curves[i];
	return NULL;
}

/* Insert a series into a curve behind those that take more samples. */
static void insert_series(const struct gz_group *group, struct gz_curve *curve, size_t place)
{
	size_t at = curve->count++;
	for (; at > 0; at--) {
		if (group->series[curve->series[at - 1]].samples >= group->series[place].samples)
			break;
		curve->series[at] = curve->series[at - 1];
	}
	curve->series[at] = place;
}

static enum gz_result find_curves(const struct gz_study *study, struct gz_group *group)
{
	group->curves =
		calloc(group->series_count > 0 ? group->series_count : 1, sizeof group->curves[0]);
	if (!group->curves)
		return GZ_ERR_NO_MEM;
	for (size_t i = 0; i < group->series_count; i++) {
		const char *method = study->variants[group->series[i].variant].method;
		struct gz_curve *curve = curve_of(group, method);
		if (!curve) {
			size_t *room = calloc(group->series_count, sizeof room[0]);
			if (!room)
				return GZ_ERR_NO_MEM;
			curve = &group->curves[group->curve_count++];
			*curve = (struct gz_curve) { .method = method, .series = room };
		}
		insert_series(group, curve, i);
	}
	return GZ_OK;
}

enum gz_error_reference gz_group_reference(const struct gz_group *group)
{
	for (size_t i = 0; i < group->series_count; i++)
		for (int measure = 0; measure < GZ_ERROR_MEASURES; measure++)
			if (group->series[i].errors[GZ_AGAINST_CONVERGED][measure].count > 0)
				return GZ_AGAINST_CONVERGED;
	return GZ_AGAINST_STANDARD;
}

/* A place on a curve, and the best one so far. */
struct place {
	double limited, wanted; /* the limited value, and the one to be least */
	size_t series;
};

static void take_curve(struct place *best, double wanted, size_t series)
{
	if (isnan(best->wanted) || wanted < best->wanted) {
		best->wanted = wanted;
		best->series = series;
	}
}

/* The least "wanted" where "limited" is at most @p limit, along the line through @p places. */
static struct place least_within(const struct place *places, size_t count, double limit)
{
	struct place best = { NAN, NAN, GZ_SERIES_NONE };
	for (size_t i = 0; i < count; i++) {
		const struct place *here = &places[i], *next = here + 1;
		if (here->limited <= limit)
			take_curve(&best, here->wanted, here->series);
		if (i + 1 == count || (here->limited <= limit) == (next->limited <= limit))
			continue;
		const double share = (limit - here->limited) / (next->limited - here->limited);
		take_curve(&best, here->wanted + share * (next->wanted - here->wanted),
			   here->series);
	}
	return best;
}

/* A limit on the cost or on the time of a curve. */
struct curve_limit {
	enum gz_error_reference reference;
	enum gz_error_measure measure;
	bool of_cost;
	double limit;
};

/* The least value of the other quantity. */
static double least_on_curve(const struct gz_group *group, const struct gz_curve *curve,
			     const struct curve_limit *limit, size_t *out_series)
{
	struct place *places = calloc(curve->count, sizeof places[0]);
	if (!places)
		return NAN;
	size_t count = 0;
	for (size_t i = 0; i < curve->count; i++) {
		const struct gz_series *series = &group->series[curve->series[i]];
		const double cost = mean_cost(series, limit->reference, limit->measure);
		if (isnan(cost))
			continue;
		places[count++] = (struct place) { limit->of_cost ? cost : series->typical_ms,
						   limit->of_cost ? series->typical_ms : cost,
						   curve->series[i] };
	}
	const struct place best = least_within(places, count, limit->limit);
	free(places);
	*out_series = best.series;
	return best.wanted;
}

double gz_curve_time_at_cost(const struct gz_group *group, const struct gz_curve *curve,
			     enum gz_error_reference reference, enum gz_error_measure measure,
			     double cost, size_t *out_series)
{
	const struct curve_limit limit = { reference, measure, true, cost };
	return least_on_curve(group, curve, &limit, out_series);
}

double gz_curve_cost_at_time(const struct gz_group *group, const struct gz_curve *curve,
			     enum gz_error_reference reference, enum gz_error_measure measure,
			     double limit_ms, size_t *out_series)
{
	const struct curve_limit limit = { reference, measure, false, limit_ms };
	return least_on_curve(group, curve, &limit, out_series);
}

/* Whether a series has an error within @p cost at every point; one without an error says nothing.
 */
static bool holds_everywhere(const struct gz_series *series, enum gz_error_reference reference,
			     enum gz_error_measure measure, double cost)
{
	const struct gz_error_summary *errors = &series->errors[reference][measure];
	return errors->count == series->point_count &&
	       gz_error_cost(gz_error_metrics[measure].kind, errors->worst) <= cost;
}

size_t gz_group_cheapest_within(const struct gz_group *group, enum gz_error_reference reference,
				enum gz_error_measure measure, double cost)
{
	size_t best = GZ_SERIES_NONE;
	for (size_t i = 0; i < group->series_count; i++) {
		const struct gz_series *series = &group->series[i];
		if (!holds_everywhere(series, reference, measure, cost))
			continue;
		if (best == GZ_SERIES_NONE || series->typical_ms < group->series[best].typical_ms)
			best = i;
	}
	return best;
}

size_t gz_group_rival(const struct gz_group *group, size_t series,
		      enum gz_error_reference reference, enum gz_error_measure measure, double cost)
{
	size_t rival = GZ_SERIES_NONE;
	double least = group->noise;
	for (size_t i = 0; i < group->series_count; i++) {
		const double apart =
			fabs(log(group->series[i].typical_ms / group->series[series].typical_ms));
		if (i == series || !(apart < least) ||
		    !holds_everywhere(&group->series[i], reference, measure, cost))
			continue;
		rival = i;
		least = apart;
	}
	return rival;
}

static enum gz_result fill_group(const struct gz_study *study, const struct gz_study_row *rows,
				 size_t count, struct gz_group *group)
{
	enum gz_result result = GZ_OK;
	const struct gz_study_row **picked = calloc(count, sizeof(void *));
	double *room = calloc(2 * count, sizeof room[0]); /* for two values of each point, too */
	group->series = calloc(study->variant_count, sizeof group->series[0]);
	if (!picked || !room || !group->series)
		result = GZ_ERR_NO_MEM;
	for (size_t v = 0; v < study->variant_count && result == GZ_OK; v++) {
		const size_t found = pick(rows, count, v, picked);
		if (found == 0)
			continue;
		group->series[group->series_count].variant = v;
		result = fill_series(&group->series[group->series_count++], picked, found, room);
		if (result == GZ_OK && strcmp(study->variants[v].text, "standard") == 0) {
			group->standard = group->series_count - 1;
			find_noise(study, group, picked, found);
		}
	}
	if (result == GZ_OK)
		relate(study, group, room);
	free(picked);
	free(room);
	if (result != GZ_OK)
		return result;
	group->reference_db = NAN;
	for (size_t i = 0; i < count; i++)
		group->reference_db = fmin(group->reference_db, rows[i].reference_db);
	find_fronts(group);
	return find_curves(study, group);
}

/* ---- growth ---- */

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

static const struct gz_series *find_series(const struct gz_group *group, size_t variant)
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
		const struct gz_series *series = find_series(other, variant);
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

static enum gz_result find_scalings(struct gz_summary *summary)
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

static bool same_group(const struct gz_study_row *a, const struct gz_study_row *b)
{
	return a->scene == b->scene && a->size == b->size && a->backend == b->backend;
}

/* Negative, 0 or positive as @p a belongs before, with or behind @p b. */
static int order(const struct gz_study_row *a, const struct gz_study_row *b)
{
	const int64_t keys[][2] = { { a->scene, b->scene },     { a->size, b->size },
				    { a->backend, b->backend }, { a->point, b->point },
				    { a->variant, b->variant }, { a->frame, b->frame } };
	for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++)
		if (keys[i][0] != keys[i][1])
			return keys[i][0] < keys[i][1] ? -1 : 1;
	return 0;
}

static bool rows_are_sound(const struct gz_study *study)
{
	for (size_t i = 0; i < study->row_count; i++) {
		const struct gz_study_row *row = &study->rows[i];
		if (row->scene >= study->scene_count || row->size >= study->size_count ||
		    row->backend >= study->backend_count || row->variant >= study->variant_count ||
		    row->point >= study->point_count || (i > 0 && order(row - 1, row) >= 0))
			return false;
	}
	return true;
}

static size_t count_groups(const struct gz_study *study)
{
	size_t groups = 0;
	for (size_t i = 0; i < study->row_count; i++)
		groups += i == 0 || !same_group(&study->rows[i - 1], &study->rows[i]);
	return groups;
}

enum gz_result gz_summary_make(const struct gz_study *study, struct gz_summary *out_summary)
{
	if (study->row_count == 0)
		return GZ_ERR_END;
	if (!rows_are_sound(study))
		return GZ_ERR_INVAL;
	struct gz_summary summary = { .study = study };
	summary.groups = calloc(count_groups(study), sizeof summary.groups[0]);
	enum gz_result result = summary.groups ? GZ_OK : GZ_ERR_NO_MEM;
	for (size_t i = 0, end; i < study->row_count && result == GZ_OK; i = end) {
		const struct gz_study_row *row = &study->rows[i];
		for (end = i + 1; end < study->row_count && same_group(row, &study->rows[end]);)
			end++;
		struct gz_group *group = &summary.groups[summary.group_count++];
		*group = (struct gz_group) { .scene = row->scene,
					     .size = row->size,
					     .backend = row->backend,
					     .standard = GZ_SERIES_NONE,
					     .noise = NAN };
		result = fill_group(study, row, end - i, group);
	}
	if (result == GZ_OK)
		result = find_scalings(&summary);
	if (result == GZ_OK)
		*out_summary = summary;
	else
		gz_summary_free(&summary);
	return result;
}

static void free_group(struct gz_group *group)
{
	for (size_t i = 0; i < group->series_count; i++)
		free(group->series[i].points);
	for (size_t i = 0; i < group->curve_count; i++)
		free(group->curves[i].series);
	free(group->series);
	free(group->curves);
}

const struct gz_jod_value *gz_summary_jod(const struct gz_summary *summary,
					  const struct gz_group *group, size_t series)
{
	const struct gz_study *study = summary->study;
	return gz_jod_table_find(summary->jods, study->scenes[group->scene].name,
				 study->variants[group->series[series].variant].text);
}

void gz_summary_free(struct gz_summary *summary)
{
	for (size_t i = 0; i < summary->group_count; i++)
		free_group(&summary->groups[i]);
	for (size_t i = 0; i < summary->scaling_count; i++)
		free(summary->scalings[i].points);
	free(summary->groups);
	free(summary->scalings);
	*summary = (struct gz_summary) { 0 };
}
