/**
 * @file
 * A context of OpenGL that a test hands to a renderer, as a window does, and that it can lose.
 */
#ifndef GZ_TESTS_RENDER_LENT_CONTEXT_H
#define GZ_TESTS_RENDER_LENT_CONTEXT_H

#include <stdbool.h>

#include "render/opengl/gl_device.h"

struct lent_context {
	struct gz_gl_context base;
	struct gz_gl_context *egl; /**< the test's own: gz_gl_context_destroy() */
	bool lost;                 /**< set: it cannot be made current any more */
};

/** Over a context of EGL. The test ends where there is none. */
struct lent_context lend_context(void);

#endif
