/**
 * @file
 * The part of the Tobii Pro SDK's C interface that the driver uses, as its reference describes it
 * (developer.tobiipro.com, "Tobii Pro SDK C API", tobii_research.h, tobii_research_eyetracker.h and
 * tobii_research_streams.h, versions 1.3 to 2.0): structs in the order of their fields, all with
 * the platform's own alignment, enumerations as int, times in microseconds. The SDK is Tobii's and
 * not part of this project: its library is the user's own.
 */
#ifndef GZ_DRIVERS_TOBII_ABI_H
#define GZ_DRIVERS_TOBII_ABI_H

#include <stddef.h>
#include <stdint.h>

/** TobiiResearchStatus: 0 is success. */
typedef int gz_tobii_status;
#define GZ_TOBII_OK 0

/** TobiiResearchValidity: 1 is valid. */
#define GZ_TOBII_VALID 1

/** TobiiResearchNotificationType: what the driver looks at. */
enum gz_tobii_notice {
	GZ_TOBII_CONNECTION_LOST = 0,
	GZ_TOBII_DISPLAY_AREA_CHANGED = 6,
	GZ_TOBII_FREQUENCY_CHANGED = 7,
	GZ_TOBII_DEVICE_FAULTS = 9,
	GZ_TOBII_DEVICE_WARNINGS = 10,
};

/** A tracker; belongs to the library and stays for as long as that is loaded. */
struct gz_tobii_tracker;

/** TobiiResearchEyeTrackers */
struct gz_tobii_trackers {
	struct gz_tobii_tracker **trackers;
	size_t count;
};

/** TobiiResearchGazePoint */
struct gz_tobii_point {
	float on_display[2]; /**< normalised, origin top left */
	float user_mm[3];    /**< in the user coordinate system */
	int validity;
};

/** TobiiResearchPupilData */
struct gz_tobii_pupil {
	float diameter_mm;
	int validity;
};

/** TobiiResearchGazeOrigin */
struct gz_tobii_origin {
	float user_mm[3];
	float track_box[3];
	int validity;
};

/** TobiiResearchEyeData */
struct gz_tobii_eye {
	struct gz_tobii_point point;
	struct gz_tobii_pupil pupil;
	struct gz_tobii_origin origin;
};

/** TobiiResearchGazeData */
struct gz_tobii_gaze {
	struct gz_tobii_eye left;
	struct gz_tobii_eye right;
	int64_t device_us; /**< the tracker's clock */
	int64_t system_us; /**< the same moment on the library's clock of this machine */
};

/** TobiiResearchDisplayArea: corners in the user coordinate system, and size. */
struct gz_tobii_display_area {
	float bottom_left_mm[3];
	float bottom_right_mm[3];
	float height_mm;
	float top_left_mm[3];
	float top_right_mm[3];
	float width_mm;
};

/** TobiiResearchNotification */
struct gz_tobii_notification {
	int64_t system_us;
	int type;
	union {
		float frequency_hz;
		struct gz_tobii_display_area display_area;
		char text[512];
	} value;
};

/** tobii_research_gaze_data_callback, on a thread of the library's own */
typedef void gz_tobii_gaze_callback(struct gz_tobii_gaze *gaze, void *user);

/** tobii_research_notification_callback, on a thread of the library's own */
typedef void gz_tobii_notification_callback(struct gz_tobii_notification *notification, void *user);

_Static_assert(sizeof(struct gz_tobii_eye) == 60, "an eye is floats and ints");
_Static_assert(offsetof(struct gz_tobii_gaze, right) == 60, "the eyes follow each other");
_Static_assert(offsetof(struct gz_tobii_gaze, device_us) == 120, "times follow the eyes");
_Static_assert(sizeof(struct gz_tobii_gaze) == 136, "and nothing follows them");
_Static_assert(sizeof(struct gz_tobii_display_area) == 56, "fourteen floats");
_Static_assert(offsetof(struct gz_tobii_notification, value) == 12, "int and float align alike");

#endif
