/**
 * @file
 * What a session is: everything that the pictures of a while were made of, in a folder NAME.session
 * (docs/sessions.md):
 *
 * - GZ_SESSION_SCENE, GZ_SESSION_TRANSFER: the scene as it was at the start;
 * - GZ_SESSION_FRAMES: a line for each frame, and before it one for each setting that has changed;
 * - GZ_SESSION_GAZE: a gaze log of the samples that the frames saw (protocol/gaze_log.h).
 */
#ifndef GZ_VIEW_SESSION_H
#define GZ_VIEW_SESSION_H

#include <stdbool.h>
#include <stdint.h>

#include "base/result.h"
#include "protocol/gaze.h"
#include "render/attention/attention.h"
#include "render/data/volume_identity.h"
#include "view/gaze/gaze_source.h"

#define GZ_SESSION_ENDING   ".session"
#define GZ_SESSION_SCENE    "scene.scene"
#define GZ_SESSION_TRANSFER "transfer.tf"
#define GZ_SESSION_FRAMES   "frames.tsv"
#define GZ_SESSION_GAZE     "gaze.gzl"

/** What is the same for all frames. */
struct gz_session_header {
	char started[GZ_NAME_SIZE];  /**< UTC, ISO 8601 */
	char software[GZ_NAME_SIZE]; /**< "gazeview 1.0" */
	char backend[GZ_NAME_SIZE];  /**< what cast the first frame: "cpu", "gl" */
	int64_t host_ns;             /**< time 0 of the frames on the host's clock */
	struct gz_volume_identity volume;
};

/** A frame that was shown. */
struct gz_session_frame {
	int64_t time_ns;           /**< since the session's host_ns, 0 or more */
	int width, height;         /**< px, 1 to GZ_IMAGE_SIDE_MAX */
	struct gz_display display; /**< of the picture */
	struct gz_gaze_reading
		reading;       /**< but for connected and, where not known, point: not kept */
	struct gz_focus focus; /**< what the plan was made of */
	bool kept;             /**< what earlier frames saw is in it: temporal.accumulate */
	double took_ms;        /**< for statistics */
};

#endif
