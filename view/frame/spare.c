#include "view/frame/spare.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/display.h"

/* Edge of the picture that makes all ready, px. Chosen: a tile. */
#define READY_PX 16

struct gz_spare {
	struct gz_spare_request request; /* its objects and settings are the spare's own */
	struct gz_object *objects;
	struct gz_scene_settings settings;
	pthread_t thread;
	atomic_bool finished;
	/* written by the thread, read when it has ended */
	struct gz_picture_maker *maker;
	enum gz_result result;
};

/* A small picture needs all that a large one does. */
static enum gz_result make_ready(struct gz_spare *spare)
{
	const struct gz_foveation foveation = gz_foveation_full();
	const struct gz_display display = gz_display_default(READY_PX, READY_PX);
	const struct gz_picture_request picture = {
		.camera = &spare->settings.camera,
		.settings = &spare->settings.rays,
		.foveation = &foveation,
		.display = &display,
		.focus = gz_focus_at((struct gz_point) { 0.5F, 0.5F }),
		.width = READY_PX,
		.height = READY_PX,
	};
	const struct gz_picture_maker_params params = {
		.backend = "cpu",
		.backend_params = spare->request.params,
	};
	struct gz_image *image;
	enum gz_result r = gz_picture_maker_create(&params, spare->request.log, &spare->maker);
	if (r == GZ_OK)
		r = gz_picture_maker_show(spare->maker, spare->objects,
					  spare->request.object_count);
	return r == GZ_OK ? gz_picture_make(spare->maker, &picture, &image, NULL) : r;
}

static void *spare_thread(void *user)
{
	struct gz_spare *spare = user;
	spare->result = make_ready(spare);
	atomic_store(&spare->finished, true);
	if (spare->request.finished)
		spare->request.finished(NULL);
	return NULL;
}

enum gz_result gz_spare_start(const struct gz_spare_request *request, struct gz_spare **out_spare)
{
	struct gz_spare *spare = calloc(1, sizeof *spare);
	if (!spare)
		return GZ_ERR_NO_MEM;
	spare->request = *request;
	spare->settings = *request->settings;
	spare->objects = calloc(request->object_count + 1, sizeof *spare->objects);
	if (spare->objects)
		memcpy(spare->objects, request->objects,
		       request->object_count * sizeof *spare->objects);
	if (!spare->objects || pthread_create(&spare->thread, NULL, spare_thread, spare) != 0) {
		free(spare->objects);
		free(spare);
		return GZ_ERR_NO_MEM;
	}
	*out_spare = spare;
	return GZ_OK;
}

bool gz_spare_finished(struct gz_spare *spare)
{
	return atomic_load(&spare->finished);
}

bool gz_spare_suits(const struct gz_spare *spare, const struct gz_scene_settings *settings)
{
	return spare->settings.rays.surface.isovalue == settings->rays.surface.isovalue &&
	       spare->settings.technique == settings->technique;
}

enum gz_result gz_spare_take(struct gz_spare **spare, struct gz_picture_maker **out_maker)
{
	struct gz_spare *self = *spare;
	pthread_join(self->thread, NULL);
	const enum gz_result result = self->result;
	if (result == GZ_OK)
		*out_maker = self->maker;
	else
		gz_picture_maker_destroy(&self->maker);
	free(self->objects);
	free(self);
	*spare = NULL;
	return result;
}

void gz_spare_drop(struct gz_spare **spare)
{
	struct gz_picture_maker *maker = NULL;
	if (!*spare)
		return;
	if (gz_spare_take(spare, &maker) == GZ_OK)
		gz_picture_maker_destroy(&maker);
}
