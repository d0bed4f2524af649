/**
 * @file
 * The user's own liblsl (Lab Streaming Layer), loaded at run time. Nothing of this project is
 * linked with it.
 *
 * The types are the part of liblsl's C interface that the daemon uses, as its headers lsl/common.h,
 * lsl/streaminfo.h, lsl/outlet.h and lsl/xml.h declare it (versions 1.13 to 1.17): handles are
 * pointers, enumerations have 4 bytes, times are double, in seconds.
 */
#ifndef GZ_DAEMON_LSL_LIBRARY_H
#define GZ_DAEMON_LSL_LIBRARY_H

#include <stdint.h>

#include "base/result.h"

/** lsl_channel_format_t: the values that the daemon uses. */
enum gz_lsl_format {
	GZ_LSL_DOUBLE = 2,
	GZ_LSL_STRING = 3,
};

/** Nominal rate of a stream whose samples come at irregular times. */
#define GZ_LSL_IRREGULAR_RATE 0.0

/** lsl_streaminfo: the description of a stream. */
struct gz_lsl_info;

/** lsl_xml_ptr: an element of a description; owned by that. */
struct gz_lsl_element;

/** lsl_outlet: a stream that others can read. */
struct gz_lsl_handle;

/** The functions, by their names in the library without "lsl_". Those that return int32_t return 0
 * on success. Those below "optional" are NULL if the version does not have them. */
struct gz_lsl_library {
	void *handle; /**< of dlopen(); NULL while closed */
	struct gz_lsl_info *(*create_streaminfo)(const char *name, const char *type,
						 int32_t channel_count, double rate_hz,
						 int32_t format, const char *source_id);
	void (*destroy_streaminfo)(struct gz_lsl_info *info);
	struct gz_lsl_element *(*get_desc)(struct gz_lsl_info *info);
	struct gz_lsl_element *(*append_child)(struct gz_lsl_element *parent, const char *name);
	struct gz_lsl_element *(*append_child_value)(struct gz_lsl_element *parent,
						     const char *name, const char *value);
	struct gz_lsl_handle *(*create_outlet)(struct gz_lsl_info *info, int32_t chunk_size,
					       int32_t max_buffered);
	void (*destroy_outlet)(struct gz_lsl_handle *outlet);
	int32_t (*have_consumers)(struct gz_lsl_handle *outlet);
	int32_t (*push_sample_dtp)(struct gz_lsl_handle *outlet, const double *values,
				   double time_s, int32_t pushthrough);
	int32_t (*push_sample_strtp)(struct gz_lsl_handle *outlet, const char **values,
				     double time_s, int32_t pushthrough);
	double (*local_clock)(void);
	int32_t (*library_version)(void);
	/* optional */
	const char *(*last_error)(void);
};

/** Bytes of a reason with its NUL: the message of the dynamic linker, and what to do. */
#define GZ_LSL_REASON_SIZE 512

/**
 * Load the library and look up its functions.
 *
 * @param path  file, or a name that the dynamic linker looks up
 * @param[out] out_library  written only on success
 * @param[out] out_reason   on failure: why and what to do; GZ_LSL_REASON_SIZE bytes
 * @retval GZ_ERR_NOT_FOUND  it cannot be loaded
 * @retval GZ_ERR_FORMAT     it is another library: a function is missing
 */
enum gz_result gz_lsl_library_open(const char *path, struct gz_lsl_library *out_library,
				   char *out_reason);

/** Release it. It stays in memory, because it may have threads. Safe on a zeroed struct. */
void gz_lsl_library_close(struct gz_lsl_library *library);

#endif
