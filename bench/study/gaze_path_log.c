/* A gaze log as a path: its samples run through the daemon's pipeline. */
#include "bench/study/gaze_path.h"

#include <stdlib.h>

#include "filter/pipeline.h"
#include "protocol/gaze_log.h"

#define GZ_LOG_MODULE "path"

struct player {
	const char *file;
	const struct gz_log *log;
	struct gz_gaze_log_reader *reader;
	struct gz_pipeline pipeline;
	bool samples; /* one point each; else one a fixation */
	bool open;    /* the newest fixation has not ended yet: it is at */
	struct gz_point at;
	struct gz_gaze_path *path;
};

static enum gz_result add_output(struct player *player, const struct gz_pipeline_output *output)
{
	enum gz_result result = GZ_OK;
	if (player->samples) {
		const enum gz_event event = output->gaze.event;
		/* In a blink or when it is lost, the point is where it was last. */
		const bool there = event != GZ_EVENT_BLINK && event != GZ_EVENT_LOST &&
				   output->rejection == GZ_REJECT_NONE;
		return there ? gz_gaze_path_add(player->path, output->gaze.point) : GZ_OK;
	}
	for (size_t i = 0; i < output->fixation_count && result == GZ_OK; i++) {
		const struct gz_fixation *fixation = &output->fixations[i];
		player->open = !fixation->final;
		player->at = fixation->point;
		if (fixation->final)
			result = gz_gaze_path_add(player->path, fixation->point);
	}
	return result;
}

static enum gz_result play(struct player *player)
{
	struct gz_gaze_log_record *record = malloc(sizeof *record);
	struct gz_pipeline_output output;
	enum gz_result result = record ? GZ_OK : GZ_ERR_NO_MEM;
	while (result == GZ_OK) {
		result = gz_gaze_log_read(player->reader, record);
		if (result == GZ_ERR_FORMAT) { /* logged; it goes on behind the line */
			result = GZ_OK;
			continue;
		}
		if (result != GZ_OK || record->kind != GZ_GAZE_LOG_SAMPLE)
			continue;
		gz_pipeline_step(&player->pipeline, &record->sample, &output);
		result = add_output(player, &output);
	}
	free(record);
	if (result != GZ_ERR_END)
		return result;
	/* A recording may end within a fixation. */
	return player->open ? gz_gaze_path_add(player->path, player->at) : GZ_OK;
}

static enum gz_result prepare(struct player *player)
{
	const struct gz_gaze_log_header *header = gz_gaze_log_header(player->reader);
	struct gz_gaze_path *path = player->path;
	struct gz_pipeline_params params;
	const enum gz_result result =
		gz_pipeline_recorded_params(header, player->file, player->log, &params);
	if (result != GZ_OK)
		return result;
	path->has_display = header->has_display && gz_display_valid(&header->display);
	/* Only its angles matter here, and those of the default are the same at any size. */
	const struct gz_display assumed = gz_display_default(1920, 1080);
	path->display = path->has_display ? header->display : assumed;
	gz_pipeline_init(&player->pipeline, &params, &path->display);
	return GZ_OK;
}

enum gz_result gz_gaze_path_add_log(const char *file, bool samples, const struct gz_log *log,
				    struct gz_gaze_path *path)
{
	struct player player = { .file = file, .log = log, .samples = samples, .path = path };
	enum gz_result result = gz_gaze_log_open(file, log, &player.reader);
	if (result == GZ_OK)
		result = prepare(&player);
	if (result == GZ_OK)
		result = play(&player);
	gz_gaze_log_close(&player.reader);
	if (result == GZ_OK && path->count == 0) {
		gz_err(log, "%s: holds no %s; record where someone looks at the display", file,
		       samples ? "valid gaze" : "fixation, as far as its gaze is valid");
		result = GZ_ERR_FORMAT;
	}
	return result;
}
