#include "drivers/pointer/pointer_driver.h"

#include <math.h>
#include <stdalign.h>
#include <stdatomic.h>
#include <stdlib.h>

#include "base/clock.h"
#include "drivers/device/device.h"

#define GZ_LOG_MODULE "pointer"

/* Distance that keeps the two counters in different cache lines, bytes; threads that share a line
 * slow each other down. */
enum { CACHE_LINE = 64 };

struct gz_pointer_feed {
	alignas(CACHE_LINE) atomic_size_t put;   /* reports written */
	alignas(CACHE_LINE) atomic_size_t taken; /* reports read */
	struct gz_pointer_report reports[GZ_POINTER_FEED_SIZE];
};

enum gz_result gz_pointer_feed_create(struct gz_pointer_feed **out_feed)
{
	struct gz_pointer_feed *feed = aligned_alloc(CACHE_LINE, sizeof *feed);
	if (!feed)
		return GZ_ERR_NO_MEM;
	atomic_init(&feed->put, 0);
	atomic_init(&feed->taken, 0);
	*out_feed = feed;
	return GZ_OK;
}

bool gz_pointer_feed_put(struct gz_pointer_feed *feed, const struct gz_pointer_report *report)
{
	size_t put = atomic_load_explicit(&feed->put, memory_order_relaxed);
	size_t taken = atomic_load_explicit(&feed->taken, memory_order_acquire);
	if (put - taken == GZ_POINTER_FEED_SIZE)
		return false;
	feed->reports[put % GZ_POINTER_FEED_SIZE] = *report;
	atomic_store_explicit(&feed->put, put + 1, memory_order_release);
	return true;
}

bool gz_pointer_feed_take(struct gz_pointer_feed *feed, int64_t until_ns,
			  struct gz_pointer_report *out_report)
{
	size_t taken = atomic_load_explicit(&feed->taken, memory_order_relaxed);
	size_t put = atomic_load_explicit(&feed->put, memory_order_acquire);
	const struct gz_pointer_report *oldest = &feed->reports[taken % GZ_POINTER_FEED_SIZE];
	if (put == taken || oldest->host_ns > until_ns)
		return false;
	*out_report = *oldest;
	atomic_store_explicit(&feed->taken, taken + 1, memory_order_release);
	return true;
}

void gz_pointer_feed_destroy(struct gz_pointer_feed **feed)
{
	if (!feed || !*feed)
		return;
	free(*feed);
	*feed = NULL;
}

/* A reader that is later than this loses the samples in between. One that is less late still gets
 * them, from the reports in the feed. Chosen: the time that the feed can bridge. */
#define LATE_NS (200 * GZ_NS_PER_MS)

struct pointer_settings {
	double rate_hz;
	int timeout_ms;
};

#define AT(field) offsetof(struct pointer_settings, field)

static const struct gz_option pointer_options[] = {
	{ "pointer.rate_hz", GZ_OPTION_DOUBLE, AT(rate_hz), 1, 2000, .preset = "60",
	  .help = "samples a second, Hz; more than the viewer's frame rate only repeats "
		  "positions" },
	{ "pointer.timeout_ms", GZ_OPTION_INT, AT(timeout_ms), 0, 3600000, .preset = "1000",
	  .help = "how long a position that is not reported again stays valid, ms; 0 for ever" },
};

static const size_t pointer_option_count = sizeof pointer_options / sizeof *pointer_options;

struct pointer_device {
	struct gz_device base;
	struct pointer_settings settings;
	struct gz_pointer_feed *feed; /* borrowed from the host */
	int64_t begin_ns;             /* host time of sample 0 */
	int64_t next;                 /* number of the next sample */
	struct gz_pointer_report newest;
	uint64_t seq;
	uint64_t lost;
	uint32_t lost_before; /* lost just before the next sample */
};

static struct pointer_device *pointer_device_of(struct gz_device *device)
{
	return (struct pointer_device *)device;
}

/* Host time at which a sample is due. Computed from its number, so that rounding errors do not add
 * up. */
static int64_t sample_due_ns(const struct pointer_device *device, int64_t number)
{
	return device->begin_ns + llround((double)number * 1e9 / device->settings.rate_hz);
}

static enum gz_result pointer_start(struct gz_device *base)
{
	struct pointer_device *device = pointer_device_of(base);
	device->begin_ns = gz_clock_now_ns();
	return GZ_OK;
}

/* Skip the samples that a late reader can no longer get. */
static void skip_missed_samples(struct pointer_device *device, int64_t now_ns)
{
	int64_t late_ns = now_ns - sample_due_ns(device, device->next);
	if (late_ns <= LATE_NS)
		return;
	double samples = floor((double)late_ns * 1e-9 * device->settings.rate_hz);
	double most = UINT32_MAX - device->lost_before;
	uint32_t skipped = (uint32_t)fmin(samples, most);
	device->next += skipped;
	device->lost_before += skipped;
}

static void read_pointer_reports(struct pointer_device *device, int64_t until_ns)
{
	struct gz_pointer_report report;
	while (gz_pointer_feed_take(device->feed, until_ns, &report))
		device->newest = report;
}

static bool is_pointer_stale(const struct pointer_device *device, int64_t now_ns)
{
	return device->settings.timeout_ms > 0 &&
	       now_ns - device->newest.host_ns > device->settings.timeout_ms * GZ_NS_PER_MS;
}

static enum gz_result pointer_read(struct gz_device *base, int timeout_ms,
				   struct gz_sample *out_sample)
{
	struct pointer_device *device = pointer_device_of(base);
	int64_t now_ns = gz_clock_now_ns();
	int64_t deadline_ns = now_ns + timeout_ms * GZ_NS_PER_MS;
	skip_missed_samples(device, now_ns);
	int64_t due_ns = sample_due_ns(device, device->next);
	struct gz_sample sample = gz_sample_unmeasured();
	if (due_ns > deadline_ns) {
		gz_clock_sleep_until_ns(deadline_ns);
		return GZ_ERR_TIMEOUT;
	}
	gz_clock_sleep_until_ns(due_ns);
	read_pointer_reports(device, due_ns);
	sample.host_ns = due_ns;
	sample.valid = device->newest.known && !is_pointer_stale(device, due_ns);
	if (sample.valid)
		sample.point = device->newest.point;
	sample.lost_before = device->lost_before;
	device->lost += device->lost_before;
	device->lost_before = 0;
	sample.seq = device->seq++;
	device->next++;
	*out_sample = sample;
	return GZ_OK;
}

static void pointer_info(const struct gz_device *base, struct gz_device_info *out_info)
{
	const struct pointer_device *device = (const struct pointer_device *)base;
	*out_info =
		(struct gz_device_info) { .name = "pointer", .rate_hz = device->settings.rate_hz };
}

static void pointer_counters(const struct gz_device *base, struct gz_device_counters *out_counters)
{
	const struct pointer_device *device = (const struct pointer_device *)base;
	*out_counters = (struct gz_device_counters) { .lost = device->lost };
}

static void pointer_destroy(struct gz_device *base)
{
	free(pointer_device_of(base));
}

static const struct gz_device_ops pointer_ops = {
	.start = pointer_start,
	.read = pointer_read,
	.info = pointer_info,
	.counters = pointer_counters,
	.destroy = pointer_destroy,
};

static enum gz_result pointer_create(const void *settings, const struct gz_driver_host *host,
				     struct gz_device **out_device)
{
	if (!host->pointer) {
		gz_err(host->log, "nobody reports a pointer to this program; the driver pointer "
				  "works only in gazed");
		return GZ_ERR_UNSUPPORTED;
	}
	struct pointer_device *device = calloc(1, sizeof *device);
	if (!device)
		return GZ_ERR_NO_MEM;
	device->base = (struct gz_device) { .ops = &pointer_ops, .log = host->log };
	device->settings = *(const struct pointer_settings *)settings;
	device->feed = host->pointer;
	device->newest = (struct gz_pointer_report) { .known = false };
	*out_device = &device->base;
	return GZ_OK;
}

_Static_assert(sizeof(struct pointer_settings) <= GZ_DRIVER_SETTINGS_SIZE, "settings fit");

const struct gz_driver gz_driver_pointer = {
	.name = "pointer",
	.help = "the mouse of a viewer (gazeview --gaze pointer) in place of an eye",
	.options = pointer_options,
	.option_count = &pointer_option_count,
	.settings_size = sizeof(struct pointer_settings),
	.create = pointer_create,
};
