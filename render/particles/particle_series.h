/**
 * @file
 * A series of particles in numbered files, one time step each: "water_0001.bgeo",
 * "water_0002.bgeo", … The number stands before the first dot that follows it. Numbers may have
 * gaps, and zeros before them.
 */
#ifndef GZ_RENDER_PARTICLES_PARTICLE_SERIES_H
#define GZ_RENDER_PARTICLES_PARTICLE_SERIES_H

#include <stdbool.h>
#include <stddef.h>

#include "base/log.h"
#include "base/result.h"
#include "base/sizes.h"
#include "render/particles/particle_grid.h"

/** The files of a series. Zero-initialised is empty. */
struct gz_particle_series {
	char **paths; /**< by their numbers */
	size_t count; /**< 0: the file is none of a series, or not its first */
};

/**
 * Find the series whose first file this is: files of the same folder, with the same name but for
 * the number, and with content of the same format. A file that may hold several time steps itself
 * (.particles) begins none.
 *
 * @param[out] out_series  count is 0, or 2 to GZ_TIME_POINTS_MAX; the caller frees it with
 *                         gz_particle_series_free()
 * @retval GZ_ERR_NO_MEM   not logged
 */
enum gz_result gz_particle_series_find(const char *path, struct gz_particle_series *out_series);

/** Free the paths and zero the struct. Accepts a zero-initialised one. */
void gz_particle_series_free(struct gz_particle_series *series);

/**
 * The first file that a pattern names: "water_%04d.bgeo" or "water_%d.bgeo", whose widths do not
 * matter.
 *
 * @param[out] out_path  written if true is returned; may be @p pattern
 * @return false: it is no pattern, there is a file of just this name, or no file that it names
 */
bool gz_particle_series_first(const char *pattern, char out_path[GZ_PATH_SIZE]);

/**
 * Find what all time points of a series share: its box is that of all particles, its radius that of
 * the first file. Reads each file, one at a time. A file that cannot be read ends the series, with
 * a warning; the first one must be readable.
 *
 * @param value    of the particles, for the range
 * @param loading  its report only; may be NULL
 * @param[out] out_frame  written on GZ_OK
 * @return the results of gz_particles_load() for the first file, and of gz_particles_find_radius()
 */
enum gz_result gz_particle_series_measure(const struct gz_particle_series *series,
					  enum gz_particle_value value,
					  const struct gz_loading *loading,
					  const struct gz_log *log,
					  struct gz_particle_frame *out_frame);

#endif
