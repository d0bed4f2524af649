/* In place of the drawer where Embree was not found when the project was built. */
#include "render/surface/isosurface_technique.h"

#define GZ_LOG_MODULE "isosurface"

enum gz_result gz_isosurface_check(const char *backend, const struct gz_backend_params *params,
				   const struct gz_log *log)
{
	(void)backend;
	(void)params;
	gz_err(log, "the technique isosurface is not in this build, because it was made without "
		    "Embree; install it (libembree-dev) and build again, or take raycast");
	return GZ_ERR_UNSUPPORTED;
}

enum gz_result gz_isosurface_create(const char *backend, const struct gz_backend_params *params,
				    const struct gz_log *log, struct gz_drawer **out_drawer)
{
	(void)out_drawer;
	return gz_isosurface_check(backend, params, log);
}
