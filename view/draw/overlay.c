#include "view/draw/overlay.h"

#include <math.h>

#include <GL/glew.h>

#include "render/opengl/gl_program.h"

/* Made from shaders/ when the program is built. */
extern const char gz_glsl_quad_vert[];
extern const char gz_glsl_overlay_frag[];

enum gz_result gz_overlay_init(struct gz_overlay *overlay, const struct gz_log *log)
{
	const struct gz_gl_shader shaders[2] = {
		{ GZ_GL_VERTEX, "quad.vert", NULL, { gz_glsl_quad_vert } },
		{ GZ_GL_FRAGMENT, "overlay.frag", NULL, { gz_glsl_overlay_frag } },
	};
	*overlay = (struct gz_overlay) { 0 };
	overlay->program = gz_gl_program(shaders, 2, "use --headless", log);
	if (!overlay->program)
		return GZ_ERR_UNSUPPORTED;
	overlay->cells_per_picture = glGetUniformLocation(overlay->program, "cells_per_picture");
	overlay->cells_before = glGetUniformLocation(overlay->program, "cells_before");
	overlay->opacity = glGetUniformLocation(overlay->program, "opacity");
	glGenVertexArrays(1, &overlay->vertices);
	glGenTextures(1, &overlay->texture);
	glBindTexture(GL_TEXTURE_2D, overlay->texture);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
	return GZ_OK;
}

static void upload(struct gz_overlay *overlay)
{
	const struct gz_plan_cells *cells = &overlay->cells;
	glBindTexture(GL_TEXTURE_2D, overlay->texture);
	glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
	if (overlay->columns == cells->columns && overlay->rows == cells->rows) {
		glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, cells->columns, cells->rows, GL_RGBA,
				GL_UNSIGNED_BYTE, cells->rgba);
		return;
	}
	glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, cells->columns, cells->rows, 0, GL_RGBA,
		     GL_UNSIGNED_BYTE, cells->rgba);
	overlay->columns = cells->columns;
	overlay->rows = cells->rows;
}

static enum gz_result refresh(struct gz_overlay *overlay, const struct gz_plan *plan,
			      enum gz_view_overlay kind)
{
	if (overlay->serial == plan->serial && overlay->shown == (int)kind)
		return GZ_OK;
	const enum gz_result r = gz_plan_cells_make(&overlay->cells, plan, kind);
	if (r != GZ_OK)
		return r;
	upload(overlay);
	overlay->serial = plan->serial;
	overlay->shown = kind;
	return GZ_OK;
}

enum gz_result gz_overlay_draw(struct gz_overlay *overlay, const struct gz_plan *plan,
			       enum gz_view_overlay kind, double share, int width, int height)
{
	const enum gz_result r = refresh(overlay, plan, kind);
	if (r != GZ_OK)
		return r;
	const float cell = GZ_TILE_EDGE;
	glViewport(0, 0, width, height);
	glEnable(GL_SCISSOR_TEST);
	glScissor(0, 0, (int)lround(share * width), height);
	glEnable(GL_BLEND);
	glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
	glUseProgram(overlay->program);
	glUniform2f(overlay->cells_per_picture, (float)plan->view.width / cell,
		    (float)plan->view.height / cell);
	glUniform2f(overlay->cells_before, (float)plan->view.shift[0] / cell,
		    (float)plan->view.shift[1] / cell);
	glUniform1f(overlay->opacity, GZ_OVERLAY_OPACITY);
	glBindVertexArray(overlay->vertices);
	glActiveTexture(GL_TEXTURE0);
	glBindTexture(GL_TEXTURE_2D, overlay->texture);
	glDrawArrays(GL_TRIANGLES, 0, 3);
	glDisable(GL_BLEND);
	glDisable(GL_SCISSOR_TEST);
	return GZ_OK;
}

void gz_overlay_free(struct gz_overlay *overlay)
{
	if (overlay->program)
		glDeleteProgram(overlay->program);
	if (overlay->vertices)
		glDeleteVertexArrays(1, &overlay->vertices);
	if (overlay->texture)
		glDeleteTextures(1, &overlay->texture);
	gz_plan_cells_free(&overlay->cells);
	*overlay = (struct gz_overlay) { 0 };
}
