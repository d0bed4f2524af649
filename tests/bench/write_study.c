/*
 * Writes the folder of a made study, as large as people make them, for tests of what reads it.
 *
 *   write_study DIR [one|several|partial] [SCENE-FILE]
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/study/stage.h"
#include "bench/study/study_folder.h"
#include "made_study.h"

/* How far a variant goes: time and rays over standard's, and the errors it makes. */
struct model {
	const char *variant;
	double time, rays, flip;
};

static const struct model models[] = {
	{ "standard", 1, 1, 0.004 },
	{ "acuity:acuity_slope=0.011", 0.17, 0.12, 0.0055 },
	{ "acuity", 0.081, 0.045, 0.009 },
	{ "acuity:acuity_slope=0.033", 0.062, 0.031, 0.014 },
	{ "acuity:acuity_slope=0.044", 0.055, 0.026, 0.037 },
	{ "mdc", 0.34, 0.31, 0.011 },
	{ "ddc:ddc_spacing=1 2 4:blend_px=16", 0.2, 0.17, 0.019 },
	{ NULL, 0, 0, 0 },
};

static double noise(uint32_t a, uint32_t b, uint32_t c)
{
	uint32_t x = a * 2654435761U ^ b * 2246822519U ^ c * 3266489917U;
	x ^= x >> 15;
	x *= 2246822519U;
	x ^= x >> 13;
	return x / 4294967296.0;
}

static struct gz_study_errors errors_of(double flip)
{
	const double mse = flip * flip * 0.2;
	return (struct gz_study_errors) {
		.psnr_db = -10 * log10(mse * 3),
		.ssim = 1 - 2.5 * flip,
		.flip = 1.9 * flip,
		.foveal_psnr_db = mse < 1e-5 ? INFINITY : -10 * log10(mse / 2),
		.foveal_ssim = 1 - 0.7 * flip,
		.foveal_flip = 0.7 * flip,
		.perceived_psnr_db = -10 * log10(mse),
		.perceived_ssim = 1 - 0.05 * flip, /* axes need four digits behind the point */
		.perceived_flip = flip,
	};
}

static void measure(const struct gz_study *study, struct gz_study_row *row)
{
	const struct model *model = &models[row->variant];
	const int *size = study->sizes[row->size];
	const double pixels = (double)size[0] * size[1];
	const double dx = row->gaze.x - 0.5, dy = row->gaze.y - 0.5;
	const double load = 1.5 - 1.8 * (dx * dx + dy * dy);
	row->frame_ms = pixels * 1.1e-4 * load * model->time *
				(1 + 0.08 * noise(row->point, row->variant, row->frame)) +
			0.5;
	row->plan_ms = 0.1;
	row->reconstruct_ms = 0.4;
	row->cast_ms = row->frame_ms - 0.5;
	row->rays = (uint64_t)(pixels * model->rays);
	row->samples = row->rays * 90;
	const double error = model->flip * load * (0.9 + 0.3 * noise(row->point, row->variant, 7));
	row->converged = errors_of(error);
	row->reference_db = 61 + load;
	if (row->variant > 0) {
		row->standard = errors_of(error * 0.8);
		row->flicker = 8 * error;
		row->turning_error = 20 * error;
	}
}

/* So that its picture lies behind the maps. */
static void take_scene(const char *path, const struct gz_log *log, struct gz_study_scene *scene)
{
	struct gz_stage stage = { .log = log };
	struct gz_transfer transfer;
	if (gz_stage_load(&stage, path) != GZ_OK ||
	    gz_stage_transfer(&stage, 0, scene->transfer, &transfer) != GZ_OK ||
	    gz_stage_data_hash(&stage, &transfer, scene->data_hash) != GZ_OK)
		exit(1);
	snprintf(scene->path, sizeof scene->path, "%s", path);
	memcpy(scene->dims, stage.scene.volume.dims, sizeof scene->dims);
	scene->camera = stage.scene.settings.camera;
	gz_stage_free(&stage);
}

int main(int argc, char **argv)
{
	const char *kind = argc > 2 ? argv[2] : "one";
	const bool several = strcmp(kind, "several") == 0, partial = strcmp(kind, "partial") == 0;
	struct made_study made = { .scenes = { "head", several ? "a <b> & 'c' \"d\"" : NULL },
				   .backends = { "cpu" },
				   .sizes = { { 1024, 1024 }, { 1920, 1080 } },
				   .size_count = several ? 2 : 1,
				   .points = 64,
				   .frames = 5 };
	struct gz_study study;
	struct gz_log log;
	if (argc < 2 || argc > 4) {
		fprintf(stderr, "usage: %s DIR [one|several|partial] [SCENE-FILE]\n", argv[0]);
		return 2;
	}
	for (size_t i = 0; models[i].variant; i++)
		made.variants[i] = models[i].variant;
	gz_log_init(&log, NULL, NULL, NULL);
	make_study(&made, &study);
	make_rows(&study, measure);
	if (partial) {
		study.complete = false;
		study.row_count = gz_study_unit_rows(&study) * 20;
	}
	if (argc > 3) {
		take_scene(argv[3], &log, &study.scenes[0]);
	}
	const enum gz_result result = gz_study_write(argv[1], &study, &log);
	gz_study_free(&study);
	return result == GZ_OK ? 0 : 1;
}
