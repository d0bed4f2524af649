/* gazectl validate: how well does the tracker tell where somebody looks? */
#include "client/gazectl.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "client/gazectl_correction.h"
#include "client/validation.h"
#include "client/validation_report.h"
#include "client/viewer_link.h"
#include "client/viewer_process.h"
#include "protocol/wire.h"

#define GZ_LOG_MODULE "gazectl"

/* Chosen: a status is sent once a second. */
#define STATUS_PATIENCE_NS (3 * GZ_NS_PER_S)

/* A daemon that sends nothing for so long has gone: a status comes every second. */
#define SILENCE_NS (3 * GZ_NS_PER_S)

/* How long the samples of the last target are waited for. */
#define TAIL_PATIENCE_NS GZ_NS_PER_S

/* How often gazeview is listened to between samples. */
#define LISTEN_NS (2 * GZ_NS_PER_MS)

static const char *const order_names[] = { "fixed", "random", NULL };
static const char *const advance_names[] = { "auto", "space", NULL };

struct validate_settings {
	struct gazectl_common common;
	char targets[GZ_PATH_SIZE];
	double duration_s;
	int order, seed, advance;
	bool instructions, windowed, json, correct, forget;
	char out[GZ_PATH_SIZE], picture[GZ_PATH_SIZE], gazeview[GZ_PATH_SIZE];
	char directory[GZ_PATH_SIZE];
};

#define AT(field) offsetof(struct validate_settings, field)

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
	{ "directory", GZ_OPTION_STRING, AT(directory), 0, GZ_PATH_SIZE, 0, NULL, "",
	  "where corrections are; empty: gazecast/corrections in the user's configuration" },
	{ "gazeview", GZ_OPTION_STRING, AT(gazeview), 0, GZ_PATH_SIZE, 0, NULL, "",
	  "program that shows the targets; empty: gazeview beside gazectl, or in PATH" },
};

/* A check under way. */
struct validate {
	const struct validate_settings *settings;
	const struct gz_log *log;
	struct gz_control *control;
	struct gz_stream *stream;
	struct gz_viewer_process viewer;
	struct gz_viewer_link *link; /* to the daemon's inlet; NULL where that cannot be told */
	struct gz_validation *result;
	bool finished;       /* all targets were shown */
	bool cancelled;      /* by the person in front of the display */
	int64_t heard_ns;    /* when the daemon last sent something */
	int64_t finished_ns; /* when the last target vanished */
	uint64_t missed;     /* gaze messages that this program was too slow for */
};

static enum gazectl_exit check_tracker(const struct validate *validate)
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
static enum gazectl_exit await_tracker(struct validate *validate)
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

static enum gz_result start_viewer(struct validate *validate)
{
	const struct validate_settings *settings = validate->settings;
	const struct gz_display *display = &validate->result->status.display;
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
	return gz_viewer_process_start(&validate->viewer, settings->gazeview, arguments,
				       validate->log);
}

/* To the daemon's inlet, where that is on this machine: a recording that runs is told of the
 * targets, and so is the viewer of a simulated tracker, before which nobody sits. */
static void open_link(struct validate *validate)
{
	static const char control[] = "/control";
	char latest[GZ_PATH_SIZE];
	const char *own = gz_control_endpoint(validate->control);
	size_t length = strlen(own), tail = strlen(control);
	if (length < tail || length >= sizeof latest - 1 ||
	    strcmp(own + length - tail, control) != 0)
		return;
	snprintf(latest, sizeof latest, "%.*s/latest", (int)(length - tail), own);
	if (gz_viewer_link_open(latest, validate->log, &validate->link) != GZ_OK)
		gz_warn(validate->log, "a recording will not be told of the targets");
}

static void tell_simulated_viewer(struct validate *validate, const struct gz_point *point)
{
	if (validate->link && strcmp(validate->result->status.tracker.name, "sim") == 0)
		gz_viewer_link_pointer(validate->link, point, gz_clock_now_ns());
}

static void tell_recording(struct validate *validate, const struct gz_viewer_event *event)
{
	char label[GZ_ANNOTATION_LABEL_SIZE];
	if (!validate->link)
		return;
	snprintf(label, sizeof label, "validate: target %zu of %zu at %.4g %.4g", event->index + 1,
		 event->count, event->point.x, event->point.y);
	gz_viewer_link_annotate(validate->link, label, event->time_ns);
}

static struct gz_validation_target *newest_target(struct validate *validate)
{
	size_t count = validate->result->target_count;
	return count > 0 ? &validate->result->target[count - 1] : NULL;
}

static enum gazectl_exit take_shown(struct validate *validate, const struct gz_viewer_event *event)
{
	struct gz_validation *result = validate->result;
	if (event->index != result->target_count || event->index >= GZ_FIT_TARGETS_MAX) {
		gz_err(validate->log,
		       "gazeview tells of target %zu after %zu targets: is it of "
		       "this version?",
		       event->index, result->target_count);
		return GAZECTL_FAILED;
	}
	result->target[result->target_count++] = (struct gz_validation_target) {
		.point = event->point,
		.shown_ns = event->time_ns,
		.hidden_ns = event->time_ns,
	};
	tell_simulated_viewer(validate, &event->point);
	tell_recording(validate, event);
	return GAZECTL_DONE;
}

static enum gazectl_exit report_gone(struct validate *validate)
{
	if (validate->finished)
		return GAZECTL_DONE;
	if (validate->cancelled) {
		gz_err(validate->log, "cancelled after %zu targets; nothing is stored",
		       validate->result->target_count > 0 ? validate->result->target_count - 1 : 0);
		return GAZECTL_CANCELLED;
	}
	gz_err(validate->log, "gazeview has ended before all targets were shown; what it said "
			      "stands above");
	return GAZECTL_FAILED;
}

static enum gazectl_exit take_event(struct validate *validate, const struct gz_viewer_event *event)
{
	struct gz_validation_target *target = newest_target(validate);
	switch (event->kind) {
	case GZ_VIEWER_SCREEN:
		return GAZECTL_DONE;
	case GZ_VIEWER_SHOWN:
		return take_shown(validate, event);
	case GZ_VIEWER_HIDDEN:
		if (target && event->time_ns > target->shown_ns)
			target->hidden_ns = event->time_ns;
		return GAZECTL_DONE;
	case GZ_VIEWER_FINISHED:
		validate->finished = true;
		validate->finished_ns = event->time_ns;
		return GAZECTL_DONE;
	case GZ_VIEWER_CANCELLED:
		validate->cancelled = true;
		return GAZECTL_DONE;
	case GZ_VIEWER_GONE:
		return report_gone(validate);
	}
	return GAZECTL_FAILED;
}

static enum gazectl_exit listen_to_viewer(struct validate *validate)
{
	struct gz_viewer_event event;
	for (;;) {
		enum gz_result result = gz_viewer_process_read(&validate->viewer, &event);
		if (result == GZ_ERR_TIMEOUT)
			return GAZECTL_DONE;
		enum gazectl_exit status =
			result == GZ_OK ? take_event(validate, &event) : GAZECTL_FAILED;
		if (status != GAZECTL_DONE)
			return status;
	}
}

static enum gazectl_exit take_status(struct validate *validate, const struct gz_status *status)
{
	enum gz_tracker_state state = status->tracker.state;
	if (state == GZ_TRACKER_RUNNING)
		return GAZECTL_DONE;
	char reason[GZ_REASON_SIZE];
	memcpy(reason, status->tracker.reason, sizeof reason);
	gazectl_make_printable(reason);
	gz_err(validate->log,
	       "the tracker is %s%s%s, at target %zu: nothing is stored; when gazectl status says "
	       "that it runs, try again",
	       gz_tracker_state_name(state), reason[0] ? ": " : "", reason,
	       validate->result->target_count);
	return GAZECTL_FAILED;
}

static enum gazectl_exit take_message(struct validate *validate, const struct gz_message *message)
{
	validate->heard_ns = gz_clock_now_ns();
	if (message->kind == GZ_MESSAGE_STATUS)
		return take_status(validate, &message->status);
	if (message->kind != GZ_MESSAGE_GAZE)
		return GAZECTL_DONE;
	validate->missed += message->lost;
	enum gz_result result = gz_gaze_trace_add(&validate->result->trace, &message->gaze);
	if (result == GZ_OK)
		return GAZECTL_DONE;
	gz_err(validate->log, "no room for so many samples: %s; show fewer targets, or shorter",
	       gz_result_text(result));
	return GAZECTL_FAILED;
}

/* Whether everything that belongs to the last target has come. */
static bool has_all(const struct validate *validate)
{
	const struct gz_gaze_trace *trace = &validate->result->trace;
	if (!validate->finished)
		return false;
	if (gz_clock_now_ns() > validate->finished_ns + TAIL_PATIENCE_NS)
		return true;
	/* A label comes at most 10 ms late. */
	return trace->count > 0 && trace->items[trace->count - 1].sample.host_ns >
					   validate->finished_ns + 20 * GZ_NS_PER_MS;
}

static enum gazectl_exit check_silence(const struct validate *validate)
{
	if (gazectl_interrupted()) {
		gz_err(validate->log, "cancelled; nothing is stored");
		return GAZECTL_CANCELLED;
	}
	if (gz_clock_now_ns() - validate->heard_ns < SILENCE_NS)
		return GAZECTL_DONE;
	gz_err(validate->log, "%s has fallen silent: does gazed still run? Nothing is stored",
	       gz_stream_endpoint(validate->stream));
	return GAZECTL_NO_DAEMON;
}

/* Samples and targets as they come, until all are there. */
static enum gazectl_exit collect(struct validate *validate)
{
	struct gz_message message;
	int64_t listen_ns = 0;
	validate->heard_ns = gz_clock_now_ns();
	while (!has_all(validate)) {
		enum gazectl_exit status = check_silence(validate);
		if (status == GAZECTL_DONE &&
		    gz_stream_read(validate->stream, 5, &message) == GZ_OK)
			status = take_message(validate, &message);
		if (status == GAZECTL_DONE && gz_clock_now_ns() >= listen_ns) {
			status = listen_to_viewer(validate);
			/* Again, for who has not heard it: sent when it is due. */
			if (validate->result->target_count > 0)
				tell_simulated_viewer(validate, &newest_target(validate)->point);
			listen_ns = gz_clock_now_ns() + LISTEN_NS;
		}
		if (status != GAZECTL_DONE)
			return status;
	}
	return GAZECTL_DONE;
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
				    const struct validate *validate)
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

static enum gazectl_exit report(const struct validate *validate)
{
	const struct validate_settings *settings = validate->settings;
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

static bool wants_correction(const struct validate *validate)
{
	const struct validate_settings *settings = validate->settings;
	if (settings->correct)
		return true;
	return validate->result->fit.helps && !settings->json && isatty(STDIN_FILENO) &&
	       isatty(STDOUT_FILENO) &&
	       validate->result->status.recording.state != GZ_RECORDING_ON && ask();
}

static struct gazectl_correction correction_of(const struct validate *validate)
{
	return (struct gazectl_correction) {
		.control = validate->control,
		.stream = validate->stream,
		.log = validate->log,
		.directory = validate->settings->directory,
	};
}

static enum gazectl_exit conclude(const struct validate *validate)
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

static enum gazectl_exit check_or_forget(struct validate *validate)
{
	const struct gazectl_correction correction = correction_of(validate);
	enum gazectl_exit status = await_tracker(validate);
	if (status != GAZECTL_DONE)
		return status;
	if (validate->settings->forget)
		return gazectl_correction_forget(&correction, &validate->result->status);
	gazectl_catch_signals();
	note_start(validate->result);
	if (start_viewer(validate) != GZ_OK)
		return GAZECTL_FAILED;
	open_link(validate);
	status = collect(validate);
	gz_viewer_process_end(&validate->viewer);
	tell_simulated_viewer(validate, NULL);
	gz_viewer_link_close(&validate->link);
	return status == GAZECTL_DONE ? conclude(validate) : status;
}

static enum gazectl_exit run_check(const struct validate_settings *settings,
				   struct gz_control *control, const struct gz_log *log)
{
	static const char *const topics[] = { GZ_TOPIC_GAZE, GZ_TOPIC_STATUS, NULL };
	struct validate validate = { .settings = settings, .log = log, .control = control };
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

static enum gazectl_exit run(int argc, char *const *argv, const struct gz_log *log)
{
	static struct validate_settings settings;
	struct gazectl_operands operands;
	enum gazectl_exit status;
	if (!gazectl_read_arguments(&gazectl_validate, argc, argv, log, &settings, &operands,
				    &status))
		return status;
	struct gz_control *control = NULL;
	if (gazectl_open_control(&settings.common, log, &control) != GZ_OK)
		return GAZECTL_USAGE;
	status = run_check(&settings, control, log);
	gz_control_close(&control);
	return status;
}

const struct gazectl_command gazectl_validate = {
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
