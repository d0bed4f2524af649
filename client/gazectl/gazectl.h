/**
 * @file
 * The commands of gazectl and what they share. Each command is one file with one table.
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
#include "client/gazectl/json.h"
#include "client/stream.h"

/** What gazectl exits with; gazectl(1) lists the same. */
enum gazectl_exit {
	GAZECTL_DONE = GZ_EXIT_DONE,
	/** The daemon refused, no tracker can be used, a file cannot be read. */
	GAZECTL_FAILED = GZ_EXIT_FAILED,
	GAZECTL_USAGE = GZ_EXIT_USAGE,
	GAZECTL_NO_DAEMON = 3, /**< nobody answers at the endpoint */
	GAZECTL_DAMAGED = 4,   /**< inspect, convert: the log is cut or corrupted */
	GAZECTL_CANCELLED = 5, /**< validate: by the Escape key or a signal */
};

extern const struct gz_command gazectl_devices;
extern const struct gz_command gazectl_status;
extern const struct gz_command gazectl_watch;
extern const struct gz_command gazectl_record;
extern const struct gz_command gazectl_stop;
extern const struct gz_command gazectl_inspect;
extern const struct gz_command gazectl_validate;
extern const struct gz_command gazectl_keygen;
extern const struct gz_command gazectl_convert;

/** Options that every command which asks the daemon has; the first member of its settings. */
struct gazectl_common {
	struct gz_command_common command;
	char endpoint[256];   /**< of the control socket; empty for the local daemon */
	char keys[1024];      /**< directory of keys; empty for the usual places */
	char server_key[128]; /**< the daemon's public key; empty: see known_servers */
};

/* clang-format off */
/** The rows that begin the table of a command which asks the daemon: "--help", "--endpoint",
 *  "--keys", "--server-key". */
#define GAZECTL_COMMON_OPTIONS                                                                   \
	GZ_COMMAND_HELP_OPTION,                                                                     \
	{ .key = "endpoint",                                                                     \
	  .type = GZ_OPTION_STRING,                                                              \
	  .offset = offsetof(struct gazectl_common, endpoint),                                   \
	  .max = sizeof((struct gazectl_common *)NULL)->endpoint,                                \
	  .preset = "",                                                                          \
	  .help = "the daemon's control socket, as tcp://127.0.0.1:50020; empty for the local one" }, \
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
	  .help = "the daemon's public key; empty: as known_servers says" }
/* clang-format on */

/** Open the control socket that @p common names. Failures are logged. */
enum gz_result gazectl_open_control(const struct gazectl_common *common, const struct gz_log *log,
				    struct gz_control **out_control);

/**
 * Open the stream that belongs to @p control and wait until it is connected.
 *
 * @return GAZECTL_DONE with *out_stream; GAZECTL_NO_DAEMON or GAZECTL_FAILED after logging why
 */
enum gazectl_exit gazectl_open_stream(struct gz_control *control, const char *const *topics,
				      const struct gz_log *log, struct gz_stream **out_stream);

/**
 * Send a request and wait for its reply.
 *
 * @return GAZECTL_DONE if the reply begins with "OK"; else after logging why
 */
enum gazectl_exit gazectl_request(struct gz_control *control, const char *request,
				  const struct gz_log *log, char out_reply[GZ_CONTROL_REPLY_SIZE]);

/**
 * Wait for the next status message, its texts made printable.
 *
 * @param deadline_ns  host time
 * @return whether one came; false also after a signal that gz_command_interrupted() tells of
 */
bool gazectl_next_status(struct gz_stream *stream, int64_t deadline_ns,
			 struct gz_status *out_status);

/** Log that nobody answers at @p endpoint, with the remedy. */
void gazectl_report_no_daemon(const char *endpoint, const struct gz_log *log);

/** Replace what could steer a terminal in @p text, which came from outside, by '?'. */
void gazectl_make_printable(char *text);

#endif
