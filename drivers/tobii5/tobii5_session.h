/**
 * @file
 * The conversation with a Tobii Eye Tracker 5: what to ask next, and what the answers mean. No I/O
 * and no clock. The order is that of scripts/dump_gaze_columns.mjs and scripts/test_calibration.mjs
 * of the repository that tobii5_frame.h names:
 *
 * 1. Greet; wait for the answer.
 * 2. Ask for the display area. If the configuration states another one, set it and ask again until
 *    the tracker has taken it, which is not at once.
 * 3. Subscribe to gaze.
 *
 * The tracker sends gaze 33 times a second, also while it sees no eye, so silence is a fault. No
 * request is needed to keep the stream going.
 *
 * Calibration stays as it is in the tracker. Changing it needs a proof of authorisation with a key
 * of the maker, which this driver does not have.
 */
#ifndef GZ_DRIVERS_TOBII5_SESSION_H
#define GZ_DRIVERS_TOBII5_SESSION_H

#include <stdbool.h>
#include <stdint.h>

#include "drivers/tobii5/tobii5_fields.h"
#include "drivers/tobii5/tobii5_frame.h"

/** Longest wait for an answer or for gaze before the request is repeated, ms. Chosen: 33 samples.
 */
#define GZ_TOBII5_ANSWER_MS 1000

/** Requests without an answer before that is given up. */
#define GZ_TOBII5_TRIES 3

/** Pause before the tracker is asked whether it has taken a display area, ms, and how often it is
 * asked. Chosen: an answer directly after the request is known to be the old area. */
#define GZ_TOBII5_TAKE_MS    100
#define GZ_TOBII5_TAKE_TRIES 10

/** Where the conversation is. */
enum gz_tobii5_phase {
	GZ_TOBII5_GREETING,
	GZ_TOBII5_ASKING_AREA,
	GZ_TOBII5_SETTING_AREA,
	GZ_TOBII5_CHECKING_AREA,
	GZ_TOBII5_SUBSCRIBING,
	GZ_TOBII5_STREAMING,
	GZ_TOBII5_SILENT, /**< it stopped to send, and does not resume; open it anew */
};

/** State. Fill it with gz_tobii5_session_begin(). */
struct gz_tobii5_session {
	enum gz_tobii5_phase phase;
	bool has_wanted;
	struct gz_tobii5_area wanted;
	bool has_area;
	struct gz_tobii5_area area; /**< what the tracker uses */
	uint32_t number;            /**< of the newest request */
	uint32_t first_number;      /**< of this phase's first request */
	int tries;                  /**< requests of this phase */
	int64_t due_ns;             /**< host time of the next request */
	/** Why the samples are useless now, and what to do; static text. NULL if all is well. */
	const char *trouble;
};

/** What a frame was. */
enum gz_tobii5_news {
	GZ_TOBII5_NEWS_NONE,    /**< an answer, or something that is not needed now */
	GZ_TOBII5_NEWS_GAZE,    /**< gaze: gz_tobii5_parse_gaze() */
	GZ_TOBII5_NEWS_UNKNOWN, /**< neither an answer nor gaze */
};

/** Begin. @param wanted  display area to set; NULL to use that of the tracker */
void gz_tobii5_session_begin(struct gz_tobii5_session *session, const struct gz_tobii5_area *wanted,
			     int64_t now_ns);

/**
 * The request that is due, if any. Nothing is due before session->due_ns.
 *
 * @return bytes written; 0 if nothing is due
 */
size_t gz_tobii5_session_ask(struct gz_tobii5_session *session, int64_t now_ns,
			     unsigned char bytes[GZ_TOBII5_REQUEST_MAX]);

/** Take a frame. @return what it was */
enum gz_tobii5_news gz_tobii5_session_take(struct gz_tobii5_session *session,
					   const struct gz_tobii5_frame *frame, int64_t now_ns);

/** Whether points on the display area are points on a screen: there is an area, and it can be a
 * screen. */
bool gz_tobii5_session_has_screen(const struct gz_tobii5_session *session);

#endif
