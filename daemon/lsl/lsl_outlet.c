#include "daemon/lsl/lsl_outlet.h"

#include <errno.h>
#include <pthread.h>
#include <stdalign.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"

#define GZ_LOG_MODULE "lsl"

/* Distance that keeps the two counters in different cache lines, bytes. */
enum { CACHE_LINE = 64 };

/* Seconds of samples that the library keeps for a reader that does not take them; it drops older
 * ones. Chosen: a reader that waits for its disk or its network; 28 MB at 2000 Hz. */
enum { BUFFERED_S = 60 };

/* Time between two comparisons of the clocks. Chosen: on Linux both are the same clock; if they
 * are not, the crystals of one machine drift apart by some µs in this time. */
#define COMPARE_NS GZ_NS_PER_S

/* Readings of the clock at each comparison, of which the tightest counts. */
enum { READINGS = 8 };

/* How long the end of a stream waits for its readers to take what was sent, ms: the library has no
 * way to ask. Chosen: a live reader on this network needs far less. */
enum { LINGER_MS = 200 };

/* What was dropped is logged once a minute. */
#define COMPLAINT_NS (60 * GZ_NS_PER_S)

enum lsl_entry_kind {
	ENTRY_DEVICE,
	ENTRY_GAZE,
	ENTRY_EVENT,
};

/* One thing in the queue. */
struct lsl_entry {
	enum lsl_entry_kind kind;
	union {
		struct gz_lsl_device device;
		struct gz_gaze gaze;
		struct {
			int64_t host_ns;
			char text[GZ_LSL_TEXT_SIZE];
		} event;
	};
};

struct gz_lsl_outlet {
	/* Both only count up. Each is written by one thread only. */
	alignas(CACHE_LINE) atomic_size_t put;
	alignas(CACHE_LINE) atomic_size_t taken;
	alignas(CACHE_LINE) atomic_bool quit;
	atomic_uint_fast64_t lost;
	struct lsl_entry *entries;
	pthread_t thread;
	bool has_thread;
	const struct gz_log *log;
	char name[GZ_NAME_SIZE];
	char host[GZ_NAME_SIZE];
	struct gz_lsl_library library;

	/* The serving thread's. */
	struct gz_lsl_events events;
	bool device_waits; /* for room in the queue; no gaze goes before it */
	struct gz_lsl_device next_device;

	/* The outlet's thread's. */
	bool has_device;
	struct gz_lsl_device device; /* that the stream of gaze is described with */
	struct gz_lsl_handle *gaze_stream, *event_stream; /* NULL if not open */
	double offset_s;                                  /* LSL's clock less the host's */
	int64_t compare_ns;                               /* when the clocks are compared next */
	uint64_t lost_told;
	struct gz_ratelimit complaints;
};

/* The next free entry, or NULL if the queue is full. */
static struct lsl_entry *free_lsl_entry(struct gz_lsl_outlet *outlet)
{
	size_t put = atomic_load_explicit(&outlet->put, memory_order_relaxed);
	size_t taken = atomic_load_explicit(&outlet->taken, memory_order_acquire);
	return put - taken == GZ_LSL_QUEUE ? NULL : &outlet->entries[put % GZ_LSL_QUEUE];
}

/* Hand over the entry that free_lsl_entry() gave and the caller has filled. */
static void put_lsl_entry(struct gz_lsl_outlet *outlet)
{
	size_t put = atomic_load_explicit(&outlet->put, memory_order_relaxed);
	atomic_store_explicit(&outlet->put, put + 1, memory_order_release);
}

static void count_lsl_loss(struct gz_lsl_outlet *outlet)
{
	atomic_fetch_add_explicit(&outlet->lost, 1, memory_order_relaxed);
}

/* Queue the device that found no room earlier. @return whether none waits any more */
static bool put_lsl_device(struct gz_lsl_outlet *outlet)
{
	if (!outlet->device_waits)
		return true;
	struct lsl_entry *entry = free_lsl_entry(outlet);
	if (!entry)
		return false;
	entry->kind = ENTRY_DEVICE;
	entry->device = outlet->next_device;
	put_lsl_entry(outlet);
	outlet->device_waits = false;
	return true;
}

void gz_lsl_outlet_set_device(struct gz_lsl_outlet *outlet, const struct gz_lsl_device *device)
{
	if (!outlet)
		return;
	outlet->next_device = *device;
	outlet->device_waits = true;
	(void)put_lsl_device(outlet); /* else before the next sample */
}

static void put_lsl_gaze(struct gz_lsl_outlet *outlet, const struct gz_gaze *gaze)
{
	struct lsl_entry *entry = put_lsl_device(outlet) ? free_lsl_entry(outlet) : NULL;
	if (!entry) {
		count_lsl_loss(outlet);
		return;
	}
	entry->kind = ENTRY_GAZE;
	entry->gaze = *gaze;
	put_lsl_entry(outlet);
}

static void put_lsl_event(struct gz_lsl_outlet *outlet, int64_t host_ns, const char *label)
{
	struct lsl_entry *entry = free_lsl_entry(outlet);
	if (!entry) {
		count_lsl_loss(outlet);
		return;
	}
	entry->kind = ENTRY_EVENT;
	entry->event.host_ns = host_ns;
	snprintf(entry->event.text, sizeof entry->event.text, "%s", label);
	put_lsl_entry(outlet);
}

void gz_lsl_outlet_step(struct gz_lsl_outlet *outlet, const struct gz_pipeline_output *step)
{
	struct gz_lsl_event events[GZ_LSL_EVENTS_MAX];
	if (!outlet)
		return;
	put_lsl_gaze(outlet, &step->gaze);
	size_t count = gz_lsl_events_step(&outlet->events, step, events);
	for (size_t i = 0; i < count; i++)
		put_lsl_event(outlet, events[i].host_ns, events[i].label);
}

void gz_lsl_outlet_annotate(struct gz_lsl_outlet *outlet, int64_t host_ns, const char *label)
{
	if (outlet && label[0])
		put_lsl_event(outlet, host_ns, label);
}

uint64_t gz_lsl_outlet_lost(const struct gz_lsl_outlet *outlet)
{
	return outlet ? atomic_load_explicit(&outlet->lost, memory_order_relaxed) : 0;
}

/*
 * From here on, on the outlet's thread.
 */

static const char *last_lsl_error(const struct gz_lsl_library *library)
{
	const char *text = library->last_error ? library->last_error() : NULL;
	return text && text[0] ? text : "no reason given";
}

/* Open a stream, and free its description. @return NULL if the library refuses; logged */
static struct gz_lsl_handle *open_lsl_stream(struct gz_lsl_outlet *outlet, struct gz_lsl_info *info,
					     const char *content)
{
	const struct gz_lsl_library *library = &outlet->library;
	struct gz_lsl_handle *stream = info ? library->create_outlet(info, 0, BUFFERED_S) : NULL;
	if (!stream)
		gz_err(outlet->log, "liblsl cannot open the stream of %s: %s; it is left out",
		       content, last_lsl_error(library));
	if (info)
		library->destroy_streaminfo(info);
	return stream;
}

/* Close a stream when its readers have had time to take what was sent. */
static void close_lsl_stream(const struct gz_lsl_outlet *outlet, struct gz_lsl_handle **stream)
{
	if (!*stream)
		return;
	if (outlet->library.have_consumers(*stream) != 0)
		gz_clock_sleep_until_ns(gz_clock_now_ns() + LINGER_MS * GZ_NS_PER_MS);
	outlet->library.destroy_outlet(*stream);
	*stream = NULL;
}

static void adopt_lsl_device(struct gz_lsl_outlet *outlet, const struct gz_lsl_device *device)
{
	if (outlet->has_device && gz_lsl_device_same(device, &outlet->device))
		return;
	outlet->has_device = true;
	outlet->device = *device;
	close_lsl_stream(outlet, &outlet->gaze_stream);
	outlet->gaze_stream = open_lsl_stream(
		outlet, gz_lsl_describe_gaze(&outlet->library, outlet->name, outlet->host, device),
		"gaze");
	if (outlet->gaze_stream)
		gz_info(outlet->log,
			"LSL: gaze of %s is the stream \"%s\"; every machine on the network that "
			"reaches this one can read it",
			device->tracker, outlet->name);
}

static double lsl_time_s(const struct gz_lsl_outlet *outlet, int64_t host_ns)
{
	return gz_ns_to_s(host_ns) + outlet->offset_s;
}

/* @param last  no other sample follows at once, so the reader gets those up to this one */
static void send_lsl_gaze(struct gz_lsl_outlet *outlet, const struct gz_gaze *gaze, bool last)
{
	double values[GZ_LSL_CHANNELS];
	if (!outlet->gaze_stream)
		return;
	gz_lsl_values(gaze, &outlet->device.display, values);
	if (outlet->library.push_sample_dtp(outlet->gaze_stream, values,
					    lsl_time_s(outlet, gaze->host_ns), last) != 0)
		count_lsl_loss(outlet);
}

static void send_lsl_event(struct gz_lsl_outlet *outlet, int64_t host_ns, const char *text)
{
	if (outlet->event_stream &&
	    outlet->library.push_sample_strtp(outlet->event_stream, &text,
					      lsl_time_s(outlet, host_ns), 1) != 0)
		count_lsl_loss(outlet);
}

/* Read LSL's clock several times; the tightest reading counts. */
static void compare_lsl_clocks(struct gz_lsl_outlet *outlet)
{
	int64_t before_ns = 0, after_ns = INT64_MAX;
	double lsl_s = 0;
	for (int i = 0; i < READINGS; i++) {
		int64_t before = gz_clock_now_ns();
		double reading = outlet->library.local_clock();
		int64_t after = gz_clock_now_ns();
		if (after - before >= after_ns - before_ns)
			continue;
		before_ns = before;
		after_ns = after;
		lsl_s = reading;
	}
	outlet->offset_s = gz_lsl_offset_step(outlet->offset_s, before_ns, lsl_s, after_ns);
	outlet->compare_ns = after_ns + COMPARE_NS;
}

static void send_lsl_entry(struct gz_lsl_outlet *outlet, const struct lsl_entry *entry, bool last)
{
	switch (entry->kind) {
	case ENTRY_DEVICE:
		adopt_lsl_device(outlet, &entry->device);
		return;
	case ENTRY_GAZE:
		send_lsl_gaze(outlet, &entry->gaze, last);
		return;
	case ENTRY_EVENT:
		send_lsl_event(outlet, entry->event.host_ns, entry->event.text);
		return;
	}
}

static void tell_lsl_loss(struct gz_lsl_outlet *outlet)
{
	uint64_t lost = gz_lsl_outlet_lost(outlet), more;
	if (lost == outlet->lost_told ||
	    !gz_ratelimit_pass(&outlet->complaints, gz_clock_now_ns(), COMPLAINT_NS, &more))
		return;
	gz_warn(outlet->log,
		"liblsl was too slow or refused them: %llu samples and events did not reach its "
		"readers",
		(unsigned long long)(lost - outlet->lost_told));
	outlet->lost_told = lost;
}

/* Whether the entry after number @p taken is there and is a sample. */
static bool gaze_follows(const struct gz_lsl_outlet *outlet, size_t taken, size_t put)
{
	return taken + 1 != put && outlet->entries[(taken + 1) % GZ_LSL_QUEUE].kind == ENTRY_GAZE;
}

static void drain_lsl_queue(struct gz_lsl_outlet *outlet)
{
	size_t taken = atomic_load_explicit(&outlet->taken, memory_order_relaxed);
	size_t put = atomic_load_explicit(&outlet->put, memory_order_acquire);
	for (; taken != put; taken++) {
		send_lsl_entry(outlet, &outlet->entries[taken % GZ_LSL_QUEUE],
			       !gaze_follows(outlet, taken, put));
		atomic_store_explicit(&outlet->taken, taken + 1, memory_order_release);
	}
}

static void close_lsl_streams(struct gz_lsl_outlet *outlet)
{
	close_lsl_stream(outlet, &outlet->gaze_stream);
	close_lsl_stream(outlet, &outlet->event_stream);
}

static void *run_lsl_outlet(void *user)
{
	struct gz_lsl_outlet *outlet = user;
	pthread_setname_np(pthread_self(), "gazed-lsl");
	outlet->event_stream = open_lsl_stream(
		outlet, gz_lsl_describe_events(&outlet->library, outlet->name, outlet->host),
		"events");
	bool quit;
	do {
		quit = atomic_load_explicit(&outlet->quit, memory_order_acquire);
		int64_t now_ns = gz_clock_now_ns();
		if (now_ns >= outlet->compare_ns)
			compare_lsl_clocks(outlet);
		drain_lsl_queue(outlet);
		tell_lsl_loss(outlet);
		if (!quit)
			gz_clock_sleep_until_ns(now_ns + GZ_LSL_DRAIN_MS * GZ_NS_PER_MS);
	} while (!quit);
	close_lsl_streams(outlet);
	return NULL;
}

static enum gz_result open_lsl_library(struct gz_lsl_outlet *outlet, const char *path)
{
	char reason[GZ_LSL_REASON_SIZE];
	enum gz_result result = gz_lsl_library_open(path, &outlet->library, reason);
	if (result != GZ_OK) {
		gz_err(outlet->log, "lsl.outlet: %s", reason);
		return result;
	}
	int version = (int)outlet->library.library_version();
	gz_debug(outlet->log, "liblsl %d.%d", version / 100, version % 100);
	return GZ_OK;
}

static enum gz_result start_lsl_thread(struct gz_lsl_outlet *outlet)
{
	outlet->entries = calloc(GZ_LSL_QUEUE, sizeof *outlet->entries);
	int error = outlet->entries ? pthread_create(&outlet->thread, NULL, run_lsl_outlet, outlet)
				    : ENOMEM;
	outlet->has_thread = error == 0;
	if (error == 0)
		return GZ_OK;
	gz_err(outlet->log, "cannot start the thread of LSL: %s", strerror(error));
	return GZ_ERR_NO_MEM;
}

enum gz_result gz_lsl_outlet_create(const char *path, const char *name, const struct gz_log *log,
				    struct gz_lsl_outlet **out_outlet)
{
	struct gz_lsl_outlet *outlet = aligned_alloc(CACHE_LINE, sizeof *outlet);
	if (!outlet) {
		gz_err(log, "no memory for LSL");
		return GZ_ERR_NO_MEM;
	}
	memset(outlet, 0, sizeof *outlet);
	atomic_init(&outlet->put, 0);
	atomic_init(&outlet->taken, 0);
	atomic_init(&outlet->quit, false);
	atomic_init(&outlet->lost, 0);
	outlet->log = log;
	snprintf(outlet->name, sizeof outlet->name, "%s", name);
	if (gethostname(outlet->host, sizeof outlet->host - 1) != 0)
		snprintf(outlet->host, sizeof outlet->host, "localhost");
	enum gz_result result = open_lsl_library(outlet, path);
	if (result == GZ_OK)
		result = start_lsl_thread(outlet);
	if (result != GZ_OK) {
		gz_lsl_outlet_destroy(&outlet);
		return result;
	}
	*out_outlet = outlet;
	return GZ_OK;
}

void gz_lsl_outlet_destroy(struct gz_lsl_outlet **outlet)
{
	if (!outlet || !*outlet)
		return;
	struct gz_lsl_outlet *o = *outlet;
	atomic_store_explicit(&o->quit, true, memory_order_release);
	if (o->has_thread)
		pthread_join(o->thread, NULL);
	gz_lsl_library_close(&o->library);
	free(o->entries);
	free(o);
	*outlet = NULL;
}
