#include "daemon/tracker.h"

#include <poll.h>
#include <stdio.h>
#include <unistd.h>

#include "base/clock.h"

#define GZ_LOG_MODULE "tracker"

static void set_tracker_state(struct gz_tracker *tracker, enum gz_tracker_state state,
			      const char *reason)
{
	tracker->state = state;
	snprintf(tracker->reason, sizeof tracker->reason, "%s", reason);
}

static void pause_before_retry(struct gz_tracker *tracker)
{
	int64_t longest_ns = GZ_TRACKER_PAUSE_MAX_MS * GZ_NS_PER_MS;
	if (tracker->pause_ns == 0)
		tracker->pause_ns = GZ_TRACKER_PAUSE_MIN_MS * GZ_NS_PER_MS;
	tracker->retry_ns = gz_clock_now_ns() + tracker->pause_ns;
	tracker->pause_ns = 2 * tracker->pause_ns < longest_ns ? 2 * tracker->pause_ns : longest_ns;
}

static bool may_appear(enum gz_result result)
{
	return result == GZ_ERR_NO_DEVICE || result == GZ_ERR_ACCESS || result == GZ_ERR_BUSY ||
	       result == GZ_ERR_IO;
}

/* The sink of the driver's log. The last warning of a failed search becomes the reason in the
 * status. While a missing device is waited for, messages are not logged again. */
static void relay_driver_message(void *user, enum gz_log_level level, const char *module,
				 const char *message)
{
	struct gz_tracker *tracker = user;
	const struct gz_log *log = tracker->host.log;
	if (atomic_load(&tracker->looking) && level >= GZ_LOG_WARN)
		snprintf(tracker->remark, sizeof tracker->remark, "%s", message);
	if (!atomic_load(&tracker->silent) && gz_log_wants(log, level, module))
		gz_log_write(log, level, module, "%s", message);
}

static enum gz_result create_device(struct gz_tracker *tracker)
{
	struct gz_driver_host host = tracker->host;
	host.log = &tracker->relay;
	tracker->remark[0] = '\0';
	atomic_store(&tracker->looking, true);
	enum gz_result result = tracker->driver->create(tracker->settings, &host, &tracker->device);
	atomic_store(&tracker->looking, false);
	return result;
}

static const char *remark_or(const struct gz_tracker *tracker, const char *otherwise)
{
	return tracker->remark[0] ? tracker->remark : otherwise;
}

/* Search again without logging, unless the reason of the failure has changed: a device that was
 * missing may be there now, but without permission to open it. */
static enum gz_result search_again(struct gz_tracker *tracker)
{
	atomic_store(&tracker->silent, true);
	enum gz_result result = create_device(tracker);
	if (result != GZ_OK)
		tracker->barren = false;
	atomic_store(&tracker->silent, tracker->barren);
	if (result != GZ_OK && result != tracker->result && tracker->remark[0]) {
		gz_warn(tracker->host.log, "%s", tracker->remark);
		set_tracker_state(tracker, tracker->state, tracker->remark);
	}
	return result;
}

static enum gz_result open_tracker_device(struct gz_tracker *tracker, bool again)
{
	tracker->result = again ? search_again(tracker) : create_device(tracker);
	if (tracker->result != GZ_OK)
		return tracker->result;
	tracker->started = false;
	tracker->delivered = false;
	tracker->opened++;
	gz_device_get_info(tracker->device, &tracker->info);
	return GZ_OK;
}

enum gz_result gz_tracker_open(struct gz_tracker *tracker, const struct gz_driver *driver,
			       const void *settings, const struct gz_driver_host *host)
{
	*tracker = (struct gz_tracker) {
		.driver = driver, .settings = settings, .host = *host, .arrivals_fd = -1
	};
	gz_log_init(&tracker->relay, relay_driver_message, tracker,
		    host->log ? host->log->rules : "*:warn");
	snprintf(tracker->info.name, sizeof tracker->info.name, "%s", driver->name);
	enum gz_result result = open_tracker_device(tracker, false);
	if (result == GZ_OK) {
		set_tracker_state(tracker, GZ_TRACKER_STARTING, "");
		return GZ_OK;
	}
	if (!may_appear(result))
		return result;
	set_tracker_state(tracker, GZ_TRACKER_ABSENT, remark_or(tracker, gz_result_text(result)));
	gz_warn(host->log, "%s: not found; retrying", driver->name);
	pause_before_retry(tracker);
	return GZ_OK;
}

void gz_tracker_watch(struct gz_tracker *tracker, int arrivals_fd)
{
	tracker->arrivals_fd = tracker->driver->on_usb ? arrivals_fd : -1;
}

void gz_tracker_update_counters(struct gz_tracker *tracker)
{
	struct gz_device_counters now = { 0 };
	if (!tracker->device)
		return;
	gz_device_get_counters(tracker->device, &now);
	tracker->counters.lost = tracker->base.lost + now.lost;
	for (int i = 0; i < GZ_MALFORMED_COUNT; i++)
		tracker->counters.malformed[i] = tracker->base.malformed[i] + now.malformed[i];
	tracker->counters.clock = now.clock;
	tracker->counters.trouble = now.trouble;
}

static void release_device(struct gz_tracker *tracker)
{
	gz_tracker_update_counters(tracker);
	tracker->counters.trouble = NULL;
	tracker->base = tracker->counters;
	tracker->seq_base = tracker->next_seq;
	gz_device_destroy(&tracker->device);
	tracker->started = false;
}

/* The reason of a loss in words that users know. */
static const char *loss_text(const struct gz_tracker *tracker, enum gz_result result)
{
	if (result != GZ_ERR_NO_DEVICE)
		return gz_result_text(result);
	return tracker->driver->on_usb ? "unplugged" : "connection lost";
}

/* Release a device that failed. A device that can be opened again and again but never delivers is
 * logged only once. */
static void tracker_device_lost(struct gz_tracker *tracker, enum gz_result result)
{
	bool was_there = tracker->samples > 0, told = tracker->barren;
	const char *text = loss_text(tracker, result);
	release_device(tracker);
	tracker->barren = !tracker->delivered;
	tracker->result = result;
	set_tracker_state(tracker, was_there ? GZ_TRACKER_LOST : GZ_TRACKER_ABSENT, text);
	if (!told)
		gz_warn(tracker->host.log, "%s is lost (%s); waiting for it to return",
			tracker->info.name, text);
	pause_before_retry(tracker);
}

/* Wait until @p until_ns, or until a USB device arrives. @return whether one arrived */
static bool wait_for_arrival(struct gz_tracker *tracker, int64_t until_ns)
{
	uint64_t arrivals;
	struct pollfd poll_fd = { .fd = tracker->arrivals_fd, .events = POLLIN };
	int64_t left_ns = until_ns - gz_clock_now_ns();
	if (tracker->arrivals_fd < 0) {
		gz_clock_sleep_until_ns(until_ns);
		return false;
	}
	if (left_ns < 0)
		left_ns = 0;
	struct timespec timeout = { .tv_sec = (time_t)(left_ns / GZ_NS_PER_S),
				    .tv_nsec = (long)(left_ns % GZ_NS_PER_S) };
	return ppoll(&poll_fd, 1, &timeout, NULL) > 0 &&
	       read(tracker->arrivals_fd, &arrivals, sizeof arrivals) == sizeof arrivals;
}

/* Search for the device if that is due before the deadline. */
static enum gz_result find_device(struct gz_tracker *tracker, int64_t deadline_ns)
{
	bool due = tracker->retry_ns <= deadline_ns;
	if (wait_for_arrival(tracker, due ? tracker->retry_ns : deadline_ns))
		tracker->pause_ns = GZ_TRACKER_PAUSE_ARRIVAL_MS * GZ_NS_PER_MS;
	else if (!due)
		return GZ_ERR_TIMEOUT;
	if (open_tracker_device(tracker, true) == GZ_OK)
		return GZ_OK;
	pause_before_retry(tracker);
	return GZ_ERR_TIMEOUT;
}

/* Open and start the device as far as that is due. */
static enum gz_result make_device_ready(struct gz_tracker *tracker, int64_t deadline_ns)
{
	if (!tracker->device) {
		int64_t patience_ns = deadline_ns + GZ_TRACKER_SLOW_MS * GZ_NS_PER_MS;
		if (find_device(tracker, deadline_ns) != GZ_OK || gz_clock_now_ns() > patience_ns)
			return GZ_ERR_TIMEOUT;
	}
	if (tracker->started)
		return GZ_OK;
	enum gz_result result = gz_device_start(tracker->device);
	if (result != GZ_OK) {
		tracker_device_lost(tracker, result);
		return GZ_ERR_TIMEOUT;
	}
	tracker->started = true;
	tracker->arrival_ns = gz_clock_now_ns();
	set_tracker_state(tracker, GZ_TRACKER_STARTING, "");
	return GZ_OK;
}

static void accept_sample(struct gz_tracker *tracker, struct gz_sample *sample)
{
	if (tracker->state != GZ_TRACKER_RUNNING) {
		/* Some devices know their properties only once they stream. */
		gz_device_get_info(tracker->device, &tracker->info);
		set_tracker_state(tracker, GZ_TRACKER_RUNNING, "");
		tracker->delivered = true;
		tracker->barren = false;
		atomic_store(&tracker->silent, false);
		gz_info(tracker->host.log, "%s delivers samples", tracker->info.name);
	}
	tracker->arrival_ns = gz_clock_now_ns();
	tracker->pause_ns = 0;
	tracker->samples++;
	sample->seq += tracker->seq_base;
	tracker->next_seq = sample->seq + 1;
}

static void check_for_silence(struct gz_tracker *tracker)
{
	int64_t silent_ns = gz_clock_now_ns() - tracker->arrival_ns;
	if (silent_ns < GZ_TRACKER_SILENCE_MS * GZ_NS_PER_MS)
		return;
	if (tracker->state == GZ_TRACKER_STARTING && !tracker->reason[0])
		set_tracker_state(tracker, GZ_TRACKER_STARTING, "connected, but no samples yet");
	if (tracker->state != GZ_TRACKER_RUNNING)
		return;
	set_tracker_state(tracker, GZ_TRACKER_LOST, "no samples for a second");
	gz_warn(tracker->host.log, "%s: no samples for a second", tracker->info.name);
}

enum gz_result gz_tracker_read(struct gz_tracker *tracker, int timeout_ms,
			       struct gz_sample *out_sample)
{
	enum gz_result result = GZ_OK;
	if (tracker->state == GZ_TRACKER_ENDED) {
		gz_clock_sleep_until_ns(gz_clock_now_ns() + timeout_ms * GZ_NS_PER_MS);
		return GZ_ERR_TIMEOUT;
	}
	if (!tracker->started)
		result = make_device_ready(tracker, gz_clock_now_ns() + timeout_ms * GZ_NS_PER_MS);
	if (result != GZ_OK)
		return result;
	result = gz_device_read(tracker->device, timeout_ms, out_sample);
	switch (result) {
	case GZ_OK:
		accept_sample(tracker, out_sample);
		return GZ_OK;
	case GZ_ERR_TIMEOUT:
		check_for_silence(tracker);
		return GZ_ERR_TIMEOUT;
	case GZ_ERR_END:
		gz_tracker_update_counters(tracker);
		set_tracker_state(tracker, GZ_TRACKER_ENDED, "the recording is over");
		return GZ_ERR_END;
	default:
		tracker_device_lost(tracker, result);
		return GZ_ERR_TIMEOUT;
	}
}

void gz_tracker_close(struct gz_tracker *tracker)
{
	gz_device_destroy(&tracker->device);
	tracker->started = false;
}

/* Shortest span that is measured: a status sent because of a change may follow the last one at
 * once, and the rate over so short a time would be arbitrary. */
static const double RATE_SPAN_MIN_S = 0.2;

void gz_rate_meter_step(struct gz_rate_meter *meter, int64_t host_ns)
{
	if (meter->count == 0 || host_ns < meter->last_ns) {
		meter->count = 0;
		meter->first_ns = host_ns;
	}
	meter->last_ns = host_ns;
	meter->count++;
}

double gz_rate_meter_take(struct gz_rate_meter *meter)
{
	double span_s = gz_ns_to_s(meter->last_ns) - gz_ns_to_s(meter->first_ns);
	if (meter->count == 0)
		meter->rate_hz = 0;
	if (meter->count < 2 || span_s < RATE_SPAN_MIN_S)
		return meter->rate_hz;
	meter->rate_hz = (double)(meter->count - 1) / span_s;
	/* The newest sample is the first of the next measurement. */
	meter->first_ns = meter->last_ns;
	meter->count = 1;
	return meter->rate_hz;
}
