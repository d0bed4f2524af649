#include "drivers/template/template_driver.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "drivers/clock_model.h"
#include "drivers/template/template_protocol.h"

#define GZ_LOG_MODULE "template"

/* One line about bad reports a second is enough to see that something is wrong. */
#define COMPLAINT_NS GZ_NS_PER_S

struct template_settings {
	char path[GZ_PATH_SIZE];
	double rate_hz;
};

#define AT(field) offsetof(struct template_settings, field)

/* Each setting once: presets, the configuration file, the command line and --help come from here.
 */
static const struct gz_option template_options[] = {
	{ "template.path", GZ_OPTION_STRING, AT(path), 0, GZ_PATH_SIZE, 0, NULL, "",
	  "file, FIFO or character device to read reports from" },
	{ "template.rate_hz", GZ_OPTION_DOUBLE, AT(rate_hz), 0, 2000, 0, NULL, "0",
	  "its nominal rate, Hz; 0 where it is not known" },
};

static const size_t template_option_count = sizeof template_options / sizeof *template_options;

/* The common head comes first, so that a struct gz_device * is a struct template_device *. */
struct template_device {
	struct gz_device base;
	double rate_hz;
	int fd; /* -1 while closed */
	unsigned char bytes[GZ_TEMPLATE_REPORT_SIZE];
	size_t filled; /* bytes of an unfinished report */
	struct gz_clock_model clock;
	struct gz_ratelimit complaints;
	int64_t clock_us;
	uint32_t counter; /* of the newest report */
	uint64_t seq;
	uint64_t lost;
	uint64_t malformed[GZ_MALFORMED_COUNT];
};

static struct template_device *of(struct gz_device *device)
{
	return (struct template_device *)device;
}

/* Here a real device is told to stream. This one streams since it was opened. */
static enum gz_result template_start(struct gz_device *device)
{
	(void)device;
	return GZ_OK;
}

/* Wait until something can be read. Returns GZ_ERR_TIMEOUT at @p deadline_ns. */
static enum gz_result wait_readable(struct template_device *device, int64_t deadline_ns)
{
	int64_t left_ns = deadline_ns - gz_clock_now_ns();
	if (left_ns < 0)
		left_ns = 0;
	struct pollfd poll_fd = { .fd = device->fd, .events = POLLIN };
	struct timespec timeout = { .tv_sec = (time_t)(left_ns / GZ_NS_PER_S),
				    .tv_nsec = (long)(left_ns % GZ_NS_PER_S) };
	int ready = ppoll(&poll_fd, 1, &timeout, NULL);
	if (ready < 0 && errno != EINTR)
		return GZ_ERR_NO_DEVICE;
	return ready > 0 ? GZ_OK : GZ_ERR_TIMEOUT;
}

/* Take in what is there. A device that has gone reads as an end or an error. */
static enum gz_result fill(struct template_device *device)
{
	ssize_t n = read(device->fd, device->bytes + device->filled,
			 sizeof device->bytes - device->filled);
	if (n > 0) {
		device->filled += (size_t)n;
		return GZ_OK;
	}
	if (n < 0 && (errno == EAGAIN || errno == EINTR))
		return GZ_OK;
	gz_warn(device->base.log, "the device has gone: %s",
		n == 0 ? "end of its reports" : strerror(errno));
	return GZ_ERR_NO_DEVICE;
}

/* After bytes that are no report: go on at the next place where one may begin. */
static void resynchronise(struct template_device *device)
{
	uint64_t held_back;
	device->malformed[GZ_MALFORMED_SYNTAX]++;
	if (gz_ratelimit_pass(&device->complaints, gz_clock_now_ns(), COMPLAINT_NS, &held_back))
		gz_warn(device->base.log,
			"device bug: bytes that are no report (%llu more times since last told)",
			(unsigned long long)held_back);
	const unsigned char *next = memchr(device->bytes + 1, 'G', sizeof device->bytes - 1);
	device->filled = next ? (size_t)(device->bytes + sizeof device->bytes - next) : 0;
	if (next)
		memmove(device->bytes, next, device->filled);
}

/* Numbers of a report to a sample: units and frames as protocol/gaze.h has them, times on both
 * clocks, and nothing smoothed or left out: that is the pipeline's. */
static void to_sample(struct template_device *device, const struct gz_template_report *report,
		      struct gz_sample *out_sample)
{
	bool jumped;
	bool first = device->seq == 0;
	device->clock_us = gz_clock_unwrap32(device->clock_us, report->clock_us);
	struct gz_sample sample = gz_sample_unmeasured();
	sample.device_ns = device->clock_us * GZ_NS_PER_US;
	sample.host_ns =
		gz_clock_model_step(&device->clock, sample.device_ns, gz_clock_now_ns(), &jumped);
	if (jumped)
		gz_warn(device->base.log, "the device's clock jumped; its fit begins again");
	for (int eye = 0; eye < GZ_EYE_COUNT; eye++) {
		sample.eye[eye].valid = report->found[eye];
		if (report->found[eye])
			sample.eye[eye].point = report->point[eye];
	}
	/* A counter that runs backwards is a device that began anew: nothing is known to be lost.
	 */
	uint32_t ahead = report->counter - device->counter - 1;
	sample.lost_before = first || ahead > INT32_MAX ? 0 : ahead;
	sample.seq = device->seq++;
	device->counter = report->counter;
	device->lost += sample.lost_before;
	*out_sample = sample;
}

/* Read until a report is whole or time is up. No allocation, no lock. */
static enum gz_result template_read(struct gz_device *base, int timeout_ms,
				    struct gz_sample *out_sample)
{
	struct template_device *device = of(base);
	int64_t deadline_ns = gz_clock_now_ns() + timeout_ms * GZ_NS_PER_MS;
	for (;;) {
		enum gz_result result = wait_readable(device, deadline_ns);
		if (result == GZ_OK)
			result = fill(device);
		if (result != GZ_OK)
			return result;
		if (device->filled < sizeof device->bytes)
			continue;
		struct gz_template_report report;
		if (gz_template_parse(device->bytes, device->filled, &report) == GZ_OK) {
			device->filled = 0;
			to_sample(device, &report, out_sample);
			return GZ_OK;
		}
		resynchronise(device);
		/* Garbage without end must not hold the caller. */
		if (gz_clock_now_ns() >= deadline_ns)
			return GZ_ERR_TIMEOUT;
	}
}

static void template_info(const struct gz_device *base, struct gz_device_info *out_info)
{
	const struct template_device *device = (const struct template_device *)base;
	*out_info = (struct gz_device_info) { .name = "template", .rate_hz = device->rate_hz };
}

static void template_counters(const struct gz_device *base, struct gz_device_counters *out_counters)
{
	const struct template_device *device = (const struct template_device *)base;
	*out_counters = (struct gz_device_counters) {
		.lost = device->lost,
		.clock = gz_clock_model_status(&device->clock, GZ_CLOCK_DECLARED),
	};
	memcpy(out_counters->malformed, device->malformed, sizeof out_counters->malformed);
}

/* Also right for a device that create() gave up half-way. */
static void template_destroy(struct gz_device *base)
{
	struct template_device *device = of(base);
	if (device->fd >= 0)
		close(device->fd);
	free(device);
}

static const struct gz_device_ops template_ops = {
	.start = template_start,
	.read = template_read,
	.info = template_info,
	.counters = template_counters,
	.destroy = template_destroy,
};

static enum gz_result refuse_path(const char *path, const struct gz_log *log)
{
	int error = errno;
	gz_err(log, "cannot open %s: %s; check --template.path", path, strerror(error));
	switch (error) {
	case EACCES:
	case EPERM:
		return GZ_ERR_ACCESS;
	default:
		return GZ_ERR_NO_DEVICE;
	}
}

static enum gz_result template_create(const void *settings, const struct gz_driver_host *host,
				      struct gz_device **out_device)
{
	const struct gz_log *log = host->log;
	const struct template_settings *wanted = settings;
	if (!wanted->path[0]) {
		gz_err(log, "no device named; name one with --template.path PATH");
		return GZ_ERR_INVAL;
	}
	struct template_device *device = calloc(1, sizeof *device);
	if (!device)
		return GZ_ERR_NO_MEM;
	device->base = (struct gz_device) { .ops = &template_ops, .log = log };
	device->rate_hz = wanted->rate_hz;
	device->fd = open(wanted->path, O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
	if (device->fd < 0) {
		enum gz_result result = refuse_path(wanted->path, log);
		template_destroy(&device->base);
		return result;
	}
	*out_device = &device->base;
	return GZ_OK;
}

_Static_assert(sizeof(struct template_settings) <= GZ_DRIVER_SETTINGS_SIZE, "settings fit");

const struct gz_driver gz_driver_template = {
	.name = "template",
	.help = "fixed reports from a file or device; the example of how to write a driver",
	.options = template_options,
	.option_count = &template_option_count,
	.settings_size = sizeof(struct template_settings),
	.create = template_create,
};
