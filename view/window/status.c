/* The part that shows two captions. The line at the top: method, size, time and rays of the last
 * frame. The lower left corner: where the gaze comes from and how good it is, amber when something
 * needs attention and red without a gaze, with the reason in words. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "view/gaze/gaze_state.h"
#include "view/panels/marks.h"
#include "view/window/displays.h"
#include "view/window/gaze.h"
#include "view/window/latency.h"
#include "view/window/refine.h"
#include "view/window/window_state.h"

/* Least time between changes of numbers, and for a warning (chosen: readable, and cheap). */
#define NUMBERS_INTERVAL_NS (GZ_NS_PER_S / 2)
/* Lost samples are reported for this time after the daemon has told of them (chosen: three of its
 * status messages). */
#define LOSS_SHOWN_NS (3 * GZ_NS_PER_S)
/* Share of the samples between two status messages that may be lost without a warning (chosen: one
 * in a second at 60 Hz, which hides no fixation). */
#define LOSS_SHARE 0.02

/* Smaller changes of a number are not shown (chosen: nobody would act on them). */
#define STEADY_SHARE   0.2
#define RATE_SHARE     0.03
#define RATE_STEP_HZ   1.0
#define AGE_STEP_MS    2.0
#define NOISE_STEP_DEG 0.02

/* Intervals over which the greatest age is shown (chosen: three seconds, in which jitter reaches
 * its maximum). */
enum { AGE_INTERVALS = 6 };

enum { TEXT_SIZE = 640 };

struct gz_window_status {
	struct gz_gaze_rate rate;
	struct gz_gaze_state state; /* as shown */
	int64_t state_ns;           /* when it was as bad as this last */
	bool lost_known;
	uint64_t samples;              /* delivered, by the daemon's status */
	uint64_t lost;                 /* lost, by the daemon's status */
	int64_t lost_ns;               /* when more had been lost; 0: never */
	int64_t due_ns;                /* when numbers may change next */
	double ages_ms[AGE_INTERVALS]; /* the greatest of each interval, the newest first */
	struct {
		double rate_hz, age_ms, noise_deg;
	} shown;
	char head[TEXT_SIZE], numbers[TEXT_SIZE];
	char text[TEXT_SIZE]; /* on the screen */
	char line[TEXT_SIZE]; /* at the top */
};

/* " of 20, 1.4 times coarser", as far as it applies. */
static void print_budget(const struct gz_frame_record *record, char *text, size_t size)
{
	text[0] = '\0';
	if (record->budget_ms > 0 && record->focus.scale > 1)
		snprintf(text, size, " of %g, %.1f times coarser", record->budget_ms,
			 record->focus.scale);
	else if (record->budget_ms > 0)
		snprintf(text, size, " of %g", record->budget_ms);
}

/* Print the line for the frame on the screen. @return whether it changes */
static bool update_line(struct gz_window *window)
{
	char budget[48], line[TEXT_SIZE];
	const struct gz_frame_record *record = &window->record;
	print_budget(record, budget, sizeof budget);
	snprintf(line, sizeof line, "%s  %dx%d  %.1f ms%s  %llu rays%s", record->method,
		 record->width, record->height, record->total_ms, budget,
		 (unsigned long long)record->rays,
		 gz_window_is_refined(window) ? "  |  at rest: full quality" : "");
	const bool changed = strcmp(line, window->status->line) != 0;
	memcpy(window->status->line, line, sizeof line);
	return changed;
}

static bool loses_samples(const struct gz_window_status *corner, const struct gz_status *status)
{
	/* Counters of another daemon begin again. */
	if (status->lost <= corner->lost || status->samples < corner->samples)
		return false;
	const double lost = (double)(status->lost - corner->lost);
	return lost > LOSS_SHARE * (lost + (double)(status->samples - corner->samples));
}

static void count_losses(struct gz_window_status *corner, const struct gz_status *status,
			 int64_t now_ns)
{
	if (!status) {
		corner->lost_known = false;
		return;
	}
	if (corner->lost_known && loses_samples(corner, status))
		corner->lost_ns = now_ns;
	corner->lost_known = true;
	corner->lost = status->lost;
	corner->samples = status->samples;
}

static bool log_is_over(const struct gz_window *window)
{
	struct gz_gaze_log_place place;
	return window->source && gz_gaze_source_log_place(window->source, &place) && place.ended;
}

static void judge_gaze(struct gz_window *window, const struct gz_window_gaze *gaze, int64_t now_ns,
		       struct gz_gaze_state *out_state)
{
	const struct gz_window_status *corner = window->status;
	if (gaze->focus) { /* a replay shows its gaze as it was */
		*out_state = (struct gz_gaze_state) { .level = GZ_GAZE_LEVEL_GOOD };
		return;
	}
	const enum gz_window_source source = gz_window_source_now(window);
	const struct gz_window_share share = gz_window_share(window);
	const struct gz_gaze_signs signs = {
		.from_daemon = window->source && window->source->ops->live,
		.from_log = source == GZ_WINDOW_LOG,
		.wants_pointer = source == GZ_WINDOW_POINTER,
		.reading = gaze->asked,
		.status = gaze->status,
		.losing = corner->lost_ns > 0 && now_ns - corner->lost_ns < LOSS_SHOWN_NS,
		.log_ended = log_is_over(window),
		.window_elsewhere = gz_window_share_is_elsewhere(&share),
	};
	gz_gaze_state_of(&signs, out_state);
}

/* A worse state is shown at once, a better one once it has lasted. @return whether it changes */
static bool take_gaze_state(struct gz_window_status *corner, const struct gz_gaze_state *state,
			    int64_t now_ns)
{
	if (state->level >= corner->state.level)
		corner->state_ns = now_ns;
	else if (now_ns - corner->state_ns < NUMBERS_INTERVAL_NS)
		return false;
	if (state->level == corner->state.level && strcmp(state->reason, corner->state.reason) == 0)
		return false;
	corner->state = *state;
	return true;
}

/* "daemon (sim)", "pointer", "mouse". */
static void print_source(const struct gz_window *window, const struct gz_window_gaze *gaze,
			 char *text, size_t size)
{
	const bool named = gaze->status && gz_window_source_now(window) != GZ_WINDOW_POINTER;
	const struct gz_point at = gaze->reading.point;
	const bool off = gaze->reading.known && !(at.x >= 0 && at.y >= 0 && at.x <= 1 && at.y <= 1);
	snprintf(text, size, "%s%s%.63s%s%s%s", gaze->source, named && !gaze->missing ? " (" : "",
		 named && !gaze->missing ? gaze->status->tracker.name : "",
		 named && !gaze->missing ? ")" : "", off ? ", off the picture" : "",
		 window->gaze_frozen ? ", FROZEN (Space)" : "");
}

/* "latency 34 ms: sample 4, frame 20, swap 2, scan-out 8 estimated". */
static void print_latency_line(const struct gz_window *window, char *text, size_t size)
{
	struct gz_latency latency;
	char age[32] = "", scanout[48] = "";
	text[0] = '\0';
	if (!gz_window_latency(window, &latency))
		return;
	if (latency.age_known)
		snprintf(age, sizeof age, "sample %.0f, ", latency.age_ms);
	if (latency.scanout_ms > 0)
		snprintf(scanout, sizeof scanout, ", scan-out %.0f estimated", latency.scanout_ms);
	snprintf(text, size, "\nlatency %.0f ms: %sframe %.0f, swap %.0f%s", latency.total_ms, age,
		 latency.frame_ms, latency.present_ms, scanout);
}

/* A number that has hardly changed stays, so that nothing is drawn for it. */
static double steady_number(double shown, double now, double least_step, double share)
{
	const double step = fmax(least_step, share * fabs(shown));
	return isfinite(now) && isfinite(shown) && fabs(now - shown) <= step ? shown : now;
}

static double greatest_age_ms(const struct gz_window_status *corner)
{
	double greatest_ms = 0;
	for (int i = 0; i < AGE_INTERVALS; i++)
		greatest_ms = fmax(greatest_ms, corner->ages_ms[i]);
	return greatest_ms;
}

static void begin_interval(struct gz_window_status *corner, int64_t now_ns)
{
	corner->due_ns = now_ns + NUMBERS_INTERVAL_NS;
	memmove(corner->ages_ms + 1, corner->ages_ms,
		sizeof corner->ages_ms - sizeof corner->ages_ms[0]);
	corner->ages_ms[0] = 0;
}

/* "  250 Hz  4 ms  fixation  noise 0.12 deg", as far as known. */
static void print_gaze_numbers(struct gz_window *window, const struct gz_window_gaze *gaze,
			       char *text, size_t size)
{
	const struct gz_gaze_reading *reading = &gaze->reading;
	struct gz_window_status *corner = window->status;
	char rate[32] = "", age[32] = "", noise[32] = "", latency[128];
	const bool fresh = reading->has_age && reading->age_ns <= GZ_GAZE_SILENT_NS;
	corner->shown.rate_hz = steady_number(corner->shown.rate_hz, gz_gaze_rate_hz(&corner->rate),
					      RATE_STEP_HZ, RATE_SHARE);
	corner->shown.age_ms = steady_number(corner->shown.age_ms, greatest_age_ms(corner),
					     AGE_STEP_MS, STEADY_SHARE);
	corner->shown.noise_deg = steady_number(corner->shown.noise_deg, reading->noise_deg,
						NOISE_STEP_DEG, STEADY_SHARE);
	if (fresh && corner->shown.rate_hz > 0)
		snprintf(rate, sizeof rate, "  %.0f Hz", corner->shown.rate_hz);
	if (fresh)
		snprintf(age, sizeof age, "  %.0f ms", corner->shown.age_ms);
	if (isfinite(reading->noise_deg))
		snprintf(noise, sizeof noise, "  noise %.2f deg", corner->shown.noise_deg);
	print_latency_line(window, latency, sizeof latency);
	snprintf(text, size, "%s%s%s%s%s%s", rate, age, fresh && reading->has_event ? "  " : "",
		 fresh && reading->has_event ? gz_event_name(reading->event) : "", noise, latency);
}

static bool corner_follows(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	struct gz_window_status *corner = window->status;
	const int64_t now_ns = gz_clock_now_ns();
	struct gz_gaze_state state;
	char head[TEXT_SIZE], text[TEXT_SIZE];
	if (!gaze->source) /* no scene is shown */
		return false;
	gz_gaze_rate_step(&corner->rate, &gaze->asked);
	count_losses(corner, gaze->status, now_ns);
	if (gaze->reading.has_age)
		corner->ages_ms[0] = fmax(corner->ages_ms[0], gz_ns_to_ms(gaze->reading.age_ns));
	judge_gaze(window, gaze, now_ns, &state);
	print_source(window, gaze, head, sizeof head);
	const bool new_state = take_gaze_state(corner, &state, now_ns);
	const bool another = strcmp(head, corner->head) != 0;
	if (another) /* the other ages are of another source */
		memset(corner->ages_ms + 1, 0, sizeof corner->ages_ms - sizeof corner->ages_ms[0]);
	if (another || new_state || now_ns >= corner->due_ns) {
		print_gaze_numbers(window, gaze, corner->numbers, sizeof corner->numbers);
		begin_interval(corner, now_ns);
	}
	memcpy(corner->head, head, sizeof head);
	snprintf(text, sizeof text, "%s%.100s%.200s%s%s", "gaze: ", head, corner->numbers,
		 corner->state.reason[0] ? "\n" : "", corner->state.reason);
	const bool changed = new_state || strcmp(text, corner->text) != 0;
	memcpy(corner->text, text, sizeof text);
	return changed;
}

static bool status_follows(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	const bool new_line = window->record.method && update_line(window);
	return corner_follows(window, gaze) || new_line;
}

static void draw_captions(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	static const struct gz_paint *const paints[] = {
		[GZ_GAZE_LEVEL_GOOD] = &gz_paint_plain,
		[GZ_GAZE_LEVEL_WARN] = &gz_paint_amber,
		[GZ_GAZE_LEVEL_BAD] = &gz_paint_red,
	};
	const struct gz_window_status *corner = window->status;
	(void)gaze;
	if (corner->line[0] && window->record.method)
		window->panels_top =
			gz_marks_draw_caption(window->panels_top, gz_paint_plain, corner->line);
	if (corner->text[0] && window->maker)
		window->panels_bottom =
			gz_marks_draw_low_caption(*paints[corner->state.level], corner->text);
}

const struct gz_window_part gz_window_status_part = {
	.name = "status",
	GZ_PART_STATE(status),
	.follows = status_follows,
	.panels = draw_captions,
};
