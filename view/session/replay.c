#include "view/session/replay.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "view/session/session_reader.h"

#define GZ_LOG_MODULE "replay"

struct gz_replay {
	const struct gz_log *log;
	const struct gz_view_options *options;
	struct gz_frame_maker *maker;
	struct gz_session_reader *reader;
	struct gz_session_state state;
	struct gz_session_frame frame;
	struct gz_scene_settings settings; /* recorded, with the command line's keys */
	bool compared;
};

/* Read the header and the first frame, ignoring its settings. */
static enum gz_result read_first(const char *path, const struct gz_log *log,
				 struct gz_session_header *out_header,
				 struct gz_session_frame *out_frame)
{
	struct gz_session_reader *reader;
	enum gz_result r = gz_session_open(path, log, &reader);
	if (r != GZ_OK)
		return r;
	struct gz_session_state *state = calloc(1, sizeof *state);
	if (!state) {
		gz_session_close(&reader);
		return GZ_ERR_NO_MEM;
	}
	r = gz_session_read(reader, state, out_frame);
	if (r == GZ_ERR_END) {
		gz_err(log, "%s: the session has no frames; record for longer", path);
		r = GZ_ERR_FORMAT;
	}
	*out_header = *gz_session_header(reader);
	free(state);
	gz_session_close(&reader);
	return r;
}

enum gz_result gz_replay_adopt(struct gz_view_options *options, const struct gz_log *log)
{
	struct gz_session_header header;
	struct gz_session_frame frame;
	const enum gz_result r = read_first(options->replay, log, &header, &frame);
	if (r != GZ_OK)
		return r;
	if (gz_text_print(options->scene, sizeof options->scene, "%s/" GZ_SESSION_SCENE,
			  options->replay) != GZ_OK) {
		gz_err(log, "--replay %s: the path is too long; move the session", options->replay);
		return GZ_ERR_FULL;
	}
	options->size_px[0] = frame.width;
	options->size_px[1] = frame.height;
	if (strcmp(options->backend, "auto") == 0 && strcmp(header.backend, "cpu") == 0)
		snprintf(options->backend, sizeof options->backend, "cpu");
	return GZ_OK;
}

static enum gz_result check_recorded_volume(const struct gz_replay *replay)
{
	const struct gz_volume *volume = &gz_frame_maker_scene(replay->maker)->volume;
	const struct gz_volume_identity *recorded = &gz_session_header(replay->reader)->volume;
	const struct gz_volume_identity here = gz_volume_identify(volume);
	if (gz_volume_identity_same(&here, recorded))
		return GZ_OK;
	gz_err(replay->log,
	       "%s: the volume (%dx%dx%d, %g to %g) differs from the recorded one (%dx%dx%d, %g to "
	       "%g); name that one in its " GZ_SESSION_SCENE,
	       replay->options->replay, here.dims[0], here.dims[1], here.dims[2], here.least,
	       here.greatest, recorded->dims[0], recorded->dims[1], recorded->dims[2],
	       recorded->least, recorded->greatest);
	return GZ_ERR_FORMAT;
}

enum gz_result gz_replay_open(const struct gz_view_options *options, struct gz_frame_maker *maker,
			      const struct gz_log *log, struct gz_replay **out_replay)
{
	const struct gz_scene *scene = gz_frame_maker_scene(maker);
	struct gz_replay *replay = calloc(1, sizeof *replay);
	if (!replay)
		return GZ_ERR_NO_MEM;
	*replay = (struct gz_replay) { .log = log, .options = options, .maker = maker };
	memcpy(&replay->state.settings, &scene->settings, sizeof scene->settings);
	replay->state.transfer = scene->transfer;
	enum gz_result r = gz_session_open(options->replay, log, &replay->reader);
	if (r == GZ_OK)
		r = check_recorded_volume(replay);
	if (r != GZ_OK) {
		gz_replay_close(&replay);
		return r;
	}
	*out_replay = replay;
	return GZ_OK;
}

/* The recorded settings with the command line's keys, checked together. */
static enum gz_result take_settings(struct gz_replay *replay)
{
	char place[GZ_PATH_SIZE];
	struct gz_foveation *foveation = &replay->state.settings.foveation;
	gz_session_print_place(replay->reader, place, sizeof place);
	enum gz_result r = GZ_OK;
	if (replay->state.table_changed) {
		foveation->table = (struct gz_spacing_table) { 0 };
		r = gz_scene_load_table(replay->options->scene, replay->log, foveation);
	}
	if (r == GZ_OK && replay->state.templates_changed)
		r = gz_scene_find_templates(replay->options->scene, replay->log,
					    &replay->state.settings);
	memcpy(&replay->settings, &replay->state.settings, sizeof replay->settings);
	if (r == GZ_OK)
		r = gz_view_options_apply(replay->options, &replay->settings);
	return r == GZ_OK ? gz_scene_settings_check(&replay->settings, place, replay->log) : r;
}

enum gz_result gz_replay_next(struct gz_replay *replay)
{
	const enum gz_result r = gz_session_read(replay->reader, &replay->state, &replay->frame);
	return r == GZ_OK ? take_settings(replay) : r;
}

const struct gz_session_frame *gz_replay_frame(const struct gz_replay *replay)
{
	return &replay->frame;
}

const struct gz_scene_settings *gz_replay_settings(const struct gz_replay *replay)
{
	return &replay->settings;
}

enum gz_result gz_replay_ready(struct gz_replay *replay)
{
	enum gz_result r = GZ_OK;
	if (replay->state.transfer_changed)
		r = gz_frame_set_transfer(replay->maker, &replay->state.transfer);
	if (!replay->frame.kept)
		gz_frame_forget(replay->maker);
	gz_frame_set_focus(replay->maker, &replay->frame.reading, &replay->frame.focus);
	gz_frame_set_raised(replay->maker, &replay->frame.raised);
	gz_frame_set_change(replay->maker, &replay->frame.change);
	return r;
}

void gz_replay_compare(struct gz_replay *replay, const struct gz_frame_record *record)
{
	const char *recorded = gz_session_header(replay->reader)->backend;
	if (replay->compared)
		return;
	replay->compared = true;
	if (strcmp(record->backend, recorded) != 0)
		gz_warn(replay->log,
			"%s: recorded with backend %s, shown with %s: colours may differ by one "
			"step in places; use --backend %s for the same pictures",
			replay->options->replay, recorded, record->backend, recorded);
}

uint64_t gz_replay_frames(const struct gz_replay *replay)
{
	return gz_session_frames_read(replay->reader);
}

void gz_replay_close(struct gz_replay **replay)
{
	if (!*replay)
		return;
	gz_session_close(&(*replay)->reader);
	free(*replay);
	*replay = NULL;
}
