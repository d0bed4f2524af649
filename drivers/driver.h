/**
 * @file
 * What a driver must provide, and the list of those there are. A new tracker is one folder with one
 * const table; see drivers/template/.
 */
#ifndef GZ_DRIVERS_DRIVER_H
#define GZ_DRIVERS_DRIVER_H

#include <stddef.h>

#include "base/log.h"
#include "base/option.h"
#include "base/result.h"
#include "protocol/gaze.h"
#include "protocol/gaze_log.h"

struct gz_device;
struct gz_pointer_feed;

/** What is known of an open device. */
struct gz_device_info {
	char name[GZ_NAME_SIZE];   /**< "sim", or the product's name */
	char serial[GZ_NAME_SIZE]; /**< empty if it has none */
	double rate_hz;            /**< nominal; 0 if unknown */
	bool on_demand; /**< delivers as fast as it is read, and loses nothing by being read late */
	bool has_display;
	struct gz_display display;
	/** Not NULL if this device plays a recording: the pipeline then takes its settings from
	 * here. Owned by the device. */
	const struct gz_gaze_log_header *recorded;
};

/** Counters a driver keeps; they never run backwards. */
struct gz_device_counters {
	uint64_t lost;                          /**< samples the device or the link lost */
	uint64_t malformed[GZ_MALFORMED_COUNT]; /**< reports that were not understood */
	struct gz_clock_status clock;
	/** Why what it delivers is of no use now, and what to do; static text. NULL while all is
	 * well. */
	const char *trouble;
};

/** What a driver must provide. Every table is const and has static storage. */
struct gz_device_ops {
	/** Start the stream. May block up to 200 ms. Called once, from the thread that reads. */
	enum gz_result (*start)(struct gz_device *device);

	/**
	 * Read one sample; see gz_device_read(). Must not allocate and must not lock.
	 */
	enum gz_result (*read)(struct gz_device *device, int timeout_ms,
			       struct gz_sample *out_sample);

	/** Fill in what is known; may become more complete after start. Must not block. */
	void (*info)(const struct gz_device *device, struct gz_device_info *out_info);

	/** Fill in the counters. Called from the thread that reads. Must not block. */
	void (*counters)(const struct gz_device *device, struct gz_device_counters *out_counters);

	/** Stop and free. Also correct after a failed start. */
	void (*destroy)(struct gz_device *device);
};

/** Common head of every device; a driver's own struct starts with one. */
struct gz_device {
	const struct gz_device_ops *ops;
	const struct gz_log *log; /**< borrowed; may be NULL */
};

/** What the daemon lends to a driver. */
struct gz_driver_host {
	const struct gz_log *log; /**< may be NULL; outlives the device */
	/** Name or serial number of the device to take where there are several; NULL or empty: the
	 * first usable one. Drivers that know only one place to look ignore it. */
	const char *choice;
	/** The display's size as configured, mm; 0 0 where it is not. For devices that measure in
	 * millimetres and do not know their screen. */
	double display_mm[2];
	/** What the viewer's pointer does; the driver is the one that takes out. NULL where nobody
	 * tells of it. */
	struct gz_pointer_feed *pointer;
	/** For a driver that opens devices of others: the settings of each of gz_drivers[], in that
	 * order; NULL where they are not known. */
	const void *const *settings;
};

/** A tracker that is there, whether or not it can be used. */
struct gz_device_entry {
	char name[GZ_NAME_SIZE];   /**< the product's name */
	char serial[GZ_NAME_SIZE]; /**< empty if it has none, or if it cannot be read */
	char place[GZ_NAME_SIZE];  /**< where it is: "/dev/hidraw0", "usb 1-2" */
	bool usable;
	char reason[GZ_REASON_SIZE]; /**< why it is not usable and what to do; empty if it is */
};

/** A number of samples or frames that leaps ahead farther than this is of a device that began anew,
 * or garbage, and says nothing of what was lost. Chosen: a minute of the fastest tracker; one that
 * is silent for a second counts as lost itself. */
#define GZ_LOST_AT_ONCE_MAX 120000

/** Most devices that one driver lists. */
#define GZ_DEVICE_ENTRIES_MAX 16

/** Room for one driver's settings, bytes. */
#define GZ_DRIVER_SETTINGS_SIZE 4096

/** One kind of tracker. */
struct gz_driver {
	const char *name;                /**< as in "--driver name" */
	const char *help;                /**< one line */
	const struct gz_option *options; /**< keys "<name>.<setting>"; NULL if there are none */
	const size_t *option_count;      /**< by address: some tables stand in other folders */
	size_t settings_size;            /**< bytes of the struct that the options point into */
	bool on_usb; /**< its devices are plugged into USB: an arrival there is a reason to look */

	/**
	 * Open a device.
	 *
	 * @param settings  the struct that the options filled; NULL only if there are no options
	 * @param host      read during the call
	 * @param[out] out_device  owned by the caller: gz_device_destroy()
	 * @retval GZ_ERR_NO_DEVICE  none there; logged with what to do
	 * @retval GZ_ERR_BUSY  another program holds it; logged
	 * @retval GZ_ERR_ACCESS, GZ_ERR_NOT_FOUND, GZ_ERR_FORMAT, GZ_ERR_NO_MEM, GZ_ERR_INVAL
	 * logged
	 */
	enum gz_result (*create)(const void *settings, const struct gz_driver_host *host,
				 struct gz_device **out_device);

	/**
	 * List the devices that are there now, in the order in which create() would try them. May
	 * block for some 100 ms; opens nothing that another program may be using. NULL for a driver
	 * that has nothing to look for.
	 *
	 * @param[out] out_entries  room for GZ_DEVICE_ENTRIES_MAX; devices beyond are left out
	 * @return how many were written
	 */
	size_t (*list)(const void *settings, const struct gz_driver_host *host,
		       struct gz_device_entry *out_entries);
};

/** All drivers of this build, NULL-terminated. */
extern const struct gz_driver *const gz_drivers[];

/** Find a driver by name, or NULL. */
const struct gz_driver *gz_driver_find(const char *name);

/** Start the stream. @return what the driver's start returns. */
enum gz_result gz_device_start(struct gz_device *device);

/**
 * Wait for the next sample.
 *
 * @param timeout_ms  longest wait, ms; 0 polls; negative is refused
 * @param[out] out_sample  written only when GZ_OK is returned; its seq is 0 counting up, but for a
 *                         replay, which keeps the recorded numbers; host_ns never runs backwards
 *                         except where a recording does
 * @retval GZ_ERR_TIMEOUT    no sample in time; try again
 * @retval GZ_ERR_NO_DEVICE  unplugged; only gz_device_destroy() helps now
 * @retval GZ_ERR_END        a recording is over
 * @retval GZ_ERR_INVAL      @p timeout_ms is negative
 *
 * Threads: one reader per device. Does not allocate.
 */
enum gz_result gz_device_read(struct gz_device *device, int timeout_ms,
			      struct gz_sample *out_sample);

/** See info and counters of struct gz_device_ops. Threads: the one that reads. */
void gz_device_get_info(const struct gz_device *device, struct gz_device_info *out_info);
void gz_device_get_counters(const struct gz_device *device,
			    struct gz_device_counters *out_counters);

/** Stop, free and set to NULL. Accepts a pointer to NULL. */
void gz_device_destroy(struct gz_device **device);

#endif
