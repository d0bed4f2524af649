#include "view/session/recording.h"

#include <unistd.h>

#define GZ_LOG_MODULE "session"

enum gz_result gz_recording_check(const char *path, const struct gz_log *log)
{
	if (access(path, F_OK) != 0)
		return GZ_OK;
	gz_err(log, "--record %s: is there already; choose another name", path);
	return GZ_ERR_BUSY;
}

enum gz_result gz_recording_begin(const struct gz_recording_start *start, const struct gz_log *log,
				  struct gz_session_writer **out_writer)
{
	const struct gz_scene *scene = gz_frame_maker_scene(start->maker);
	const struct gz_session_start session = {
		.path = start->path,
		.scene = start->scene,
		.settings = start->settings,
		.has_display = scene->has_display,
		.transfer = &scene->transfer,
		.volume = &scene->volume,
		.display = start->display,
		.software = "gazeview " GAZECAST_VERSION,
		.backend = gz_frame_backend(start->maker),
		.source = start->source,
		.rate_hz = start->rate_hz,
		.now_ns = start->now_ns,
	};
	const enum gz_result r = gz_session_writer_begin(&session, log, out_writer);
	if (r != GZ_OK)
		return r;
	gz_frame_forget(start->maker);
	if (scene->volume.bricks)
		gz_warn(log,
			"%s: a replay shows all of the file of bricks, not what had been read "
			"of it by each frame",
			start->path);
	return GZ_OK;
}

enum gz_result gz_recording_add(struct gz_session_writer *writer,
				const struct gz_frame_maker *maker,
				const struct gz_frame_request *request,
				const struct gz_frame_record *record, int64_t time_ns)
{
	const struct gz_session_frame frame = {
		.time_ns = time_ns > 0 ? time_ns : 0,
		.width = request->width,
		.height = request->height,
		.display = *request->display,
		.reading = *gz_frame_reading(maker),
		.focus = record->focus,
		.kept = record->kept,
		.took_ms = record->total_ms,
	};
	return gz_session_writer_add(writer, request->settings,
				     &gz_frame_maker_scene(maker)->transfer, &frame);
}
