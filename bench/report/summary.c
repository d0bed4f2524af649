#include "bench/report/summary.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bench/report/summary_parts.h"

/* Distribution of a column of @p rows; @p room for all of them. */
static struct gz_distribution join_column(const struct gz_study_row *const *rows, size_t count,
					  enum gz_study_column_id column, double *room)
{
	for (size_t i = 0; i < count; i++)
		room[i] = gz_study_column_value(column, rows[i]);
	return gz_distribution_of(room, count);
}

/* Of each frame what it takes beside casting. */
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
	series->points = calloc(points, sizeof series->points[0]);
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
	return GZ_OK;
}

/* Against standard, over the points that both have; points are sorted. */
static void compare_with_standard(const struct gz_series *standard, struct gz_series *series)
{
	double of_standard = 0, of_series = 0, ratios = 0, least = INFINITY;
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
		common++;
	}
	if (common == 0)
		return;
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

static void relate(const struct gz_study *study, struct gz_group *group)
{
	const int *size = study->sizes[group->size];
	const double pixels = (double)size[0] * size[1];
	for (size_t i = 0; i < group->series_count; i++) {
		struct gz_series *series = &group->series[i];
		series->ratio_of_means = series->mean_ratio = series->least_ratio = NAN;
		if (group->standard != GZ_SERIES_NONE)
			compare_with_standard(&group->series[group->standard], series);
		series->bound_share = series->rays / (mean_bound(study, group, series) * pixels);
	}
	group->bound_share = mean_bound(study, group, &group->series[0]);
	group->bound_ms = group->standard == GZ_SERIES_NONE
				  ? NAN
				  : group->series[group->standard].typical_ms * group->bound_share;
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

static enum gz_result fill_group(const struct gz_study *study, const struct gz_study_row *rows,
				 size_t count, struct gz_group *group)
{
	enum gz_result result = GZ_OK;
	const struct gz_study_row **picked = calloc(count, sizeof(void *));
	double *room = calloc(count, sizeof room[0]);
	group->series = calloc(study->variant_count, sizeof group->series[0]);
	if (!picked || !room || !group->series)
		result = GZ_ERR_NO_MEM;
	for (size_t v = 0; v < study->variant_count && result == GZ_OK; v++) {
		const size_t found = pick(rows, count, v, picked);
		if (found == 0)
			continue;
		if (strcmp(study->variants[v].text, "standard") == 0)
			group->standard = group->series_count;
		group->series[group->series_count].variant = v;
		result = fill_series(&group->series[group->series_count++], picked, found, room);
	}
	free(picked);
	free(room);
	if (result != GZ_OK)
		return result;
	group->reference_db = NAN;
	for (size_t i = 0; i < count; i++)
		group->reference_db = fmin(group->reference_db, rows[i].reference_db);
	relate(study, group);
	gz_group_find_fronts(group);
	return gz_group_find_curves(study, group);
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
					     .standard = GZ_SERIES_NONE };
		result = fill_group(study, row, end - i, group);
	}
	if (result == GZ_OK)
		result = gz_summary_find_scalings(&summary);
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
