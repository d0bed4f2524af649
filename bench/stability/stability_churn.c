/* The row about many frames that have nothing in common. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "bench/stability/stability_bench.h"
#include "render/plan/method.h"

/* What was allocated by then stays: chosen, all methods and sizes have come by many times. */
enum { SETTLED = 500 };

static long resident_kib(void)
{
	long pages = 0, resident = 0;
	FILE *in = fopen("/proc/self/statm", "r");
	if (!in || fscanf(in, "%ld %ld", &pages, &resident) != 2)
		resident = 0;
	if (in)
		fclose(in);
	return resident * (sysconf(_SC_PAGESIZE) / 1024);
}

/* Another method, size, gaze and step rule each frame. */
static enum gz_result churn_frame(struct gz_stability_bench *bench, int frame,
				  struct gz_image *image)
{
	static const int sides[] = { 64, 33, 64, 1, 48, 7, 63 };
	const int count = sizeof sides / sizeof sides[0];
	const struct gz_stability_view view =
		gz_stability_small_view(sides[frame % count], sides[frame / 2 % count]);
	const struct gz_point gaze = { (float)(frame % 23) / 20 - 0.1F,
				       (float)(frame % 31) / 25 - 0.1F };
	struct gz_foveation foveation = gz_stability_small_foveation(bench, &view);
	foveation.method = frame % GZ_METHOD_COUNT;
	foveation.step_rule = frame / 3 % 4;
	return gz_stability_frame_at(bench, &bench->settings.scene, &foveation, &view, gaze, image);
}

enum gz_result gz_stability_churn(struct gz_stability_bench *bench,
				  struct gz_stability_outcome *outcome)
{
	const int frames = bench->settings.churn_frames;
	struct gz_foveation with_table = bench->foveation;
	struct gz_image image = { 0 };
	long settled_kib = 0;
	enum gz_result result = GZ_OK;
	for (int i = 0; i < GZ_METHOD_COUNT; i++)
		if (gz_methods[i].needs_table)
			with_table.method = i;
	gz_stability_use_method(bench, &with_table, NULL, bench->every_step_rule);
	/* Chosen: a byte more a frame would be a hundredth of it, a leaked picture a hundred times
	 * as much. */
	gz_stability_name(outcome, 0, "KiB of memory more than at the start", 512);
	for (int frame = 0; frame < frames && result == GZ_OK; frame++) {
		result = churn_frame(bench, frame, &image);
		if (frame == SETTLED)
			settled_kib = resident_kib();
	}
	gz_image_free(&image);
	if (result != GZ_OK)
		return result;
	return gz_stability_take(outcome, 0, (double)(resident_kib() - settled_kib),
				 (struct gz_stability_place) { 0 }, "%d frames of all methods",
				 frames);
}
