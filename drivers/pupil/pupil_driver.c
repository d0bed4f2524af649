/**
 * @file
 * A Pupil Core headset through the Network API of Pupil Capture, or another gazed, as its client.
 * The source is Pupil Labs' description of the API and its data formats,
 * docs.pupil-labs.com/core/developer/.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "drivers/device/device.h"
#include "drivers/pupil/pupil_link.h"
#include "drivers/pupil/pupil_message.h"

#define GZ_LOG_MODULE "pupil"

/* Longest waits, ms: create() for the first answer, start() for the clocks, list() and create() for
 * other answers, create() for a status. Chosen: enough for a network with round trips of some ms.
 * If an answer does not come in time, create() fails and is called again. */
enum { CREATE_MS = 150, START_MS = 150, LIST_MS = 100, ASK_MS = 150, STATUS_MS = 500 };

/* Silence after which a warning is logged although requests are answered, ns. Chosen: longer than a
 * scene takes to find its markers again. */
static const int64_t SILENCE_NS = 5 * GZ_NS_PER_S;

/* A sample that is older than the newest one by more than this, ns, is not explained by two eyes
 * that were matched out of order. */
static const int64_t LONG_PAST_NS = GZ_NS_PER_S / 2;

struct pupil_settings {
	char address[GZ_ENDPOINT_SIZE];
	char surface[GZ_NAME_SIZE];
	double confidence;
};

#define AT(field) offsetof(struct pupil_settings, field)

static const struct gz_option pupil_options[] = {
	{ "pupil.address", GZ_OPTION_STRING, AT(address), 0, GZ_ENDPOINT_SIZE,
	  .preset = GZ_CONTROL_TCP_ENDPOINT, .help = "address of Pupil Remote, tcp://HOST:PORT" },
	{ "pupil.surface", GZ_OPTION_STRING, AT(surface), 0, GZ_NAME_SIZE, .preset = "screen",
	  .help = "name of the surface that is the screen; empty: gaze without a surface, which "
		  "with Pupil Core is a position in the picture of the scene camera" },
	{ "pupil.confidence", GZ_OPTION_DOUBLE, AT(confidence), 0, 1, .preset = "0.6",
	  .help = "gaze and eyes with less confidence are invalid" },
};

static const size_t pupil_option_count = sizeof pupil_options / sizeof *pupil_options;

struct pupil_device {
	struct gz_device base;
	struct gz_pupil_link link;
	struct gz_device_info info;
	char surface_topic[GZ_PUPIL_TOPIC_SIZE]; /* empty: gaze without a surface */
	double confidence;
	struct gz_pupil_memory memory;
	struct gz_pupil_entries entries;
	struct gz_pupil_order order;
	struct gz_ratelimit complaints;
	uint64_t jumps;    /* jumps of the link that are already handled */
	int64_t sample_ns; /* arrival of the newest sample, or time of start */
	bool told_silence;
	uint64_t seq;
	uint64_t lost;
	uint64_t malformed[GZ_MALFORMED_COUNT];
};

static struct pupil_device *pupil_device_of(struct gz_device *device)
{
	return (struct pupil_device *)device;
}

static enum gz_result pupil_start(struct gz_device *base)
{
	struct pupil_device *device = pupil_device_of(base);
	const char *surface = device->surface_topic[0] ? device->surface_topic : NULL;
	enum gz_result result = gz_pupil_link_subscribe(&device->link, GZ_TOPIC_GAZE, surface);
	if (result != GZ_OK)
		return result;
	device->sample_ns = gz_clock_now_ns();
	gz_pupil_link_synchronise(&device->link, device->sample_ns + START_MS * GZ_NS_PER_MS);
	return GZ_OK;
}

static void count_pupil_malformed(struct pupil_device *device, enum gz_malformed reason)
{
	device->malformed[reason]++;
	/* Stale messages are common: Pupil matches the two eyes out of order. */
	if (reason != GZ_MALFORMED_STALE)
		gz_warn_limited(device->base.log, &device->complaints,
				"%s sends malformed messages: %s", device->link.address,
				gz_malformed_name(reason));
}

/* Whether a sample is so old that Pupil's clock may have been set back. */
static bool is_long_past(const struct pupil_device *device, int64_t pupil_ns)
{
	int64_t past_ns;
	return __builtin_sub_overflow(device->order.pupil_ns, pupil_ns, &past_ns) ||
	       past_ns > LONG_PAST_NS;
}

/* Set the times on both clocks, the number and the losses of a sample. */
static enum gz_result finish_pupil_sample(struct pupil_device *device, struct gz_pupil_gaze *gaze,
					  int64_t arrival_ns)
{
	struct gz_sample *sample = &gaze->sample;
	bool believed;
	uint32_t missing;
	if (device->jumps != device->link.jumps)
		gz_pupil_order_restart(&device->order);
	device->jumps = device->link.jumps;
	enum gz_result result = gz_pupil_order_step(&device->order, gaze, &missing);
	if (result != GZ_OK) {
		if (is_long_past(device, sample->device_ns))
			gz_pupil_link_doubt_clock(&device->link, arrival_ns);
		return result;
	}
	sample->host_ns =
		gz_pupil_clock_map(&device->link.clock, sample->device_ns, arrival_ns, &believed);
	if (!believed)
		gz_pupil_link_doubt_clock(&device->link, arrival_ns);
	sample->lost_before = missing;
	sample->seq = device->seq++;
	device->lost += missing;
	device->sample_ns = arrival_ns;
	device->told_silence = false;
	return GZ_OK;
}

/* Take the next entry of the newest surface message that is a sample. */
static enum gz_result next_surface_sample(struct pupil_device *device, struct gz_sample *out_sample)
{
	struct gz_pupil_gaze gaze;
	int64_t now_ns = gz_clock_now_ns();
	while (gz_pupil_next_entry(&device->entries, &device->memory, device->confidence, &gaze) ==
	       GZ_OK) {
		if (finish_pupil_sample(device, &gaze, now_ns) == GZ_OK) {
			*out_sample = gaze.sample;
			return GZ_OK;
		}
		count_pupil_malformed(device, GZ_MALFORMED_STALE);
	}
	return GZ_ERR_TIMEOUT;
}

static enum gz_result take_pupil_gaze(struct pupil_device *device, const void *bytes, size_t size,
				      struct gz_sample *out_sample)
{
	struct gz_pupil_gaze gaze;
	enum gz_malformed reason;
	if (gz_pupil_read_gaze(bytes, size, device->confidence, &gaze, &reason) != GZ_OK) {
		count_pupil_malformed(device, reason);
		return GZ_ERR_TIMEOUT;
	}
	if (device->surface_topic[0]) {
		gz_pupil_remember(&device->memory, &gaze);
		return GZ_ERR_TIMEOUT;
	}
	if (finish_pupil_sample(device, &gaze, gz_clock_now_ns()) != GZ_OK) {
		count_pupil_malformed(device, GZ_MALFORMED_STALE);
		return GZ_ERR_TIMEOUT;
	}
	*out_sample = gaze.sample;
	return GZ_OK;
}

static enum gz_result take_pupil_surface(struct pupil_device *device, const void *bytes,
					 size_t size, struct gz_sample *out_sample)
{
	enum gz_malformed reason;
	if (gz_pupil_read_surface(bytes, size, &device->entries, &reason) == GZ_OK)
		return next_surface_sample(device, out_sample);
	count_pupil_malformed(device, reason);
	return GZ_ERR_TIMEOUT;
}

/* Whether the topic is that of the surface, not of one whose name begins with it. */
static bool is_pupil_surface_topic(const struct pupil_device *device, const char *topic,
				   size_t size)
{
	return size == strlen(device->surface_topic) &&
	       memcmp(topic, device->surface_topic, size) == 0;
}

/* Read one message. @retval GZ_ERR_TIMEOUT  it is not a sample */
static enum gz_result take_pupil_message(struct pupil_device *device, zmq_msg_t frames[2],
					 int count, struct gz_sample *out_sample)
{
	const char *topic = zmq_msg_data(&frames[0]);
	size_t topic_size = zmq_msg_size(&frames[0]);
	const void *body = zmq_msg_data(&frames[1]);
	size_t size = zmq_msg_size(&frames[1]);
	if (count != 2) {
		count_pupil_malformed(device, count < 2 ? GZ_MALFORMED_SHORT : GZ_MALFORMED_LONG);
		return GZ_ERR_TIMEOUT;
	}
	if (device->surface_topic[0] && is_pupil_surface_topic(device, topic, topic_size))
		return take_pupil_surface(device, body, size, out_sample);
	if (topic_size >= strlen(GZ_TOPIC_GAZE) &&
	    memcmp(topic, GZ_TOPIC_GAZE, strlen(GZ_TOPIC_GAZE)) == 0)
		return take_pupil_gaze(device, body, size, out_sample);
	return GZ_ERR_TIMEOUT; /* a surface whose name begins with ours */
}

static enum gz_result receive_pupil_message(struct pupil_device *device,
					    struct gz_sample *out_sample)
{
	zmq_msg_t frames[2];
	int count = 0, more = 1;
	zmq_msg_init(&frames[0]);
	zmq_msg_init(&frames[1]);
	while (more) {
		zmq_msg_t *frame = &frames[count > 0];
		if (zmq_msg_recv(frame, device->link.stream, ZMQ_DONTWAIT) < 0)
			break;
		count++;
		more = zmq_msg_more(frame);
	}
	enum gz_result result = GZ_ERR_TIMEOUT;
	if (count > 0)
		result = take_pupil_message(device, frames, count, out_sample);
	zmq_msg_close(&frames[0]);
	zmq_msg_close(&frames[1]);
	return result;
}

static void warn_about_silence(struct pupil_device *device)
{
	if (device->told_silence || gz_clock_now_ns() - device->sample_ns < SILENCE_NS)
		return;
	device->told_silence = true;
	gz_warn(device->base.log, "%s answers, but sends no gaze%s%s; %s", device->link.address,
		device->surface_topic[0] ? " on " : "", device->surface_topic,
		device->surface_topic[0]
			? "calibrate, and define this surface in the Surface Tracker plugin"
			: "check its calibration and its eye cameras");
}

/* Wait for a message that is a sample. This driver neither allocates nor locks; libzmq and the
 * MessagePack library may. */
static enum gz_result pupil_read(struct gz_device *base, int timeout_ms,
				 struct gz_sample *out_sample)
{
	struct pupil_device *device = pupil_device_of(base);
	int64_t deadline_ns = gz_clock_now_ns() + timeout_ms * GZ_NS_PER_MS;
	if (next_surface_sample(device, out_sample) == GZ_OK)
		return GZ_OK;
	for (;;) {
		enum gz_result result = gz_pupil_link_wait(&device->link, deadline_ns);
		if (result == GZ_OK)
			result = receive_pupil_message(device, out_sample);
		if (result == GZ_OK)
			return GZ_OK;
		if (result == GZ_ERR_NO_DEVICE) {
			gz_warn(device->base.log, "%s no longer answers", device->link.address);
			return GZ_ERR_NO_DEVICE;
		}
		/* Endless garbage must not hold the caller. */
		if (gz_clock_now_ns() >= deadline_ns) {
			warn_about_silence(device);
			return GZ_ERR_TIMEOUT;
		}
	}
}

static void pupil_info(const struct gz_device *base, struct gz_device_info *out_info)
{
	*out_info = ((const struct pupil_device *)base)->info;
}

static void pupil_counters(const struct gz_device *base, struct gz_device_counters *out_counters)
{
	const struct pupil_device *device = (const struct pupil_device *)base;
	*out_counters = (struct gz_device_counters) {
		.lost = device->lost,
		.clock = gz_pupil_clock_status(&device->link.clock),
	};
	memcpy(out_counters->malformed, device->malformed, sizeof out_counters->malformed);
}

static void pupil_destroy(struct gz_device *base)
{
	struct pupil_device *device = pupil_device_of(base);
	gz_pupil_link_close(&device->link);
	free(device);
}

static const struct gz_device_ops pupil_ops = {
	.start = pupil_start,
	.read = pupil_read,
	.info = pupil_info,
	.counters = pupil_counters,
	.destroy = pupil_destroy,
};

/* Whether the peer is a gazed: it knows a request that Pupil Remote does not.
 * @retval GZ_ERR_TIMEOUT  no answer */
static enum gz_result ask_whether_gazed(struct gz_pupil_link *link, int timeout_ms,
					bool *out_is_gazed)
{
	char latest[32];
	enum gz_result result =
		gz_pupil_link_ask(link, "LATEST_PORT", timeout_ms, latest, sizeof latest);
	*out_is_gazed = latest[0] >= '0' && latest[0] <= '9';
	return result;
}

/* Find out who the peer is and, if it is another gazed, what it knows about its tracker and
 * display.
 * @retval GZ_ERR_TIMEOUT  it is too busy to answer: what it would say of its display is needed */
static enum gz_result identify_peer(struct pupil_device *device)
{
	struct gz_device_info *info = &device->info;
	struct gz_status status;
	char version[32];
	bool is_gazed;
	snprintf(info->name, sizeof info->name, "pupil");
	enum gz_result result = ask_whether_gazed(&device->link, ASK_MS, &is_gazed);
	if (result == GZ_OK && !is_gazed) {
		if (gz_pupil_link_ask(&device->link, "v", ASK_MS, version, sizeof version) == GZ_OK)
			snprintf(info->name, sizeof info->name, "Pupil Capture %s", version);
		return GZ_OK;
	}
	if (result == GZ_OK)
		result = gz_pupil_link_status(&device->link, STATUS_MS, &status);
	if (result != GZ_OK)
		return result == GZ_ERR_TIMEOUT ? result : GZ_OK;
	if (status.tracker.name[0])
		memcpy(info->name, status.tracker.name, sizeof info->name);
	memcpy(info->serial, status.tracker.serial, sizeof info->serial);
	info->rate_hz = status.rate_hz_nominal;
	info->has_display = gz_display_valid(&status.display);
	if (info->has_display)
		info->display = status.display;
	return GZ_OK;
}

static enum gz_result pupil_create(const void *settings, const struct gz_driver_host *host,
				   struct gz_device **out_device)
{
	const struct pupil_settings *wanted = settings;
	if (!gz_pupil_address_valid(wanted->address)) {
		gz_err(host->log, "pupil.address: \"%s\" is not of the form tcp://HOST:PORT",
		       wanted->address);
		return GZ_ERR_INVAL;
	}
	struct pupil_device *device = calloc(1, sizeof *device);
	if (!device)
		return GZ_ERR_NO_MEM;
	device->base = (struct gz_device) { .ops = &pupil_ops, .log = host->log };
	device->confidence = wanted->confidence;
	if (wanted->surface[0])
		snprintf(device->surface_topic, sizeof device->surface_topic,
			 GZ_TOPIC_SURFACES "%s", wanted->surface);
	enum gz_result result =
		gz_pupil_link_open(&device->link, wanted->address, CREATE_MS, host->log);
	if (result == GZ_OK && identify_peer(device) != GZ_OK) {
		gz_err(host->log, "%s does not answer in time who it is", wanted->address);
		result = GZ_ERR_NO_DEVICE;
	}
	if (result != GZ_OK) {
		pupil_destroy(&device->base);
		return result;
	}
	*out_device = &device->base;
	return GZ_OK;
}

/* Lists Pupil Capture only. A gazed is left out, because it may be our own daemon at the preset
 * address. */
static size_t pupil_list(const void *settings, const struct gz_driver_host *host,
			 struct gz_device_entry *out_entries)
{
	const struct pupil_settings *wanted = settings;
	struct gz_pupil_link link;
	char version[32];
	(void)host;
	if (!gz_pupil_address_valid(wanted->address) ||
	    gz_pupil_link_open(&link, wanted->address, LIST_MS, NULL) != GZ_OK)
		return 0;
	bool is_gazed;
	bool is_pupil = ask_whether_gazed(&link, LIST_MS, &is_gazed) == GZ_OK && !is_gazed &&
			gz_pupil_link_ask(&link, "v", LIST_MS, version, sizeof version) == GZ_OK;
	gz_pupil_link_close(&link);
	if (!is_pupil)
		return 0;
	out_entries[0] = (struct gz_device_entry) { .usable = true };
	snprintf(out_entries[0].name, sizeof out_entries[0].name, "Pupil Capture %s", version);
	snprintf(out_entries[0].place, sizeof out_entries[0].place, "%.*s", GZ_NAME_SIZE - 1,
		 wanted->address);
	return 1;
}

_Static_assert(sizeof(struct pupil_settings) <= GZ_DRIVER_SETTINGS_SIZE, "settings fit");

const struct gz_driver gz_driver_pupil = {
	.name = "pupil",
	.help = "Pupil Core through Pupil Capture, or another gazed, over the network",
	.options = pupil_options,
	.option_count = &pupil_option_count,
	.settings_size = sizeof(struct pupil_settings),
	.create = pupil_create,
	.list = pupil_list,
};
