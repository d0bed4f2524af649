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

/** Room for the name of who was recorded, with its NUL. */
#define GZ_OBSERVER_SIZE 16

/** One recording as one person labelled it. */
struct gz_labelled_recording {
	struct gz_display display;
	char observer[GZ_OBSERVER_SIZE]; /**< who was recorded */
	size_t count, room;              /**< samples, and how many there is memory for */
	struct gz_sample *sample;
	int *label;
};

/** What people looked at while they were recorded. */
enum gz_labelled_stimulus {
	GZ_LABELLED_IMAGES,
	GZ_LABELLED_DOTS, /**< that move */
	GZ_LABELLED_VIDEOS,
	GZ_LABELLED_STIMULI,
};

/** "img", "dots", "video". */
extern const char *const gz_labelled_stimulus_names[GZ_LABELLED_STIMULI];

#define GZ_LABELLED_CODERS 2  /**< people who labelled each recording: "MN" and "RA" */
#define GZ_LABELLED_FILES  16 /**< recordings, each labelled by both */

/** The recordings, grouped by stimulus. */
extern const struct gz_labelled_file {
	enum gz_labelled_stimulus stimulus;
	const char *name; /**< of its files, without the coder */
} gz_labelled_files[GZ_LABELLED_FILES];

/**
 * Read a recording as one of the coders labelled it: GAZECAST_DATA/gaze/andersson2017/...tsv.gz.
 *
 * @param data   the folder of data; NULL: there is none
 * @param file   place in gz_labelled_files
 * @param coder  0 or 1
 * @param[out] out  free with gz_labelled_recording_free(), in any case
 * @return false if it is missing or not such a file
 */
bool gz_labelled_recording_read(const char *data, size_t file, int coder,
				struct gz_labelled_recording *out);

/**
 * Add a sample behind the last one.
 *
 * @param recording  zero-initialised but for the display before the first one
 * @return false if there is no memory
 */
bool gz_labelled_recording_add(struct gz_labelled_recording *recording,
			       const struct gz_sample *sample, int label);

/** Samples for Cohen's kappa, one label against the rest. */
struct gz_agreement {
	double both, ours, theirs, all;
};

/** Count one sample. */
void gz_agreement_add(struct gz_agreement *agreement, bool ours, bool theirs);

/** Cohen's kappa ("A coefficient of agreement for nominal scales", 1960): 1 for the same labels, 0
 *  for as many alike as by chance. */
double gz_agreement_kappa(const struct gz_agreement *agreement);

/** Free what gz_labelled_recording_read() allocated. */
void gz_labelled_recording_free(struct gz_labelled_recording *recording);

#endif
