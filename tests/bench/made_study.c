#include "made_study.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static size_t length(const char *const *list)
{
	size_t count = 0;
	while (list[count])
		count++;
	return count;
}

static void *room(size_t count, size_t size)
{
	void *memory = calloc(count, size);
	if (!memory)
		abort();
	return memory;
}

struct gz_study_errors no_errors(void)
{
	return (struct gz_study_errors) { NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN };
}

static void make_lists(const struct made_study *made, struct gz_study *study)
{
	study->scenes = room(study->scene_count, sizeof study->scenes[0]);
	for (size_t i = 0; i < study->scene_count; i++) {
		struct gz_study_scene *scene = &study->scenes[i];
		snprintf(scene->name, sizeof scene->name, "%s", made->scenes[i]);
		snprintf(scene->path, sizeof scene->path, "%s.scene", made->scenes[i]);
		snprintf(scene->transfer, sizeof scene->transfer, "%s", made->scenes[i]);
		snprintf(scene->hash, sizeof scene->hash, "%064zx", i);
		for (int axis = 0; axis < 3; axis++)
			scene->dims[axis] = 64 << i;
		scene->display = gz_display_default(made->sizes[0][0], made->sizes[0][1]);
	}
	study->variants = room(study->variant_count, sizeof study->variants[0]);
	for (size_t i = 0; i < study->variant_count; i++) {
		struct gz_study_variant *variant = &study->variants[i];
		snprintf(variant->text, sizeof variant->text, "%s", made->variants[i]);
		snprintf(variant->method, sizeof variant->method, "%.*s",
			 (int)strcspn(made->variants[i], ":"), made->variants[i]);
	}
	study->backends = room(study->backend_count, sizeof study->backends[0]);
	for (size_t i = 0; i < study->backend_count; i++)
		snprintf(study->backends[i], sizeof study->backends[i], "%s", made->backends[i]);
	study->sizes = room(study->size_count, sizeof study->sizes[0]);
	memcpy(study->sizes, made->sizes, study->size_count * sizeof study->sizes[0]);
}

static void make_points(struct gz_study *study)
{
	study->points = room(study->point_count, sizeof study->points[0]);
	for (size_t i = 0; i < study->point_count; i++) {
		const double t = ((double)i + 0.5) / (double)study->point_count;
		study->points[i].gaze =
			(struct gz_point) { (float)(0.5 + 0.4 * sin(6.283185307179586 * t)),
					    (float)t };
	}
	const size_t bounds = study->scene_count * study->size_count * study->point_count;
	study->bound_rays = room(bounds, sizeof study->bound_rays[0]);
	for (size_t i = 0; i < bounds; i++)
		study->bound_rays[i] = 0.04;
}

void make_study(const struct made_study *made, struct gz_study *out_study)
{
	*out_study = (struct gz_study) {
		.scene_count = length(made->scenes),
		.variant_count = length(made->variants),
		.backend_count = length(made->backends),
		.size_count = (size_t)made->size_count,
		.point_count = (size_t)made->points,
		.frames_per_point = made->frames,
		.warm_up_frames = 1,
		.seed = GZ_STUDY_SEED_DEFAULT,
		.shard_count = 1,
		.complete = true,
	};
	snprintf(out_study->path, sizeof out_study->path, "sweep:s");
	snprintf(out_study->machine.host_cpu, sizeof out_study->machine.host_cpu,
		 "a processor <of> \"tests\" & more");
	make_lists(made, out_study);
	make_points(out_study);
}

void make_rows(struct gz_study *study, made_row *measure)
{
	const size_t count = study->scene_count * study->size_count * study->backend_count *
			     study->point_count * study->variant_count *
			     (size_t)study->frames_per_point;
	study->rows = room(count, sizeof study->rows[0]);
	study->row_count = count;
	for (size_t i = 0; i < count; i++) {
		struct gz_study_row *row = &study->rows[i];
		size_t rest = i;
		row->frame = (uint32_t)(rest % (size_t)study->frames_per_point);
		rest /= (size_t)study->frames_per_point;
		row->variant = (uint16_t)(rest % study->variant_count);
		rest /= study->variant_count;
		row->point = (uint32_t)(rest % study->point_count);
		rest /= study->point_count;
		row->backend = (uint16_t)(rest % study->backend_count);
		rest /= study->backend_count;
		row->size = (uint16_t)(rest % study->size_count);
		row->scene = (uint16_t)(rest / study->size_count);
		row->gaze = study->points[row->point].gaze;
		row->gpu_ms = row->prepare_ms = NAN;
		row->flicker = row->turning_error = row->reference_db = NAN;
		row->camera_path_error = NAN;
		row->converged = row->standard = no_errors();
		measure(study, row);
	}
}
