/**
 * @file
 * A sequence of steps in time, whatever its data are: one step is shown, the next one is loaded
 * ahead on a thread, and a clock says when it is due.
 */
#ifndef GZ_RENDER_DATA_TIME_STEPS_H
#define GZ_RENDER_DATA_TIME_STEPS_H

#include <stdbool.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "render/data/volume.h"

/** Slowest and fastest rate of playing, steps per second. Chosen: a step in a hundred seconds, and
 *  as many as displays show. */
#define GZ_PLAYBACK_RATE_MIN 0.01
#define GZ_PLAYBACK_RATE_MAX 240

/** Where the data of steps come from. */
struct gz_time_step_source {
	int count; /**< steps, 1 or more */
	void *user;
	/**
	 * Load a step, on a thread of its own.
	 *
	 * @param loading        its report says whether the step is still wanted
	 * @param[out] out_data  freed by release
	 * @return GZ_ERR_CANCELLED if @p loading says so; other failures are logged
	 */
	enum gz_result (*load)(void *user, int step, const struct gz_loading *loading,
			       void **out_data);
	void (*release)(void *user, void *data);
	/** Optional: a step is loaded or has failed; called on a thread of its own. */
	void (*finished)(void *user);
};

/** Loads steps ahead, one at a time. */
struct gz_time_steps;

/**
 * Start the thread. It waits until a step is asked for.
 *
 * @param source  copied; its user outlives the result
 * @param[out] out_steps  owned by the caller: gz_time_steps_destroy()
 * @retval GZ_ERR_INVAL   the source has no steps
 * @retval GZ_ERR_NO_MEM  no memory, or no thread; not logged
 */
enum gz_result gz_time_steps_create(const struct gz_time_step_source *source,
				    struct gz_time_steps **out_steps);

/** Load a step ahead, from 0, in place of another one that is being loaded or has not been taken.
 *  Does nothing if it is loaded already. Steps beyond the source's are ignored. */
void gz_time_steps_expect(struct gz_time_steps *steps, int step);

/**
 * Take a step; if it is not loaded, it is expected now.
 *
 * @param wait           wait until it is loaded
 * @param[out] out_data  the caller's, to be freed by the source's release
 * @retval GZ_ERR_TIMEOUT  it is being loaded
 * @retval GZ_ERR_INVAL    there is no such step
 * @return otherwise what the source's load returned; the next call tries again
 *
 * Threads: one caller.
 */
enum gz_result gz_time_steps_take(struct gz_time_steps *steps, int step, bool wait,
				  void **out_data);

/** Stop the thread, release what was not taken, and set to NULL. Accepts a pointer to NULL. */
void gz_time_steps_destroy(struct gz_time_steps **steps);

/** A clock for steps. Every step is shown, in order: if one is loaded late, those after it come
 *  later too. Zero-initialised stands still. */
struct gz_playback {
	bool playing;
	double rate;    /**< steps per second, GZ_PLAYBACK_RATE_MIN to GZ_PLAYBACK_RATE_MAX */
	int64_t due_ns; /**< when the next step is due */
};

/** Play from now on at @p rate, or change the rate. The next step is due one period later. */
void gz_playback_start(struct gz_playback *playback, double rate, int64_t now_ns);

/** Whether the next step is due. */
bool gz_playback_due(const struct gz_playback *playback, int64_t now_ns);

/** A step is shown: the next one is due a period after this one was, or, if this one is more than a
 *  period late, a period from now. */
void gz_playback_shown(struct gz_playback *playback, int64_t now_ns);

/** The step that pictures at regular times show: @p first, and one more each 1 / @p rate seconds,
 *  from the beginning again after the last. */
int gz_playback_step_of_frame(int first, int count, double rate, double time_s);

#endif
