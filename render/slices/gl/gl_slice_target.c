#include "render/slices/gl/gl_slice_target.h"

#include <stdbool.h>

#include <GL/glew.h>

#include "render/layers/gl_layers.h"

#define GZ_LOG_MODULE "slices"

static unsigned texture_of(GLenum format, int width, int height)
{
	const unsigned name = gz_gl_texture(GL_TEXTURE_2D);
	glTexStorage2D(GL_TEXTURE_2D, 1, format, width, height);
	glBindTexture(GL_TEXTURE_2D, 0);
	return name;
}

/* Attach the textures to a framebuffer; colour 0: depth alone. */
static bool attach_textures(unsigned framebuffer, unsigned colour, unsigned depth)
{
	glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
	if (colour)
		glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, colour,
				       0);
	glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth, 0);
	glDrawBuffer(colour ? GL_COLOR_ATTACHMENT0 : GL_NONE);
	glReadBuffer(GL_NONE);
	return glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
}

static bool make_framebuffers(struct gz_gl_slice_target *target)
{
	GLint before = 0;
	glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &before);
	glGenFramebuffers(1, &target->drawing);
	glGenFramebuffers(1, &target->hiding);
	const bool complete = attach_textures(target->drawing, target->blended, target->depth) &&
			      attach_textures(target->hiding, 0, target->depth);
	glBindFramebuffer(GL_FRAMEBUFFER, (GLuint)before);
	return complete;
}

enum gz_result gz_gl_slice_target_reserve(struct gz_gl_slice_target *target,
					  const struct gz_gl_device *device,
					  const struct gz_raster_layer *layer,
					  const struct gz_log *log)
{
	if (target->blended && target->width >= layer->points[0] &&
	    target->height >= layer->points[1])
		return GZ_OK;
	const int width = target->width > layer->points[0] ? target->width : layer->points[0];
	const int height = target->height > layer->points[1] ? target->height : layer->points[1];
	gz_gl_slice_target_free(target);
	target->width = width;
	target->height = height;
	target->blended = texture_of(GL_RGBA32F, width, height);
	target->depth = texture_of(GL_DEPTH_COMPONENT24, width, height);
	const bool complete = make_framebuffers(target);
	enum gz_result result = gz_gl_device_errors(device);
	if (result == GZ_OK && !complete)
		result = GZ_ERR_UNSUPPORTED;
	if (result == GZ_OK)
		return GZ_OK;
	gz_err(log, "the graphics device has no room for slices of %d x %d points: %s", width,
	       height, gz_result_text(result));
	gz_gl_slice_target_free(target);
	return result;
}

void gz_gl_slice_target_begin(const struct gz_gl_slice_target *target,
			      const struct gz_raster_layer *layer)
{
	static const GLfloat nothing[4] = { 0 };
	glBindFramebuffer(GL_FRAMEBUFFER, target->drawing);
	glClearBufferfv(GL_COLOR, 0, nothing);
	gz_gl_layer_begin(layer);
	glEnable(GL_DEPTH_TEST);
	glBlendFunc(GL_ONE_MINUS_DST_ALPHA, GL_ONE);
	glBlendEquation(GL_FUNC_ADD);
	gz_gl_slice_target_open(target);
}

void gz_gl_slice_target_close(const struct gz_gl_slice_target *target)
{
	glBindFramebuffer(GL_FRAMEBUFFER, target->hiding);
	glDisable(GL_BLEND);
	glDepthMask(GL_TRUE);
}

void gz_gl_slice_target_open(const struct gz_gl_slice_target *target)
{
	glBindFramebuffer(GL_FRAMEBUFFER, target->drawing);
	glEnable(GL_BLEND);
	glDepthMask(GL_FALSE);
}

void gz_gl_slice_target_free(struct gz_gl_slice_target *target)
{
	/* Without an object GLEW may have no functions yet. */
	if (target->drawing)
		glDeleteFramebuffers(1, &target->drawing);
	if (target->hiding)
		glDeleteFramebuffers(1, &target->hiding);
	if (target->blended)
		glDeleteTextures(1, &target->blended);
	if (target->depth)
		glDeleteTextures(1, &target->depth);
	*target = (struct gz_gl_slice_target) { 0 };
}
