#include "render/surface/gl/raster_shadow.h"

#include <string.h>

#include <GL/glew.h>

#include "render/surface/gl/raster_programs.h"

#define GZ_LOG_MODULE "isosurface"

enum { EDGE_MIN = 256, EDGE_MAX = 4096 };

int gz_raster_shadow_edge(int width, int height)
{
	const int longer = width > height ? width : height;
	GLint most = EDGE_MAX;
	glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
	int edge = EDGE_MIN;
	while (edge < 2 * longer && edge < EDGE_MAX && 2 * edge <= most)
		edge *= 2;
	return edge;
}

static void make_shadow_texture(struct gz_raster_shadow_map *map)
{
	map->texture = gz_gl_texture(GL_TEXTURE_2D);
	glTexStorage2D(GL_TEXTURE_2D, 1, GL_DEPTH_COMPONENT32F, map->edge, map->edge);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
	glBindTexture(GL_TEXTURE_2D, 0);
}

static bool make_shadow_framebuffer(struct gz_raster_shadow_map *map)
{
	GLint before = 0;
	glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &before);
	glGenFramebuffers(1, &map->framebuffer);
	glBindFramebuffer(GL_FRAMEBUFFER, map->framebuffer);
	glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, map->texture, 0);
	glDrawBuffer(GL_NONE);
	glReadBuffer(GL_NONE);
	const bool complete = glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
	glBindFramebuffer(GL_FRAMEBUFFER, (GLuint)before);
	return complete;
}

enum gz_result gz_raster_shadow_reserve(struct gz_raster_shadow_map *map,
					const struct gz_gl_device *device, int edge,
					const struct gz_log *log)
{
	if (map->texture && map->edge == edge)
		return GZ_OK;
	gz_raster_shadow_free(map);
	map->edge = edge;
	make_shadow_texture(map);
	const bool complete = make_shadow_framebuffer(map);
	enum gz_result result = gz_gl_device_errors(device);
	if (result == GZ_OK && !complete)
		result = GZ_ERR_UNSUPPORTED;
	if (result == GZ_OK)
		return GZ_OK;
	gz_err(log, "the graphics device has no room for a shadow map of %d x %d: %s", edge, edge,
	       gz_result_text(result));
	gz_raster_shadow_free(map);
	return result;
}

void gz_raster_shadow_draw(struct gz_raster_shadow_map *map, const struct gz_raster_shadow *view,
			   const struct gz_raster_meshes *meshes)
{
	static const GLfloat farthest = 1;
	if (map->serial != meshes->serial || memcmp(&map->drawn, view, sizeof *view) != 0) {
		glBindFramebuffer(GL_FRAMEBUFFER, map->framebuffer);
		glViewport(0, 0, map->edge, map->edge);
		glEnable(GL_DEPTH_TEST);
		glDepthMask(GL_TRUE);
		glClearBufferfv(GL_DEPTH, 0, &farthest);
		gz_raster_meshes_draw(meshes);
		map->drawn = *view;
		map->serial = meshes->serial;
	}
	glActiveTexture(GL_TEXTURE0 + GZ_RASTER_UNIT_SHADOW);
	glBindTexture(GL_TEXTURE_2D, map->texture);
	glActiveTexture(GL_TEXTURE0);
}

void gz_raster_shadow_free(struct gz_raster_shadow_map *map)
{
	if (map->framebuffer)
		glDeleteFramebuffers(1, &map->framebuffer);
	if (map->texture)
		glDeleteTextures(1, &map->texture);
	*map = (struct gz_raster_shadow_map) { 0 };
}
