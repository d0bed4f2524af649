/* Prints what frames cost while values of a volume fade in and out by gaze, beside frames at rest:
 *
 *     fade_speed SCENE [--size 1280x720] [--fades 5] [--threads 0] [--backend cpu]
 *
 * A fade is 12 frames, as at 60 a second, in which the values around --value rise; then 12 in which
 * they fade; then 12 at rest. Processor time is that of all threads: it hardly depends on what else
 * runs. The first frame of a fade, which makes what the others reuse, is shown apart. The gaze is
 * in the middle. */
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "base/log.h"
#include "base/option.h"
#include "base/order.h"
#include "render/plan/method.h"
#include "render/raycast/raycast.h"
#include "render/raycast/shared/raycaster.h"
#include "render/scene/scene.h"

enum { FADES_MAX = 100, FADE_FRAMES = 12 };

/* The command line. */
struct fade_request {
	int size[2], fades, threads;
	double value;
	char backend[8];
};

#define AT(field) offsetof(struct fade_request, field)

static const struct gz_option fade_options[] = {
	{ "size", GZ_OPTION_SIZE, AT(size), 16, 8192, .preset = "1280x720",
	  .help = "of the picture" },
	{ "fades", GZ_OPTION_INT, AT(fades), 1, FADES_MAX, .preset = "5", .help = "in and out" },
	{ "threads", GZ_OPTION_INT, AT(threads), 0, 256, .preset = "0",
	  .help = "0: one for each processor" },
	{ "value", GZ_OPTION_DOUBLE, AT(value), 0, 1, .preset = "0.5",
	  .help = "of the transfer function, that stands out with all like it" },
	{ "backend", GZ_OPTION_STRING, AT(backend), 0, sizeof((struct fade_request *)0)->backend,
	  .preset = "cpu", .help = "cpu or gl" },
};

enum { FADE_OPTIONS = sizeof fade_options / sizeof fade_options[0] };

/* What is drawn, and with what. */
struct fade_stage {
	struct gz_scene scene;
	struct gz_transfer transfer; /* with emphasis */
	struct gz_raycaster *raycaster;
	struct gz_plan plan;
	struct gz_image image;
};

/* The processor times of one kind of frames. */
struct fade_times {
	const char *name;
	int count;
	double processor_ms[2 * FADES_MAX * FADE_FRAMES];
};

enum { AT_REST, FIRST_OF_FADE, FURTHER_OF_FADE, TIMES };

/* What all threads of the process have computed so far. */
static double processor_now_ms(void)
{
	struct timespec now;
	(void)clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
	return (double)now.tv_sec * 1e3 + (double)now.tv_nsec * 1e-6;
}

static enum gz_result set_up_fade(const struct fade_request *request, const char *path,
				  const struct gz_log *log, struct fade_stage *stage)
{
	const struct gz_backend_params params = { .threads = request->threads };
	const struct gz_display display = gz_display_default(request->size[0], request->size[1]);
	enum gz_result result = gz_scene_load(path, NULL, log, &stage->scene);
	if (result == GZ_OK)
		result = gz_raycaster_create(request->backend, &params, log, &stage->raycaster);
	if (result == GZ_OK)
		result = gz_raycaster_set_volume(stage->raycaster, &stage->scene.volume);
	if (result == GZ_OK)
		result = gz_plan_make(&stage->scene.settings.foveation, &display,
				      (struct gz_point) { 0.5F, 0.5F }, request->size[0],
				      request->size[1], &stage->plan);
	if (result != GZ_OK)
		return result;
	stage->transfer = stage->scene.transfer;
	gz_transfer_find_alike(&stage->scene.transfer, request->value, &stage->transfer.emphasis);
	printf("values %g to %g, %llu rays, %d step lengths\n", stage->transfer.emphasis.least,
	       stage->transfer.emphasis.greatest, (unsigned long long)stage->plan.ray_count,
	       stage->plan.step_count);
	return GZ_OK;
}

/* Draw a frame with a share of emphasis; a share below 0 leaves the function as it is. */
static enum gz_result draw_faded(struct fade_stage *stage, double share, struct fade_times *times)
{
	const double before_ms = processor_now_ms();
	enum gz_result result = GZ_OK;
	if (share >= 0) {
		stage->transfer.emphasis.share = share;
		result = gz_raycaster_set_transfer(stage->raycaster, &stage->transfer);
	}
	if (result == GZ_OK)
		result = gz_raycaster_render(stage->raycaster, &stage->scene.settings.camera,
					     &stage->scene.settings.rays, &stage->plan,
					     &stage->image, NULL);
	if (times)
		times->processor_ms[times->count++] = processor_now_ms() - before_ms;
	return result;
}

static enum gz_result draw_fade(struct fade_stage *stage, struct fade_times times[TIMES])
{
	enum gz_result result = GZ_OK;
	for (int i = 1; i <= 2 * FADE_FRAMES && result == GZ_OK; i++) {
		const int step = i <= FADE_FRAMES ? i : 2 * FADE_FRAMES - i;
		const double fade = (double)step / FADE_FRAMES;
		result = draw_faded(stage, fade * fade * (3 - 2 * fade),
				    &times[i == 1 ? FIRST_OF_FADE : FURTHER_OF_FADE]);
	}
	for (int i = 0; i < FADE_FRAMES && result == GZ_OK; i++)
		result = draw_faded(stage, -1, &times[AT_REST]);
	return result;
}

static enum gz_result draw_fades(const struct fade_request *request, struct fade_stage *stage)
{
	static struct fade_times times[TIMES] = {
		[AT_REST] = { .name = "at rest" },
		[FIRST_OF_FADE] = { .name = "first of a fade" },
		[FURTHER_OF_FADE] = { .name = "further of a fade" },
	};
	enum gz_result result = draw_faded(stage, 0, NULL);
	for (int i = 0; i < request->fades && result == GZ_OK; i++) {
		result = draw_faded(stage, 0, NULL);
		if (result == GZ_OK)
			result = draw_fade(stage, times);
	}
	for (int i = 0; i < TIMES && result == GZ_OK; i++) {
		double *all = times[i].processor_ms;
		qsort(all, (size_t)times[i].count, sizeof all[0], gz_compare_doubles);
		printf("%-20s best %6.2f ms, median %6.2f ms of the processor\n", times[i].name,
		       all[0], all[times[i].count / 2]);
	}
	return result;
}

int main(int argc, char **argv)
{
	static struct fade_request request;
	static struct fade_stage stage;
	struct gz_option_binding binding = { fade_options, FADE_OPTIONS, &request, NULL };
	struct gz_operands operands;
	struct gz_log log;
	gz_log_init(&log, NULL, NULL, "*:warn");
	enum gz_result result = gz_options_preset(&binding);
	if (result == GZ_OK)
		result = gz_options_read_arguments(&binding, 1, argc, argv, &operands, &log);
	if (result == GZ_OK && operands.count != 1) {
		fputs("fade_speed SCENE [options]\n", stderr);
		result = GZ_ERR_INVAL;
	}
	if (result == GZ_OK)
		result = set_up_fade(&request, operands.items[0], &log, &stage);
	if (result == GZ_OK)
		result = draw_fades(&request, &stage);
	gz_raycaster_destroy(&stage.raycaster);
	gz_plan_free(&stage.plan);
	gz_image_free(&stage.image);
	gz_scene_free(&stage.scene);
	if (result != GZ_OK)
		fprintf(stderr, "fade_speed: %s\n", gz_result_text(result));
	return result == GZ_OK ? EXIT_SUCCESS : EXIT_FAILURE;
}
