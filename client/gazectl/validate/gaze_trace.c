#include "client/gazectl/validate/gaze_trace.h"

#include <math.h>
#include <stdlib.h>

/* How far back a label is looked for: the certain one comes at most 10 ms late, 20 samples at 2000
 * Hz; chosen with room for slow learners. */
enum { LABEL_REACH = 200 };

/* Room made at first: 16 s at 500 Hz. */
enum { ROOM_FIRST = 8192 };

static enum gz_result make_room(struct gz_gaze_trace *trace)
{
	if (trace->count < trace->room)
		return GZ_OK;
	if (trace->count >= GZ_GAZE_TRACE_MAX)
		return GZ_ERR_FULL;
	size_t room = trace->room ? 2 * trace->room : ROOM_FIRST;
	struct gz_gaze_trace_sample *items = realloc(trace->items, room * sizeof *items);
	if (!items)
		return GZ_ERR_NO_MEM;
	trace->items = items;
	trace->room = room;
	return GZ_OK;
}

static void take_label(struct gz_gaze_trace *trace, uint64_t first, uint64_t last,
		       enum gz_event event)
{
	size_t reach = trace->count < LABEL_REACH ? trace->count : LABEL_REACH;
	for (size_t i = 1; i <= reach; i++) {
		struct gz_gaze_trace_sample *item = &trace->items[trace->count - i];
		if (item->sample.seq < first)
			return;
		if (item->sample.seq > last)
			continue;
		item->event = event;
		item->sample.fixating = event == GZ_EVENT_FIXATION;
	}
}

enum gz_result gz_gaze_trace_add(struct gz_gaze_trace *trace, const struct gz_gaze *gaze)
{
	enum gz_result result = make_room(trace);
	if (result != GZ_OK)
		return result;
	if (trace->count == 0 || gaze->host_ns > trace->items[trace->count - 1].sample.host_ns) {
		struct gz_gaze_trace_sample *item = &trace->items[trace->count++];
		*item = (struct gz_gaze_trace_sample) { .event = gaze->event };
		item->sample.host_ns = gaze->host_ns;
		item->sample.seq = gaze->seq;
		item->sample.fixating = gaze->event == GZ_EVENT_FIXATION;
		item->sample.point[GZ_TRACE_BOTH] = gaze->raw;
		for (int i = 0; i < GZ_EYE_COUNT; i++)
			item->sample.point[i] = gaze->eye[i].valid ? gaze->eye[i].point
								   : (struct gz_point) { NAN, NAN };
	}
	if (gaze->final_known)
		take_label(trace, gaze->final_seq - gaze->final_span, gaze->final_seq,
			   gaze->final_event);
	return GZ_OK;
}

size_t gz_gaze_trace_find(const struct gz_gaze_trace *trace, int64_t host_ns)
{
	size_t low = 0, high = trace->count;
	while (low < high) {
		size_t middle = low + (high - low) / 2;
		if (trace->items[middle].sample.host_ns < host_ns)
			low = middle + 1;
		else
			high = middle;
	}
	return low;
}

void gz_gaze_trace_clear(struct gz_gaze_trace *trace)
{
	free(trace->items);
	*trace = (struct gz_gaze_trace) { 0 };
}
