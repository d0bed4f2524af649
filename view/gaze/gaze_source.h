/**
 * @file
 * Where the gaze comes from: a point that stays, the mouse, a daemon's latest channel, or a gaze
 * log run through the daemon's pipeline in process. All behind one small table.
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
	bool known;            /**< point holds something; it stays so through blinks and loss */
	struct gz_point point; /**< normalised display area */
	bool has_age;
	int64_t age_ns;      /**< of the sample that gave the point; only with has_age */
	bool connected;      /**< whoever gives the gaze is there now; true where nobody need be */
	bool has_event;      /**< the source tells what the eye does */
	enum gz_event event; /**< only with has_event */
	double noise_deg;    /**< of the tracker, sample to sample; NaN where not known */
	bool numbered;       /**< the sample has a number and a time */
	uint64_t seq;        /**< counts the tracker's samples; only with numbered */
	int64_t sample_ns;   /**< its time, host's or the log's; only with numbered */
};

struct gz_gaze_source;

/** What a source must provide. Every table is const and has static storage. */
struct gz_gaze_source_ops {
	const char *name; /**< for the text line: "fixed", "mouse", "daemon", "log" */
	/** The source lives in real time: frames must be paced, and time_ns is not looked at. */
	bool live;
	/** The newest gaze at @p time_ns after the first frame. Never blocks on others. */
	void (*read)(struct gz_gaze_source *source, int64_t time_ns,
		     struct gz_gaze_reading *out_reading);
	/** Optional. The display geometry the source brings, if it knows one by now. */
	bool (*display)(struct gz_gaze_source *source, struct gz_display *out_display);
	/** Optional. What the daemon behind it last told of itself; NULL before it did. Valid
	 * until the next read. */
	const struct gz_status *(*status)(const struct gz_gaze_source *source);
	void (*destroy)(struct gz_gaze_source *source);
};

/** Common head of every source. */
struct gz_gaze_source {
	const struct gz_gaze_source_ops *ops;
};

/** A point that never moves. GZ_ERR_NO_MEM. */
enum gz_result gz_gaze_source_fixed(struct gz_point point, struct gz_gaze_source **out_source);

/** The mouse: unknown until the first gz_gaze_source_move(). GZ_ERR_NO_MEM. */
enum gz_result gz_gaze_source_mouse(struct gz_gaze_source **out_source);

/** The mouse is at @p point, normalised; of a source made by gz_gaze_source_mouse() only. */
void gz_gaze_source_move(struct gz_gaze_source *source, struct gz_point point);

/**
 * A daemon's latest channel. Its age is host time less the sample's time.
 *
 * @param endpoint  NULL or empty for the local daemon's
 * @retval GZ_ERR_INVAL   @p endpoint is no ZeroMQ endpoint; logged
 * @retval GZ_ERR_NO_MEM  no room
 *
 * Succeeds also while no daemon runs. @p log is borrowed.
 */
enum gz_result gz_gaze_source_latest(const char *endpoint, const struct gz_log *log,
				     struct gz_gaze_source **out_source);

/**
 * A gaze log. With t0 the host_ns of its first sample, reading at time_ns gives the last sample at
 * or before t0 + time_ns, as the pipeline saw it with the log's own settings and display; its age
 * is t0 + time_ns less the sample's host_ns. Times must not run backwards from read to read.
 *
 * @retval GZ_ERR_NOT_FOUND, GZ_ERR_IO, GZ_ERR_NO_MEM  logged
 * @retval GZ_ERR_FORMAT  no gaze log, a setting that the pipeline refuses, or not one sample;
 * logged
 */
enum gz_result gz_gaze_source_log(const char *path, const struct gz_log *log,
				  struct gz_gaze_source **out_source);

/** How far a log has been gone through. */
struct gz_gaze_log_place {
	int64_t at_ns;     /**< from its first sample to the newest one that was read */
	int64_t length_ns; /**< from its first sample to its last one; negative where not known */
	bool ended;        /**< its last sample was read */
};

/** Where a log is; of a source made by gz_gaze_source_log() only: false for others. */
bool gz_gaze_source_log_place(const struct gz_gaze_source *source,
			      struct gz_gaze_log_place *out_place);

/**
 * Go on in a log to @p time_ns, as reading it would, but for no longer than @p budget_ns.
 *
 * @return whether it is there; true for other sources
 */
bool gz_gaze_source_log_forward(struct gz_gaze_source *source, int64_t time_ns, int64_t budget_ns);

/** See gz_gaze_source_ops; NULL where the source has none. */
const struct gz_status *gz_gaze_source_status(const struct gz_gaze_source *source);

/** See gz_gaze_source_ops. */
void gz_gaze_source_read(struct gz_gaze_source *source, int64_t time_ns,
			 struct gz_gaze_reading *out_reading);

/** See gz_gaze_source_ops; false where the source has none. */
bool gz_gaze_source_display(struct gz_gaze_source *source, struct gz_display *out_display);

/** Destroy and set to NULL. Accepts a pointer to NULL. */
void gz_gaze_source_destroy(struct gz_gaze_source **source);

#ifdef __cplusplus
}
#endif

#endif
