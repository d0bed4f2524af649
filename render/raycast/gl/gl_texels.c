#include "render/raycast/gl/gl_texels.h"

#include <GL/glew.h>

const struct gz_gl_texel_format *gz_gl_texel_format(enum gz_gl_texels texels,
						    enum gz_voxel_type type)
{
	static const struct gz_gl_texel_format packed[GZ_VOXEL_TYPE_COUNT] = {
		[GZ_VOXEL_U8] = { GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, 4 },
		[GZ_VOXEL_U16] = { GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, 4 },
		[GZ_VOXEL_F32] = { GL_R32F, GL_RED, GL_FLOAT, 4 },
	};
	static const struct gz_gl_texel_format single[GZ_VOXEL_TYPE_COUNT] = {
		[GZ_VOXEL_U8] = { GL_R8UI, GL_RED_INTEGER, GL_UNSIGNED_BYTE, 1 },
		[GZ_VOXEL_U16] = { GL_R16UI, GL_RED_INTEGER, GL_UNSIGNED_SHORT, 2 },
		[GZ_VOXEL_F32] = { GL_R32F, GL_RED, GL_FLOAT, 4 },
	};
	return texels == GZ_GL_TEXELS_PACKED ? &packed[type] : &single[type];
}
