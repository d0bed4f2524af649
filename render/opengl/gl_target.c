#include "render/opengl/gl_target.h"

#include <stdbool.h>

#include <GL/glew.h>

#define GZ_LOG_MODULE "gl"

/* The bits of a float that is infinite. */
#define INFINITE_BITS 0x7F800000U

static const struct {
	GLenum internal, format, type;
} plane_formats[GZ_GL_TARGET_PLANES] = {
	[GZ_GL_TARGET_COLOUR] = { GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE },
	[GZ_GL_TARGET_ID] = { GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT },
	[GZ_GL_TARGET_VALUE] = { GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT },
	[GZ_GL_TARGET_VECTOR] = { GL_RGBA32F, GL_RGBA, GL_FLOAT },
};

static unsigned wanted_planes(const struct gz_gl_target *target)
{
	unsigned planes = 0;
	for (int i = 0; i < GZ_GL_TARGET_PLANES; i++)
		if (target->planes[i])
			planes |= 1U << i;
	return planes;
}

static void attach_planes(struct gz_gl_target *target, unsigned planes)
{
	GLenum buffers[GZ_GL_TARGET_PLANES];
	for (int i = 0; i < GZ_GL_TARGET_PLANES; i++) {
		buffers[i] = GL_NONE;
		if (!(planes >> i & 1))
			continue;
		target->planes[i] = gz_gl_texture(GL_TEXTURE_2D);
		glTexStorage2D(GL_TEXTURE_2D, 1, plane_formats[i].internal, target->width,
			       target->height);
		buffers[i] = GL_COLOR_ATTACHMENT0 + (GLenum)i;
		glFramebufferTexture2D(GL_FRAMEBUFFER, buffers[i], GL_TEXTURE_2D, target->planes[i],
				       0);
	}
	glDrawBuffers(GZ_GL_TARGET_PLANES, buffers);
	target->depth = gz_gl_texture(GL_TEXTURE_2D);
	glTexStorage2D(GL_TEXTURE_2D, 1, GL_DEPTH_COMPONENT32F, target->width, target->height);
	glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, target->depth,
			       0);
	glBindTexture(GL_TEXTURE_2D, 0);
}

static bool target_fits(const struct gz_gl_target *target, unsigned planes, int width, int height)
{
	return target->framebuffer && target->width >= width && target->height >= height &&
	       wanted_planes(target) == planes;
}

enum gz_result gz_gl_target_reserve(struct gz_gl_target *target, const struct gz_gl_device *device,
				    unsigned planes, int width, int height,
				    const struct gz_log *log)
{
	GLint before = 0;
	if (target_fits(target, planes, width, height))
		return GZ_OK;
	width = width > target->width ? width : target->width;
	height = height > target->height ? height : target->height;
	gz_gl_target_free(target);
	target->width = width;
	target->height = height;
	glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &before);
	glGenFramebuffers(1, &target->framebuffer);
	glBindFramebuffer(GL_FRAMEBUFFER, target->framebuffer);
	attach_planes(target, planes);
	const bool complete = glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
	glBindFramebuffer(GL_FRAMEBUFFER, (GLuint)before);
	enum gz_result result = gz_gl_device_errors(device);
	if (result == GZ_OK && !complete)
		result = GZ_ERR_UNSUPPORTED;
	if (result == GZ_OK)
		return GZ_OK;
	gz_err(log, "the graphics device has no framebuffer of %d x %d px: %s", width, height,
	       gz_result_text(result));
	gz_gl_target_free(target);
	return result;
}

void gz_gl_target_begin(const struct gz_gl_target *target)
{
	glBindFramebuffer(GL_FRAMEBUFFER, target->framebuffer);
	glViewport(0, 0, target->width, target->height);
	glEnable(GL_DEPTH_TEST);
	glDisable(GL_BLEND);
}

void gz_gl_target_clear(const struct gz_gl_target *target, const float colour[4])
{
	static const GLuint no_id[4] = { 0 };
	static const GLuint no_value[4] = { INFINITE_BITS };
	static const GLfloat no_vector[4] = { 0 }, farthest = 1;
	if (target->planes[GZ_GL_TARGET_COLOUR])
		glClearBufferfv(GL_COLOR, GZ_GL_TARGET_COLOUR, colour);
	if (target->planes[GZ_GL_TARGET_ID])
		glClearBufferuiv(GL_COLOR, GZ_GL_TARGET_ID, no_id);
	if (target->planes[GZ_GL_TARGET_VALUE])
		glClearBufferuiv(GL_COLOR, GZ_GL_TARGET_VALUE, no_value);
	if (target->planes[GZ_GL_TARGET_VECTOR])
		glClearBufferfv(GL_COLOR, GZ_GL_TARGET_VECTOR, no_vector);
	glClearBufferfv(GL_DEPTH, 0, &farthest);
}

void gz_gl_target_read(const struct gz_gl_target *target, enum gz_gl_target_plane plane, int width,
		       int height, void *out_words)
{
	GLint before = 0;
	glGetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &before);
	glBindFramebuffer(GL_READ_FRAMEBUFFER, target->framebuffer);
	glReadBuffer(GL_COLOR_ATTACHMENT0 + (GLenum)plane);
	glPixelStorei(GL_PACK_ALIGNMENT, 4);
	glReadPixels(0, 0, width, height, plane_formats[plane].format, plane_formats[plane].type,
		     out_words);
	glBindFramebuffer(GL_READ_FRAMEBUFFER, (GLuint)before);
}

void gz_gl_target_free(struct gz_gl_target *target)
{
	for (int i = 0; i < GZ_GL_TARGET_PLANES; i++)
		if (target->planes[i])
			glDeleteTextures(1, &target->planes[i]);
	if (target->depth)
		glDeleteTextures(1, &target->depth);
	if (target->framebuffer)
		glDeleteFramebuffers(1, &target->framebuffer);
	*target = (struct gz_gl_target) { 0 };
}
