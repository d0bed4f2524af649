/**
 * @file
 * Sources of the gaze behind one small table: a fixed point, the mouse, a daemon's latest channel,
 * or a gaze log run through the daemon's pipeline in process.
 */
#ifndef GZ_VIEW_GAZE_GAZE_SOURCE_H
#define GZ_VIEW_GAZE_GAZE_SOURCE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "protocol/gaze.h"

#ifdef __cplusplus
extern "C" {
#endif

/** What a source knows at one moment. */
struct gz_gaze_reading {
	bool known;            /**< point is valid; stays true through blinks and loss */
	struct gz_point point; /**< on the display, 0 to 1 */
	bool has_age;          /**< age_ns is valid */
	int64_t age_ns;        /**< age of the sample that gave the point */
	bool connected;        /**< the source is reachable; always true for a point and a log */
	bool has_event;        /**< event is valid */
	enum gz_event event;   /**< what the eye does */
	struct gz_landing landing; /**< of the running saccade, on the display */
	double noise_deg;  /**< sample-to-sample noise of the tracker, degrees; NaN: unknown */
	bool numbered;     /**< seq and sample_ns are valid */
	uint64_t seq;      /**< number of the tracker's sample */
	int64_t sample_ns; /**< time of the sample, on the host's or the log's clock */
};

struct gz_gaze_source;

/** What a source must provide. Every table is const and has static storage. */
struct gz_gaze_source_ops {
	const char *name; /**< for the text line: "fixed", "mouse", "daemon", "log" */
	bool live;        /**< runs in real time: the caller paces frames, and time_ns is ignored */
	/** Read the newest gaze at @p time_ns after the first frame. Never blocks. */
	void (*read)(struct gz_gaze_source *source, int64_t time_ns,
		     struct gz_gaze_reading *out_reading);
	/** Optional. Get the display geometry. @return false while it is unknown */
	bool (*display)(struct gz_gaze_source *source, struct gz_display *out_display);
	/** Optional. The daemon's latest status, valid until the next read; NULL: none yet. */
	const struct gz_status *(*status)(const struct gz_gaze_source *source);
	/** Free the source. Also correct after a failed start. */
	void (*destroy)(struct gz_gaze_source *source);
};

/** Common head of every source. */
struct gz_gaze_source {
	const struct gz_gaze_source_ops *ops;
};

/** Create a source whose gaze stays at @p point. GZ_ERR_NO_MEM: out of memory. */
enum gz_result gz_gaze_source_fixed(struct gz_point point, struct gz_gaze_source **out_source);

/** Create a source for the mouse. Its gaze is unknown until gz_gaze_source_move(). GZ_ERR_NO_MEM:
 * out of memory. */
enum gz_result gz_gaze_source_mouse(struct gz_gaze_source **out_source);

/** Set the gaze of a mouse source to @p point, 0 to 1. Does nothing for other sources. */
void gz_gaze_source_move(struct gz_gaze_source *source, struct gz_point point);

/**
 * Create a source for a daemon's latest channel. Age is the host's time minus the sample's time.
 * Succeeds also while no daemon runs.
 *
 * @param endpoint  ZeroMQ endpoint; NULL or empty: the local daemon's
 * @param log       borrowed, outlives the source
 * @retval GZ_ERR_INVAL   @p endpoint is not a ZeroMQ endpoint; logged
 * @retval GZ_ERR_NO_MEM  out of memory
 */
enum gz_result gz_gaze_source_latest(const char *endpoint, const struct gz_log *log,
				     struct gz_gaze_source **out_source);

/**
 * Create a source for a gaze log. Let t0 be the host_ns of the first sample: reading at time_ns
 * gives the last sample at or before t0 + time_ns, filtered with the log's own settings and
 * display. Age is t0 + time_ns minus the sample's host_ns. Times must not decrease from read to
 * read.
 *
 * @param log  borrowed, outlives the source
 * @retval GZ_ERR_NOT_FOUND, GZ_ERR_IO, GZ_ERR_NO_MEM  logged
 * @retval GZ_ERR_FORMAT  not a gaze log, a setting the pipeline refuses, or no sample; logged
 */
enum gz_result gz_gaze_source_log(const char *path, const struct gz_log *log,
				  struct gz_gaze_source **out_source);

/** The position in a gaze log. */
struct gz_gaze_log_place {
	int64_t at_ns;     /**< from the first sample to the newest one read */
	int64_t length_ns; /**< from the first sample to the last one; negative: unknown */
	bool ended;        /**< the last sample was read */
};

/** Get the position of a log source. @return false for other sources */
bool gz_gaze_source_log_place(const struct gz_gaze_source *source,
			      struct gz_gaze_log_place *out_place);

/**
 * Advance a log source to @p time_ns as reading would, but stop after about @p budget_ns of work.
 *
 * @return whether it has reached @p time_ns; always true for other sources
 */
bool gz_gaze_source_log_forward(struct gz_gaze_source *source, int64_t time_ns, int64_t budget_ns);

/** Call the source's status slot; NULL if it has none. */
const struct gz_status *gz_gaze_source_status(const struct gz_gaze_source *source);

/** Call the source's read slot. */
void gz_gaze_source_read(struct gz_gaze_source *source, int64_t time_ns,
			 struct gz_gaze_reading *out_reading);

/** Call the source's display slot; false if it has none. */
bool gz_gaze_source_display(struct gz_gaze_source *source, struct gz_display *out_display);

/** Destroy the source and set the pointer to NULL. Accepts NULL and a pointer to NULL. */
void gz_gaze_source_destroy(struct gz_gaze_source **source);

#ifdef __cplusplus
}
#endif

#endif
