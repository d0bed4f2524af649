/**
 * @file
 * What gazed is told: a configuration file and the command line, by one table of options.
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

/** Most surfaces that the screen is published under. */
#define GZ_SURFACES_MAX 8

/** Most drivers of a build whose settings can be kept. */
#define GZ_CONFIG_DRIVERS_MAX 16

/** Most options of the daemon's own. */
#define GZ_CONFIG_OPTIONS_MAX 64

/** Who may connect by TCP. */
enum gz_tcp {
	GZ_TCP_OFF,
	GZ_TCP_LOOPBACK, /**< at addresses of this machine alone, without keys */
	GZ_TCP_CURVE,    /**< anywhere, for clients whose key is known */
};

/** Settings of one driver, as its options filled them. */
union gz_driver_settings {
	unsigned char bytes[GZ_DRIVER_SETTINGS_SIZE];
	max_align_t align;
};

/** All settings of gazed. Plain data; gz_config_read() fills it. */
struct gz_config {
	/* Of the command line only. */
	char file[GZ_PATH_SIZE]; /**< of the configuration; empty: the usual places */
	bool help;
	bool version;
	bool print_config;
	bool exit_at_end; /**< leave when a replay is over */
	int wait_readers; /**< subscriptions of the stream to wait for before the tracker starts */
	char record[GZ_NAME_SIZE]; /**< record from the first sample under this name; empty: no */

	char driver[GZ_NAME_SIZE];
	char tracker[GZ_NAME_SIZE];     /**< name or serial of one of several; empty: any */
	char corrections[GZ_PATH_SIZE]; /**< directory; empty: the usual ones; "none" */
	int tcp;                        /**< enum gz_tcp */
	char address[GZ_NAME_SIZE];     /**< of this machine, where TCP is bound */
	char control[GZ_ENDPOINT_SIZE]; /**< as given; empty: see control_endpoint */
	int stream_port, latest_port, inlet_port; /**< 0: the system chooses */
	char key_directory[GZ_PATH_SIZE];         /**< empty: the usual places */
	char user[GZ_NAME_SIZE]; /**< to become where root has started; empty: stay */
	char surfaces[256];      /**< names, separated by blanks */
	char recording_directory[GZ_PATH_SIZE]; /**< empty: the user's data directory */
	int display_px[2];                      /**< 0 0: as the tracker says */
	double display_mm[2];                   /**< 0 0: as the tracker says */
	double distance_mm;                     /**< 0: as the tracker says */
	struct gz_pipeline_params pipeline;
	union gz_driver_settings driver_settings[GZ_CONFIG_DRIVERS_MAX];

	/* Made of the above. */
	char file_read[GZ_PATH_SIZE];            /**< the configuration file; empty: none */
	char control_endpoint[GZ_ENDPOINT_SIZE]; /**< TCP endpoint of the control socket */
	size_t surface_count;
	char surface[GZ_SURFACES_MAX][GZ_NAME_SIZE];
	bool own_given[GZ_CONFIG_OPTIONS_MAX];         /**< on the command line, options but those
							  of the pipeline and of drivers */
	bool pipeline_given[GZ_GAZE_LOG_SETTINGS_MAX]; /**< on the command line */
	bool display_given[3];                         /**< px, mm, distance; on the command line */
};

/**
 * Presets, then the configuration file, then the command line.
 *
 * The file is the one named by --config, else $XDG_CONFIG_HOME/gazecast/gazed.conf (or
 * ~/.config/gazecast/gazed.conf), else gazecast/gazed.conf in the system's configuration directory,
 * else none. With --help or --version no file is read.
 *
 * @param[out] out_config  filled; on failure of no meaning
 * @retval GZ_OK  read
 * @return else a result after one logged line: what, where, what to do
 */
enum gz_result gz_config_read(int argc, char *const *argv, const struct gz_log *log,
			      struct gz_config *out_config);

/**
 * Take the stored correction that belongs to a tracker and its display into @p params. A recording
 * keeps that of its header, and one given on the command line stays. A file that cannot be used is
 * logged, and nothing is corrected by it.
 */
void gz_config_correction(const struct gz_config *config, const struct gz_device_info *info,
			  const struct gz_display *display, const struct gz_log *log,
			  struct gz_pipeline_params *params);

/** Print every option with its meaning, for --help. */
void gz_config_print_help(struct gz_config *config, FILE *out);

/** Print a commented configuration file with the present values, for --print-config. */
void gz_config_print_file(struct gz_config *config, FILE *out);

/** The settings of each of gz_drivers[], in that order, as struct gz_driver_host has them; they
 * point into @p config. */
void gz_config_all_settings(const struct gz_config *config,
			    const void *out_settings[GZ_CONFIG_DRIVERS_MAX]);

/** The chosen driver, never NULL after a successful gz_config_read(), and its settings. */
const struct gz_driver *gz_config_driver(const struct gz_config *config, const void **out_settings);

/**
 * The display to compute with, best known first: command line, then for a recording its header,
 * then the configuration file, then the tracker, then gz_display_default(). Each of px, mm and
 * distance by itself.
 */
struct gz_display gz_config_display(const struct gz_config *config,
				    const struct gz_device_info *info);

/**
 * The pipeline's settings: the configured ones; for a recording those of its header, but for what
 * the command line gives.
 *
 * @retval GZ_ERR_FORMAT  the header holds a value that this build refuses; logged
 */
enum gz_result gz_config_pipeline(const struct gz_config *config,
				  const struct gz_gaze_log_header *recorded,
				  const struct gz_log *log, struct gz_pipeline_params *out_params);

/** Fill @p header's settings with every setting of @p params. */
void gz_config_describe_pipeline(const struct gz_pipeline_params *params,
				 struct gz_gaze_log_header *header);

/**
 * The directory for recordings: the configured one, else $XDG_DATA_HOME/gazecast, else
 * ~/.local/share/gazecast; the latter two are made if missing.
 *
 * @retval GZ_ERR_NOT_FOUND  there is none; logged
 */
enum gz_result gz_config_recording_directory(const struct gz_config *config,
					     const struct gz_log *log, char *text, size_t size);

#endif
