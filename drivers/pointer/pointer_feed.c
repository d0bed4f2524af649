#include "drivers/pointer/pointer_feed.h"

#include <stdalign.h>
#include <stdatomic.h>
#include <stdlib.h>

/* Bytes that two threads must not share, lest they slow each other down. */
enum { CACHE_LINE = 64 };

struct gz_pointer_feed {
	alignas(CACHE_LINE) atomic_size_t put;   /* so many were put in, */
	alignas(CACHE_LINE) atomic_size_t taken; /* and so many taken out */
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
