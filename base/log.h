/**
 * @file
 * Logging: one line per message, a level per module, and a sink that the owner chooses.
 *
 * Each .c file that logs defines GZ_LOG_MODULE before its first use:
 *
 *     #define GZ_LOG_MODULE "replay"
 *     gz_warn(log, "short line: %zu of %d fields", fields, expected);
 *
 * Messages do not end with a newline. A NULL log is allowed everywhere and passes nothing on.
 */
#ifndef GZ_BASE_LOG_H
#define GZ_BASE_LOG_H

#include <stdbool.h>
#include <stdint.h>

enum gz_log_level {
	GZ_LOG_DEBUG,
	GZ_LOG_INFO,
	GZ_LOG_WARN,
	GZ_LOG_ERROR,
};

/**
 * Receives one finished message.
 *
 * @param user     the pointer given to gz_log_init()
 * @param level    the message's level
 * @param module   the GZ_LOG_MODULE of the file that logged it
 * @param message  text without a newline, valid during the call only
 *
 * Called on the thread that logs; must be thread-safe.
 */
typedef void gz_log_sink(void *user, enum gz_log_level level, const char *module,
			 const char *message);

/** Size of the level rules that gz_log_init() keeps, with the NUL, bytes; longer ones are cut. */
#define GZ_LOG_RULES_SIZE 256

/** A log. The caller owns it; it must outlive all its users and does not change after
 * gz_log_init(). */
struct gz_log {
	gz_log_sink *sink;
	void *user;
	char rules[GZ_LOG_RULES_SIZE]; /**< "replay:debug,*:warn" */
};

/**
 * Prepare @p log.
 *
 * @param[out] log  filled
 * @param sink      where messages go; NULL for gz_log_to_stderr()
 * @param user      passed to @p sink
 * @param rules     levels per module, separated by commas: "module:level", "*:level", or a level
 *                  alone for all modules. Levels are debug, info, warn and error. The first rule
 *                  that applies to a module counts; unreadable rules are ignored. NULL takes the
 *                  environment variable GZ_LOG, and "*:info" if that is unset.
 */
void gz_log_init(struct gz_log *log, gz_log_sink *sink, void *user, const char *rules);

/** A sink that writes lines such as "gazecast: error: replay: message" to stderr, each by one
 * write. */
void gz_log_to_stderr(void *user, enum gz_log_level level, const char *module, const char *message);

/** Whether @p log passes on a message of this level and module. False for NULL. */
bool gz_log_wants(const struct gz_log *log, enum gz_log_level level, const char *module);

/** Format a message and pass it on. Control characters and bytes that are not UTF-8 become '?':
 * names and contents of files may hold commands for a terminal. Use the macros below, which check
 * the level first. */
__attribute__((format(printf, 4, 5))) void gz_log_write(const struct gz_log *log,
							enum gz_log_level level, const char *module,
							const char *format, ...);

#define GZ_LOG_AT(log, level, ...)                                                \
	do {                                                                      \
		if (gz_log_wants((log), (level), GZ_LOG_MODULE))                  \
			gz_log_write((log), (level), GZ_LOG_MODULE, __VA_ARGS__); \
	} while (0)

#define gz_debug(log, ...) GZ_LOG_AT(log, GZ_LOG_DEBUG, __VA_ARGS__)
#define gz_info(log, ...)  GZ_LOG_AT(log, GZ_LOG_INFO, __VA_ARGS__)
#define gz_warn(log, ...)  GZ_LOG_AT(log, GZ_LOG_WARN, __VA_ARGS__)
#define gz_err(log, ...)   GZ_LOG_AT(log, GZ_LOG_ERROR, __VA_ARGS__)

/** Lets one message per interval pass. Zero-initialised is ready. One thread at a time. */
struct gz_ratelimit {
	int64_t next_ns;
	uint64_t dropped; /**< since the last message that passed */
};

/**
 * Whether a message may pass now.
 *
 * @param limit        the state; counts the messages that do not pass
 * @param now_ns       host time
 * @param interval_ns  least time between two messages that pass
 * @param[out] out_dropped  messages dropped since the last one that passed; written only on true
 */
bool gz_ratelimit_pass(struct gz_ratelimit *limit, int64_t now_ns, int64_t interval_ns,
		       uint64_t *out_dropped);

#endif
