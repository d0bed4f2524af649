/**
 * @file
 * The technique `slices`: a volume as slices across the view, blended one behind the other.
 */
#ifndef GZ_RENDER_SLICES_SLICES_TECHNIQUE_H
#define GZ_RENDER_SLICES_SLICES_TECHNIQUE_H

#include "render/technique/technique.h"

/** Its settings are a struct gz_ray_params. It shows one volume with its transfer function, as the
 *  ray caster does; slices.count takes the place of render.ray_sampling_rate. */
extern const struct gz_technique gz_slices_technique;

/* Within this room: */

/** The functions of the row; see struct gz_technique. */
enum gz_result gz_slices_check(const char *backend, const struct gz_backend_params *params,
			       const struct gz_log *log);
enum gz_result gz_slices_create(const char *backend, const struct gz_backend_params *params,
				const struct gz_log *log, struct gz_drawer **out_drawer);

#endif
