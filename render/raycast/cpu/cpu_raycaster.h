/**
 * @file
 * The cpu backend: SIMD over a tile's rays, threads over tiles. Needs no GPU and gives the same
 * bits for any number of threads and in every run on one instruction set.
 */
#ifndef GZ_RENDER_RAYCAST_CPU_CPU_RAYCASTER_H
#define GZ_RENDER_RAYCAST_CPU_CPU_RAYCASTER_H

#include "render/raycast/shared/raycaster.h"

extern const struct gz_raycaster_ops gz_cpu_raycaster_ops;

/** Whether the processor runs what @p params ask for: GZ_ERR_UNSUPPORTED if not; logged. */
enum gz_result gz_cpu_raycaster_check(const struct gz_backend_params *params,
				      const struct gz_log *log);

#endif
