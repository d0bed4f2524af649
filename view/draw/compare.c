#include "view/draw/compare.h"

#include <math.h>

#include <GL/glew.h>

#include "render/opengl/gl_program.h"

/* Made from shaders/ when the program is built. */
extern const char gz_glsl_quad_vert[];
extern const char gz_glsl_compare_frag[];

enum gz_result gz_compare_init(struct gz_compare *compare, const struct gz_log *log)
{
	const struct gz_gl_shader shaders[2] = {
		{ GZ_GL_VERTEX, "quad.vert", NULL, { gz_glsl_quad_vert } },
		{ GZ_GL_FRAGMENT, "compare.frag", NULL, { gz_glsl_compare_frag } },
	};
	*compare = (struct gz_compare) { 0 };
	compare->program = gz_gl_program(shaders, 2, "use --headless", log);
	if (!compare->program)
		return GZ_ERR_UNSUPPORTED;
	compare->picture = glGetUniformLocation(compare->program, "picture");
	compare->standard = glGetUniformLocation(compare->program, "standard");
	compare->gain = glGetUniformLocation(compare->program, "gain");
	glGenVertexArrays(1, &compare->vertices);
	glGenTextures(1, &compare->texture);
	glBindTexture(GL_TEXTURE_2D, compare->texture);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
	return GZ_OK;
}

void gz_compare_upload(struct gz_compare *compare, const struct gz_image *standard)
{
	glBindTexture(GL_TEXTURE_2D, compare->texture);
	glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
	glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, standard->width, standard->height, 0, GL_RGBA,
		     GL_UNSIGNED_BYTE, standard->pixels);
	compare->width = standard->width;
	compare->height = standard->height;
}

static void draw(const struct gz_compare *compare, unsigned picture, float gain, int width,
		 int height)
{
	glViewport(0, 0, width, height);
	glDisable(GL_BLEND);
	glUseProgram(compare->program);
	glUniform1i(compare->picture, 0);
	glUniform1i(compare->standard, 1);
	glUniform1f(compare->gain, gain);
	glBindVertexArray(compare->vertices);
	glActiveTexture(GL_TEXTURE1);
	glBindTexture(GL_TEXTURE_2D, compare->texture);
	glActiveTexture(GL_TEXTURE0);
	glBindTexture(GL_TEXTURE_2D, picture);
	glDrawArrays(GL_TRIANGLES, 0, 3);
}

void gz_compare_draw_beside(const struct gz_compare *compare, double split, int width, int height)
{
	const int left = (int)lround(split * width);
	glEnable(GL_SCISSOR_TEST);
	glScissor(left, 0, width - left, height);
	draw(compare, compare->texture, 0, width, height);
	glDisable(GL_SCISSOR_TEST);
}

void gz_compare_draw_difference(const struct gz_compare *compare, unsigned picture, double gain,
				int width, int height)
{
	draw(compare, picture, (float)gain, width, height);
}

void gz_compare_free(struct gz_compare *compare)
{
	if (compare->program)
		glDeleteProgram(compare->program);
	if (compare->vertices)
		glDeleteVertexArrays(1, &compare->vertices);
	if (compare->texture)
		glDeleteTextures(1, &compare->texture);
	*compare = (struct gz_compare) { 0 };
}
