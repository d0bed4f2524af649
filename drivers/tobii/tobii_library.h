/**
 * @file
 * The user's own libtobii_research.so, loaded at run time, and the trackers that it finds. Nothing
 * of this project is linked with it: the SDK belongs to Tobii.
 *
 * The types are the part of the Tobii Pro SDK's C interface that the driver uses, as its reference
 * describes it (developer.tobiipro.com, "Tobii Pro SDK C API": tobii_research.h,
 * tobii_research_eyetracker.h and tobii_research_streams.h, versions 1.3 to 2.0): structs in the
 * order of their fields, all with the platform's own alignment, enumerations as int, times in
 * microseconds.
 */
#ifndef GZ_DRIVERS_TOBII_LIBRARY_H
#define GZ_DRIVERS_TOBII_LIBRARY_H

#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "drivers/device/device.h"

/** TobiiResearchStatus: 0 is success. */
typedef int gz_tobii_status;
#define GZ_TOBII_OK 0

/** TobiiResearchValidity: 1 is valid. */
#define GZ_TOBII_VALID 1

/** TobiiResearchNotificationType: the values that the driver uses. */
enum gz_tobii_notice {
	GZ_TOBII_CONNECTION_LOST = 0,
	GZ_TOBII_DISPLAY_AREA_CHANGED = 6,
	GZ_TOBII_FREQUENCY_CHANGED = 7,
	GZ_TOBII_DEVICE_FAULTS = 9,
	GZ_TOBII_DEVICE_WARNINGS = 10,
};

/** A tracker. Owned by the library, valid while that is loaded. */
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
	int64_t system_us; /**< the same moment on the clock of the library on this machine */
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

/** tobii_research_gaze_data_callback, called on a thread of the library. */
typedef void gz_tobii_gaze_callback(struct gz_tobii_gaze *gaze, void *user);

/** tobii_research_notification_callback, called on a thread of the library. */
typedef void gz_tobii_notification_callback(struct gz_tobii_notification *notification, void *user);

_Static_assert(sizeof(struct gz_tobii_eye) == 60, "an eye is floats and ints");
_Static_assert(offsetof(struct gz_tobii_gaze, right) == 60, "the eyes follow each other");
_Static_assert(offsetof(struct gz_tobii_gaze, device_us) == 120, "times follow the eyes");
_Static_assert(sizeof(struct gz_tobii_gaze) == 136, "nothing follows the times");
_Static_assert(sizeof(struct gz_tobii_display_area) == 56, "fourteen floats");
_Static_assert(offsetof(struct gz_tobii_notification, value) == 12, "int and float align alike");

/**
 * The functions, by their names in the library without "tobii_research_". Those below "optional"
 * are NULL if the version does not have them.
 */
struct gz_tobii_library {
	void *handle; /**< of dlopen(); NULL while closed */
	gz_tobii_status (*find_all_eyetrackers)(struct gz_tobii_trackers **out_trackers);
	void (*free_eyetrackers)(struct gz_tobii_trackers *trackers);
	gz_tobii_status (*get_address)(struct gz_tobii_tracker *tracker, char **out_text);
	gz_tobii_status (*get_device_name)(struct gz_tobii_tracker *tracker, char **out_text);
	void (*free_string)(char *text);
	gz_tobii_status (*get_display_area)(struct gz_tobii_tracker *tracker,
					    struct gz_tobii_display_area *out_area);
	gz_tobii_status (*set_gaze_output_frequency)(struct gz_tobii_tracker *tracker,
						     float frequency_hz);
	gz_tobii_status (*get_system_time_stamp)(int64_t *out_us);
	gz_tobii_status (*subscribe_to_gaze_data)(struct gz_tobii_tracker *tracker,
						  gz_tobii_gaze_callback *callback, void *user);
	gz_tobii_status (*unsubscribe_from_gaze_data)(struct gz_tobii_tracker *tracker,
						      gz_tobii_gaze_callback *callback);
	/* optional */
	gz_tobii_status (*get_serial_number)(struct gz_tobii_tracker *tracker, char **out_text);
	gz_tobii_status (*get_model)(struct gz_tobii_tracker *tracker, char **out_text);
	gz_tobii_status (*get_gaze_output_frequency)(struct gz_tobii_tracker *tracker,
						     float *out_frequency_hz);
	gz_tobii_status (*subscribe_to_notifications)(struct gz_tobii_tracker *tracker,
						      gz_tobii_notification_callback *callback,
						      void *user);
	gz_tobii_status (*unsubscribe_from_notifications)(struct gz_tobii_tracker *tracker,
							  gz_tobii_notification_callback *callback);
};

/** Bytes of a reason with its NUL: the message of the dynamic linker, and what to do. */
#define GZ_TOBII_REASON_SIZE 512

/**
 * Load the library and look up its functions.
 *
 * @param path  file, or a name that the dynamic linker looks up
 * @param[out] out_library  written only on success
 * @param[out] out_reason   on failure: why and what to do; GZ_TOBII_REASON_SIZE bytes
 * @retval GZ_ERR_NOT_FOUND  it cannot be loaded
 * @retval GZ_ERR_FORMAT     it is another library: a function is missing
 */
enum gz_result gz_tobii_library_open(const char *path, struct gz_tobii_library *out_library,
				     char *out_reason);

/** Release it. It stays in memory, because it may have threads. Safe on a zeroed struct. */
void gz_tobii_library_close(struct gz_tobii_library *library);

/** The trackers that the SDK has found. */
struct gz_tobii_found {
	size_t count; /**< trackers and entries */
	struct gz_tobii_tracker *trackers[GZ_DEVICE_ENTRIES_MAX];
	/** Name: the model, or the device name if there is none; place: the address. */
	struct gz_device_entry entries[GZ_DEVICE_ENTRIES_MAX];
};

/**
 * Find the trackers that are present. May block for seconds: the SDK searches the network.
 *
 * @param log  may be NULL
 * @param[out] out_found  on failure its count is 0
 * @retval GZ_ERR_NO_DEVICE  the SDK cannot search, or found none; logged
 */
enum gz_result gz_tobii_find(const struct gz_tobii_library *library, const struct gz_log *log,
			     struct gz_tobii_found *out_found);

/**
 * Choose one of the trackers found.
 *
 * @param choice  model, device name, serial number or address; NULL or empty: the first
 * @return its index, or found->count if @p choice is none of them; logged with those there are
 */
size_t gz_tobii_choose(const struct gz_tobii_library *library, const struct gz_tobii_found *found,
		       const char *choice, const struct gz_log *log);

#endif
