/* Input reports to samples. No allocation, no lock. */
#include <math.h>
#include <string.h>

#include "base/clock.h"
#include "drivers/hid/hid_device.h"
#include "drivers/hid/hid_usages.h"

#define GZ_LOG_MODULE "hid"

/* One line of a kind a second is enough to see that something is wrong. */
#define COMPLAINT_NS GZ_NS_PER_S

static void count_malformed(struct gz_hid_device *device, enum gz_malformed malformed, size_t size)
{
	uint64_t held_back;
	device->malformed[malformed]++;
	if (gz_ratelimit_pass(&device->complaints, gz_clock_now_ns(), COMPLAINT_NS, &held_back))
		gz_warn(device->base.log,
			"%s: device bug: a report of %zu bytes that cannot be (%s); dropped (%llu "
			"more since last told)",
			device->entry.name, size, gz_malformed_name(malformed),
			(unsigned long long)held_back);
}

/* The same report again, time and all, of a clock that is known to run: some never set it. */
static bool is_stale(struct gz_hid_device *device, const struct gz_hid_input_report *report,
		     size_t size)
{
	bool runs = device->clock.settled && device->clock.tick != GZ_CLOCK_NONE;
	bool same = report->has_ticks && runs && size == device->last_size &&
		    memcmp(device->report, device->last, size) == 0;
	memcpy(device->last, device->report, size);
	device->last_size = size;
	return same;
}

static void tell(struct gz_hid_device *device, enum gz_clock_finding finding)
{
	const struct gz_log *log = device->base.log;
	const char *name = device->entry.name;
	uint64_t held_back;
	switch (finding) {
	case GZ_CLOCK_FOUND_NOTHING:
		return;
	case GZ_CLOCK_FOUND_DECLARED:
		gz_info(log, "%s: its clock counts %g ns, as it declares", name,
			device->clock.tick_ns);
		return;
	case GZ_CLOCK_FOUND_ESTIMATED:
		gz_warn(log, "%s: its clock counts %g ns by times of arrival; it declares %g", name,
			device->clock.tick_ns, device->clock.declared_ns);
		return;
	case GZ_CLOCK_FOUND_COARSE:
		gz_warn(log, "%s: its clock is too coarse; times of arrival are used", name);
		return;
	case GZ_CLOCK_FOUND_JUMP:
		if (gz_ratelimit_pass(&device->jumps, gz_clock_now_ns(), COMPLAINT_NS, &held_back))
			gz_warn(log,
				"%s: its clock jumped; its fit begins again (%llu more since last "
				"told)",
				name, (unsigned long long)held_back);
		return;
	}
}

/* Times on both clocks; host time goes on whatever the device's does. */
static void stamp(struct gz_hid_device *device, const struct gz_hid_input_report *report,
		  int64_t arrival_ns, struct gz_sample *sample)
{
	sample->host_ns = arrival_ns;
	if (report->has_ticks) {
		struct gz_clock_stamp times =
			gz_clock_ticks_step(&device->clock, report->ticks, arrival_ns);
		sample->device_ns = times.device_ns;
		sample->host_ns = times.host_ns;
		tell(device, times.finding);
	}
	gz_hid_silence_sample(&device->silence, sample->host_ns, arrival_ns);
	if (device->seq > 0 && sample->host_ns <= device->host_ns)
		sample->host_ns = device->host_ns + 1;
}

/* What one eye does: the class knows one gaze point, at which each eye that is seen looks. */
static void fill_eye(struct gz_eye_sample *eye, const double eye_mm[3], const double gaze_mm[2],
		     const struct gz_sample *sample)
{
	double away[3] = { gaze_mm[0] - eye_mm[0], gaze_mm[1] - eye_mm[1], -eye_mm[2] };
	double length = sqrt(away[0] * away[0] + away[1] * away[1] + away[2] * away[2]);
	for (int axis = 0; axis < 3; axis++)
		eye->origin_mm[axis] = (float)eye_mm[axis];
	if (!sample->valid)
		return;
	eye->valid = true;
	eye->point = sample->point;
	for (int axis = 0; axis < 3; axis++)
		eye->direction[axis] = (float)(away[axis] / length);
}

static void to_sample(struct gz_hid_device *device, const struct gz_hid_input_report *report,
		      int64_t arrival_ns, struct gz_sample *out_sample)
{
	struct gz_sample sample = gz_sample_unmeasured();
	stamp(device, report, arrival_ns, &sample);
	sample.valid = report->has_gaze && device->screen_mm[0] > 0;
	if (sample.valid)
		sample.point =
			(struct gz_point) { (float)(report->gaze_mm[0] / device->screen_mm[0]),
					    (float)(report->gaze_mm[1] / device->screen_mm[1]) };
	for (int eye = 0; eye < GZ_EYE_COUNT; eye++) {
		if (report->has_eye[eye])
			fill_eye(&sample.eye[eye], report->eye_mm[eye], report->gaze_mm, &sample);
	}
	sample.seq = device->seq++;
	device->host_ns = sample.host_ns;
	*out_sample = sample;
}

static void fill_silence(struct gz_hid_device *device, struct gz_sample *out_sample)
{
	struct gz_sample sample = gz_sample_unmeasured();
	sample.host_ns = gz_hid_silence_fill(&device->silence);
	if (sample.host_ns <= device->host_ns)
		sample.host_ns = device->host_ns + 1;
	sample.seq = device->seq++;
	device->host_ns = sample.host_ns;
	*out_sample = sample;
}

static void take_status(struct gz_hid_device *device, const struct gz_hid_input_report *report)
{
	uint64_t held_back;
	if (report->has_rate)
		device->rate_hz = gz_hid_believed_rate(report->rate_hz);
	device->silence.nominal_ns = device->rate_hz > 0 ? 1e9 / device->rate_hz : 0;
	if (!report->has_state || report->state == device->state)
		return;
	device->state = report->state;
	device->was_set_up = device->was_set_up || report->state == GZ_HID_STATE_READY;
	const char *trouble = gz_hid_setup_trouble(device);
	if (gz_ratelimit_pass(&device->changes, gz_clock_now_ns(), COMPLAINT_NS, &held_back))
		gz_info(device->base.log, "%s: %s (%llu more changes since last told)",
			device->entry.name, trouble ? trouble : "it is ready",
			(unsigned long long)held_back);
}

/* GZ_OK with a sample, GZ_ERR_TIMEOUT without one. */
static enum gz_result take_report(struct gz_hid_device *device, size_t size,
				  struct gz_sample *out_sample)
{
	struct gz_hid_input_report report;
	int64_t arrival_ns = gz_clock_now_ns();
	gz_hid_tracker_read(&device->tracker, device->report, size, &report);
	switch (report.kind) {
	case GZ_HID_INPUT_TRACKING:
		if (is_stale(device, &report, size)) {
			count_malformed(device, GZ_MALFORMED_STALE, size);
			return GZ_ERR_TIMEOUT;
		}
		to_sample(device, &report, arrival_ns, out_sample);
		return GZ_OK;
	case GZ_HID_INPUT_STATUS:
		take_status(device, &report);
		return GZ_ERR_TIMEOUT;
	case GZ_HID_INPUT_MALFORMED:
		count_malformed(device, report.malformed, size);
		return GZ_ERR_TIMEOUT;
	case GZ_HID_INPUT_OTHER:
		break;
	}
	return GZ_ERR_TIMEOUT;
}

/* Whole milliseconds from now on, rounded up. */
static int ms_until(int64_t now_ns, int64_t then_ns)
{
	if (then_ns <= now_ns)
		return 0;
	return (int)((then_ns - now_ns + GZ_NS_PER_MS - 1) / GZ_NS_PER_MS);
}

enum gz_result gz_hid_stream_read(struct gz_hid_device *device, int timeout_ms,
				  struct gz_sample *out_sample)
{
	int64_t now_ns = gz_clock_now_ns();
	int64_t deadline_ns = now_ns + timeout_ms * GZ_NS_PER_MS;
	for (;;) {
		size_t size;
		int64_t due_ns = gz_hid_silence_due_ns(&device->silence);
		enum gz_result result = gz_hid_setup_look_after(device, now_ns);
		if (result != GZ_OK)
			return result;
		/* What has arrived counts before silence does, however late it is read. */
		result = gz_hid_port_read(
			device->port, device->report, device->report_size,
			ms_until(now_ns, due_ns < deadline_ns ? due_ns : deadline_ns), &size);
		if (result == GZ_OK)
			result = take_report(device, size, out_sample);
		else if (result == GZ_ERR_TIMEOUT && gz_clock_now_ns() >= due_ns) {
			fill_silence(device, out_sample);
			return GZ_OK;
		}
		if (result != GZ_ERR_TIMEOUT)
			return result;
		/* Garbage without end must not hold the caller. */
		now_ns = gz_clock_now_ns();
		if (now_ns >= deadline_ns)
			return GZ_ERR_TIMEOUT;
	}
}
