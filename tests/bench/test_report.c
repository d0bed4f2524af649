/* Names, words, page and advice of a report; charts and the page's looks: report_in_browser.py. */
#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/captured_log.h"
#include "bench/report/advice.h"
#include "bench/report/charts.h"
#include "bench/report/names.h"
#include "bench/report/plot.h"
#include "bench/report/report.h"
#include "bench/report/study_charts.h"
#include "bench/report/template.h"
#include "bench/study/stage.h"
#include "made_study.h"

static const double flips[] = { 0.001, 0.012, 0.02, 0.04, 0.015 };
static const double times[] = { 100, 20, 10, 5, 40 };

static void measure(const struct gz_study *study, struct gz_study_row *row)
{
	(void)study;
	row->frame_ms = times[row->variant] * (1 + row->size);
	row->cast_ms = row->frame_ms;
	row->rays = row->samples = (uint64_t)(100 * times[row->variant]);
	/* The second scene needs more. */
	row->converged.perceived_flip = flips[row->variant] * (1 + row->scene);
}

static void make(const char *second_scene, int sizes, struct gz_study *study,
		 struct gz_summary *summary)
{
	const struct made_study made = {
		.scenes = { "head", second_scene },
		.variants = { "standard", "acuity", "acuity:acuity_slope=0.033",
			      "acuity:acuity_slope=0.044", "mdc:blend_px=16:levels=yes" },
		.backends = { "cpu" },
		.sizes = { { 100, 100 }, { 200, 100 } },
		.size_count = sizes,
		.points = 3,
		.frames = 1,
	};
	make_study(&made, study);
	make_rows(study, measure);
	assert_int_equal(gz_summary_make(study, summary), GZ_OK);
}

static void free_both(struct gz_study *study, struct gz_summary *summary)
{
	gz_summary_free(summary);
	gz_study_free(study);
}

static void variants_have_readable_names(void **state)
{
	(void)state;
	struct gz_study study;
	struct gz_summary summary;
	char text[GZ_NAMES_SIZE];
	make(NULL, 1, &study, &summary);
	const struct gz_group *group = &summary.groups[0];
	gz_variant_words(&study.variants[2], text);
	assert_string_equal(text, "acuity, slope 0.033");
	gz_variant_words(&study.variants[4], text);
	assert_string_equal(text, "mdc, blend 16 px, levels yes");
	gz_curve_name(&study, group, &group->curves[1], text);
	assert_string_equal(text, "acuity, slope");
	gz_variant_label(&study, group, &group->curves[1], 2, text);
	assert_string_equal(text, "0.033");
	gz_variant_label(&study, group, &group->curves[1], 1, text);
	assert_string_equal(text, "preset");
	gz_variant_label(&study, group, &group->curves[0], 0, text);
	assert_string_equal(text, "");
	free_both(&study, &summary);
}

static void longest_variant_is_cut_and_not_overrun(void **state)
{
	(void)state;
	struct gz_study_variant variant = { .method = "acuity" };
	char text[GZ_NAMES_SIZE];
	memset(variant.text, 'x', sizeof variant.text - 1);
	memcpy(variant.text, "acuity:", 7);
	gz_variant_words(&variant, text);
	assert_true(strlen(text) < GZ_NAMES_SIZE);
}

static void files_of_several_groups_have_their_names_and_no_slash(void **state)
{
	(void)state;
	struct gz_study study;
	struct gz_summary summary;
	char text[GZ_NAMES_SIZE];
	make("../ä b", 1, &study, &summary);
	gz_chart_name(&summary, "boxes", &summary.groups[0], text);
	assert_string_equal(text, "boxes-head-100x100-cpu");
	gz_chart_name(&summary, "boxes", &summary.groups[1], text);
	assert_null(strchr(text, '/'));
	assert_non_null(strstr(text, "boxes-..-"));
	free_both(&study, &summary);
}

static void answer_names_the_cheapest_within_the_bound_and_what_it_saves(void **state)
{
	(void)state;
	struct gz_study study;
	struct gz_summary summary;
	struct gz_text text = { 0 };
	make(NULL, 1, &study, &summary);
	const struct gz_group *group = &summary.groups[0];
	const struct gz_advice_question question = gz_advice_preset(group);
	gz_advice_tell(&study, group, &question, gz_advice_find(group, &question), false, &text);
	assert_non_null(strstr(text.bytes, "On head at 100×100 on cpu, acuity, slope 0.033 takes "
					   "10 ms a frame where a ray for every pixel takes 100 "
					   "ms: 10 times as fast (mean time over mean time; 95 % "
					   "confidence interval 10 to 10), with 10 % of the "
					   "rays."));
	assert_non_null(strstr(text.bytes, "below the bound of 0.03 everywhere"));
	gz_text_free(&text);
	free_both(&study, &summary);
}

static void without_a_variant_within_the_bound_standard_remains(void **state)
{
	(void)state;
	struct gz_study study;
	struct gz_summary summary;
	struct gz_text text = { 0 };
	make(NULL, 1, &study, &summary);
	const struct gz_group *group = &summary.groups[0];
	struct gz_advice_question question = gz_advice_preset(group);
	question.bound = 0.002;
	assert_int_equal(gz_advice_find(group, &question), 0);
	gz_advice_tell(&study, group, &question, 0, false, &text);
	assert_non_null(strstr(text.bytes, "nothing faster keeps perceived FLIP below 0.002"));
	gz_text_free(&text);
	question.bound = 0.0001;
	assert_int_equal(gz_advice_find(group, &question), GZ_SERIES_NONE);
	gz_advice_tell(&study, group, &question, GZ_SERIES_NONE, false, &text);
	assert_non_null(strstr(text.bytes, "so that standard remains"));
	gz_text_free(&text);
	free_both(&study, &summary);
}

static void answer_about_what_is_slower_and_holds_the_bound_is_true_and_readable(void **state)
{
	(void)state;
	struct gz_study study;
	struct gz_summary summary;
	struct gz_text text = { 0 };
	make(NULL, 1, &study, &summary);
	struct gz_group *group = &summary.groups[0];
	const struct gz_advice_question question = gz_advice_preset(group);
	for (size_t i = 0; i < group->series_count; i++)
		if (i != group->standard) {
			group->series[i].typical_ms = 125;
			group->series[i].ratio_of_means = 0.8;
			group->series[i].ratio_interval = (struct gz_interval) { 0.5, 1.25 };
			group->series[i].rays = 1.1 * 100 * 100;
		}
	const size_t winner = gz_advice_find(group, &question);
	assert_int_equal(winner, group->standard);
	gz_advice_tell(&study, group, &question, winner, false, &text);
	assert_null(strstr(text.bytes, "only standard"));
	assert_non_null(strstr(text.bytes, "nothing faster keeps perceived FLIP below 0.03"));
	assert_non_null(strstr(text.bytes, ", which takes 125 ms a frame"));
	assert_non_null(strstr(text.bytes,
			       "1.25 times as long (mean time over mean time; 95 % "
			       "confidence interval 0.8 to 2), with 110 % of the rays"));
	gz_text_free(&text);
	free_both(&study, &summary);
}

static void answer_says_the_noise_and_what_it_leaves_open(void **state)
{
	(void)state;
	struct gz_study study;
	struct gz_summary summary;
	struct gz_text text = { 0 };
	make(NULL, 1, &study, &summary);
	struct gz_group *group = &summary.groups[0];
	const struct gz_advice_question question = gz_advice_preset(group);
	const size_t winner = gz_advice_find(group, &question);
	group->noise = 0.05;
	gz_advice_tell(&study, group, &question, winner, false, &text);
	assert_non_null(strstr(text.bytes, "90 of 100 of its times lie within ±5 %."));
	assert_null(strstr(text.bytes, "Warning"));
	gz_text_free(&text);
	group->series[group->standard].typical_ms = 1.04 * group->series[winner].typical_ms;
	group->noise_of_frames = true;
	gz_advice_tell(&study, group, &question, winner, true, &text);
	assert_non_null(strstr(text.bytes, "standard&#39;s frames of one place"));
	assert_non_null(strstr(text.bytes, "<strong>Warning: standard holds the bound too"));
	gz_text_free(&text);
	free_both(&study, &summary);
}

static void advice_for_several_groups_holds_in_each_of_them(void **state)
{
	(void)state;
	struct gz_study study;
	struct gz_summary summary;
	make("hand", 1, &study, &summary);
	const struct gz_group *groups[] = { &summary.groups[0], &summary.groups[1] };
	struct gz_advice_question question = gz_advice_preset(groups[0]);
	assert_int_equal(gz_advice_choose(&study, groups, 1, &question), 2);
	assert_int_equal(gz_advice_choose(&study, groups, 2, &question), 1);
	question.bound = 0.0011;
	assert_int_equal(gz_advice_choose(&study, groups, 1, &question), 0);
	assert_int_equal(gz_advice_choose(&study, groups, 2, &question), GZ_SERIES_NONE);
	assert_true(gz_advice_has_errors(groups, 2, &question));
	question.reference = GZ_AGAINST_STANDARD;
	assert_false(gz_advice_has_errors(groups, 2, &question));
	assert_int_equal(gz_advice_choose(&study, groups, 2, &question), GZ_SERIES_NONE);
	free_both(&study, &summary);
}

static void page_escapes_every_text_and_holds_nothing_from_elsewhere(void **state)
{
	(void)state;
	struct gz_study study;
	struct gz_summary summary;
	struct gz_text page = { 0 };
	const struct gz_charts none = { 0 };
	make("<script>alert('x')</script>", 2, &study, &summary);
	snprintf(study.machine.host_cpu, sizeof study.machine.host_cpu, "<img src=x onerror=y>");
	snprintf(study.machine.program, sizeof study.machine.program, "\"><b>");
	snprintf(study.path, sizeof study.path, "it's; rm -rf \"$HOME\" <b>");
	gz_page_write(&summary, &none, NULL, &page);
	assert_false(page.failed);
	assert_null(strstr(page.bytes, "<script"));
	assert_null(strstr(page.bytes, "<img"));
	assert_null(strstr(page.bytes, "\"><b>"));
	assert_null(strstr(page.bytes, "http://"));
	assert_null(strstr(page.bytes, "https://"));
	assert_non_null(strstr(page.bytes, "&lt;script&gt;alert(&#39;x&#39;)&lt;/script&gt;"));
	/* The command is one that a shell takes as it is meant. */
	assert_non_null(strstr(page.bytes, "--path &#39;it&#39;\\&#39;&#39;s; rm -rf "
					   "&quot;$HOME&quot; &lt;b&gt;&#39;"));
	assert_non_null(strstr(page.bytes, "No charts."));
	assert_null(strstr(page.bytes, "Partial study"));
	gz_text_free(&page);
	free_both(&study, &summary);
}

static void page_shows_the_command_that_makes_the_study(void **state)
{
	(void)state;
	struct gz_study study;
	struct gz_summary summary;
	struct gz_text page = { 0 };
	const struct gz_charts none = { 0 };
	make(NULL, 1, &study, &summary);
	study.camera_count = 7;
	gz_page_write(&summary, &none, NULL, &page);
	assert_non_null(strstr(page.bytes, " --cameras 7 \\\n  --frames 1 "));
	assert_null(strstr(page.bytes, "--min-move"));
	assert_null(strstr(page.bytes, "camera path"));
	assert_null(strstr(page.bytes, "--camera-path"));
	assert_null(strstr(page.bytes, "--per-cell"));
	assert_null(strstr(page.bytes, "--distance-mm"));
	gz_text_free(&page);
	study.scenes[0].display_known = true;
	study.scenes[0].display.mm[0] = 565.8;
	study.scenes[0].display.mm[1] = 318;
	study.min_move_px = 10.5;
	study.per_cell = true;
	strcpy(study.camera_path, "a walk.csv");
	gz_page_write(&summary, &none, NULL, &page);
	assert_non_null(strstr(page.bytes, "along the camera path, of 255</th>"));
	assert_non_null(strstr(
		page.bytes,
		" --camera-path &#39;a walk.csv&#39; --cameras 7 --min-move 10.5 --per-cell \\\n"));
	assert_non_null(strstr(page.bytes, "--display-mm &#39;565.8 318&#39; --distance-mm 600 "));
	gz_text_free(&page);
	free_both(&study, &summary);
}

/* ---- entered JOD ---- */

/* Its scene is head, its variants those of make(). */
static enum gz_result read_jods(const char *text, const struct gz_study *study,
				const struct gz_log *log, struct gz_jod_table *out_table)
{
	char path[] = "/tmp/gz_jod_XXXXXX";
	const int file = mkstemp(path);
	assert_true(file >= 0);
	assert_int_equal(write(file, text, strlen(text)), (ssize_t)strlen(text));
	close(file);
	const enum gz_result result = gz_jod_table_read(path, study, log, out_table);
	unlink(path);
	return result;
}

static void entered_jod_stand_beside_what_was_measured_and_say_so(void **state)
{
	(void)state;
	struct gz_study study;
	struct gz_summary summary;
	struct gz_jod_table jods = { 0 };
	struct gz_text page = { 0 };
	struct captured_log captured;
	const struct gz_charts none = { 0 };
	captured_log_init(&captured, "*:warn");
	make(NULL, 1, &study, &summary);
	gz_page_write(&summary, &none, NULL, &page);
	assert_null(strstr(page.bytes, "JOD"));
	gz_text_free(&page);
	assert_int_equal(read_jods("scene,method,jod,how\n"
				   "# of a clip\n"
				   "head,acuity,9.64,\"a metric, 24 frames\"\r\n"
				   "\n"
				   "head,ddc,9.5,a metric\n"
				   "head,mdc:blend_px=16:levels=yes,-0.5,another metric\n",
				   &study, &captured.log, &jods),
			 GZ_OK);
	assert_non_null(strstr(captured.last, ":5: the study has no method ddc"));
	summary.jods = &jods;
	const struct gz_group *group = &summary.groups[0];
	assert_true(gz_summary_jod(&summary, group, 1)->jod == 9.64);
	assert_true(gz_summary_jod(&summary, group, 4)->jod == -0.5);
	assert_null(gz_summary_jod(&summary, group, 0));
	char source[256];
	gz_jod_source(&summary, group, source);
	assert_string_equal(source, "a metric, 24 frames and others");
	gz_page_write(&summary, &none, NULL, &page);
	assert_non_null(strstr(page.bytes, "JOD, entered</th>"));
	assert_non_null(strstr(page.bytes, "<td>9.64</td></tr>"));
	gz_text_free(&page);
	gz_jod_table_free(&jods);
	free_both(&study, &summary);
}

static void table_of_jod_that_is_none_is_refused_with_its_line(void **state)
{
	(void)state;
	static const struct {
		const char *text, *message;
	} wrong[] = {
		{ "", ":1: the first line must be" },
		{ "scene,jod\n", ":1: the first line must be" },
		{ "scene,method,jod,how\nhead,acuity,ten,x\n", ":2: no value" },
		{ "scene,method,jod,how\nhead,acuity,10.5,x\n", ":2: no value" },
		{ "scene,method,jod,how\nhead,acuity,nan,x\n", ":2: no value" },
		{ "scene,method,jod,how\nhead,acuity,9\n", ":2: say in the fourth column" },
		{ "scene,method,jod,how\nhead,acuity,9,\n", ":2: say in the fourth column" },
		{ "scene,method,jod,how\nhead,acuity,9,x,y\n", ":2: say in the fourth column" },
		{ "scene,method,jod,how\nhead,acuity,9,x\nhead,acuity,8,x\n",
		  ":3: an earlier line" },
	};
	struct gz_study study;
	struct gz_summary summary;
	struct captured_log captured;
	make(NULL, 1, &study, &summary);
	for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
		struct gz_jod_table jods = { 0 };
		captured_log_init(&captured, "*:warn");
		if (read_jods(wrong[i].text, &study, &captured.log, &jods) != GZ_ERR_FORMAT ||
		    !strstr(captured.last, wrong[i].message) || jods.values)
			fail_msg("'%s' gives '%s'", wrong[i].text, captured.last);
	}
	free_both(&study, &summary);
}

/* A scene on the disk, and a study that has seen it. */
struct seen_scene {
	char folder[64];
	struct gz_study_scene scene;
	struct gz_log log;
	int sizes[1][2];
};

static void write_file(const char *folder, const char *name, const char *text)
{
	char path[128];
	snprintf(path, sizeof path, "%s/%s", folder, name);
	FILE *file = fopen(path, "w");
	assert_non_null(file);
	fputs(text, file);
	assert_int_equal(fclose(file), 0);
}

static void see_scene(struct seen_scene *seen)
{
	struct gz_transfer transfer;
	strcpy(seen->folder, "/tmp/gz_report_XXXXXX");
	assert_non_null(mkdtemp(seen->folder));
	gz_log_init(&seen->log, NULL, NULL, NULL);
	write_file(seen->folder, "a.tf", "0 0 0 0 0\n1 1 1 1 0.5\n");
	write_file(seen->folder, "b.tf", "0 0 0 0 0\n1 1 0 0 0.5\n");
	write_file(seen->folder, "a.scene",
		   "[volume]\nprocedural = shells\ndims = 16 16 16\n[transfer]\nfile = a.tf\n"
		   "also = b.tf\n");
	snprintf(seen->scene.path, sizeof seen->scene.path, "%s/a.scene", seen->folder);
	struct gz_stage stage = { .log = &seen->log };
	assert_int_equal(gz_stage_load(&stage, seen->scene.path), GZ_OK);
	seen->scene.camera = stage.scene.settings.camera;
	assert_int_equal(gz_stage_transfer(&stage, 1, seen->scene.transfer, &transfer), GZ_OK);
	assert_int_equal(gz_stage_data_hash(&stage, &transfer, seen->scene.data_hash), GZ_OK);
	gz_stage_free(&stage);
	strcpy(seen->scene.name, "a");
	seen->sizes[0][0] = seen->sizes[0][1] = 32;
}

static enum gz_result picture_of(struct seen_scene *seen, struct gz_image *image)
{
	struct gz_study study = {
		.scenes = &seen->scene, .scene_count = 1, .sizes = seen->sizes, .size_count = 1
	};
	return gz_report_picture(&study, 0, seen->folder, &seen->log, image);
}

static void picture_behind_maps_is_of_what_was_measured_and_of_nothing_else(void **state)
{
	(void)state;
	struct seen_scene seen = { 0 };
	struct gz_image image = { 0 };
	char command[128];
	see_scene(&seen);
	/* The same names and dims, another function. */
	write_file(seen.folder, "b.tf", "0 0 0 0 0\n1 0 1 0 0.5\n");
	assert_int_equal(picture_of(&seen, &image), GZ_ERR_NOT_FOUND);
	assert_null(image.pixels);
	/* What it was, by another name. */
	write_file(seen.folder, "c.tf", "0 0 0 0 0\n1 1 0 0 0.5\n");
	write_file(seen.folder, "a.scene",
		   "[volume]\nprocedural = shells\ndims = 16 16 16\n[transfer]\nfile = c.tf\n");
	assert_int_equal(picture_of(&seen, &image), GZ_OK);
	uint64_t red = 0, green = 0;
	for (size_t i = 0; i < 32 * 32; i++) {
		red += image.pixels[4 * i];
		green += image.pixels[4 * i + 1];
	}
	assert_true(red > 0 && green == 0);
	gz_image_free(&image);
	snprintf(command, sizeof command, "rm -rf %s", seen.folder);
	assert_int_equal(system(command), 0);
}

static void page_of_a_partial_study_or_one_shard_says_so(void **state)
{
	(void)state;
	struct gz_study study;
	struct gz_summary summary;
	struct gz_text page = { 0 };
	const struct gz_charts none = { 0 };
	make(NULL, 1, &study, &summary);
	study.complete = false;
	study.shard = 2;
	study.shard_count = 4;
	gz_page_write(&summary, &none, NULL, &page);
	assert_non_null(strstr(page.bytes, "Partial study."));
	assert_non_null(strstr(page.bytes, "One part of 4."));
	assert_non_null(strstr(page.bytes, "holds shard 3;"));
	assert_non_null(strstr(page.bytes, " --shard 3/4 "));
	gz_text_free(&page);
	free_both(&study, &summary);
}

static void page_without_errors_has_no_empty_tables_of_them(void **state)
{
	(void)state;
	struct gz_study study;
	struct gz_summary summary;
	struct gz_text page = { 0 };
	const struct gz_charts none = { 0 };
	make(NULL, 1, &study, &summary);
	gz_page_write(&summary, &none, NULL, &page);
	assert_non_null(strstr(page.bytes, "All measures of error"));
	gz_text_free(&page);
	gz_summary_free(&summary);
	for (size_t i = 0; i < study.row_count; i++)
		study.rows[i].converged.perceived_flip = NAN;
	assert_int_equal(gz_summary_make(&study, &summary), GZ_OK);
	gz_page_write(&summary, &none, NULL, &page);
	assert_null(strstr(page.bytes, "All measures of error"));
	assert_null(strstr(page.bytes, "At equal error"));
	assert_non_null(strstr(page.bytes, "what it costs is not known"));
	gz_text_free(&page);
	free_both(&study, &summary);
}

static void base64_is_that_of_the_standard(void **state)
{
	(void)state;
	/* RFC 4648, section 10. */
	static const char *const pairs[][2] = {
		{ "f", "Zg==" },        { "fo", "Zm8=" },        { "foo", "Zm9v" },
		{ "foob", "Zm9vYg==" }, { "fooba", "Zm9vYmE=" }, { "foobar", "Zm9vYmFy" },
	};
	for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++) {
		struct gz_text text = { 0 };
		gz_text_add_base64(&text, pairs[i][0], strlen(pairs[i][0]));
		assert_string_equal(text.bytes, pairs[i][1]);
		gz_text_free(&text);
	}
}

static void template_is_filled_from_json(void **state)
{
	(void)state;
	static const struct {
		const char *page, *json, *filled;
	} pages[] = {
		{ "a{{t}}b", "{\"t\": \"<&>\"}", "a&lt;&amp;&gt;b" },
		{ "{{o.n}} {{none}}.", "{\"o\": {\"n\": 7}}", "7 ." },
		{ "{{x|number}} {{y|number}} {{z|number}}",
		  "{\"x\": 1234.5, \"y\": null, \"z\": \"inf\"}", "1234 – ∞" },
		{ "{{x|percent}} {{x|similarity}} {{x|times}}", "{\"x\": 0.25}",
		  "25 % 0.2500 0.25×" },
		{ "{{t|svg}}{{t|html}}", "{\"t\": \"<b>\"}", "PGI+<b>" },
		{ "{{#l}}{{.}},{{/l}}{{^l}}none{{/l}}", "{\"l\": [1, 2]}", "1,2," },
		{ "{{#l}}{{.}},{{/l}}{{^l}}none{{/l}}", "{\"l\": []}", "none" },
		{ "{{#o}}{{in}}{{out}}{{/o}}", "{\"out\": \"o\", \"o\": {\"in\": \"i\"}}", "io" },
		{ "{{#a}}{{#a}}x{{/a}}{{/a}}{{#b}}y{{/b}}", "{\"a\": true, \"b\": false}", "x" },
		{ "{{<f}}[{{t}}]{{/f}}{{>f}}{{>f}}", "{\"t\": \"i\"}", "[i][i]" },
	};
	for (size_t i = 0; i < sizeof pages / sizeof pages[0]; i++) {
		struct gz_text out = { 0 };
		json_t *json = json_loads(pages[i].json, 0, NULL);
		assert_true(gz_template_fill(pages[i].page, json, &out));
		assert_string_equal(out.bytes ? out.bytes : "", pages[i].filled);
		json_decref(json);
		gz_text_free(&out);
	}
}

static void wrong_template_is_refused(void **state)
{
	(void)state;
	static const char *const pages[] = { "{{t",
					     "{{#t}}a",
					     "{{/t}}",
					     "{{t|none}}",
					     "{{>none}}",
					     "{{}}",
					     "{{<f}}{{>f}}{{/f}}{{>f}}" };
	json_t *json = json_pack("{s:s}", "t", "text");
	for (size_t i = 0; i < sizeof pages / sizeof pages[0]; i++) {
		struct gz_text out = { 0 };
		if (gz_template_fill(pages[i], json, &out))
			fail_msg("%s is filled", pages[i]);
		gz_text_free(&out);
	}
	json_decref(json);
}

static void labels_lie_off_points_and_off_each_other(void **state)
{
	(void)state;
	struct gz_label_field field = { .area = { 0, 0, 200, 100 } };
	struct gz_label first = { .x = 90, .y = 50, .width = 40, .height = 10 }, second = first;
	struct gz_label wide = { .x = 90, .y = 50, .width = 400, .height = 10 };
	gz_labels_avoid(&field, (struct gz_box) { 100, 40, 160, 60 }, GZ_LABEL_ON_POINT);
	assert_true(gz_labels_place(&field, &first));
	assert_true(first.side <= 0); /* right of it is a point */
	assert_true(gz_labels_place(&field, &second));
	assert_true(fabs(first.anchor_y - second.anchor_y) >= 10 || first.side != second.side);
	/* Nowhere is there room: left out, unless it must be. */
	assert_false(gz_labels_place(&field, &wide));
	wide.must = true;
	assert_true(gz_labels_place(&field, &wide));
	gz_labels_free(&field);
}

static void chart_gets_colours_for_dark_pages_and_stays_as_it_is(void **state)
{
	(void)state;
	struct gz_text out = { 0 };
	gz_palette_add_dark(&out, "<?xml?>\n<svg width=\"1\">\n<g/></svg>");
	static const char start[] = "<?xml?>\n<svg width=\"1\">\n<style>";
	assert_memory_equal(out.bytes, start, sizeof start - 1);
	assert_non_null(strstr(out.bytes, "prefers-color-scheme:dark"));
	assert_non_null(strstr(out.bytes, "</style>\n<g/></svg>"));
	gz_text_free(&out);
}

TEST_SUITE(report)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(variants_have_readable_names),
		cmocka_unit_test(longest_variant_is_cut_and_not_overrun),
		cmocka_unit_test(entered_jod_stand_beside_what_was_measured_and_say_so),
		cmocka_unit_test(table_of_jod_that_is_none_is_refused_with_its_line),
		cmocka_unit_test(files_of_several_groups_have_their_names_and_no_slash),
		cmocka_unit_test(answer_names_the_cheapest_within_the_bound_and_what_it_saves),
		cmocka_unit_test(without_a_variant_within_the_bound_standard_remains),
		cmocka_unit_test(
			answer_about_what_is_slower_and_holds_the_bound_is_true_and_readable),
		cmocka_unit_test(answer_says_the_noise_and_what_it_leaves_open),
		cmocka_unit_test(advice_for_several_groups_holds_in_each_of_them),
		cmocka_unit_test(page_escapes_every_text_and_holds_nothing_from_elsewhere),
		cmocka_unit_test(page_shows_the_command_that_makes_the_study),
		cmocka_unit_test(picture_behind_maps_is_of_what_was_measured_and_of_nothing_else),
		cmocka_unit_test(page_of_a_partial_study_or_one_shard_says_so),
		cmocka_unit_test(page_without_errors_has_no_empty_tables_of_them),
		cmocka_unit_test(base64_is_that_of_the_standard),
		cmocka_unit_test(template_is_filled_from_json),
		cmocka_unit_test(wrong_template_is_refused),
		cmocka_unit_test(labels_lie_off_points_and_off_each_other),
		cmocka_unit_test(chart_gets_colours_for_dark_pages_and_stays_as_it_is),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
