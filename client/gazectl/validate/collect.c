/* gazectl validate: targets are shown, and samples taken meanwhile. */
#include "client/gazectl/validate/validate.h"

#include <stdio.h>
#include <string.h>

#include "base/clock.h"

#define GZ_LOG_MODULE "gazectl"

/* A daemon that sends nothing for so long has gone: a status comes every second. */
#define SILENCE_NS (3 * GZ_NS_PER_S)

/* How long the samples of the last target are waited for. */
#define TAIL_PATIENCE_NS GZ_NS_PER_S

/* How often gazeview is listened to between samples. */
#define LISTEN_NS (2 * GZ_NS_PER_MS)

static enum gz_result start_viewer(struct gazectl_validation *validate)
{
	const struct gazectl_validate_settings *settings = validate->settings;
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
static void open_link(struct gazectl_validation *validate)
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

static void tell_simulated_viewer(struct gazectl_validation *validate, const struct gz_point *point)
{
	if (validate->link && strcmp(validate->result->status.tracker.name, "sim") == 0)
		gz_viewer_link_pointer(validate->link, point, gz_clock_now_ns());
}

static void tell_recording(struct gazectl_validation *validate, const struct gz_viewer_event *event)
{
	char label[GZ_ANNOTATION_LABEL_SIZE];
	if (!validate->link)
		return;
	snprintf(label, sizeof label, "validate: target %zu of %zu at %.4g %.4g", event->index + 1,
		 event->count, event->point.x, event->point.y);
	gz_viewer_link_annotate(validate->link, label, event->time_ns);
}

static struct gz_validation_target *newest_target(struct gazectl_validation *validate)
{
	size_t count = validate->result->target_count;
	return count > 0 ? &validate->result->target[count - 1] : NULL;
}

static enum gazectl_exit take_shown(struct gazectl_validation *validate,
				    const struct gz_viewer_event *event)
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

static enum gazectl_exit report_gone(struct gazectl_validation *validate)
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

static enum gazectl_exit take_event(struct gazectl_validation *validate,
				    const struct gz_viewer_event *event)
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

static enum gazectl_exit listen_to_viewer(struct gazectl_validation *validate)
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

static enum gazectl_exit take_status(struct gazectl_validation *validate,
				     const struct gz_status *status)
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

static enum gazectl_exit take_message(struct gazectl_validation *validate,
				      const struct gz_message *message)
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
static bool has_all(const struct gazectl_validation *validate)
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

static enum gazectl_exit check_silence(const struct gazectl_validation *validate)
{
	if (gz_command_interrupted()) {
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
static enum gazectl_exit collect(struct gazectl_validation *validate)
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

enum gazectl_exit gazectl_validate_collect(struct gazectl_validation *validate)
{
	enum gazectl_exit status = GAZECTL_FAILED;
	open_link(validate); /* first: it takes a moment until it stands */
	if (start_viewer(validate) == GZ_OK) {
		status = collect(validate);
		gz_viewer_process_end(&validate->viewer);
		tell_simulated_viewer(validate, NULL);
	}
	gz_viewer_link_close(&validate->link);
	return status;
}
