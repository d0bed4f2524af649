#include "bench/report/comparison_report.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "bench/report/comparison_charts.h"
#include "bench/report/comparison_page.h"
#include "bench/report/published_times.h"
#include "bench/report/summary_json.h"

#define GZ_LOG_MODULE "report"

/* ---- sums ---- */

struct gz_comparison_summary gz_comparison_sum(const struct gz_comparison *comparison,
					       const struct gz_comparison_row *row)
{
	const struct gz_comparison_row *standard = row - row->method;
	struct gz_comparison_summary sum = { 0 };
	double *values = calloc((size_t)comparison->frames, sizeof *values);
	double whole = 0;
	for (int i = 0; i < comparison->frames; i++) {
		whole += standard->frames[i].frame_ms / comparison->frames;
		if (values)
			values[i] = row->frames[i].frame_ms;
	}
	sum.frame_ms = gz_distribution_of(values, values ? (size_t)comparison->frames : 0);
	sum.fps = 1000 / sum.frame_ms.mean;
	sum.weighted_fps = 1000 / sum.frame_ms.perceived;
	sum.ratio = whole / sum.frame_ms.mean;
	free(values);
	return sum;
}

/* ---- frames.csv ---- */

static void add_number_cell(struct gz_text *text, double value)
{
	char number[GZ_NUMBER_SIZE] = "nan";
	if (isfinite(value))
		gz_number_print(value, number);
	gz_text_add(text, ",%s", number);
}

static void add_frame(const struct gz_comparison *comparison, const struct gz_comparison_row *row,
		      int index, struct gz_text *text)
{
	const struct gz_comparison_frame *frame = &row->frames[index];
	gz_text_add(text, "\"%s\",%s,%s,%s,%d,\"%s\",%d", comparison->scenes[row->scene].name,
		    row->technique->name, row->backend, row->effect->name, row->slices,
		    comparison->methods[row->method], index);
	add_number_cell(text, frame->frame_ms);
	add_number_cell(text, frame->cast_ms);
	add_number_cell(text, frame->reconstruct_ms);
	add_number_cell(text, frame->prepare_ms);
	add_number_cell(text, frame->gpu_ms);
	gz_text_add(text, ",%llu,%llu\n", (unsigned long long)frame->rays,
		    (unsigned long long)frame->samples);
}

static enum gz_result write_frames(const struct gz_comparison *comparison, const char *folder,
				   const struct gz_log *log)
{
	char path[GZ_PATH_SIZE + 32];
	struct gz_text text = { 0 };
	gz_text_add(&text, "scene,technique,backend,effect,slices,method,frame,frame_ms,cast_ms,"
			   "reconstruct_ms,prepare_ms,gpu_ms,rays,samples\n");
	for (size_t i = 0; i < comparison->row_count; i++)
		for (int k = 0; k < comparison->frames; k++)
			add_frame(comparison, &comparison->rows[i], k, &text);
	snprintf(path, sizeof path, "%s/frames.csv", folder);
	const enum gz_result result = gz_text_write(&text, path, log);
	gz_text_free(&text);
	return result;
}

/* ---- techniques.json ---- */

static json_t *number_json(double value)
{
	return isfinite(value) ? json_real(value) : isnan(value) ? json_null() : json_string("inf");
}

static json_t *errors_json(const struct gz_study_errors *errors)
{
	return json_pack("{so so so so so so}", "psnr_db", number_json(errors->psnr_db), "ssim",
			 number_json(errors->ssim), "flip", number_json(errors->flip),
			 "foveal_flip", number_json(errors->foveal_flip), "perceived_flip",
			 number_json(errors->perceived_flip), "perceived_psnr_db",
			 number_json(errors->perceived_psnr_db));
}

static const char *const reference_names[] = {
	[GZ_REFERENCE_NONE] = "none",
	[GZ_REFERENCE_VOLUME] = "volume",
	[GZ_REFERENCE_SURFACE] = "surface",
	[GZ_REFERENCE_VOXELS] = "voxels",
};

static json_t *row_json(const struct gz_comparison *comparison, const struct gz_comparison_row *row)
{
	const struct gz_comparison_summary sum = gz_comparison_sum(comparison, row);
	const struct gz_comparison_frame *frame = &row->frames[0];
	return json_pack(
		"{ss ss ss ss ss si ss so so so so so so so so so sI sI ss so so}", "scene",
		comparison->scenes[row->scene].name, "technique", row->technique->name, "backend",
		row->backend, "device", row->device, "effect", row->effect->name, "slices",
		row->slices, "method", comparison->methods[row->method], "prepare_ms",
		number_json(row->prepare_ms), "mean_ms", number_json(sum.frame_ms.mean),
		"weighted_ms", number_json(sum.frame_ms.perceived), "least_ms",
		number_json(sum.frame_ms.least), "median_ms", number_json(sum.frame_ms.median),
		"greatest_ms", number_json(sum.frame_ms.greatest), "fps", number_json(sum.fps),
		"weighted_fps", number_json(sum.weighted_fps), "ratio", number_json(sum.ratio),
		"rays", (json_int_t)frame->rays, "samples", (json_int_t)frame->samples, "reference",
		reference_names[row->reference], "converged", errors_json(&row->converged),
		"standard", errors_json(&row->standard));
}

static json_t *gap_json(const struct gz_comparison *comparison, const struct gz_comparison_gap *gap)
{
	return json_pack("{ss ss ss ss ss}", "scene", comparison->scenes[gap->scene].name,
			 "technique", gap->technique->name, "backend", gap->backend, "effect",
			 gap->effect->name, "why",
			 gap->why == GZ_ABSENT_BACKEND ? "does not run here"
						       : "refused, or changes nothing");
}

static json_t *scene_json(const struct gz_comparison_scene *scene)
{
	return json_pack("{ss ss s[iii] so ss so}", "name", scene->name, "path", scene->path,
			 "dims", scene->dims[0], scene->dims[1], scene->dims[2], "isovalue",
			 number_json(scene->isovalue), "data_hash", scene->data_hash,
			 "reference_db", number_json(scene->reference_db));
}

static json_t *machine_json(const struct gz_study_machine *machine)
{
	return json_pack("{ss ss ss ss ss ss}", "host_cpu", machine->host_cpu, "memory",
			 machine->memory, "system", machine->system, "compiler", machine->compiler,
			 "program", machine->program, "commit", machine->commit);
}

json_t *gz_comparison_to_json(const struct gz_comparison *comparison)
{
	json_t *scenes = json_array(), *methods = json_array(), *rows = json_array();
	json_t *gaps = json_array();
	for (size_t i = 0; i < comparison->scene_count; i++)
		json_array_append_new(scenes, scene_json(&comparison->scenes[i]));
	for (size_t i = 0; i < comparison->method_count; i++)
		json_array_append_new(methods, json_string(comparison->methods[i]));
	for (size_t i = 0; i < comparison->row_count; i++)
		json_array_append_new(rows, row_json(comparison, &comparison->rows[i]));
	for (size_t i = 0; i < comparison->gap_count; i++)
		json_array_append_new(gaps, gap_json(comparison, &comparison->gaps[i]));
	return json_pack("{ss si s[ii] si si so ss so so so so so so}", "format",
			 GZ_COMPARISON_FORMAT, "version", GZ_COMPARISON_VERSION, "size",
			 comparison->width, comparison->height, "frames", comparison->frames,
			 "warm_up", comparison->warm_up, "turn_deg",
			 number_json(comparison->camera_path[0] ? NAN : comparison->turn_deg),
			 "camera_path", comparison->camera_path, "machine",
			 machine_json(&comparison->machine), "scenes", scenes, "methods", methods,
			 "rows", rows, "absent", gaps, "published", gz_published_times());
}

/* ---- the table of the terminal ---- */

static void print_cell(double value, const char *format, FILE *file)
{
	if (isnan(value))
		fprintf(file, " %9s", "-");
	else
		fprintf(file, format, value);
}

static void print_row(const struct gz_comparison *comparison, const struct gz_comparison_row *row,
		      FILE *file)
{
	const struct gz_comparison_summary sum = gz_comparison_sum(comparison, row);
	char slices[16] = "";
	if (row->slices > 0)
		snprintf(slices, sizeof slices, "%d", row->slices);
	fprintf(file, "  %-10s %-3s %-10s %6s  %-20.20s", row->technique->name, row->backend,
		row->effect->name, slices, comparison->methods[row->method]);
	print_cell(row->prepare_ms, " %9.1f", file);
	print_cell(sum.frame_ms.mean, " %9.2f", file);
	print_cell(sum.frame_ms.perceived, " %9.2f", file);
	print_cell(sum.fps, " %9.1f", file);
	print_cell(sum.ratio, " %9.2f", file);
	print_cell(row->converged.psnr_db, " %9.2f", file);
	print_cell(row->converged.flip, " %9.4f", file);
	print_cell(row->standard.perceived_flip, " %9.4f", file);
	fputc('\n', file);
}

static void print_gaps(const struct gz_comparison *comparison, size_t scene, FILE *file)
{
	for (size_t i = 0; i < comparison->gap_count; i++) {
		const struct gz_comparison_gap *gap = &comparison->gaps[i];
		if (gap->scene != scene)
			continue;
		if (gap->why == GZ_ABSENT_BACKEND)
			fprintf(file, "  %s %s: does not run here\n", gap->technique->name,
				gap->backend);
		else
			fprintf(file, "  %s %s: no %s, or it changes nothing here\n",
				gap->technique->name, gap->backend, gap->effect->words);
	}
}

void gz_comparison_print(const struct gz_comparison *comparison, FILE *file)
{
	for (size_t i = 0; i < comparison->scene_count; i++) {
		const struct gz_comparison_scene *scene = &comparison->scenes[i];
		fprintf(file, "%s, isovalue %.6g, %dx%d, %d frames\n", scene->name, scene->isovalue,
			comparison->width, comparison->height, comparison->frames);
		fprintf(file, "  %-10s %-3s %-10s %6s  %-20s %9s %9s %9s %9s %9s %9s %9s %9s\n",
			"technique", "by", "effect", "slices", "method", "once, ms", "mean, ms",
			"weighted", "fps", "faster", "PSNR, dB", "FLIP", "foveated");
		for (size_t k = 0; k < comparison->row_count; k++)
			if (comparison->rows[k].scene == i)
				print_row(comparison, &comparison->rows[k], file);
		print_gaps(comparison, i, file);
	}
}

/* ---- the folder ---- */

static enum gz_result write_json(const struct gz_comparison *comparison, const char *folder,
				 const struct gz_log *log)
{
	char path[GZ_PATH_SIZE + 32];
	json_t *json = gz_comparison_to_json(comparison);
	if (!json) {
		gz_err(log, "%s: no summary: %s", folder, gz_result_text(GZ_ERR_NO_MEM));
		return GZ_ERR_NO_MEM;
	}
	snprintf(path, sizeof path, "%s/techniques.json", folder);
	const enum gz_result result = gz_json_write(json, path, log);
	json_decref(json);
	return result;
}

static enum gz_result write_comparison_page(const struct gz_comparison *comparison,
					    const struct gz_charts *charts, const char *folder,
					    const struct gz_log *log)
{
	char path[GZ_PATH_SIZE + 32];
	struct gz_text page = { 0 };
	gz_comparison_page_write(comparison, charts, &page);
	snprintf(path, sizeof path, "%s/report.html", folder);
	const enum gz_result result = gz_text_write(&page, path, log);
	gz_text_free(&page);
	return result;
}

enum gz_result gz_comparison_write(const struct gz_comparison *comparison, const char *folder,
				   const struct gz_log *log)
{
	struct gz_charts charts = { 0 };
	enum gz_result result = write_frames(comparison, folder, log);
	if (result == GZ_OK)
		result = write_json(comparison, folder, log);
	if (result == GZ_OK)
		result = gz_charts_open(folder, log, &charts);
	if (result == GZ_OK)
		result = gz_comparison_charts_draw(comparison, &charts);
	if (result == GZ_OK)
		result = write_comparison_page(comparison, &charts, folder, log);
	gz_charts_close(&charts);
	return result;
}
