#include "render/slices/slices_technique.h"

#include <string.h>

#include "render/raycast/shared/ray_params.h"

static size_t slices_bind(void *settings, struct gz_option_binding *out_bindings, size_t room)
{
	struct gz_option_binding bindings[GZ_RAY_BINDINGS];
	gz_ray_params_bind(settings, bindings);
	bindings[GZ_RAY_SAMPLE_BINDINGS] = bindings[GZ_RAY_BINDING_SLICES];
	const size_t own = GZ_RAY_SAMPLE_BINDINGS + 1;
	const size_t count = room < own ? room : own;
	memcpy(out_bindings, bindings, count * sizeof bindings[0]);
	return own;
}

static const char *const slices_backends[] = { "gl", NULL };

const struct gz_technique gz_slices_technique = {
	.name = "slices",
	.help = "draws a volume as slices across the view, coloured by its transfer function",
	.shows = GZ_OBJECT_VOLUME | GZ_OBJECT_PARTICLES,
	.objects_max = 1,
	.backends = slices_backends,
	.check = gz_slices_check,
	.create = gz_slices_create,
	.settings_size = sizeof(struct gz_ray_params),
	.bind = slices_bind,
};
