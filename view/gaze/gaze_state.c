#include "view/gaze/gaze_state.h"

#include <stdio.h>
#include <string.h>

#include "base/clock.h"

/* The span a rate is measured over, and the smallest distance of the readings kept. */
#define RATE_SPAN_NS  GZ_NS_PER_S
#define RATE_APART_NS (GZ_NS_PER_S / 100)
/* The shortest span that gives a rate. Chosen: a fifth of the full span. */
#define RATE_LEAST_NS (RATE_SPAN_NS / 5)

static void set_reason(struct gz_gaze_state *state, enum gz_gaze_level level, const char *what,
		       const char *more)
{
	state->level = level;
	snprintf(state->reason, sizeof state->reason, "%s%s", what, more);
}

/* The daemon is connected and gives no gaze: its tracker has a reason. */
static void say_tracker(const struct gz_status *status, struct gz_gaze_state *state)
{
	char text[GZ_REASON_SIZE];
	if (!status || status->tracker.state == GZ_TRACKER_RUNNING) {
		set_reason(state, GZ_GAZE_LEVEL_WARN, "NO GAZE yet from the daemon",
			   "; using the mouse");
		return;
	}
	snprintf(text, sizeof text, "NO TRACKER: %.31s %s%s%.100s", status->tracker.name,
		 gz_tracker_state_name(status->tracker.state),
		 status->tracker.reason[0] ? ", " : "", status->tracker.reason);
	set_reason(state, GZ_GAZE_LEVEL_WARN, text, "; using the mouse");
}

static bool is_of_another_tracker(const struct gz_gaze_signs *signs)
{
	return signs->wants_pointer && signs->status && signs->status->tracker.name[0] &&
	       strcmp(signs->status->tracker.name, "pointer") != 0;
}

static void say_silent(const struct gz_gaze_signs *signs, struct gz_gaze_state *state)
{
	const struct gz_status *status = signs->status;
	const bool stopped = status && status->tracker.state != GZ_TRACKER_RUNNING;
	set_reason(state, GZ_GAZE_LEVEL_BAD, "SILENT for more than a second",
		   stopped ? ": the tracker is " : "");
	if (stopped)
		strncat(state->reason, gz_tracker_state_name(status->tracker.state),
			sizeof state->reason - strlen(state->reason) - 1);
}

static bool eye_is_lost(const struct gz_gaze_reading *reading)
{
	return reading->has_event && reading->event == GZ_EVENT_LOST;
}

static void judge_daemon(const struct gz_gaze_signs *signs, struct gz_gaze_state *state)
{
	if (!signs->reading.connected)
		set_reason(state, GZ_GAZE_LEVEL_WARN, "NO DAEMON: start gazed",
			   "; using the mouse");
	else if (!signs->reading.known)
		say_tracker(signs->status, state);
	else if (is_of_another_tracker(signs))
		set_reason(state, GZ_GAZE_LEVEL_WARN,
			   "OTHER TRACKER: start gazed with --driver pointer; it reads ",
			   signs->status->tracker.name);
}

static void judge_age(const struct gz_gaze_signs *signs, struct gz_gaze_state *state)
{
	const struct gz_gaze_reading *reading = &signs->reading;
	if (signs->from_daemon && (!reading->connected || !reading->known))
		return;
	if (signs->log_ended)
		set_reason(state, GZ_GAZE_LEVEL_WARN, "LOG AT ITS END", "");
	else if (reading->has_age && reading->age_ns > GZ_GAZE_SILENT_NS)
		say_silent(signs, state);
	else if (eye_is_lost(reading))
		set_reason(state, GZ_GAZE_LEVEL_BAD, "EYE LOST", "");
	else if (state->level == GZ_GAZE_LEVEL_GOOD && reading->has_age &&
		 reading->age_ns > GZ_GAZE_LATE_NS)
		set_reason(state, GZ_GAZE_LEVEL_WARN, "LATE: older than 50 ms", "");
	else if (state->level == GZ_GAZE_LEVEL_GOOD && signs->losing)
		set_reason(state, GZ_GAZE_LEVEL_WARN, "LOSING samples between tracker and daemon",
			   "");
}

/* The least verdict: the gaze is there, but perhaps at another place. */
static void judge_validation(const struct gz_status *status, struct gz_gaze_state *state)
{
	char text[GZ_REASON_SIZE];
	if (!status || !status->validation.changed[0])
		return;
	snprintf(text, sizeof text, "DISPLAY CHANGED since gazectl validate: %.100s",
		 status->validation.changed);
	set_reason(state, GZ_GAZE_LEVEL_WARN, text, "; validate again");
}

void gz_gaze_state_of(const struct gz_gaze_signs *signs, struct gz_gaze_state *out_state)
{
	struct gz_gaze_state state = { .level = GZ_GAZE_LEVEL_GOOD };
	if (signs->from_daemon)
		judge_daemon(signs, &state);
	if (signs->from_daemon || signs->from_log)
		judge_age(signs, &state);
	if (state.level == GZ_GAZE_LEVEL_GOOD && signs->from_daemon && signs->window_elsewhere)
		set_reason(&state, GZ_GAZE_LEVEL_WARN,
			   "OTHER DISPLAY: the window is not on the tracker's display",
			   "; press D to move it");
	if (state.level == GZ_GAZE_LEVEL_GOOD && signs->from_daemon)
		judge_validation(signs->status, &state);
	*out_state = state;
}

/* The times in a log may be any numbers. */
static int64_t span_ns(int64_t from_ns, int64_t to_ns)
{
	int64_t span;
	return __builtin_sub_overflow(to_ns, from_ns, &span) ? INT64_MAX : span;
}

static size_t newest(const struct gz_gaze_rate *rate)
{
	return (rate->next + GZ_GAZE_RATE_ROOM - 1) % GZ_GAZE_RATE_ROOM;
}

void gz_gaze_rate_step(struct gz_gaze_rate *rate, const struct gz_gaze_reading *reading)
{
	if (!reading->numbered)
		return;
	const size_t last = newest(rate);
	if (rate->count > 0 && (reading->seq < rate->kept[last].seq ||
				reading->sample_ns < rate->kept[last].sample_ns))
		*rate = (struct gz_gaze_rate) { 0 };
	if (rate->count > 0 &&
	    span_ns(rate->kept[last].sample_ns, reading->sample_ns) < RATE_APART_NS)
		return;
	rate->kept[rate->next].seq = reading->seq;
	rate->kept[rate->next].sample_ns = reading->sample_ns;
	rate->next = (rate->next + 1) % GZ_GAZE_RATE_ROOM;
	rate->count += rate->count < GZ_GAZE_RATE_ROOM;
}

double gz_gaze_rate_hz(const struct gz_gaze_rate *rate)
{
	if (rate->count < 2)
		return 0;
	const size_t last = newest(rate);
	size_t first = last;
	for (size_t i = 1; i < rate->count; i++) {
		const size_t at = (last + GZ_GAZE_RATE_ROOM - i) % GZ_GAZE_RATE_ROOM;
		if (span_ns(rate->kept[at].sample_ns, rate->kept[last].sample_ns) > RATE_SPAN_NS)
			break;
		first = at;
	}
	const int64_t time_ns = span_ns(rate->kept[first].sample_ns, rate->kept[last].sample_ns);
	return time_ns < RATE_LEAST_NS ? 0
				       : (double)(rate->kept[last].seq - rate->kept[first].seq) /
						 gz_ns_to_s(time_ns);
}
