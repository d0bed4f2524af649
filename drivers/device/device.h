/**
 * @file
 * What a driver provides, what it gets from its host, and the calls that programs make on an open
 * device. The drivers themselves are listed in drivers/driver.h; drivers/template/ is the smallest
 * complete example.
 */
#ifndef GZ_DRIVERS_DEVICE_DEVICE_H
#define GZ_DRIVERS_DEVICE_DEVICE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/clock.h"
#include "base/log.h"
#include "base/option.h"
#include "base/result.h"
#include "protocol/gaze.h"
#include "protocol/gaze_log.h"

struct gz_device;
struct gz_pointer_feed;

/** What is known about an open device. */
struct gz_device_info {
	char name[GZ_NAME_SIZE];   /**< "sim", or the product name */
	char serial[GZ_NAME_SIZE]; /**< serial number; empty if there is none */
	double rate_hz;            /**< nominal sample rate; 0 if unknown */
	bool on_demand;   /**< delivers as fast as it is read; reading late loses nothing */
	bool has_display; /**< display is filled */
	struct gz_display display;
	/** Header of the recording that this device plays, or NULL. The pipeline then takes its
	 * settings from it. Owned by the device. */
	const struct gz_gaze_log_header *recorded;
};

/** Counters that a driver keeps. They never decrease. */
struct gz_device_counters {
	uint64_t lost;                          /**< samples that the device or the link lost */
	uint64_t malformed[GZ_MALFORMED_COUNT]; /**< unusable reports, by reason */
	struct gz_clock_status clock;           /**< how the device clock maps to the host clock */
	/** Why the samples are useless now, and what to do; static text. NULL if all is well. */
	const char *trouble;
};

/** What a driver must provide for an open device. Every table is const and has static storage. */
struct gz_device_ops {
	/** Start the stream. May block for up to 200 ms. Called once, on the reading thread. */
	enum gz_result (*start)(struct gz_device *device);

	/** Read one sample, as gz_device_read() describes. Must not allocate and must not lock. */
	enum gz_result (*read)(struct gz_device *device, int timeout_ms,
			       struct gz_sample *out_sample);

	/** Fill in what is known; more may be known after start. Must not block. */
	void (*info)(const struct gz_device *device, struct gz_device_info *out_info);

	/** Fill in the counters. Called on the reading thread. Must not block. */
	void (*counters)(const struct gz_device *device, struct gz_device_counters *out_counters);

	/** Stop and free. Must also work after a failed start. */
	void (*destroy)(struct gz_device *device);
};

/** Common head of every device: the first member of a driver's own device struct. */
struct gz_device {
	const struct gz_device_ops *ops;
	const struct gz_log *log; /**< borrowed; may be NULL */
};

/** What the host, usually the daemon, lends to a driver while a device is opened. */
struct gz_driver_host {
	const struct gz_log *log; /**< may be NULL; outlives the device */
	/** Name or serial number of the device to open if there are several. NULL or empty: the
	 * first usable one. Drivers that know only one place to look ignore it. */
	const char *choice;
	/** Configured display size, width and height, mm; 0 0 if none is configured. For devices
	 * that measure in millimetres and do not know their screen. */
	double display_mm[2];
	/** Pointer reports of the viewer; the driver is the reading side. NULL if nobody reports a
	 * pointer. */
	struct gz_pointer_feed *pointer;
	/** Settings of each driver of the table, in the order of the table, for a driver that opens
	 * devices of other drivers. NULL if they are not known. */
	const void *const *settings;
};

/** A tracker that is present, usable or not. */
struct gz_device_entry {
	char name[GZ_NAME_SIZE];   /**< product name */
	char serial[GZ_NAME_SIZE]; /**< empty if it has none or it cannot be read */
	char place[GZ_NAME_SIZE];  /**< "/dev/hidraw0", "usb 1-2" */
	bool usable;
	char reason[GZ_REASON_SIZE]; /**< why it is not usable and what to do; empty if usable */
};

/** Largest gap in a counter of samples or frames that counts as lost samples. A larger one means
 * that the device restarted or sent garbage, and says nothing about losses. Chosen: one minute of
 * the fastest tracker; a tracker that is silent for a second counts as lost anyway. */
#define GZ_LOST_AT_ONCE_MAX 120000

/** Most devices that one driver lists. */
#define GZ_DEVICE_ENTRIES_MAX 16

/** Room for one driver's settings, bytes. */
#define GZ_DRIVER_SETTINGS_SIZE 4096

/** What to do if a device node may not be opened; ends a sentence. */
#define GZ_DEVICE_PERMISSION_REMEDY \
	"install the udev rule 71-gazecast.rules, then plug the tracker in again"

/** One kind of tracker. */
struct gz_driver {
	const char *name;                /**< as in "--driver name" */
	const char *help;                /**< one line */
	const struct gz_option *options; /**< keys "<name>.<setting>"; NULL if there are none */
	const size_t *option_count;      /**< by address: some tables belong to other folders */
	size_t settings_size;            /**< bytes of the struct that the options fill */
	bool on_usb; /**< its devices are on USB: search again when something is plugged in */

	/**
	 * Open a device.
	 *
	 * @param settings  the struct that the options filled; NULL only if there are no options
	 * @param host      read during the call
	 * @param[out] out_device  owned by the caller: gz_device_destroy()
	 * @retval GZ_ERR_NO_DEVICE  none is present; logged with what to do
	 * @retval GZ_ERR_BUSY       another program uses it; logged
	 * @retval GZ_ERR_ACCESS, GZ_ERR_NOT_FOUND, GZ_ERR_FORMAT, GZ_ERR_NO_MEM, GZ_ERR_INVAL
	 * logged
	 */
	enum gz_result (*create)(const void *settings, const struct gz_driver_host *host,
				 struct gz_device **out_device);

	/**
	 * List the devices that are present, in the order in which create() would try them. May
	 * block for some 100 ms. Opens nothing that another program may be using. NULL for a driver
	 * that has nothing to search for.
	 *
	 * @param[out] out_entries  room for GZ_DEVICE_ENTRIES_MAX; further devices are left out
	 * @return how many were written
	 */
	size_t (*list)(const void *settings, const struct gz_driver_host *host,
		       struct gz_device_entry *out_entries);
};

/** Start the stream. @return the result of the driver's start */
enum gz_result gz_device_start(struct gz_device *device);

/**
 * Wait for the next sample.
 *
 * @param timeout_ms  longest wait, ms; 0 polls; negative is refused
 * @param[out] out_sample  written only on GZ_OK. seq counts up from 0, except in a replay, which
 *                         keeps the recorded numbers. host_ns never decreases, except where a
 *                         recording does.
 * @retval GZ_ERR_TIMEOUT    no sample in time; try again
 * @retval GZ_ERR_NO_DEVICE  unplugged; only gz_device_destroy() helps
 * @retval GZ_ERR_END        a recording is over
 * @retval GZ_ERR_INVAL      @p timeout_ms is negative
 *
 * Threads: one reader per device. Does not allocate.
 */
enum gz_result gz_device_read(struct gz_device *device, int timeout_ms,
			      struct gz_sample *out_sample);

/** What is known about the device; see info of struct gz_device_ops. Threads: the reading one. */
void gz_device_get_info(const struct gz_device *device, struct gz_device_info *out_info);

/** The device's counters; see counters of struct gz_device_ops. Threads: the reading one. */
void gz_device_get_counters(const struct gz_device *device,
			    struct gz_device_counters *out_counters);

/** Stop, free and set to NULL. Accepts a pointer to NULL. */
void gz_device_destroy(struct gz_device **device);

/** Whether @p choice means a device with this name and serial number: it equals one of them, or is
 * NULL or empty, which means any device. */
bool gz_device_is_chosen(const char *choice, const char *name, const char *serial);

/**
 * Wait until a file descriptor is ready. Signals do not end the wait.
 *
 * @param events       POLLIN, POLLOUT
 * @param deadline_ns  end of the wait, host time; one in the past polls
 * @retval GZ_OK             ready, or in error: reading or writing says which
 * @retval GZ_ERR_TIMEOUT    not ready in time
 * @retval GZ_ERR_NO_DEVICE  it cannot be waited for
 */
enum gz_result gz_device_poll(int fd, short events, int64_t deadline_ns);

/**
 * Log a warning about something that can happen with every sample: at most one line a second, which
 * says how many lines were left out before it.
 *
 * @param log    the log; the file defines GZ_LOG_MODULE
 * @param limit  struct gz_ratelimit *, one for each kind of warning
 * @param format string literal, then at least one argument, as for printf()
 */
#define gz_warn_limited(log, limit, format, ...)                                             \
	do {                                                                                 \
		uint64_t held_back_;                                                         \
		if (gz_ratelimit_pass((limit), gz_clock_now_ns(), GZ_NS_PER_S, &held_back_)) \
			gz_warn((log), format " (%llu more not shown)", __VA_ARGS__,         \
				(unsigned long long)held_back_);                             \
	} while (0)

#endif
