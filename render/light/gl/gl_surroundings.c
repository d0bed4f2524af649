#include "render/light/gl/gl_surroundings.h"

#include <string.h>

/* Numbers of enum gz_surroundings as literals, since they are pasted into the shaders' text. */
#define SKY  1
#define CUBE 2

_Static_assert(SKY == GZ_SURROUNDINGS_SKY && CUBE == GZ_SURROUNDINGS_CUBE, "kinds are these");

#define TEXT_OF(number)      #number
#define DEFINE(name, number) "#define " name " " TEXT_OF(number) "\n"

const char gz_gl_surroundings_numbers[] =
	DEFINE("SURROUNDINGS_SKY", SKY) DEFINE("SURROUNDINGS_CUBE", CUBE);

static void copy3(const float from[3], float out[4])
{
	memcpy(out, from, 3 * sizeof *from);
	out[3] = 0;
}

void gz_gl_surroundings_fill(const struct gz_seen_surroundings *seen,
			     struct gz_gl_surroundings *out_around)
{
	*out_around = (struct gz_gl_surroundings) {
		.ground = { seen->floor_height, seen->tiles_per_length, seen->fade_per_length },
		.kind = { (int32_t)seen->kind, seen->floor, seen->edge },
	};
	for (int i = 0; i < 3; i++)
		copy3(seen->axes[i], out_around->axes[i]);
	copy3(seen->sun, out_around->sun);
	copy3(seen->horizon, out_around->horizon);
	copy3(seen->zenith, out_around->zenith);
	copy3(seen->bright, out_around->bright);
	copy3(seen->dark, out_around->dark);
}
