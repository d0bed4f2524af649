/**
 * @file
 * The data of the pipeline: the sample that a driver delivers, and the gaze, fixation, blink,
 * saccade and status messages that the daemon makes of it. Times are ns on the host's
 * CLOCK_MONOTONIC, except device_ns. A floating-point field that was not measured is NaN.
 */
#ifndef GZ_PROTOCOL_GAZE_H
#define GZ_PROTOCOL_GAZE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/sizes.h"
#include "protocol/display.h"

/** Index of an eye, numbered as in Pupil Core. */
enum gz_eye {
	GZ_EYE_RIGHT = 0,
	GZ_EYE_LEFT = 1,
	GZ_EYE_COUNT = 2,
};

/** What the eyes do. */
enum gz_event {
	GZ_EVENT_FIXATION,
	GZ_EVENT_SACCADE,
	GZ_EVENT_PURSUIT,
	GZ_EVENT_BLINK,
	GZ_EVENT_LOST,
	GZ_EVENT_OSCILLATION, /**< the eye rings after a saccade; only as a certain label */
	GZ_EVENT_COUNT,
};

/** "fixation", "saccade", "pursuit", "blink", "lost" or "oscillation"; "unknown" for a value
 * outside the enum. Static text. */
const char *gz_event_name(enum gz_event event);

/** One eye of a sample. The fields are float because "%.9g" in the gaze log keeps a float exactly.
 */
struct gz_eye_sample {
	struct gz_point point; /**< where this eye looks on the display */
	bool valid;            /**< according to the tracker */
	float confidence;      /**< [0, 1] */
	float pupil_mm;        /**< pupil diameter, mm */
	float origin_mm[3];    /**< centre of the eye in the tracker's coordinates, mm */
	float direction[3];    /**< unit vector from the eye to the gaze point */
};

/**
 * One measurement, exactly as a driver delivers it. A gaze log stores it, and the pipeline takes
 * it. A device that measures only one point for both eyes leaves both eyes unmeasured
 * (gz_sample_combined_only()).
 */
struct gz_sample {
	uint64_t seq;      /**< number of the sample; a replay keeps the recorded numbers */
	int64_t device_ns; /**< on the device's own clock; GZ_NO_DEVICE_TIME if it has none */
	int64_t host_ns; /**< the same moment on the host's clock: the best estimate of the exposure
			  */
	struct gz_point point; /**< of both eyes together */
	bool valid;            /**< of point, according to the tracker */
	struct gz_eye_sample eye[GZ_EYE_COUNT];
	uint32_t lost_before; /**< samples that the device lost just before this one; a !gap record
				 in a gaze log; the pipeline ignores it */
	bool still_scene; /**< not of the device: viewers say that nothing moves in the scene; in a
			     gaze log a change is a !scene record */
};

/** The device_ns of a device without a clock. */
#define GZ_NO_DEVICE_TIME INT64_MIN

/** A sample without measurements: every measurement NaN, nothing valid, host_ns and seq 0, no
 * device time. */
struct gz_sample gz_sample_unmeasured(void);

/** Whether the device measured the common point only and nothing of either eye. False if it
 * measured nothing at all. */
bool gz_sample_combined_only(const struct gz_sample *sample);

/** One eye of a gaze message; the fields are those of struct gz_eye_sample. */
struct gz_gaze_eye {
	struct gz_point point;
	float pupil_mm;
	bool valid;
	float confidence;
	float origin_mm[3];
	float direction[3];
};

/** Where and when the running saccade will probably land. */
struct gz_landing {
	bool known; /**< whether the other fields are set */
	struct gz_point point;
	int64_t time_ns; /**< host time */
	float sigma_deg; /**< 68 % of landings are at most this far from point, degrees */
};

/** One gaze message. The stream and the channel "latest" carry one for each sample. */
struct gz_gaze {
	uint64_t seq;
	int64_t device_ns;
	int64_t host_ns;
	int64_t publish_ns; /**< when the daemon sent it */
	struct gz_point
		point;       /**< smoothed; always finite: during a blink it keeps its last value */
	struct gz_point raw; /**< before smoothing; NaN if the sample was rejected */
	float confidence;    /**< [0, 1]; 0 during a blink and while the gaze is lost */
	enum gz_event event; /**< as known now */
	bool final_known;    /**< whether the other final_ fields are set */
	uint64_t final_seq;  /**< this or an earlier sample, whose event is now certain */
	uint64_t final_span; /**< the event applies from sample final_seq - final_span on; above 0
				only after a gap, when several events become certain at once */
	enum gz_event final_event;
	float velocity_deg_s;      /**< finite, 0 or more */
	struct gz_landing landing; /**< may be known during a saccade */
	bool combined;             /**< the device gives one point for both eyes */
	struct gz_gaze_eye eye[GZ_EYE_COUNT];
};

/** A fixation: sent at its onset, while it lasts, and once at its end. */
struct gz_fixation {
	uint64_t id; /**< the seq of its first sample: unique, and equal in a replay */
	int64_t onset_ns;
	int64_t duration_ns;   /**< so far */
	float dispersion_deg;  /**< greatest distance of a sample from the centre so far */
	struct gz_point point; /**< the centre of its samples so far */
	float confidence;      /**< mean of its samples, [0, 1] */
	bool final;            /**< the last message about this fixation */
};

/** The beginning or end of a blink. */
struct gz_blink {
	bool onset; /**< otherwise the end */
	int64_t time_ns;
	float confidence; /**< [0, 1] */
};

/** A finished saccade. */
struct gz_saccade {
	int64_t start_ns;
	int64_t duration_ns;
	float amplitude_deg;
	float peak_velocity_deg_s;
	struct gz_point start, end;
};

/** Why the pipeline rejected a sample. */
enum gz_rejection {
	GZ_REJECT_NONE,
	GZ_REJECT_TRACKER,    /**< the tracker reports it as invalid */
	GZ_REJECT_NOT_FINITE, /**< NaN or infinite coordinates */
	GZ_REJECT_OFF_SCREEN, /**< outside the screen by more than the margin */
	GZ_REJECT_VELOCITY,   /**< faster than an eye can move */
	GZ_REJECT_DISPARITY,  /**< the eyes' points are too far apart */
	GZ_REJECT_TIME,       /**< not newer than the previous sample */
	GZ_REJECT_CONFIDENCE, /**< the tracker's confidence is below the limit */
	GZ_REJECT_COUNT,
};

/** The key in status.rejected: "tracker", "not_finite", "off_screen", …; "none" for NONE. Static
 * text. */
const char *gz_rejection_name(enum gz_rejection rejection);

/** What was wrong with bytes from which a driver could not make a sample. */
enum gz_malformed {
	GZ_MALFORMED_SHORT,  /**< fewer bytes than such a report has */
	GZ_MALFORMED_LONG,   /**< more bytes than such a report has, or than fit into the buffer */
	GZ_MALFORMED_STALE,  /**< sent before: its counter or time does not advance */
	GZ_MALFORMED_SYNTAX, /**< not in the tracker's format: magic number, framing, nesting,
				encoding */
	GZ_MALFORMED_VALUE,  /**< well formed, but a field is missing or impossible */
	GZ_MALFORMED_COUNT,
};

/** The key in status.malformed: "short", "long", "stale", "syntax" or "value". Static text. */
const char *gz_malformed_name(enum gz_malformed malformed);

/** What the daemon refused its clients. */
enum gz_refusal {
	GZ_REFUSAL_CONNECTIONS,   /**< connections ended, because there were too many */
	GZ_REFUSAL_SUBSCRIPTIONS, /**< connections ended, because they subscribed to too much */
	GZ_REFUSAL_MESSAGES,      /**< messages that were not valid or had a reserved topic */
	GZ_REFUSAL_OVERFLOW,      /**< valid messages for which there was no room */
	GZ_REFUSAL_LSL,           /**< samples and events that liblsl did not take */
	GZ_REFUSAL_COUNT,
};

/** The key in status.refused: "connections", "subscriptions", "messages", "overflow" or "lsl".
 * Static text. */
const char *gz_refusal_name(enum gz_refusal refusal);

/** State of the tracker. */
enum gz_tracker_state {
	GZ_TRACKER_ABSENT, /**< not found so far */
	GZ_TRACKER_STARTING,
	GZ_TRACKER_RUNNING,
	GZ_TRACKER_LOST,  /**< disconnected; the daemon waits for it */
	GZ_TRACKER_ENDED, /**< a replay has reached its end */
	GZ_TRACKER_STATE_COUNT,
};

/** Its name on the wire; static text. */
const char *gz_tracker_state_name(enum gz_tracker_state state);

/** State of the recording. */
enum gz_recording_state {
	GZ_RECORDING_OFF,
	GZ_RECORDING_ON,
	GZ_RECORDING_FAILED, /**< stopped by an error; recording.error says which */
	GZ_RECORDING_STATE_COUNT,
};

/** Its name on the wire; static text. */
const char *gz_recording_state_name(enum gz_recording_state state);

/** How the unit of the device's clock is known. */
enum gz_clock_tick {
	GZ_CLOCK_NONE,      /**< the device has no clock; host_ns is the time of arrival */
	GZ_CLOCK_DECLARED,  /**< the unit that the device states, which is plausible */
	GZ_CLOCK_ESTIMATED, /**< estimated from arrival times */
	GZ_CLOCK_TICK_COUNT,
};

/** Its name on the wire; static text. */
const char *gz_clock_tick_name(enum gz_clock_tick tick);

/** The relation of the device's clock to the host's. */
struct gz_clock_status {
	int64_t offset_ns; /**< host time less device time at the newest sample */
	double skew_ppm;   /**< how much faster the device's clock runs, parts per million */
	double sigma_ns;   /**< standard deviation of the fit */
	enum gz_clock_tick tick;
};

#define GZ_REASON_SIZE 160 /**< a reason with its NUL, bytes */

/** The daemon's state: sent once a second and when it changes. */
struct gz_status {
	struct {
		char name[GZ_NAME_SIZE];
		char serial[GZ_NAME_SIZE];
		enum gz_tracker_state state;
		char reason[GZ_REASON_SIZE]; /**< why it does not run; empty while it does */
	} tracker;
	double rate_hz_nominal;  /**< 0 if unknown */
	double rate_hz_measured; /**< 0 if no samples arrive */
	uint64_t samples;        /**< delivered by the driver */
	uint64_t lost;           /**< lost by the device or on the way to the daemon */
	uint64_t rejected[GZ_REJECT_COUNT];
	uint64_t malformed[GZ_MALFORMED_COUNT]; /**< reports from which no sample could be made */
	uint64_t refused[GZ_REFUSAL_COUNT];     /**< to clients */
	struct gz_clock_status clock;
	double noise_deg; /**< RMS of sample-to-sample distances in fixations; NaN before the first
			   */
	bool still_scene; /**< the pipeline takes it that nothing moves: there is no pursuit */
	struct gz_display display;
	/** The affine correction of the tracker's points: a b c of x' = a + b x + c y, and of y' =
	 * a + b x + c y, in display sides. 0 1 0 and 0 0 1 change nothing. */
	struct {
		double x[3], y[3];
	} correction;
	/** The last check of the tracker's calibration, by gazectl validate. */
	struct {
		char measured[GZ_NAME_SIZE];  /**< UTC, ISO 8601; empty: none is known */
		double accuracy_deg;          /**< NaN if none is known */
		char changed[GZ_REASON_SIZE]; /**< how the display has changed since; empty: it has
						   not */
	} validation;
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
