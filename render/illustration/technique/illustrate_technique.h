/**
 * @file
 * The technique `illustrate`: surfaces of volumes and labels, and meshes, shaded by a shading map.
 */
#ifndef GZ_RENDER_ILLUSTRATION_TECHNIQUE_ILLUSTRATE_TECHNIQUE_H
#define GZ_RENDER_ILLUSTRATION_TECHNIQUE_ILLUSTRATE_TECHNIQUE_H

#include "render/technique/technique.h"

/** Its settings are a struct gz_ray_params, of which it uses illustration, clip and
 *  surface.isovalue. "auto" is cpu, or gl in a build without Embree; there cpu returns
 *  GZ_ERR_UNSUPPORTED and logs what is missing. */
extern const struct gz_technique gz_illustrate_technique;

/* Within this room: */

/** The functions of the row; see struct gz_technique. */
enum gz_result gz_illustrate_check(const char *backend, const struct gz_backend_params *params,
				   const struct gz_log *log);
enum gz_result gz_illustrate_create(const char *backend, const struct gz_backend_params *params,
				    const struct gz_log *log, struct gz_drawer **out_drawer);

#endif
