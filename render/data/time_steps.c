#include "render/data/time_steps.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>

#include "base/clock.h"

enum { NO_STEP = -1 };

struct gz_time_steps {
	struct gz_time_step_source source;
	pthread_t thread;
	pthread_mutex_t lock;
	pthread_cond_t wake; /* of both sides */
	/* under the lock */
	bool quit;
	int wanted;  /* step to load; NO_STEP: none */
	int loading; /* step that the thread loads; NO_STEP: none */
	int loaded;  /* step of the result below; NO_STEP: none */
	enum gz_result result;
	void *data; /* only with GZ_OK */
};

/* Whether the step that the thread loads is still wanted. */
static bool is_step_wanted(void *user, double share, const char *what)
{
	struct gz_time_steps *steps = user;
	(void)share;
	(void)what;
	pthread_mutex_lock(&steps->lock);
	const bool wanted =
		!steps->quit && (steps->wanted == NO_STEP || steps->wanted == steps->loading);
	pthread_mutex_unlock(&steps->lock);
	return wanted;
}

/* Release what was loaded and not taken. Under the lock. */
static void drop_loaded(struct gz_time_steps *steps)
{
	if (steps->loaded != NO_STEP && steps->result == GZ_OK)
		steps->source.release(steps->source.user, steps->data);
	steps->loaded = NO_STEP;
}

/* Load the wanted step. Under the lock, which is released meanwhile. */
static void load_wanted(struct gz_time_steps *steps)
{
	const struct gz_time_step_source *source = &steps->source;
	const struct gz_loading loading = { .report = is_step_wanted, .user = steps };
	const int step = steps->wanted;
	void *data = NULL;
	drop_loaded(steps);
	steps->loading = step;
	steps->wanted = NO_STEP;
	pthread_mutex_unlock(&steps->lock);
	const enum gz_result result = source->load(source->user, step, &loading, &data);
	pthread_mutex_lock(&steps->lock);
	steps->loading = NO_STEP;
	if (result == GZ_ERR_CANCELLED)
		return;
	steps->loaded = step;
	steps->result = result;
	steps->data = data;
	pthread_cond_broadcast(&steps->wake);
	if (source->finished)
		source->finished(source->user);
}

static void *run_time_steps(void *user)
{
	struct gz_time_steps *steps = user;
	pthread_mutex_lock(&steps->lock);
	while (!steps->quit) {
		if (steps->wanted != NO_STEP)
			load_wanted(steps);
		else
			pthread_cond_wait(&steps->wake, &steps->lock);
	}
	pthread_mutex_unlock(&steps->lock);
	return NULL;
}

enum gz_result gz_time_steps_create(const struct gz_time_step_source *source,
				    struct gz_time_steps **out_steps)
{
	if (source->count < 1)
		return GZ_ERR_INVAL;
	struct gz_time_steps *steps = calloc(1, sizeof *steps);
	if (!steps)
		return GZ_ERR_NO_MEM;
	steps->source = *source;
	steps->wanted = steps->loading = steps->loaded = NO_STEP;
	pthread_mutex_init(&steps->lock, NULL);
	pthread_cond_init(&steps->wake, NULL);
	if (pthread_create(&steps->thread, NULL, run_time_steps, steps) != 0) {
		pthread_cond_destroy(&steps->wake);
		pthread_mutex_destroy(&steps->lock);
		free(steps);
		return GZ_ERR_NO_MEM;
	}
	*out_steps = steps;
	return GZ_OK;
}

/* Under the lock. */
static void want_step(struct gz_time_steps *steps, int step)
{
	if (steps->loaded == step)
		return;
	/* Wanted again before it was cancelled: it goes on. */
	steps->wanted = steps->loading == step ? NO_STEP : step;
	pthread_cond_broadcast(&steps->wake);
}

void gz_time_steps_expect(struct gz_time_steps *steps, int step)
{
	if (step < 0 || step >= steps->source.count)
		return;
	pthread_mutex_lock(&steps->lock);
	want_step(steps, step);
	pthread_mutex_unlock(&steps->lock);
}

enum gz_result gz_time_steps_take(struct gz_time_steps *steps, int step, bool wait, void **out_data)
{
	if (step < 0 || step >= steps->source.count)
		return GZ_ERR_INVAL;
	enum gz_result result = GZ_ERR_TIMEOUT;
	pthread_mutex_lock(&steps->lock);
	want_step(steps, step);
	while (wait && steps->loaded != step) {
		pthread_cond_wait(&steps->wake, &steps->lock);
		want_step(steps, step);
	}
	if (steps->loaded == step) {
		result = steps->result;
		if (result == GZ_OK)
			*out_data = steps->data;
		steps->loaded = NO_STEP;
	}
	pthread_mutex_unlock(&steps->lock);
	return result;
}

void gz_time_steps_destroy(struct gz_time_steps **steps_pointer)
{
	struct gz_time_steps *steps = *steps_pointer;
	if (!steps)
		return;
	pthread_mutex_lock(&steps->lock);
	steps->quit = true;
	pthread_cond_broadcast(&steps->wake);
	pthread_mutex_unlock(&steps->lock);
	pthread_join(steps->thread, NULL);
	drop_loaded(steps);
	pthread_cond_destroy(&steps->wake);
	pthread_mutex_destroy(&steps->lock);
	free(steps);
	*steps_pointer = NULL;
}

static int64_t playback_period_ns(const struct gz_playback *playback)
{
	return (int64_t)((double)GZ_NS_PER_S / playback->rate);
}

void gz_playback_start(struct gz_playback *playback, double rate, int64_t now_ns)
{
	playback->playing = true;
	playback->rate = rate;
	playback->due_ns = now_ns + playback_period_ns(playback);
}

bool gz_playback_due(const struct gz_playback *playback, int64_t now_ns)
{
	return playback->playing && now_ns >= playback->due_ns;
}

void gz_playback_shown(struct gz_playback *playback, int64_t now_ns)
{
	if (!playback->playing)
		return;
	const int64_t period_ns = playback_period_ns(playback);
	const bool late = now_ns > playback->due_ns + period_ns;
	playback->due_ns = (late ? now_ns : playback->due_ns) + period_ns;
}

int gz_playback_step_of_frame(int first, int count, double rate, double time_s)
{
	/* Dividing whole frames by whole rates leaves rounding: a step begins at its time. */
	const double steps = floor(time_s * rate + 1e-9);
	return (int)fmod((double)first + steps, count);
}
