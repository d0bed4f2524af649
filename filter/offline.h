/**
 * @file
 * Labels with the whole recording in view, for analysis: what comes after a sample counts as much
 * as what came before it. They also know the eye's ringing after a saccade, and a blink covers the
 * lid's closing and opening. The steps before the labels, validate, correct and combine, are those
 * of the pipeline; classifier/whole.h finds the labels.
 *
 * Unlike the pipeline this keeps the recording in memory: about 100 bytes a sample.
 */
#ifndef GZ_FILTER_OFFLINE_H
#define GZ_FILTER_OFFLINE_H

#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "filter/pipeline.h"
#include "protocol/display.h"
#include "protocol/gaze.h"

/** What the eye does. */
enum gz_offline_label {
	GZ_OFFLINE_FIXATION,
	GZ_OFFLINE_SACCADE,
	GZ_OFFLINE_OSCILLATION, /**< the eye, or the lens in it, rings after a saccade */
	GZ_OFFLINE_PURSUIT,
	GZ_OFFLINE_BLINK, /**< with the lid's closing and opening: something was not measured, up to
			     blink_max_ms in all */
	GZ_OFFLINE_LOST,  /**< longer than a blink, or measured but no movement of an eye */
	GZ_OFFLINE_LABELS,
};

/** "fixation", "saccade", "oscillation", "pursuit", "blink" or "lost". */
const char *gz_offline_label_name(enum gz_offline_label label);

/** A stretch of time with one label. Each begins where the one before it ends. */
struct gz_offline_interval {
	enum gz_offline_label label;
	int64_t start_ns; /**< time of its first sample; after a gap in time, of the one before */
	int64_t end_ns;   /**< start of the next one; of the last one, time of its last sample */
	uint64_t samples; /**< 0: nothing but a gap in time */
	struct gz_point start, end; /**< first and last measured point; NaN if there is none */
	struct gz_point mean;       /**< of the measured points; NaN if there is none */
	double amplitude_deg;       /**< between start and end; NaN if there is none */
	double peak_deg_s; /**< greatest speed over GZ_OFFLINE_SPEED_NS; NaN if it is shorter */
};

/** Time over which a speed is measured. Chosen: at 1000 Hz, noise of 0.1 degrees adds less than 20
 *  degrees per second. */
#define GZ_OFFLINE_SPEED_NS INT64_C(8000000)

/** The labels of a recording. */
struct gz_offline_labels {
	size_t count;   /**< of samples */
	uint8_t *label; /**< enum gz_offline_label of each sample; a sample whose time is not newer
			   than that of the last has the label of that */
	size_t interval_count;
	struct gz_offline_interval *interval;
};

/** A recording that is to be labelled. */
struct gz_offline;

/**
 * Begin a recording.
 *
 * @param params   as gz_pipeline_init(); what belongs to the pipeline's own labels is not used
 * @param display  passes gz_display_valid()
 * @param[out] out_offline  owned by the caller: gz_offline_destroy()
 * @retval GZ_ERR_NO_MEM  no memory
 */
enum gz_result gz_offline_create(const struct gz_pipeline_params *params,
				 const struct gz_display *display, struct gz_offline **out_offline);

/**
 * Add the next sample. The result is the same for the same samples on every machine.
 *
 * @retval GZ_ERR_NO_MEM  no memory; the sample was not added
 */
enum gz_result gz_offline_add(struct gz_offline *offline, const struct gz_sample *sample);

/**
 * Label all samples that were added.
 *
 * @param[out] out_labels  owned by the caller: gz_offline_labels_free(); written on success only
 * @retval GZ_ERR_NO_MEM  no memory
 */
enum gz_result gz_offline_finish(const struct gz_offline *offline,
				 struct gz_offline_labels *out_labels);

/** Free the labels and zero them. */
void gz_offline_labels_free(struct gz_offline_labels *labels);

/** Free the recording and set it to NULL. Accepts a pointer to NULL. */
void gz_offline_destroy(struct gz_offline **offline);

#endif
