/**
 * @file
 * The gl backend: OpenGL 4.3 compute shaders over the plan's tiles. The same samples as the cpu
 * backend, so that pictures differ by rounding only.
 */
#ifndef GZ_RENDER_GL_GL_RENDERER_H
#define GZ_RENDER_GL_GL_RENDERER_H

#include "render/renderer.h"

extern const struct gz_renderer_ops gz_gl_renderer_ops;

#endif
