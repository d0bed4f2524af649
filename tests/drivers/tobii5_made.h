/**
 * @file
 * What a Tobii Eye Tracker 5 sends, laid out by the numbers of the public description
 * (drivers/tobii5/tobii5_frame.h), not by those of the parser under test, and a tracker that
 * answers requests.
 */
#ifndef GZ_TESTS_DRIVERS_TOBII5_MADE_H
#define GZ_TESTS_DRIVERS_TOBII5_MADE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "protocol/gaze.h"

/** Room for any frame made here, bytes. */
#define TOBII5_MADE_MAX 2048

/** Bytes of a frame of gaze: envelope, head and 40 columns. */
#define TOBII5_MADE_GAZE_SIZE 1751

/** Bytes before the payload: envelope and head. */
#define TOBII5_MADE_OVERHEAD 32

/** One sample. */
struct tobii5_made_gaze {
	int64_t time_us;
	uint32_t counter;
	struct {
		bool seen;
		double point[2];
		double origin_mm[3], target_mm[3];
		double pupil_mm;
	} eye[GZ_EYE_COUNT];
	bool known; /**< of the common point */
	double point[2];
	bool lacks_seen; /**< the columns that say whether an eye is seen are missing */
};

/** A sample of which both eyes look at this point of a screen of 500 mm x 300 mm, whose lower edge
 * is at the tracker, from 600 mm in front of it. @p number gives time and counter, as at 33 Hz. */
struct tobii5_made_gaze tobii5_made_looking(uint32_t number, double x, double y);

/** Lay out a frame of gaze. @return TOBII5_MADE_GAZE_SIZE; less if columns are missing */
size_t tobii5_made_gaze(const struct tobii5_made_gaze *gaze, unsigned char bytes[TOBII5_MADE_MAX]);

/** Lay out a frame with its envelope. @return bytes written: size + TOBII5_MADE_OVERHEAD */
size_t tobii5_made_frame(uint32_t kind, uint32_t number, uint32_t operation,
			 const unsigned char *payload, size_t size, unsigned char *bytes);

/** A tracker. Zero-initialised it answers everything and has no display area (0 mm). */
struct tobii5_played {
	double corner_mm[3][3]; /**< its display area: upper left, upper right, lower left */
	bool is_mute;           /**< answers nothing */
	bool hides_area;        /**< does not answer requests for its display area */
	bool keeps_area;        /**< ignores requests to set it */
	int late_answers;       /**< answers with the old area after it is set */
	double next_mm[3][3];   /**< area that it will have then */
	int late_left;
	int hellos, area_requests, area_sets, subscriptions, unknown; /**< requests so far */
	bool is_subscribed;
};

/** Give it the screen of tobii5_made_looking(). */
void tobii5_played_set_screen(struct tobii5_played *played);

/**
 * It receives a request with its envelope.
 *
 * @param[out] reply  room for TOBII5_MADE_MAX
 * @return bytes of the reply; 0 for none
 */
size_t tobii5_played_answer(struct tobii5_played *played, const unsigned char *request, size_t size,
			    unsigned char *reply);

#endif
