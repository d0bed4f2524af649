/**
 * @file
 * The gl backend: OpenGL 4.3 compute shaders over the plan's tiles. It takes the samples that the
 * cpu backend takes, so pictures differ only by rounding.
 */
#ifndef GZ_RENDER_RAYCAST_GL_GL_RAYCASTER_H
#define GZ_RENDER_RAYCAST_GL_GL_RAYCASTER_H

#include "render/raycast/shared/raycaster.h"

extern const struct gz_raycaster_ops gz_gl_raycaster_ops;

/** How tests change what a device does. */
struct gz_gl_raycaster_hooks {
	bool as_hardware;    /**< take the paths for a graphics device on any device */
	int volume_edge_max; /**< show volumes with a longer edge, voxels, by bricks, as with a
				  driver with smaller textures; 0 = the driver's own limit */
};

/** Make a ray caster of this backend with hooks. @return what gz_raycaster_create() returns */
enum gz_result gz_gl_raycaster_create(const struct gz_backend_params *params,
				      const struct gz_gl_raycaster_hooks *hooks,
				      const struct gz_log *log,
				      struct gz_raycaster **out_raycaster);

#endif
