/**
 * @file
 * The cpu backend: SIMD over a tile's rays, threads over tiles. Needs no GPU and gives the same
 * bits for any number of threads and in every run on one instruction set.
 */
#ifndef GZ_RENDER_CPU_CPU_RENDERER_H
#define GZ_RENDER_CPU_CPU_RENDERER_H

#include "render/renderer.h"

extern const struct gz_renderer_ops gz_cpu_renderer_ops;

#endif
