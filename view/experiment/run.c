#include "view/experiment/run.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "render/plan/method.h"
#include "view/experiment/staircase.h"

/* Texts before a trial, in order. */
enum page { PAGE_INSTRUCTIONS, PAGE_BLOCK, PAGE_BREAK, PAGE_NONE };

/* Size of a mark's label with its NUL: fits into an annotation. */
enum { LABEL_SIZE = 200 };

/* Time without gaze after which the cross says so. Chosen: longer than a blink. */
#define GAZE_PATIENCE_NS GZ_NS_PER_S

__attribute__((format(printf, 3, 4))) static void mark(struct gz_run *run, int64_t time_ns,
						       const char *format, ...)
{
	char label[LABEL_SIZE];
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(label, sizeof label, format, arguments);
	va_end(arguments);
	if (run->sink.mark)
		run->sink.mark(run->sink.user, label, time_ns);
}

static const struct gz_presentation *presentation_of(const struct gz_run *run)
{
	return run->index < run->sequence->count ? &run->sequence->presentations[run->index] : NULL;
}

int gz_presentation_alternative(const struct gz_presentation *presentation, int interval)
{
	return presentation->swapped ? 1 - interval : interval;
}

static void enter_phase(struct gz_run *run, enum gz_run_phase phase)
{
	run->phase = phase;
	run->shown_ns = 0;
}

static bool page_is_due(const struct gz_run *run, enum page page)
{
	const struct gz_presentation *presentation = presentation_of(run);
	const bool first = run->index == run->first;
	const int every = presentation->block->params.break_every;
	switch (page) {
	case PAGE_INSTRUCTIONS:
		return first && run->experiment->instructions;
	case PAGE_BLOCK:
		return (first || presentation->number == 1) && presentation->block->instructions;
	case PAGE_BREAK:
		return !first && every > 0 && presentation->number > 1 &&
		       (presentation->number - 1) % every == 0;
	case PAGE_NONE:
		break;
	}
	return false;
}

/* Show the next due text from @p page on, or prepare the trial after the last. */
static void turn_page(struct gz_run *run, int page)
{
	while (page < PAGE_NONE && !page_is_due(run, (enum page)page))
		page++;
	run->page = page;
	enter_phase(run, page < PAGE_NONE ? GZ_RUN_TEXT : GZ_RUN_PREPARE);
}

static void clear_trial(struct gz_run *run, int restarts)
{
	run->trial = (struct gz_trial_result) {
		.index = run->index,
		.presentation = presentation_of(run),
		.answer = -1,
		.chosen = -1,
		.right = -1,
		.restarts = restarts,
	};
	memset(&run->frames, 0, sizeof run->frames);
	run->frame_ns = 0;
	run->interval = 0;
	run->gaze_missing = false;
}

/* Start the current trial with the texts before it, or finish the experiment. */
static void begin_trial(struct gz_run *run, int64_t now_ns)
{
	run->index = gz_sequence_next(run->sequence, run->index);
	clear_trial(run, 0);
	if (presentation_of(run)) {
		gz_staircase_place(presentation_of(run)->condition->staircase);
		turn_page(run, PAGE_INSTRUCTIONS);
		return;
	}
	run->complete = true;
	run->page = PAGE_NONE;
	mark(run, now_ns, "experiment %s ends", run->experiment->params.name);
	enter_phase(run, run->experiment->params.goodbye[0] ? GZ_RUN_TEXT : GZ_RUN_ENDED);
}

void gz_run_begin(struct gz_run *run, const struct gz_run_start *start)
{
	*run = (struct gz_run) {
		.experiment = start->experiment,
		.sequence = start->sequence,
		.sink = start->sink,
		.participant = start->participant,
		.session = start->session,
		.index = start->first,
		.first = start->first,
	};
	begin_trial(run, 0);
}

static void end_run(struct gz_run *run, enum gz_result result)
{
	run->result = result;
	enter_phase(run, GZ_RUN_ENDED);
}

/* Median time between swaps, ms: the centre of its bin. */
static double median_ms(const struct gz_trial_frames *frames)
{
	uint64_t seen = 0;
	for (size_t i = 0; i < GZ_RUN_GAP_BINS; i++) {
		seen += frames->gaps[i];
		if (frames->count > 0 && 2 * seen >= frames->count)
			return ((double)i + 0.5) * 0.1;
	}
	return NAN;
}

/* Evaluate the answer. */
static void judge_answer(struct gz_run *run)
{
	struct gz_trial_result *trial = &run->trial;
	const struct gz_condition *condition = trial->presentation->condition;
	bool asks_interval = condition->params.asks == GZ_ASKS_INTERVAL;
	if (asks_interval && trial->answer >= 0 && trial->answer < 2)
		trial->chosen = gz_presentation_alternative(trial->presentation, trial->answer);
	int said = asks_interval ? trial->chosen : trial->answer;
	if (condition->correct >= 0)
		trial->right = trial->answer >= 0 && said == condition->correct;
}

/* Finish the trial with an answer; -1: none in time. */
static void finish_trial(struct gz_run *run, int answer, int64_t now_ns)
{
	struct gz_trial_result *trial = &run->trial;
	const struct gz_condition *condition = trial->presentation->condition;
	trial->answer = answer;
	trial->by_mouse = run->clicked;
	trial->end_ns = now_ns;
	judge_answer(run);
	/* An answer that did not come says nothing about the value. */
	if (answer >= 0)
		gz_staircase_take(condition->staircase, trial->right == 1);
	trial->frames = run->frames.count;
	trial->dropped = run->frames.dropped;
	trial->frame_ms = median_ms(&run->frames);
	trial->gaze_loss = run->frames.gaze_told && run->frames.total_ns > 0
				   ? (double)run->frames.lost_ns / (double)run->frames.total_ns
				   : NAN;
	if (answer < 0)
		mark(run, now_ns, "trial %zu no answer", run->index + 1);
	else
		mark(run, now_ns, "trial %zu answer %s%s", run->index + 1,
		     condition->answers[answer].name,
		     trial->chosen == 0   ? " chosen a"
		     : trial->chosen == 1 ? " chosen b"
					  : "");
	enum gz_result result = run->sink.over ? run->sink.over(run->sink.user, trial) : GZ_OK;
	if (result != GZ_OK)
		end_run(run, result);
	else if (condition->params.feedback)
		enter_phase(run, GZ_RUN_FEEDBACK);
	else
		enter_phase(run, GZ_RUN_PAUSE);
}

/* Duration of the current phase, s. */
static double phase_s(const struct gz_run *run)
{
	const struct gz_presentation *presentation = run->trial.presentation;
	if (!presentation)
		return HUGE_VAL;
	const struct gz_trial_params *params = &presentation->condition->params;
	switch (run->phase) {
	case GZ_RUN_FIXATION:
		return params->fixation_s;
	case GZ_RUN_INTERVAL:
		return params->duration_s;
	case GZ_RUN_BLANK:
		return params->blank_s;
	case GZ_RUN_FEEDBACK:
		return params->feedback_s;
	case GZ_RUN_PAUSE:
		return params->pause_s;
	case GZ_RUN_QUESTION:
		return params->timeout_s > 0 ? params->timeout_s : HUGE_VAL;
	default:
		return HUGE_VAL;
	}
}

/* Whether the next frame is closer to the phase's end than the one after it. A phase of zero length
 * is over before it is shown. */
static bool phase_is_over(const struct gz_run *run, const struct gz_run_input *input)
{
	double length_s = phase_s(run);
	if (length_s <= 0)
		return true;
	if (!run->shown_ns || length_s > 1e9)
		return false;
	int64_t length_ns = (int64_t)(length_s * (double)GZ_NS_PER_S);
	return input->now_ns + input->refresh_ns / 2 >= run->shown_ns + length_ns;
}

/* Leave FIXATION; if gaze is required, only once there is some. */
static void leave_fixation(struct gz_run *run, const struct gz_run_input *input, bool *changed)
{
	bool waits = run->experiment->params.gaze == GZ_GAZE_REQUIRED && !input->gaze_there;
	if (!waits) {
		run->gaze_missing = false;
		enter_phase(run, GZ_RUN_INTERVAL);
		*changed = true;
		return;
	}
	if (!run->gaze_missing_ns)
		run->gaze_missing_ns = input->now_ns;
	bool tell = input->now_ns - run->gaze_missing_ns >= GAZE_PATIENCE_NS;
	*changed = tell && !run->gaze_missing;
	run->gaze_missing = run->gaze_missing || tell;
}

static void leave_interval(struct gz_run *run)
{
	if (run->interval + 1 < run->trial.presentation->condition->params.intervals)
		enter_phase(run, GZ_RUN_BLANK);
	else
		enter_phase(run, GZ_RUN_QUESTION);
}

/* Go to the next phase. */
static bool advance_phase(struct gz_run *run, const struct gz_run_input *input)
{
	bool changed = true;
	switch (run->phase) {
	case GZ_RUN_FIXATION:
		leave_fixation(run, input, &changed);
		return changed;
	case GZ_RUN_INTERVAL:
		leave_interval(run);
		return true;
	case GZ_RUN_BLANK:
		run->interval++;
		enter_phase(run, GZ_RUN_INTERVAL);
		return true;
	case GZ_RUN_QUESTION:
		finish_trial(run, -1, input->now_ns);
		return true;
	case GZ_RUN_FEEDBACK:
		enter_phase(run, GZ_RUN_PAUSE);
		return true;
	case GZ_RUN_PAUSE:
		run->index++;
		begin_trial(run, input->now_ns);
		return true;
	default:
		return false;
	}
}

/* Whether an interval has been without the gaze that it requires for too long. */
static bool interval_lost_gaze(struct gz_run *run, const struct gz_run_input *input)
{
	const struct gz_experiment_params *params = &run->experiment->params;
	if (run->phase != GZ_RUN_INTERVAL || params->gaze != GZ_GAZE_REQUIRED ||
	    params->gaze_lost_s <= 0 || input->gaze_there) {
		run->gaze_lost_ns = 0;
		return false;
	}
	if (!run->gaze_lost_ns)
		run->gaze_lost_ns = input->now_ns;
	return (double)(input->now_ns - run->gaze_lost_ns) >=
	       params->gaze_lost_s * (double)GZ_NS_PER_S;
}

static void restart_trial(struct gz_run *run)
{
	clear_trial(run, run->trial.restarts + 1);
	enter_phase(run, GZ_RUN_PREPARE);
}

bool gz_run_step(struct gz_run *run, const struct gz_run_input *input)
{
	if (input->gaze_there)
		run->gaze_missing_ns = 0;
	if (interval_lost_gaze(run, input)) {
		mark(run, input->now_ns, "trial %zu interrupted without gaze", run->index + 1);
		restart_trial(run);
		return true;
	}
	if (run->phase == GZ_RUN_PREPARE) {
		if (!input->ready)
			return false;
		enter_phase(run, GZ_RUN_FIXATION);
		if (phase_is_over(run, input))
			advance_phase(run, input);
		return true;
	}
	bool changed = false;
	/* Skip phases of zero length; none follows itself. */
	for (int i = 0; i < GZ_RUN_ENDED && phase_is_over(run, input); i++) {
		enum gz_run_phase before = run->phase;
		changed = advance_phase(run, input) || changed;
		if (run->phase == before || run->phase == GZ_RUN_PREPARE)
			break;
	}
	return changed;
}

/* Mark the start of a trial. */
static void tell_begun(struct gz_run *run, int64_t now_ns)
{
	const struct gz_presentation *presentation = run->trial.presentation;
	if (!run->begun)
		mark(run, now_ns, "experiment %s begins participant %s%s%s seed %d",
		     run->experiment->params.name, run->participant,
		     run->session[0] ? " session " : "", run->session,
		     run->experiment->params.seed);
	run->begun = true;
	run->trial.begin_ns = now_ns;
	mark(run, now_ns, "trial %zu begins block %s trial %s order %s", run->index + 1,
	     presentation->block->label, presentation->condition->label,
	     presentation->condition->params.intervals == 1 ? "a"
	     : presentation->swapped                        ? "ba"
							    : "ab");
}

/* Mark the end of an interval. */
static void tell_interval_off(struct gz_run *run, int interval, int64_t now_ns)
{
	if (!run->trial.on_ns[interval] || run->trial.off_ns[interval])
		return;
	run->trial.off_ns[interval] = now_ns;
	mark(run, now_ns, "trial %zu interval %d off", run->index + 1, interval + 1);
}

static void tell_interval_on(struct gz_run *run, int64_t now_ns)
{
	const struct gz_presentation *presentation = run->trial.presentation;
	int which = gz_presentation_alternative(presentation, run->interval);
	run->trial.on_ns[run->interval] = now_ns;
	run->frame_ns = 0;
	mark(run, now_ns, "trial %zu interval %d on %c %s", run->index + 1, run->interval + 1,
	     'a' + which, gz_method_names[presentation->condition->alternatives[which].method]);
}

void gz_run_shown(struct gz_run *run, int64_t now_ns)
{
	if (run->shown_ns)
		return;
	run->shown_ns = now_ns;
	bool of_trial = run->phase == GZ_RUN_FIXATION || run->phase == GZ_RUN_INTERVAL;
	if (of_trial && !run->trial.begin_ns)
		tell_begun(run, now_ns);
	switch (run->phase) {
	case GZ_RUN_INTERVAL:
		if (run->interval > 0)
			tell_interval_off(run, run->interval - 1, now_ns);
		tell_interval_on(run, now_ns);
		break;
	case GZ_RUN_BLANK:
		tell_interval_off(run, run->interval, now_ns);
		break;
	case GZ_RUN_QUESTION:
		tell_interval_off(run, run->interval, now_ns);
		run->trial.question_ns = now_ns;
		mark(run, now_ns, "trial %zu question", run->index + 1);
		break;
	default:
		break;
	}
}

void gz_run_frame(struct gz_run *run, const struct gz_run_frame *frame)
{
	struct gz_trial_frames *frames = &run->frames;
	int64_t before_ns = run->frame_ns;
	if (run->phase != GZ_RUN_INTERVAL)
		return;
	run->frame_ns = frame->shown_ns;
	frames->gaze_told = frames->gaze_told || frame->gaze_told;
	if (!before_ns || frame->shown_ns < before_ns)
		return;
	int64_t gap_ns = frame->shown_ns - before_ns;
	size_t bin = (size_t)(gap_ns / (GZ_NS_PER_MS / 10));
	frames->gaps[bin < GZ_RUN_GAP_BINS ? bin : GZ_RUN_GAP_BINS - 1]++;
	frames->count++;
	frames->total_ns += gap_ns;
	frames->lost_ns += frame->gaze_told && !frame->gaze_there ? gap_ns : 0;
	int64_t refreshes =
		frame->refresh_ns > 0 ? (gap_ns + frame->refresh_ns / 2) / frame->refresh_ns : 0;
	frames->dropped += refreshes > 1 ? (uint64_t)refreshes - 1 : 0;
}

/* Escape: ask whether to leave. */
static void ask_to_leave(struct gz_run *run, int64_t now_ns)
{
	run->left = run->phase;
	if (run->trial.begin_ns && !run->trial.end_ns)
		mark(run, now_ns, "trial %zu interrupted", run->index + 1);
	enter_phase(run, GZ_RUN_LEAVING);
}

/* Continue after all: restart an interrupted trial, but do not repeat an answered one. */
static void stay_after_all(struct gz_run *run, int64_t now_ns)
{
	if (run->left == GZ_RUN_TEXT || run->left == GZ_RUN_PREPARE) {
		enter_phase(run, run->left);
	} else if (run->trial.end_ns) {
		run->index++;
		begin_trial(run, now_ns);
	} else {
		restart_trial(run);
	}
}

static bool key_in_text(struct gz_run *run, int key)
{
	if (key != GZ_KEY_SPACE || !run->shown_ns)
		return false;
	if (run->complete)
		enter_phase(run, GZ_RUN_ENDED);
	else
		turn_page(run, run->page + 1);
	return true;
}

static bool key_in_question(struct gz_run *run, int key, int64_t now_ns)
{
	const struct gz_condition *condition = run->trial.presentation->condition;
	if (!run->shown_ns)
		return false;
	for (size_t i = 0; i < condition->answer_count; i++) {
		if (condition->answers[i].key != key)
			continue;
		finish_trial(run, (int)i, now_ns);
		return true;
	}
	return false;
}

void gz_run_stop(struct gz_run *run, enum gz_result result, int64_t now_ns)
{
	if (run->phase == GZ_RUN_ENDED)
		return;
	if (run->complete) {
		enter_phase(run, GZ_RUN_ENDED);
		return;
	}
	mark(run, now_ns, "experiment %s left", run->experiment->params.name);
	end_run(run, result);
}

static bool key_in_leaving(struct gz_run *run, int key, int64_t now_ns)
{
	if (key == GZ_KEY_ESCAPE) {
		gz_run_stop(run, GZ_ERR_CANCELLED, now_ns);
		return true;
	}
	if (key == GZ_KEY_SPACE)
		stay_after_all(run, now_ns);
	return key == GZ_KEY_SPACE;
}

bool gz_run_key(struct gz_run *run, int key, int64_t now_ns)
{
	if (run->phase == GZ_RUN_ENDED)
		return false;
	if (run->phase == GZ_RUN_LEAVING)
		return key_in_leaving(run, key, now_ns);
	if (key == GZ_KEY_ESCAPE) {
		if (run->complete)
			enter_phase(run, GZ_RUN_ENDED);
		else
			ask_to_leave(run, now_ns);
		return true;
	}
	if (run->phase == GZ_RUN_TEXT)
		return key_in_text(run, key);
	return run->phase == GZ_RUN_QUESTION && key_in_question(run, key, now_ns);
}

bool gz_run_click(struct gz_run *run, int key, int64_t now_ns)
{
	run->clicked = true;
	const bool changed = gz_run_key(run, key, now_ns);
	run->clicked = false;
	return changed;
}

static const char *feedback_text(const struct gz_run *run)
{
	const struct gz_trial_params *params = &run->trial.presentation->condition->params;
	if (run->trial.answer < 0)
		return params->feedback_late;
	return run->trial.right == 1 ? params->feedback_correct : params->feedback_wrong;
}

static const char *page_text(const struct gz_run *run)
{
	if (run->complete)
		return run->experiment->params.goodbye;
	const struct gz_presentation *presentation = presentation_of(run);
	return run->page == PAGE_INSTRUCTIONS ? run->experiment->instructions
	       : run->page == PAGE_BLOCK      ? presentation->block->instructions
					      : presentation->block->params.break_text;
}

static void add_choice(struct gz_run_screen *screen, int key, const char *name,
		       const char *key_name)
{
	screen->choices[screen->choice_count++] = (struct gz_run_choice) { key, name, key_name };
}

static void offer_answers(const struct gz_condition *condition, struct gz_run_screen *screen)
{
	for (size_t i = 0; i < condition->answer_count; i++)
		add_choice(screen, condition->answers[i].key, condition->answers[i].name,
			   condition->answers[i].key_name);
}

static void offer_choices(const struct gz_run *run, struct gz_run_screen *screen)
{
	switch (run->phase) {
	case GZ_RUN_TEXT:
		add_choice(screen, GZ_KEY_SPACE, run->complete ? "Finish" : "Continue", "Space");
		return;
	case GZ_RUN_LEAVING:
		add_choice(screen, GZ_KEY_SPACE, "Continue", "Space");
		add_choice(screen, GZ_KEY_ESCAPE, "Leave", "Escape");
		return;
	case GZ_RUN_QUESTION:
		offer_answers(screen->presentation->condition, screen);
		return;
	default:
		return;
	}
}

void gz_run_screen(const struct gz_run *run, struct gz_run_screen *out_screen)
{
	const struct gz_presentation *presentation = presentation_of(run);
	struct gz_run_screen screen = {
		.phase = run->phase,
		.presentation = presentation,
		.done = run->index,
		.count = run->sequence->count,
		.gaze_missing = run->gaze_missing,
	};
	if (run->phase == GZ_RUN_TEXT)
		screen.text = page_text(run);
	else if (run->phase == GZ_RUN_QUESTION)
		screen.text = presentation->condition->params.question;
	else if (run->phase == GZ_RUN_FEEDBACK)
		screen.text = feedback_text(run);
	else if (run->phase == GZ_RUN_LEAVING)
		screen.text = "Leave the experiment?\nPress Escape to leave, Space to continue.";
	else if (run->phase == GZ_RUN_INTERVAL)
		screen.alternative =
			&presentation->condition->alternatives[gz_presentation_alternative(
				presentation, run->interval)];
	if (run->experiment->params.buttons)
		offer_choices(run, &screen);
	*out_screen = screen;
}
