/* gazectl record and gazectl stop: start and end the daemon's recording. */
#include "client/gazectl/gazectl.h"

#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "protocol/wire.h"

#define GZ_LOG_MODULE "gazectl"

/* Longest wait for a status. Chosen: one is sent at each change, and at least once a second. */
#define STATUS_PATIENCE_NS (2 * GZ_NS_PER_S)

struct record_settings {
	struct gazectl_common common;
};

static const struct gz_option record_options[] = {
	GAZECTL_COMMON_OPTIONS,
};

enum { OPTION_COUNT = sizeof record_options / sizeof record_options[0] };

static const char *const status_topics[] = { GZ_TOPIC_STATUS, NULL };

/* Wait for a status whose recording is in state @p wanted; otherwise take the last status in time.
 * Statuses from before the request may come first. */
static bool wait_recording(struct gz_stream *stream, enum gz_recording_state wanted,
			   struct gz_status *out_status)
{
	int64_t deadline_ns = gz_clock_now_ns() + STATUS_PATIENCE_NS;
	bool found = false;
	while (gazectl_next_status(stream, deadline_ns, out_status)) {
		found = true;
		if (out_status->recording.state == wanted)
			break;
	}
	return found;
}

static enum gazectl_exit report_started(struct gz_stream *stream, const struct gz_log *log)
{
	struct gz_status status;
	if (!wait_recording(stream, GZ_RECORDING_ON, &status)) {
		gz_warn(log, "the recording has started, but %s does not report its file",
			gz_stream_endpoint(stream));
		return GAZECTL_DONE;
	}
	if (status.recording.state == GZ_RECORDING_ON) {
		puts(status.recording.file);
		return GAZECTL_DONE;
	}
	gz_err(log, "the recording stopped at once: %s",
	       status.recording.error[0] ? status.recording.error
					 : "the daemon gives no reason; see its log");
	return GAZECTL_FAILED;
}

static enum gazectl_exit start_and_report(struct gz_control *control, const char *name,
					  const struct gz_log *log)
{
	char request[300], reply[GZ_CONTROL_REPLY_SIZE];
	int length = snprintf(request, sizeof request, name ? "R %s" : "R", name);
	if (length >= (int)sizeof request) {
		gz_err(log, "the name is too long; allowed: 1 to 64 of A-Z a-z 0-9 . _ -");
		return GAZECTL_USAGE;
	}
	/* Subscribe first, so that the status of the start is not missed. */
	struct gz_stream *stream = NULL;
	enum gazectl_exit status = gazectl_open_stream(control, status_topics, log, &stream);
	if (status != GAZECTL_DONE)
		return status;
	status = gazectl_request(control, request, log, reply);
	if (status == GAZECTL_DONE)
		status = report_started(stream, log);
	gz_stream_close(&stream);
	return status;
}

static int run_record(int argc, char *const *argv, const struct gz_log *log)
{
	struct record_settings settings;
	struct gz_operands operands;
	int status =
		gz_command_read_arguments(&gazectl_record, argc, argv, log, &settings, &operands);
	if (status != GZ_COMMAND_GO_ON)
		return status;
	struct gz_control *control = NULL;
	if (gazectl_open_control(&settings.common, log, &control) != GZ_OK)
		return GAZECTL_USAGE;
	status = start_and_report(control, operands.items[0], log);
	gz_control_close(&control);
	return status;
}

static enum gazectl_exit stop_and_report(struct gz_control *control, const struct gz_log *log)
{
	char reply[GZ_CONTROL_REPLY_SIZE];
	struct gz_stream *stream = NULL;
	struct gz_status before = { 0 };
	enum gazectl_exit status = gazectl_open_stream(control, status_topics, log, &stream);
	if (status != GAZECTL_DONE)
		return status;
	/* The status names the file only while it is being written. */
	gazectl_next_status(stream, gz_clock_now_ns() + STATUS_PATIENCE_NS, &before);
	gz_stream_close(&stream);
	status = gazectl_request(control, "r", log, reply);
	if (status == GAZECTL_DONE && before.recording.file[0])
		puts(before.recording.file);
	return status;
}

static int run_stop(int argc, char *const *argv, const struct gz_log *log)
{
	struct record_settings settings;
	struct gz_operands operands;
	int status =
		gz_command_read_arguments(&gazectl_stop, argc, argv, log, &settings, &operands);
	if (status != GZ_COMMAND_GO_ON)
		return status;
	struct gz_control *control = NULL;
	if (gazectl_open_control(&settings.common, log, &control) != GZ_OK)
		return GAZECTL_USAGE;
	status = stop_and_report(control, log);
	gz_control_close(&control);
	return status;
}

const struct gz_command gazectl_record = {
	.program = "gazectl",
	.name = "record",
	.operands = "[NAME]",
	.operands_max = 1,
	.summary = "start a recording and print the name of its file",
	.details = "NAME consists of 1 to 64 of the characters A-Z a-z 0-9 . _ - and becomes the "
		   "name of the file\nin the daemon's recording directory. Without NAME the daemon "
		   "uses the present time.\n",
	.options = record_options,
	.option_count = OPTION_COUNT,
	.run = run_record,
};

const struct gz_command gazectl_stop = {
	.program = "gazectl",
	.name = "stop",
	.operands = "",
	.operands_max = 0,
	.summary = "end the recording and print the name of its file",
	.details = "",
	.options = record_options,
	.option_count = OPTION_COUNT,
	.run = run_stop,
};
