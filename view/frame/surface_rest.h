/**
 * @file
 * When a volume's surface that is being changed rests. Making triangles takes longer than a frame,
 * so the window makes them only then; until then rays find the surface in the voxels.
 */
#ifndef GZ_VIEW_FRAME_SURFACE_REST_H
#define GZ_VIEW_FRAME_SURFACE_REST_H

#include <stdbool.h>
#include <stdint.h>

/** How long a surface stays until it rests, ns. Chosen: longer than the pauses of a hand that is
 *  still looking for an isovalue or a time point. */
#define GZ_SURFACE_REST_NS INT64_C(300000000)

/** What a surface is made of. */
struct gz_surface_state {
	double isovalue; /**< not NaN */
	int time_point;  /**< of the volume */
};

/** The surface of the last step. Zero-initialised, it knows none. */
struct gz_surface_rest {
	bool known; /**< there was a step: state is valid */
	bool moves; /**< it has changed and does not rest yet */
	struct gz_surface_state state;
	int64_t changed_ns; /**< when it last changed */
};

/**
 * Take the surface of now. The first one rests at once.
 *
 * @param held    the user still holds the mouse, or time points play: a surface that moves does not
 *                rest, however long it stays
 * @param now_ns  of any clock that does not go back
 * @return whether it moves
 */
bool gz_surface_rest_step(struct gz_surface_rest *rest, const struct gz_surface_state *state,
			  bool held, int64_t now_ns);

/** Time until a surface that moves rests if nothing changes and nothing holds it, ns; 0: now.
 *  @param rest  moves */
int64_t gz_surface_rest_left_ns(const struct gz_surface_rest *rest, int64_t now_ns);

#endif
