/**
 * @file
 * The six pictures of the surroundings, read when a picture first shows them.
 */
#ifndef GZ_RENDER_LIGHT_CUBE_PICTURES_H
#define GZ_RENDER_LIGHT_CUBE_PICTURES_H

#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "base/sizes.h"
#include "render/light/cube.h"
#include "render/light/environment.h"

/** Zero-initialised is none; keep it from frame to frame. */
struct gz_cube_pictures {
	struct gz_cube cube;
	char path[GZ_PATH_SIZE]; /**< of its folder */
	uint64_t serial;         /**< increased whenever pictures are read */
};

/**
 * Read the pictures if they are wanted and others than those that are there.
 *
 * @param[in,out] prepare_ms  the time is added
 * @return what gz_cube_load() returns; logged
 */
enum gz_result gz_cube_pictures_prepare(struct gz_cube_pictures *cube,
					const struct gz_environment *environment,
					const struct gz_log *log, double *prepare_ms);

/** Free the pictures and zero the struct. */
void gz_cube_pictures_free(struct gz_cube_pictures *cube);

#endif
