#include "daemon/service.h"

#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <zmq.h>

#include "base/clock.h"
#include "daemon/inlet.h"
#include "daemon/publisher.h"
#include "daemon/service.h"
#include "daemon/tracker.h"
#include "drivers/usb/usb_watch.h"
#include "protocol/wire.h"

#define GZ_LOG_MODULE "service"

/* Most commands between two samples, so that a flood of them does not delay the stream. */
enum { COMMANDS_AT_ONCE = 16 };

struct gz_service {
	struct gz_service_parts parts;
	void *commands; /* the PAIR socket */
	pthread_t thread;
	bool has_thread;
	bool quit;
	bool waiting; /* for readers, before the tracker starts (--wait-readers) */
	struct gz_tracker tracker;
	const void *driver_settings[GZ_CONFIG_DRIVERS_MAX];
	struct gz_usb_watch *watch; /* NULL if arrivals of USB devices cannot be watched */
	uint64_t opened;            /* value of tracker.opened for which maker was set up */
	struct gz_message_maker maker;
	struct gz_rate_meter rate;
	struct gz_viewer_place viewer;
	struct gz_monitor_place monitor; /* that the viewer reported last */
	struct gz_viewer_scenes scenes;
	bool still_scene; /* of the newest sample */
	bool has_validated;
	struct gz_validated validated;     /* set if has_validated */
	char told_changed[GZ_REASON_SIZE]; /* how the display has changed; logged */
	uint64_t rejected[GZ_REJECT_COUNT];
	int64_t host_ns;     /* newest sample's */
	int64_t commands_ns; /* when commands are read next */
	bool hurry;          /* there are more commands than were read at once */
	bool held;           /* a command that waits for the recorder */
	int64_t care_ns;     /* when the periodic work is due */
	int64_t status_ns;   /* when the next status is due */
	/* From the last status sent; a change is sent at once. */
	enum gz_tracker_state told_tracker;
	const char *told_trouble;
	enum gz_recording_state told_recording;
	bool told_still;
	uint32_t told_subscribers;
	uint64_t told_arrivals;       /* a new reader gets a status at once */
	char told_path[GZ_PATH_SIZE]; /* of the recording whose start was announced; empty: none */
	/* Large; used for one sample or command at a time. */
	struct gz_outgoing_batch batch;
	struct gz_gaze_log_header header;
	struct gz_command command;
};

/* Set up the pipeline for the device that was opened. A device that has returned may bring another
 * display or other settings. A log holds one display and one set of settings, so a recording ends
 * when they change. */
static enum gz_result adopt_device(struct gz_service *service)
{
	const struct gz_service_parts *parts = &service->parts;
	const struct gz_device_info *info = &service->tracker.info;
	struct gz_pipeline_params params;
	struct gz_display display = gz_config_display(parts->config, info);
	if (!gz_display_valid(&display)) {
		gz_err(parts->log,
		       "%s: the size of its display is not plausible; set display.px, display.mm "
		       "and display.distance_mm",
		       info->name);
		return GZ_ERR_INVAL;
	}
	enum gz_result result =
		gz_config_pipeline(parts->config, info->recorded, parts->log, &params);
	if (result != GZ_OK)
		return result;
	gz_config_correction(parts->config, info, &display, parts->log, &params);
	service->has_validated =
		gz_config_validated(parts->config, info, parts->log, &service->validated);
	const struct gz_pipeline *pipeline = &service->maker.pipeline;
	bool same = service->opened > 0 &&
		    memcmp(&display, &pipeline->display, sizeof display) == 0 &&
		    memcmp(&params.correct, &pipeline->params.correct, sizeof params.correct) == 0;
	service->opened = service->tracker.opened;
	if (same)
		return GZ_OK;
	if (gz_recorder_running(parts->recorder)) {
		gz_warn(parts->log, "the display or the correction has changed, so the recording "
				    "ends here");
		gz_recorder_stop(parts->recorder);
	}
	gz_message_maker_init(&service->maker, parts->config, &params, &display);
	return GZ_OK;
}

/* Describe the stream of the Lab Streaming Layer with the tracker and its display. */
static void tell_lsl_of_device(struct gz_service *service)
{
	const struct gz_device_info *info = &service->tracker.info;
	struct gz_lsl_device device = { .rate_hz = info->rate_hz,
					.display = service->maker.pipeline.display };
	memcpy(device.tracker, info->name, sizeof device.tracker);
	memcpy(device.serial, info->serial, sizeof device.serial);
	if (service->tracker.opened > 0)
		gz_lsl_outlet_set_device(service->parts.lsl, &device);
}

enum gz_result gz_service_create(const struct gz_service_parts *parts,
				 struct gz_service **out_service)
{
	const void *settings;
	struct gz_service *service = calloc(1, sizeof *service);
	if (!service)
		return GZ_ERR_NO_MEM;
	service->parts = *parts;
	service->waiting = parts->config->wait_readers > 0;
	const struct gz_driver *driver = gz_config_driver(parts->config, &settings);
	const struct gz_config *config = parts->config;
	const struct gz_driver_host host = {
		.log = parts->log,
		.choice = config->tracker,
		.pointer = parts->pointer,
		.display_mm = { config->display_mm[0], config->display_mm[1] },
		.settings = service->driver_settings,
	};
	gz_config_all_settings(config, service->driver_settings);
	/* Before the first search, so that no device arrives unnoticed between the two. */
	if (driver->on_usb)
		gz_usb_watch_create(GZ_UDEV_CONTROL, parts->log, &service->watch);
	enum gz_result result = gz_tracker_open(&service->tracker, driver, settings, &host);
	gz_tracker_watch(&service->tracker, gz_usb_watch_fd(service->watch));
	if (result == GZ_OK)
		result = adopt_device(service);
	if (result != GZ_OK) {
		gz_service_destroy(&service);
		return result;
	}
	tell_lsl_of_device(service);
	*out_service = service;
	return GZ_OK;
}

static void fill_log_header(struct gz_service *service)
{
	struct gz_gaze_log_header *header = &service->header;
	const struct gz_device_info *info = &service->tracker.info;
	*header = (struct gz_gaze_log_header) {
		.rate_hz = info->rate_hz,
		.has_display = true,
		.display = service->maker.pipeline.display,
	};
	snprintf(header->tracker, sizeof header->tracker, "%s", info->name);
	snprintf(header->serial, sizeof header->serial, "%s", info->serial);
	snprintf(header->software, sizeof header->software, "gazed %s", GAZECAST_VERSION);
	time_t now = time(NULL);
	struct tm utc;
	gmtime_r(&now, &utc);
	strftime(header->started, sizeof header->started, "%Y-%m-%dT%H:%M:%SZ", &utc);
	gz_config_describe_pipeline(&service->maker.pipeline.params, header);
}

static void send_notification(struct gz_service *service, const char *topic)
{
	const struct gz_wire_message *message = &service->batch.item[0].body;
	gz_publisher_send_one(service->parts.publisher, topic, message->bytes, message->size);
}

/* Pupil clients wait for recording.stopped and recording.started, whoever asked for the recording.
 */
static void notify_stopped(struct gz_service *service)
{
	if (service->told_path[0] == '\0')
		return;
	if (gz_wire_encode_recording_stopped(service->told_path, &service->batch.item[0].body) ==
	    GZ_OK)
		send_notification(service, GZ_TOPIC_NOTIFY GZ_SUBJECT_RECORDING_STOPPED);
	service->told_path[0] = '\0';
}

/* Whether the recording is finished, not only asked to end: a reader that is told may open the
 * file.
 */
static bool recording_has_ended(const struct gz_service *service)
{
	struct gz_recorder_status status;
	gz_recorder_get_status(service->parts.recorder, &status);
	return status.state != GZ_RECORDING_ON;
}

static void notify_started(struct gz_service *service, const char *path)
{
	const char *slash = strrchr(path, '/');
	char session[GZ_PATH_SIZE];
	notify_stopped(service); /* for a recording that has just ended */
	snprintf(service->told_path, sizeof service->told_path, "%s", path);
	snprintf(session, sizeof session, "%s", slash ? slash + 1 : path);
	char *dot = strrchr(session, '.');
	if (dot)
		*dot = '\0';
	if (gz_wire_encode_recording_started(path, session, gz_clock_now_ns(),
					     &service->batch.item[0].body) == GZ_OK)
		send_notification(service, GZ_TOPIC_NOTIFY GZ_SUBJECT_RECORDING_STARTED);
}

/* The pipeline returns to its start state when a log begins, because its replay begins in that
 * state: what the pipeline learnt before the first recorded sample is not in the log. */
enum gz_result gz_service_record(struct gz_service *service, int fd, const char *path)
{
	fill_log_header(service);
	enum gz_result result =
		gz_recorder_start(service->parts.recorder, fd, path, &service->header);
	if (result != GZ_OK)
		return result;
	gz_message_maker_reset(&service->maker);
	struct gz_gaze_log_record window;
	if (gz_viewer_place_at_start(&service->viewer, gz_clock_now_ns(), &window))
		gz_recorder_push(service->parts.recorder, &window);
	notify_started(service, path);
	return GZ_OK;
}

static void record_gap(struct gz_service *service, int64_t host_ns, uint64_t missing,
		       const char *reason)
{
	struct gz_gaze_log_record gap = { .kind = GZ_GAZE_LOG_GAP,
					  .host_ns = host_ns,
					  .missing = missing };
	snprintf(gap.text, sizeof gap.text, "%s", reason);
	gz_recorder_push(service->parts.recorder, &gap);
}

static void record_sample(struct gz_service *service, const struct gz_sample *sample)
{
	if (!gz_recorder_running(service->parts.recorder))
		return;
	if (sample->lost_before > 0)
		record_gap(service, sample->host_ns, sample->lost_before, "lost by the tracker");
	struct gz_gaze_log_record record;
	record.kind = GZ_GAZE_LOG_SAMPLE;
	record.sample = *sample;
	gz_recorder_push(service->parts.recorder, &record);
}

static void serve_sample(struct gz_service *service, const struct gz_sample *sample)
{
	struct gz_publisher *publisher = service->parts.publisher;
	service->maker.without_surfaces = !gz_publisher_wants_surfaces(publisher);
	gz_message_maker_step(&service->maker, sample, service->tracker.arrival_ns,
			      &service->batch);
	gz_publisher_send(publisher, &service->batch);
	gz_lsl_outlet_step(service->parts.lsl, &service->batch.step);
	service->rejected[service->batch.step.rejection]++;
	record_sample(service, sample);
	gz_rate_meter_step(&service->rate, sample->host_ns);
	service->host_ns = sample->host_ns;
}

static void send_notice(struct gz_service *service, enum gz_notice_kind kind, uint32_t number,
			enum gz_result result)
{
	struct gz_notice notice = { kind, number, result };
	zmq_send(service->commands, &notice, sizeof notice, ZMQ_DONTWAIT);
}

static void follow_viewer_window(struct gz_service *service, const struct gz_command *command)
{
	struct gz_gaze_log_record window;
	const int *rect_px = command->window.known ? command->window.rect_px : NULL;
	service->monitor = command->window.monitor;
	gz_viewer_scenes_step(&service->scenes, &command->window, command->host_ns);
	if (gz_viewer_place_step(&service->viewer, rect_px, command->host_ns, &window))
		gz_recorder_push(service->parts.recorder, &window);
}

static void obey_command(struct gz_service *service, const struct gz_command *command)
{
	enum gz_result result = GZ_OK;
	switch (command->kind) {
	case GZ_COMMAND_RECORD:
		result = gz_service_record(service, command->fd, command->path);
		send_notice(service, GZ_NOTICE_ANSWER, command->number, result);
		return;
	case GZ_COMMAND_STOP:
		gz_recorder_stop(service->parts.recorder);
		send_notice(service, GZ_NOTICE_ANSWER, command->number, result);
		return;
	case GZ_COMMAND_CORRECT:
		if (service->tracker.opened > 0)
			(void)adopt_device(service); /* cannot fail: the display is unchanged */
		service->status_ns = 0;              /* send the correction now in force */
		service->care_ns = 0;
		send_notice(service, GZ_NOTICE_ANSWER, command->number, GZ_OK);
		return;
	case GZ_COMMAND_SEND: /* done in take_commands() */
		return;
	case GZ_COMMAND_WINDOW:
		follow_viewer_window(service, command);
		return;
	case GZ_COMMAND_QUIT:
		service->quit = true;
		return;
	}
}

/* Write the mark of a client's message into the gaze log. */
static void record_mark(struct gz_service *service, const struct gz_command *command)
{
	struct gz_gaze_log_record mark = { .kind = GZ_GAZE_LOG_MARK,
					   .host_ns = command->host_ns,
					   .duration_ns = command->duration_ns };
	memcpy(mark.text, command->text, sizeof mark.text);
	memcpy(mark.keys, command->keys, sizeof mark.keys);
	gz_recorder_push(service->parts.recorder, &mark);
}

/* Send a message from the inlet: its body is the next frame. */
static void resend_client_message(struct gz_service *service)
{
	zmq_msg_t body;
	zmq_msg_init(&body);
	if (service->command.has_mark) {
		record_mark(service, &service->command);
		gz_lsl_outlet_annotate(service->parts.lsl, service->command.host_ns,
				       service->command.text);
	}
	if (zmq_msg_recv(&body, service->commands, ZMQ_DONTWAIT) >= 0)
		gz_publisher_send_one(service->parts.publisher, service->command.topic,
				      zmq_msg_data(&body), zmq_msg_size(&body));
	zmq_msg_close(&body);
}

/* Whether a mark must wait until the recorder has room, because the disk is slow. Samples cannot
 * wait, so half of the room is theirs. */
static bool mark_must_wait(const struct gz_service *service, const struct gz_command *command)
{
	const struct gz_recorder *recorder = service->parts.recorder;
	return command->kind == GZ_COMMAND_SEND && command->has_mark &&
	       gz_recorder_running(recorder) && !gz_recorder_has_room(recorder);
}

/* Take the next command, unless it must wait. @return whether one was taken */
static bool take_command(struct gz_service *service)
{
	struct gz_command *command = &service->command;
	if (!service->held && zmq_recv(service->commands, command, sizeof *command, ZMQ_DONTWAIT) !=
				      (int)sizeof *command)
		return false;
	service->held = mark_must_wait(service, command);
	if (service->held)
		return false;
	if (command->kind == GZ_COMMAND_SEND)
		resend_client_message(service);
	else
		obey_command(service, command);
	return true;
}

static void take_commands(struct gz_service *service, int64_t now_ns)
{
	int taken = 0;
	if (now_ns < service->commands_ns)
		return;
	while (taken < COMMANDS_AT_ONCE && take_command(service))
		taken++;
	service->hurry = taken == COMMANDS_AT_ONCE;
	int wait_ms = service->hurry ? GZ_SERVICE_HURRY_MS : GZ_SERVICE_COMMANDS_MS;
	service->commands_ns = now_ns + wait_ms * GZ_NS_PER_MS;
}

static void fill_refusals(const struct gz_service *service, uint64_t refused[GZ_REFUSAL_COUNT])
{
	const struct gz_guard *guard = service->parts.guard;
	refused[GZ_REFUSAL_CONNECTIONS] = gz_guard_ended(guard, GZ_QUOTA_TOO_MANY);
	refused[GZ_REFUSAL_SUBSCRIPTIONS] = gz_guard_ended(guard, GZ_QUOTA_TOO_LARGE) +
					    gz_publisher_refused(service->parts.publisher);
	const struct gz_inlet_counts *counts = service->parts.inlet_counts;
	refused[GZ_REFUSAL_MESSAGES] = atomic_load_explicit(&counts->refused, memory_order_relaxed);
	refused[GZ_REFUSAL_OVERFLOW] =
		atomic_load_explicit(&counts->overflow, memory_order_relaxed);
	refused[GZ_REFUSAL_LSL] = gz_lsl_outlet_lost(service->parts.lsl);
}

/* Say what the tracker was validated on, and how that has changed since. */
static void fill_validation(const struct gz_service *service, struct gz_status *status)
{
	const struct gz_monitor_place unknown = { .scale = 0 };
	bool seen = service->viewer.known &&
		    gz_clock_now_ns() - service->viewer.heard_ns <= GZ_VIEWER_WINDOW_NS;
	status->validation.accuracy_deg = NAN;
	if (!service->has_validated)
		return;
	memcpy(status->validation.measured, service->validated.measured,
	       sizeof status->validation.measured);
	status->validation.accuracy_deg = service->validated.accuracy_deg;
	gz_validated_changed(&service->validated, &status->display,
			     seen ? &service->monitor : &unknown, status->validation.changed);
}

static bool is_scene_still(const struct gz_service *service)
{
	return service->maker.pipeline.params.classify.still_scene || service->still_scene;
}

static void fill_status(struct gz_service *service, struct gz_status *status)
{
	const struct gz_tracker *tracker = &service->tracker;
	struct gz_recorder_status recorder;
	gz_recorder_get_status(service->parts.recorder, &recorder);
	*status = (struct gz_status) {
		.rate_hz_nominal = tracker->info.rate_hz,
		.samples = tracker->samples,
		.lost = tracker->counters.lost,
		.clock = tracker->counters.clock,
		.noise_deg = gz_pipeline_noise_deg(&service->maker.pipeline),
		.still_scene = is_scene_still(service),
		.display = service->maker.pipeline.display,
		.subscribers = gz_publisher_subscribers(service->parts.publisher),
		.version = GAZECAST_VERSION,
	};
	const struct gz_correct_params *correct = &service->maker.pipeline.params.correct;
	memcpy(status->correction.x, correct->x, sizeof status->correction.x);
	memcpy(status->correction.y, correct->y, sizeof status->correction.y);
	status->tracker.state = tracker->state;
	if (tracker->state == GZ_TRACKER_RUNNING)
		status->rate_hz_measured = gz_rate_meter_take(&service->rate);
	memcpy(status->tracker.name, tracker->info.name, sizeof status->tracker.name);
	memcpy(status->tracker.serial, tracker->info.serial, sizeof status->tracker.serial);
	/* While the device is open, its own report of trouble is more precise. */
	bool open = tracker->state == GZ_TRACKER_STARTING || !tracker->reason[0];
	snprintf(status->tracker.reason, sizeof status->tracker.reason, "%s",
		 open && tracker->counters.trouble ? tracker->counters.trouble : tracker->reason);
	memcpy(status->rejected, service->rejected, sizeof status->rejected);
	memcpy(status->malformed, tracker->counters.malformed, sizeof status->malformed);
	fill_refusals(service, status->refused);
	fill_validation(service, status);
	status->recording.state = recorder.state;
	status->recording.samples = recorder.samples;
	memcpy(status->recording.error, recorder.error, sizeof status->recording.error);
	if (recorder.state != GZ_RECORDING_OFF)
		gz_recorder_get_path(service->parts.recorder, status->recording.file);
}

/* Report the tracker's state for `systemctl status`. */
static void notify_manager(const struct gz_service *service, const struct gz_status *status)
{
	char text[sizeof status->tracker.name + sizeof status->tracker.reason + 64];
	snprintf(text, sizeof text, "%s: %s%s%s", status->tracker.name,
		 gz_tracker_state_name(status->tracker.state),
		 status->tracker.reason[0] ? ", " : "", status->tracker.reason);
	gz_notify_status(service->parts.notify, text);
}

/* Log how the display has changed since the validation, once. */
static void log_changed_display(struct gz_service *service, const struct gz_status *status)
{
	const char *changed = status->validation.changed;
	if (strcmp(service->told_changed, changed) == 0)
		return;
	memcpy(service->told_changed, changed, sizeof service->told_changed);
	if (changed[0])
		gz_warn(service->parts.log,
			"the display has changed since %s was validated (%s): %s; run gazectl "
			"validate again",
			status->tracker.name, status->validation.measured, changed);
}

static void send_status(struct gz_service *service)
{
	struct gz_status status;
	gz_tracker_update_counters(&service->tracker);
	fill_status(service, &status);
	log_changed_display(service, &status);
	struct gz_wire_message *message = &service->batch.item[0].body;
	if (gz_wire_encode_status(&status, message) == GZ_OK)
		gz_publisher_send_one(service->parts.publisher, GZ_TOPIC_STATUS, message->bytes,
				      message->size);
	if (service->told_tracker != status.tracker.state)
		notify_manager(service, &status);
	service->told_tracker = status.tracker.state;
	service->told_trouble = service->tracker.counters.trouble;
	service->told_recording = status.recording.state;
	service->told_still = status.still_scene;
	service->told_subscribers = status.subscribers;
	service->told_arrivals = gz_publisher_arrivals(service->parts.publisher);
}

static bool status_changed(const struct gz_service *service)
{
	struct gz_recorder_status recorder;
	gz_recorder_get_status(service->parts.recorder, &recorder);
	return service->told_tracker != service->tracker.state ||
	       service->told_trouble != service->tracker.counters.trouble ||
	       service->told_recording != recorder.state ||
	       service->told_still != is_scene_still(service) ||
	       service->told_subscribers != gz_publisher_subscribers(service->parts.publisher) ||
	       service->told_arrivals != gz_publisher_arrivals(service->parts.publisher);
}

/* What is done every GZ_SERVICE_CARE_MS, and not for every sample. */
static void do_periodic_work(struct gz_service *service, int64_t now_ns)
{
	if (now_ns < service->care_ns)
		return;
	service->care_ns = now_ns + GZ_SERVICE_CARE_MS * GZ_NS_PER_MS;
	gz_notify_alive(service->parts.notify, now_ns);
	gz_publisher_update(service->parts.publisher);
	if (service->waiting && gz_publisher_subscriptions(service->parts.publisher) >=
					(uint32_t)service->parts.config->wait_readers)
		service->waiting = false;
	if (recording_has_ended(service))
		notify_stopped(service);
	gz_tracker_update_counters(&service->tracker);
	if (now_ns >= service->status_ns || status_changed(service)) {
		send_status(service);
		service->status_ns = now_ns + GZ_SERVICE_STATUS_MS * GZ_NS_PER_MS;
	}
}

/* Each sample gets its certain event, the last ones too. */
static void send_last_events(struct gz_service *service)
{
	struct gz_outgoing *last = &service->batch.item[0];
	while (gz_message_maker_flush(&service->maker, last))
		gz_publisher_send_one(service->parts.publisher, last->topic, last->body.bytes,
				      last->body.size);
}

static void end_replay(struct gz_service *service)
{
	send_last_events(service);
	gz_info(service->parts.log, "the replay is over after %llu samples",
		(unsigned long long)service->tracker.samples);
	gz_recorder_stop(service->parts.recorder);
	send_notice(service, GZ_NOTICE_ENDED, 0, GZ_OK);
}

/* Whether the tracker has told its display only now. */
static bool is_display_late(const struct gz_service *service)
{
	struct gz_display display =
		gz_config_display(service->parts.config, &service->tracker.info);
	return !gz_display_same(&display, &service->maker.pipeline.display);
}

/* Adapt the pipeline to a new device, and record the loss of one in the gaze log. */
static void follow_tracker(struct gz_service *service, enum gz_tracker_state before)
{
	enum gz_tracker_state state = service->tracker.state;
	bool is_new = service->tracker.opened != service->opened;
	bool begins = state != before && state == GZ_TRACKER_RUNNING;
	if (is_new || (begins && is_display_late(service))) {
		if (adopt_device(service) != GZ_OK) {
			send_notice(service, GZ_NOTICE_FAILED, 0, GZ_ERR_INVAL);
			service->quit = true;
			return;
		}
		tell_lsl_of_device(service);
	}
	if (state != before && state == GZ_TRACKER_LOST)
		record_gap(service, service->host_ns, 0, service->tracker.reason);
}

/* Note in a new sample what viewers say about their scenes. A recorded one has it already. */
static void ask_viewers(struct gz_service *service, struct gz_sample *sample)
{
	if (!service->tracker.info.recorded)
		sample->still_scene =
			service->parts.config->viewers_still_scene &&
			gz_viewer_scenes_still(&service->scenes, service->tracker.arrival_ns);
	service->still_scene = sample->still_scene;
}

static void serve_tracker(struct gz_service *service)
{
	struct gz_sample sample;
	enum gz_tracker_state before = service->tracker.state;
	int wait_ms = service->hurry ? GZ_SERVICE_HURRY_MS : GZ_SERVICE_WAIT_MS;
	enum gz_result result = gz_tracker_read(&service->tracker, wait_ms, &sample);
	follow_tracker(service, before);
	if (service->quit)
		return;
	if (result == GZ_OK) {
		ask_viewers(service, &sample);
		serve_sample(service, &sample);
	} else if (result == GZ_ERR_END)
		end_replay(service);
}

/* A source that delivers on demand, faster than any disk, waits until the recorder has room, so
 * that nothing is lost. A live tracker cannot wait. */
static bool must_wait_for_recorder(const struct gz_service *service)
{
	const struct gz_recorder *recorder = service->parts.recorder;
	return service->tracker.info.on_demand && gz_recorder_running(recorder) &&
	       !gz_recorder_has_room(recorder);
}

static void *service_run(void *user)
{
	struct gz_service *service = user;
	pthread_setname_np(pthread_self(), "gazed-serve");
	while (!service->quit) {
		int64_t now_ns = gz_clock_now_ns();
		take_commands(service, now_ns);
		do_periodic_work(service, now_ns);
		if (service->waiting || must_wait_for_recorder(service))
			gz_clock_sleep_until_ns(gz_clock_now_ns() +
						GZ_SERVICE_WAIT_MS * GZ_NS_PER_MS);
		else
			serve_tracker(service);
	}
	gz_recorder_stop(service->parts.recorder);
	notify_stopped(service);
	send_status(service);
	gz_tracker_close(&service->tracker);
	return NULL;
}

enum gz_result gz_service_start(struct gz_service *service)
{
	int linger = 0;
	service->commands = zmq_socket(service->parts.context, ZMQ_PAIR);
	if (!service->commands ||
	    zmq_setsockopt(service->commands, ZMQ_LINGER, &linger, sizeof linger) != 0 ||
	    zmq_connect(service->commands, GZ_COMMAND_ENDPOINT) != 0) {
		gz_err(service->parts.log, "cannot open the command socket: %s",
		       zmq_strerror(errno));
		return GZ_ERR_IO;
	}
	if (pthread_create(&service->thread, NULL, service_run, service) != 0) {
		gz_err(service->parts.log, "cannot start the thread that serves samples: %s",
		       strerror(errno));
		return GZ_ERR_NO_MEM;
	}
	service->has_thread = true;
	return GZ_OK;
}

void gz_service_destroy(struct gz_service **service)
{
	if (!service || !*service)
		return;
	struct gz_service *s = *service;
	if (s->has_thread)
		pthread_join(s->thread, NULL);
	if (s->commands)
		zmq_close(s->commands);
	gz_tracker_close(&s->tracker);
	gz_usb_watch_destroy(&s->watch);
	free(s);
	*service = NULL;
}
