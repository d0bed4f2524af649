#include "render/gl/compute_program.h"

#include <string.h>

#include <GL/glew.h>

#include "render/gl/frame_block.h"

#define GZ_LOG_MODULE "gl"

enum { MESSAGE_SIZE = 400 };

/* Made from files when the program is built. */
extern const char gz_glsl_cast_constants_h[];

#define TEXT_OF(number)      #number
#define DEFINE(name, number) "#define " name " " TEXT_OF(number) "\n"

static const char sizes[] =
	DEFINE("GROUP_SIZE", GZ_GL_GROUP_SIZE) DEFINE("TILE_POINTS", GZ_GL_TILE_POINTS)
		DEFINE("COUNT_SLOTS", GZ_GL_COUNT_SLOTS) DEFINE("BRICK_EDGE", GZ_GL_BRICK_EDGE)
			DEFINE("BRICK_STORED_EDGE", GZ_GL_BRICK_STORED_EDGE)
				DEFINE("BRICK_LEVELS", GZ_GL_BRICK_LEVELS)
					DEFINE("BRICK_LEVEL_BITS", GZ_GL_BRICK_LEVEL_BITS)
						DEFINE("BRICK_PLACE_BITS", GZ_GL_BRICK_PLACE_BITS)
							DEFINE("IMAGE_POINTS", GZ_GL_IMAGE_POINTS);

/* Shaders do without what is enabled here, which drivers may not know. */
const char *const gz_compute_head[] = { "#version 430 core\n",
					"#extension GL_ARB_shader_group_vote : enable\n",
					gz_glsl_cast_constants_h, sizes };
const int gz_compute_head_count = sizeof gz_compute_head / sizeof gz_compute_head[0];

/* The first line of what the driver says. */
static void log_failure(const struct gz_compute_text *text, const char *verb, char *message,
			const struct gz_log *log)
{
	message[strcspn(message, "\n")] = '\0';
	gz_err(log, "the OpenGL driver does not %s %s: %s; update it, or use --backend cpu", verb,
	       text->name, message);
}

static GLuint compile(const struct gz_compute_text *text, const struct gz_log *log)
{
	const char *strings[8 + GZ_COMPUTE_PARTS_MAX];
	int count = 0;
	for (int i = 0; i < gz_compute_head_count; i++)
		strings[count++] = gz_compute_head[i];
	if (text->defines)
		strings[count++] = text->defines;
	for (int i = 0; i < GZ_COMPUTE_PARTS_MAX && text->parts[i]; i++)
		strings[count++] = text->parts[i];
	const GLuint shader = glCreateShader(GL_COMPUTE_SHADER);
	GLint good = GL_FALSE;
	glShaderSource(shader, count, strings, NULL);
	glCompileShader(shader);
	glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
	if (good)
		return shader;
	char message[MESSAGE_SIZE] = "";
	glGetShaderInfoLog(shader, sizeof message, NULL, message);
	log_failure(text, "compile", message, log);
	glDeleteShader(shader);
	return 0;
}

unsigned gz_compute_program(const struct gz_compute_text *text, const struct gz_log *log)
{
	const GLuint shader = compile(text, log);
	if (!shader)
		return 0;
	GLuint program = glCreateProgram();
	GLint good = GL_FALSE;
	glAttachShader(program, shader);
	glLinkProgram(program);
	glDeleteShader(shader);
	glGetProgramiv(program, GL_LINK_STATUS, &good);
	if (good)
		return program;
	char message[MESSAGE_SIZE] = "";
	glGetProgramInfoLog(program, sizeof message, NULL, message);
	log_failure(text, "link", message, log);
	glDeleteProgram(program);
	return 0;
}
