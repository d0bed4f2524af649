/* Prints how long volumes take to load: volume_load SCENE... The best and the median of a few runs
 * of each, with the files in the page cache. */
#include <stdio.h>
#include <stdlib.h>

#include "base/clock.h"
#include "base/log.h"
#include "base/order.h"
#include "render/scene/scene.h"

enum { RUNS = 7 };

static int measure_load_times(const char *path, const struct gz_log *log)
{
	double took_ms[RUNS];
	double mib = 0;
	for (int run = -1; run < RUNS; run++) {
		struct gz_scene scene;
		const int64_t start_ns = gz_clock_now_ns();
		if (gz_scene_load(path, NULL, log, &scene) != GZ_OK)
			return EXIT_FAILURE;
		if (run >= 0) /* the first one reads the disk */
			took_ms[run] = gz_ns_to_ms(gz_clock_now_ns() - start_ns);
		mib = (double)gz_volume_voxel_count(&scene.volume) *
		      (double)gz_voxel_size(scene.volume.type) / (1 << 20);
		gz_scene_free(&scene);
	}
	qsort(took_ms, RUNS, sizeof took_ms[0], gz_compare_doubles);
	printf("%-32s %7.0f MiB  best %7.1f ms  median %7.1f ms\n", path, mib, took_ms[0],
	       took_ms[RUNS / 2]);
	return EXIT_SUCCESS;
}

int main(int argc, char **argv)
{
	struct gz_log log;
	gz_log_init(&log, NULL, NULL, "*:warn");
	if (argc < 2) {
		fputs("volume_load SCENE...\n", stderr);
		return EXIT_FAILURE;
	}
	for (int i = 1; i < argc; i++)
		if (measure_load_times(argv[i], &log) != EXIT_SUCCESS)
			return EXIT_FAILURE;
	return EXIT_SUCCESS;
}
