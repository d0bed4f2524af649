/**
 * @file
 * A headless OpenGL context from EGL, without any display server.
 */
#ifndef GZ_RENDER_GL_CONTEXT_EGL_H
#define GZ_RENDER_GL_CONTEXT_EGL_H

#include <stdbool.h>
#include <stddef.h>

#include "render/gl/gl_context.h"

/**
 * Make a core context of OpenGL 4.3 or later: on the first GPU that EGL lists
 * (EGL_EXT_platform_device, as NVIDIA's and Mesa's drivers have it), else, unless only hardware
 * will do, on Mesa's software (EGL_MESA_platform_surfaceless).
 *
 * @param hardware_only  refuse software renderers before they are loaded
 * @param[out] out_context  owned by the caller: gz_gl_context_destroy(); current nowhere
 * @param[out] reason       why there is none: one phrase, cut to @p size; written on failure
 * @retval GZ_ERR_NO_DEVICE    no EGL, or no device that EGL can use
 * @retval GZ_ERR_UNSUPPORTED  there is one, but with less than OpenGL 4.3
 * @retval GZ_ERR_NO_MEM       no room
 *
 * EGL's displays are initialised once a process and never terminated, for other contexts may use
 * them. Threads: any.
 */
enum gz_result gz_gl_context_egl(bool hardware_only, struct gz_gl_context **out_context,
				 char *reason, size_t size);

#endif
