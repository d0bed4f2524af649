/* gazectl status: the daemon's next status message, as a table or as JSON. */
#include "client/gazectl/gazectl.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>

#include "base/clock.h"
#include "protocol/wire.h"

#define GZ_LOG_MODULE "gazectl"

/* Chosen: a status is sent once a second. */
#define STATUS_PATIENCE_NS (3 * GZ_NS_PER_S)

struct status_settings {
	struct gazectl_common common;
	bool json;
};

static const struct gz_option status_options[] = {
	GAZECTL_COMMON_OPTIONS,
	{ .key = "json",
	  .type = GZ_OPTION_BOOL,
	  .offset = offsetof(struct status_settings, json),
	  .preset = "false",
	  .help = "print JSON, with the keys of the status message" },
};

/* One row of the table: its name, then what @p format says. */
__attribute__((format(printf, 2, 3))) static void row(const char *name, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	printf("%-12s ", name);
	vprintf(format, arguments);
	putchar('\n');
	va_end(arguments);
}

static void print_tracker(const struct gz_status *status)
{
	const char *reason = status->tracker.reason, *serial = status->tracker.serial;
	row("tracker", "%s%s%s, %s%s%s", status->tracker.name, serial[0] ? " " : "", serial,
	    gz_tracker_state_name(status->tracker.state), reason[0] ? ": " : "", reason);
}

static void print_rate(const struct gz_status *status)
{
	if (status->rate_hz_nominal > 0)
		row("rate", "%.1f Hz measured, %g Hz nominal", status->rate_hz_measured,
		    status->rate_hz_nominal);
	else
		row("rate", "%.1f Hz measured", status->rate_hz_measured);
}

static const char *rejection_name(int reason)
{
	return gz_rejection_name((enum gz_rejection)reason);
}

static const char *malformed_name(int reason)
{
	return gz_malformed_name((enum gz_malformed)reason);
}

/* The sum of @p counts, and each that is not 0 by its name. */
static void print_reasons(const char *name, const uint64_t *counts, int first, int count,
			  const char *(*reason_name)(int reason))
{
	char text[512] = "";
	size_t used = 0;
	uint64_t sum = 0;
	for (int i = first; i < count; i++) {
		sum += counts[i];
		if (counts[i] && used < sizeof text)
			used += (size_t)snprintf(text + used, sizeof text - used, "%s%s %" PRIu64,
						 used ? ", " : " (", reason_name(i), counts[i]);
	}
	row(name, "%" PRIu64 "%s%s", sum, text, used ? ")" : "");
}

static void print_clock(const struct gz_clock_status *clock)
{
	if (clock->tick == GZ_CLOCK_NONE)
		row("clock", "time of arrival: the tracker has no clock");
	else
		row("clock", "%s tick, offset %.6f s, skew %.2f ppm, uncertainty %.1f us",
		    gz_clock_tick_name(clock->tick), gz_ns_to_s(clock->offset_ns), clock->skew_ppm,
		    clock->sigma_ns / 1000);
}

static void print_display(const struct gz_display *display)
{
	if (!gz_display_valid(display)) {
		row("display", "unknown");
		return;
	}
	const struct gz_point left = { 0, 0.5f }, right = { 1, 0.5f };
	row("display", "%dx%d px, %gx%g mm, %g mm away: %.1f deg wide", display->px[0],
	    display->px[1], display->mm[0], display->mm[1], display->distance_mm,
	    gz_display_angle_deg(display, left, right));
}

static void print_correction(const struct gz_status *status)
{
	const double *x = status->correction.x, *y = status->correction.y;
	if (x[0] == 0 && x[1] == 1 && x[2] == 0 && y[0] == 0 && y[1] == 0 && y[2] == 1)
		row("correction", "none");
	else
		row("correction", "x' = %.4g %+.4g x %+.4g y, y' = %.4g %+.4g x %+.4g y", x[0],
		    x[1], x[2], y[0], y[1], y[2]);
}

static void print_recording(const struct gz_status *status)
{
	const char *state = gz_recording_state_name(status->recording.state);
	if (status->recording.state == GZ_RECORDING_ON)
		row("recording", "%s: %s, %" PRIu64 " samples", state, status->recording.file,
		    status->recording.samples);
	else if (status->recording.state == GZ_RECORDING_FAILED)
		row("recording", "%s: %s: %s; %" PRIu64 " samples are in it", state,
		    status->recording.file, status->recording.error, status->recording.samples);
	else
		row("recording", "%s", state);
}

static void print_table(const struct gz_status *status, const char *endpoint)
{
	print_tracker(status);
	print_rate(status);
	row("samples", "%" PRIu64, status->samples);
	row("lost", "%" PRIu64, status->lost);
	print_reasons("rejected", status->rejected, GZ_REJECT_NONE + 1, GZ_REJECT_COUNT,
		      rejection_name);
	print_reasons("malformed", status->malformed, 0, GZ_MALFORMED_COUNT, malformed_name);
	print_clock(&status->clock);
	if (isfinite(status->noise_deg))
		row("noise", "%.3f deg from sample to sample (RMS within fixations)",
		    status->noise_deg);
	else
		row("noise", "unknown: no fixation yet");
	print_display(&status->display);
	print_correction(status);
	print_recording(status);
	row("subscribers", "%" PRIu32, status->subscribers);
	row("version", "%s", status->version);
	row("stream", "%s", endpoint);
}

static void print_json_tracker(struct gz_json *json, const struct gz_status *status)
{
	gz_json_begin(json, "tracker");
	gz_json_text(json, "name", status->tracker.name);
	gz_json_text(json, "serial", status->tracker.serial);
	gz_json_text(json, "state", gz_tracker_state_name(status->tracker.state));
	gz_json_text(json, "reason", status->tracker.reason);
	gz_json_end(json);
	gz_json_begin(json, "rate_hz");
	gz_json_double(json, "nominal", status->rate_hz_nominal);
	gz_json_double(json, "measured", status->rate_hz_measured);
	gz_json_end(json);
	gz_json_uint(json, "samples", status->samples);
	gz_json_uint(json, "lost", status->lost);
	gz_json_begin(json, "rejected");
	for (int i = GZ_REJECT_NONE + 1; i < GZ_REJECT_COUNT; i++)
		gz_json_uint(json, rejection_name(i), status->rejected[i]);
	gz_json_end(json);
	gz_json_begin(json, "malformed");
	for (int i = 0; i < GZ_MALFORMED_COUNT; i++)
		gz_json_uint(json, malformed_name(i), status->malformed[i]);
	gz_json_end(json);
}

static void print_json_clock(struct gz_json *json, const struct gz_clock_status *clock)
{
	gz_json_begin(json, "clock");
	gz_json_int(json, "offset_ns", clock->offset_ns);
	gz_json_double(json, "skew_ppm", clock->skew_ppm);
	gz_json_double(json, "sigma_ns", clock->sigma_ns);
	gz_json_text(json, "tick", gz_clock_tick_name(clock->tick));
	gz_json_end(json);
}

static void print_json_map(struct gz_json *json, const char *key, const double map[3])
{
	gz_json_begin_list(json, key);
	for (int i = 0; i < 3; i++)
		gz_json_double(json, NULL, map[i]);
	gz_json_end_list(json);
}

static void print_json_correction(struct gz_json *json, const struct gz_status *status)
{
	gz_json_begin(json, "correction");
	print_json_map(json, "x", status->correction.x);
	print_json_map(json, "y", status->correction.y);
	gz_json_end(json);
}

static void print_json_recording(struct gz_json *json, const struct gz_status *status)
{
	gz_json_begin(json, "recording");
	gz_json_text(json, "state", gz_recording_state_name(status->recording.state));
	gz_json_text(json, "file", status->recording.file);
	gz_json_uint(json, "samples", status->recording.samples);
	gz_json_text(json, "error", status->recording.error);
	gz_json_end(json);
}

static void print_json(const struct gz_status *status, const char *endpoint)
{
	struct gz_json json = { .out = stdout };
	gz_json_begin(&json, NULL);
	print_json_tracker(&json, status);
	print_json_clock(&json, &status->clock);
	gz_json_double(&json, "noise_deg", status->noise_deg);
	gz_json_display(&json, "display", &status->display);
	print_json_correction(&json, status);
	print_json_recording(&json, status);
	gz_json_uint(&json, "subscribers", status->subscribers);
	gz_json_text(&json, "version", status->version);
	gz_json_text(&json, "stream", endpoint);
	gz_json_end(&json);
}

static enum gazectl_exit show(const struct status_settings *settings, struct gz_control *control,
			      const struct gz_log *log)
{
	static const char *const topics[] = { GZ_TOPIC_STATUS, NULL };
	struct gz_stream *stream = NULL;
	struct gz_status status;
	enum gazectl_exit exit_status = gazectl_open_stream(control, topics, log, &stream);
	if (exit_status != GAZECTL_DONE)
		return exit_status;
	if (!gazectl_next_status(stream, gz_clock_now_ns() + STATUS_PATIENCE_NS, &status)) {
		gz_err(log, "%s sends no status: it is no gazed, or hangs; restart it",
		       gz_stream_endpoint(stream));
		exit_status = GAZECTL_FAILED;
	} else if (settings->json) {
		print_json(&status, gz_stream_endpoint(stream));
	} else {
		print_table(&status, gz_stream_endpoint(stream));
	}
	gz_stream_close(&stream);
	return exit_status;
}

static int run(int argc, char *const *argv, const struct gz_log *log)
{
	struct status_settings settings;
	struct gz_operands operands;
	int exit_status;
	if (!gz_command_read_arguments(&gazectl_status, argc, argv, log, &settings, &operands,
				       &exit_status))
		return exit_status;
	struct gz_control *control = NULL;
	if (gazectl_open_control(&settings.common, log, &control) != GZ_OK)
		return GAZECTL_USAGE;
	exit_status = show(&settings, control, log);
	gz_control_close(&control);
	return exit_status;
}

const struct gz_command gazectl_status = {
	.program = "gazectl",
	.name = "status",
	.operands = "",
	.operands_max = 0,
	.summary = "print how the tracker, its clock and the recording are",
	.details = "Waits for the daemon's next status message, at most a second old.\n",
	.options = status_options,
	.option_count = sizeof status_options / sizeof status_options[0],
	.run = run,
};
