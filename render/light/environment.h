/**
 * @file
 * What surrounds the picture's objects: section [environment] of a scene. Surfaces of glass and
 * water show it, and so does what is behind everything. It is a sky, or six pictures
 * (render/light/cube.h).
 *
 * The sky in the unit direction d, with U the unit vector up and L the one towards the light:
 *
 *   h = max(d.U, 0)
 *   sky = horizon + h (2 - h) (zenith - horizon)
 *   s = clamp((d.L - GZ_SUN_RIM) / (GZ_SUN_DISC - GZ_SUN_RIM), 0, 1)^2
 *   colour = sky + s (1 - sky)
 *
 * The floor is a plane across U through the lowest corner of the volume's box. A ray from above it
 * that goes down meets it after t world units at p. With A and B unit vectors along the floor and
 * e the edge of a tile,
 *
 *   tile = floor(p.A / e) + floor(p.B / e) is odd ? dark : bright
 *   f = 2^(-t / GZ_FLOOR_HALF)
 *   colour = horizon + f (tile (ambient + diffuse max(L.U, 0)) - horizon)
 *
 * so that it fades before its tiles are finer than pixels. Nothing casts a shadow on it.
 */
#ifndef GZ_RENDER_LIGHT_ENVIRONMENT_H
#define GZ_RENDER_LIGHT_ENVIRONMENT_H

#include <stdbool.h>
#include <stddef.h>

#include "base/option.h"
#include "base/sizes.h"
#include "render/light/light_constants.h"

/** What the surroundings are. */
enum gz_surroundings {
	GZ_SURROUNDINGS_NONE, /**< render.background on all sides */
	GZ_SURROUNDINGS_SKY,  /**< a sky with a sun where the light comes from */
	GZ_SURROUNDINGS_CUBE, /**< six pictures; without their folder as GZ_SURROUNDINGS_NONE */
};

/** The surroundings. */
struct gz_environment {
	int kind;                /**< enum gz_surroundings */
	char cube[GZ_PATH_SIZE]; /**< folder of six pictures, as the scene names it; "": none */
	/** Where that folder is: gz_scene_find_cube(). "": none. No option, as it follows from the
	 *  name. Techniques read the pictures when they draw. */
	char cube_path[GZ_PATH_SIZE];
	double up[3];      /**< any length but 0 */
	double horizon[3]; /**< colours, [0, 1] each */
	double zenith[3];
	bool floor;       /**< a checkered floor under the volume's box */
	double tile;      /**< edge of a floor tile, world units */
	double bright[3]; /**< colours of floor tiles, [0, 1] each */
	double dark[3];
};

/** Table over struct gz_environment: "environment.…". */
extern const struct gz_option gz_environment_options[];
extern const size_t gz_environment_option_count;

/** Whether every field is within its range and up is not zero. */
bool gz_environment_valid(const struct gz_environment *environment);

/** Unit vectors up and along the floor: @p out_axes [0] is up, the others are across it. */
void gz_environment_axes(const struct gz_environment *environment, double out_axes[3][3]);

#endif
