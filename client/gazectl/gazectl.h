/**
 * @file
 * The commands of gazectl and how they ask the daemon. Each command is one file with one table.
 */
#ifndef GZ_CLIENT_GAZECTL_GAZECTL_H
#define GZ_CLIENT_GAZECTL_GAZECTL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/command.h"
#include "base/log.h"
#include "base/option.h"
#include "base/result.h"
#include "client/control.h"
#include "client/stream.h"

/** Exit statuses of gazectl; gazectl(1) lists the same. */
enum gazectl_exit {
	GAZECTL_DONE = GZ_EXIT_DONE,
	/** The daemon refused, no tracker can be used, or a file cannot be read or written. */
	GAZECTL_FAILED = GZ_EXIT_FAILED,
	GAZECTL_USAGE = GZ_EXIT_USAGE,
	GAZECTL_NO_DAEMON = 3, /**< no daemon answers at the endpoint */
	GAZECTL_DAMAGED = 4,   /**< inspect, label, convert: the log is cut or corrupted */
	GAZECTL_CANCELLED = 5, /**< validate: cancelled by the Escape key or a signal */
};

extern const struct gz_command gazectl_devices;
extern const struct gz_command gazectl_status;
extern const struct gz_command gazectl_watch;
extern const struct gz_command gazectl_record;
extern const struct gz_command gazectl_stop;
extern const struct gz_command gazectl_inspect;
extern const struct gz_command gazectl_label;
extern const struct gz_command gazectl_validate;
extern const struct gz_command gazectl_keygen;
extern const struct gz_command gazectl_convert;

/** Options of every command that asks the daemon; the first member of its settings. */
struct gazectl_common {
	struct gz_command_common command;
	char endpoint[256];   /**< of the control socket; empty: the local daemon */
	char keys[1024];      /**< directory of keys; empty: see gz_keys_find() */
	char server_key[128]; /**< the daemon's public key; empty: from known_servers */
};

/* clang-format off */
/** The first rows in the option table of a command that asks the daemon: "--help", "--endpoint",
 *  "--keys", "--server-key". */
#define GAZECTL_COMMON_OPTIONS                                                                   \
	GZ_COMMAND_HELP_OPTION,                                                                     \
	{ .key = "endpoint",                                                                     \
	  .type = GZ_OPTION_STRING,                                                              \
	  .offset = offsetof(struct gazectl_common, endpoint),                                   \
	  .max = sizeof((struct gazectl_common *)NULL)->endpoint,                                \
	  .preset = "",                                                                          \
	  .help = "control socket of the daemon, such as tcp://127.0.0.1:50020; empty: the local " \
		  "daemon" },                                                                    \
	{ .key = "keys",                                                                         \
	  .type = GZ_OPTION_STRING,                                                              \
	  .offset = offsetof(struct gazectl_common, keys),                                       \
	  .max = sizeof((struct gazectl_common *)NULL)->keys,                                    \
	  .preset = "",                                                                          \
	  .help = "directory of client_key and known_servers; empty: gazecast in the user's "    \
		  "configuration directory" },                                                   \
	{ .key = "server-key",                                                                   \
	  .type = GZ_OPTION_STRING,                                                              \
	  .offset = offsetof(struct gazectl_common, server_key),                                 \
	  .max = sizeof((struct gazectl_common *)NULL)->server_key,                              \
	  .preset = "",                                                                          \
	  .help = "public key of the daemon; empty: the one in known_servers" }
/* clang-format on */

/** Open the control socket that @p common names. @return as gz_control_open() and gz_keys_find();
 *  failures are logged */
enum gz_result gazectl_open_control(const struct gazectl_common *common, const struct gz_log *log,
				    struct gz_control **out_control);

/**
 * Open the stream of the same daemon as @p control and wait until it is connected.
 *
 * @param topics           as gz_stream_open()
 * @param[out] out_stream  owned by the caller: gz_stream_close(); written on GAZECTL_DONE only
 * @return GAZECTL_DONE; or GAZECTL_NO_DAEMON or GAZECTL_FAILED after logging why
 */
enum gazectl_exit gazectl_open_stream(struct gz_control *control, const char *const *topics,
				      const struct gz_log *log, struct gz_stream **out_stream);

/**
 * Send a request and wait for its reply.
 *
 * @param[out] out_reply  made printable
 * @return GAZECTL_DONE if the reply begins with "OK"; otherwise GAZECTL_NO_DAEMON or GAZECTL_FAILED
 *         after logging why
 */
enum gazectl_exit gazectl_request(struct gz_control *control, const char *request,
				  const struct gz_log *log, char out_reply[GZ_CONTROL_REPLY_SIZE]);

/**
 * Wait for the next status message; its texts are made printable.
 *
 * @param deadline_ns  host time
 * @param[out] out_status  written on true only
 * @return whether one came; false also after a signal (gz_command_interrupted())
 */
bool gazectl_next_status(struct gz_stream *stream, int64_t deadline_ns,
			 struct gz_status *out_status);

/** Log that no daemon answers at @p endpoint, with the remedy. */
void gazectl_report_no_daemon(const char *endpoint, const struct gz_log *log);

#endif
