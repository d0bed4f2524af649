/* gazectl watch: prints the stream line by line, or refreshed in place on a terminal. */
#include "client/gazectl/gazectl.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/utf8.h"
#include "client/client.h"
#include "protocol/wire.h"

#define GZ_LOG_MODULE "gazectl"

/* Carriage return, then EL of ECMA-48. */
#define ERASE_LINE "\r\033[K"
/* DEC private mode 7: a line longer than the terminal is cut, so that erasing one line is enough.
 */
#define WRAP_OFF "\033[?7l"
#define WRAP_ON  "\033[?7h"

/* Shortest time between two refreshes. Chosen: as often as a reader can follow changing numbers. */
#define REFRESH_NS (GZ_NS_PER_S / 20)

/* How often the daemon is asked whether its stream has moved to another port, while the stream is
 * disconnected. Chosen. */
#define ASK_AGAIN_NS GZ_NS_PER_S

struct watch_settings {
	struct gazectl_common common;
	int count;
	bool all;
};

static const struct gz_option watch_options[] = {
	GAZECTL_COMMON_OPTIONS,
	{ .key = "count",
	  .type = GZ_OPTION_INT,
	  .offset = offsetof(struct watch_settings, count),
	  .min = 0,
	  .max = 1e9,
	  .preset = "0",
	  .help = "end after this many messages; 0: run until Ctrl-C" },
	{ .key = "all",
	  .type = GZ_OPTION_BOOL,
	  .offset = offsetof(struct watch_settings, all),
	  .preset = "false",
	  .help = "print every message, even on a terminal" },
};

static const char *const preset_topics[] = { GZ_TOPIC_GAZE, GZ_TOPIC_FIXATIONS, GZ_TOPIC_SACCADES,
					     GZ_TOPIC_BLINKS, NULL };

struct watch {
	const struct watch_settings *settings;
	const char *const *topics;
	const struct gz_log *log;
	struct gz_control *control;
	struct gz_stream *stream;
	bool refreshes; /* in place, at most every REFRESH_NS */
	int64_t shown_ns;
	bool line_open; /* the last line is gaze, which the next message replaces */
	uint64_t messages;
	uint64_t lost; /* by streams that were closed */
	int64_t asked_ns;
};

static void print_gaze(const struct gz_message *message)
{
	const struct gz_gaze *gaze = &message->gaze;
	double age_ms = gz_ns_to_ms(gz_gaze_age_ns(gaze, message->received_ns));
	printf("%.6f gaze %" PRIu64 " at %.4f %.4f %s %.1f deg/s confidence %.2f age %.2f ms",
	       gz_ns_to_s(gaze->host_ns), gaze->seq, (double)gaze->point.x, (double)gaze->point.y,
	       gz_event_name(gaze->event), (double)gaze->velocity_deg_s, (double)gaze->confidence,
	       age_ms);
	if (message->lost)
		printf(" lost %" PRIu64, message->lost);
}

static void print_fixation(const struct gz_fixation *fixation)
{
	printf("%.6f fixation %" PRIu64 " %.1f ms at %.4f %.4f dispersion %.3f deg%s",
	       gz_ns_to_s(fixation->onset_ns), fixation->id, gz_ns_to_ms(fixation->duration_ns),
	       (double)fixation->point.x, (double)fixation->point.y,
	       (double)fixation->dispersion_deg, fixation->final ? " final" : "");
}

static void print_saccade(const struct gz_saccade *saccade)
{
	printf("%.6f saccade %.1f ms %.2f deg peak %.0f deg/s from %.4f %.4f to %.4f %.4f",
	       gz_ns_to_s(saccade->start_ns), gz_ns_to_ms(saccade->duration_ns),
	       (double)saccade->amplitude_deg, (double)saccade->peak_velocity_deg_s,
	       (double)saccade->start.x, (double)saccade->start.y, (double)saccade->end.x,
	       (double)saccade->end.y);
}

static void print_status(const struct gz_message *message)
{
	const struct gz_status *status = &message->status;
	printf("%.6f status %s %.1f Hz samples %" PRIu64 " lost %" PRIu64
	       " recording %s subscribers %" PRIu32,
	       gz_ns_to_s(message->received_ns), gz_tracker_state_name(status->tracker.state),
	       status->rate_hz_measured, status->samples, status->lost,
	       gz_recording_state_name(status->recording.state), status->subscribers);
}

static void print_other(struct gz_message *message)
{
	gz_utf8_clean(message->topic);
	printf("%.6f %s %zu bytes", gz_ns_to_s(message->received_ns), message->topic,
	       message->size);
}

static void print_message(struct gz_message *message)
{
	switch (message->kind) {
	case GZ_MESSAGE_GAZE:
		print_gaze(message);
		return;
	case GZ_MESSAGE_FIXATION:
		print_fixation(&message->fixation);
		return;
	case GZ_MESSAGE_BLINK:
		printf("%.6f blink %s", gz_ns_to_s(message->blink.time_ns),
		       message->blink.onset ? "onset" : "offset");
		return;
	case GZ_MESSAGE_SACCADE:
		print_saccade(&message->saccade);
		return;
	case GZ_MESSAGE_STATUS:
		print_status(message);
		return;
	case GZ_MESSAGE_OTHER:
		print_other(message);
		return;
	}
}

/* Whether to skip this message on a terminal. */
static bool too_soon(struct watch *watch, const struct gz_message *message)
{
	if (message->kind == GZ_MESSAGE_FIXATION)
		return !message->fixation.final;
	if (message->kind != GZ_MESSAGE_GAZE || message->lost)
		return false;
	if (message->received_ns < watch->shown_ns + REFRESH_NS)
		return true;
	watch->shown_ns = message->received_ns;
	return false;
}

static void show_message(struct watch *watch, struct gz_message *message)
{
	if (!watch->refreshes) {
		print_message(message);
		putchar('\n');
		return;
	}
	if (too_soon(watch, message))
		return;
	bool replaces = message->kind == GZ_MESSAGE_GAZE && !message->lost;
	if (watch->line_open)
		fputs(ERASE_LINE, stdout);
	if (replaces)
		fputs(WRAP_OFF, stdout);
	print_message(message);
	fputs(replaces ? WRAP_ON : "\n", stdout);
	watch->line_open = replaces;
	fflush(stdout);
}

static uint64_t count_lost(struct watch *watch)
{
	struct gz_stream_counters counters;
	gz_stream_get_counters(watch->stream, &counters);
	return watch->lost + counters.lost;
}

/* A daemon that was restarted may publish on another TCP port: ask for it, and follow. */
static void follow_port(struct watch *watch)
{
	struct gz_stream_counters counters;
	char endpoint[256];
	gz_stream_get_counters(watch->stream, &counters);
	if (counters.connected || gz_clock_now_ns() < watch->asked_ns + ASK_AGAIN_NS)
		return;
	watch->asked_ns = gz_clock_now_ns();
	struct gz_stream *stream = NULL;
	if (gz_control_stream_endpoint(watch->control, 200, endpoint, sizeof endpoint) != GZ_OK ||
	    strcmp(endpoint, gz_stream_endpoint(watch->stream)) == 0 ||
	    gz_stream_open_with_keys(endpoint, watch->topics, gz_control_keys(watch->control),
				     watch->log, &stream) != GZ_OK)
		return;
	gz_info(watch->log, "the stream has moved to %s", endpoint);
	watch->lost += counters.lost;
	gz_stream_close(&watch->stream);
	watch->stream = stream;
}

static void follow_stream(struct watch *watch)
{
	struct gz_message message;
	while (!gz_command_interrupted() && !ferror(stdout)) {
		if (gz_stream_read(watch->stream, 200, &message) != GZ_OK) {
			follow_port(watch);
			continue;
		}
		show_message(watch, &message);
		watch->messages++;
		if (watch->settings->count > 0 &&
		    watch->messages >= (uint64_t)watch->settings->count)
			return;
	}
}

static enum gazectl_exit watch_stream(struct watch *watch)
{
	enum gazectl_exit status =
		gazectl_open_stream(watch->control, watch->topics, watch->log, &watch->stream);
	if (status != GAZECTL_DONE)
		return status;
	gz_command_catch_signals();
	/* A program that reads from a pipe gets each line at once. */
	setvbuf(stdout, NULL, _IOLBF, BUFSIZ);
	follow_stream(watch);
	if (watch->line_open)
		putchar('\n');
	gz_info(watch->log, "%" PRIu64 " messages, %" PRIu64 " lost", watch->messages,
		count_lost(watch));
	gz_stream_close(&watch->stream);
	return GAZECTL_DONE;
}

static int watch_run(int argc, char *const *argv, const struct gz_log *log)
{
	struct watch_settings settings;
	struct gz_operands operands;
	int status =
		gz_command_read_arguments(&gazectl_watch, argc, argv, log, &settings, &operands);
	if (status != GZ_COMMAND_GO_ON)
		return status;
	struct watch watch = {
		.settings = &settings,
		.topics = operands.count > 0 ? operands.items : preset_topics,
		.log = log,
		.refreshes = isatty(STDOUT_FILENO) && !settings.all,
	};
	if (gazectl_open_control(&settings.common, log, &watch.control) != GZ_OK)
		return GAZECTL_USAGE;
	status = watch_stream(&watch);
	gz_control_close(&watch.control);
	return status;
}

const struct gz_command gazectl_watch = {
	.program = "gazectl",
	.name = "watch",
	.operands = "[TOPIC]...",
	.operands_max = -1,
	.summary = "print the stream",
	.details =
		"TOPIC is the beginning of a topic: gaze, fixations, saccades, blinks, status, "
		"surfaces;\nwithout TOPIC the first four. On a terminal the gaze is refreshed in "
		"place. The command\nkeeps running when the daemon ends and returns. The last line "
		"gives the number of lost messages.\n",
	.options = watch_options,
	.option_count = sizeof watch_options / sizeof watch_options[0],
	.run = watch_run,
};
