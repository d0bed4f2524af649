#include "view/quad.h"

#include <string.h>

#include <GL/glew.h>

#define GZ_LOG_MODULE "window"

/* Made from shaders/ when the program is built. */
extern const char gz_glsl_quad_vert[];
extern const char gz_glsl_quad_frag[];

enum { MESSAGE_SIZE = 400 };

static GLuint compile(GLenum kind, const char *name, const char *source, const struct gz_log *log)
{
	GLuint shader = glCreateShader(kind);
	GLint good = GL_FALSE;
	glShaderSource(shader, 1, &source, NULL);
	glCompileShader(shader);
	glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
	if (good)
		return shader;
	char message[MESSAGE_SIZE] = "";
	glGetShaderInfoLog(shader, sizeof message, NULL, message);
	message[strcspn(message, "\n")] = '\0';
	gz_err(log, "the OpenGL driver refuses %s: %s; update it, or use --headless", name,
	       message);
	glDeleteShader(shader);
	return 0;
}

static GLuint link_program(const struct gz_log *log)
{
	GLuint vertex = compile(GL_VERTEX_SHADER, "quad.vert", gz_glsl_quad_vert, log);
	GLuint fragment =
		vertex ? compile(GL_FRAGMENT_SHADER, "quad.frag", gz_glsl_quad_frag, log) : 0;
	GLuint program = 0;
	if (fragment) {
		GLint good = GL_FALSE;
		program = glCreateProgram();
		glAttachShader(program, vertex);
		glAttachShader(program, fragment);
		glLinkProgram(program);
		glGetProgramiv(program, GL_LINK_STATUS, &good);
		if (!good) {
			gz_err(log, "the OpenGL driver does not link quad.vert and quad.frag; "
				    "update it, or use --headless");
			glDeleteProgram(program);
			program = 0;
		}
	}
	glDeleteShader(vertex); /* 0 is ignored */
	glDeleteShader(fragment);
	return program;
}

enum gz_result gz_quad_init(struct gz_quad *quad, const struct gz_log *log)
{
	*quad = (struct gz_quad) { 0 };
	quad->program = link_program(log);
	if (!quad->program)
		return GZ_ERR_UNSUPPORTED;
	glGenVertexArrays(1, &quad->vertices);
	glGenTextures(1, &quad->texture);
	glBindTexture(GL_TEXTURE_2D, quad->texture);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
	return GZ_OK;
}

void gz_quad_upload(struct gz_quad *quad, const struct gz_image *image)
{
	glBindTexture(GL_TEXTURE_2D, quad->texture);
	glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
	if (quad->width != image->width || quad->height != image->height) {
		glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, image->width, image->height, 0, GL_RGBA,
			     GL_UNSIGNED_BYTE, image->pixels);
		quad->width = image->width;
		quad->height = image->height;
		return;
	}
	glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, image->width, image->height, GL_RGBA,
			GL_UNSIGNED_BYTE, image->pixels);
}

void gz_quad_draw(const struct gz_quad *quad, int width, int height)
{
	glViewport(0, 0, width, height);
	glDisable(GL_BLEND);
	glUseProgram(quad->program);
	glBindVertexArray(quad->vertices);
	glActiveTexture(GL_TEXTURE0);
	glBindTexture(GL_TEXTURE_2D, quad->texture);
	glDrawArrays(GL_TRIANGLES, 0, 3);
}

void gz_quad_free(struct gz_quad *quad)
{
	if (quad->program)
		glDeleteProgram(quad->program);
	if (quad->vertices)
		glDeleteVertexArrays(1, &quad->vertices);
	if (quad->texture)
		glDeleteTextures(1, &quad->texture);
	*quad = (struct gz_quad) { 0 };
}
