/* When a gaze log ends, from the file's end. */
#include <errno.h>
#include <locale.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/gaze_log_parse.h"

/* Looked at, bytes (chosen: more marks than this do not stand behind the last sample). */
enum { TAIL_SIZE = 65536 };

/* @return bytes read; 0: none */
static size_t read_tail(FILE *file, char *bytes)
{
	if (fseek(file, 0, SEEK_END) != 0)
		return 0;
	const long size = ftell(file);
	const long from = size > TAIL_SIZE ? size - TAIL_SIZE : 0;
	const size_t got =
		size > 0 && fseek(file, from, SEEK_SET) == 0 ? fread(bytes, 1, TAIL_SIZE, file) : 0;
	/* Lines with a NUL are none; they do not end the text. */
	for (size_t i = 0; i < got; i++)
		if (!bytes[i])
			bytes[i] = '?';
	return got;
}

static bool is_sample(char *line, locale_t c_locale, int64_t *out_host_ns)
{
	struct gz_gaze_log_record record;
	if (gz_gaze_log_parse_record(line, c_locale, &record) || record.kind != GZ_GAZE_LOG_SAMPLE)
		return false;
	*out_host_ns = record.sample.host_ns;
	return true;
}

/* From the last line with a newline to the first that is not cut. The text is cut into lines. */
static enum gz_result find_last(char *text, locale_t c_locale, int64_t *out_host_ns)
{
	char *newline = strrchr(text, '\n');
	while (newline) {
		*newline = '\0';
		newline = strrchr(text, '\n');
		if (newline && is_sample(newline + 1, c_locale, out_host_ns))
			return GZ_OK;
	}
	return GZ_ERR_FORMAT;
}

enum gz_result gz_gaze_log_find_last(const char *path, int64_t *out_host_ns)
{
	FILE *file = fopen(path, "rbe");
	if (!file)
		return errno == ENOENT ? GZ_ERR_NOT_FOUND : GZ_ERR_IO;
	char *text = malloc(TAIL_SIZE + 1);
	locale_t c_locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
	enum gz_result r = text && c_locale ? GZ_ERR_IO : GZ_ERR_NO_MEM;
	const size_t size = text && c_locale ? read_tail(file, text) : 0;
	if (size > 0) {
		text[size] = '\0';
		r = find_last(text, c_locale, out_host_ns);
	}
	if (c_locale)
		freelocale(c_locale);
	free(text);
	fclose(file);
	return r;
}
