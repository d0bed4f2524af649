/**
 * @file
 * The cpu backend: SIMD over a tile's rays, threads over tiles. Needs no GPU and gives the same
 * bits for any number of threads and in every run on one instruction set.
 */
#ifndef GZ_RENDER_CPU_CPU_RENDERER_H
#define GZ_RENDER_CPU_CPU_RENDERER_H

#include "render/renderer.h"

extern const struct gz_renderer_ops gz_cpu_renderer_ops;

/** Whether the processor runs what @p params ask for: GZ_ERR_UNSUPPORTED if not; logged. */
enum gz_result gz_cpu_renderer_check(const struct gz_renderer_params *params,
				     const struct gz_log *log);

#endif
