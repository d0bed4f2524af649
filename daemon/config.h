/**
 * @file
 * The settings of gazed, from presets, a configuration file and the command line, described by one
 * table of options.
 */
#ifndef GZ_DAEMON_CONFIG_H
#define GZ_DAEMON_CONFIG_H

#include <stdbool.h>
#include <stdio.h>

#include "base/log.h"
#include "base/option.h"
#include "base/result.h"
#include "drivers/driver.h"
#include "filter/pipeline.h"
#include "protocol/endpoint.h"
#include "protocol/gaze.h"
#include "protocol/gaze_log.h"
#include "protocol/validated_file.h"

/** Most surface names under which the screen is published. */
#define GZ_SURFACES_MAX 8

/** Most drivers whose settings a configuration can hold. */
#define GZ_CONFIG_DRIVERS_MAX 16

/** Most options of the daemon itself, without those of the pipeline and the drivers. */
#define GZ_CONFIG_OPTIONS_MAX 64

/** Who may connect by TCP. */
enum gz_tcp {
	GZ_TCP_OFF,
	GZ_TCP_LOOPBACK, /**< this machine's users, without keys */
	GZ_TCP_CURVE,    /**< clients on any machine whose key is authorised */
};

/** Settings of one driver, as its options filled them. */
union gz_driver_settings {
	unsigned char bytes[GZ_DRIVER_SETTINGS_SIZE];
	max_align_t align;
};

/** All settings of gazed. Plain data; gz_config_read() fills it. */
struct gz_config {
	/* From the command line only. */
	char file[GZ_PATH_SIZE]; /**< configuration file; empty: see gz_config_read() */
	bool help;
	bool version;
	bool print_config;
	bool exit_at_end; /**< exit when a replay ends */
	int wait_readers; /**< subscriptions of the stream to wait for before the tracker starts */
	char record[GZ_NAME_SIZE]; /**< name of a recording that begins before the first sample;
				      empty: none */

	char driver[GZ_NAME_SIZE];
	char tracker[GZ_NAME_SIZE]; /**< name or serial number; empty: the first tracker found */
	char corrections[GZ_PATH_SIZE]; /**< directory; empty: the user's and the system's; "none":
					   use no correction */
	int tcp;                        /**< enum gz_tcp */
	char address[GZ_NAME_SIZE];     /**< address of this machine to which TCP is bound */
	char control[GZ_ENDPOINT_SIZE]; /**< as given; empty: see control_endpoint */
	int stream_port, latest_port, inlet_port; /**< 0: the system chooses */
	char key_directory[GZ_PATH_SIZE]; /**< empty: the user's, else the system's configuration */
	int open_clients;                 /**< of a port without keys */
	int trusted_clients;              /**< of a local socket, or of a port with keys */
	int trusted_topics; /**< bytes of topics that the daemon does not send, of these readers */
	char user[GZ_NAME_SIZE];  /**< user to become when root starts the daemon; empty: none */
	char surfaces[256];       /**< names, separated by blanks */
	bool viewers_still_scene; /**< a viewer may say that nothing moves in its scene */
	bool lsl;                 /**< offer streams of the Lab Streaming Layer */
	char lsl_library[GZ_PATH_SIZE];         /**< file, or a name for the dynamic linker */
	char lsl_name[GZ_NAME_SIZE];            /**< of the stream of gaze */
	char recording_directory[GZ_PATH_SIZE]; /**< empty: the user's data directory */
	int display_px[2];                      /**< 0 0: as the tracker reports */
	double display_mm[2];                   /**< 0 0: as the tracker reports */
	double distance_mm;                     /**< 0: as the tracker reports */
	struct gz_pipeline_params pipeline;
	union gz_driver_settings driver_settings[GZ_CONFIG_DRIVERS_MAX];

	/* Derived from the above. */
	char file_read[GZ_PATH_SIZE]; /**< configuration file that was read; empty: none */
	char control_endpoint[GZ_ENDPOINT_SIZE]; /**< TCP endpoint of the control socket */
	size_t surface_count;
	char surface[GZ_SURFACES_MAX][GZ_NAME_SIZE];
	/* What the command line gave: */
	bool own_given[GZ_CONFIG_OPTIONS_MAX];         /**< the daemon's own options */
	bool pipeline_given[GZ_GAZE_LOG_SETTINGS_MAX]; /**< the pipeline's options */
	bool display_given[3];                         /**< display.px, .mm, .distance_mm */
};

/**
 * Set the presets, read the configuration file, then the command line; each overrides the one
 * before. Then check that the settings fit together.
 *
 * The file is the one named by --config, else $XDG_CONFIG_HOME/gazecast/gazed.conf (or
 * ~/.config/gazecast/gazed.conf), else gazecast/gazed.conf in the system's configuration directory,
 * else none. With --help or --version no file is read.
 *
 * @param[out] out_config  filled; on failure its content has no meaning
 * @retval GZ_OK          read
 * @retval GZ_ERR_INVAL   the command line is refused, or settings contradict each other
 * @return else as gz_options_read_file(). Each failure is logged in one line: what is wrong, in
 *         which line of the file or which option, and what to do.
 */
enum gz_result gz_config_read(int argc, char *const *argv, const struct gz_log *log,
			      struct gz_config *out_config);

/**
 * Put the stored correction for a tracker and its display into @p params. The correction in the
 * header of a recording and one given on the command line are kept instead. A file that cannot be
 * used is logged and ignored.
 *
 * @param info             the tracker
 * @param[in,out] params   its correction is replaced if there is a stored one
 */
void gz_config_correction(const struct gz_config *config, const struct gz_device_info *info,
			  const struct gz_display *display, const struct gz_log *log,
			  struct gz_pipeline_params *params);

/**
 * Look up what a tracker was last validated on, in the directories of corrections. A file that
 * cannot be used is logged and ignored.
 *
 * @param[out] out_validated  written on true only
 * @return whether it is known; never for a recording
 */
bool gz_config_validated(const struct gz_config *config, const struct gz_device_info *info,
			 const struct gz_log *log, struct gz_validated *out_validated);

/** Print every option with its meaning, for --help. */
void gz_config_print_help(struct gz_config *config, FILE *out);

/** Print a commented configuration file with the present values, for --print-config. */
void gz_config_print_file(struct gz_config *config, FILE *out);

/** The settings of each driver in the order of gz_drivers[], for struct gz_driver_host; they point
 * into @p config. */
void gz_config_all_settings(const struct gz_config *config,
			    const void *out_settings[GZ_CONFIG_DRIVERS_MAX]);

/** The chosen driver and its settings, which point into @p config. Never NULL after a successful
 * gz_config_read(). */
const struct gz_driver *gz_config_driver(const struct gz_config *config, const void **out_settings);

/**
 * The display to compute with. The first source that knows it counts: the command line, the header
 * of a recording, the configuration file, the tracker, gz_display_default(). Pixels, millimetres
 * and distance are looked up separately.
 */
struct gz_display gz_config_display(const struct gz_config *config,
				    const struct gz_device_info *info);

/**
 * The settings of the pipeline: the configured ones; or for a recording those of its header, except
 * settings given on the command line. A setting of the header that this version does not know is
 * ignored with a warning; warns too if gz_pipeline_other_forests(). A recording that names no
 * source of labels gets them from what gz_pipeline_unnamed_params() says.
 *
 * @param recorded         header of the recording; NULL if the tracker is none
 * @param[out] out_params  written on success only
 * @retval GZ_ERR_FORMAT  the header holds a value that this version refuses; logged
 * @retval GZ_ERR_INVAL   the settings contradict each other; logged
 */
enum gz_result gz_config_pipeline(const struct gz_config *config,
				  const struct gz_gaze_log_header *recorded,
				  const struct gz_log *log, struct gz_pipeline_params *out_params);

/** Write every setting of @p params, and the name of the forests, into the settings of @p header.
 */
void gz_config_describe_pipeline(const struct gz_pipeline_params *params,
				 struct gz_gaze_log_header *header);

/**
 * The directory for recordings: the configured one, else $XDG_DATA_HOME/gazecast, else
 * ~/.local/share/gazecast. The latter two are made if missing.
 *
 * @param[out] text  the whole path, @p size bytes
 * @retval GZ_ERR_NOT_FOUND  the directory does not exist or cannot be made; logged
 */
enum gz_result gz_config_recording_directory(const struct gz_config *config,
					     const struct gz_log *log, char *text, size_t size);

#endif
