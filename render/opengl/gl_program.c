#include "render/opengl/gl_program.h"

#include <stdbool.h>
#include <string.h>

#include <GL/glew.h>

#define GZ_LOG_MODULE "gl"

enum { MESSAGE_SIZE = 400 };

/* Compute shaders work without the extension, which drivers may not know. */
static const char *head_of(const struct gz_gl_shader *shader)
{
	if (shader->stage == GZ_GL_COMPUTE)
		return "#version 430 core\n#extension GL_ARB_shader_group_vote : enable\n";
	return shader->with_430 ? "#version 430 core\n" : "#version 330 core\n";
}

static const GLenum stages[] = {
	[GZ_GL_VERTEX] = GL_VERTEX_SHADER,
	[GZ_GL_FRAGMENT] = GL_FRAGMENT_SHADER,
	[GZ_GL_COMPUTE] = GL_COMPUTE_SHADER,
};

int gz_gl_shader_source(const struct gz_gl_shader *shader, const char *out_pieces[GZ_GL_PIECES_MAX])
{
	int count = 0;
	out_pieces[count++] = head_of(shader);
	if (shader->defines)
		out_pieces[count++] = shader->defines;
	for (int i = 0; i < GZ_GL_PARTS_MAX && shader->parts[i]; i++)
		out_pieces[count++] = shader->parts[i];
	return count;
}

static GLuint compile_shader(const struct gz_gl_shader *shader, const char *remedy,
			     const struct gz_log *log)
{
	const char *pieces[GZ_GL_PIECES_MAX];
	const int count = gz_gl_shader_source(shader, pieces);
	const GLuint name = glCreateShader(stages[shader->stage]);
	GLint good = GL_FALSE;
	glShaderSource(name, count, pieces, NULL);
	glCompileShader(name);
	glGetShaderiv(name, GL_COMPILE_STATUS, &good);
	if (good)
		return name;
	char message[MESSAGE_SIZE] = "";
	glGetShaderInfoLog(name, sizeof message, NULL, message);
	message[strcspn(message, "\n")] = '\0';
	gz_err(log, "the OpenGL driver does not compile %s: %s; update the driver, or %s",
	       shader->name, message, remedy);
	glDeleteShader(name);
	return 0;
}

static bool link_program(GLuint program, const char *name, const char *remedy,
			 const struct gz_log *log)
{
	GLint good = GL_FALSE;
	glLinkProgram(program);
	glGetProgramiv(program, GL_LINK_STATUS, &good);
	if (good)
		return true;
	char message[MESSAGE_SIZE] = "";
	glGetProgramInfoLog(program, sizeof message, NULL, message);
	message[strcspn(message, "\n")] = '\0';
	gz_err(log, "the OpenGL driver does not link %s: %s; update the driver, or %s", name,
	       message, remedy);
	return false;
}

unsigned gz_gl_program(const struct gz_gl_shader *shaders, int count, const char *remedy,
		       const struct gz_log *log)
{
	GLuint program = glCreateProgram();
	bool good = true;
	for (int i = 0; i < count && good; i++) {
		const GLuint shader = compile_shader(&shaders[i], remedy, log);
		good = shader != 0;
		if (good)
			glAttachShader(program, shader);
		glDeleteShader(shader); /* it lives on as long as the program; 0 is ignored */
	}
	if (good)
		good = link_program(program, shaders[count - 1].name, remedy, log);
	if (good)
		return program;
	glDeleteProgram(program);
	return 0;
}
