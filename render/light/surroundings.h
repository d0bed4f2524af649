/**
 * @file
 * struct gz_environment in the form that kernels and shaders take: numbers of single precision, in
 * a unit of length that the caller chooses.
 */
#ifndef GZ_RENDER_LIGHT_SURROUNDINGS_H
#define GZ_RENDER_LIGHT_SURROUNDINGS_H

#include <stdbool.h>
#include <stdint.h>

#include "render/light/cube.h"
#include "render/light/environment.h"
#include "render/light/light.h"

/** What rays that leave the scene see. */
struct gz_seen_surroundings {
	enum gz_surroundings kind; /**< NONE: everything is the horizon's colour */
	const uint32_t *texels;    /**< CUBE: as in struct gz_cube; borrowed */
	int edge;
	bool floor; /**< SKY: there is one */
	/** Unit vectors. SKY: up, and two along the floor. CUBE: right, front and up. */
	float axes[3][3];
	float sun[3];       /**< SKY: unit vector towards the light */
	float floor_height; /**< along up, from the middle of the volume's box */
	float tiles_per_length, fade_per_length;
	float horizon[3], zenith[3];
	float bright[3], dark[3]; /**< of tiles, lit */
};

/** What they are made of. All pointers are borrowed. */
struct gz_surroundings_request {
	const struct gz_environment *environment;
	const struct gz_cube *cube; /**< pictures for GZ_SURROUNDINGS_CUBE; without an edge: NONE */
	const struct gz_light *light;
	const double *background; /**< red, green and blue of NONE */
	const double *half;       /**< half extents of the volume's box, world units */
	const float *towards;     /**< unit vector towards the light, in world directions */
	double lengths_a_unit;    /**< of the wanted unit of length in a world unit */
};

/** Make them. @p out_seen borrows the cube's texels. */
void gz_seen_surroundings_make(const struct gz_surroundings_request *request,
			       struct gz_seen_surroundings *out_seen);

#endif
