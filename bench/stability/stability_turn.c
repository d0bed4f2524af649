/* Rows about a camera that turns while the gaze rests. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bench/metrics/temporal.h"
#include "bench/stability/stability_bench.h"
#include "render/plan/method.h"

/* Degrees a frame, at 60 frames a second: as bench/study/run.c measures. */
#define TURN_DEG 0.25
#define TURN_FPS 60

/* Chosen: as much as any change elsewhere, and what a frame may be worse by chance. */
#define TURN_MOST 0.5
#define KEPT_MOST 1.01

/* Frames of a turn with a history. Chosen: some have one of four frames and more. */
enum { KEPT_FRAMES = 12 };

static const struct gz_point turned_gaze = { 0.45F, 0.5F };

/* A turn, frame by frame. */
struct turn {
	struct gz_stability_scene scene; /* with the camera of the current frame */
	struct gz_stability_view view;
	struct gz_foveation foveation;
	struct gz_foveation standard;
	const struct gz_temporal_params *temporal; /* NULL: frames stand alone */
	struct gz_image standards[KEPT_FRAMES], frame;
};

static void begin_turn(const struct gz_stability_bench *bench, struct turn *turn)
{
	*turn = (struct turn) { .scene = bench->settings.scene,
				.view = gz_stability_scene_view(bench),
				.foveation = bench->foveation,
				.standard = gz_foveation_full() };
}

static void end_turn(struct turn *turn)
{
	for (int i = 0; i < KEPT_FRAMES; i++)
		gz_image_free(&turn->standards[i]);
	gz_image_free(&turn->frame);
}

static enum gz_result turned_frame(struct gz_stability_bench *bench, const struct turn *turn,
				   const struct gz_foveation *foveation, struct gz_image *image)
{
	const struct gz_stability_shot shot = { foveation, &turn->view, gz_focus_at(turned_gaze),
						turn->temporal };
	return gz_stability_frame(bench, &turn->scene, &shot, image);
}

/* ---- what comes and goes ---- */

/* Responses of the eye's transient channel to a method and to standard. */
struct responses {
	struct gz_map of[2], weights;
	uint8_t *fovea;
};

static enum gz_result begin_responses(const struct turn *turn, struct responses *responses)
{
	const int width = turn->view.width, height = turn->view.height;
	const size_t pixels = (size_t)width * (size_t)height;
	enum gz_result result = gz_weights_acuity(&turn->view.display, turned_gaze, width, height,
						  &responses->weights);
	for (int i = 0; i < 2 && result == GZ_OK; i++) {
		result = gz_map_resize(&responses->of[i], width, height);
		if (result == GZ_OK)
			memset(responses->of[i].values, 0,
			       pixels * sizeof *responses->of[i].values);
	}
	responses->fovea = malloc(pixels);
	if (result == GZ_OK && !responses->fovea)
		result = GZ_ERR_NO_MEM;
	if (result == GZ_OK)
		gz_stability_mark_fovea(&turn->foveation, &turn->view, turned_gaze, false,
					responses->fovea);
	return result;
}

static void end_responses(struct responses *responses)
{
	gz_map_free(&responses->of[0]);
	gz_map_free(&responses->of[1]);
	gz_map_free(&responses->weights);
	free(responses->fovea);
}

/* The fovea of a frame against standard's. */
static enum gz_result take_fovea(const struct turn *turn, const struct responses *responses,
				 int frame, struct gz_stability_outcome *outcome)
{
	const size_t pixels = (size_t)turn->view.width * (size_t)turn->view.height;
	size_t worst = 0;
	int most = 0;
	if (!gz_method_of(&turn->foveation)->sharp_at_gaze)
		return GZ_OK; /* it promises no sharp pixel */
	for (size_t i = 0; i < pixels; i++) {
		const int apart = responses->fovea[i]
					  ? gz_stability_apart(&turn->frame, &turn->standards[0], i)
					  : 0;
		if (apart > most) {
			most = apart;
			worst = i;
		}
	}
	return gz_stability_take(
		outcome, 0, most,
		(struct gz_stability_place) { &turn->frame, &turn->standards[0], worst },
		"frame %d of a turn, steps by %s", frame,
		gz_step_rule_names[turn->foveation.step_rule]);
}

static enum gz_result respond(struct gz_stability_bench *bench, struct turn *turn,
			      struct responses *responses, struct gz_stability_outcome *outcome)
{
	double weights[GZ_TEMPORAL_FRAMES];
	enum gz_result result = GZ_OK;
	gz_temporal_weights(TURN_FPS, weights);
	for (int i = 0; i < GZ_TEMPORAL_FRAMES && result == GZ_OK; i++) {
		result = turned_frame(bench, turn, &turn->standard, &turn->standards[0]);
		if (result == GZ_OK)
			result = turned_frame(bench, turn, &turn->foveation, &turn->frame);
		if (result != GZ_OK)
			return result;
		gz_map_add_luma(&responses->of[0], &turn->standards[0], weights[i]);
		gz_map_add_luma(&responses->of[1], &turn->frame, weights[i]);
		result = take_fovea(turn, responses, i, outcome);
		gz_camera_turn(&turn->scene.camera, TURN_DEG);
	}
	const double seen = gz_map_weighted_difference(&responses->of[1], &responses->of[0],
						       &responses->weights);
	return result != GZ_OK ? result
			       : gz_stability_take(outcome, 1, seen,
						   (struct gz_stability_place) { NULL, NULL, 0 },
						   "steps by %s",
						   gz_step_rule_names[turn->foveation.step_rule]);
}

enum gz_result gz_stability_turn(struct gz_stability_bench *bench,
				 struct gz_stability_outcome *outcome)
{
	int rules[GZ_STABILITY_RULES_MAX];
	const int count = gz_stability_rules(bench, rules);
	enum gz_result result = GZ_OK;
	gz_stability_name(outcome, 0, "greatest difference from standard in the fovea, grey levels",
			  0);
	gz_stability_name(outcome, 1,
			  "what the eye sees come and go that does not in standard, grey levels",
			  TURN_MOST);
	for (int i = 0; i < count && result == GZ_OK; i++) {
		struct turn turn;
		struct responses responses = { 0 };
		begin_turn(bench, &turn);
		turn.foveation.step_rule = rules[i];
		result = begin_responses(&turn, &responses);
		if (result == GZ_OK)
			result = respond(bench, &turn, &responses, outcome);
		end_responses(&responses);
		end_turn(&turn);
	}
	return result;
}

/* ---- earlier frames ---- */

/* Root of the mean squared difference of a frame from standard's, grey levels. */
static double frame_error(const struct gz_image *frame, const struct gz_image *standard)
{
	const size_t bytes = (size_t)frame->width * (size_t)frame->height * 4;
	double sum = 0;
	for (size_t i = 0; i < bytes; i++) {
		const int apart = frame->pixels[i] - standard->pixels[i];
		sum += apart * apart;
	}
	return sqrt(sum / (3.0 / 4 * (double)bytes));
}

/* The errors of each frame of a turn. */
static enum gz_result measure_turn(struct gz_stability_bench *bench, struct turn *turn,
				   double out_errors[KEPT_FRAMES])
{
	enum gz_result result = GZ_OK;
	turn->scene.camera = bench->settings.scene.camera;
	for (int i = 0; i < KEPT_FRAMES && result == GZ_OK; i++) {
		gz_camera_turn(&turn->scene.camera, TURN_DEG);
		result = turned_frame(bench, turn, &turn->foveation, &turn->frame);
		if (result == GZ_OK)
			out_errors[i] = frame_error(&turn->frame, &turn->standards[i]);
	}
	return result;
}

static enum gz_result draw_standards(struct gz_stability_bench *bench, struct turn *turn)
{
	enum gz_result result = GZ_OK;
	for (int i = 0; i < KEPT_FRAMES && result == GZ_OK; i++) {
		gz_camera_turn(&turn->scene.camera, TURN_DEG);
		result = turned_frame(bench, turn, &turn->standard, &turn->standards[i]);
	}
	return result;
}

/* Errors of each frame: with earlier ones, of the same rays without, and without accumulation. */
struct turn_errors {
	double kept[KEPT_FRAMES], bare[KEPT_FRAMES], alone[KEPT_FRAMES];
};

static enum gz_result measure_turns(struct gz_stability_bench *bench, struct turn *turn,
				    struct turn_errors *errors)
{
	struct gz_temporal_params keeps = gz_temporal_default(), bares = keeps;
	keeps.accumulate = bares.accumulate = true;
	bares.weight = 0;
	enum gz_result result = draw_standards(bench, turn);
	if (result == GZ_OK)
		result = measure_turn(bench, turn, errors->alone);
	turn->temporal = &bares;
	if (result == GZ_OK)
		result = measure_turn(bench, turn, errors->bare);
	turn->temporal = NULL; /* another frame drops the history */
	if (result == GZ_OK)
		result = turned_frame(bench, turn, &turn->foveation, &turn->frame);
	turn->temporal = &keeps;
	if (result == GZ_OK)
		result = measure_turn(bench, turn, errors->kept);
	turn->temporal = NULL;
	return result;
}

/* Of two errors. gl rounds the rays of a shifted lattice otherwise, by a level here and there: so
 * much is none. */
static double share_of(double part, double whole)
{
	static const double rounding = 0.05;
	return part <= rounding ? 0 : whole > 0 ? part / whole : INFINITY;
}

static enum gz_result take_shares(const struct turn_errors *errors,
				  struct gz_stability_outcome *outcome)
{
	const struct gz_stability_place nowhere = { NULL, NULL, 0 };
	double kept = 0, alone = 0;
	enum gz_result result = GZ_OK;
	for (int i = 0; i < KEPT_FRAMES && result == GZ_OK; i++) {
		kept += errors->kept[i] / KEPT_FRAMES;
		alone += errors->alone[i] / KEPT_FRAMES;
		result = gz_stability_take(outcome, 0, share_of(errors->kept[i], errors->bare[i]),
					   nowhere, "frame %d of a turn", i);
	}
	return result == GZ_OK ? gz_stability_take(outcome, 1, share_of(kept, alone), nowhere,
						   "%.3g and %.3g levels", kept, alone)
			       : result;
}

enum gz_result gz_stability_kept(struct gz_stability_bench *bench,
				 struct gz_stability_outcome *outcome)
{
	struct turn_errors errors = { 0 };
	struct turn turn;
	gz_stability_name(outcome, 0,
			  "a frame's error with earlier ones, times that of its rays alone",
			  KEPT_MOST);
	gz_stability_name(outcome, 1, "mean error, times that without accumulation", 1);
	begin_turn(bench, &turn);
	enum gz_result result = measure_turns(bench, &turn, &errors);
	if (result == GZ_OK)
		result = take_shares(&errors, outcome);
	end_turn(&turn);
	return result;
}
