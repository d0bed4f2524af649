/* gazectl status: the daemon's next status message, as a table or as JSON. */
#include "client/gazectl/gazectl.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "base/utf8.h"
#include "client/gazectl/output.h"
#include "protocol/wire.h"

#define GZ_LOG_MODULE "gazectl"

/* Longest wait for a status. Chosen: one is sent every second. */
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

/* Print one row of the table: its name, then a formatted text. */
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

static const char *refusal_name(int refusal)
{
	return gz_refusal_name((enum gz_refusal)refusal);
}

/* Print the sum of @p counts, and the name and value of each that is not 0. */
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
		row("clock", "time of arrival, because the tracker has no clock");
	else
		row("clock", "%s tick, offset %.6f s, skew %.2f ppm, uncertainty %.1f us",
		    gz_clock_tick_name(clock->tick), gz_ns_to_s(clock->offset_ns), clock->skew_ppm,
		    clock->sigma_ns / 1000);
}

static void print_display_row(const struct gz_display *display)
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

static void print_validation(const struct gz_status *status)
{
	char measured[GZ_NAME_SIZE], changed[GZ_REASON_SIZE];
	memcpy(measured, status->validation.measured, sizeof measured);
	memcpy(changed, status->validation.changed, sizeof changed);
	gz_utf8_clean(measured);
	gz_utf8_clean(changed);
	if (!measured[0]) {
		row("validated", "never, or by another user; run gazectl validate");
		return;
	}
	row("validated", "%s, %.2f deg", measured, status->validation.accuracy_deg);
	if (changed[0])
		row("", "the display has changed since: %s; run gazectl validate again", changed);
}

static void print_recording(const struct gz_status *status)
{
	const char *state = gz_recording_state_name(status->recording.state);
	if (status->recording.state == GZ_RECORDING_ON)
		row("recording", "%s: %s, %" PRIu64 " samples", state, status->recording.file,
		    status->recording.samples);
	else if (status->recording.state == GZ_RECORDING_FAILED)
		row("recording", "%s: %s: %s; it has %" PRIu64 " samples", state,
		    status->recording.file, status->recording.error, status->recording.samples);
	else
		row("recording", "%s", state);
}

static void print_status_table(const struct gz_status *status, const char *endpoint)
{
	print_tracker(status);
	print_rate(status);
	row("samples", "%" PRIu64, status->samples);
	row("lost", "%" PRIu64, status->lost);
	print_reasons("rejected", status->rejected, GZ_REJECT_NONE + 1, GZ_REJECT_COUNT,
		      rejection_name);
	print_reasons("malformed", status->malformed, 0, GZ_MALFORMED_COUNT, malformed_name);
	print_reasons("refused", status->refused, 0, GZ_REFUSAL_COUNT, refusal_name);
	print_clock(&status->clock);
	if (isfinite(status->noise_deg))
		row("noise", "%.3f deg from sample to sample (RMS within fixations)",
		    status->noise_deg);
	else
		row("noise", "unknown: no fixation yet");
	if (status->still_scene)
		row("scene", "still: no pursuit");
	print_display_row(&status->display);
	print_correction(status);
	print_validation(status);
	print_recording(status);
	row("subscribers", "%" PRIu32, status->subscribers);
	row("version", "%s", status->version);
	row("stream", "%s", endpoint);
}

/* Counts by the name of their reason. */
static json_t *json_reasons(const uint64_t *counts, int first, int count,
			    const char *(*reason_name)(int reason))
{
	json_t *reasons = json_object();
	for (int i = first; i < count; i++)
		json_object_set_new(reasons, reason_name(i), gz_output_json_count(counts[i]));
	return reasons;
}

static json_t *json_tracker(const struct gz_status *status)
{
	return json_pack("{so so ss so}", "name", gz_output_json_text(status->tracker.name),
			 "serial", gz_output_json_text(status->tracker.serial), "state",
			 gz_tracker_state_name(status->tracker.state), "reason",
			 gz_output_json_text(status->tracker.reason));
}

static json_t *json_clock(const struct gz_clock_status *clock)
{
	return json_pack("{sI so so ss}", "offset_ns", (json_int_t)clock->offset_ns, "skew_ppm",
			 gz_output_json_number(clock->skew_ppm), "sigma_ns",
			 gz_output_json_number(clock->sigma_ns), "tick",
			 gz_clock_tick_name(clock->tick));
}

static json_t *json_validation(const struct gz_status *status)
{
	return json_pack("{so so so}", "measured", gz_output_json_text(status->validation.measured),
			 "accuracy_deg", gz_output_json_number(status->validation.accuracy_deg),
			 "changed", gz_output_json_text(status->validation.changed));
}

static json_t *json_recording(const struct gz_status *status)
{
	return json_pack("{ss so so so}", "state", gz_recording_state_name(status->recording.state),
			 "file", gz_output_json_text(status->recording.file), "samples",
			 gz_output_json_count(status->recording.samples), "error",
			 gz_output_json_text(status->recording.error));
}

static json_t *json_status(const struct gz_status *status, const char *endpoint)
{
	return json_pack(
		"{so so so so so so so so so sb so s{so so} so so sI so so}", "tracker",
		json_tracker(status), "rate_hz",
		gz_output_json_rate(status->rate_hz_nominal, status->rate_hz_measured), "samples",
		gz_output_json_count(status->samples), "lost", gz_output_json_count(status->lost),
		"rejected",
		json_reasons(status->rejected, GZ_REJECT_NONE + 1, GZ_REJECT_COUNT, rejection_name),
		"malformed", json_reasons(status->malformed, 0, GZ_MALFORMED_COUNT, malformed_name),
		"refused", json_reasons(status->refused, 0, GZ_REFUSAL_COUNT, refusal_name),
		"clock", json_clock(&status->clock), "noise_deg",
		gz_output_json_number(status->noise_deg), "still_scene", status->still_scene,
		"display", gz_output_json_display(&status->display), "correction", "x",
		gz_output_json_numbers(status->correction.x, 3), "y",
		gz_output_json_numbers(status->correction.y, 3), "validation",
		json_validation(status), "recording", json_recording(status), "subscribers",
		(json_int_t)status->subscribers, "version", gz_output_json_text(status->version),
		"stream", gz_output_json_text(endpoint));
}

static enum gazectl_exit show_status(const struct status_settings *settings,
				     struct gz_control *control, const struct gz_log *log)
{
	static const char *const topics[] = { GZ_TOPIC_STATUS, NULL };
	struct gz_stream *stream = NULL;
	struct gz_status status;
	enum gazectl_exit exit_status = gazectl_open_stream(control, topics, log, &stream);
	if (exit_status != GAZECTL_DONE)
		return exit_status;
	if (!gazectl_next_status(stream, gz_clock_now_ns() + STATUS_PATIENCE_NS, &status)) {
		gz_err(log, "%s sends no status: it is not gazed, or gazed hangs; restart it",
		       gz_stream_endpoint(stream));
		exit_status = GAZECTL_FAILED;
	} else if (!settings->json) {
		print_status_table(&status, gz_stream_endpoint(stream));
	} else if (gz_output_json_print(json_status(&status, gz_stream_endpoint(stream)), stdout,
					log) != GZ_OK) {
		exit_status = GAZECTL_FAILED;
	}
	gz_stream_close(&stream);
	return exit_status;
}

static int status_run(int argc, char *const *argv, const struct gz_log *log)
{
	struct status_settings settings;
	struct gz_operands operands;
	int exit_status =
		gz_command_read_arguments(&gazectl_status, argc, argv, log, &settings, &operands);
	if (exit_status != GZ_COMMAND_GO_ON)
		return exit_status;
	struct gz_control *control = NULL;
	if (gazectl_open_control(&settings.common, log, &control) != GZ_OK)
		return GAZECTL_USAGE;
	exit_status = show_status(&settings, control, log);
	gz_control_close(&control);
	return exit_status;
}

const struct gz_command gazectl_status = {
	.program = "gazectl",
	.name = "status",
	.operands = "",
	.operands_max = 0,
	.summary = "print the state of the tracker, its clock and the recording",
	.details =
		"Waits for the next status message of the daemon, which sends one every second.\n",
	.options = status_options,
	.option_count = sizeof status_options / sizeof status_options[0],
	.run = status_run,
};
