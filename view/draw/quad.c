#include "view/draw/quad.h"

#include <math.h>

#include <GL/glew.h>

#include "render/opengl/gl_program.h"

/* Made from shaders/ when the program is built. */
extern const char gz_glsl_quad_vert[];
extern const char gz_glsl_quad_frag[];
extern const char gz_glsl_compare_frag[];

enum gz_result gz_fill_init(struct gz_fill *fill, const char *name, const char *fragment,
			    const struct gz_log *log)
{
	const struct gz_gl_shader shaders[2] = {
		{ .stage = GZ_GL_VERTEX, .name = "quad.vert", .parts = { gz_glsl_quad_vert } },
		{ .stage = GZ_GL_FRAGMENT, .name = name, .parts = { fragment } },
	};
	*fill = (struct gz_fill) { .program = gz_gl_program(shaders, 2, "use --headless", log) };
	if (!fill->program)
		return GZ_ERR_UNSUPPORTED;
	glGenVertexArrays(1, &fill->vertices);
	glGenTextures(1, &fill->texture);
	glBindTexture(GL_TEXTURE_2D, fill->texture);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
	return GZ_OK;
}

void gz_fill_upload(struct gz_fill *fill, const uint8_t *rgba, int width, int height)
{
	glBindTexture(GL_TEXTURE_2D, fill->texture);
	glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
	if (fill->width == width && fill->height == height) {
		glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE,
				rgba);
		return;
	}
	glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, width, height, 0, GL_RGBA, GL_UNSIGNED_BYTE, rgba);
	fill->width = width;
	fill->height = height;
}

void gz_fill_use(const struct gz_fill *fill, int width, int height)
{
	glViewport(0, 0, width, height);
	glDisable(GL_BLEND);
	glUseProgram(fill->program);
}

void gz_fill_draw(const struct gz_fill *fill, unsigned texture)
{
	glBindVertexArray(fill->vertices);
	glActiveTexture(GL_TEXTURE0);
	glBindTexture(GL_TEXTURE_2D, texture);
	glDrawArrays(GL_TRIANGLES, 0, 3);
}

void gz_fill_free(struct gz_fill *fill)
{
	if (fill->program)
		glDeleteProgram(fill->program);
	if (fill->vertices)
		glDeleteVertexArrays(1, &fill->vertices);
	if (fill->texture)
		glDeleteTextures(1, &fill->texture);
	*fill = (struct gz_fill) { 0 };
}

/* ---- the picture ---- */

enum gz_result gz_quad_init(struct gz_quad *quad, const struct gz_log *log)
{
	quad->shown = 0;
	return gz_fill_init(&quad->fill, "quad.frag", gz_glsl_quad_frag, log);
}

void gz_quad_upload(struct gz_quad *quad, const struct gz_image *image)
{
	gz_fill_upload(&quad->fill, image->pixels, image->width, image->height);
	quad->shown = quad->fill.texture;
}

void gz_quad_show(struct gz_quad *quad, unsigned texture)
{
	quad->shown = texture;
}

void gz_quad_draw(const struct gz_quad *quad, int width, int height)
{
	gz_fill_use(&quad->fill, width, height);
	gz_fill_draw(&quad->fill, quad->shown);
}

void gz_quad_draw_part(const struct gz_quad *quad, int width, int height, const int corner[2],
		       const int size[2])
{
	glEnable(GL_SCISSOR_TEST);
	glScissor(corner[0], corner[1], size[0], size[1]);
	gz_quad_draw(quad, width, height);
	glDisable(GL_SCISSOR_TEST);
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
	gz_fill_free(&quad->fill);
	quad->shown = 0;
}

/* ---- the standard picture ---- */

enum gz_result gz_compare_init(struct gz_compare *compare, const struct gz_log *log)
{
	const enum gz_result r =
		gz_fill_init(&compare->fill, "compare.frag", gz_glsl_compare_frag, log);
	if (r != GZ_OK)
		return r;
	compare->picture = glGetUniformLocation(compare->fill.program, "picture");
	compare->standard = glGetUniformLocation(compare->fill.program, "standard");
	compare->gain = glGetUniformLocation(compare->fill.program, "gain");
	return GZ_OK;
}

void gz_compare_upload(struct gz_compare *compare, const struct gz_image *standard)
{
	gz_fill_upload(&compare->fill, standard->pixels, standard->width, standard->height);
}

/* A gain of 0 shows the standard picture itself. */
static void draw_standard(const struct gz_compare *compare, unsigned picture, float gain, int width,
			  int height)
{
	gz_fill_use(&compare->fill, width, height);
	glUniform1i(compare->picture, 0);
	glUniform1i(compare->standard, 1);
	glUniform1f(compare->gain, gain);
	glActiveTexture(GL_TEXTURE1);
	glBindTexture(GL_TEXTURE_2D, compare->fill.texture);
	gz_fill_draw(&compare->fill, picture);
}

void gz_compare_draw_beside(const struct gz_compare *compare, double split, int width, int height)
{
	const int left = (int)lround(split * width);
	glEnable(GL_SCISSOR_TEST);
	glScissor(left, 0, width - left, height);
	draw_standard(compare, compare->fill.texture, 0, width, height);
	glDisable(GL_SCISSOR_TEST);
}

void gz_compare_draw_difference(const struct gz_compare *compare, unsigned picture, double gain,
				int width, int height)
{
	draw_standard(compare, picture, (float)gain, width, height);
}

void gz_compare_free(struct gz_compare *compare)
{
	gz_fill_free(&compare->fill);
}
