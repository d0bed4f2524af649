/* gazectl validate: how well does the tracker tell where somebody looks? */
#include "client/gazectl/validate/validate.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "client/gazectl/output_file.h"
#include "client/gazectl/validate/correction.h"
#include "client/gazectl/validate/validation_report.h"
#include "protocol/wire.h"

#define GZ_LOG_MODULE "gazectl"

/* Chosen: a status is sent once a second. */
#define STATUS_PATIENCE_NS (3 * GZ_NS_PER_S)

static const char *const order_names[] = { "fixed", "random", NULL };
static const char *const advance_names[] = { "auto", "space", NULL };

#define AT(field) offsetof(struct gazectl_validate_settings, field)

static const struct gz_option validate_options[] = {
	GAZECTL_COMMON_OPTIONS,
	{ "targets", GZ_OPTION_STRING, AT(targets), 0, GZ_PATH_SIZE, 0, NULL, "9",
	  "5, 9, 13, or a file with a line \"x y\" for each (0 0 top left, 1 1 bottom right)" },
	{ "duration", GZ_OPTION_DOUBLE, AT(duration_s), 1.2, 60, 0, NULL, "2.5",
	  "each target stays for so long, s" },
	{ "order", GZ_OPTION_CHOICE, AT(order), 0, 0, 0, order_names, "random",
	  "in which order targets come: as listed, or at random" },
	{ "seed", GZ_OPTION_INT, AT(seed), 0, 2147483647, 0, NULL, "0",
	  "of the random order; 0 takes another one each time" },
	{ "advance", GZ_OPTION_CHOICE, AT(advance), 0, 0, 0, advance_names, "auto",
	  "the next target comes by itself, or when the space bar is pressed" },
	{ "instructions", GZ_OPTION_BOOL, AT(instructions), 0, 0, 0, NULL, "true",
	  "say first what to do, and wait for the space bar" },
	{ "window", GZ_OPTION_BOOL, AT(windowed), 0, 0, 0, NULL, "false",
	  "show targets in a window instead of on the whole display" },
	{ "json", GZ_OPTION_BOOL, AT(json), 0, 0, 0, NULL, "false", "print JSON" },
	{ "out", GZ_OPTION_STRING, AT(out), 0, GZ_PATH_SIZE, 0, NULL, "",
	  "write the JSON into this file, too" },
	{ "picture", GZ_OPTION_STRING, AT(picture), 0, GZ_PATH_SIZE, 0, NULL, "",
	  "draw targets and samples into this SVG file" },
	{ "correct", GZ_OPTION_BOOL, AT(correct), 0, 0, 0, NULL, "false",
	  "store the correction if it helps, without asking" },
	{ "forget", GZ_OPTION_BOOL, AT(forget), 0, 0, 0, NULL, "false",
	  "show nothing, but remove the correction that is stored" },
	{ "corrections", GZ_OPTION_STRING, AT(directory), 0, GZ_PATH_SIZE, 0, NULL, "",
	  "directory of corrections; empty: gazecast/corrections in the user's configuration" },
	{ "gazeview", GZ_OPTION_STRING, AT(gazeview), 0, GZ_PATH_SIZE, 0, NULL, "",
	  "program that shows the targets; empty: gazeview beside gazectl, or in PATH" },
};

static enum gazectl_exit check_tracker(const struct gazectl_validation *validate)
{
	const struct gz_status *status = &validate->result->status;
	const char *reason = status->tracker.reason;
	if (status->tracker.state != GZ_TRACKER_RUNNING) {
		gz_err(validate->log,
		       "%s is %s%s%s: nothing to check; see gazectl status, then try again",
		       status->tracker.name[0] ? status->tracker.name : "the tracker",
		       gz_tracker_state_name(status->tracker.state), reason[0] ? ": " : "", reason);
		return GAZECTL_FAILED;
	}
	if (status->recording.state == GZ_RECORDING_ON &&
	    (validate->settings->correct || validate->settings->forget)) {
		gz_err(validate->log, "a recording is running, which another correction would end: "
				      "end it first, with gazectl stop");
		return GAZECTL_FAILED;
	}
	if (gz_display_valid(&status->display))
		return GAZECTL_DONE;
	gz_err(validate->log, "the daemon does not know the display: set display.px, display.mm "
			      "and display.distance_mm in gazed.conf");
	return GAZECTL_FAILED;
}

/* The tracker must run before anybody is asked to look at targets. One that has just been started
 * may take some moments. */
static enum gazectl_exit await_tracker(struct gazectl_validation *validate)
{
	int64_t deadline_ns = gz_clock_now_ns() + STATUS_PATIENCE_NS;
	struct gz_status *status = &validate->result->status;
	bool told = false;
	while (gazectl_next_status(validate->stream, deadline_ns, status)) {
		told = true;
		if (status->tracker.state == GZ_TRACKER_RUNNING)
			break;
	}
	if (told)
		return check_tracker(validate);
	gz_err(validate->log, "%s sends no status: it is no gazed, or hangs; restart it",
	       gz_stream_endpoint(validate->stream));
	return GAZECTL_FAILED;
}

static void note_start(struct gz_validation *result)
{
	time_t now = time(NULL);
	struct tm utc;
	gmtime_r(&now, &utc);
	strftime(result->started, sizeof result->started, "%Y-%m-%dT%H:%M:%SZ", &utc);
}

/* Write a file by @p print. An empty path is no file. */
static enum gazectl_exit write_file(const char *path,
				    void (*print)(const struct gz_validation *result, FILE *out),
				    const struct gazectl_validation *validate)
{
	if (!path[0])
		return GAZECTL_DONE;
	FILE *out = fopen(path, "w");
	bool good = out != NULL;
	if (good) {
		print(validate->result, out);
		good = !ferror(out);
		good = fclose(out) == 0 && good;
	}
	if (good)
		return GAZECTL_DONE;
	gz_err(validate->log, "cannot write %s: %s; name another file", path, strerror(errno));
	return GAZECTL_FAILED;
}

static enum gazectl_exit report(const struct gazectl_validation *validate)
{
	const struct gazectl_validate_settings *settings = validate->settings;
	if (settings->json)
		gz_validation_write_json(validate->result, stdout);
	else
		gz_validation_print(validate->result, stdout);
	if (validate->missed > 0)
		gz_warn(validate->log,
			"%" PRIu64 " messages did not reach gazectl, and count as lost "
			"samples: is this machine too busy?",
			validate->missed);
	if (validate->result->summary[GZ_TRACE_BOTH].targets == 0)
		gz_warn(validate->log, "no target has samples of a fixation: did somebody look?");
	enum gazectl_exit status = write_file(settings->out, gz_validation_write_json, validate);
	if (status == GAZECTL_DONE)
		status = write_file(settings->picture, gz_validation_draw, validate);
	return status;
}

/* Whether the person at the terminal wants it. */
static bool ask(void)
{
	char answer[16];
	fputs("\nStore this correction, so that the daemon applies it from now on? [y/N] ", stdout);
	fflush(stdout);
	return fgets(answer, sizeof answer, stdin) && (answer[0] == 'y' || answer[0] == 'Y');
}

static bool wants_correction(const struct gazectl_validation *validate)
{
	const struct gazectl_validate_settings *settings = validate->settings;
	if (settings->correct)
		return true;
	return validate->result->fit.helps && !settings->json && isatty(STDIN_FILENO) &&
	       isatty(STDOUT_FILENO) &&
	       validate->result->status.recording.state != GZ_RECORDING_ON && ask();
}

static struct gazectl_correction correction_of(const struct gazectl_validation *validate)
{
	return (struct gazectl_correction) {
		.control = validate->control,
		.stream = validate->stream,
		.log = validate->log,
		.directory = validate->settings->directory,
	};
}

static enum gazectl_exit conclude(const struct gazectl_validation *validate)
{
	const struct gazectl_correction correction = correction_of(validate);
	enum gz_result result = gz_validation_evaluate(validate->result);
	if (result != GZ_OK) {
		gz_err(validate->log, "cannot evaluate the check: %s", gz_result_text(result));
		return GAZECTL_FAILED;
	}
	enum gazectl_exit status = report(validate);
	if (status == GAZECTL_DONE && wants_correction(validate))
		status = gazectl_correction_store(&correction, validate->result);
	return status;
}

static enum gazectl_exit check_or_forget(struct gazectl_validation *validate)
{
	const struct gazectl_correction correction = correction_of(validate);
	enum gazectl_exit status = await_tracker(validate);
	if (status != GAZECTL_DONE)
		return status;
	if (validate->settings->forget)
		return gazectl_correction_forget(&correction, &validate->result->status);
	gz_command_catch_signals();
	note_start(validate->result);
	status = gazectl_validate_collect(validate);
	return status == GAZECTL_DONE ? conclude(validate) : status;
}

static enum gazectl_exit run_check(const struct gazectl_validate_settings *settings,
				   struct gz_control *control, const struct gz_log *log)
{
	static const char *const topics[] = { GZ_TOPIC_GAZE, GZ_TOPIC_STATUS, NULL };
	struct gazectl_validation validate = { .settings = settings,
					       .log = log,
					       .control = control };
	enum gazectl_exit status = gazectl_open_stream(control, topics, log, &validate.stream);
	if (status != GAZECTL_DONE)
		return status;
	validate.result = calloc(1, sizeof *validate.result);
	status = validate.result ? check_or_forget(&validate) : GAZECTL_FAILED;
	if (validate.result)
		gz_gaze_trace_clear(&validate.result->trace);
	free(validate.result);
	gz_stream_close(&validate.stream);
	return status;
}

static int run(int argc, char *const *argv, const struct gz_log *log)
{
	static struct gazectl_validate_settings settings;
	struct gz_operands operands;
	int status;
	if (!gz_command_read_arguments(&gazectl_validate, argc, argv, log, &settings, &operands,
				       &status))
		return status;
	if (gz_output_check_svg(settings.picture, log) != GZ_OK)
		return GAZECTL_USAGE;
	struct gz_control *control = NULL;
	if (gazectl_open_control(&settings.common, log, &control) != GZ_OK)
		return GAZECTL_USAGE;
	status = run_check(&settings, control, log);
	gz_control_close(&control);
	return status;
}

const struct gz_command gazectl_validate = {
	.program = "gazectl",
	.name = "validate",
	.operands = "",
	.operands_max = 0,
	.summary = "show targets and tell how well the tracker finds them",
	.details = "Starts gazeview, which shows one target after another; from the samples that "
		   "come\nmeanwhile it tells accuracy and precision in degrees. The space bar "
		   "begins, Esc cancels.\n",
	.options = validate_options,
	.option_count = sizeof validate_options / sizeof validate_options[0],
	.run = run,
};
