/**
 * @file
 * Recordings that people labelled sample by sample: Andersson, Larsson, Holmqvist, Stridh and
 * Nyström, "One algorithm to rule them all? An evaluation and discussion of ten eye movement
 * event-detection algorithms", Behavior Research Methods 49, 2017.
 */
#ifndef GZ_TESTS_FILTER_RECORDING_H
#define GZ_TESTS_FILTER_RECORDING_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "protocol/display.h"
#include "protocol/gaze.h"

/** Labels of the recordings. */
enum recording_label {
	LABEL_FIXATION = 1,
	LABEL_SACCADE = 2,
	LABEL_GLISSADE = 3, /**< the eye rings after a saccade */
	LABEL_PURSUIT = 4,
	LABEL_BLINK = 5,
	LABEL_UNDEFINED = 6,
};

/** One recording as one person labelled it. */
struct recording {
	struct gz_display display;
	size_t count;
	struct gz_sample *sample;
	int *label;
};

/** Read a file; false if it is not there or not such a file. Free with recording_free(). */
bool recording_read(const char *path, struct recording *out);

void recording_free(struct recording *recording);

#endif
