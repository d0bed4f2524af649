/**
 * @file
 * Recordings that people labelled sample by sample: Andersson, Larsson, Holmqvist, Stridh and
 * Nyström, "One algorithm to rule them all? An evaluation and discussion of ten eye movement
 * event-detection algorithms", Behavior Research Methods 49, 2017.
 */
#ifndef GZ_BENCH_FILTER_LABELLED_RECORDING_H
#define GZ_BENCH_FILTER_LABELLED_RECORDING_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "protocol/display.h"
#include "protocol/gaze.h"

/** Labels of the recordings. */
enum gz_human_label {
	GZ_HUMAN_FIXATION = 1,
	GZ_HUMAN_SACCADE = 2,
	GZ_HUMAN_GLISSADE = 3, /**< the eye rings after a saccade */
	GZ_HUMAN_PURSUIT = 4,
	GZ_HUMAN_BLINK = 5,
	GZ_HUMAN_UNDEFINED = 6,
};

/** One recording as one person labelled it. */
struct gz_labelled_recording {
	struct gz_display display;
	size_t count;
	struct gz_sample *sample;
	int *label;
};

/** Read a file; false if it is not there or not such a file. Free with
 * gz_labelled_recording_free(). */
bool gz_labelled_recording_read(const char *path, struct gz_labelled_recording *out);

/** Free what gz_labelled_recording_read() allocated. */
void gz_labelled_recording_free(struct gz_labelled_recording *recording);

#endif
