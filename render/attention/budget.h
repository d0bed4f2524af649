/**
 * @file
 * A time to keep: how much coarser a plan must be for the 95th percentile of its frames to stay
 * within so many milliseconds. Pure steps over a state: no clock, no allocation.
 *
 * Scales are rungs, so that a frame's jitter changes no picture. Too slow is seen as soon as it is
 * certain (3 of the last 40 frames, that is more than 5 %), and answered at once by as many rungs
 * as the frames were too slow, and twice as far where that did not help. A finer rung is tried
 * after 40 frames that left room for what a rung costs at most. Where that fails, or slow frames
 * are strewn among fast ones, it is not tried again before the frames are clearly cheaper or, each
 * time, twice as many have passed.
 */
#ifndef GZ_RENDER_BUDGET_H
#define GZ_RENDER_BUDGET_H

#include <stdbool.h>

/** Rungs of the scale: 1, 2^(1/4), 2^(1/2), … Chosen: a rung costs or saves at most 1.4 times the
 *  rays, which go with the scale's square. */
#define GZ_BUDGET_RUNGS 25
/** The scale of the last rung: 2^((GZ_BUDGET_RUNGS - 1) / 4). */
#define GZ_BUDGET_SCALE_MAX 64

/** Frames that the percentile is of: the least in which 5 % is more than one. */
#define GZ_BUDGET_WINDOW 40

/** For statistics. */
enum gz_budget_state {
	GZ_BUDGET_OFF,    /**< none is set */
	GZ_BUDGET_WITHIN, /**< so far as is known */
	GZ_BUDGET_OVER,   /**< the last frame was not */
	GZ_BUDGET_LIMIT,  /**< out of reach with the coarsest plan */
	GZ_BUDGET_STATE_COUNT,
};

/** "off", "within", "over", "limit"; static text. */
const char *gz_budget_state_name(enum gz_budget_state state);

/** Plain data; gz_budget_init() fills it. */
struct gz_budget {
	double budget_ms; /**< 0: none */
	int rung;
	enum gz_budget_state state;
	bool limit_told;
	int count; /**< frames since the rung was chosen, up to GZ_BUDGET_WINDOW; the newest last */
	double frames_ms[GZ_BUDGET_WINDOW];
	int leaps;  /**< over the budget in a row, since a whole window was not */
	int waited; /**< whole windows since the rung was chosen */

	/** How it went when the rung was last left for a finer one. */
	struct {
		double before_ms; /**< percentile that made it try; infinite: never failed */
		int fails;        /**< since frames were last clearly cheaper */
	} tries[GZ_BUDGET_RUNGS];
	int tried_from; /**< the rung that the present one is tried from; 0 if none is on trial */
};

/** Start at full detail. @p budget_ms above 0, or 0 for no limit. */
void gz_budget_init(struct gz_budget *budget, double budget_ms);

/** How much coarser the next frame is to be: 1 to GZ_BUDGET_SCALE_MAX. */
double gz_budget_scale(const struct gz_budget *budget);

/**
 * What the frame with gz_budget_scale() took. Not finite or below 0 counts for nothing.
 *
 * @return true once since gz_budget_init(): when the coarsest plan turns out not to be enough
 */
bool gz_budget_step(struct gz_budget *budget, double frame_ms);

/** Whether a few more frames like the last would not make it finer. */
bool gz_budget_at_rest(const struct gz_budget *budget);

#endif
