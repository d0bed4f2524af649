/* Draws a scene's surfaces as an illustration by rays, writes it, and prints how long frames take:
 *
 *     illustration_picture SCENE --out FILE.png [--template NAME.template] [--size 1920x1080]
 *         [--runs 9] [--threads 0] [--full] [--illustration.KEY VALUE] [--shading_map.KEY VALUE]
 *
 * A template sets combined settings, then come those of the command line; single settings that are
 * given replace what the combined ones made. The gaze is in the middle; --full casts every pixel.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/log.h"
#include "base/option.h"
#include "base/order.h"
#include "base/sizes.h"
#include "render/illustration/cpu/illustrate_caster.h"
#include "render/illustration/shading_template.h"
#include "render/plan/method.h"
#include "render/scene/scene.h"

enum { RUNS_MAX = 1000, SINGLE_MAX = 32 };

/* The command line. */
struct picture_request {
	char out[GZ_PATH_SIZE], shading_template[GZ_PATH_SIZE];
	int size[2], runs, threads;
	bool full;
	struct gz_illustration_settings combined;
	struct gz_shading_settings single;
	bool given[SINGLE_MAX]; /* of the single settings */
};

#define AT(field) offsetof(struct picture_request, field)

static const struct gz_option request_options[] = {
	{ "out", GZ_OPTION_STRING, AT(out), .max = GZ_PATH_SIZE, .preset = "",
	  .help = "PNG to write" },
	{ "template", GZ_OPTION_STRING, AT(shading_template), .max = GZ_PATH_SIZE, .preset = "",
	  .help = "template of combined settings" },
	{ "size", GZ_OPTION_SIZE, AT(size), 16, 8192, .preset = "1920x1080",
	  .help = "of the picture" },
	{ "runs", GZ_OPTION_INT, AT(runs), 1, RUNS_MAX, .preset = "9", .help = "frames" },
	{ "threads", GZ_OPTION_INT, AT(threads), 0, 256, .preset = "0",
	  .help = "0: one for each processor" },
	{ "full", GZ_OPTION_BOOL, AT(full), .preset = "no", .help = "cast every pixel" },
};

/* What is drawn, and with what. */
struct picture_stage {
	struct gz_scene scene;
	struct gz_object objects[GZ_SCENE_LISTED_MAX];
	size_t count;
	struct gz_illustration_look look;
	struct gz_illustrate_caster *caster;
	struct gz_plan plan;
	struct gz_image image;
};

static enum gz_result read_request(int argc, char **argv, const struct gz_log *log,
				   struct picture_request *request, struct gz_operands *operands)
{
	struct gz_option_binding bindings[] = {
		{ request_options, sizeof request_options / sizeof request_options[0], request,
		  NULL },
		{ gz_illustration_options, gz_illustration_option_count, &request->combined, NULL },
		{ gz_shading_options, gz_shading_option_count, &request->single, request->given },
	};
	struct gz_shading_template read;
	enum gz_result result = GZ_OK;
	for (size_t i = 0; i < 3 && result == GZ_OK; i++)
		result = gz_options_preset(&bindings[i]);
	if (result == GZ_OK)
		result = gz_options_read_arguments(bindings, 3, argc, argv, operands, log);
	if (result != GZ_OK || !request->shading_template[0])
		return result;
	result = gz_shading_template_read(request->shading_template, log, &read);
	if (result != GZ_OK)
		return result;
	gz_shading_template_apply(&read, &request->combined);
	return gz_options_read_arguments(bindings, 3, argc, argv, operands, log);
}

/* The single settings: what the combined ones make, and what was given. */
static enum gz_result resolve_settings(const struct picture_request *request,
				       struct gz_shading_settings *out_settings)
{
	const struct gz_option_binding binding = { gz_shading_options, gz_shading_option_count,
						   out_settings, NULL };
	char text[GZ_OPTION_TEXT_SIZE];
	enum gz_result result = gz_options_preset(&binding);
	gz_illustration_apply(&request->combined, out_settings);
	for (size_t i = 0; i < gz_shading_option_count && result == GZ_OK; i++) {
		const struct gz_option *option = &gz_shading_options[i];
		if (!request->given[i])
			continue;
		result = gz_option_format(option, &request->single, text, sizeof text);
		if (result == GZ_OK)
			result = gz_option_parse(option, text, out_settings, NULL, 0);
	}
	return result;
}

static enum gz_result set_up_stage(const struct picture_request *request, const char *path,
				   const struct gz_log *log, struct picture_stage *stage)
{
	const struct gz_backend_params params = { .threads = request->threads,
						  .wait_for_bricks = true };
	enum gz_result result = gz_scene_load(path, NULL, log, &stage->scene);
	if (result == GZ_OK)
		result = resolve_settings(request, &stage->look.single);
	stage->look.source = GZ_ILLUSTRATION_SINGLE;
	stage->look.pen_width = 2; /* no marks are drawn, but it has to be in range */
	if (result == GZ_OK)
		result = gz_illustrate_caster_create(&params, log, &stage->caster);
	if (result != GZ_OK)
		return result;
	stage->count = gz_scene_list_objects(&stage->scene, stage->objects, GZ_SCENE_LISTED_MAX);
	result = gz_illustrate_caster_show(stage->caster, stage->objects, stage->count);
	struct gz_foveation foveation = stage->scene.settings.foveation;
	if (request->full)
		foveation.method = gz_method_full();
	const struct gz_display display = gz_display_default(request->size[0], request->size[1]);
	if (result == GZ_OK)
		result = gz_plan_make(&foveation, &display, (struct gz_point) { 0.5F, 0.5F },
				      request->size[0], request->size[1], &stage->plan);
	return result;
}

static enum gz_result draw_runs(const struct picture_request *request, struct picture_stage *stage)
{
	const struct gz_illustrate_shot shot = {
		.camera = &stage->scene.settings.camera,
		.plan = &stage->plan,
		.look = &stage->look,
		.isovalue = stage->scene.settings.rays.surface.isovalue,
	};
	struct gz_frame_stats stats = { 0 };
	double took_ms[RUNS_MAX];
	enum gz_result result =
		gz_illustrate_caster_draw(stage->caster, &shot, &stage->image, NULL, &stats);
	printf("prepared in %.0f ms, %s\n", stats.prepare_ms,
	       gz_illustrate_caster_describe(stage->caster));
	for (int run = 0; run < request->runs && result == GZ_OK; run++) {
		const int64_t start_ns = gz_clock_now_ns();
		result = gz_illustrate_caster_draw(stage->caster, &shot, &stage->image, NULL,
						   &stats);
		took_ms[run] = gz_ns_to_ms(gz_clock_now_ns() - start_ns);
	}
	if (result != GZ_OK)
		return result;
	qsort(took_ms, (size_t)request->runs, sizeof took_ms[0], gz_compare_doubles);
	printf("%dx%d, %llu rays: best_ms %.2f median_ms %.2f, last: cast_ms %.2f rest_ms %.2f\n",
	       request->size[0], request->size[1], (unsigned long long)stats.rays, took_ms[0],
	       took_ms[request->runs / 2], stats.cast_ms, stats.reconstruct_ms);
	return GZ_OK;
}

int main(int argc, char **argv)
{
	static struct picture_request request;
	static struct picture_stage stage;
	struct gz_operands operands;
	struct gz_log log;
	gz_log_init(&log, NULL, NULL, "*:warn");
	enum gz_result result = read_request(argc, argv, &log, &request, &operands);
	if (result == GZ_OK && (operands.count != 1 || !request.out[0])) {
		fputs("illustration_picture SCENE --out FILE.png [options]\n", stderr);
		result = GZ_ERR_INVAL;
	}
	if (result == GZ_OK)
		result = set_up_stage(&request, operands.items[0], &log, &stage);
	if (result == GZ_OK)
		result = draw_runs(&request, &stage);
	if (result == GZ_OK)
		result = gz_image_write_png(&stage.image, request.out, &log);
	gz_illustrate_caster_destroy(&stage.caster);
	gz_plan_free(&stage.plan);
	gz_image_free(&stage.image);
	gz_scene_free(&stage.scene);
	if (result != GZ_OK)
		fprintf(stderr, "illustration_picture: %s\n", gz_result_text(result));
	return result == GZ_OK ? EXIT_SUCCESS : EXIT_FAILURE;
}
