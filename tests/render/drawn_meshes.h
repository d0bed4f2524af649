/**
 * @file
 * Meshes of formulas and what a camera sees of them, computed ray by ray, for the tests of
 * stipples and hatches. A mesh has the number 1.
 */
#ifndef GZ_TESTS_RENDER_DRAWN_MESHES_H
#define GZ_TESTS_RENDER_DRAWN_MESHES_H

#include "render/illustration/hatch_strokes.h"
#include "render/illustration/stipple_view.h"
#include "render/mesh/mesh.h"
#include "render/picture/camera.h"

/** Edge of the board and radius of the ball, mm. */
#define DRAWN_BOARD_MM 100.0
#define DRAWN_BALL_MM  50.0

/** What is seen: a square board in the plane z = 0 that faces +z, centred at the origin, or a ball
 *  there. */
enum drawn_body { DRAWN_BOARD, DRAWN_BALL };

/** Make the mesh of a body. */
struct gz_mesh drawn_mesh(enum drawn_body body);

/** Distance of the nodes of a stroke of drawn_strokes_make(), mm. */
#define DRAWN_STROKE_MM 0.8

/**
 * Trace strokes over the mesh of a body.
 *
 * @param layers  1: those round the y axis; 2: others that cross them, too
 * @param[out] out_strokes  of each layer; the caller frees them with gz_hatch_strokes_free()
 * @return what gz_mesh_points_make() or gz_hatch_strokes_make() returns
 */
enum gz_result drawn_strokes_make(const struct gz_mesh *mesh, int layers,
				  struct gz_hatch_strokes *out_strokes);

/** A picture of a body. */
struct drawn_picture {
	struct gz_ray_frame rays;
	struct gz_plane tone, depth, ids;
	struct gz_stipple_view view; /**< 1 mm is 1/100 of the world; points into this struct */
};

/** Look at a body; the shading map is @p tone everywhere. @p picture must stay where it is, is
 *  zero-initialised or was used before, and is freed with drawn_picture_free(). */
void drawn_picture_make(enum drawn_body body, const struct gz_camera *camera, int edge_px,
			float tone, struct drawn_picture *picture);

/** Free the planes. */
void drawn_picture_free(struct drawn_picture *picture);

/** A camera over the origin, @p tilt_deg from the z axis: orthographic with a view of @p height
 *  mm, or in perspective from @p height mm away with a field of view of 60 degrees. */
struct gz_camera drawn_camera(enum gz_projection projection, double height, double tilt_deg);

/** Set a value of a GZ_PLANE_VALUE. */
void drawn_set_value(struct gz_plane *plane, int x, int y, float value);

#endif
