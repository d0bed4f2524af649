#include "base/log.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/utf8.h"

static const char *const level_names[] = { "debug", "info", "warn", "error" };

/* Size of a message, with its NUL; longer ones are cut. Chosen: a path and a sentence. */
enum { MESSAGE_SIZE = 1024 };

static bool parse_level(const char *text, size_t length, enum gz_log_level *out_level)
{
	for (int level = GZ_LOG_DEBUG; level <= GZ_LOG_ERROR; level++) {
		const char *name = level_names[level];
		if (strlen(name) == length && strncmp(name, text, length) == 0) {
			*out_level = (enum gz_log_level)level;
			return true;
		}
	}
	return false;
}

/* The lowest level that passes for a module. */
static enum gz_log_level module_threshold(const struct gz_log *log, const char *module)
{
	const char *rule = log->rules;
	while (*rule) {
		size_t length = strcspn(rule, ",");
		const char *colon = memchr(rule, ':', length);
		enum gz_log_level level;
		if (!colon && parse_level(rule, length, &level))
			return level;
		if (colon && parse_level(colon + 1, length - (size_t)(colon + 1 - rule), &level)) {
			size_t name = (size_t)(colon - rule);
			bool any = name == 1 && rule[0] == '*';
			if (any || (strlen(module) == name && strncmp(module, rule, name) == 0))
				return level;
		}
		rule += length;
		rule += *rule == ',';
	}
	return GZ_LOG_INFO;
}

void gz_log_init(struct gz_log *log, gz_log_sink *sink, void *user, const char *rules)
{
	if (!rules)
		rules = getenv("GZ_LOG");
	*log = (struct gz_log) { .sink = sink ? sink : gz_log_to_stderr, .user = user };
	snprintf(log->rules, sizeof log->rules, "%s", rules ? rules : "*:info");
}

void gz_log_to_stderr(void *user, enum gz_log_level level, const char *module, const char *message)
{
	(void)user;
	fprintf(stderr, "gazecast: %s: %s: %s\n", level_names[level], module, message);
}

bool gz_log_wants(const struct gz_log *log, enum gz_log_level level, const char *module)
{
	return log && log->sink && level >= module_threshold(log, module);
}

void gz_log_write(const struct gz_log *log, enum gz_log_level level, const char *module,
		  const char *format, ...)
{
	if (!log || !log->sink)
		return;
	char message[MESSAGE_SIZE];
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(message, sizeof message, format, arguments);
	va_end(arguments);
	gz_utf8_clean(message);
	log->sink(log->user, level, module, message);
}

bool gz_ratelimit_pass(struct gz_ratelimit *limit, int64_t now_ns, int64_t interval_ns,
		       uint64_t *out_dropped)
{
	if (now_ns < limit->next_ns) {
		limit->dropped++;
		return false;
	}
	*out_dropped = limit->dropped;
	limit->dropped = 0;
	limit->next_ns = now_ns + interval_ns;
	return true;
}
