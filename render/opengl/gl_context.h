/**
 * @file
 * An OpenGL context for the gl backend, whoever made it: one without a window from
 * EGL, or a window's, which view/ hands in. Whoever makes a context destroys it, after the
 * renderers that use it.
 *
 * A program with a window gives the window's own context, because a thread has at most one current
 * context and EGL and GLX do not share one: the picture then is a texture that the window draws
 * without a copy.
 */
#ifndef GZ_RENDER_OPENGL_GL_CONTEXT_H
#define GZ_RENDER_OPENGL_GL_CONTEXT_H

#include <stdbool.h>
#include <stddef.h>

#include "base/result.h"

struct gz_gl_context;

/** What a context must provide. Every table is const and has static storage. */
struct gz_gl_context_ops {
	/** Make it current on the calling thread, where it may be already.
	 *  GZ_ERR_NO_DEVICE: it is lost. */
	enum gz_result (*make_current)(struct gz_gl_context *context);
	/** The renderer's call ends: leave the thread without this context, so that the next call
	 * may come from another. A window's context stays current: its window draws next. */
	void (*release)(struct gz_gl_context *context);
	/** Optional. Free it; it is current nowhere. */
	void (*destroy)(struct gz_gl_context *context);
};

/** Common head of every context. */
struct gz_gl_context {
	const struct gz_gl_context_ops *ops;
};

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

/** Destroy and set to NULL. Accepts a pointer to NULL. */
void gz_gl_context_destroy(struct gz_gl_context **context);

#endif
