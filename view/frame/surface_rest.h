/**
 * @file
 * When an isovalue that is being changed rests. Making triangles takes longer than a frame, so the
 * window makes them only then; until then rays find the surface in the voxels.
 */
#ifndef GZ_VIEW_FRAME_ISOVALUE_REST_H
#define GZ_VIEW_FRAME_ISOVALUE_REST_H

#include <stdbool.h>
#include <stdint.h>

/** How long an isovalue stays until it rests, ns. Chosen: longer than the pauses of a hand that is
 *  still looking for it. */
#define GZ_ISOVALUE_REST_NS INT64_C(300000000)

/** The isovalue of the last step. Zero-initialised, it knows none. */
struct gz_isovalue_rest {
	bool known; /**< there was a step: value is valid */
	bool moves; /**< it has changed and does not rest yet */
	double value;
	int64_t changed_ns; /**< when it last changed */
};

/**
 * Take the isovalue of now. The first one rests at once.
 *
 * @param isovalue  not NaN
 * @param held      the user still holds the mouse: it does not rest, however long it stays
 * @param now_ns    of any clock that does not go back
 * @return whether it moves
 */
bool gz_isovalue_rest_step(struct gz_isovalue_rest *rest, double isovalue, bool held,
			   int64_t now_ns);

/** Time until an isovalue that moves rests if nothing changes and nobody holds it, ns; 0: now.
 *  @param rest  moves */
int64_t gz_isovalue_rest_left_ns(const struct gz_isovalue_rest *rest, int64_t now_ns);

#endif
