#include "view/options/options_check.h"

#include <limits.h>
#include <string.h>

#define GZ_LOG_MODULE "gazeview"

/* Targets are for somebody who sits there and sees nothing else. */
static enum gz_result check_targets(const struct gz_view_options *options, const struct gz_log *log)
{
	const char *other = options->scene[0]    ? "a scene"
			    : options->headless  ? "--headless"
			    : options->record[0] ? "--record"
			    : options->replay[0] ? "--replay"
						 : NULL;
	if (!other)
		return GZ_OK;
	gz_err(log, "--targets: %s cannot go with it; remove one of them", other);
	return GZ_ERR_INVAL;
}

/* A session has what these say. */
static enum gz_result check_replay(const struct gz_view_options *options, const struct gz_log *log)
{
	static const char *const others[] = {
		"scene",         "size",        "gaze",        "frames",        "turn",
		"display-px",    "display-mm",  "distance-mm", "write-volume",  "record",
		"transfer.file", "volume.dims", "volume.type", "volume.endian", "volume.spacing",
	};
	const char *other = options->scene[0] ? "scene" : NULL;
	for (size_t i = 0; i < gz_view_option_count && !other; i++)
		for (size_t k = 0; k < sizeof others / sizeof others[0]; k++)
			if (options->given[i] &&
			    strcmp(gz_view_option_table[i].key, others[k]) == 0)
				other = others[k];
	if (!other)
		return GZ_OK;
	gz_err(log, "--replay: --%s cannot go with it: the session says that; remove one of them",
	       other);
	return GZ_ERR_INVAL;
}

/* A layout is told by dims and type; the rest has presets. */
static enum gz_result check_raw(const struct gz_view_options *options, const struct gz_log *log)
{
	const bool dims = options->volume_dims[0] > 0, type = options->volume_type >= 0;
	const bool more = options->volume_endian >= 0 || options->volume_spacing[0] > 0;
	if (dims == type && (dims || !more))
		return GZ_OK;
	gz_err(log, "--volume.%s: not given; a raw file needs both dims and type",
	       dims ? "type" : "dims");
	return GZ_ERR_INVAL;
}

/* A key of a scene that says what is shown, not on which display. */
static bool any_scene_key(const struct gz_view_options *options)
{
	struct gz_scene_settings settings;
	struct gz_view_scene_tables tables;
	bool any = false;
	const bool *given = options->scene_given;
	gz_view_pick_scene_tables(&settings, &tables);
	for (size_t i = 0; i < GZ_VIEW_SCENE_TABLES; i++) {
		for (size_t k = 0; k < tables.bindings[i].count; k++) {
			const char *key = tables.bindings[i].options[k].key;
			const bool display = strcmp(key, "view.vsync") == 0 ||
					     strcmp(key, "view.tracker_display") == 0;
			any = (*given++ && !display) || any;
		}
	}
	return any;
}

/* What is shown, and how, says the experiment alone. */
static enum gz_result check_experiment(const struct gz_view_options *options,
				       const struct gz_log *log)
{
	const char *other = options->target.targets[0]  ? "--targets"
			    : options->scene[0]         ? "a scene"
			    : options->method >= 0      ? "--method"
			    : options->turn_deg != 0    ? "--turn"
			    : options->write_volume[0]  ? "--write-volume"
			    : options->out[0]           ? "--out"
			    : options->video[0]         ? "--video"
			    : options->transfer_file[0] ? "--transfer.file"
			    : options->record[0]        ? "--record"
			    : options->replay[0]        ? "--replay"
			    : options->stats[0]         ? "--stats"
			    : options->cross            ? "--cross"
			    : options->letters          ? "--letters"
			    : any_scene_key(options)    ? "a key of a scene"
							: NULL;
	if (!other)
		return gz_sitting_options_check(&options->sitting, log);
	gz_err(log,
	       "--experiment: %s cannot go with it, since the file says what is shown; remove one "
	       "of them",
	       other);
	return GZ_ERR_INVAL;
}

enum gz_result gz_view_options_check(const struct gz_view_options *options,
				     const struct gz_log *log)
{
	if (options->sitting.file[0])
		return check_experiment(options, log);
	const enum gz_result r = gz_sitting_options_check(&options->sitting, log);
	if (r != GZ_OK)
		return r;
	if (options->target.targets[0])
		return check_targets(options, log);
	if (options->replay[0] && check_replay(options, log) != GZ_OK)
		return GZ_ERR_INVAL;
	if (!options->scene[0] && !options->replay[0] &&
	    (options->headless || options->write_volume[0])) {
		gz_err(log, "no scene; give one, as in: gazeview --scene head.scene (see --help)");
		return GZ_ERR_INVAL;
	}
	bool by_mouse =
		options->gaze.kind == GZ_GAZE_MOUSE || options->gaze.kind == GZ_GAZE_POINTER;
	if (options->headless && by_mouse) {
		gz_err(log,
		       "--gaze %s: there is no mouse without a window; leave out --headless, or "
		       "give X,Y",
		       options->gaze_text);
		return GZ_ERR_INVAL;
	}
	if (check_raw(options, log) != GZ_OK)
		return GZ_ERR_INVAL;
	const char *file = options->out[0]     ? "out"
			   : options->video[0] ? "video"
			   : options->stats[0] ? "stats"
					       : NULL;
	if (!options->headless && file) {
		gz_err(log, "--%s: only written without a window; add --headless", file);
		return GZ_ERR_INVAL;
	}
	/* A session hardly has but one frame. */
	const int frames = options->replay[0] ? INT_MAX : options->frames;
	return options->out[0] ? gz_pattern_check(options->out, frames, log) : GZ_OK;
}
