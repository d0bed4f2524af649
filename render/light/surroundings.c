#include "render/light/surroundings.h"

#include <math.h>

static void fill_axes(const struct gz_surroundings_request *request,
		      struct gz_seen_surroundings *seen)
{
	double axes[3][3], lowest = 0;
	if (request->environment->kind == GZ_SURROUNDINGS_CUBE)
		gz_cube_axes(request->environment->up, axes);
	else
		gz_environment_axes(request->environment, axes);
	for (int axis = 0; axis < 3; axis++) {
		lowest -= fabs(axes[0][axis]) * request->half[axis];
		seen->sun[axis] = request->towards[axis];
		for (int i = 0; i < 3; i++)
			seen->axes[i][axis] = (float)axes[i][axis];
	}
	seen->floor_height = (float)(lowest * request->lengths_a_unit);
}

static void fill_colours(const struct gz_surroundings_request *request,
			 struct gz_seen_surroundings *seen)
{
	const struct gz_environment *environment = request->environment;
	double overhead = 0;
	for (int axis = 0; axis < 3; axis++)
		overhead += (double)seen->axes[0][axis] * (double)seen->sun[axis];
	const double lamp = request->light->ambient + request->light->diffuse * fmax(overhead, 0);
	for (int i = 0; i < 3; i++) {
		seen->horizon[i] =
			(float)(seen->kind == GZ_SURROUNDINGS_SKY ? environment->horizon[i]
								  : request->background[i]);
		seen->zenith[i] = (float)environment->zenith[i];
		seen->bright[i] = (float)(environment->bright[i] * lamp);
		seen->dark[i] = (float)(environment->dark[i] * lamp);
	}
}

void gz_seen_surroundings_make(const struct gz_surroundings_request *request,
			       struct gz_seen_surroundings *out_seen)
{
	const struct gz_environment *environment = request->environment;
	const bool pictures = environment->kind == GZ_SURROUNDINGS_CUBE;
	*out_seen = (struct gz_seen_surroundings) {
		.kind = pictures && !request->cube->edge ? GZ_SURROUNDINGS_NONE
							 : (enum gz_surroundings)environment->kind,
		.texels = request->cube->texels,
		.edge = request->cube->edge,
		.floor = environment->floor,
		.tiles_per_length = (float)(1 / (environment->tile * request->lengths_a_unit)),
		.fade_per_length = (float)(1 / ((double)GZ_FLOOR_HALF * request->lengths_a_unit)),
	};
	fill_axes(request, out_seen);
	fill_colours(request, out_seen);
}
