/* Particle files from anywhere: the first byte chooses the name, the time point and the value, the
 * rest is the file. Whatever the bytes, loading ends, takes no more memory than the file can fill,
 * and what is loaded keeps the promises of particles.h and becomes volumes. */
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "fuzz/fuzz_folder.h"
#include "render/particles/particle_grid.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* New names are put last: the corpus has indices. */
static const char *const names[] = { "a.particles", "a.bgeo", "a.ply", "a.vtk", "a.xyz", "a" };
#define NAME_COUNT (sizeof names / sizeof names[0])

static char folder[64];

static void require(bool holds)
{
	if (!holds)
		abort();
}

static void path_of(size_t name, char *out, size_t size)
{
	snprintf(out, size, "%s/%s", folder, names[name]);
}

static void remove_folder(void)
{
	char path[128];
	for (size_t i = 0; i < NAME_COUNT; i++) {
		path_of(i, path, sizeof path);
		unlink(path);
	}
	rmdir(folder);
}

static void check_particles(const struct gz_particles *particles,
			    const struct gz_particle_request *request)
{
	require(particles->count >= 1 && particles->count <= GZ_PARTICLES_MAX);
	require(particles->time_points >= 1 && particles->time_points <= GZ_TIME_POINTS_MAX);
	require(particles->time_point == request->time_point);
	require((particles->values == NULL) == (request->value == GZ_PARTICLE_FILL));
	require(particles->value_range[0] <= particles->value_range[1]);
	for (size_t i = 0; i < particles->count; i++) {
		for (int axis = 0; axis < 3; axis++) {
			const double x = particles->positions[i][axis];
			require(fabs(x) <= GZ_PARTICLE_COORDINATE_MAX);
			require(!particles->has_box || (x >= particles->box_least[axis] &&
							x <= particles->box_greatest[axis]));
		}
		require(!particles->values ||
			((double)particles->values[i] >= particles->value_range[0] &&
			 (double)particles->values[i] <= particles->value_range[1]));
	}
}

/* A volume of them is finite and keeps its range. */
static void check_gridding(const struct gz_particles *particles, enum gz_particle_value value)
{
	for (int i = 0; i < GZ_GRIDDING_COUNT; i++) {
		struct gz_particle_grid grid = gz_particle_grid_preset();
		struct gz_volume volume;
		grid.gridding = (enum gz_particle_gridding)i;
		grid.value = value;
		grid.cells = 12;
		grid.threads = 1;
		if (gz_particles_to_volume(particles, &grid, "fuzz", NULL, NULL, &volume) != GZ_OK)
			continue;
		require(isfinite(volume.stored_min) && isfinite(volume.stored_max));
		for (size_t k = 0; k < gz_volume_voxel_count(&volume); k++) {
			const double voxel = (double)((const float *)volume.voxels)[k];
			require(voxel >= volume.stored_min && voxel <= volume.stored_max);
		}
		for (int axis = 0; axis < 3; axis++)
			require(volume.spacing[axis] > 0 && isfinite(volume.spacing[axis]));
		gz_volume_free(&volume);
	}
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct gz_particles particles;
	char path[128];
	if (size < 1)
		return 0;
	if (!folder[0]) {
		fuzz_folder_make(folder);
		atexit(remove_folder);
	}
	path_of(data[0] % NAME_COUNT, path, sizeof path);
	FILE *file = fopen(path, "wb");
	require(file != NULL);
	require(fwrite(data + 1, 1, size - 1, file) == size - 1);
	require(fclose(file) == 0);
	const struct gz_particle_request request = {
		.path = path,
		.value = (enum gz_particle_value)(data[0] / NAME_COUNT % GZ_PARTICLE_VALUE_COUNT),
		.time_point = data[0] / (NAME_COUNT * GZ_PARTICLE_VALUE_COUNT) % 2,
	};
	if (gz_particles_load(&request, &particles) == GZ_OK) {
		check_particles(&particles, &request);
		check_gridding(&particles, request.value);
		gz_particles_free(&particles);
	}
	return 0;
}
