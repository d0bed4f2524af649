#include "render/light/gl/gl_cube.h"

#include <GL/glew.h>

#define GZ_LOG_MODULE "light"

static enum gz_result upload_cube(struct gz_gl_cube *cube, const struct gz_gl_device *device,
				  const struct gz_cube_pictures *pictures, const struct gz_log *log)
{
	const int side = pictures->cube.edge + 2; /* with the rim */
	gz_gl_cube_free(cube);
	cube->texture = gz_gl_texture(GL_TEXTURE_2D_ARRAY);
	glTexStorage3D(GL_TEXTURE_2D_ARRAY, 1, GL_RGBA8, side, side, GZ_CUBE_FACES);
	glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
	glTexSubImage3D(GL_TEXTURE_2D_ARRAY, 0, 0, 0, 0, side, side, GZ_CUBE_FACES, GL_RGBA,
			GL_UNSIGNED_BYTE, pictures->cube.texels);
	const enum gz_result result = gz_gl_device_errors(device);
	if (result != GZ_OK) {
		gz_err(log,
		       "the graphics device does not take six pictures of %d x %d: %s; take "
		       "--backend cpu",
		       pictures->cube.edge, pictures->cube.edge, gz_result_text(result));
		gz_gl_cube_free(cube);
		return result;
	}
	cube->serial = pictures->serial;
	return GZ_OK;
}

enum gz_result gz_gl_cube_bind(struct gz_gl_cube *cube, const struct gz_gl_device *device,
			       const struct gz_cube_pictures *pictures, unsigned unit,
			       const struct gz_log *log)
{
	if (!pictures->cube.edge)
		return GZ_OK;
	glActiveTexture(GL_TEXTURE0 + unit);
	enum gz_result result = GZ_OK;
	if (!cube->texture || cube->serial != pictures->serial)
		result = upload_cube(cube, device, pictures, log);
	glBindTexture(GL_TEXTURE_2D_ARRAY, cube->texture);
	glActiveTexture(GL_TEXTURE0);
	return result;
}

void gz_gl_cube_free(struct gz_gl_cube *cube)
{
	if (cube->texture)
		glDeleteTextures(1, &cube->texture);
	*cube = (struct gz_gl_cube) { 0 };
}
