#include "render/illustration/technique/illustrate_technique.h"

#include "render/raycast/shared/ray_params.h"

/* Most objects of a picture. Chosen: an atlas of the brain has 116 regions. */
enum { SURFACES_MAX = 1024 };

/* The clip region, the isovalue, and all that says how surfaces are shaded. */
static size_t illustrate_bind(void *settings, struct gz_option_binding *out_bindings, size_t room)
{
	enum { OWN = 2 + GZ_ILLUSTRATION_BINDINGS };
	struct gz_option_binding bindings[GZ_RAY_BINDINGS], own[OWN];
	gz_ray_params_bind(settings, bindings);
	own[0] = bindings[GZ_RAY_BINDING_CLIP];
	own[1] = bindings[GZ_RAY_BINDING_SURFACE];
	own[1].count = GZ_ISOVALUE_OPTIONS;
	for (size_t i = 2; i < OWN; i++)
		own[i] = bindings[GZ_RAY_BINDING_ILLUSTRATION + i - 2];
	for (size_t i = 0; i < OWN && i < room; i++)
		out_bindings[i] = own[i];
	return OWN;
}

static const char *const illustrate_backends[] = { "gl", "cpu", NULL };

const struct gz_technique gz_illustrate_technique = {
	.name = "illustrate",
	.help = "shades surfaces so that form and place are easy to see",
	.stylised = true,
	.shows = GZ_OBJECT_VOLUME | GZ_OBJECT_LABELS | GZ_OBJECT_MESH | GZ_OBJECT_PARTICLES,
	.objects_max = SURFACES_MAX,
	.backends = illustrate_backends,
	.whole_pictures = true, /* its histogram is that of all pixels */
	.sharing = GZ_SHARES_NOT,
	.check = gz_illustrate_check,
	.create = gz_illustrate_create,
	.settings_size = sizeof(struct gz_ray_params),
	.bind = illustrate_bind,
};
