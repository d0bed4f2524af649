/**
 * @file
 * Gazepoint GP3 and GP3 HD, through the server of Gazepoint Control (TCP, port 4242), on this
 * machine or another one. gazepoint_protocol.h describes its language.
 *
 * A server that closes the connection, or sends nothing for GZ_GAZEPOINT_SILENCE_MS, counts as an
 * unplugged device: the daemon closes it and searches for it again, with growing pauses.
 */
#include <errno.h>
#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "drivers/device/clock_model.h"
#include "drivers/device/clock_ticks.h"
#include "drivers/device/device.h"
#include "drivers/gazepoint/gazepoint_link.h"
#include "drivers/gazepoint/gazepoint_protocol.h"

#define GZ_LOG_MODULE "gazepoint"

/* Width of TIME_TICK, a signed 64-bit integer. */
enum { TICK_BITS = 64 };

/* Requests before the stream. The frequency comes last: once it is answered, all are. */
#define QUESTIONS                        \
	"<GET ID=\"PRODUCT_ID\" />\r\n"  \
	"<GET ID=\"SERIAL_ID\" />\r\n"   \
	"<GET ID=\"SCREEN_SIZE\" />\r\n" \
	"<GET ID=\"TIME_TICK_FREQUENCY\" />\r\n"

#define ENABLE(what) "<SET ID=\"ENABLE_SEND_" what "\" STATE=\"1\" />\r\n"

/* Older versions refuse fields that they do not know and send the others. The data come last. */
static const char enable_stream[] = ENABLE("COUNTER") ENABLE("TIME") ENABLE("TIME_TICK")
	ENABLE("POG_LEFT") ENABLE("POG_RIGHT") ENABLE("POG_BEST") ENABLE("EYE_LEFT")
		ENABLE("EYE_RIGHT") ENABLE("PUPILMM") ENABLE("DATA");

static const char disable_stream[] = "<SET ID=\"ENABLE_SEND_DATA\" STATE=\"0\" />\r\n";

/* Where the server is according to the API documentation. */
#define USUAL_HOST "127.0.0.1"
#define USUAL_PORT "4242"

struct gazepoint_settings {
	char host[GZ_NAME_SIZE];
	int port;
};

#define AT(field) offsetof(struct gazepoint_settings, field)

static const struct gz_option gazepoint_options[] = {
	{ "gazepoint.host", GZ_OPTION_STRING, AT(host), 0, GZ_NAME_SIZE, .preset = USUAL_HOST,
	  .help = "name or address of the machine that runs Gazepoint Control" },
	{ "gazepoint.port", GZ_OPTION_INT, AT(port), 1, 65535, .preset = USUAL_PORT,
	  .help = "TCP port of Gazepoint Control" },
};

static const size_t gazepoint_option_count = sizeof gazepoint_options / sizeof *gazepoint_options;

struct gazepoint_device {
	struct gz_device base;
	struct gz_device_info info;
	int fd; /* -1 while closed */
	struct gz_gazepoint_framer framer;
	struct gz_gazepoint_xml *xml;
	struct gz_clock_ticks ticks; /* TIME_TICK */
	struct gz_clock_model clock; /* TIME, if there are no usable ticks */
	struct gz_ratelimit complaints;
	struct gz_ratelimit jumps;
	bool by_ticks;       /* the newest record was stamped by ticks */
	int64_t stamp_ns;    /* arrival of the newest record, each a little later than the last */
	int64_t host_ns;     /* of the newest sample */
	bool clock_answered; /* no better frequency will come, whether or not it is known */
	bool over;           /* the connection is useless now */
	int64_t arrival_ns;  /* of the newest bytes */
	bool has_counter;
	long long counter; /* of the newest data record */
	enum gz_clock_tick tick;
	uint64_t seq;
	uint64_t lost;
	uint64_t malformed[GZ_MALFORMED_COUNT];
};

static struct gazepoint_device *gazepoint_device_of(struct gz_device *device)
{
	return (struct gazepoint_device *)device;
}

static void count_gazepoint_malformed(struct gazepoint_device *device, enum gz_malformed reason)
{
	device->malformed[reason]++;
	gz_warn_limited(device->base.log, &device->complaints, "unusable record: %s",
			gz_malformed_name(reason));
}

static void take_screen_answer(struct gazepoint_device *device,
			       const struct gz_gazepoint_record *answer)
{
	double side_max = GZ_DISPLAY_SIDE_MAX_PX;
	bool good = answer->width >= 1 && answer->width <= side_max && answer->height >= 1 &&
		    answer->height <= side_max;
	if (!good) {
		count_gazepoint_malformed(device, GZ_MALFORMED_VALUE);
		return;
	}
	device->info.has_display = true;
	device->info.display = gz_display_default((int)answer->width, (int)answer->height);
}

static void take_frequency_answer(struct gazepoint_device *device, long long sent)
{
	device->clock_answered = true;
	int64_t frequency_hz = gz_gazepoint_frequency_hz(sent);
	if (frequency_hz == 0)
		gz_warn(device->base.log, "a tick frequency of %lld Hz is impossible; TIME is used",
			sent);
	else
		gz_clock_ticks_init(&device->ticks, TICK_BITS, 1e9 / (double)frequency_hz);
}

static void take_gazepoint_ack(struct gazepoint_device *device,
			       const struct gz_gazepoint_record *answer)
{
	struct gz_device_info *info = &device->info;
	if (strcmp(answer->id, "PRODUCT_ID") == 0) {
		if (answer->value[0])
			snprintf(info->name, sizeof info->name, "Gazepoint %.48s", answer->value);
		if (answer->rate_hz > 0 && answer->rate_hz <= 2000)
			info->rate_hz = answer->rate_hz;
	} else if (strcmp(answer->id, "SERIAL_ID") == 0) {
		memcpy(info->serial, answer->value, sizeof info->serial);
	} else if (strcmp(answer->id, "SCREEN_SIZE") == 0) {
		take_screen_answer(device, answer);
	} else if (strcmp(answer->id, "TIME_TICK_FREQUENCY") == 0) {
		take_frequency_answer(device, answer->frequency);
	}
}

static void take_gazepoint_nack(struct gazepoint_device *device,
				const struct gz_gazepoint_record *answer)
{
	if (strcmp(answer->id, "ENABLE_SEND_DATA") == 0) {
		gz_err(device->base.log,
		       "%s sends no data; check that a tracker is connected to it",
		       device->info.name);
		device->over = true;
		return;
	}
	if (strcmp(answer->id, "TIME_TICK_FREQUENCY") == 0)
		device->clock_answered = true;
	gz_info(device->base.log, "this version of Gazepoint Control does not know %s", answer->id);
}

/* Another of several trackers, each with its own screen, has become active. The display of an open
 * device cannot change. */
static void take_gazepoint_update(struct gazepoint_device *device,
				  const struct gz_gazepoint_record *update)
{
	const int *px = device->info.display.px;
	bool same =
		!device->info.has_display || (update->width == px[0] && update->height == px[1]);
	if (same) {
		gz_info(device->base.log, "another tracker is active now");
		return;
	}
	gz_warn(device->base.log,
		"another tracker with another screen is active now; reopening the device");
	device->over = true;
}

/* Seconds since the server started or was last calibrated, as ns. */
static bool gazepoint_seconds_to_ns(double time_s, int64_t *out_ns)
{
	if (!(fabs(time_s) <= 9e9))
		return false;
	*out_ns = llrint(time_s * 1e9);
	return true;
}

static void warn_gazepoint_jump(struct gazepoint_device *device)
{
	gz_warn_limited(device->base.log, &device->jumps,
			"%s: the clock jumped; the clock fit starts again", device->info.name);
}

static void report_tick_finding(struct gazepoint_device *device, enum gz_clock_finding finding)
{
	const struct gz_clock_ticks *ticks = &device->ticks;
	switch (finding) {
	case GZ_CLOCK_FOUND_NOTHING:
	case GZ_CLOCK_FOUND_DECLARED:
		return;
	case GZ_CLOCK_FOUND_ESTIMATED:
		gz_warn(device->base.log,
			"%s: the clock ticks every %g ns by times of arrival, but declares %g ns; "
			"the measured tick is used",
			device->info.name, ticks->tick_ns, ticks->declared_ns);
		return;
	case GZ_CLOCK_FOUND_COARSE:
		gz_warn(device->base.log, "%s: the clock is too coarse; times of arrival are used",
			device->info.name);
		return;
	case GZ_CLOCK_FOUND_JUMP:
		warn_gazepoint_jump(device);
		return;
	}
}

static void stamp_by_ticks(struct gazepoint_device *device, long long tick,
			   struct gz_sample *sample)
{
	struct gz_clock_stamp stamp =
		gz_clock_ticks_step(&device->ticks, (uint64_t)tick, device->stamp_ns);
	sample->device_ns = stamp.device_ns;
	sample->host_ns = stamp.host_ns;
	device->tick = device->ticks.tick;
	report_tick_finding(device, stamp.finding);
}

static void stamp_by_seconds(struct gazepoint_device *device, double time_s,
			     struct gz_sample *sample)
{
	bool jumped = false;
	device->tick = GZ_CLOCK_NONE;
	sample->host_ns = device->stamp_ns;
	if (!gazepoint_seconds_to_ns(time_s, &sample->device_ns))
		return;
	device->tick = GZ_CLOCK_DECLARED;
	sample->host_ns =
		gz_clock_model_step(&device->clock, sample->device_ns, device->stamp_ns, &jumped);
	if (jumped)
		warn_gazepoint_jump(device);
}

/* Use the best clock of the record: ticks of a known length, else seconds, else ticks whose length
 * can be estimated. Records that arrive together were not taken together, so each later one counts
 * as arriving a nanosecond later. */
static void stamp_gazepoint_sample(struct gazepoint_device *device,
				   const struct gz_gazepoint_record *record,
				   struct gz_sample *sample)
{
	int64_t after_ns = device->stamp_ns + 1;
	device->stamp_ns = device->arrival_ns > after_ns ? device->arrival_ns : after_ns;
	device->by_ticks =
		record->has_tick && (device->ticks.declared_ns > 0 || isnan(record->time_s));
	if (device->by_ticks)
		stamp_by_ticks(device, record->tick, sample);
	else
		stamp_by_seconds(device, record->time_s, sample);
	/* Time must not run backwards when records change between these clocks. */
	if (sample->host_ns < device->host_ns)
		sample->host_ns = device->host_ns;
	device->host_ns = sample->host_ns;
}

/* Count lost records. @return false for a record that was received before */
static bool follow_record_counter(struct gazepoint_device *device,
				  const struct gz_gazepoint_record *record, uint32_t *out_lost)
{
	bool known = device->has_counter && record->has_counter;
	*out_lost = 0;
	if (known && record->counter == device->counter)
		return false;
	/* If the counter runs backwards, the server has restarted, and nothing counts as lost. */
	if (known && record->counter > device->counter && record->counter <= INT32_MAX &&
	    device->counter >= 0 && record->counter - device->counter <= GZ_LOST_AT_ONCE_MAX)
		*out_lost = (uint32_t)(record->counter - device->counter - 1);
	device->has_counter = record->has_counter;
	device->counter = record->counter;
	return true;
}

static void gazepoint_eye_to_sample(const struct gz_gazepoint_record *record, int side,
				    struct gz_eye_sample *out_eye)
{
	const struct gz_gazepoint_eye *eye = &record->eye[side];
	out_eye->point = (struct gz_point) { (float)eye->point[0], (float)eye->point[1] };
	out_eye->valid = record->has_eye[side] && eye->valid;
	if (eye->pupil_mm_valid)
		out_eye->pupil_mm = (float)eye->pupil_mm;
	else if (eye->origin_valid)
		out_eye->pupil_mm = (float)(eye->pupil_m * 1000);
	for (int i = 0; i < 3 && eye->origin_valid; i++)
		out_eye->origin_mm[i] = (float)(eye->origin_m[i] * 1000);
}

/* @retval GZ_ERR_PROTOCOL  it becomes no sample */
static enum gz_result gazepoint_record_to_sample(struct gazepoint_device *device,
						 const struct gz_gazepoint_record *record,
						 struct gz_sample *out_sample)
{
	struct gz_sample sample = gz_sample_unmeasured();
	if (!record->has_best && !record->has_eye[0] && !record->has_eye[1]) {
		count_gazepoint_malformed(device, GZ_MALFORMED_VALUE);
		return GZ_ERR_PROTOCOL;
	}
	if (!follow_record_counter(device, record, &sample.lost_before)) {
		count_gazepoint_malformed(device, GZ_MALFORMED_STALE);
		return GZ_ERR_PROTOCOL;
	}
	stamp_gazepoint_sample(device, record, &sample);
	sample.point = (struct gz_point) { (float)record->best[0], (float)record->best[1] };
	sample.valid = record->best_valid;
	for (int side = 0; side < GZ_EYE_COUNT; side++)
		gazepoint_eye_to_sample(record, side, &sample.eye[side]);
	device->lost += sample.lost_before;
	sample.seq = device->seq++;
	*out_sample = sample;
	return GZ_OK;
}

/* Take the next record. @retval GZ_OK  it became a sample. @retval GZ_ERR_TIMEOUT  more bytes are
 * needed. @retval GZ_ERR_PROTOCOL  it is no sample */
static enum gz_result take_gazepoint_record(struct gazepoint_device *device, bool streaming,
					    struct gz_sample *out_sample)
{
	const char *text;
	size_t size;
	enum gz_malformed reason = GZ_MALFORMED_LONG;
	struct gz_gazepoint_record record;
	enum gz_result result = gz_gazepoint_framer_next(&device->framer, &text, &size);
	if (result == GZ_OK)
		result = gz_gazepoint_parse(device->xml, text, size, &record, &reason);
	if (result == GZ_ERR_PROTOCOL)
		count_gazepoint_malformed(device, reason);
	if (result != GZ_OK)
		return result;
	if (record.kind == GZ_GAZEPOINT_DATA)
		return streaming && device->clock_answered
			       ? gazepoint_record_to_sample(device, &record, out_sample)
			       : GZ_ERR_PROTOCOL;
	if (record.kind == GZ_GAZEPOINT_ACK)
		take_gazepoint_ack(device, &record);
	else if (record.kind == GZ_GAZEPOINT_NACK)
		take_gazepoint_nack(device, &record);
	else if (record.kind == GZ_GAZEPOINT_UPDATE)
		take_gazepoint_update(device, &record);
	return device->over ? GZ_ERR_NO_DEVICE : GZ_ERR_PROTOCOL;
}

static enum gz_result lose_gazepoint_server(struct gazepoint_device *device, const char *why)
{
	gz_warn(device->base.log, "%s is gone: %s", device->info.name, why);
	close(device->fd);
	device->fd = -1;
	return GZ_ERR_NO_DEVICE;
}

/* Wait for bytes and receive them. */
static enum gz_result receive_gazepoint_bytes(struct gazepoint_device *device, int64_t deadline_ns)
{
	size_t size;
	int64_t silent_ns = device->arrival_ns + GZ_GAZEPOINT_SILENCE_MS * GZ_NS_PER_MS;
	if (device->fd < 0)
		return GZ_ERR_NO_DEVICE;
	bool soon = silent_ns < deadline_ns;
	enum gz_result result = gz_device_poll(device->fd, POLLIN, soon ? silent_ns : deadline_ns);
	if (result == GZ_ERR_TIMEOUT && gz_clock_now_ns() >= silent_ns)
		return lose_gazepoint_server(
			device,
			"it sends nothing; check that Gazepoint Control runs at gazepoint.host");
	if (result != GZ_OK)
		return result;
	char *room = gz_gazepoint_framer_room(&device->framer, &size);
	result = gz_gazepoint_link_receive(device->fd, room, size, &size);
	if (result == GZ_ERR_NO_DEVICE)
		return lose_gazepoint_server(device,
					     errno ? strerror(errno) : "it closed the connection");
	if (result == GZ_OK) {
		device->arrival_ns = gz_clock_now_ns();
		gz_gazepoint_framer_add(&device->framer, size);
	}
	return result;
}

/* No allocation, no lock. */
static enum gz_result gazepoint_read(struct gz_device *base, int timeout_ms,
				     struct gz_sample *out_sample)
{
	struct gazepoint_device *device = gazepoint_device_of(base);
	int64_t deadline_ns = gz_clock_now_ns() + timeout_ms * GZ_NS_PER_MS;
	if (device->over)
		return GZ_ERR_NO_DEVICE;
	for (;;) {
		enum gz_result result = take_gazepoint_record(device, true, out_sample);
		if (result == GZ_OK || result == GZ_ERR_NO_DEVICE)
			return result;
		if (result == GZ_ERR_TIMEOUT)
			result = receive_gazepoint_bytes(device, deadline_ns);
		if (result == GZ_ERR_NO_DEVICE)
			return result;
		/* Endless records without a sample must not hold the caller. */
		if (result != GZ_OK && gz_clock_now_ns() >= deadline_ns)
			return GZ_ERR_TIMEOUT;
	}
}

/* Ask about the tracker and wait a little for the answers. A server that takes longer may still
 * answer later. */
static enum gz_result ask_about_tracker(struct gazepoint_device *device)
{
	struct gz_sample unused;
	int64_t deadline_ns = gz_clock_now_ns() + GZ_GAZEPOINT_ANSWER_MS * GZ_NS_PER_MS;
	enum gz_result result = gz_gazepoint_link_send(device->fd, QUESTIONS, sizeof QUESTIONS - 1);
	if (result != GZ_OK)
		return lose_gazepoint_server(device, "it accepts no commands");
	while (!device->clock_answered) {
		result = take_gazepoint_record(device, false, &unused);
		if (result == GZ_ERR_TIMEOUT)
			result = receive_gazepoint_bytes(device, deadline_ns);
		if (result == GZ_ERR_NO_DEVICE)
			return result;
		if (gz_clock_now_ns() >= deadline_ns)
			return GZ_OK;
	}
	return GZ_OK;
}

static enum gz_result gazepoint_start(struct gz_device *base)
{
	struct gazepoint_device *device = gazepoint_device_of(base);
	/* Answers that have not come by now are not waited for: without a frequency, TIME is used.
	 */
	device->clock_answered = true;
	device->arrival_ns = gz_clock_now_ns();
	if (device->fd < 0)
		return GZ_ERR_NO_DEVICE;
	if (gz_gazepoint_link_send(device->fd, enable_stream, sizeof enable_stream - 1) != GZ_OK)
		return lose_gazepoint_server(device, "it accepts no commands");
	return GZ_OK;
}

static void gazepoint_info(const struct gz_device *base, struct gz_device_info *out_info)
{
	*out_info = ((const struct gazepoint_device *)base)->info;
}

static void gazepoint_counters(const struct gz_device *base,
			       struct gz_device_counters *out_counters)
{
	const struct gazepoint_device *device = (const struct gazepoint_device *)base;
	*out_counters = (struct gz_device_counters) {
		.lost = device->lost,
		.clock = device->by_ticks ? gz_clock_ticks_status(&device->ticks)
					  : gz_clock_model_status(&device->clock, device->tick),
	};
	memcpy(out_counters->malformed, device->malformed, sizeof out_counters->malformed);
}

static void gazepoint_destroy(struct gz_device *base)
{
	struct gazepoint_device *device = gazepoint_device_of(base);
	if (device->fd >= 0) {
		/* The server would also notice by itself. */
		gz_gazepoint_link_send(device->fd, disable_stream, sizeof disable_stream - 1);
		close(device->fd);
	}
	gz_gazepoint_xml_destroy(&device->xml);
	free(device);
}

static const struct gz_device_ops gazepoint_ops = {
	.start = gazepoint_start,
	.read = gazepoint_read,
	.info = gazepoint_info,
	.counters = gazepoint_counters,
	.destroy = gazepoint_destroy,
};

static enum gz_result open_gazepoint_link(struct gazepoint_device *device,
					  const struct gazepoint_settings *settings)
{
	char reason[GZ_GAZEPOINT_LINK_REASON_SIZE];
	enum gz_result result =
		gz_gazepoint_link_open(settings->host, settings->port, &device->fd, reason);
	if (result != GZ_OK)
		gz_err(device->base.log,
		       "cannot reach %s, port %d: %s; start Gazepoint Control there, or check "
		       "gazepoint.host and gazepoint.port",
		       settings->host, settings->port, reason);
	return result;
}

static enum gz_result gazepoint_create(const void *settings, const struct gz_driver_host *host,
				       struct gz_device **out_device)
{
	struct gazepoint_device *device = calloc(1, sizeof *device);
	if (!device)
		return GZ_ERR_NO_MEM;
	device->base = (struct gz_device) { .ops = &gazepoint_ops, .log = host->log };
	device->fd = -1;
	device->info = (struct gz_device_info) { .name = "Gazepoint" };
	gz_clock_ticks_init(&device->ticks, TICK_BITS, 0);
	device->arrival_ns = gz_clock_now_ns();
	enum gz_result result = gz_gazepoint_xml_create(&device->xml);
	if (result == GZ_OK)
		result = open_gazepoint_link(device, settings);
	if (result == GZ_OK)
		result = ask_about_tracker(device);
	if (result != GZ_OK) {
		gazepoint_destroy(&device->base);
		return result;
	}
	*out_device = &device->base;
	return GZ_OK;
}

/* Whether the server is at its default address. If none answers there and the user has not named
 * another, nothing is listed. */
static bool is_default_gazepoint_server(const struct gazepoint_settings *settings)
{
	return strcmp(settings->host, USUAL_HOST) == 0 && settings->port == atoi(USUAL_PORT);
}

/* Tries to connect; a server accepts several clients at a time. */
static size_t gazepoint_list(const void *settings, const struct gz_driver_host *host,
			     struct gz_device_entry *out_entries)
{
	const struct gazepoint_settings *wanted = settings;
	char reason[GZ_GAZEPOINT_LINK_REASON_SIZE];
	int fd;
	struct gz_device_entry *entry = &out_entries[0];
	(void)host;
	*entry = (struct gz_device_entry) { .name = "Gazepoint Control" };
	snprintf(entry->place, sizeof entry->place, "%.50s port %d", wanted->host, wanted->port);
	entry->usable = gz_gazepoint_link_open(wanted->host, wanted->port, &fd, reason) == GZ_OK;
	if (entry->usable)
		close(fd);
	else if (is_default_gazepoint_server(wanted))
		return 0;
	else
		snprintf(entry->reason, sizeof entry->reason,
			 "%.80s; start Gazepoint Control, or check gazepoint.host", reason);
	return 1;
}

_Static_assert(sizeof(struct gazepoint_settings) <= GZ_DRIVER_SETTINGS_SIZE, "settings fit");

const struct gz_driver gz_driver_gazepoint = {
	.name = "gazepoint",
	.help = "Gazepoint GP3 and GP3 HD, through Gazepoint Control over TCP",
	.options = gazepoint_options,
	.option_count = &gazepoint_option_count,
	.settings_size = sizeof(struct gazepoint_settings),
	.create = gazepoint_create,
	.list = gazepoint_list,
};
