/**
 * @file
 * Programs for the graphics device: shader files joined, compiled and linked. gz_gl_program() needs
 * a current context.
 */
#ifndef GZ_RENDER_OPENGL_GL_PROGRAM_H
#define GZ_RENDER_OPENGL_GL_PROGRAM_H

#include <stdbool.h>

#include "base/log.h"

/** Kinds of shader. */
enum gz_gl_stage { GZ_GL_VERTEX, GZ_GL_FRAGMENT, GZ_GL_COMPUTE };

/** Most files of one shader. */
#define GZ_GL_PARTS_MAX 16

/** One shader's text. */
struct gz_gl_shader {
	enum gz_gl_stage stage;
	const char *name;                   /**< for messages: the last file's */
	const char *defines;                /**< lines of #define before all files; may be NULL */
	const char *parts[GZ_GL_PARTS_MAX]; /**< the files in order; NULL ends them */
	bool with_430; /**< vertex and fragment shaders: GLSL 4.30 instead of 3.30 */
};

/** Most pieces of one shader's source: version, defines, parts. */
#define GZ_GL_PIECES_MAX (GZ_GL_PARTS_MAX + 2)

/**
 * The pieces of a shader's source, in the order in which the driver gets them: the version (430 for
 * compute shaders and where with_430 asks for it, else 330), the defines, the parts.
 *
 * @param[out] out_pieces  borrowed from @p shader, or static
 * @return number of pieces
 */
int gz_gl_shader_source(const struct gz_gl_shader *shader,
			const char *out_pieces[GZ_GL_PIECES_MAX]);

/**
 * Compile and link a program.
 *
 * @param shaders  one compute shader, or a vertex and a fragment shader
 * @param remedy   advice for the user if the driver refuses, such as "use --backend cpu"
 * @return OpenGL's name of the program, which the caller deletes; 0 if the driver refuses it, which
 *         is logged
 */
unsigned gz_gl_program(const struct gz_gl_shader *shaders, int count, const char *remedy,
		       const struct gz_log *log);

#endif
