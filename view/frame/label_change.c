#include "view/frame/label_change.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

struct gz_label_change {
	struct gz_scene_label_request request; /* points to the next two */
	struct gz_scene_settings settings;
	double centre[3];
	void (*finished_function)(void *user);
	const struct gz_log *log;
	pthread_t thread;
	atomic_bool finished;
	/* written by the thread, read when it has ended */
	struct gz_label_surfaces *labels;
	enum gz_result result;
};

static void *label_thread(void *user)
{
	struct gz_label_change *change = user;
	change->result = gz_scene_make_labels(&change->request, change->log, &change->labels);
	atomic_store(&change->finished, true);
	if (change->finished_function)
		change->finished_function(NULL);
	return NULL;
}

enum gz_result gz_label_change_start(const struct gz_scene_label_request *request,
				     void (*finished)(void *user), const struct gz_log *log,
				     struct gz_label_change **out_change)
{
	struct gz_label_change *change = calloc(1, sizeof *change);
	if (!change)
		return GZ_ERR_NO_MEM;
	change->settings = *request->settings;
	memcpy(change->centre, request->centre, sizeof change->centre);
	change->request = (struct gz_scene_label_request) {
		.name = request->name,
		.settings = &change->settings,
		.centre = change->centre,
	};
	change->finished_function = finished;
	change->log = log;
	if (pthread_create(&change->thread, NULL, label_thread, change) != 0) {
		free(change);
		return GZ_ERR_NO_MEM;
	}
	*out_change = change;
	return GZ_OK;
}

bool gz_label_change_finished(struct gz_label_change *change)
{
	return atomic_load(&change->finished);
}

const struct gz_label_look *gz_label_change_look(const struct gz_label_change *change)
{
	return &change->settings.labels;
}

enum gz_result gz_label_change_take(struct gz_label_change **change,
				    struct gz_label_surfaces **out_labels)
{
	struct gz_label_change *self = *change;
	pthread_join(self->thread, NULL);
	const enum gz_result result = self->result;
	if (result == GZ_OK)
		*out_labels = self->labels;
	free(self);
	*change = NULL;
	return result;
}
