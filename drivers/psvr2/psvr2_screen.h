/**
 * @file
 * Where a ray from a head-worn tracker meets a flat screen that keeps its place before the head:
 * the picture a headset shows, or a chin rest before a monitor. Pure geometry.
 *
 * Frame: origin where the tracker has it (between the lenses), +x right, +y down, +z ahead, mm.
 */
#ifndef GZ_DRIVERS_PSVR2_SCREEN_H
#define GZ_DRIVERS_PSVR2_SCREEN_H

#include <stdbool.h>

#include "drivers/psvr2/psvr2_packet.h"
#include "protocol/display.h"

/** The screen as the configuration gives it. */
struct gz_psvr2_screen_params {
	double distance_mm;  /**< of its centre, along +z; above 0 */
	double offset_mm[2]; /**< of its centre, to the right and down */
	double size_mm[2];   /**< width and height; above 0 */
	double turn_deg[3];  /**< about its centre: yaw (its right side comes nearer), then pitch
				(its  lower edge comes nearer), then roll (clockwise) */
};

/** The screen as it is computed with; gz_psvr2_screen_make() fills it. */
struct gz_psvr2_screen {
	double centre_mm[3];
	double right[3], down[3], ahead[3]; /**< unit vectors; ahead is the normal */
	double size_mm[2];
};

/** Prepare @p params, which are in their ranges. */
struct gz_psvr2_screen gz_psvr2_screen_make(const struct gz_psvr2_screen_params *params);

/**
 * Where a ray meets the screen's plane.
 *
 * @param[out] out_point  normalised, origin top left, outside [0, 1] beside the screen; written on
 *                        true only
 * @return whether it does: false without origin or direction, where the ray leads away from the
 * plane, and where it is so nearly parallel, or meets it so far away, that the point says nothing
 * (85 degrees off the normal, chosen: no eye turns so far in a headset; a million screens)
 */
bool gz_psvr2_screen_meet(const struct gz_psvr2_screen *screen, const struct gz_psvr2_ray *ray,
			  struct gz_point *out_point);

#endif
