#include "bench/report/summary_json.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define GZ_LOG_MODULE "report"

const double gz_equal_time_shares[GZ_EQUAL_TIMES] = { 1. / 2, 1. / 4, 1. / 8, 1. / 16 };

static json_t *number(double value)
{
	if (isnan(value))
		return json_null();
	if (isinf(value))
		return json_string(value > 0 ? "inf" : "-inf");
	return json_real(value);
}

static json_t *count(size_t value)
{
	return json_integer((json_int_t)value);
}

static json_t *distribution(const struct gz_distribution *of)
{
	if (of->count == 0)
		return json_null();
	json_t *object = json_object();
	json_object_set_new(object, "count", count(of->count));
	json_object_set_new(object, "mean", number(of->mean));
	json_object_set_new(object, "variance", number(of->variance));
	json_object_set_new(object, "least", number(of->least));
	json_object_set_new(object, "p25", number(of->p25));
	json_object_set_new(object, "median", number(of->median));
	json_object_set_new(object, "p50", number(of->median));
	json_object_set_new(object, "p75", number(of->p75));
	json_object_set_new(object, "p90", number(of->p90));
	json_object_set_new(object, "p95", number(of->p95));
	json_object_set_new(object, "p99", number(of->p99));
	json_object_set_new(object, "greatest", number(of->greatest));
	json_object_set_new(object, "sum", number(of->sum));
	json_object_set_new(object, "perceived", number(of->perceived));
	return object;
}

static json_t *errors(const struct gz_series *series)
{
	json_t *object = json_object();
	for (int reference = 0; reference < GZ_ERROR_REFERENCES; reference++) {
		json_t *all = json_object();
		for (int measure = 0; measure < GZ_ERROR_MEASURES; measure++) {
			const struct gz_error_summary *of = &series->errors[reference][measure];
			json_t *one = of->count == 0
					      ? json_null()
					      : json_pack("{s:o, s:o, s:o, s:b}", "mean",
							  number(of->mean), "p95", number(of->p95),
							  "worst", number(of->worst), "front",
							  (int)series->front[reference][measure]);
			json_object_set_new(all, gz_error_metrics[measure].key, one);
		}
		json_object_set_new(object, gz_error_reference_names[reference], all);
	}
	return object;
}

static json_t *series_to_json(const struct gz_study *study, const struct gz_series *series)
{
	const struct gz_study_variant *variant = &study->variants[series->variant];
	json_t *object = json_object();
	json_object_set_new(object, "variant", json_string(variant->text));
	json_object_set_new(object, "method", json_string(variant->method));
	json_object_set_new(object, "frames", count(series->row_count));
	json_object_set_new(object, "points", count(series->point_count));
	json_object_set_new(object, "typical_ms", number(series->typical_ms));
	json_object_set_new(object, "ratio_of_means", number(series->ratio_of_means));
	json_object_set_new(object, "ratio_of_means_95",
			    json_pack("[o, o]", number(series->ratio_interval.low),
				      number(series->ratio_interval.high)));
	json_object_set_new(object, "mean_ratio", number(series->mean_ratio));
	json_object_set_new(object, "least_ratio", number(series->least_ratio));
	json_object_set_new(object, "rays", number(series->rays));
	json_object_set_new(object, "samples", number(series->samples));
	json_object_set_new(object, "bound_share", number(series->bound_share));
	json_object_set_new(object, "efficiency", number(series->efficiency));
	for (int id = 0; id < GZ_STUDY_COLUMNS; id++)
		if (gz_study_columns[id].join == GZ_JOIN_FRAMES)
			json_object_set_new(object, gz_study_columns[id].name,
					    distribution(&series->columns[id]));
	json_object_set_new(object, "overhead_ms", distribution(&series->overhead_ms));
	json_object_set_new(object, "flicker", distribution(&series->flicker));
	json_object_set_new(object, "turning_error", distribution(&series->turning_error));
	json_object_set_new(object, "camera_path_error", distribution(&series->camera_path_error));
	json_object_set_new(object, "errors", errors(series));
	return object;
}

static json_t *variant_name(const struct gz_study *study, const struct gz_group *group,
			    size_t series)
{
	if (series == GZ_SERIES_NONE)
		return json_null();
	return json_string(study->variants[group->series[series].variant].text);
}

static json_t *equal_error(const struct gz_study *study, const struct gz_group *group)
{
	json_t *list = json_array();
	for (size_t i = 0; i < group->curve_count; i++) {
		json_t *object = json_object();
		json_object_set_new(object, "method", json_string(group->curves[i].method));
		for (int reference = 0; reference < GZ_ERROR_REFERENCES; reference++) {
			size_t series;
			const double ms = gz_curve_time_at_cost(group, &group->curves[i], reference,
								GZ_FOVEAL_FLIP,
								GZ_EQUAL_FOVEAL_FLIP, &series);
			json_object_set_new(object, gz_error_reference_names[reference],
					    json_pack("{s:o, s:o}", "ms", number(ms), "at_or_near",
						      variant_name(study, group, series)));
		}
		json_array_append_new(list, object);
	}
	return json_pack("{s:s, s:f, s:o}", "metric", "foveal_flip", "at_most",
			 GZ_EQUAL_FOVEAL_FLIP, "methods", list);
}

static json_t *equal_time(const struct gz_study *study, const struct gz_group *group)
{
	json_t *list = json_array();
	if (group->standard == GZ_SERIES_NONE)
		return list;
	const double standard_ms = group->series[group->standard].typical_ms;
	const enum gz_error_reference reference = gz_group_reference(group);
	for (size_t i = 0; i < group->curve_count; i++)
		for (int k = 0; k < GZ_EQUAL_TIMES; k++) {
			size_t series;
			const double limit_ms = gz_equal_time_shares[k] * standard_ms;
			const double cost =
				gz_curve_cost_at_time(group, &group->curves[i], reference,
						      GZ_PERCEIVED_FLIP, limit_ms, &series);
			json_array_append_new(
				list, json_pack("{s:s, s:o, s:o, s:s, s:o}", "method",
						group->curves[i].method, "at_most_ms",
						number(limit_ms), "perceived_flip", number(cost),
						"against", gz_error_reference_names[reference],
						"at_or_near", variant_name(study, group, series)));
		}
	return list;
}

static json_t *group_to_json(const struct gz_study *study, const struct gz_group *group)
{
	const struct gz_study_scene *scene = &study->scenes[group->scene];
	json_t *object = json_object();
	json_object_set_new(object, "scene", json_string(scene->name));
	json_object_set_new(object, "transfer", json_string(scene->transfer));
	json_object_set_new(
		object, "size",
		json_pack("[i, i]", study->sizes[group->size][0], study->sizes[group->size][1]));
	json_object_set_new(object, "voxels",
			    json_pack("[i, i, i]", scene->dims[0], scene->dims[1], scene->dims[2]));
	json_object_set_new(object, "backend", json_string(study->backends[group->backend]));
	json_object_set_new(object, "bound_rays", number(group->bound_share));
	json_object_set_new(object, "bound_ms", number(group->bound_ms));
	json_object_set_new(object, "noise", number(group->noise));
	json_object_set_new(object, "noise_of",
			    json_string(group->noise_of_frames ? "frames" : "points"));
	json_object_set_new(object, "reference_db", number(group->reference_db));
	json_t *list = json_array();
	for (size_t i = 0; i < group->series_count; i++)
		json_array_append_new(list, series_to_json(study, &group->series[i]));
	json_object_set_new(object, "variants", list);
	json_object_set_new(object, "equal_error", equal_error(study, group));
	json_object_set_new(object, "equal_time", equal_time(study, group));
	return object;
}

static json_t *scaling_to_json(const struct gz_study *study, const struct gz_scaling *scaling)
{
	static const char *const kinds[] = { "pixels", "voxels", "threads" };
	json_t *points = json_array();
	for (size_t i = 0; i < scaling->point_count; i++)
		json_array_append_new(
			points, json_pack("[f, f]", scaling->points[i].x, scaling->points[i].ms));
	json_t *object = json_object();
	json_object_set_new(object, "of", json_string(kinds[scaling->kind]));
	json_object_set_new(object, "variant", json_string(study->variants[scaling->variant].text));
	if (scaling->kind != GZ_SCALING_VOXELS) {
		json_object_set_new(object, "scene",
				    json_string(study->scenes[scaling->scene].name));
		json_object_set_new(object, "transfer",
				    json_string(study->scenes[scaling->scene].transfer));
	}
	if (scaling->kind != GZ_SCALING_PIXELS)
		json_object_set_new(object, "size",
				    json_pack("[i, i]", study->sizes[scaling->size][0],
					      study->sizes[scaling->size][1]));
	json_object_set_new(object, "backend", json_string(study->backends[scaling->backend]));
	json_object_set_new(object, "exponent", number(scaling->exponent));
	json_object_set_new(object, "factor", number(scaling->factor));
	json_object_set_new(object, "r2", number(scaling->r2));
	json_object_set_new(object, "points", points);
	return object;
}

static json_t *summary_machine_to_json(const struct gz_study *study)
{
	const struct gz_study_machine *machine = &study->machine;
	json_t *backends = json_object();
	for (size_t i = 0; i < study->backend_count; i++)
		json_object_set_new(backends, study->backends[i],
				    json_string(machine->backends[i]));
	json_t *object = json_object();
	json_object_set_new(object, "cpu", json_string(machine->host_cpu));
	json_object_set_new(object, "memory", json_string(machine->memory));
	json_object_set_new(object, "system", json_string(machine->system));
	json_object_set_new(object, "compiler", json_string(machine->compiler));
	json_object_set_new(object, "commit", json_string(machine->commit));
	json_object_set_new(object, "program", json_string(machine->program));
	json_object_set_new(object, "backends", backends);
	return object;
}

static json_t *head_to_json(const struct gz_study *study)
{
	json_t *object = json_object();
	json_object_set_new(object, "format", json_string(GZ_SUMMARY_FORMAT));
	json_object_set_new(object, "version", json_integer(GZ_SUMMARY_VERSION));
	json_object_set_new(object, "complete", json_boolean(study->complete));
	json_object_set_new(object, "shard",
			    json_pack("[i, i]", study->shard + 1, study->shard_count));
	json_object_set_new(object, "rows", count(study->row_count));
	json_object_set_new(object, "path", json_string(study->path));
	json_object_set_new(object, "camera_path", json_string(study->camera_path));
	json_object_set_new(object, "path_hash", json_string(study->path_hash));
	json_object_set_new(object, "points", count(study->point_count));
	json_object_set_new(object, "cameras", json_integer(study->camera_count));
	json_object_set_new(object, "frames_per_point", json_integer(study->frames_per_point));
	json_object_set_new(object, "warm_up_frames", json_integer(study->warm_up_frames));
	json_object_set_new(object, "seed", json_integer((json_int_t)study->seed));
	json_object_set_new(object, "machine", summary_machine_to_json(study));
	return object;
}

/* Put entered JOD beside what was measured. */
static void add_jods(const struct gz_summary *summary, const struct gz_group *group, json_t *object)
{
	json_t *variants = json_object_get(object, "variants");
	for (size_t i = 0; summary->jods && i < group->series_count; i++) {
		const struct gz_jod_value *value = gz_summary_jod(summary, group, i);
		json_t *variant = json_array_get(variants, i);
		json_object_set_new(variant, "jod", value ? json_real(value->jod) : json_null());
		json_object_set_new(variant, "jod_how",
				    value ? json_string(value->how) : json_null());
	}
}

json_t *gz_summary_to_json(const struct gz_summary *summary)
{
	json_t *object = head_to_json(summary->study);
	json_t *groups = json_array(), *scalings = json_array();
	for (size_t i = 0; i < summary->group_count; i++) {
		json_t *group = group_to_json(summary->study, &summary->groups[i]);
		add_jods(summary, &summary->groups[i], group);
		json_array_append_new(groups, group);
	}
	if (summary->jods)
		json_object_set_new(object, "jods", json_string(summary->jods->path));
	for (size_t i = 0; i < summary->scaling_count; i++)
		json_array_append_new(scalings,
				      scaling_to_json(summary->study, &summary->scalings[i]));
	json_object_set_new(object, "groups", groups);
	json_object_set_new(object, "scaling", scalings);
	return object;
}

enum gz_result gz_json_write(const json_t *json, const char *path, const struct gz_log *log)
{
	char part[GZ_PATH_SIZE + 8];
	snprintf(part, sizeof part, "%s.part", path);
	errno = 0;
	if (json_dump_file(json, part, JSON_INDENT(1) | JSON_REAL_PRECISION(9)) == 0 &&
	    rename(part, path) == 0)
		return GZ_OK;
	gz_err(log, "%s: cannot be written: %s", path, strerror(errno ? errno : EIO));
	unlink(part);
	return GZ_ERR_IO;
}
