#include "protocol/gaze.h"

#include <math.h>

const char *gz_event_name(enum gz_event event)
{
	switch (event) {
	case GZ_EVENT_FIXATION:
		return "fixation";
	case GZ_EVENT_SACCADE:
		return "saccade";
	case GZ_EVENT_PURSUIT:
		return "pursuit";
	case GZ_EVENT_BLINK:
		return "blink";
	case GZ_EVENT_LOST:
		return "lost";
	case GZ_EVENT_OSCILLATION:
		return "oscillation";
	case GZ_EVENT_COUNT:
		break;
	}
	return "unknown";
}

const char *gz_rejection_name(enum gz_rejection rejection)
{
	switch (rejection) {
	case GZ_REJECT_NONE:
		return "none";
	case GZ_REJECT_TRACKER:
		return "tracker";
	case GZ_REJECT_NOT_FINITE:
		return "not_finite";
	case GZ_REJECT_OFF_SCREEN:
		return "off_screen";
	case GZ_REJECT_VELOCITY:
		return "velocity";
	case GZ_REJECT_DISPARITY:
		return "disparity";
	case GZ_REJECT_TIME:
		return "time";
	case GZ_REJECT_CONFIDENCE:
		return "confidence";
	case GZ_REJECT_COUNT:
		break;
	}
	return "unknown";
}

const char *gz_malformed_name(enum gz_malformed malformed)
{
	switch (malformed) {
	case GZ_MALFORMED_SHORT:
		return "short";
	case GZ_MALFORMED_LONG:
		return "long";
	case GZ_MALFORMED_STALE:
		return "stale";
	case GZ_MALFORMED_SYNTAX:
		return "syntax";
	case GZ_MALFORMED_VALUE:
		return "value";
	case GZ_MALFORMED_COUNT:
		break;
	}
	return "unknown";
}

const char *gz_refusal_name(enum gz_refusal refusal)
{
	switch (refusal) {
	case GZ_REFUSAL_CONNECTIONS:
		return "connections";
	case GZ_REFUSAL_SUBSCRIPTIONS:
		return "subscriptions";
	case GZ_REFUSAL_MESSAGES:
		return "messages";
	case GZ_REFUSAL_OVERFLOW:
		return "overflow";
	case GZ_REFUSAL_LSL:
		return "lsl";
	case GZ_REFUSAL_COUNT:
		break;
	}
	return "unknown";
}

const char *gz_tracker_state_name(enum gz_tracker_state state)
{
	switch (state) {
	case GZ_TRACKER_ABSENT:
		return "absent";
	case GZ_TRACKER_STARTING:
		return "starting";
	case GZ_TRACKER_RUNNING:
		return "running";
	case GZ_TRACKER_LOST:
		return "lost";
	case GZ_TRACKER_ENDED:
		return "ended";
	case GZ_TRACKER_STATE_COUNT:
		break;
	}
	return "unknown";
}

const char *gz_recording_state_name(enum gz_recording_state state)
{
	switch (state) {
	case GZ_RECORDING_OFF:
		return "off";
	case GZ_RECORDING_ON:
		return "on";
	case GZ_RECORDING_FAILED:
		return "failed";
	case GZ_RECORDING_STATE_COUNT:
		break;
	}
	return "unknown";
}

const char *gz_clock_tick_name(enum gz_clock_tick tick)
{
	switch (tick) {
	case GZ_CLOCK_NONE:
		return "none";
	case GZ_CLOCK_DECLARED:
		return "declared";
	case GZ_CLOCK_ESTIMATED:
		return "estimated";
	case GZ_CLOCK_TICK_COUNT:
		break;
	}
	return "unknown";
}

struct gz_sample gz_sample_unmeasured(void)
{
	static const struct gz_eye_sample eye = {
		.point = { NAN, NAN },
		.confidence = NAN,
		.pupil_mm = NAN,
		.origin_mm = { NAN, NAN, NAN },
		.direction = { NAN, NAN, NAN },
	};
	return (struct gz_sample) {
		.device_ns = GZ_NO_DEVICE_TIME,
		.point = { NAN, NAN },
		.eye = { eye, eye },
	};
}

static bool eye_measured(const struct gz_eye_sample *eye)
{
	return eye->valid || !isnan(eye->point.x) || !isnan(eye->point.y) ||
	       !isnan(eye->pupil_mm) || !isnan(eye->origin_mm[0]) || !isnan(eye->direction[0]);
}

bool gz_sample_combined_only(const struct gz_sample *sample)
{
	bool point_measured = !isnan(sample->point.x) && !isnan(sample->point.y);
	return point_measured && !eye_measured(&sample->eye[GZ_EYE_RIGHT]) &&
	       !eye_measured(&sample->eye[GZ_EYE_LEFT]);
}
