/**
 * @file
 * A vertex and a fragment shader, compiled and linked. Needs a current OpenGL 3.3 context.
 */
#ifndef GZ_VIEW_GL_PROGRAM_H
#define GZ_VIEW_GL_PROGRAM_H

#include "base/log.h"

/** A shader's source and the name it has in messages. */
struct gz_gl_shader {
	const char *name;
	const char *source;
};

/**
 * Compile and link.
 *
 * @return OpenGL's name of the program, the caller's to delete; 0 where the driver refuses one of
 *         the shaders or both together, which is logged
 */
unsigned gz_gl_program(const struct gz_gl_shader *vertex, const struct gz_gl_shader *fragment,
		       const struct gz_log *log);

#endif
