/**
 * @file
 * Parts of the procedural volumes; internal to them. gz_volume_generate() is in volume.h.
 */
#ifndef GZ_RENDER_DATA_PROCEDURAL_H
#define GZ_RENDER_DATA_PROCEDURAL_H

#include "render/data/volume.h"

/** Gradient noise at a point, about -1 to 1; coordinates within ±2³⁰. It uses + - * / alone, so the
 *  bits are the same on every machine. Perlin, "Improving noise", SIGGRAPH 2002. */
double gz_noise(const double p[3]);

/** All tubes of the animal, and how finely they are drawn. */
struct gz_chameleon;

/**
 * Lay out the animal for voxels of @p voxel_length, in units of half the longest edge of the box:
 * what is thinner becomes fainter instead of broken. The caller frees it with
 * gz_chameleon_destroy().
 *
 * @retval GZ_ERR_NO_MEM
 */
enum gz_result gz_chameleon_create(double voxel_length, struct gz_chameleon **out_chameleon);

/** Accepts NULL and half-built ones. */
void gz_chameleon_destroy(struct gz_chameleon **chameleon);

/** One row of values. */
struct gz_chameleon_row {
	double y, z;  /**< of the row, -1 to 1 */
	double first; /**< x of the first value, -1 to 1 */
	double step;  /**< from one x to the next, above 0 */
	int count;    /**< of values */
};

/** Compute one row, values 0 to 1. Threads: any number may use the same @p chameleon. */
void gz_chameleon_draw_row(const struct gz_chameleon *chameleon, const struct gz_chameleon_row *row,
			   float *out_values);

enum { GZ_SPLASH_FINGERS = 15 };

/** A cone with round ends; a ball where both ends are one point. */
struct gz_blob {
	double from[3], axis[3]; /**< one end, and the way to the other */
	double squared_length;   /**< of the axis */
	double radius[2];        /**< at either end */
};

/** The splash of a drop in a puddle. Owns nothing. */
struct gz_splash {
	double fingers[GZ_SPLASH_FINGERS][2]; /**< directions of the crown's fingers */
	struct gz_blob blobs[4 * GZ_SPLASH_FINGERS + 3];
	int count; /**< of blobs */
};

/** Lay out all bodies of the splash. */
void gz_splash_lay_out(struct gz_splash *splash);

/** How much of a point is liquid, 0 to 1 and 0.5 at the surface; z is up. @param p  -1 to 1 */
double gz_splash_at(const struct gz_splash *splash, const double p[3]);

#endif
