/**
 * @file
 * A volume and a ball of triangles in one picture, for the tests of techniques that share one.
 */
#ifndef GZ_TESTS_RENDER_JOINED_SCENE_H
#define GZ_TESTS_RENDER_JOINED_SCENE_H

#include "mesh_fields.h"
#include "render/frame/picture_maker.h"
#include "render/mesh/mesh.h"
#include "render/raycast/shared/ray_params.h"

/** Of pictures, px, and of the volume, voxels of 1 mm. */
enum { WIDTH = 150, HEIGHT = 110, EDGE = 64 };

/** Of the ball, mm. */
#define BALL_RADIUS 8.0

/** How close to the ball's rim a ray meets the formula or the mesh by chance, mm. */
#define RIM 0.15

/** Where joined_set_up() puts the eye. */
extern const struct gz_camera JOINED_CAMERA;

/** A volume, a mesh of a ball, and what makes pictures of both. */
struct joined {
	struct gz_volume volume;
	struct gz_mesh ball;
	struct gz_transfer transfer;
	struct gz_camera camera;
	struct gz_ray_params rays;
	struct gz_foveation foveation;
	struct gz_display display;
	struct gz_object objects[2]; /**< the volume, the ball */
	double centre[3];            /**< of the ball, mm */
	const char *backend;
	struct gz_picture_maker *maker;
	struct gz_image *image; /**< of the last picture */
	struct gz_picture_cost cost;
};

/** Make a volume of a formula with a transfer function from 0 to 1, and a ball that has its own
 *  colour whatever its slope. */
void joined_set_up(field_formula *formula, const double centre[3], struct joined *joined);

/** Move the ball: mm. It is another one for what has seen it before. */
void joined_move_ball(const double centre[3], struct joined *joined);

/** Free all of it. */
void joined_take_down(struct joined *joined);

/** The request for a picture. */
struct gz_picture_request joined_request(const struct joined *joined);

/** Make a picture of the first @p object_count objects by a maker of its own. */
void joined_draw(const struct gz_backend_params *params, size_t object_count,
		 struct joined *joined);

/** A copy of a picture; gz_image_free(). */
struct gz_image joined_copy(const struct gz_image *image);

/** A ray of the reference, world units; the direction has length 1. */
struct ray {
	double origin[3], direction[3];
};

/** The ray of a pixel. */
struct ray joined_ray(const struct joined *joined, int x, int y);

/** Where a ray meets the ball, world units; INFINITY: nowhere. @param[out] out_rim  how far it
 *  passes inside the rim, or outside of it if negative, mm */
double joined_meet_ball(const struct joined *joined, const struct ray *ray, double *out_rim);

/** The part of a ray in the volume's box. */
void joined_cut_by_box(const struct ray *ray, double *from, double *to);

#endif
