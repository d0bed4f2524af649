#include "render/surface/isosurface_technique.h"

#include <string.h>

#include "render/raycast/shared/ray_params.h"

/* Most objects of a picture. Chosen: an atlas of the brain has 116 regions. */
enum { SURFACES_MAX = 1024 };

static size_t isosurface_bind(void *settings, struct gz_option_binding *out_bindings, size_t room)
{
	struct gz_option_binding bindings[GZ_RAY_BINDINGS];
	gz_ray_params_bind(settings, bindings);
	const size_t own = GZ_RAY_SURFACE_BINDINGS;
	const size_t count = room < own ? room : own;
	memcpy(out_bindings, bindings, count * sizeof bindings[0]);
	return own;
}

static const char *const isosurface_backends[] = { "gl", "cpu", NULL };

const struct gz_technique gz_isosurface_technique = {
	.name = "isosurface",
	.help = "shows the surface where a volume has one value, labels and meshes",
	.shows = GZ_OBJECT_VOLUME | GZ_OBJECT_LABELS | GZ_OBJECT_MESH | GZ_OBJECT_PARTICLES,
	.objects_max = SURFACES_MAX,
	.backends = isosurface_backends,
	.sharing = GZ_SHARES_AS_OPAQUE,
	.check = gz_isosurface_check,
	.create = gz_isosurface_create,
	.settings_size = sizeof(struct gz_ray_params),
	.bind = isosurface_bind,
};
