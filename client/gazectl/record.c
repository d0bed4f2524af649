/* gazectl record and gazectl stop: the daemon's recording. */
#include "client/gazectl/gazectl.h"

#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "protocol/wire.h"

#define GZ_LOG_MODULE "gazectl"

/* Chosen: a status is sent on each change, and once a second in any case. */
#define STATUS_PATIENCE_NS (2 * GZ_NS_PER_S)

struct record_settings {
	struct gazectl_common common;
};

static const struct gz_option record_options[] = {
	GAZECTL_COMMON_OPTIONS,
};

enum { OPTION_COUNT = sizeof record_options / sizeof record_options[0] };

static const char *const status_topics[] = { GZ_TOPIC_STATUS, NULL };

/* The last status within a patience, or the first whose recording is in @p wanted. Statuses sent
 * before the request may come first. */
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
		gz_warn(log, "recording, but %s does not tell into which file",
			gz_stream_endpoint(stream));
		return GAZECTL_DONE;
	}
	if (status.recording.state == GZ_RECORDING_ON) {
		puts(status.recording.file);
		return GAZECTL_DONE;
	}
	gz_err(log, "the recording stopped at once: %s",
	       status.recording.error[0] ? status.recording.error : "the daemon does not say why");
	return GAZECTL_FAILED;
}

static enum gazectl_exit record(struct gz_control *control, const char *name,
				const struct gz_log *log)
{
	char request[300], reply[GZ_CONTROL_REPLY_SIZE];
	int length = snprintf(request, sizeof request, name ? "R %s" : "R", name);
	if (length >= (int)sizeof request) {
		gz_err(log, "a name has at most 64 characters: A-Z a-z 0-9 . _ -");
		return GAZECTL_USAGE;
	}
	/* Listen first, so that the status of the start is not missed. */
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
	int status;
	if (!gz_command_read_arguments(&gazectl_record, argc, argv, log, &settings, &operands,
				       &status))
		return status;
	struct gz_control *control = NULL;
	if (gazectl_open_control(&settings.common, log, &control) != GZ_OK)
		return GAZECTL_USAGE;
	status = record(control, operands.items[0], log);
	gz_control_close(&control);
	return status;
}

static enum gazectl_exit stop(struct gz_control *control, const struct gz_log *log)
{
	char reply[GZ_CONTROL_REPLY_SIZE];
	struct gz_stream *stream = NULL;
	struct gz_status before = { 0 };
	enum gazectl_exit status = gazectl_open_stream(control, status_topics, log, &stream);
	if (status != GAZECTL_DONE)
		return status;
	/* The file's name is in the status as long as it is written to. */
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
	int status;
	if (!gz_command_read_arguments(&gazectl_stop, argc, argv, log, &settings, &operands,
				       &status))
		return status;
	struct gz_control *control = NULL;
	if (gazectl_open_control(&settings.common, log, &control) != GZ_OK)
		return GAZECTL_USAGE;
	status = stop(control, log);
	gz_control_close(&control);
	return status;
}

const struct gz_command gazectl_record = {
	.program = "gazectl",
	.name = "record",
	.operands = "[NAME]",
	.operands_max = 1,
	.summary = "start a recording and print its file's name",
	.details = "NAME has up to 64 characters of A-Z a-z 0-9 . _ - and becomes the file's name "
		   "in the\ndaemon's recording directory; without it the daemon takes the time.\n",
	.options = record_options,
	.option_count = OPTION_COUNT,
	.run = run_record,
};

const struct gz_command gazectl_stop = {
	.program = "gazectl",
	.name = "stop",
	.operands = "",
	.operands_max = 0,
	.summary = "end the recording and print its file's name",
	.details = "",
	.options = record_options,
	.option_count = OPTION_COUNT,
	.run = run_stop,
};
