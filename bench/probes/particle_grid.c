/* Prints how long particles take to become a volume:
 * particle_grid FILE|COUNT CELLS [THREADS [RUNS]]. COUNT particles are generated: a cube of liquid,
 * each moved at random by up to a fifth of their distance. The best and the median of several runs
 * of each way, without reading the file. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/clock.h"
#include "base/log.h"
#include "base/order.h"
#include "base/text.h"
#include "base/workers.h"
#include "render/particles/particle_grid.h"

enum { RUNS = 7, RUNS_MAX = 1000 };

/* Marsaglia, "Xorshift RNGs", 2003. @return 0 to 1 */
static double random_share(uint64_t *state)
{
	*state ^= *state << 13;
	*state ^= *state >> 7;
	*state ^= *state << 17;
	return (double)(*state >> 11) / 9007199254740992.0;
}

static bool generate(size_t count, struct gz_particles *out_particles)
{
	const size_t edge = (size_t)ceil(cbrt((double)count));
	uint64_t state = UINT64_C(88172645463325252);
	struct gz_particles particles = { .count = count,
					  .positions = malloc(count * sizeof(double[3])),
					  .time_points = 1,
					  .value_range = { 1, 1 } };
	if (!particles.positions)
		return false;
	for (size_t i = 0; i < count; i++) {
		const size_t cell[3] = { i % edge, i / edge % edge, i / edge / edge };
		for (int axis = 0; axis < 3; axis++)
			particles.positions[i][axis] =
				((double)cell[axis] + 0.5 + 0.4 * (random_share(&state) - 0.5)) /
				(double)edge;
	}
	*out_particles = particles;
	return true;
}

static bool measure_gridding(const struct gz_particles *particles,
			     const struct gz_particle_grid *grid, int runs,
			     const struct gz_log *log)
{
	double took_ms[RUNS_MAX] = { 0 };
	int dims[3] = { 0 };
	for (int run = -1; run < runs; run++) { /* the first one warms up */
		struct gz_volume volume;
		const int64_t start_ns = gz_clock_now_ns();
		if (gz_particles_to_volume(particles, grid, "particles", NULL, log, &volume) !=
		    GZ_OK)
			return false;
		if (run >= 0)
			took_ms[run] = gz_ns_to_ms(gz_clock_now_ns() - start_ns);
		for (int axis = 0; axis < 3; axis++)
			dims[axis] = volume.dims[axis];
		gz_volume_free(&volume);
	}
	qsort(took_ms, (size_t)runs, sizeof took_ms[0], gz_compare_doubles);
	printf("%-8s %zu particles, %d x %d x %d: best %.1f ms, median %.1f ms\n",
	       gz_particle_gridding_names[grid->gridding], particles->count, dims[0], dims[1],
	       dims[2], took_ms[0], took_ms[runs / 2]);
	return true;
}

int main(int argc, char **argv)
{
	struct gz_log log;
	struct gz_particles particles = { 0 };
	long long cells = 0, threads = 0, runs = RUNS, count = 0;
	gz_log_init(&log, NULL, NULL, "*:warn");
	if (argc < 3 || argc > 5 || !gz_number_parse_whole(argv[2], &cells) ||
	    (argc > 3 && !gz_number_parse_whole(argv[3], &threads)) ||
	    (argc > 4 && !gz_number_parse_whole(argv[4], &runs)) || cells < GZ_PARTICLE_CELLS_MIN ||
	    cells > GZ_PARTICLE_CELLS_MAX || threads < 0 || threads > GZ_WORKERS_MAX || runs < 1 ||
	    runs > RUNS_MAX) {
		fputs("particle_grid FILE|COUNT CELLS [THREADS [RUNS]]\n", stderr);
		return EXIT_FAILURE;
	}
	const struct gz_particle_request request = { .path = argv[1], .log = &log };
	const bool made = gz_number_parse_whole(argv[1], &count) && count > 0 &&
			  (size_t)count <= GZ_PARTICLES_MAX;
	bool good = made ? generate((size_t)count, &particles)
			 : gz_particles_load(&request, &particles) == GZ_OK;
	struct gz_particle_grid grid = gz_particle_grid_preset();
	grid.cells = (int)cells;
	grid.threads = (int)threads;
	for (int i = 0; i < GZ_GRIDDING_COUNT && good; i++) {
		grid.gridding = (enum gz_particle_gridding)i;
		good = measure_gridding(&particles, &grid, (int)runs, &log);
	}
	gz_particles_free(&particles);
	return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
