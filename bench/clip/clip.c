#include "bench/clip/clip.h"

#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/command.h"
#include "base/order.h"
#include "base/text.h"
#include "bench/study/camera_path.h"
#include "bench/study/errors.h"
#include "bench/study/stage.h"

#define GZ_LOG_MODULE "clip"

/* Frames of a camera that turns. Chosen: .4 s at 60 a second, more than the quarter of a second
 * over which metrics look at changes. */
#define FRAMES_DEFAULT 24

/* Bytes of a sequence's name, and how many of its method are kept. Chosen: well below what file
 * systems take. */
enum { SEQUENCE_NAME_SIZE = 120, METHOD_BYTES = 92 };

/* Pictures of one kind. */
struct sequence {
	char folder[SEQUENCE_NAME_SIZE]; /* in the clip's */
	struct gz_variant_settings settings;
	struct gz_picture_maker *own_maker; /* NULL: pictures do not depend on earlier ones */
	struct gz_plan plan;
	double *frame_ms;
};

/* A clip in the making. Sequence i is variant i of the study; 0 is the reference. */
struct clip {
	const struct gz_clip_request *request;
	const struct gz_log *log;
	const char *folder;
	struct gz_study study;
	struct gz_stage stage;
	struct gz_camera_path cameras; /* empty: the camera turns */
	struct gz_camera camera;
	struct gz_display display;
	int frames;
	struct sequence *sequences;
	struct gz_image image;
	json_t *gaze_json, *cameras_json; /* by frame */
};

/* ---- what is asked ---- */

/* Only one of each: sequences of one clip differ by their method alone. */
static enum gz_result check_counts(const struct clip *clip)
{
	const struct gz_study *study = &clip->study;
	if (clip->request->study.scene_count == 1 && study->size_count == 1 &&
	    study->backend_count == 1)
		return GZ_OK;
	gz_err(clip->log, "a clip is of one scene, of one size, by one backend");
	return GZ_ERR_INVAL;
}

static enum gz_result find_frames(struct clip *clip)
{
	const struct gz_clip_request *request = clip->request;
	const int recorded = (int)clip->cameras.count;
	clip->frames = request->frames > 0    ? request->frames
		       : request->camera_path ? recorded
					      : FRAMES_DEFAULT;
	if (request->camera_path && clip->frames > recorded) {
		gz_err(clip->log, "%s has %d cameras, fewer than the %d frames asked for",
		       request->camera_path, recorded, clip->frames);
		return GZ_ERR_INVAL;
	}
	if (clip->frames <= GZ_CLIP_FRAMES_MAX)
		return GZ_OK;
	gz_err(clip->log, "%d frames: a clip has at most %d; take some by --frames", clip->frames,
	       GZ_CLIP_FRAMES_MAX);
	return GZ_ERR_INVAL;
}

static enum gz_result ask_clip(struct clip *clip)
{
	enum gz_result result =
		gz_study_ask(&clip->request->study, &clip->stage, clip->log, &clip->study);
	if (result == GZ_OK)
		result = check_counts(clip);
	if (result == GZ_OK)
		result =
			gz_stage_enter(&clip->stage, &clip->study, 0, clip->study.machine.backends);
	if (result != GZ_OK)
		return result;
	if (clip->stage.scene.volume.bricks) {
		gz_err(clip->log,
		       "%s: a file of bricks cannot be a clip, because it changes while it is "
		       "shown; use the volume itself",
		       clip->study.scenes[0].path);
		return GZ_ERR_UNSUPPORTED;
	}
	clip->camera = gz_study_camera(&clip->study, 0, 0);
	clip->display = gz_study_display(&clip->study, 0, 0);
	if (clip->request->camera_path)
		result = gz_camera_path_read(clip->request->camera_path, &clip->camera, clip->log,
					     &clip->cameras);
	return result == GZ_OK ? find_frames(clip) : result;
}

/* ---- folders ---- */

static enum gz_result refuse_folder(const struct clip *clip, const char *path, const char *why)
{
	gz_err(clip->log, "%s: %s", path, why);
	return GZ_ERR_IO;
}

static enum gz_result make_empty_folder(const struct clip *clip, const char *path)
{
	if (mkdir(path, 0777) == 0)
		return GZ_OK;
	if (errno != EEXIST)
		return refuse_folder(clip, path, strerror(errno));
	DIR *folder = opendir(path);
	if (!folder)
		return refuse_folder(clip, path, strerror(errno));
	bool empty = true;
	for (const struct dirent *entry; empty && (entry = readdir(folder));)
		empty = strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0;
	closedir(folder);
	return empty ? GZ_OK : refuse_folder(clip, path, "not empty; name a new folder by --out");
}

/* "2-acuity-acuity_slope-0.0275": what any file system takes. */
static void name_sequence(size_t number, const char *variant, char out_name[SEQUENCE_NAME_SIZE])
{
	if (number == 0)
		snprintf(out_name, SEQUENCE_NAME_SIZE, "reference");
	else
		snprintf(out_name, SEQUENCE_NAME_SIZE, "%zu-%.*s", number, METHOD_BYTES, variant);
	for (char *c = out_name; *c; c++)
		if (!isalnum((unsigned char)*c) && *c != '.' && *c != '_')
			*c = '-';
}

static enum gz_result start_sequence(struct clip *clip, size_t number)
{
	struct sequence *sequence = &clip->sequences[number];
	char path[GZ_PATH_SIZE + SEQUENCE_NAME_SIZE];
	name_sequence(number, clip->study.variants[number].text, sequence->folder);
	sequence->settings = clip->stage.variants[number];
	if (number == 0 && clip->request->converged) {
		sequence->settings.foveation = gz_foveation_full();
		sequence->settings.foveation.step_rule = GZ_STEP_NONE;
		sequence->settings.rays =
			gz_reference_rays(&clip->stage.scene.settings.rays, GZ_REFERENCE_RATE);
	}
	sequence->frame_ms = calloc((size_t)clip->frames, sizeof *sequence->frame_ms);
	if (!sequence->frame_ms)
		return GZ_ERR_NO_MEM;
	snprintf(path, sizeof path, "%s/%s", clip->folder, sequence->folder);
	if (mkdir(path, 0777) != 0)
		return refuse_folder(clip, path, strerror(errno));
	/* Its plans grow while only the gaze changes, so no other picture may come between. */
	const struct gz_foveation *foveation = &sequence->settings.foveation;
	return foveation->still_growth > 0 && gz_plan_can_grow(foveation)
		       ? gz_stage_open_maker(&clip->stage, 0, &sequence->own_maker)
		       : GZ_OK;
}

static enum gz_result start_sequences(struct clip *clip)
{
	enum gz_result result = make_empty_folder(clip, clip->folder);
	clip->sequences = calloc(clip->study.variant_count, sizeof *clip->sequences);
	if (!clip->sequences)
		return GZ_ERR_NO_MEM;
	for (size_t i = 0; i < clip->study.variant_count && result == GZ_OK; i++)
		result = start_sequence(clip, i);
	return result;
}

/* ---- frames ---- */

static struct gz_point clip_gaze(const struct clip *clip, int frame)
{
	const size_t last = clip->study.point_count - 1;
	return clip->study.points[(size_t)frame < last ? (size_t)frame : last].gaze;
}

static enum gz_result write_frame(struct clip *clip, struct sequence *sequence, int frame)
{
	const struct gz_temporal_params keeps = { .keep_rays = true };
	const struct gz_picture_request request = {
		.camera = &clip->camera,
		.settings = &sequence->settings.rays,
		.foveation = &sequence->settings.foveation,
		.display = &clip->display,
		.focus = gz_focus_at(clip_gaze(clip, frame)),
		.width = clip->study.sizes[0][0],
		.height = clip->study.sizes[0][1],
		.temporal = sequence->own_maker ? &keeps : NULL,
		.fresh_plan = gz_foveation_follows_gaze(&sequence->settings.foveation),
		.plan = &sequence->plan,
		.image = &clip->image,
	};
	struct gz_image *image;
	struct gz_picture_cost cost;
	char path[GZ_PATH_SIZE + SEQUENCE_NAME_SIZE + 32];
	if (gz_command_interrupted())
		return GZ_ERR_CANCELLED;
	struct gz_picture_maker *maker =
		sequence->own_maker ? sequence->own_maker : clip->stage.backends[0];
	const enum gz_result result = gz_picture_make(maker, &request, &image, &cost);
	if (result != GZ_OK)
		return result;
	sequence->frame_ms[frame] = cost.total_ms;
	snprintf(path, sizeof path, "%s/%s/frame-%04d.png", clip->folder, sequence->folder, frame);
	return gz_image_write_png(image, path, clip->log);
}

static json_t *vector_json(const double v[3])
{
	return json_pack("[fff]", v[0], v[1], v[2]);
}

/* What clip.json says of a frame. Pixels: the centre of the first one is at (1/2, 1/2). */
static void note_frame(struct clip *clip, int frame)
{
	const struct gz_point gaze = clip_gaze(clip, frame);
	const struct gz_camera *camera = &clip->camera;
	json_array_append_new(clip->gaze_json,
			      json_pack("[ff]", (double)gaze.x * clip->study.sizes[0][0],
					(double)gaze.y * clip->study.sizes[0][1]));
	const bool flat = camera->projection == GZ_PROJECTION_ORTHOGRAPHIC;
	json_array_append_new(clip->cameras_json,
			      json_pack("{so so so sf}", "eye", vector_json(camera->eye), "look_at",
					vector_json(camera->look_at), "up", vector_json(camera->up),
					flat ? "height" : "fov_deg",
					flat ? camera->height : camera->fov_deg));
}

/* All sequences take turns, so that their times are of one run. */
static enum gz_result write_frames(struct clip *clip)
{
	enum gz_result result = GZ_OK;
	for (int frame = 0; frame < clip->frames && result == GZ_OK; frame++) {
		if (clip->request->camera_path)
			clip->camera = clip->cameras.cameras[frame];
		else if (frame > 0)
			gz_camera_turn(&clip->camera, clip->request->turn_deg);
		for (size_t i = 0; i < clip->study.variant_count && result == GZ_OK; i++)
			result = write_frame(clip, &clip->sequences[i], frame);
		note_frame(clip, frame);
	}
	return result;
}

/* ---- clip.json ---- */

/* The first frame prepares what later ones keep, so it does not count if there are others. */
static double median_ms(const struct clip *clip, struct sequence *sequence)
{
	double *times = sequence->frame_ms + (clip->frames > 1);
	const int count = clip->frames - (clip->frames > 1);
	qsort(times, (size_t)count, sizeof *times, gz_compare_doubles);
	return (times[(count - 1) / 2] + times[count / 2]) / 2;
}

static json_t *sequence_json(struct clip *clip, size_t number)
{
	struct sequence *sequence = &clip->sequences[number];
	const bool converged = number == 0 && clip->request->converged;
	return json_pack("{ss ss sb sf}", "folder", sequence->folder, "variant",
			 converged ? "converged" : clip->study.variants[number].text, "keeps_rays",
			 sequence->own_maker != NULL, "frame_ms", median_ms(clip, sequence));
}

static json_t *clip_json(struct clip *clip)
{
	const struct gz_study *study = &clip->study;
	json_t *tests = json_array();
	for (size_t i = 1; i < study->variant_count; i++)
		json_array_append_new(tests, sequence_json(clip, i));
	return json_pack("{ss si ss ss ss ss ss s[ii] si sf s{s[ff] sf} ss so so sO sO}", "format",
			 "gazecast clip", "version", 1, "scene", study->scenes[0].name, "transfer",
			 study->scenes[0].transfer, "program", study->machine.program, "commit",
			 study->machine.commit, "backend", study->machine.backends[0], "size",
			 study->sizes[0][0], study->sizes[0][1], "frames", clip->frames, "fps",
			 clip->request->fps, "display", "mm", clip->display.mm[0],
			 clip->display.mm[1], "distance_mm", clip->display.distance_mm, "pictures",
			 "frame-%04d.png", "reference", sequence_json(clip, 0), "tests", tests,
			 "gaze_px", clip->gaze_json, "cameras", clip->cameras_json);
}

static enum gz_result write_description(struct clip *clip)
{
	char path[GZ_PATH_SIZE + 16];
	snprintf(path, sizeof path, "%s/clip.json", clip->folder);
	json_t *json = clip_json(clip);
	char *dump = json ? json_dumps(json, JSON_INDENT(1) | JSON_REAL_PRECISION(12)) : NULL;
	struct gz_text text = { 0 };
	if (dump)
		gz_text_add(&text, "%s\n", dump);
	const enum gz_result result =
		!dump || text.failed ? GZ_ERR_NO_MEM : gz_text_write(&text, path, clip->log);
	free(dump);
	gz_text_free(&text);
	json_decref(json);
	return result;
}

static void free_clip(struct clip *clip)
{
	for (size_t i = 0; clip->sequences && i < clip->study.variant_count; i++) {
		gz_picture_maker_destroy(&clip->sequences[i].own_maker);
		gz_plan_free(&clip->sequences[i].plan);
		free(clip->sequences[i].frame_ms);
	}
	free(clip->sequences);
	json_decref(clip->gaze_json);
	json_decref(clip->cameras_json);
	gz_image_free(&clip->image);
	gz_camera_path_free(&clip->cameras);
	gz_stage_free(&clip->stage);
	gz_study_free(&clip->study);
}

static void tell_outcome(const struct clip *clip, struct gz_clip_outcome *out_outcome)
{
	const size_t tests = clip->study.variant_count - 1;
	*out_outcome = (struct gz_clip_outcome) {
		.frames = clip->frames,
		.tests = tests,
		.px_per_deg = gz_display_px_per_deg(&clip->display),
	};
	if (tests > 0)
		snprintf(out_outcome->first_test, sizeof out_outcome->first_test, "%s",
			 clip->sequences[1].folder);
}

enum gz_result gz_clip_write(const struct gz_clip_request *request, const char *folder,
			     const struct gz_log *log, struct gz_clip_outcome *out_outcome)
{
	struct clip clip = { .request = request,
			     .log = log,
			     .folder = folder,
			     .stage = { .log = log },
			     .gaze_json = json_array(),
			     .cameras_json = json_array() };
	enum gz_result result = ask_clip(&clip);
	if (result == GZ_OK)
		result = start_sequences(&clip);
	if (result == GZ_OK)
		result = write_frames(&clip);
	if (result == GZ_OK)
		result = write_description(&clip);
	if (result == GZ_OK)
		tell_outcome(&clip, out_outcome);
	else if (result == GZ_ERR_NO_MEM)
		gz_err(log, "no memory for a clip of %d frames", clip.frames);
	free_clip(&clip);
	return gz_command_interrupted() && result != GZ_OK ? GZ_ERR_CANCELLED : result;
}
