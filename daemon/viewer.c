#include "daemon/viewer.h"

#include <string.h>

int64_t gz_viewer_time_ns(bool has_time, int64_t time_ns, int64_t now_ns)
{
	bool believable = has_time && time_ns <= now_ns && time_ns > now_ns - GZ_VIEWER_AGE_MAX_NS;
	return believable ? time_ns : now_ns;
}

struct gz_pointer_report gz_viewer_report(const struct gz_viewer_pointer *pointer, int64_t now_ns)
{
	return (struct gz_pointer_report) {
		.host_ns = gz_viewer_time_ns(pointer->has_time, pointer->time_ns, now_ns),
		.known = pointer->known,
		.point = pointer->point,
	};
}

static struct gz_gaze_log_record record_of(const int *rect_px, int64_t host_ns)
{
	struct gz_gaze_log_record record = { .kind = GZ_GAZE_LOG_WINDOW, .host_ns = host_ns };
	memcpy(record.window_px, rect_px, sizeof record.window_px);
	return record;
}

bool gz_viewer_place_step(struct gz_viewer_place *place, const int *rect_px, int64_t host_ns,
			  struct gz_gaze_log_record *out_record)
{
	if (!rect_px) {
		place->known = false;
		return false;
	}
	bool same = place->known && host_ns - place->heard_ns <= GZ_VIEWER_WINDOW_NS &&
		    memcmp(place->rect_px, rect_px, sizeof place->rect_px) == 0;
	place->known = true;
	place->heard_ns = host_ns;
	memcpy(place->rect_px, rect_px, sizeof place->rect_px);
	if (!same)
		*out_record = record_of(rect_px, host_ns);
	return !same;
}

bool gz_viewer_place_at_start(const struct gz_viewer_place *place, int64_t now_ns,
			      struct gz_gaze_log_record *out_record)
{
	if (!place->known || now_ns - place->heard_ns > GZ_VIEWER_WINDOW_NS)
		return false;
	*out_record = record_of(place->rect_px, now_ns);
	return true;
}
