/* gazectl validate: the accuracy and precision of the tracker. Shows targets, collects the samples
 * meanwhile, reports, and stores a correction. */
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/utf8.h"
#include "client/gazectl/gazectl.h"
#include "client/gazectl/output.h"
#include "client/gazectl/validate/correction.h"
#include "client/gazectl/validate/validation.h"
#include "client/gazectl/validate/viewer_process.h"
#include "client/viewer_link.h"
#include "protocol/wire.h"

#define GZ_LOG_MODULE "gazectl"

/* Longest wait for a status. Chosen: one is sent every second. */
#define STATUS_PATIENCE_NS (3 * GZ_NS_PER_S)

/* A daemon that sends nothing for this long has ended: it sends a status every second. */
#define SILENCE_NS (3 * GZ_NS_PER_S)

/* Longest wait for the samples of the last target. Chosen. */
#define TAIL_PATIENCE_NS GZ_NS_PER_S

/* How often the output of gazeview is read between samples. Chosen. */
#define LISTEN_NS (2 * GZ_NS_PER_MS)

/* The command line. */
struct validate_settings {
	struct gazectl_common common;
	char targets[GZ_PATH_SIZE];
	double duration_s;
	int order, seed, advance; /* like the options of gazeview with these names */
	bool instructions, windowed, json, correct, forget;
	char out[GZ_PATH_SIZE], picture[GZ_PATH_SIZE], gazeview[GZ_PATH_SIZE];
	char directory[GZ_PATH_SIZE];
};

static const char *const order_names[] = { "fixed", "random", NULL };
static const char *const advance_names[] = { "auto", "space", NULL };

#define AT(field) offsetof(struct validate_settings, field)

static const struct gz_option validate_options[] = {
	GAZECTL_COMMON_OPTIONS,
	{ "targets", GZ_OPTION_STRING, AT(targets), 0, GZ_PATH_SIZE, 0, NULL, "9",
	  "5, 9, 13, or a file with a line \"x y\" for each (0 0 top left, 1 1 bottom right)" },
	{ "duration", GZ_OPTION_DOUBLE, AT(duration_s), 1.2, 60, 0, NULL, "2.5",
	  "how long each target is shown, s" },
	{ "order", GZ_OPTION_CHOICE, AT(order), 0, 0, 0, order_names, "random",
	  "order of the targets; fixed: as listed" },
	{ "seed", GZ_OPTION_INT, AT(seed), 0, 2147483647, 0, NULL, "0",
	  "seed of the random order; 0: another order each time" },
	{ "advance", GZ_OPTION_CHOICE, AT(advance), 0, 0, 0, advance_names, "auto",
	  "when the next target comes; auto: after --duration; space: when the space bar is "
	  "pressed" },
	{ "instructions", GZ_OPTION_BOOL, AT(instructions), 0, 0, 0, NULL, "true",
	  "show instructions first, and wait for the space bar" },
	{ "window", GZ_OPTION_BOOL, AT(windowed), 0, 0, 0, NULL, "false",
	  "show the targets in a window instead of on the whole display" },
	{ "json", GZ_OPTION_BOOL, AT(json), 0, 0, 0, NULL, "false", "print JSON" },
	{ "out", GZ_OPTION_STRING, AT(out), 0, GZ_PATH_SIZE, 0, NULL, "",
	  "also write the JSON into this file" },
	{ "picture", GZ_OPTION_STRING, AT(picture), 0, GZ_PATH_SIZE, 0, NULL, "",
	  "draw targets and samples into this SVG file" },
	{ "correct", GZ_OPTION_BOOL, AT(correct), 0, 0, 0, NULL, "false",
	  "store the correction if it helps, without asking" },
	{ "forget", GZ_OPTION_BOOL, AT(forget), 0, 0, 0, NULL, "false",
	  "remove the stored correction, and show no targets" },
	{ "corrections", GZ_OPTION_STRING, AT(directory), 0, GZ_PATH_SIZE, 0, NULL, "",
	  "directory of corrections; empty: gazecast/corrections in the user's configuration "
	  "directory" },
	{ "gazeview", GZ_OPTION_STRING, AT(gazeview), 0, GZ_PATH_SIZE, 0, NULL, "",
	  "program that shows the targets; empty: gazeview in the directory of gazectl, else in "
	  "PATH" },
};

/* A check in progress. */
struct check_run {
	const struct validate_settings *settings;
	const struct gz_log *log;
	struct gz_control *control;
	struct gz_stream *stream;
	struct gz_viewer_process viewer;
	struct gz_viewer_link *link; /* to the daemon's inlet; NULL if that is not known */
	struct gz_validation *result;
	bool finished;       /* all targets were shown */
	bool cancelled;      /* by the person in front of the display */
	int64_t heard_ns;    /* when the daemon last sent something */
	int64_t finished_ns; /* when the last target vanished */
	uint64_t missed;     /* gaze messages for which this program was too slow */
};

static enum gz_result start_viewer(struct check_run *check)
{
	const struct validate_settings *settings = check->settings;
	const struct gz_display *display = &check->result->status.display;
	char targets[GZ_PATH_SIZE + 16], duration[64], seed[64], px[64], mm[96], distance[64];
	const char *arguments[12];
	int count = 0;
	snprintf(targets, sizeof targets, "--targets=%s", settings->targets);
	snprintf(duration, sizeof duration, "--duration=%.9g", settings->duration_s);
	snprintf(seed, sizeof seed, "--seed=%d", settings->seed);
	snprintf(px, sizeof px, "--display-px=%dx%d", display->px[0], display->px[1]);
	snprintf(mm, sizeof mm, "--display-mm=%.9g %.9g", display->mm[0], display->mm[1]);
	snprintf(distance, sizeof distance, "--distance-mm=%.9g", display->distance_mm);
	arguments[count++] = targets;
	arguments[count++] = duration;
	arguments[count++] = seed;
	arguments[count++] = px;
	arguments[count++] = mm;
	arguments[count++] = distance;
	arguments[count++] = settings->order == 0 ? "--order=fixed" : "--order=random";
	arguments[count++] = settings->advance == 0 ? "--advance=auto" : "--advance=space";
	arguments[count++] = settings->instructions ? "--instructions=yes" : "--instructions=no";
	arguments[count++] = settings->windowed ? "--window=yes" : "--window=no";
	arguments[count] = NULL;
	return gz_viewer_process_start(&check->viewer, settings->gazeview, arguments, check->log);
}

/* Connect to the daemon's inlet, if that is on this machine. The targets become marks in a running
 * recording, and the simulated viewer of the driver "sim" looks at them. */
static void open_viewer_link(struct check_run *check)
{
	static const char control[] = "/control";
	char latest[GZ_PATH_SIZE];
	const char *own = gz_control_endpoint(check->control);
	size_t length = strlen(own), tail = strlen(control);
	if (length < tail || length >= sizeof latest - 1 ||
	    strcmp(own + length - tail, control) != 0)
		return;
	snprintf(latest, sizeof latest, "%.*s/latest", (int)(length - tail), own);
	if (gz_viewer_link_open(latest, check->log, &check->link) != GZ_OK)
		gz_warn(check->log, "targets will not be marked in recordings");
}

static void tell_simulated_viewer(struct check_run *check, const struct gz_point *point)
{
	if (check->link && strcmp(check->result->status.tracker.name, "sim") == 0)
		gz_viewer_link_pointer(check->link, point, gz_clock_now_ns());
}

static void tell_recording(struct check_run *check, const struct gz_viewer_event *event)
{
	char label[GZ_ANNOTATION_LABEL_SIZE];
	if (!check->link)
		return;
	snprintf(label, sizeof label, "validate: target %zu of %zu at %.4g %.4g", event->index + 1,
		 event->count, event->point.x, event->point.y);
	gz_viewer_link_annotate(check->link, label, event->time_ns);
}

static struct gz_validation_target *newest_target(struct check_run *check)
{
	size_t count = check->result->target_count;
	return count > 0 ? &check->result->target[count - 1] : NULL;
}

static enum gazectl_exit add_target(struct check_run *check, const struct gz_viewer_event *event)
{
	struct gz_validation *result = check->result;
	if (event->index != result->target_count || event->index >= GZ_FIT_TARGETS_MAX) {
		gz_err(check->log,
		       "gazeview reports target %zu after %zu targets: are gazeview and gazectl of "
		       "the same version?",
		       event->index, result->target_count);
		return GAZECTL_FAILED;
	}
	result->target[result->target_count++] = (struct gz_validation_target) {
		.point = event->point,
		.shown_ns = event->time_ns,
		.hidden_ns = event->time_ns,
	};
	tell_simulated_viewer(check, &event->point);
	tell_recording(check, event);
	return GAZECTL_DONE;
}

static enum gazectl_exit report_gone(struct check_run *check)
{
	if (check->finished)
		return GAZECTL_DONE;
	if (check->cancelled) {
		gz_err(check->log, "cancelled after %zu targets; nothing is stored",
		       check->result->target_count > 0 ? check->result->target_count - 1 : 0);
		return GAZECTL_CANCELLED;
	}
	gz_err(check->log, "gazeview ended before all targets were shown; see its messages above");
	return GAZECTL_FAILED;
}

static enum gazectl_exit take_viewer_event(struct check_run *check,
					   const struct gz_viewer_event *event)
{
	struct gz_validation_target *target = newest_target(check);
	switch (event->kind) {
	case GZ_VIEWER_SCREEN:
		check->result->monitor = event->monitor;
		return GAZECTL_DONE;
	case GZ_VIEWER_SHOWN:
		return add_target(check, event);
	case GZ_VIEWER_HIDDEN:
		if (target && event->time_ns > target->shown_ns)
			target->hidden_ns = event->time_ns;
		return GAZECTL_DONE;
	case GZ_VIEWER_FINISHED:
		check->finished = true;
		check->finished_ns = event->time_ns;
		return GAZECTL_DONE;
	case GZ_VIEWER_CANCELLED:
		check->cancelled = true;
		return GAZECTL_DONE;
	case GZ_VIEWER_GONE:
		return report_gone(check);
	}
	return GAZECTL_FAILED;
}

static enum gazectl_exit listen_to_viewer(struct check_run *check)
{
	struct gz_viewer_event event;
	for (;;) {
		enum gz_result result = gz_viewer_process_read(&check->viewer, &event);
		if (result == GZ_ERR_TIMEOUT)
			return GAZECTL_DONE;
		enum gazectl_exit status =
			result == GZ_OK ? take_viewer_event(check, &event) : GAZECTL_FAILED;
		if (status != GAZECTL_DONE)
			return status;
	}
}

static enum gazectl_exit check_status(struct check_run *check, const struct gz_status *status)
{
	enum gz_tracker_state state = status->tracker.state;
	if (state == GZ_TRACKER_RUNNING)
		return GAZECTL_DONE;
	char reason[GZ_REASON_SIZE];
	memcpy(reason, status->tracker.reason, sizeof reason);
	gz_utf8_clean(reason);
	gz_err(check->log,
	       "the tracker is %s%s%s, at target %zu: nothing is stored; try again when gazectl "
	       "status shows that it is running",
	       gz_tracker_state_name(state), reason[0] ? ": " : "", reason,
	       check->result->target_count);
	return GAZECTL_FAILED;
}

static enum gazectl_exit take_stream_message(struct check_run *check,
					     const struct gz_message *message)
{
	check->heard_ns = gz_clock_now_ns();
	if (message->kind == GZ_MESSAGE_STATUS)
		return check_status(check, &message->status);
	if (message->kind != GZ_MESSAGE_GAZE)
		return GAZECTL_DONE;
	check->missed += message->lost;
	enum gz_result result = gz_gaze_trace_add(&check->result->trace, &message->gaze);
	if (result == GZ_OK)
		return GAZECTL_DONE;
	gz_err(check->log,
	       "too many samples: %s; show fewer targets, or show them for a shorter time",
	       gz_result_text(result));
	return GAZECTL_FAILED;
}

/* Whether all samples of the last target have come, with their final labels. */
static bool is_complete(const struct check_run *check)
{
	const struct gz_gaze_trace *trace = &check->result->trace;
	if (!check->finished)
		return false;
	if (gz_clock_now_ns() > check->finished_ns + TAIL_PATIENCE_NS)
		return true;
	/* A final label comes at most 10 ms late. */
	return trace->count > 0 && trace->items[trace->count - 1].sample.host_ns >
					   check->finished_ns + 20 * GZ_NS_PER_MS;
}

static enum gazectl_exit check_silence(const struct check_run *check)
{
	if (gz_command_interrupted()) {
		gz_err(check->log, "cancelled; nothing is stored");
		return GAZECTL_CANCELLED;
	}
	if (gz_clock_now_ns() - check->heard_ns < SILENCE_NS)
		return GAZECTL_DONE;
	gz_err(check->log, "%s sends nothing any more: is gazed still running? Nothing is stored",
	       gz_stream_endpoint(check->stream));
	return GAZECTL_NO_DAEMON;
}

/* Take samples and targets as they come, until the check is complete. */
static enum gazectl_exit collect_until_complete(struct check_run *check)
{
	struct gz_message message;
	int64_t listen_ns = 0;
	check->heard_ns = gz_clock_now_ns();
	while (!is_complete(check)) {
		enum gazectl_exit status = check_silence(check);
		if (status == GAZECTL_DONE && gz_stream_read(check->stream, 5, &message) == GZ_OK)
			status = take_stream_message(check, &message);
		if (status == GAZECTL_DONE && gz_clock_now_ns() >= listen_ns) {
			status = listen_to_viewer(check);
			/* Repeated at intervals, in case the daemon has not received it. */
			if (check->result->target_count > 0)
				tell_simulated_viewer(check, &newest_target(check)->point);
			listen_ns = gz_clock_now_ns() + LISTEN_NS;
		}
		if (status != GAZECTL_DONE)
			return status;
	}
	return GAZECTL_DONE;
}

/* Start gazeview, and collect targets and samples until all are there. */
static enum gazectl_exit collect_samples(struct check_run *check)
{
	enum gazectl_exit status = GAZECTL_FAILED;
	open_viewer_link(check); /* first, because the connection takes a moment */
	if (start_viewer(check) == GZ_OK) {
		status = collect_until_complete(check);
		gz_viewer_process_end(&check->viewer);
		tell_simulated_viewer(check, NULL);
	}
	gz_viewer_link_close(&check->link);
	return status;
}

/* A changed correction ends a recording. */
static bool would_end_recording(const struct check_run *check)
{
	return check->result->status.recording.state == GZ_RECORDING_ON &&
	       (check->settings->correct || check->settings->forget);
}

static enum gazectl_exit check_tracker(const struct check_run *check)
{
	const struct gz_status *status = &check->result->status;
	const char *reason = status->tracker.reason;
	if (status->tracker.state != GZ_TRACKER_RUNNING) {
		gz_err(check->log,
		       "%s cannot be checked: it is %s%s%s; see gazectl status, then try again",
		       status->tracker.name[0] ? status->tracker.name : "the tracker",
		       gz_tracker_state_name(status->tracker.state), reason[0] ? ": " : "", reason);
		return GAZECTL_FAILED;
	}
	if (would_end_recording(check)) {
		gz_err(check->log, "a recording is running, and a changed correction would end it: "
				   "end it first with gazectl stop");
		return GAZECTL_FAILED;
	}
	if (gz_display_valid(&status->display))
		return GAZECTL_DONE;
	gz_err(check->log, "the daemon does not know the display: set display.px, display.mm "
			   "and display.distance_mm in gazed.conf");
	return GAZECTL_FAILED;
}

/* Wait until the tracker is running, before anyone is asked to look at targets: one that was just
 * started may need a moment. The first status may be older than the end of a recording. */
static enum gazectl_exit await_tracker(struct check_run *check)
{
	int64_t deadline_ns = gz_clock_now_ns() + STATUS_PATIENCE_NS;
	struct gz_status *status = &check->result->status;
	int told = 0;
	while (gazectl_next_status(check->stream, deadline_ns, status)) {
		told++;
		if (status->tracker.state == GZ_TRACKER_RUNNING &&
		    (told > 1 || !would_end_recording(check)))
			break;
	}
	if (told > 0)
		return check_tracker(check);
	gz_err(check->log, "%s sends no status: it is not gazed, or gazed hangs; restart it",
	       gz_stream_endpoint(check->stream));
	return GAZECTL_FAILED;
}

static void note_start(struct gz_validation *result)
{
	time_t now = time(NULL);
	struct tm utc;
	gmtime_r(&now, &utc);
	strftime(result->started, sizeof result->started, "%Y-%m-%dT%H:%M:%SZ", &utc);
}

static enum gz_result write_picture_file(const struct gz_validation *result, FILE *out,
					 const struct gz_log *log)
{
	(void)log;
	gz_validation_draw(result, out);
	return GZ_OK;
}

/* Write a file with @p write. An empty path: no file. */
static enum gazectl_exit write_report_file(
	const char *path,
	enum gz_result (*write)(const struct gz_validation *result, FILE *out,
				const struct gz_log *log),
	const struct check_run *check)
{
	enum gz_result result = GZ_OK;
	if (!path[0])
		return GAZECTL_DONE;
	FILE *out = fopen(path, "w");
	bool good = out != NULL;
	if (good) {
		result = write(check->result, out, check->log);
		good = !ferror(out);
		good = fclose(out) == 0 && good;
	}
	if (good)
		return result == GZ_OK ? GAZECTL_DONE : GAZECTL_FAILED;
	gz_err(check->log, "cannot write %s: %s; choose another file", path, strerror(errno));
	return GAZECTL_FAILED;
}

static enum gazectl_exit report_check(const struct check_run *check)
{
	const struct validate_settings *settings = check->settings;
	if (!settings->json)
		gz_validation_print(check->result, stdout);
	else if (gz_validation_write_json(check->result, stdout, check->log) != GZ_OK)
		return GAZECTL_FAILED;
	if (check->missed > 0)
		gz_warn(check->log,
			"%" PRIu64 " messages did not reach gazectl and count as lost samples: is "
			"this machine too busy?",
			check->missed);
	if (check->result->summary[GZ_TRACE_BOTH].targets == 0)
		gz_warn(check->log, "no target was fixated: did anyone look at the targets?");
	enum gazectl_exit status =
		write_report_file(settings->out, gz_validation_write_json, check);
	if (status == GAZECTL_DONE)
		status = write_report_file(settings->picture, write_picture_file, check);
	return status;
}

/* Ask the person at the terminal whether to store the correction. */
static bool ask_to_store(void)
{
	char answer[16];
	fputs("\nStore this correction, so that the daemon applies it from now on? [y/N] ", stdout);
	fflush(stdout);
	return fgets(answer, sizeof answer, stdin) && (answer[0] == 'y' || answer[0] == 'Y');
}

static bool wants_correction(const struct check_run *check)
{
	const struct validate_settings *settings = check->settings;
	if (settings->correct)
		return true;
	return check->result->fit.helps && !settings->json && isatty(STDIN_FILENO) &&
	       isatty(STDOUT_FILENO) && check->result->status.recording.state != GZ_RECORDING_ON &&
	       ask_to_store();
}

static struct gazectl_correction correction_of(const struct check_run *check)
{
	return (struct gazectl_correction) {
		.control = check->control,
		.stream = check->stream,
		.log = check->log,
		.directory = check->settings->directory,
	};
}

static enum gazectl_exit evaluate_and_report(const struct check_run *check)
{
	const struct gazectl_correction correction = correction_of(check);
	enum gz_result result = gz_validation_evaluate(check->result);
	if (result != GZ_OK) {
		gz_err(check->log, "cannot evaluate the check: %s", gz_result_text(result));
		return GAZECTL_FAILED;
	}
	enum gazectl_exit status = report_check(check);
	if (status == GAZECTL_DONE)
		gazectl_validated_store(&correction, check->result);
	if (status == GAZECTL_DONE && wants_correction(check))
		status = gazectl_correction_store(&correction, check->result);
	return status;
}

static enum gazectl_exit check_or_forget(struct check_run *check)
{
	const struct gazectl_correction correction = correction_of(check);
	enum gazectl_exit status = await_tracker(check);
	if (status != GAZECTL_DONE)
		return status;
	if (check->settings->forget)
		return gazectl_correction_forget(&correction, &check->result->status);
	gz_command_catch_signals();
	note_start(check->result);
	status = collect_samples(check);
	return status == GAZECTL_DONE ? evaluate_and_report(check) : status;
}

static enum gazectl_exit run_check(const struct validate_settings *settings,
				   struct gz_control *control, const struct gz_log *log)
{
	static const char *const topics[] = { GZ_TOPIC_GAZE, GZ_TOPIC_STATUS, NULL };
	struct check_run check = { .settings = settings, .log = log, .control = control };
	enum gazectl_exit status = gazectl_open_stream(control, topics, log, &check.stream);
	if (status != GAZECTL_DONE)
		return status;
	check.result = calloc(1, sizeof *check.result);
	status = check.result ? check_or_forget(&check) : GAZECTL_FAILED;
	if (check.result)
		gz_gaze_trace_clear(&check.result->trace);
	free(check.result);
	gz_stream_close(&check.stream);
	return status;
}

static int validate_run(int argc, char *const *argv, const struct gz_log *log)
{
	static struct validate_settings settings;
	struct gz_operands operands;
	int status =
		gz_command_read_arguments(&gazectl_validate, argc, argv, log, &settings, &operands);
	if (status != GZ_COMMAND_GO_ON)
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
	.summary = "show targets and measure the accuracy and precision of the tracker",
	.details =
		"Starts gazeview, which shows one target after another, and computes accuracy "
		"and precision\nin degrees from the samples taken meanwhile. Press the space bar "
		"to start, Esc to cancel.\n",
	.options = validate_options,
	.option_count = sizeof validate_options / sizeof validate_options[0],
	.run = validate_run,
};
