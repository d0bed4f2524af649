#include "study_example.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static struct gz_study_scene example_scene(const char *name, const char *transfer)
{
	struct gz_study_scene scene = {
		.dims = { 10, 20, 30 },
		.camera = { .eye = { 0, -2, 0.1 },
			    .look_at = { 0, 0, 1.0 / 3 },
			    .up = { 0, 0, 1 },
			    .fov_deg = 40,
			    .height = 1.5 },
		.display = gz_display_default(64, 48),
	};
	strcpy(scene.name, name);
	strcpy(scene.transfer, transfer);
	strcpy(scene.path, "scenes/");
	strcat(scene.path, name);
	memset(scene.hash, 'a', 64);
	memset(scene.data_hash, 'd', 64);
	return scene;
}

static void fill_lists(struct gz_study *study)
{
	static const char *const variants[] = { "standard", "mdc", "acuity:acuity_slope=0.0275" };
	study->scenes = calloc(2, sizeof *study->scenes);
	study->scenes[study->scene_count++] = example_scene("head, \"old\"", "soft");
	study->scenes[study->scene_count++] = example_scene("head, \"old\"", "hard");
	study->variants = calloc(3, sizeof *study->variants);
	for (; study->variant_count < 3; study->variant_count++) {
		struct gz_study_variant *variant = &study->variants[study->variant_count];
		strcpy(variant->text, variants[study->variant_count]);
		strncpy(variant->method, variant->text, strcspn(variant->text, ":"));
	}
	study->sizes = calloc(1, sizeof *study->sizes);
	study->sizes[0][0] = 64;
	study->sizes[0][1] = 48;
	study->size_count = 1;
	study->backends = calloc(2, sizeof *study->backends);
	study->machine.copy_ms[0] = 0.25;
	strcpy(study->backends[0], "cpu");
	strcpy(study->backends[1], "cpu:threads=2");
	study->backend_count = 2;
	study->points = calloc(4, sizeof *study->points);
	for (; study->point_count < 4; study->point_count++)
		study->points[study->point_count] =
			(struct gz_study_point) { { 0.1F * (float)study->point_count, 1.0F / 3 },
						  (uint32_t)study->point_count };
	study->camera_count = 4;
}

static struct gz_study_errors example_errors(double from)
{
	return (struct gz_study_errors) { from,      from + .1, from + .2, INFINITY, from + .4,
					  from + .5, from + .6, from + .7, from + .8 };
}

static void fill_rows(struct gz_study *study)
{
	const size_t units = gz_study_shard_unit_count(study), per = gz_study_unit_rows(study);
	study->rows = calloc(units * per, sizeof *study->rows);
	for (size_t i = 0; i < units * per; i++) {
		const size_t unit = (size_t)study->shard + i / per * (size_t)study->shard_count;
		struct gz_study_row *row = &study->rows[study->row_count++];
		*row = gz_study_unit_row(study, unit, i % per);
		const double number = (double)(unit * per + i % per);
		row->plan_ms = number + .125;
		row->cast_ms = number + .25;
		row->reconstruct_ms = number + .5;
		row->frame_ms = number + .75;
		row->gpu_ms = i % 2 ? NAN : number;
		row->prepare_ms = number / 16;
		row->rays = 1000 + unit;
		row->samples = (UINT64_C(1) << 40) + unit;
		row->converged = example_errors(number);
		row->standard = example_errors(number + 1);
		row->flicker = number / 8;
		row->turning_error = number / 32;
		row->camera_path_error = number / 64;
		row->reference_db = 70;
	}
}

struct gz_study study_example(int shard, int shard_count)
{
	struct gz_study study = {
		.path = "random:4",
		.camera_path = "walk.session/frames.tsv",
		.min_move_px = 0.8,
		.per_cell = true,
		.seed = 7,
		.frames_per_point = 2,
		.warm_up_frames = 1,
		.accuracy = GZ_STUDY_ACCURACY_ALL,
		.machine = { .host_cpu = "a processor",
			     .memory = "1 GiB",
			     .system = "a system",
			     .compiler = "a compiler",
			     .commit = "0123abc",
			     .program = "gazebench 0.0.0",
			     .backends = { "portable, 1 thread", "portable, 2 threads" } },
		.shard = shard,
		.shard_count = shard_count,
		.complete = true,
	};
	memset(study.path_hash, 'b', 64);
	memset(study.camera_path_hash, 'c', 64);
	fill_lists(&study);
	study.bound_rays = calloc(2 * 4, sizeof *study.bound_rays);
	for (int i = 0; i < 2 * 4; i++)
		study.bound_rays[i] = 0.01 * i;
	fill_rows(&study);
	return study;
}
