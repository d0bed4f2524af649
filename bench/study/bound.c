#include "bench/study/bound.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/workers.h"
#include "render/plan/plan.h"

#define GZ_LOG_MODULE "study"

/* Places along an edge that the mean is taken over, at most. Chosen: at 1024 px they lie 4 px
 * apart, over which the spacing changes by a few hundredths. */
enum { PLACES = 256 };

double gz_bound_rays(const struct gz_display *display, struct gz_point gaze, int width, int height)
{
	const struct gz_foveation foveation = gz_foveation_default();
	const int columns = width < PLACES ? width : PLACES;
	const int rows = height < PLACES ? height : PLACES;
	double sum = 0;
	for (int y = 0; y < rows; y++)
		for (int x = 0; x < columns; x++) {
			const struct gz_point place = { ((float)x + 0.5F) / (float)columns,
							((float)y + 0.5F) / (float)rows };
			const double spacing = fmax(gz_acuity_spacing_px(&foveation, display, gaze,
									 place, width, height),
						    1);
			sum += 1 / (spacing * spacing);
		}
	return sum / (columns * rows);
}

/* What the threads share: one part a value. */
struct job {
	struct gz_study *study;
	size_t scene, size;
	double *values;
};

static void make_value(void *user, size_t point, int worker)
{
	const struct job *job = user;
	const struct gz_study *study = job->study;
	const struct gz_display display = gz_study_display(study, job->scene, job->size);
	(void)worker;
	job->values[point] = gz_bound_rays(&display, study->points[point].gaze,
					   study->sizes[job->size][0], study->sizes[job->size][1]);
}

static bool same_geometry(const struct gz_study *study, size_t a, size_t b)
{
	const struct gz_study_scene *x = &study->scenes[a], *y = &study->scenes[b];
	return x->display_known == y->display_known && x->display.mm[0] == y->display.mm[0] &&
	       x->display.mm[1] == y->display.mm[1] &&
	       x->display.distance_mm == y->display.distance_mm;
}

enum gz_result gz_bound_rays_make(struct gz_study *study, const struct gz_log *log)
{
	const size_t points = study->point_count, per_scene = study->size_count * points;
	struct gz_workers *workers = NULL;
	double *values = calloc(study->scene_count * per_scene, sizeof *values);
	if (!values || gz_workers_create(0, &workers) != GZ_OK) {
		gz_err(log, "no memory for the acuity bound");
		free(values);
		return GZ_ERR_NO_MEM;
	}
	for (size_t scene = 0; scene < study->scene_count; scene++) {
		double *row = values + scene * per_scene;
		if (scene > 0 && same_geometry(study, scene, scene - 1)) {
			memcpy(row, row - per_scene, per_scene * sizeof *row);
			continue;
		}
		for (size_t size = 0; size < study->size_count; size++) {
			struct job job = { study, scene, size, row + size * points };
			gz_workers_run(workers, make_value, &job, points);
		}
	}
	gz_workers_destroy(&workers);
	free(study->bound_rays);
	study->bound_rays = values;
	return GZ_OK;
}
