#include "render/light/environment.h"

#include <math.h>

#include "base/vector.h"

static const char *const surroundings_names[] = { "none", "sky", "cube", NULL };

#define AT(field) offsetof(struct gz_environment, field)

const struct gz_option gz_environment_options[] = {
	{ "environment.kind", GZ_OPTION_CHOICE, AT(kind), .choices = surroundings_names,
	  .preset = "none",
	  .help = "surroundings: none (render.background), sky (with a sun) or cube (six "
		  "pictures)" },
	{ "environment.cube", GZ_OPTION_STRING, AT(cube), .max = GZ_PATH_SIZE, .preset = "",
	  .help = "cube: folder of right, left, front, back, up and down.png; searched beside the "
		  "scene, then under $GAZECAST_DATA" },
	{ "environment.up", GZ_OPTION_DOUBLE, AT(up), -1e6, 1e6, .count = 3, .preset = "0 0 1",
	  .help = "direction of the zenith, any length" },
	{ "environment.horizon", GZ_OPTION_DOUBLE, AT(horizon), 0, 1, .count = 3,
	  .preset = "0.78 0.84 0.9", .help = "red, green and blue of the sky at the horizon" },
	{ "environment.zenith", GZ_OPTION_DOUBLE, AT(zenith), 0, 1, .count = 3,
	  .preset = "0.22 0.42 0.72", .help = "red, green and blue of the sky overhead" },
	{ "environment.floor", GZ_OPTION_BOOL, AT(floor), .preset = "yes",
	  .help = "checkered floor under the volume's box" },
	{ "environment.tile", GZ_OPTION_DOUBLE, AT(tile), 0.001, 1000, .preset = "0.125",
	  .help = "edge of a floor tile, world units" },
	{ "environment.bright", GZ_OPTION_DOUBLE, AT(bright), 0, 1, .count = 3,
	  .preset = "0.85 0.83 0.8", .help = "red, green and blue of every other floor tile" },
	{ "environment.dark", GZ_OPTION_DOUBLE, AT(dark), 0, 1, .count = 3,
	  .preset = "0.25 0.27 0.3", .help = "red, green and blue of the floor's other tiles" },
};
const size_t gz_environment_option_count =
	sizeof gz_environment_options / sizeof gz_environment_options[0];

bool gz_environment_valid(const struct gz_environment *environment)
{
	const double *up = environment->up;
	return gz_options_hold(gz_environment_options, gz_environment_option_count, environment) &&
	       (up[0] != 0 || up[1] != 0 || up[2] != 0);
}

void gz_environment_axes(const struct gz_environment *environment, double out_axes[3][3])
{
	double *up = out_axes[0], least[3] = { 0, 0, 0 };
	int axis = 0;
	for (int i = 0; i < 3; i++)
		up[i] = environment->up[i];
	(void)gz_normalise3(up);
	for (int i = 1; i < 3; i++)
		if (fabs(up[i]) < fabs(up[axis]))
			axis = i;
	least[axis] = 1;
	gz_cross3(up, least, out_axes[1]);
	(void)gz_normalise3(out_axes[1]);
	gz_cross3(up, out_axes[1], out_axes[2]);
}
