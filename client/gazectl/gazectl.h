/**
 * @file
 * The commands of gazectl and what they share. Each command is one file with one table.
 */
#ifndef GZ_CLIENT_GAZECTL_GAZECTL_H
#define GZ_CLIENT_GAZECTL_GAZECTL_H

#include <signal.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/option.h"
#include "base/result.h"
#include "client/control.h"
#include "client/gazectl/json.h"
#include "client/stream.h"

/** What gazectl exits with; gazectl(1) lists the same. */
enum gazectl_exit {
	GAZECTL_DONE = 0,
	GAZECTL_FAILED =
		1,         /**< the daemon refused, no tracker can be used, a file cannot be read */
	GAZECTL_USAGE = 2, /**< a command line that is not understood */
	GAZECTL_NO_DAEMON = 3, /**< nobody answers at the endpoint */
	GAZECTL_DAMAGED = 4,   /**< inspect, convert: the log is cut or corrupted */
	GAZECTL_CANCELLED = 5, /**< validate: by the Escape key or a signal */
};

/** One command. Tables are const and have static storage. */
struct gazectl_command {
	const char *name;
	const char *operands; /**< "[NAME]", as the usage line shows them */
	int operands_max;     /**< how many may be given; -1 for any number */
	const char *summary;  /**< one line of `gazectl --help` */
	const char
		*details; /**< what `gazectl NAME --help` says beyond that; ends with a newline */
	const struct gz_option *options; /**< over the command's own settings */
	size_t option_count;
	/** Do it. argv[0] is the command's name. Called once, on the main thread. */
	enum gazectl_exit (*run)(int argc, char *const *argv, const struct gz_log *log);
};

extern const struct gazectl_command gazectl_devices;
extern const struct gazectl_command gazectl_status;
extern const struct gazectl_command gazectl_watch;
extern const struct gazectl_command gazectl_record;
extern const struct gazectl_command gazectl_stop;
extern const struct gazectl_command gazectl_inspect;
extern const struct gazectl_command gazectl_validate;
extern const struct gazectl_command gazectl_keygen;
extern const struct gazectl_command gazectl_convert;

/** Most arguments that a command line may have. Chosen: more than any use needs. */
enum { GAZECTL_ARGUMENTS_MAX = 64 };

/** What of a command line is no option. */
struct gazectl_operands {
	const char *items[GAZECTL_ARGUMENTS_MAX + 1]; /**< NULL behind the last */
	int count;
};

/** Options that every command which asks the daemon has; the first member of its settings. */
struct gazectl_common {
	bool help;
	char endpoint[256];   /**< of the control socket; empty for the local daemon */
	char keys[1024];      /**< directory of keys; empty for the usual places */
	char server_key[128]; /**< the daemon's public key; empty: see known_servers */
};

/* clang-format off */
/** The rows that begin the table of a command which asks the daemon: "--help", "--endpoint",
 *  "--keys", "--server-key". */
#define GAZECTL_COMMON_OPTIONS                                                                   \
	GAZECTL_HELP_OPTION,                                                                     \
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

/** The row "--help", for the others. */
#define GAZECTL_HELP_OPTION                                                                      \
	{ .key = "help",                                                                         \
	  .type = GZ_OPTION_BOOL,                                                                \
	  .offset = offsetof(struct gazectl_common, help),                                       \
	  .preset = "false",                                                                     \
	  .help = "print this and exit" }
/* clang-format on */

/**
 * Read a command's arguments.
 *
 * @param settings            what the command's option table points into; begins with a
 *                            struct gazectl_common
 * @param[out] out_operands   filled
 * @param[out] out_exit       written only on false
 * @return whether to go on: false after --help and after a usage error, which is logged
 */
bool gazectl_read_arguments(const struct gazectl_command *command, int argc, char *const *argv,
			    const struct gz_log *log, void *settings,
			    struct gazectl_operands *out_operands, enum gazectl_exit *out_exit);

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
 * @return whether one came; false also after a signal that gazectl_interrupted() tells of
 */
bool gazectl_next_status(struct gz_stream *stream, int64_t deadline_ns,
			 struct gz_status *out_status);

/** Log that nobody answers at @p endpoint, with the remedy. */
void gazectl_report_no_daemon(const char *endpoint, const struct gz_log *log);

/** Replace what could steer a terminal in @p text, which came from outside, by '?'. */
void gazectl_make_printable(char *text);

/** From now on SIGINT and SIGTERM set a flag in place of ending the program. */
void gazectl_catch_signals(void);

/** Whether one of them arrived. */
bool gazectl_interrupted(void);

#endif
