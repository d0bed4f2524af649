/**
 * @file
 * An OpenGL context for the gl backend, whoever made it: headless from EGL (context_egl.h), or a
 * window's, which view/ hands in. The one who makes a context destroys it, after the renderers that
 * use it.
 *
 * A program with a window gives the window's own context, because a thread has at most one current
 * context and EGL and GLX do not share one: the picture then is a texture that the window draws
 * without a copy.
 */
#ifndef GZ_RENDER_GL_GL_CONTEXT_H
#define GZ_RENDER_GL_GL_CONTEXT_H

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

/** Destroy and set to NULL. Accepts a pointer to NULL. */
void gz_gl_context_destroy(struct gz_gl_context **context);

#endif
