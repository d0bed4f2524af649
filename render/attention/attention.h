/**
 * @file
 * How the plan follows the eye over time: where it is sharp, how much coarser it may be outside,
 * and what happens when the eye is not seen. Pure steps over a state: no clock, no input or output,
 * no allocation; times come in, so that a replay gives the same plans.
 *
 * - A still eye sees a still picture: the place stays while the gaze is within a dead band of it.
 * - In a saccade, where vision is suppressed, the plan goes with the gaze and is coarser; the first
 *   step that knows of the landing is sharp there. For 60 ms it goes on with the gaze, while the
 *   tracker finds out where exactly the eye has come to rest; what changes then goes unseen.
 * - A blink holds everything. A lost gaze holds the place a while; then the plan widens, step by
 *   step, towards rays spread evenly at the same cost, for the eye may be anywhere. The first step
 *   that knows the gaze again is sharp there.
 * - A time to keep makes the plan coarser as far as needed (render/attention/budget.h).
 *
 * What the events mean stands in docs/gaze-pipeline.md.
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

/** Settings; the table's keys are "attention.<name>". */
struct gz_attention_params {
	double dead_band_deg;   /**< the gaze moves the plan once it is farther than this from it */
	double dead_band_noise; /**< and than so many times the tracker's noise */
	double saccade_scale;   /**< spacing outside the fovea in a saccade, times the usual one */
	double blink_ms;        /**< longest blink; also how old a gaze may be */
	double hold_ms;         /**< a lost gaze keeps its plan so long */
	double widen_ms;        /**< then the plan takes so long to become even; 0: it stays */
	double budget_ms;       /**< of a frame, at its 95th percentile; 0: none */
};

/** Table over struct gz_attention_params. */
extern const struct gz_option gz_attention_options[];
extern const size_t gz_attention_option_count;

/** The table's presets. */
struct gz_attention_params gz_attention_default(void);

/** What is known of the gaze at one moment. */
struct gz_attention_gaze {
	bool known;            /**< point holds something */
	struct gz_point point; /**< on the display; not finite counts as lost */
	bool has_age;
	int64_t age_ns;      /**< of the sample that gave the point; only with has_age */
	bool has_event;      /**< whoever gives the gaze tells what the eye does */
	enum gz_event event; /**< only with has_event */
	double noise_deg;    /**< of the tracker, sample to sample; NaN where not known */
};

/** What the plan goes by. */
enum gz_attention_state {
	GZ_ATTENTION_FIXATION, /**< the gaze is within the dead band, or told by no tracker */
	GZ_ATTENTION_SACCADE,
	GZ_ATTENTION_PURSUIT,
	GZ_ATTENTION_BLINK, /**< held as it was */
	GZ_ATTENTION_HOLD,  /**< lost, and held */
	GZ_ATTENTION_WIDEN, /**< lost, and widening or wide */
	GZ_ATTENTION_STATE_COUNT,
};

/** "fixation", "saccade", "pursuit", "blink", "hold", "widen"; static text. */
const char *gz_attention_state_name(enum gz_attention_state state);

/** What a plan is made of, beside method and display. */
struct gz_focus {
	struct gz_point point; /**< where it is sharp; NaN before there was a gaze: the centre */
	double scale;          /**< of spacings outside the fovea, 1 or more */
	double widen;          /**< 0: round the point, to 1: even */
};

/** Whether both make the same plan. */
bool gz_focus_same(const struct gz_focus *a, const struct gz_focus *b);

/** The state; plain data. gz_attention_init() fills it. */
struct gz_attention {
	struct gz_attention_params params;
	struct gz_budget budget;
	struct gz_focus focus; /**< its scale without the budget's */
	enum gz_attention_state state;
	enum gz_attention_state said; /**< what the gaze alone said, and said_ns since when */
	int64_t said_ns;
	int64_t lost_ns;   /**< since when; only in HOLD and WIDEN */
	bool on_way;       /**< the plan goes with a saccade */
	bool landed;       /**< landed_ns holds something */
	int64_t landed_ns; /**< when the plan last came to rest somewhere else */
	int64_t now_ns;    /**< of the newest step */
	bool started;      /**< there was one */
};

/** Into the start state: no gaze has been seen. @p params within the table's ranges. */
void gz_attention_init(struct gz_attention *attention, const struct gz_attention_params *params);

/** Other settings, from the next step on; the place stays. A new budget starts at full detail. */
void gz_attention_set_params(struct gz_attention *attention,
			     const struct gz_attention_params *params);

/**
 * Take what is known of the gaze at @p now_ns.
 *
 * @param display  what the gaze's point is on; valid
 * @param now_ns   any origin; a time before the last one counts as the last
 * @return what the frame's plan is made of
 */
struct gz_focus gz_attention_step(struct gz_attention *attention,
				  const struct gz_attention_gaze *gaze,
				  const struct gz_display *display, int64_t now_ns);

/** Whether a later step with the same gaze gives the same focus; else one must be made for each
 *  frame. */
bool gz_attention_settled(const struct gz_attention *attention);

/** The dead band in force, degrees. @p noise_deg may be NaN. */
double gz_attention_dead_band_deg(const struct gz_attention_params *params, double noise_deg);

/**
 * What the frame made by the last step took. Without a budget nothing happens.
 *
 * @return true once: when the budget turns out to be out of reach, as by gz_budget_step()
 */
bool gz_attention_spent(struct gz_attention *attention, double frame_ms);

/** What frames took so far tells nothing of those that follow: full detail again. */
void gz_attention_forget_spent(struct gz_attention *attention);

#endif
