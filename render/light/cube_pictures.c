#include "render/light/cube_pictures.h"

#include <string.h>

#include "base/clock.h"

enum gz_result gz_cube_pictures_prepare(struct gz_cube_pictures *cube,
					const struct gz_environment *environment,
					const struct gz_log *log, double *prepare_ms)
{
	const bool wanted = environment->kind == GZ_SURROUNDINGS_CUBE && environment->cube_path[0];
	if (cube->cube.edge && strcmp(environment->cube_path, cube->path) != 0)
		gz_cube_free(&cube->cube);
	if (!wanted || cube->cube.edge)
		return GZ_OK;
	const int64_t start_ns = gz_clock_now_ns();
	const enum gz_result result = gz_cube_load(environment->cube_path, log, &cube->cube);
	if (result == GZ_OK) {
		memcpy(cube->path, environment->cube_path, sizeof cube->path);
		cube->serial++;
	}
	*prepare_ms += gz_ns_to_ms(gz_clock_now_ns() - start_ns);
	return result;
}

void gz_cube_pictures_free(struct gz_cube_pictures *cube)
{
	gz_cube_free(&cube->cube);
	*cube = (struct gz_cube_pictures) { 0 };
}
