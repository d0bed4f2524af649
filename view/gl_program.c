#include "view/gl_program.h"

#include <string.h>

#include <GL/glew.h>

#define GZ_LOG_MODULE "window"

enum { MESSAGE_SIZE = 400 };

static GLuint compile(GLenum kind, const struct gz_gl_shader *text, const struct gz_log *log)
{
	GLuint shader = glCreateShader(kind);
	GLint good = GL_FALSE;
	glShaderSource(shader, 1, &text->source, NULL);
	glCompileShader(shader);
	glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
	if (good)
		return shader;
	char message[MESSAGE_SIZE] = "";
	glGetShaderInfoLog(shader, sizeof message, NULL, message);
	message[strcspn(message, "\n")] = '\0';
	gz_err(log, "the OpenGL driver refuses %s: %s; update it, or use --headless", text->name,
	       message);
	glDeleteShader(shader);
	return 0;
}

unsigned gz_gl_program(const struct gz_gl_shader *vertex, const struct gz_gl_shader *fragment,
		       const struct gz_log *log)
{
	GLuint v = compile(GL_VERTEX_SHADER, vertex, log);
	GLuint f = v ? compile(GL_FRAGMENT_SHADER, fragment, log) : 0;
	GLuint program = 0;
	if (f) {
		GLint good = GL_FALSE;
		program = glCreateProgram();
		glAttachShader(program, v);
		glAttachShader(program, f);
		glLinkProgram(program);
		glGetProgramiv(program, GL_LINK_STATUS, &good);
		if (!good) {
			gz_err(log,
			       "the OpenGL driver does not link %s and %s; update it, or use "
			       "--headless",
			       vertex->name, fragment->name);
			glDeleteProgram(program);
			program = 0;
		}
	}
	glDeleteShader(v); /* 0 is ignored */
	glDeleteShader(f);
	return program;
}
