/**
 * @file
 * Runs an experiment: the state machine of texts, cross, intervals, question and feedback, driven
 * by the clock, keys and clicks. It knows no window. The caller shows what gz_run_screen() returns,
 * reports with gz_run_shown() when it appeared, passes keys, and calls gz_run_step() each frame.
 * Events come out as marks, and each trial as a result.
 *
 * A trial interrupted by Escape is restarted when the participant continues, and one that requires
 * gaze when there has been none for too long.
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
	GZ_RUN_TEXT,     /**< instructions, a break or the last text: until Space is pressed */
	GZ_RUN_PREPARE,  /**< until the trial's pictures are ready */
	GZ_RUN_FIXATION, /**< the cross */
	GZ_RUN_INTERVAL, /**< the picture */
	GZ_RUN_BLANK,    /**< between intervals */
	GZ_RUN_QUESTION,
	GZ_RUN_FEEDBACK,
	GZ_RUN_PAUSE,   /**< after the answer */
	GZ_RUN_LEAVING, /**< asks whether to leave: Escape leaves, Space continues */
	GZ_RUN_ENDED,
};

/** Number of bins in gz_trial_frames: 0.1 ms each; the last holds all longer times. */
#define GZ_RUN_GAP_BINS 10000

/** Times between the swaps in a trial's intervals. */
struct gz_trial_frames {
	uint64_t count;
	uint64_t dropped; /**< display refreshes without a new frame */
	uint32_t gaps[GZ_RUN_GAP_BINS];
	int64_t total_ns, lost_ns; /**< time in intervals, and the part without gaze */
	bool gaze_told;            /**< lost_ns is valid */
};

/** Result of a trial. Times are host times; 0: it did not happen. */
struct gz_trial_result {
	size_t index; /**< in the sequence */
	const struct gz_presentation *presentation;
	int64_t begin_ns; /**< of its first screen */
	int64_t on_ns[2], off_ns[2];
	int64_t question_ns;
	int64_t end_ns;   /**< of the answer, or the end of the wait for it */
	int answer;       /**< index into the condition's answers; -1: none in time */
	bool by_mouse;    /**< the answer was a click */
	int chosen;       /**< alternative, if the question asks for an interval; otherwise -1 */
	int right;        /**< 1: correct, 0: wrong or late, -1: no answer is correct */
	int restarts;     /**< number of interruptions */
	uint64_t frames;  /**< in its intervals */
	uint64_t dropped; /**< see struct gz_trial_frames */
	double frame_ms;  /**< median time between swaps, to 0.1 ms; NaN: no frames */
	double gaze_loss; /**< fraction of the intervals without gaze; NaN: unknown */
};

/** Receives the events of a run. */
struct gz_run_sink {
	void *user;
	/** Optional. Something happened at @p time_ns. @p label has no tabs and is shorter than 200
	 * bytes. */
	void (*mark)(void *user, const char *label, int64_t time_ns);
	/** Optional. A trial is over. A result other than GZ_OK, which it logs, ends the run. */
	enum gz_result (*over)(void *user, const struct gz_trial_result *result);
};

/** A run. Callers may read phase and result; the other fields are private to run.c. */
struct gz_run {
	const struct gz_experiment *experiment;
	const struct gz_sequence *sequence;
	struct gz_run_sink sink;
	const char *participant, *session;
	size_t index, first; /* in the sequence: of this trial, and of the first trial of the run */
	enum gz_run_phase phase;
	int64_t shown_ns;       /* time the phase was shown; 0: not yet */
	int page;               /* which text before a trial */
	int interval;           /* in INTERVAL and BLANK: 0 or 1 */
	enum gz_run_phase left; /* LEAVING: the interrupted phase */
	bool clicked;           /* a click is being handled */
	bool gaze_missing;      /* FIXATION is extended because gaze is missing */
	int64_t gaze_missing_ns;
	int64_t gaze_lost_ns; /* INTERVAL: since when there is no gaze; 0: there is */
	bool begun, complete;
	int64_t frame_ns; /* the last swap in an interval; 0: none */
	struct gz_trial_frames frames;
	struct gz_trial_result trial;
	enum gz_result result; /**< GZ_ERR_CANCELLED: left; otherwise the result of the sink */
};

/** What can be answered on a screen: a button, and the key that does the same. */
struct gz_run_choice {
	int key;              /**< enum gz_answer_key */
	const char *name;     /**< name of the answer */
	const char *key_name; /**< as shown: "1", "Space" */
};

/** What to show. */
struct gz_run_screen {
	enum gz_run_phase phase;
	/** INTERVAL: the picture. In PREPARE, make the presentation's alternatives ready. */
	const struct gz_alternative *alternative;
	const struct gz_presentation *presentation; /**< NULL after the last trial */
	const char *text;                           /**< to show in the centre; NULL: none */
	size_t done, count;                         /**< number of trials done, and of all trials */
	bool gaze_missing;                          /**< the cross waits for gaze: say so */
	/** Buttons for the mouse; none if the experiment wants none. */
	struct gz_run_choice choices[GZ_EXPERIMENT_ANSWERS_MAX];
	size_t choice_count;
};

/** Input of a step. */
struct gz_run_input {
	int64_t now_ns;
	int64_t refresh_ns; /**< of the display: a phase ends with the frame closest to its end */
	bool ready;         /**< the pictures of the presentation are ready */
	bool gaze_there;    /**< the eye is seen */
};

/** A frame that was shown. */
struct gz_run_frame {
	int64_t shown_ns;
	int64_t refresh_ns; /**< of the display */
	bool gaze_told;     /**< gaze_there is valid: there is a tracker */
	bool gaze_there;
};

/** What a run starts with. Everything but the sink is borrowed and outlives the run. */
struct gz_run_start {
	const struct gz_experiment *experiment;
	const struct gz_sequence *sequence;
	const char *participant, *session; /**< labels, for marks; session may be empty */
	size_t first; /**< index of the first trial: 0, or the next to answer */
	struct gz_run_sink sink;
};

/** Start a run. */
void gz_run_begin(struct gz_run *run, const struct gz_run_start *start);

/** Go to the next phase if it is time. @return whether gz_run_screen() has changed */
bool gz_run_step(struct gz_run *run, const struct gz_run_input *input);

/** Handle a key press; @p key is an enum gz_answer_key. @return whether gz_run_screen() has changed
 */
bool gz_run_key(struct gz_run *run, int key, int64_t now_ns);

/** Handle a click on the button of @p key: the same as the key, but an answer says that it was the
 * mouse. @return whether gz_run_screen() has changed */
bool gz_run_click(struct gz_run *run, int key, int64_t now_ns);

/** End the run with @p result. Trials that were not answered can be resumed. Does nothing if the
 * run has ended; if all trials are answered, it ends with GZ_OK. */
void gz_run_stop(struct gz_run *run, enum gz_result result, int64_t now_ns);

/** Report that the current screen appeared at @p now_ns. Only the first call in a phase counts. */
void gz_run_shown(struct gz_run *run, int64_t now_ns);

/** Report a frame of an interval. Call it for each one, after gz_run_shown(). */
void gz_run_frame(struct gz_run *run, const struct gz_run_frame *frame);

/** Get what to show now. Texts are valid until the next gz_run_step() or gz_run_key(). */
void gz_run_screen(const struct gz_run *run, struct gz_run_screen *out_screen);

/** The alternative, 0 or 1, that a presentation shows in interval 0 or 1. */
int gz_presentation_alternative(const struct gz_presentation *presentation, int interval);

#endif
