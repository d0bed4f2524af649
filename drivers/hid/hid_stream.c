/* Input reports to samples, and silence filled in. No allocation, no lock. */
#include <math.h>
#include <string.h>

#include "base/clock.h"
#include "drivers/hid/hid_device.h"

#define GZ_LOG_MODULE "hid"

/* Steps after which the measured period is believed, and how fast it follows. Chosen: as in the
 * pipeline. */
enum { STEPS_ENOUGH = 16 };
static const double GAIN = 1.0 / 16;

/* Longer steps are never a period, in periods. Chosen: shorter than blinks at any rate. */
static const double PERIOD_STEPS_MAX = 6;

/* The period until one is measured, which takes half a second: that of the slowest trackers, ns.
 * The stated period is too often wrong. */
static const double SLOWEST_NS = 1e9 / 30;

/* How fast a long gap between arrivals is forgotten, for each sample, and the longest gap that is
 * attributed to the link, ns. Chosen: a stall counts for some tenths of a second; no link buffers
 * for longer than a frame or two of a screen. */
static const double GAP_DECAY = 1 - 1.0 / 32;
static const double GAP_MAX_NS = 40e6;

double gz_hid_silence_period_ns(const struct gz_hid_silence *silence)
{
	if (silence->steps >= STEPS_ENOUGH)
		return silence->measured_ns;
	return fmax(silence->nominal_ns, SLOWEST_NS);
}

/* Consecutive samples that arrive far apart came in bursts. */
static void learn_arrival_gap(struct gz_hid_silence *silence, double step_ns,
			      double arrival_step_ns)
{
	silence->gap_ns *= GAP_DECAY;
	if (step_ns < 1.5 * gz_hid_silence_period_ns(silence))
		silence->gap_ns = fmax(silence->gap_ns, fmin(arrival_step_ns, GAP_MAX_NS));
}

void gz_hid_silence_sample(struct gz_hid_silence *silence, int64_t host_ns, int64_t arrival_ns)
{
	double step_ns = (double)(host_ns - silence->host_ns);
	/* A step across a blink or a clock jump is not a period. A step across a few fillers may be
	 * one, of a tracker that has become slower. */
	if (silence->started && step_ns > 0 &&
	    step_ns < PERIOD_STEPS_MAX * gz_hid_silence_period_ns(silence)) {
		if (silence->steps == 0)
			silence->measured_ns = fmin(step_ns, SLOWEST_NS);
		double change_ns = step_ns - silence->measured_ns;
		silence->measured_ns += GAIN * fmin(change_ns, silence->measured_ns);
		if (silence->steps < STEPS_ENOUGH)
			silence->steps++;
	}
	if (silence->started)
		learn_arrival_gap(silence, step_ns, (double)(arrival_ns - silence->arrival_ns));
	silence->started = true;
	silence->host_ns = host_ns;
	silence->arrival_ns = arrival_ns;
	silence->filled = 0;
}

int64_t gz_hid_silence_due_ns(const struct gz_hid_silence *silence)
{
	if (!silence->started)
		return INT64_MAX;
	/* The first fillers together, then one for each period. */
	double period_ns = gz_hid_silence_period_ns(silence);
	double late_ns = fmax(period_ns, silence->gap_ns);
	double due_ns = (double)(silence->filled + 1) * period_ns + late_ns;
	return silence->arrival_ns + (int64_t)fmax(GZ_HID_SILENCE_PERIODS * period_ns, due_ns);
}

int64_t gz_hid_silence_fill(struct gz_hid_silence *silence)
{
	silence->filled++;
	return silence->host_ns +
	       (int64_t)((double)silence->filled * gz_hid_silence_period_ns(silence));
}

static void count_hid_malformed(struct gz_hid_device *device, enum gz_malformed malformed,
				size_t size)
{
	device->malformed[malformed]++;
	gz_warn_limited(device->base.log, &device->complaints,
			"%s: device bug: malformed report of %zu bytes dropped: %s",
			device->entry.name, size, gz_malformed_name(malformed));
}

/* Whether the device sent the same report again, including its time, although its clock runs. Some
 * devices never set their time. */
static bool is_hid_report_stale(struct gz_hid_device *device,
				const struct gz_hid_input_report *report, size_t size)
{
	bool runs = device->clock.settled && device->clock.tick != GZ_CLOCK_NONE;
	bool same = report->has_ticks && runs && size == device->last_size &&
		    memcmp(device->report, device->last, size) == 0;
	memcpy(device->last, device->report, size);
	device->last_size = size;
	return same;
}

static void report_clock_finding(struct gz_hid_device *device, enum gz_clock_finding finding)
{
	const struct gz_log *log = device->base.log;
	const char *name = device->entry.name;
	switch (finding) {
	case GZ_CLOCK_FOUND_NOTHING:
		return;
	case GZ_CLOCK_FOUND_DECLARED:
		gz_info(log, "%s: the clock ticks every %g ns, as it declares", name,
			device->clock.tick_ns);
		return;
	case GZ_CLOCK_FOUND_ESTIMATED:
		gz_warn(log,
			"%s: the clock ticks every %g ns by times of arrival, but declares %g ns; "
			"the measured tick is used",
			name, device->clock.tick_ns, device->clock.declared_ns);
		return;
	case GZ_CLOCK_FOUND_COARSE:
		gz_warn(log, "%s: the clock is too coarse; times of arrival are used", name);
		return;
	case GZ_CLOCK_FOUND_JUMP:
		gz_warn_limited(log, &device->jumps,
				"%s: the clock jumped; the clock fit starts again", name);
		return;
	}
}

/* Set the times on both clocks. Host time never runs backwards, whatever the device clock does. */
static void stamp_hid_sample(struct gz_hid_device *device, const struct gz_hid_input_report *report,
			     int64_t arrival_ns, struct gz_sample *sample)
{
	sample->host_ns = arrival_ns;
	if (report->has_ticks) {
		struct gz_clock_stamp times =
			gz_clock_ticks_step(&device->clock, report->ticks, arrival_ns);
		sample->device_ns = times.device_ns;
		sample->host_ns = times.host_ns;
		report_clock_finding(device, times.finding);
	}
	gz_hid_silence_sample(&device->silence, sample->host_ns, arrival_ns);
	if (device->seq > 0 && sample->host_ns <= device->host_ns)
		sample->host_ns = device->host_ns + 1;
}

/* Fill in one eye. The class knows one gaze point, at which each visible eye looks. */
static void fill_hid_eye(struct gz_eye_sample *eye, const double eye_mm[3], const double gaze_mm[2],
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

static void hid_report_to_sample(struct gz_hid_device *device,
				 const struct gz_hid_input_report *report, int64_t arrival_ns,
				 struct gz_sample *out_sample)
{
	struct gz_sample sample = gz_sample_unmeasured();
	stamp_hid_sample(device, report, arrival_ns, &sample);
	sample.valid = report->has_gaze && device->screen_mm[0] > 0;
	if (sample.valid)
		sample.point =
			(struct gz_point) { (float)(report->gaze_mm[0] / device->screen_mm[0]),
					    (float)(report->gaze_mm[1] / device->screen_mm[1]) };
	for (int eye = 0; eye < GZ_EYE_COUNT; eye++) {
		if (report->has_eye[eye])
			fill_hid_eye(&sample.eye[eye], report->eye_mm[eye], report->gaze_mm,
				     &sample);
	}
	sample.seq = device->seq++;
	device->host_ns = sample.host_ns;
	*out_sample = sample;
}

static void fill_in_sample(struct gz_hid_device *device, struct gz_sample *out_sample)
{
	struct gz_sample sample = gz_sample_unmeasured();
	sample.host_ns = gz_hid_silence_fill(&device->silence);
	if (sample.host_ns <= device->host_ns)
		sample.host_ns = device->host_ns + 1;
	sample.seq = device->seq++;
	device->host_ns = sample.host_ns;
	*out_sample = sample;
}

static void take_status_report(struct gz_hid_device *device,
			       const struct gz_hid_input_report *report)
{
	if (report->has_rate)
		device->rate_hz = gz_hid_believed_rate(report->rate_hz);
	device->silence.nominal_ns = device->rate_hz > 0 ? 1e9 / device->rate_hz : 0;
	if (!report->has_state || report->state == device->state)
		return;
	device->state = report->state;
	device->was_set_up = device->was_set_up || report->state == GZ_HID_STATE_READY;
	const char *trouble = gz_hid_setup_trouble(device);
	uint64_t held_back;
	if (gz_ratelimit_pass(&device->changes, gz_clock_now_ns(), GZ_NS_PER_S, &held_back))
		gz_info(device->base.log, "%s: %s (%llu more not shown)", device->entry.name,
			trouble ? trouble : "it is ready", (unsigned long long)held_back);
}

/* Read a report. @retval GZ_OK  it is a sample. @retval GZ_ERR_TIMEOUT  it is not */
static enum gz_result take_hid_report(struct gz_hid_device *device, size_t size,
				      struct gz_sample *out_sample)
{
	struct gz_hid_input_report report;
	int64_t arrival_ns = gz_clock_now_ns();
	gz_hid_tracker_read(&device->tracker, device->report, size, &report);
	switch (report.kind) {
	case GZ_HID_INPUT_TRACKING:
		if (is_hid_report_stale(device, &report, size)) {
			count_hid_malformed(device, GZ_MALFORMED_STALE, size);
			return GZ_ERR_TIMEOUT;
		}
		hid_report_to_sample(device, &report, arrival_ns, out_sample);
		return GZ_OK;
	case GZ_HID_INPUT_STATUS:
		take_status_report(device, &report);
		return GZ_ERR_TIMEOUT;
	case GZ_HID_INPUT_MALFORMED:
		count_hid_malformed(device, report.malformed, size);
		return GZ_ERR_TIMEOUT;
	case GZ_HID_INPUT_OTHER:
		break;
	}
	return GZ_ERR_TIMEOUT;
}

/* Time until @p then_ns, rounded up to milliseconds. */
static int milliseconds_until_due(int64_t now_ns, int64_t then_ns)
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
		/* Samples that have arrived come before fillers, however late they are read. */
		result = gz_hid_port_read(
			device->port, device->report, device->report_size,
			milliseconds_until_due(now_ns, due_ns < deadline_ns ? due_ns : deadline_ns),
			&size);
		if (result == GZ_OK)
			result = take_hid_report(device, size, out_sample);
		else if (result == GZ_ERR_TIMEOUT && gz_clock_now_ns() >= due_ns) {
			fill_in_sample(device, out_sample);
			return GZ_OK;
		}
		if (result != GZ_ERR_TIMEOUT)
			return result;
		/* Endless garbage must not hold the caller. */
		now_ns = gz_clock_now_ns();
		if (now_ns >= deadline_ns)
			return GZ_ERR_TIMEOUT;
	}
}
