/**
 * @file
 * Shaders against the reference compiler: drivers forgive what it does not.
 */
#ifndef GZ_TESTS_RENDER_SHADER_CHECK_H
#define GZ_TESTS_RENDER_SHADER_CHECK_H

#include "render/opengl/gl_program.h"

/** Skip the test where there is no glslangValidator. */
void shader_check_needs_validator(void);

/** Fail the test if the reference compiler refuses a shader. */
void shader_check(const struct gz_gl_shader *shader);

#endif
