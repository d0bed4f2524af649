/**
 * @file
 * Display geometry: it relates places on the screen to visual angles.
 *
 * Points on the screen are normalised to the active display area: the origin is the top left
 * corner, (1, 1) the bottom right corner. Values outside [0, 1] are legal: a person can look past
 * the edge.
 */
#ifndef GZ_PROTOCOL_DISPLAY_H
#define GZ_PROTOCOL_DISPLAY_H

#include <stdbool.h>

/** A point in normalised display coordinates. */
struct gz_point {
	float x, y;
};

/** Most pixels of a side of a display. */
#define GZ_DISPLAY_SIDE_MAX_PX 32768

/** A flat display; the eye is straight in front of its centre. */
struct gz_display {
	int px[2];          /**< pixels, width and height; 1 to 32768 */
	double mm[2];       /**< size of the active area, mm; above 0 */
	double distance_mm; /**< from the eye to the centre of the display; above 0 */
};

/** Farthest corner of a monitor from the desktop's, px. Chosen: many displays side by side. */
#define GZ_MONITOR_PLACE_MAX_PX 1000000

/** Largest scale of a desktop. Chosen: none comes near it. */
#define GZ_MONITOR_SCALE_MAX 100

/** Where a monitor is on the desktop. Zero-initialised: unknown. */
struct gz_monitor_place {
	int at[2];    /**< its upper left corner, px */
	int px[2];    /**< width and height; 0: all is unknown */
	double scale; /**< of what the desktop shows on it: 1, 1.5, 2; 0: unknown */
};

/**
 * The geometry that is assumed if no other is known: 50.4 degrees wide at 600 mm, with square
 * pixels, for any number of pixels. It is the display of Bauer 2018, section 2.4: 2263 pixels
 * over 50.4 degrees.
 */
struct gz_display gz_display_default(int width_px, int height_px);

/** Whether every field is finite and within its range. */
bool gz_display_valid(const struct gz_display *display);

/** Whether all fields of two displays are equal. */
bool gz_display_same(const struct gz_display *a, const struct gz_display *b);

/**
 * The position of a point of the screen relative to the eye, mm: +x right, +y down, +z from the eye
 * to the display.
 */
void gz_display_to_mm(const struct gz_display *display, struct gz_point point, double out_mm[3]);

/** The visual angle between two points of the screen, degrees, 0 to 180. NaN if a point is NaN. */
double gz_display_angle_deg(const struct gz_display *display, struct gz_point a, struct gz_point b);

/** Pixels per degree of visual angle at the centre of the display, horizontally. */
double gz_display_px_per_deg(const struct gz_display *display);

#endif
