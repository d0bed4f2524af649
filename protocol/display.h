/**
 * @file
 * Display geometry: what turns a place on the screen into visual angle.
 *
 * Gaze on screen is in the normalised active display area: origin top left, (1, 1) bottom right;
 * values outside [0, 1] are legal (looking past the edge).
 */
#ifndef GZ_PROTOCOL_DISPLAY_H
#define GZ_PROTOCOL_DISPLAY_H

#include <stdbool.h>

/** A place on the normalised display area. */
struct gz_point {
	float x, y;
};

/** Most pixels a side of a display may have. */
#define GZ_DISPLAY_SIDE_MAX_PX 32768

/** A flat display seen from straight in front of its centre. */
struct gz_display {
	int px[2];          /**< pixels, width and height; 1 to 32768 */
	double mm[2];       /**< size of the active area, mm; above 0 */
	double distance_mm; /**< from the eye to the centre of the display; above 0 */
};

/**
 * The geometry assumed when nothing better is known: 50.4 degrees wide seen from 600 mm, square
 * pixels, at any pixel size (the display of Bauer 2018, section 2.4: 2263 pixels over 50.4
 * degrees).
 */
struct gz_display gz_display_default(int width_px, int height_px);

/** Whether every field is finite and in its range. */
bool gz_display_valid(const struct gz_display *display);

/**
 * Where a point of the screen is in the eye's frame, mm: +x right, +y down, +z from the eye towards
 * the display.
 */
void gz_display_to_mm(const struct gz_display *display, struct gz_point point, double out_mm[3]);

/** Angle at the eye between two points of the screen, degrees, 0 to 180. NaN where a point is NaN.
 */
double gz_display_angle_deg(const struct gz_display *display, struct gz_point a, struct gz_point b);

/** Pixels per degree at the centre of the display, horizontally. */
double gz_display_px_per_deg(const struct gz_display *display);

#endif
