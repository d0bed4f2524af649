/**
 * @file
 * The frame-time budget: how much coarser a plan must be so that the 95th percentile of the frame
 * times stays within the budget. Pure steps over a state: no clock, no allocation.
 *
 * The scale moves on rungs, so jitter of the frame times changes no picture. When 3 of the last 40
 * frames (more than 5 %) are too slow, the plan becomes coarser at once, by as many rungs as the
 * excess needs, and by twice as many if that did not help. A finer rung is tried after 40 frames
 * that left room for the greatest cost of a rung. If the trial fails, or slow frames are scattered
 * among fast ones, the next trial waits until frames are clearly cheaper or, after each failure,
 * twice as many frames have passed.
 */
#ifndef GZ_RENDER_BUDGET_H
#define GZ_RENDER_BUDGET_H

#include <stdbool.h>

/** Rungs of the scale: 1, 2^(1/4), 2^(1/2), … Chosen: a rung costs or saves at most 1.4 times the
 *  rays, which go with the scale's square. */
#define GZ_BUDGET_RUNGS 25
/** The scale of the last rung: 2^((GZ_BUDGET_RUNGS - 1) / 4). */
#define GZ_BUDGET_SCALE_MAX 64

/** Frames of the percentile: the fewest of which 5 % is more than one frame. */
#define GZ_BUDGET_WINDOW 40

/** How the frames keep the budget; for statistics. */
enum gz_budget_state {
	GZ_BUDGET_OFF,    /**< no budget is set */
	GZ_BUDGET_WITHIN, /**< the last frame kept it */
	GZ_BUDGET_OVER,   /**< the last frame exceeded it */
	GZ_BUDGET_LIMIT,  /**< even the coarsest plan exceeds it */
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
	int count; /**< frames since the rung changed, up to GZ_BUDGET_WINDOW; newest last */
	double frames_ms[GZ_BUDGET_WINDOW];
	int leaps;  /**< answers to slow frames since the last whole window within the budget */
	int waited; /**< whole windows since the rung changed */

	/** For each rung, the result of the last trial of a finer one. */
	struct {
		double before_ms; /**< percentile before the trial; infinite: no trial has failed */
		int fails;        /**< failed trials since frames were last clearly cheaper */
	} tries[GZ_BUDGET_RUNGS];
	int tried_from; /**< the rung before the present trial; 0 = no trial */
};

/** Start at full detail. @p budget_ms above 0, or 0 for no limit. */
void gz_budget_init(struct gz_budget *budget, double budget_ms);

/** Factor on the next frame's spacings: 1 to GZ_BUDGET_SCALE_MAX. */
double gz_budget_scale(const struct gz_budget *budget);

/**
 * Report the time of a frame with gz_budget_scale(). Times that are not finite or below 0 are
 * ignored.
 *
 * @return true once since gz_budget_init(), when even the coarsest plan exceeds the budget
 */
bool gz_budget_step(struct gz_budget *budget, double frame_ms);

/** Whether a few more frames like the last ones would leave the scale as it is. */
bool gz_budget_at_rest(const struct gz_budget *budget);

#endif
