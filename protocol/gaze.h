/**
 * @file
 * What travels through the pipeline: the sample a driver delivers, and the gaze, fixation, blink,
 * saccade and status messages the daemon makes of it. Times are CLOCK_MONOTONIC ns of the host
 * unless named device_ns. A floating-point field that was not measured is NaN.
 */
#ifndef GZ_PROTOCOL_GAZE_H
#define GZ_PROTOCOL_GAZE_H

#include <stdbool.h>
#include <stdint.h>

#include "protocol/display.h"

/** Index of an eye, as Pupil numbers them. */
enum gz_eye {
	GZ_EYE_RIGHT = 0,
	GZ_EYE_LEFT = 1,
	GZ_EYE_COUNT = 2,
};

/** What the eyes are doing. */
enum gz_event {
	GZ_EVENT_FIXATION,
	GZ_EVENT_SACCADE,
	GZ_EVENT_PURSUIT,
	GZ_EVENT_BLINK,
	GZ_EVENT_LOST,
	GZ_EVENT_COUNT,
};

/** "fixation", "saccade", "pursuit", "blink" or "lost"; "unknown" outside the enum. */
const char *gz_event_name(enum gz_event event);

/** One eye of a sample. float, because "%.9g" in the gaze log keeps a float exactly. */
struct gz_eye_sample {
	struct gz_point point; /**< where this eye looks on the display */
	bool valid;            /**< as the tracker says */
	float confidence;      /**< [0, 1] */
	float pupil_mm;        /**< pupil diameter, mm */
	float origin_mm[3];    /**< centre of the eye, tracker's frame, mm */
	float direction[3];    /**< unit vector from the eye to the gaze point */
};

/**
 * One measurement, exactly as a driver delivered it: what a gaze log stores and what the pipeline
 * takes. A device that knows only one point for both eyes leaves both eyes unmeasured
 * (gz_sample_combined_only()).
 */
struct gz_sample {
	uint64_t seq;      /**< counts delivered samples; a replay keeps the recorded numbers */
	int64_t device_ns; /**< the device's own clock; INT64_MIN where it has none */
	int64_t host_ns; /**< the same moment on the host's clock: the best estimate of exposure */
	struct gz_point point; /**< both eyes together */
	bool valid;            /**< as the tracker says, for @p point */
	struct gz_eye_sample eye[GZ_EYE_COUNT];
	uint32_t lost_before; /**< samples the device lost just before this one, 0 if none; in a log
				 it is a !gap record, and the pipeline does not look at it */
};

/** device_ns of a device without a clock. */
#define GZ_NO_DEVICE_TIME INT64_MIN

/** A sample with every measurement NaN, nothing valid, times and seq 0, no device time. */
struct gz_sample gz_sample_unmeasured(void);

/** Whether the device measured only the common point and nothing of either eye. False where it
 *  measured nothing at all. */
bool gz_sample_combined_only(const struct gz_sample *sample);

/** One eye of a gaze message. */
struct gz_gaze_eye {
	struct gz_point point;
	float pupil_mm;
	bool valid;
	float confidence;
	float origin_mm[3];
	float direction[3];
};

/** One gaze message: what the stream and the latest channel carry for each sample. */
struct gz_gaze {
	uint64_t seq;
	int64_t device_ns;
	int64_t host_ns;
	int64_t publish_ns;    /**< when the daemon sent it */
	struct gz_point point; /**< smoothed; always finite: holds its last place through a blink */
	struct gz_point raw;   /**< before smoothing; NaN where the sample was rejected */
	float confidence;      /**< [0, 1]; 0 while blinking or lost */
	enum gz_event event;   /**< as known now */
	bool final_known;      /**< whether the next two fields hold something */
	uint64_t final_seq;    /**< this or an earlier sample, whose label is now certain */
	uint64_t final_span; /**< the label holds from final_seq - final_span on: 0 but after a gap,
				when several become certain at once */
	enum gz_event final_event;
	float velocity_deg_s; /**< finite, 0 or more */
	bool combined;        /**< the device gave one point, not two eyes */
	struct gz_gaze_eye eye[GZ_EYE_COUNT];
};

/** A fixation, sent at onset, while it lasts and once at its end. */
struct gz_fixation {
	uint64_t id; /**< seq of its first sample: unique, and the same in a replay */
	int64_t onset_ns;
	int64_t duration_ns;   /**< so far */
	float dispersion_deg;  /**< greatest distance from its centre so far */
	struct gz_point point; /**< its centre so far */
	float confidence;      /**< mean over its samples, [0, 1] */
	bool final;            /**< no more will follow for this id */
};

/** The beginning or end of a blink. */
struct gz_blink {
	bool onset; /**< else offset */
	int64_t time_ns;
	float confidence; /**< [0, 1] */
};

/** A finished saccade, or a running one with its prediction. */
struct gz_saccade {
	int64_t start_ns;
	int64_t duration_ns;
	float amplitude_deg;
	float peak_velocity_deg_s;
	struct gz_point start, end;
	bool has_prediction; /**< it still runs, and predicted_end and sigma_deg hold something */
	struct gz_point predicted_end;
	float sigma_deg;
};

/** Why a sample was rejected. */
enum gz_rejection {
	GZ_REJECT_NONE,
	GZ_REJECT_TRACKER,    /**< the tracker itself says invalid */
	GZ_REJECT_NOT_FINITE, /**< NaN or infinite coordinates */
	GZ_REJECT_OFF_SCREEN, /**< farther outside than the margin */
	GZ_REJECT_VELOCITY,   /**< faster than an eye can turn */
	GZ_REJECT_DISPARITY,  /**< the eyes disagree more than they can */
	GZ_REJECT_TIME,       /**< not newer than the sample before */
	GZ_REJECT_CONFIDENCE, /**< the tracker's confidence is below the limit */
	GZ_REJECT_COUNT,
};

/** "tracker", "not_finite", "off_screen", …: the keys of status.rejected; "none" for NONE. */
const char *gz_rejection_name(enum gz_rejection rejection);

/** What was wrong with bytes that a driver received and could not turn into a sample. */
enum gz_malformed {
	GZ_MALFORMED_SHORT,  /**< fewer bytes than its kind has */
	GZ_MALFORMED_LONG,   /**< more than its kind has, or than there is room for */
	GZ_MALFORMED_STALE,  /**< sent before: a counter or time that does not advance */
	GZ_MALFORMED_SYNTAX, /**< not the tracker's language: magic, framing, nesting, encoding */
	GZ_MALFORMED_VALUE,  /**< well formed, but a field is missing or cannot be */
	GZ_MALFORMED_COUNT,
};

/** "short", "long", "stale", "syntax", "value": the keys of status.malformed; static text. */
const char *gz_malformed_name(enum gz_malformed malformed);

enum gz_tracker_state {
	GZ_TRACKER_ABSENT, /**< looked for, not there */
	GZ_TRACKER_STARTING,
	GZ_TRACKER_RUNNING,
	GZ_TRACKER_LOST,  /**< was there; being waited for */
	GZ_TRACKER_ENDED, /**< a replay has come to its end */
	GZ_TRACKER_STATE_COUNT,
};

/** Its name on the wire; static text. */
const char *gz_tracker_state_name(enum gz_tracker_state state);

enum gz_recording_state {
	GZ_RECORDING_OFF,
	GZ_RECORDING_ON,
	GZ_RECORDING_FAILED, /**< stopped by an error, told in error */
	GZ_RECORDING_STATE_COUNT,
};

/** Its name on the wire; static text. */
const char *gz_recording_state_name(enum gz_recording_state state);

/** How the tick of the device's clock was found. */
enum gz_clock_tick {
	GZ_CLOCK_NONE,      /**< the device has no clock: host_ns is the time of arrival */
	GZ_CLOCK_DECLARED,  /**< the unit the device states is believable */
	GZ_CLOCK_ESTIMATED, /**< fitted from arrival times */
	GZ_CLOCK_TICK_COUNT,
};

/** Its name on the wire; static text. */
const char *gz_clock_tick_name(enum gz_clock_tick tick);

/** How device time maps to host time. */
struct gz_clock_status {
	int64_t offset_ns; /**< host - device at the newest sample */
	double skew_ppm;
	double sigma_ns; /**< uncertainty of the fit */
	enum gz_clock_tick tick;
};

#define GZ_NAME_SIZE   64   /**< bytes of a name with its NUL */
#define GZ_REASON_SIZE 160  /**< bytes of a reason with its NUL */
#define GZ_PATH_SIZE   1024 /**< bytes of a path with its NUL */

/** The daemon's state, sent once a second and on change. */
struct gz_status {
	struct {
		char name[GZ_NAME_SIZE];
		char serial[GZ_NAME_SIZE];
		enum gz_tracker_state state;
		char reason[GZ_REASON_SIZE]; /**< empty while all is well */
	} tracker;
	double rate_hz_nominal;  /**< 0 if unknown */
	double rate_hz_measured; /**< 0 if nothing arrives */
	uint64_t samples;        /**< delivered by the driver */
	uint64_t lost;           /**< missed by the device or on the way to the daemon */
	uint64_t rejected[GZ_REJECT_COUNT];
	uint64_t malformed[GZ_MALFORMED_COUNT]; /**< reports that became no sample */
	struct gz_clock_status clock;
	double noise_deg; /**< sample-to-sample RMS within fixations; NaN before the first */
	struct gz_display display;
	/** The affine map that the tracker's points have passed: a b c of x' = a + b x + c y, and
	 * the same for y', in display sides; 0 1 0 and 0 0 1 change nothing. */
	struct {
		double x[3], y[3];
	} correction;
	struct {
		enum gz_recording_state state;
		char file[GZ_PATH_SIZE];
		uint64_t samples;
		char error[GZ_REASON_SIZE];
	} recording;
	uint32_t subscribers;
	char version[GZ_NAME_SIZE];
};

#endif
