/**
 * @file
 * How the plan follows the eye over time: where it is sharp, how much coarser it may be outside,
 * and what happens when the gaze is lost. Pure steps over a state: no clock, no input or output, no
 * allocation. The caller passes the time, so a replay gives the same plans.
 *
 * - Fixation: the place stays the same while the gaze is within a dead band of it.
 * - Saccade: vision is suppressed, so the plan moves with the gaze, or to where a large one will
 *   probably land, and is coarser. The first step
 *   that knows of the landing is sharp there. For another 60 ms the plan follows every sample,
 * while the tracker settles on the exact place; nobody notices changes in that time.
 * - Blink: nothing changes.
 * - Lost gaze: the place is held for a while. Then the plan widens, step by step, to evenly spread
 *   rays at the same cost, since the eye may look anywhere. The first step that knows the gaze
 * again is sharp there.
 * - A frame-time budget makes the plan as coarse as needed (render/attention/budget.h).
 *
 * docs/gaze-pipeline.md explains the events.
 */
#ifndef GZ_RENDER_ATTENTION_H
#define GZ_RENDER_ATTENTION_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/option.h"
#include "protocol/display.h"
#include "protocol/gaze.h"
#include "render/attention/budget.h"

/** Settings; the option keys are "attention.<name>". */
struct gz_attention_params {
	double dead_band_deg;   /**< the plan moves when the gaze is farther away than this */
	double dead_band_noise; /**< and farther than so many times the tracker's noise */
	double saccade_scale;   /**< factor on spacings outside the fovea in a saccade */
	double landing_deg;     /**< in a saccade of at least this predicted size the plan moves to
				   where it will land; 0: never */
	double blink_ms;        /**< longest blink; also the greatest age of a gaze */
	double hold_ms;         /**< how long the plan of a lost gaze is kept */
	double widen_ms;        /**< how long the plan then takes to become uniform; 0: it stays */
	double budget_ms;       /**< frame time at the 95th percentile; 0: no budget */
	double importance;      /**< how far the object that is looked at is raised in importance,
				   [0, 1]: render/attention/interest.h */
	double importance_dwell_ms; /**< after so long a look */
	double importance_fade_ms;  /**< how long it fades in and out */
};

/** Table over struct gz_attention_params. */
extern const struct gz_option gz_attention_options[];
extern const size_t gz_attention_option_count;

/** The table's presets. */
struct gz_attention_params gz_attention_default(void);

/** What is known of the gaze at one moment. */
struct gz_attention_gaze {
	bool known;            /**< there is a point */
	struct gz_point point; /**< on the display, normalised; NaN or infinite means lost */
	bool has_age;
	int64_t age_ns;            /**< of the sample that gave the point; only with has_age */
	bool has_event;            /**< the source says what the eye does */
	enum gz_event event;       /**< only with has_event */
	struct gz_landing landing; /**< of the running saccade, on the display; its time is not used
				    */
	double noise_deg;          /**< of the tracker, sample to sample; NaN if unknown */
};

/** What the plan follows. */
enum gz_attention_state {
	GZ_ATTENTION_FIXATION, /**< the eye is at rest, or the source reports no events */
	GZ_ATTENTION_SACCADE,
	GZ_ATTENTION_PURSUIT,
	GZ_ATTENTION_BLINK, /**< nothing changes */
	GZ_ATTENTION_HOLD,  /**< lost; the place is held */
	GZ_ATTENTION_WIDEN, /**< lost; the plan is widening, or wide */
	GZ_ATTENTION_STATE_COUNT,
};

/** "fixation", "saccade", "pursuit", "blink", "hold", "widen"; static text. */
const char *gz_attention_state_name(enum gz_attention_state state);

/** Where a plan is sharp, and how coarse it is. */
struct gz_focus {
	struct gz_point
		point; /**< where it is sharp, normalised; NaN before the first gaze: the centre */
	double scale;  /**< factor on spacings outside the fovea, 1 or more */
	double widen;  /**< 0: sharp at the point, to 1: uniform */
	/** gz_plan_request.finer; 0: as earlier pictures let it grow (foveation.still_growth). */
	double finer;
};

/** Whether both give the same plan. */
bool gz_focus_same(const struct gz_focus *a, const struct gz_focus *b);

/** The state; plain data. gz_attention_init() fills it. */
struct gz_attention {
	struct gz_attention_params params;
	struct gz_budget budget;
	struct gz_focus focus; /**< without the budget's scale */
	enum gz_attention_state state;
	enum gz_attention_state said; /**< state by the gaze alone */
	int64_t said_ns;              /**< since when */
	int64_t lost_ns;              /**< since when; only in HOLD and WIDEN */
	struct gz_point left;         /**< the last gaze outside saccades; NaN after a loss */
	bool on_way;                  /**< the plan is following a saccade */
	bool landed;                  /**< landed_ns is valid */
	int64_t landed_ns;            /**< when the plan last came to rest in a new place */
	int64_t now_ns;               /**< of the newest step */
	bool started;                 /**< there was a step */
};

/** Set the start state: no gaze has been seen. @p params must be within the table's ranges. */
void gz_attention_init(struct gz_attention *attention, const struct gz_attention_params *params);

/** Change the settings from the next step on. The place stays. A new budget starts at full detail.
 */
void gz_attention_set_params(struct gz_attention *attention,
			     const struct gz_attention_params *params);

/**
 * Advance by one frame with what is known of the gaze at @p now_ns.
 *
 * @param display  the display that the gaze's point refers to; valid
 * @param now_ns   any origin; a time before the last one counts as the last
 * @return the focus of the frame's plan
 */
struct gz_focus gz_attention_step(struct gz_attention *attention,
				  const struct gz_attention_gaze *gaze,
				  const struct gz_display *display, int64_t now_ns);

/** Whether later steps with the same gaze give the same focus. If not, call gz_attention_step() for
 *  each frame. */
bool gz_attention_settled(const struct gz_attention *attention);

/** The dead band that applies with this noise of a tracker, degrees. @p noise_deg may be NaN. */
double gz_attention_dead_band_deg(const struct gz_attention_params *params, double noise_deg);

/**
 * Report the time of the frame made by the last step. Does nothing without a budget.
 *
 * @param kept  many of its rays are of earlier frames. The next frame may have to cast all of them,
 *              so it gives no reason for a finer plan
 * @return true once, when even the coarsest plan exceeds the budget (gz_budget_step())
 */
bool gz_attention_spent(struct gz_attention *attention, double frame_ms, bool kept);

/** Forget all frame times and start again at full detail, for instance after a change of scene. */
void gz_attention_forget_spent(struct gz_attention *attention);

#endif
