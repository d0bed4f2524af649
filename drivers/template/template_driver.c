/**
 * @file
 * The driver to start a new one from. It reads fixed reports (template_protocol.h) from a file, a
 * FIFO or a character device. It is a real driver of the table, run by the conformance and daemon
 * tests. docs/adding-a-tracker.md describes what to change.
 */
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "drivers/device/clock_model.h"
#include "drivers/device/device.h"
#include "drivers/template/template_protocol.h"

#define GZ_LOG_MODULE "template"

struct template_settings {
	char path[GZ_PATH_SIZE];
	double rate_hz;
};

#define AT(field) offsetof(struct template_settings, field)

/* One row a setting: defaults, configuration file, command line and --help are made from it. */
static const struct gz_option template_options[] = {
	{ "template.path", GZ_OPTION_STRING, AT(path), 0, GZ_PATH_SIZE, .preset = "",
	  .help = "file, FIFO or character device to read reports from" },
	{ "template.rate_hz", GZ_OPTION_DOUBLE, AT(rate_hz), 0, 2000, .preset = "0",
	  .help = "nominal sample rate of the device, Hz; 0 if it is not known" },
};

static const size_t template_option_count = sizeof template_options / sizeof *template_options;

/* The common head comes first, so that a struct gz_device * also points to the whole device. */
struct template_device {
	struct gz_device base;
	double rate_hz;
	int fd; /* -1 while closed */
	unsigned char bytes[GZ_TEMPLATE_REPORT_SIZE];
	size_t filled; /* bytes of an unfinished report */
	struct gz_clock_model clock;
	struct gz_ratelimit complaints;
	int64_t clock_us; /* unwrapped */
	uint32_t counter; /* of the newest report */
	uint64_t seq;
	uint64_t lost;
	uint64_t malformed[GZ_MALFORMED_COUNT];
};

static struct template_device *template_device_of(struct gz_device *device)
{
	return (struct template_device *)device;
}

/* A real device is told to stream here. This one streams from the moment it is opened. */
static enum gz_result template_start(struct gz_device *device)
{
	(void)device;
	return GZ_OK;
}

/* Read the bytes that have arrived. A device that is gone reads as an end or an error. */
static enum gz_result read_template_bytes(struct template_device *device)
{
	ssize_t n = read(device->fd, device->bytes + device->filled,
			 sizeof device->bytes - device->filled);
	if (n > 0) {
		device->filled += (size_t)n;
		return GZ_OK;
	}
	if (n < 0 && (errno == EAGAIN || errno == EINTR))
		return GZ_OK;
	gz_warn(device->base.log, "the device is gone: %s",
		n == 0 ? "its reports have ended" : strerror(errno));
	return GZ_ERR_NO_DEVICE;
}

/* Skip bytes that are not a report, up to the next place where one may begin. */
static void resynchronise_reports(struct template_device *device)
{
	device->malformed[GZ_MALFORMED_SYNTAX]++;
	gz_warn_limited(device->base.log, &device->complaints,
			"device bug: %zu bytes are not a report; searching for the next one",
			device->filled);
	const unsigned char *next = memchr(device->bytes + 1, 'G', sizeof device->bytes - 1);
	device->filled = next ? (size_t)(device->bytes + sizeof device->bytes - next) : 0;
	if (next)
		memmove(device->bytes, next, device->filled);
}

/* Turn a report into a sample: units and frames of protocol/gaze.h, times on both clocks. Do not
 * smooth and do not leave anything out: that is the pipeline's task. */
static void template_report_to_sample(struct template_device *device,
				      const struct gz_template_report *report,
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
		gz_warn(device->base.log, "the device clock jumped; the clock fit starts again");
	for (int eye = 0; eye < GZ_EYE_COUNT; eye++) {
		sample.eye[eye].valid = report->found[eye];
		if (report->found[eye])
			sample.eye[eye].point = report->point[eye];
	}
	/* If the counter runs backwards, the device has restarted, and nothing counts as lost. */
	uint32_t ahead = report->counter - device->counter - 1;
	sample.lost_before = first || ahead > INT32_MAX ? 0 : ahead;
	sample.seq = device->seq++;
	device->counter = report->counter;
	device->lost += sample.lost_before;
	*out_sample = sample;
}

/* Read until a report is complete or the time is up. No allocation, no lock. */
static enum gz_result template_read(struct gz_device *base, int timeout_ms,
				    struct gz_sample *out_sample)
{
	struct template_device *device = template_device_of(base);
	int64_t deadline_ns = gz_clock_now_ns() + timeout_ms * GZ_NS_PER_MS;
	for (;;) {
		enum gz_result result = gz_device_poll(device->fd, POLLIN, deadline_ns);
		if (result == GZ_OK)
			result = read_template_bytes(device);
		if (result != GZ_OK)
			return result;
		if (device->filled < sizeof device->bytes)
			continue;
		struct gz_template_report report;
		if (gz_template_parse(device->bytes, device->filled, &report) == GZ_OK) {
			device->filled = 0;
			template_report_to_sample(device, &report, out_sample);
			return GZ_OK;
		}
		resynchronise_reports(device);
		/* Endless garbage must not hold the caller. */
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

/* Also works on a device that create() could not finish. */
static void template_destroy(struct gz_device *base)
{
	struct template_device *device = template_device_of(base);
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

static enum gz_result refuse_template_path(const char *path, const struct gz_log *log)
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
		gz_err(log, "no device given; name one with --template.path PATH");
		return GZ_ERR_INVAL;
	}
	struct template_device *device = calloc(1, sizeof *device);
	if (!device)
		return GZ_ERR_NO_MEM;
	device->base = (struct gz_device) { .ops = &template_ops, .log = log };
	device->rate_hz = wanted->rate_hz;
	device->fd = open(wanted->path, O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
	if (device->fd < 0) {
		enum gz_result result = refuse_template_path(wanted->path, log);
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
