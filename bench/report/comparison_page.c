#include "bench/report/comparison_page.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench/report/comparison_charts.h"
#include "bench/report/comparison_report.h"
#include "bench/report/page_parts.h"
#include "bench/report/published_times.h"
#include "bench/report/template.h"
#include "render/scene/techniques.h"

/* comparison.html, embedded. */
extern const char gz_comparison_html[];

/* The page is comparison.html filled from techniques.json, to which what follows adds names that
 * people read, charts and the table beside printed times. */

/* "slices gl, 64 slices, shadow" */
static void series_words(const struct gz_comparison_row *row, char out_words[GZ_NAMES_SIZE])
{
	char slices[GZ_NAME_SIZE] = "";
	const bool none = row->effect == &gz_effects[0];
	if (row->slices > 0)
		snprintf(slices, sizeof slices, ", %d slices", row->slices);
	snprintf(out_words, GZ_NAMES_SIZE, "%s %s%s%s%s", row->technique->name, row->backend,
		 slices, none ? "" : ", ", none ? "" : row->effect->words);
}

/* ---- the answer ---- */

/* What wins among the rows of a scene without effects. */
struct winners {
	const struct gz_comparison_row *fastest, *closest;
	double fastest_ms;
};

static struct winners find_winners(const struct gz_comparison *comparison, size_t scene)
{
	struct winners winners = { .fastest_ms = INFINITY };
	for (size_t i = 0; i < comparison->row_count; i++) {
		const struct gz_comparison_row *row = &comparison->rows[i];
		if (row->scene != scene || row->effect != &gz_effects[0])
			continue;
		const double ms = gz_comparison_sum(comparison, row).frame_ms.mean;
		if (ms < winners.fastest_ms) {
			winners.fastest = row;
			winners.fastest_ms = ms;
		}
		if (row->reference == GZ_REFERENCE_VOLUME &&
		    (!winners.closest || row->converged.flip < winners.closest->converged.flip))
			winners.closest = row;
	}
	return winners;
}

static void set_answer(const struct gz_comparison *comparison, size_t scene, json_t *object)
{
	char words[GZ_NAMES_SIZE], text[4 * GZ_NAMES_SIZE] = "Nothing draws this scene here.";
	const struct winners winners = find_winners(comparison, scene);
	if (winners.fastest) {
		series_words(winners.fastest, words);
		const int used = snprintf(
			text, sizeof text,
			"The fastest without an effect is %s, by %s: %.3g ms a frame.", words,
			comparison->methods[winners.fastest->method], winners.fastest_ms);
		if (winners.closest) {
			series_words(winners.closest, words);
			snprintf(text + used, sizeof text - (size_t)used,
				 " Of what shows the whole volume, %s, by %s, is closest to the "
				 "converged ray cast: %.3g dB, FLIP %.3g.",
				 words, comparison->methods[winners.closest->method],
				 winners.closest->converged.psnr_db,
				 winners.closest->converged.flip);
		}
	}
	gz_page_set_text(object, "answer", text);
}

/* ---- beside printed times ---- */

/* A line of the table: one of technique, effect and slices. */
struct printed_key {
	const struct gz_technique *technique;
	const struct gz_effect *effect;
	int slices;
};

static double our_ms(const struct gz_comparison *comparison, size_t scene,
		     const struct printed_key *key, const char *backend, size_t method)
{
	for (size_t i = 0; i < comparison->row_count; i++) {
		const struct gz_comparison_row *row = &comparison->rows[i];
		if (row->scene == scene && row->technique == key->technique &&
		    row->effect == key->effect && row->slices == key->slices &&
		    row->method == method && strcmp(row->backend, backend) == 0)
			return gz_comparison_sum(comparison, row).frame_ms.mean;
	}
	return NAN;
}

static bool add_time_cell(json_t *cells, double ms)
{
	json_array_append_new(cells, isnan(ms) ? json_null() : json_real(ms));
	return !isnan(ms);
}

/* Names of backends that some row has, in the order of the techniques' tables. */
static size_t list_backends(const struct gz_comparison *comparison, const char *out_names[8])
{
	size_t count = 0;
	for (size_t i = 0; i < comparison->row_count; i++) {
		size_t k = 0;
		while (k < count && strcmp(out_names[k], comparison->rows[i].backend) != 0)
			k++;
		if (k == count && count < 8)
			out_names[count++] = comparison->rows[i].backend;
	}
	return count;
}

static json_t *make_headings(const struct gz_comparison *comparison, const json_t *sources)
{
	json_t *headings = json_array();
	const char *backends[8];
	const size_t count = list_backends(comparison, backends);
	char text[GZ_NAMES_SIZE];
	json_array_append_new(headings, json_string("mean, ms"));
	for (size_t i = 0; i < count; i++)
		for (size_t k = 0; k < comparison->method_count; k++) {
			snprintf(text, sizeof text, "here, %s, %.40s", backends[i],
				 comparison->methods[k]);
			json_array_append_new(headings, json_string_nocheck(text));
		}
	for (size_t i = 0; i < json_array_size(sources); i++) {
		const json_t *source = json_array_get(sources, i);
		const json_t *machines = json_object_get(source, "machines");
		for (size_t k = 0; k < json_array_size(machines); k++) {
			snprintf(text, sizeof text, "%s: %s",
				 json_string_value(json_object_get(source, "name")),
				 json_string_value(
					 json_object_get(json_array_get(machines, k), "name")));
			json_array_append_new(headings, json_string(text));
		}
	}
	return headings;
}

static void add_printed_line(const struct gz_comparison *comparison, size_t scene,
			     const struct printed_key *key, const json_t *sources, json_t *rows)
{
	const char *backends[8];
	const size_t count = list_backends(comparison, backends);
	char name[GZ_NAMES_SIZE], slices[GZ_NAME_SIZE] = "";
	json_t *cells = json_array();
	bool any = false;
	for (size_t i = 0; i < count; i++)
		for (size_t k = 0; k < comparison->method_count; k++)
			any |= add_time_cell(cells, our_ms(comparison, scene, key, backends[i], k));
	for (size_t i = 0; i < json_array_size(sources); i++) {
		const json_t *source = json_array_get(sources, i);
		const size_t machines = json_array_size(json_object_get(source, "machines"));
		for (size_t k = 0; k < machines; k++)
			any |= add_time_cell(cells,
					     gz_published_ms(source, k, key->technique->name,
							     key->effect->name, key->slices));
	}
	if (key->slices > 0)
		snprintf(slices, sizeof slices, ", %d", key->slices);
	snprintf(name, sizeof name, "%s%s, %s", key->technique->name, slices, key->effect->words);
	if (any)
		json_array_append_new(rows, json_pack("{ss sO}", "name", name, "cells", cells));
	json_decref(cells);
}

/* One table: what is measured here and what others printed. Slices of which no number is stated
 * have a line of their own. */
static json_t *make_printed(const struct gz_comparison *comparison, size_t scene,
			    const json_t *sources)
{
	static const int slices[] = { 0, 64, 128, 512 };
	json_t *rows = json_array();
	for (size_t i = 0; gz_techniques[i]; i++)
		for (size_t k = 0; k < GZ_EFFECT_COUNT; k++)
			for (size_t n = 0; n < sizeof slices / sizeof slices[0]; n++) {
				const struct printed_key key = { gz_techniques[i], &gz_effects[k],
								 slices[n] };
				add_printed_line(comparison, scene, &key, sources, rows);
			}
	return json_pack("{ss so so}", "caption", "Mean time of a frame, ms, here and in print",
			 "headings", make_headings(comparison, sources), "rows", rows);
}

/* ---- a scene ---- */

static json_t *scene_rows(const struct gz_comparison *comparison, size_t scene, const json_t *rows)
{
	json_t *list = json_array();
	for (size_t i = 0; i < comparison->row_count; i++) {
		char words[GZ_NAMES_SIZE];
		if (comparison->rows[i].scene != scene)
			continue;
		series_words(&comparison->rows[i], words);
		json_t *row = json_array_get(rows, i);
		gz_page_set_text(row, "words", words);
		json_array_append(list, row);
	}
	return list;
}

static void set_absent(const struct gz_comparison *comparison, size_t scene, json_t *object)
{
	json_t *list = json_array();
	for (size_t i = 0; i < comparison->gap_count; i++) {
		const struct gz_comparison_gap *gap = &comparison->gaps[i];
		char text[GZ_NAMES_SIZE];
		if (gap->scene != scene)
			continue;
		const char *what = gap->why == GZ_ABSENT_BACKEND ? "" : gap->effect->words;
		snprintf(text, sizeof text, "%s %s%s%s;", gap->technique->name, gap->backend,
			 what[0] ? " with " : "", what);
		json_array_append_new(list, json_string(text));
	}
	json_object_set_new(object, "some_absent", json_boolean(json_array_size(list) > 0));
	json_object_set_new(object, "absent_words", list);
}

static void add_scene(const struct gz_comparison *comparison, size_t index,
		      const struct gz_charts *charts, json_t *page)
{
	const struct gz_comparison_scene *scene = &comparison->scenes[index];
	json_t *object = json_array_get(json_object_get(page, "scenes"), index);
	char text[2 * GZ_STUDY_TEXT_SIZE], name[GZ_NAMES_SIZE];
	snprintf(text, sizeof text, "%s: %d×%d×%d voxels, isovalue %.6g", scene->name,
		 scene->dims[0], scene->dims[1], scene->dims[2], scene->isovalue);
	gz_page_set_text(object, "title", text);
	set_answer(comparison, index, object);
	gz_comparison_chart_name(comparison, "error", index, name);
	json_t *figure = gz_page_figure(
		charts, name, "first",
		"The lower and the farther left, the better. Numbers at points are slices. What "
		"the reference is depends on the technique: see below.");
	json_object_set_new(object, "error_chart", figure ? figure : json_null());
	gz_comparison_chart_name(comparison, "times", index, name);
	figure = gz_page_figure(charts, name, "",
				"Time of a frame without effects, here and, grey, as printed.");
	json_object_set_new(object, "times_chart", figure ? figure : json_null());
	json_object_set_new(object, "table_rows",
			    scene_rows(comparison, index, json_object_get(page, "rows")));
	set_absent(comparison, index, object);
	json_object_set_new(object, "printed",
			    make_printed(comparison, index, json_object_get(page, "published")));
}

/* ---- the page ---- */

/* What each backend of each technique runs on, once. */
static void add_devices(const struct gz_comparison *comparison, json_t *facts)
{
	for (size_t i = 0; i < comparison->row_count; i++) {
		const struct gz_comparison_row *row = &comparison->rows[i], *before = row - 1;
		char name[GZ_NAMES_SIZE];
		if (i > 0 && before->technique == row->technique &&
		    strcmp(before->backend, row->backend) == 0)
			continue;
		if (row->scene > 0)
			break;
		snprintf(name, sizeof name, "%s %s", row->technique->name, row->backend);
		gz_page_add_fact(facts, name, row->device);
	}
}

static json_t *make_comparison_facts(const struct gz_comparison *comparison)
{
	const struct gz_study_machine *machine = &comparison->machine;
	json_t *facts = json_array();
	gz_page_add_fact(facts, "processor", machine->host_cpu);
	gz_page_add_fact(facts, "memory", machine->memory);
	gz_page_add_fact(facts, "system", machine->system);
	add_devices(comparison, facts);
	gz_page_add_fact(facts, "compiler", machine->compiler);
	gz_page_add_fact(facts, "program", machine->program);
	gz_page_add_fact(facts, "commit", machine->commit);
	for (size_t i = 0; i < comparison->scene_count; i++) {
		char text[GZ_PATH_SIZE + GZ_STUDY_HASH_SIZE + 64];
		snprintf(text, sizeof text, "%s, volume and transfer function SHA-256 %s",
			 comparison->scenes[i].path, comparison->scenes[i].data_hash);
		gz_page_add_fact(facts, "scene", text);
	}
	return facts;
}

static void set_frame_words(const struct gz_comparison *comparison, json_t *page)
{
	char moves[GZ_PATH_SIZE + 64], text[sizeof moves + GZ_NAMES_SIZE];
	if (comparison->camera_path[0])
		snprintf(moves, sizeof moves, "follows %s", comparison->camera_path);
	else
		snprintf(moves, sizeof moves, "turns by %.3g° a frame", comparison->turn_deg);
	snprintf(text, sizeof text, "camera %s, %d×%d px, %d frames after %d that do not count",
		 moves, comparison->width, comparison->height, comparison->frames,
		 comparison->warm_up);
	gz_page_set_text(page, "frame_words", text);
}

void gz_comparison_page_write(const struct gz_comparison *comparison,
			      const struct gz_charts *charts, struct gz_text *out)
{
	json_t *page = gz_comparison_to_json(comparison);
	gz_page_set_style(page);
	gz_page_set_text(page, "title", "Techniques of volume rendering compared");
	json_object_set_new(page, "no_charts", json_boolean(!charts->available));
	set_frame_words(comparison, page);
	for (size_t i = 0; i < comparison->scene_count; i++)
		add_scene(comparison, i, charts, page);
	json_object_set_new(page, "facts", make_comparison_facts(comparison));
	if (!page || !gz_template_fill(gz_comparison_html, page, out))
		out->failed = true;
	json_decref(page);
}
