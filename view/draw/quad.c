#include "view/draw/quad.h"

#include <GL/glew.h>

#include "render/opengl/gl_program.h"

/* Made from shaders/ when the program is built. */
extern const char gz_glsl_quad_vert[];
extern const char gz_glsl_quad_frag[];

enum gz_result gz_quad_init(struct gz_quad *quad, const struct gz_log *log)
{
	const struct gz_gl_shader shaders[2] = {
		{ GZ_GL_VERTEX, "quad.vert", NULL, { gz_glsl_quad_vert } },
		{ GZ_GL_FRAGMENT, "quad.frag", NULL, { gz_glsl_quad_frag } },
	};
	*quad = (struct gz_quad) { 0 };
	quad->program = gz_gl_program(shaders, 2, "use --headless", log);
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
	quad->shown = quad->texture;
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

void gz_quad_show(struct gz_quad *quad, unsigned texture)
{
	quad->shown = texture;
}

void gz_quad_draw(const struct gz_quad *quad, int width, int height)
{
	glViewport(0, 0, width, height);
	glDisable(GL_BLEND);
	glUseProgram(quad->program);
	glBindVertexArray(quad->vertices);
	glActiveTexture(GL_TEXTURE0);
	glBindTexture(GL_TEXTURE_2D, quad->shown);
	glDrawArrays(GL_TRIANGLES, 0, 3);
}

void gz_quad_clear(int width, int height)
{
	glViewport(0, 0, width, height);
	/* Chosen: dark, but not the black of an empty picture. */
	glClearColor(0.09f, 0.10f, 0.12f, 1);
	glClear(GL_COLOR_BUFFER_BIT);
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
