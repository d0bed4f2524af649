/**
 * @file
 * The technique `isosurface`: surfaces of volumes, and meshes, by rays through a tree of triangles
 * or as triangles by OpenGL.
 */
#ifndef GZ_RENDER_SURFACE_ISOSURFACE_TECHNIQUE_H
#define GZ_RENDER_SURFACE_ISOSURFACE_TECHNIQUE_H

#include "render/technique/technique.h"

/** Its settings are a struct gz_ray_params. Of a volume it shows the surface where the data are
 *  surface.isovalue. "auto" is cpu, whose shadows and refractions are exact, or gl in a build
 *  without Embree. There cpu and cast_hits return GZ_ERR_UNSUPPORTED and log what is missing. */
extern const struct gz_technique gz_isosurface_technique;

/* Within this room: */

/** The functions of the row; see struct gz_technique. */
enum gz_result gz_isosurface_check(const char *backend, const struct gz_backend_params *params,
				   const struct gz_log *log);
enum gz_result gz_isosurface_create(const char *backend, const struct gz_backend_params *params,
				    const struct gz_log *log, struct gz_drawer **out_drawer);

#endif
