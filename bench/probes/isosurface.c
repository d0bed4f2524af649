/* Prints how long the surface of a volume takes: isosurface VOLUME ISOVALUE [THREADS [RUNS]]. The
 * best and the median of several runs, without and with the ranges of macrocells, and how large the
 * mesh is. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/log.h"
#include "base/order.h"
#include "base/text.h"
#include "base/workers.h"
#include "render/mesh/isosurface.h"
#include "render/raycast/shared/macrocells.h"

enum { RUNS = 9, RUNS_MAX = 1000 };

static enum gz_result measure_surface(const struct gz_isosurface_request *request,
				      struct gz_workers *workers, int runs,
				      const struct gz_log *log)
{
	double took_ms[RUNS_MAX] = { 0 };
	size_t triangles = 0, vertices = 0;
	for (int run = -1; run < runs; run++) { /* the first one warms up */
		struct gz_mesh mesh;
		const int64_t start_ns = gz_clock_now_ns();
		const enum gz_result result = gz_isosurface_make(request, workers, log, &mesh);
		if (result != GZ_OK)
			return result;
		if (run >= 0)
			took_ms[run] = gz_ns_to_ms(gz_clock_now_ns() - start_ns);
		triangles = mesh.triangle_count;
		vertices = mesh.vertex_count;
		gz_mesh_free(&mesh);
	}
	qsort(took_ms, (size_t)runs, sizeof took_ms[0], gz_compare_doubles);
	printf("%s best_ms %.3f median_ms %.3f triangles %zu vertices %zu\n",
	       request->blocks ? "blocks" : "plain", took_ms[0], took_ms[runs / 2], triangles,
	       vertices);
	return GZ_OK;
}

static enum gz_result measure_volume(const struct gz_volume *volume, double isovalue, int threads,
				     int runs, const struct gz_log *log)
{
	struct gz_workers *workers = NULL;
	struct gz_macrocells cells = { 0 };
	struct gz_isosurface_request request = { .volume = volume, .isovalue = isovalue };
	enum gz_result result = gz_workers_create(threads, &workers);
	if (result == GZ_OK)
		result = measure_surface(&request, workers, runs, log);
	if (result == GZ_OK)
		result = gz_macrocells_build(volume, &cells);
	if (result == GZ_OK) {
		struct gz_value_blocks blocks = { .edge = GZ_MACROCELL_EDGE,
						  .least = cells.least,
						  .greatest = cells.greatest };
		memcpy(blocks.dims, cells.dims, sizeof blocks.dims);
		request.blocks = &blocks;
		result = measure_surface(&request, workers, runs, log);
	}
	gz_macrocells_free(&cells);
	gz_workers_destroy(&workers);
	return result;
}

int main(int argc, char **argv)
{
	struct gz_log log;
	struct gz_volume volume;
	double isovalue;
	long long threads = 0, runs = RUNS;
	gz_log_init(&log, NULL, NULL, "*:warn");
	if (argc < 3 || argc > 5 || !gz_number_parse(argv[2], &isovalue) ||
	    (argc > 3 && !gz_number_parse_whole(argv[3], &threads)) ||
	    (argc > 4 && !gz_number_parse_whole(argv[4], &runs)) || threads < 0 ||
	    threads > GZ_WORKERS_MAX || runs < 1 || runs > RUNS_MAX) {
		fputs("isosurface VOLUME ISOVALUE [THREADS [RUNS]]\n", stderr);
		return EXIT_FAILURE;
	}
	if (gz_volume_load(argv[1], NULL, NULL, &log, &volume) != GZ_OK)
		return EXIT_FAILURE;
	const enum gz_result result =
		measure_volume(&volume, isovalue, (int)threads, (int)runs, &log);
	gz_volume_free(&volume);
	return result == GZ_OK ? EXIT_SUCCESS : EXIT_FAILURE;
}
