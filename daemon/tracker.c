#include "daemon/tracker.h"

#include <stdio.h>

#include "base/clock.h"

#define GZ_LOG_MODULE "tracker"

static void set_state(struct gz_tracker *tracker, enum gz_tracker_state state, const char *reason)
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

/* The driver logs why it fails; while a device is being waited for that is known, and silent. */
static enum gz_result open_device(struct gz_tracker *tracker, bool silent)
{
	struct gz_driver_host host = tracker->host;
	if (silent)
		host.log = NULL;
	enum gz_result result = tracker->driver->create(tracker->settings, &host, &tracker->device);
	if (result == GZ_OK) {
		tracker->started = false;
		tracker->opened++;
		gz_device_get_info(tracker->device, &tracker->info);
	}
	return result;
}

enum gz_result gz_tracker_open(struct gz_tracker *tracker, const struct gz_driver *driver,
			       const void *settings, const struct gz_driver_host *host)
{
	*tracker = (struct gz_tracker) { .driver = driver, .settings = settings, .host = *host };
	snprintf(tracker->info.name, sizeof tracker->info.name, "%s", driver->name);
	enum gz_result result = open_device(tracker, false);
	if (result == GZ_OK) {
		set_state(tracker, GZ_TRACKER_STARTING, "");
		return GZ_OK;
	}
	if (!may_appear(result))
		return result;
	set_state(tracker, GZ_TRACKER_ABSENT, gz_result_text(result));
	gz_warn(host->log, "%s is looked for until it appears", driver->name);
	pause_before_retry(tracker);
	return GZ_OK;
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
}

static void drop_device(struct gz_tracker *tracker)
{
	gz_tracker_update_counters(tracker);
	tracker->base = tracker->counters;
	tracker->seq_base = tracker->next_seq;
	gz_device_destroy(&tracker->device);
	tracker->started = false;
}

static void lose_device(struct gz_tracker *tracker, enum gz_result result)
{
	bool was_there = tracker->samples > 0;
	drop_device(tracker);
	set_state(tracker, was_there ? GZ_TRACKER_LOST : GZ_TRACKER_ABSENT, gz_result_text(result));
	gz_warn(tracker->host.log, "%s is gone (%s); waiting for it", tracker->info.name,
		gz_result_text(result));
	pause_before_retry(tracker);
}

/* Open and start as far as that is due. */
static enum gz_result get_ready(struct gz_tracker *tracker, int64_t deadline_ns)
{
	if (!tracker->device) {
		if (tracker->retry_ns > deadline_ns) {
			gz_clock_sleep_until_ns(deadline_ns);
			return GZ_ERR_TIMEOUT;
		}
		gz_clock_sleep_until_ns(tracker->retry_ns);
		enum gz_result result = open_device(tracker, true);
		if (result != GZ_OK) {
			pause_before_retry(tracker);
			return GZ_ERR_TIMEOUT;
		}
	}
	if (tracker->started)
		return GZ_OK;
	enum gz_result result = gz_device_start(tracker->device);
	if (result != GZ_OK) {
		lose_device(tracker, result);
		return GZ_ERR_TIMEOUT;
	}
	tracker->started = true;
	tracker->arrival_ns = gz_clock_now_ns();
	return GZ_OK;
}

static void take(struct gz_tracker *tracker, struct gz_sample *sample)
{
	if (tracker->state != GZ_TRACKER_RUNNING) {
		/* Some devices know more of themselves once they stream. */
		gz_device_get_info(tracker->device, &tracker->info);
		set_state(tracker, GZ_TRACKER_RUNNING, "");
		gz_info(tracker->host.log, "%s delivers samples", tracker->info.name);
	}
	tracker->arrival_ns = gz_clock_now_ns();
	tracker->pause_ns = 0;
	tracker->samples++;
	sample->seq += tracker->seq_base;
	tracker->next_seq = sample->seq + 1;
}

static void notice_silence(struct gz_tracker *tracker)
{
	int64_t silent_ns = gz_clock_now_ns() - tracker->arrival_ns;
	if (tracker->state != GZ_TRACKER_RUNNING ||
	    silent_ns < GZ_TRACKER_SILENCE_MS * GZ_NS_PER_MS)
		return;
	set_state(tracker, GZ_TRACKER_LOST, "no samples for a second");
	gz_warn(tracker->host.log, "%s: no samples for a second", tracker->info.name);
}

enum gz_result gz_tracker_read(struct gz_tracker *tracker, int timeout_ms,
			       struct gz_sample *out_sample)
{
	int64_t deadline_ns = gz_clock_now_ns() + timeout_ms * GZ_NS_PER_MS;
	if (tracker->state == GZ_TRACKER_ENDED) {
		gz_clock_sleep_until_ns(deadline_ns);
		return GZ_ERR_TIMEOUT;
	}
	enum gz_result result = get_ready(tracker, deadline_ns);
	if (result != GZ_OK)
		return result;
	result = gz_device_read(tracker->device, timeout_ms, out_sample);
	switch (result) {
	case GZ_OK:
		take(tracker, out_sample);
		return GZ_OK;
	case GZ_ERR_TIMEOUT:
		notice_silence(tracker);
		return GZ_ERR_TIMEOUT;
	case GZ_ERR_END:
		gz_tracker_update_counters(tracker);
		set_state(tracker, GZ_TRACKER_ENDED, "the recording is over");
		return GZ_ERR_END;
	default:
		lose_device(tracker, result);
		return GZ_ERR_TIMEOUT;
	}
}

void gz_tracker_close(struct gz_tracker *tracker)
{
	gz_device_destroy(&tracker->device);
	tracker->started = false;
}
