/**
 * @file
 * A simulated viewer in front of a simulated tracker (sim/tracker.h), delivered in real time or as
 * fast as it is read.
 */
#include <stdlib.h>
#include <sys/prctl.h>
#include <sys/stat.h>

#include "drivers/device/clock_model.h"
#include "drivers/device/device.h"
#include "drivers/pointer/pointer_driver.h"
#include "sim/tracker.h"

#define GZ_LOG_MODULE "sim"

/* A reader that was held up for longer than this does not get what it missed: the buffers of a real
 * tracker end somewhere, too. Chosen: above any scheduling delay. */
static const int64_t BACKLOG_NS = 2 * GZ_NS_PER_S;

/* If no target is reported for this long, the viewer looks where it likes again. Chosen: equal to
 * the preset of pointer.timeout_ms. */
static const int64_t FOLLOW_PATIENCE_NS = GZ_NS_PER_S;

/* Interval of asking whether the picture has changed. Chosen: no longer than two fixations. */
static const int64_t PICTURE_INTERVAL_NS = GZ_NS_PER_S / 2;

struct sim_device {
	struct gz_device base;
	struct gz_sim_params params;
	struct gz_sim_tracker *tracker;
	struct gz_clock_model clock;
	struct gz_sim_sample next; /* not delivered yet; its times count from start_ns */
	int64_t start_ns;
	uint64_t seq;
	uint64_t lost;
	struct gz_pointer_feed *feed; /* target reports, borrowed; may be NULL */
	int64_t told_ns;              /* host time of the newest target; 0: none, or forgotten */
	int64_t picture_asked_ns;     /* host time; 0: not yet */
	struct timespec picture_time; /* when the picture was changed, as last seen */
	uint32_t skipped; /* lost since the last delivered sample, beyond next's own losses */
};

static struct sim_device *sim_device_of(struct gz_device *device)
{
	return (struct sim_device *)device;
}

static enum gz_result sim_start(struct gz_device *device)
{
	struct sim_device *sim = sim_device_of(device);
	/* The default slack of 50 us would show as jitter in the delivery of every sample. */
	if (prctl(PR_SET_TIMERSLACK, 1) != 0)
		gz_debug(device->log,
			 "the timer slack cannot be reduced; samples arrive less evenly");
	sim->start_ns = gz_clock_now_ns();
	gz_sim_tracker_next(sim->tracker, &sim->next);
	return GZ_OK;
}

static uint32_t add_saturated(uint32_t a, uint32_t b)
{
	return a > UINT32_MAX - b ? UINT32_MAX : a + b;
}

/* Skip the samples that a reader has missed for too long. */
static void skip_sim_backlog(struct sim_device *sim, int64_t now_ns)
{
	while (now_ns - (sim->start_ns + sim->next.arrival_ns) > BACKLOG_NS) {
		sim->skipped = add_saturated(sim->skipped, sim->next.sample.lost_before);
		sim->skipped = add_saturated(sim->skipped, 1);
		gz_sim_tracker_next(sim->tracker, &sim->next);
	}
}

/* Host time as any driver estimates it: from the device clock and the arrivals. The simulator knows
 * the constant delay, as the maker of a tracker does. */
static int64_t fitted_host_ns(struct sim_device *sim, int64_t arrival_ns)
{
	bool jumped;
	int64_t host_ns =
		gz_clock_model_step(&sim->clock, sim->next.sample.device_ns, arrival_ns, &jumped);
	if (jumped)
		gz_warn(sim->base.log, "the device clock jumped; the clock fit starts again");
	return host_ns - (int64_t)(sim->params.latency_ms * (double)GZ_NS_PER_MS);
}

static void deliver_simulated(struct sim_device *sim, struct gz_sample *out_sample)
{
	int64_t arrival_ns = sim->start_ns + sim->next.arrival_ns;
	*out_sample = sim->next.sample;
	out_sample->host_ns = sim->start_ns + sim->next.sample.host_ns;
	if (sim->params.clock_skew_ppm != 0)
		out_sample->host_ns = fitted_host_ns(sim, arrival_ns);
	out_sample->seq = sim->seq++;
	out_sample->lost_before = add_saturated(sim->next.sample.lost_before, sim->skipped);
	sim->lost += out_sample->lost_before;
	sim->skipped = 0;
	gz_sim_tracker_next(sim->tracker, &sim->next);
}

/* A program that shows targets to the simulated viewer reports their positions, as a viewer reports
 * its pointer. */
static void follow_shown_targets(struct sim_device *sim)
{
	struct gz_pointer_report report;
	int64_t now_ns = sim->feed ? gz_clock_now_ns() : 0;
	while (sim->feed && gz_pointer_feed_take(sim->feed, now_ns, &report)) {
		gz_sim_tracker_follow(sim->tracker, report.known ? &report.point : NULL);
		sim->told_ns = report.known ? now_ns : 0;
	}
	if (sim->told_ns == 0 || now_ns - sim->told_ns < FOLLOW_PATIENCE_NS)
		return;
	gz_sim_tracker_follow(sim->tracker, NULL);
	sim->told_ns = 0;
}

/* When the picture was changed last; zeros: it cannot be told. */
static struct timespec picture_time(const struct sim_device *sim)
{
	struct stat status;
	if (!sim->params.picture[0] || stat(sim->params.picture, &status) != 0)
		return (struct timespec) { 0 };
	return status.st_mtim;
}

/* The program that shows a picture may replace the file. Reading it takes some milliseconds, by
 * which samples are late. */
static void follow_picture(struct sim_device *sim, int64_t now_ns)
{
	if (!sim->params.picture[0] || now_ns - sim->picture_asked_ns < PICTURE_INTERVAL_NS)
		return;
	sim->picture_asked_ns = now_ns;
	const struct timespec time = picture_time(sim);
	if ((time.tv_sec == 0 && time.tv_nsec == 0) ||
	    (time.tv_sec == sim->picture_time.tv_sec && time.tv_nsec == sim->picture_time.tv_nsec))
		return;
	sim->picture_time = time;
	struct gz_targets targets;
	if (gz_targets_from_png(sim->params.picture, sim->base.log, &targets) == GZ_OK)
		gz_sim_tracker_attract(sim->tracker, &targets);
}

static enum gz_result sim_read(struct gz_device *device, int timeout_ms,
			       struct gz_sample *out_sample)
{
	struct sim_device *sim = sim_device_of(device);
	if (sim->params.realtime) {
		int64_t now_ns = gz_clock_now_ns();
		follow_picture(sim, now_ns);
		skip_sim_backlog(sim, now_ns);
		int64_t deadline_ns = now_ns + timeout_ms * GZ_NS_PER_MS;
		int64_t due_ns = sim->start_ns + sim->next.arrival_ns;
		if (due_ns > deadline_ns) {
			gz_clock_sleep_until_ns(deadline_ns);
			return GZ_ERR_TIMEOUT;
		}
		gz_clock_sleep_until_ns(due_ns);
	}
	follow_shown_targets(sim);
	deliver_simulated(sim, out_sample);
	return GZ_OK;
}

static void sim_info(const struct gz_device *device, struct gz_device_info *out_info)
{
	const struct sim_device *sim = (const struct sim_device *)device;
	*out_info = (struct gz_device_info) {
		.name = "sim",
		.rate_hz = sim->params.rate_hz,
		.on_demand = !sim->params.realtime,
		.has_display = true,
		.display = gz_sim_tracker_display(sim->tracker),
	};
}

static void sim_counters(const struct gz_device *device, struct gz_device_counters *out_counters)
{
	const struct sim_device *sim = (const struct sim_device *)device;
	*out_counters = (struct gz_device_counters) {
		.lost = sim->lost,
		.clock = gz_clock_model_status(&sim->clock, GZ_CLOCK_DECLARED),
	};
	if (sim->params.clock_skew_ppm == 0) {
		out_counters->clock = gz_sim_tracker_clock(sim->tracker);
		out_counters->clock.offset_ns += sim->start_ns;
	}
}

static void sim_destroy(struct gz_device *device)
{
	struct sim_device *sim = sim_device_of(device);
	gz_sim_tracker_destroy(&sim->tracker);
	free(sim);
}

static const struct gz_device_ops sim_ops = {
	.start = sim_start,
	.read = sim_read,
	.info = sim_info,
	.counters = sim_counters,
	.destroy = sim_destroy,
};

static enum gz_result sim_create(const void *settings, const struct gz_driver_host *host,
				 struct gz_device **out_device)
{
	const struct gz_log *log = host->log;
	struct sim_device *sim = calloc(1, sizeof *sim);
	if (!sim)
		return GZ_ERR_NO_MEM;
	sim->base = (struct gz_device) { .ops = &sim_ops, .log = log };
	sim->feed = host->pointer;
	sim->params = *(const struct gz_sim_params *)settings;
	sim->picture_time = picture_time(sim);
	enum gz_result result = gz_sim_tracker_create(&sim->params, 0, log, &sim->tracker);
	if (result != GZ_OK) {
		sim_destroy(&sim->base);
		return result;
	}
	*out_device = &sim->base;
	return GZ_OK;
}

_Static_assert(sizeof(struct gz_sim_params) <= GZ_DRIVER_SETTINGS_SIZE, "settings fit");

const struct gz_driver gz_driver_sim = {
	.name = "sim",
	.help = "a simulated viewer; needs no device",
	.options = gz_sim_options,
	.option_count = &gz_sim_option_count,
	.settings_size = sizeof(struct gz_sim_params),
	.create = sim_create,
};
