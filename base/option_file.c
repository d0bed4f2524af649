#include <stdio.h>
#include <string.h>

#include "base/ini.h"
#include "base/option.h"
#include "base/option_internal.h"

#define GZ_LOG_MODULE "option"

/* Settings in reading. */
struct pass {
	struct gz_option_reader reader;
	const char *name;
	const struct gz_log *log;
};

static enum gz_result take(void *user, const struct gz_ini_item *item)
{
	struct pass *pass = user;
	char key[512];
	char message[GZ_OPTION_MESSAGE_SIZE];
	int first = 0;
	if (!item->name)
		return GZ_OK;
	snprintf(key, sizeof key, "%s.%s", item->section, item->name);
	if (gz_option_reader_set(&pass->reader, key, item->value, item->line, &first, message,
				 sizeof message) == GZ_OK)
		return GZ_OK;
	if (first)
		snprintf(message, sizeof message, "given twice, first in line %d; keep one", first);
	gz_err(pass->log, "%s:%d: %s: %s", pass->name, item->line, key, message);
	return GZ_ERR_FORMAT;
}

enum gz_result gz_options_read_text(const struct gz_option_binding *bindings, size_t count,
				    const char *name, const char *text, size_t size,
				    const struct gz_log *log)
{
	struct pass pass = { .name = name, .log = log };
	enum gz_result result = gz_option_reader_init(&pass.reader, bindings, count);
	if (result != GZ_OK)
		return result;
	result = gz_ini_read_text(name, text, size, take, &pass, log);
	gz_option_reader_free(&pass.reader);
	return result;
}

enum gz_result gz_options_read_file(const struct gz_option_binding *bindings, size_t count,
				    const char *path, const struct gz_log *log)
{
	struct pass pass = { .name = path, .log = log };
	enum gz_result result = gz_option_reader_init(&pass.reader, bindings, count);
	if (result != GZ_OK)
		return result;
	result = gz_ini_read_file(path, take, &pass, log);
	gz_option_reader_free(&pass.reader);
	return result;
}

/* A key whose line is looked for. */
struct search {
	const char *key;
	int line;
};

static enum gz_result look(void *user, const struct gz_ini_item *item)
{
	struct search *search = user;
	size_t section = strlen(item->section);
	if (item->name && strncmp(search->key, item->section, section) == 0 &&
	    search->key[section] == '.' && strcmp(search->key + section + 1, item->name) == 0)
		search->line = item->line;
	return GZ_OK;
}

int gz_options_file_line(const char *path, const char *key)
{
	struct search search = { .key = key };
	gz_ini_read_file(path, look, &search, NULL);
	return search.line;
}
