/**
 * @file
 * An experiment as it goes: texts, cross, intervals, question, feedback, by the clock and by keys.
 * Knows no window: whoever shows it asks gz_run_screen() what to show, tells gz_run_shown() when it
 * was there, hands over keys, and calls gz_run_step() each frame. What happens comes out as marks
 * and, for each trial, a result.
 *
 * A trial that Escape interrupts, and that is then gone on with, begins again.
 */
#ifndef GZ_VIEW_EXPERIMENT_RUN_H
#define GZ_VIEW_EXPERIMENT_RUN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "view/experiment/sequence.h"

/** What is on the screen. */
enum gz_run_phase {
	GZ_RUN_TEXT,     /**< instructions, a break, the end: until Space */
	GZ_RUN_PREPARE,  /**< until the trial's pictures can be shown */
	GZ_RUN_FIXATION, /**< the cross */
	GZ_RUN_INTERVAL, /**< the picture */
	GZ_RUN_BLANK,
	GZ_RUN_QUESTION,
	GZ_RUN_FEEDBACK,
	GZ_RUN_PAUSE,
	GZ_RUN_LEAVING, /**< Escape again leaves, Space goes on */
	GZ_RUN_ENDED,
};

/** Bins of gz_trial_frames: 0.1 ms each, the last one for all above. */
#define GZ_RUN_GAP_BINS 10000

/** The frames of a trial's intervals, from one swap to the next. */
struct gz_trial_frames {
	uint64_t count;
	uint64_t dropped; /**< refreshes of the display that showed no new frame */
	uint32_t gaps[GZ_RUN_GAP_BINS];
	int64_t total_ns, lost_ns; /**< time in intervals, and that without gaze */
	bool gaze_told;            /**< lost_ns says something */
};

/** What came of a trial. Times are host times; 0 where it did not come to that. */
struct gz_trial_result {
	size_t index; /**< in the sequence */
	const struct gz_presentation *presentation;
	int64_t begin_ns; /**< of the first thing shown of it */
	int64_t on_ns[2], off_ns[2];
	int64_t question_ns;
	int64_t end_ns;   /**< the answer, or the end of the wait for it */
	int answer;       /**< index of the condition's answers; -1: none in time */
	int chosen;       /**< alternative, where the question is which interval; else -1 */
	int right;        /**< 1, 0; -1: nothing is right or wrong */
	int restarts;     /**< it was interrupted so often */
	uint64_t frames;  /**< in its intervals */
	uint64_t dropped; /**< see struct gz_trial_frames */
	double frame_ms;  /**< median from swap to swap, to 0.1 ms; NaN: no frames */
	double gaze_loss; /**< share of the intervals without gaze, 0 to 1; NaN: not known */
};

/** Who is told of what happens. */
struct gz_run_sink {
	void *user;
	/** Something happened at @p time_ns. @p label is text without tabs, below 200 bytes. */
	void (*mark)(void *user, const char *label, int64_t time_ns);
	/** A trial is over. Anything but GZ_OK, which it has logged, ends the experiment. */
	enum gz_result (*over)(void *user, const struct gz_trial_result *result);
};

/** A run. Its fields are for run.c, but that all may read phase and result. */
struct gz_run {
	const struct gz_experiment *experiment;
	const struct gz_sequence *sequence;
	struct gz_run_sink sink;
	const char *participant, *session;
	size_t index, first; /* in the sequence: of this trial, and of the run's first */
	enum gz_run_phase phase;
	int64_t shown_ns;       /* of the phase; 0: it is not on the screen yet */
	int page;               /* which of the texts before a trial */
	int interval;           /* in INTERVAL and BLANK: 0 or 1 */
	enum gz_run_phase left; /* LEAVING: from where */
	bool gaze_missing;      /* FIXATION goes on for that */
	int64_t gaze_missing_ns;
	bool begun, complete;
	int64_t frame_ns; /* the last swap in an interval; 0: none */
	struct gz_trial_frames frames;
	struct gz_trial_result trial;
	enum gz_result result; /**< GZ_ERR_CANCELLED: left; else what the sink returned */
};

/** What there is to show. */
struct gz_run_screen {
	enum gz_run_phase phase;
	/** INTERVAL: the picture; PREPARE: what is to be made ready comes from the presentation. */
	const struct gz_alternative *alternative;
	const struct gz_presentation *presentation; /**< NULL after the last */
	const char *text;                           /**< to show in the middle; NULL: none */
	size_t done, count;                         /**< trials, of all */
	bool gaze_missing;                          /**< the cross waits for a gaze */
};

/** What the moment brings. */
struct gz_run_input {
	int64_t now_ns;
	int64_t refresh_ns; /**< of the display: a phase ends with the frame nearest to its time */
	bool ready;         /**< the pictures of the presentation can be shown */
	bool gaze_there;    /**< the eye is seen */
};

/** A frame that was shown. */
struct gz_run_frame {
	int64_t shown_ns;
	int64_t refresh_ns; /**< of the display */
	bool gaze_told;     /**< gaze_there says something: there is a tracker */
	bool gaze_there;
};

/**
 * Begin.
 *
 * @param experiment, sequence, participant, session  borrowed, outlive the run
 * @param first  index of the first trial: 0, or where an earlier run was left
 * @param sink   copied
 */
void gz_run_begin(struct gz_run *run, const struct gz_experiment *experiment,
		  const struct gz_sequence *sequence, const char *participant, const char *session,
		  size_t first, const struct gz_run_sink *sink);

/** Go on where it is time to. @return whether what there is to show has changed */
bool gz_run_step(struct gz_run *run, const struct gz_run_input *input);

/** A key, enum gz_answer_key, was pressed. @return whether what there is to show has changed */
bool gz_run_key(struct gz_run *run, int key, int64_t now_ns);

/** End it where it is, for @p result: the trial that is not answered will come again. Nothing where
 *  it has ended, or all its trials are answered. */
void gz_run_stop(struct gz_run *run, enum gz_result result, int64_t now_ns);

/** What gz_run_screen() gave is on the screen since @p now_ns. Counts once for each phase. */
void gz_run_shown(struct gz_run *run, int64_t now_ns);

/** A frame of an interval was shown: after gz_run_shown(), each time. */
void gz_run_frame(struct gz_run *run, const struct gz_run_frame *frame);

/** What to show now. Texts are valid until the next gz_run_step() or gz_run_key(). */
void gz_run_screen(const struct gz_run *run, struct gz_run_screen *out_screen);

/** The alternative that a presentation shows in its interval 0 or 1. */
int gz_presentation_alternative(const struct gz_presentation *presentation, int interval);

#endif
