/**
 * @file
 * A log whose last message a test can read.
 */
#ifndef GZ_TESTS_BASE_CAPTURED_LOG_H
#define GZ_TESTS_BASE_CAPTURED_LOG_H

#include <stdio.h>

#include "base/log.h"

struct captured_log {
	struct gz_log log;
	int messages;
	enum gz_log_level level;
	char module[64];
	char last[1200];
};

static inline void capture(void *user, enum gz_log_level level, const char *module,
			   const char *message)
{
	struct captured_log *captured = user;
	captured->messages++;
	captured->level = level;
	snprintf(captured->module, sizeof captured->module, "%s", module);
	snprintf(captured->last, sizeof captured->last, "%s", message);
}

/** Prepare @p captured without messages; @p rules as for gz_log_init(). */
static inline void captured_log_init(struct captured_log *captured, const char *rules)
{
	*captured = (struct captured_log) { 0 };
	gz_log_init(&captured->log, capture, captured, rules);
}

#endif
