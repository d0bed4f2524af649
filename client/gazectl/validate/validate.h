/**
 * @file
 * What the parts of gazectl validate share: gazectl_validate.c reads the command line and reports,
 * gazectl_validate_collect.c shows the targets and takes the samples. Internal to gazectl.
 */
#ifndef GZ_CLIENT_GAZECTL_VALIDATE_VALIDATE_H
#define GZ_CLIENT_GAZECTL_VALIDATE_VALIDATE_H

#include "client/gazectl/gazectl.h"
#include "client/gazectl/validate/validation.h"
#include "client/gazectl/validate/viewer_process.h"
#include "client/viewer_link.h"

/** The command line. */
struct gazectl_validate_settings {
	struct gazectl_common common;
	char targets[GZ_PATH_SIZE];
	double duration_s;
	int order, seed, advance; /**< as gazeview's options of these names */
	bool instructions, windowed, json, correct, forget;
	char out[GZ_PATH_SIZE], picture[GZ_PATH_SIZE], gazeview[GZ_PATH_SIZE];
	char directory[GZ_PATH_SIZE];
};

/** A check under way. */
struct gazectl_validation {
	const struct gazectl_validate_settings *settings;
	const struct gz_log *log;
	struct gz_control *control;
	struct gz_stream *stream;
	struct gz_viewer_process viewer;
	struct gz_viewer_link *link; /**< to the daemon's inlet; NULL where that cannot be told */
	struct gz_validation *result;
	bool finished;       /**< all targets were shown */
	bool cancelled;      /**< by the person in front of the display */
	int64_t heard_ns;    /**< when the daemon last sent something */
	int64_t finished_ns; /**< when the last target vanished */
	uint64_t missed;     /**< gaze messages that this program was too slow for */
};

/**
 * Start gazeview, and take samples and targets as they come until all are there.
 *
 * @return GAZECTL_DONE with the targets and the trace filled; else after logging why
 */
enum gazectl_exit gazectl_validate_collect(struct gazectl_validation *validate);

#endif
