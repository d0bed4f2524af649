/**
 * @file
 * Compute programs: shader files put together, compiled and linked.
 */
#ifndef GZ_RENDER_GL_COMPUTE_PROGRAM_H
#define GZ_RENDER_GL_COMPUTE_PROGRAM_H

#include "base/log.h"

/** Most files of one program. */
#define GZ_COMPUTE_PARTS_MAX 8

/** One program's text. */
struct gz_compute_text {
	const char *name;                        /**< in messages */
	const char *defines;                     /**< lines of #define, before all files */
	const char *parts[GZ_COMPUTE_PARTS_MAX]; /**< in order; NULL ends them */
};

/** What stands before the files of every program: the version, cast_constants.h and the sizes that
 *  C knows. */
extern const char *const gz_compute_head[];
extern const int gz_compute_head_count;

/**
 * Compile and link; needs a current context of OpenGL 4.3.
 *
 * @return OpenGL's name of the program, the caller's to delete; 0 where the driver refuses it,
 *         which is logged
 */
unsigned gz_compute_program(const struct gz_compute_text *text, const struct gz_log *log);

#endif
