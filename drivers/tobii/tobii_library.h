/**
 * @file
 * The user's own libtobii_research.so, loaded at run time: nothing of ours is linked with it.
 */
#ifndef GZ_DRIVERS_TOBII_LIBRARY_H
#define GZ_DRIVERS_TOBII_LIBRARY_H

#include "base/log.h"
#include "base/result.h"
#include "drivers/tobii/tobii_abi.h"

/**
 * The functions; names as in the library, without "tobii_research_". Those below "optional" may be
 * NULL, in versions that do not have them.
 */
struct gz_tobii_library {
	void *handle; /**< of dlopen(); NULL while there is none */
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

/** Bytes of a reason with its NUL: the dynamic linker's words, and what to do. */
#define GZ_TOBII_REASON_SIZE 512

/**
 * Load the library and find its functions.
 *
 * @param path  file, or a name that the dynamic linker looks up
 * @param[out] out_library  written only on success
 * @param[out] out_reason   on failure: why and what to do, GZ_TOBII_REASON_SIZE bytes
 * @retval GZ_ERR_NOT_FOUND  it cannot be loaded
 * @retval GZ_ERR_FORMAT     it is another library: a function is missing
 */
enum gz_result gz_tobii_library_open(const char *path, struct gz_tobii_library *out_library,
				     char *out_reason);

/** Let it go; it stays in memory, because it may have threads. Safe on a zeroed struct. */
void gz_tobii_library_close(struct gz_tobii_library *library);

#endif
