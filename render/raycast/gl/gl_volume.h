/**
 * @file
 * A volume and its macrocells as textures. All calls need the context current.
 */
#ifndef GZ_RENDER_RAYCAST_GL_GL_VOLUME_H
#define GZ_RENDER_RAYCAST_GL_GL_VOLUME_H

#include "base/result.h"
#include "render/data/volume.h"
#include "render/opengl/gl_device.h"
#include "render/raycast/gl/gl_texels.h"
#include "render/raycast/shared/macrocells.h"

/** Textures; names of OpenGL, 0: none. Zero-initialised holds nothing. */
struct gz_gl_volume {
	unsigned voxels, reach;
	enum gz_gl_texels texels; /**< bricks: voxels is another's */
};

/**
 * Give the device a whole volume in memory, in place of what was there: packed, or where that has
 * no room in voxels of their own size. Nothing is logged.
 *
 * @retval GZ_ERR_UNSUPPORTED  an edge is beyond the device's 3D textures
 * @retval GZ_ERR_NO_MEM       the device has no room for it
 * @retval GZ_ERR_NO_DEVICE    the context is lost
 */
enum gz_result gz_gl_volume_load(struct gz_gl_volume *gl, const struct gz_gl_device *device,
				 const struct gz_volume *volume);

/** The voxels are bricks in an atlas, which stays another's. In place of what was there. */
void gz_gl_volume_lend(struct gz_gl_volume *gl, unsigned atlas);

/** Give the device the reach of classified cells, always of the same volume. */
void gz_gl_volume_classify(struct gz_gl_volume *gl, const struct gz_macrocells *cells);

/** Bind both to their units, of textures and of images. */
void gz_gl_volume_bind(const struct gz_gl_volume *gl, enum gz_voxel_type type);

/** Delete the textures and zero the struct. */
void gz_gl_volume_free(struct gz_gl_volume *gl);

#endif
