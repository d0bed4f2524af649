#include "view/frame/comparison.h"

#include <math.h>
#include <semaphore.h>
#include <stdlib.h>
#include <string.h>

#include "view/frame/reference.h"

#define GZ_LOG_MODULE "gazeview"

struct gz_comparison {
	const struct gz_frame_maker *maker;
	struct gz_reference_worker *worker;
	sem_t finished; /* posted for each picture that is finished or has failed */
	struct gz_image standard;
};

/* Called on the worker's thread. */
static void tell_standard_finished(void *user)
{
	struct gz_comparison *comparison = user;
	sem_post(&comparison->finished);
}

static enum gz_result start_worker(struct gz_comparison *comparison,
				   const struct gz_view_options *options, const struct gz_log *log)
{
	const struct gz_scene *scene = gz_frame_maker_scene(comparison->maker);
	struct gz_object objects[GZ_SCENE_LISTED_MAX];
	const struct gz_reference_source source = {
		.objects = objects,
		.object_count = gz_frame_list_objects(comparison->maker, objects),
		.backend = gz_frame_standard_backend(comparison->maker),
		.gl_memory_bytes = (size_t)options->gl_memory_mib << 20,
		.threads = options->threads,
		.finished = tell_standard_finished,
		.user = comparison,
		.log = log,
	};
	return gz_reference_worker_start(&source, &scene->transfer, &comparison->worker);
}

enum gz_result gz_comparison_start(const struct gz_frame_maker *maker,
				   const struct gz_view_options *options, const struct gz_log *log,
				   struct gz_comparison **out_comparison)
{
	struct gz_comparison *comparison = calloc(1, sizeof *comparison);
	if (!comparison)
		return GZ_ERR_NO_MEM;
	comparison->maker = maker;
	if (sem_init(&comparison->finished, 0, 0) != 0) {
		free(comparison);
		return GZ_ERR_NO_MEM;
	}
	const enum gz_result r = start_worker(comparison, options, log);
	if (r != GZ_OK) {
		gz_err(log, "no standard picture to compare with: %s",
		       r == GZ_ERR_UNSUPPORTED ? "volumes of bricks are read for one picture only"
					       : gz_result_text(r));
		gz_comparison_stop(&comparison);
		return r;
	}
	*out_comparison = comparison;
	return GZ_OK;
}

/* Make the standard picture of a view. */
static enum gz_result make_standard(struct gz_comparison *comparison,
				    const struct gz_reference_view *view)
{
	struct gz_object objects[GZ_SCENE_LISTED_MAX];
	const size_t count = gz_frame_list_objects(comparison->maker, objects);
	double share;
	if (gz_reference_worker_set_objects(comparison->worker, objects, count) != GZ_OK)
		return GZ_ERR_NO_MEM;
	gz_reference_worker_set_transfer(comparison->worker, gz_frame_transfer(comparison->maker));
	const bool another = gz_reference_worker_ask(comparison->worker, view);
	while (gz_reference_worker_busy(comparison->worker, &share))
		while (sem_wait(&comparison->finished) != 0) /* a signal came */
			;
	const bool taken = gz_reference_worker_take(comparison->worker, &comparison->standard);
	return taken || !another ? GZ_OK : GZ_ERR_UNSUPPORTED;
}

enum gz_result gz_comparison_join(struct gz_comparison *comparison,
				  const struct gz_frame_request *request, struct gz_image *image)
{
	const struct gz_scene_settings *settings = request->settings;
	struct gz_reference_view view = {
		.camera = settings->camera,
		.rays = *gz_frame_rays(comparison->maker),
		.image_sampling_rate = settings->image_sampling_rate,
		.width = request->width,
		.height = request->height,
	};
	if (settings->view.compare_with == GZ_COMPARE_WITH_PLAIN)
		gz_illustration_look_show_plain(&view.rays.illustration);
	const enum gz_result r = make_standard(comparison, &view);
	if (r != GZ_OK)
		return r;
	if (settings->view.compare == GZ_COMPARE_SPLIT)
		gz_comparison_split(image, &comparison->standard, settings->view.split);
	else if (settings->view.compare == GZ_COMPARE_DIFFERENCE)
		gz_comparison_subtract(image, &comparison->standard,
				       settings->view.difference_gain);
	return GZ_OK;
}

void gz_comparison_stop(struct gz_comparison **comparison)
{
	struct gz_comparison *self = *comparison;
	if (!self)
		return;
	gz_reference_worker_stop(&self->worker);
	gz_image_free(&self->standard);
	sem_destroy(&self->finished);
	free(self);
	*comparison = NULL;
}

void gz_comparison_split(struct gz_image *image, const struct gz_image *standard, double split)
{
	const size_t stride = 4 * (size_t)image->width;
	const size_t left = 4 * (size_t)lround(split * image->width);
	for (size_t y = 0; y < (size_t)image->height; y++)
		memcpy(image->pixels + y * stride + left, standard->pixels + y * stride + left,
		       stride - left);
}

void gz_comparison_subtract(struct gz_image *image, const struct gz_image *standard, double gain)
{
	const size_t bytes = 4 * (size_t)image->width * (size_t)image->height;
	for (size_t i = 0; i < bytes; i++) {
		const double apart = gain * abs(image->pixels[i] - standard->pixels[i]);
		image->pixels[i] = i % 4 == 3 ? 255 : (uint8_t)lround(fmin(apart, 255));
	}
}
