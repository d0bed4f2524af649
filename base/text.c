#include "base/text.h"

#include <errno.h>
#include <locale.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define GZ_LOG_MODULE "text"

bool gz_number_parse(const char *word, double *out_value)
{
	if (!word[0] || word[strspn(word, "+-.eE0123456789")] != '\0')
		return false;
	/* The "C" locale always exists, so in glibc this cannot fail and allocates nothing. */
	locale_t plain = newlocale(LC_ALL_MASK, "C", (locale_t)0);
	if (plain == (locale_t)0)
		return false;
	char *end;
	double value = strtod_l(word, &end, plain);
	freelocale(plain);
	if (end == word || *end != '\0' || !isfinite(value))
		return false;
	*out_value = value;
	return true;
}

bool gz_number_parse_whole(const char *word, long long *out_value)
{
	if (!word[0] || word[strspn(word, "+-0123456789")] != '\0')
		return false;
	char *end;
	errno = 0;
	long long value = strtoll(word, &end, 10);
	if (end == word || *end != '\0' || errno == ERANGE)
		return false;
	*out_value = value;
	return true;
}

void gz_number_normalise_point(char *number)
{
	static const char others[] = "0123456789+-e";
	size_t before = strspn(number, others);
	if (number[before] == '\0')
		return;
	/* Whatever is not a digit, sign or exponent is the decimal point; it may be several bytes.
	 */
	const char *after = number + before + strcspn(number + before, others);
	number[before] = '.';
	memmove(number + before + 1, after, strlen(after) + 1);
}

void gz_number_print(double value, char text[GZ_NUMBER_SIZE])
{
	double back;
	/* Whole numbers as "600", not "6e+02". */
	if (fabs(value) < 1e15 && value == (double)(long long)value) {
		snprintf(text, GZ_NUMBER_SIZE, "%.0f", value);
		return;
	}
	/* 17 digits distinguish all doubles (IEEE 754-2008, 5.12.2). */
	for (int digits = 1; digits <= 17; digits++) {
		snprintf(text, GZ_NUMBER_SIZE, "%.*g", digits, value);
		gz_number_normalise_point(text);
		if (gz_number_parse(text, &back) && back == value)
			return;
	}
}

double gz_number_of_float(float value)
{
	char text[GZ_NUMBER_SIZE];
	double back;
	for (int digits = 1; digits < 9; digits++) {
		snprintf(text, sizeof text, "%.*g", digits, (double)value);
		gz_number_normalise_point(text);
		if (gz_number_parse(text, &back) && (float)back == value)
			return back;
	}
	return (double)value;
}

char *gz_number_next_word(char **text, const char *blanks)
{
	char *word = *text + strspn(*text, blanks);
	if (!*word)
		return NULL;
	char *end = word + strcspn(word, blanks);
	*text = *end ? end + 1 : end;
	*end = '\0';
	return word;
}

enum gz_result gz_text_print(char *text, size_t size, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	const int length = vsnprintf(text, size, format, arguments);
	va_end(arguments);
	if (length >= 0 && (size_t)length < size)
		return GZ_OK;
	if (size > 0)
		text[0] = '\0';
	return GZ_ERR_FULL;
}

/* Make room for @p more bytes and a NUL. False if there is no memory, now or before. */
static bool reserve_bytes(struct gz_text *text, size_t more)
{
	if (text->failed)
		return false;
	if (text->length + more + 1 <= text->room)
		return true;
	const size_t room = (text->length + more + 1) * 2;
	char *bytes = realloc(text->bytes, room);
	if (!bytes) {
		text->failed = true;
		return false;
	}
	text->bytes = bytes;
	text->room = room;
	return true;
}

void gz_text_add_bytes(struct gz_text *text, const char *bytes, size_t size)
{
	if (!reserve_bytes(text, size))
		return;
	memcpy(text->bytes + text->length, bytes, size);
	text->length += size;
	text->bytes[text->length] = '\0';
}

void gz_text_add(struct gz_text *text, const char *format, ...)
{
	va_list arguments, again;
	va_start(arguments, format);
	va_copy(again, arguments);
	const int length = vsnprintf(NULL, 0, format, arguments);
	if (length > 0 && reserve_bytes(text, (size_t)length)) {
		vsnprintf(text->bytes + text->length, (size_t)length + 1, format, again);
		text->length += (size_t)length;
	}
	va_end(again);
	va_end(arguments);
}

void gz_text_free(struct gz_text *text)
{
	free(text->bytes);
	*text = (struct gz_text) { 0 };
}

/* The file that a link points to, so that the link stays; otherwise the path itself. The caller
 * frees it. */
static char *resolve_link(const char *path)
{
	char *real = realpath(path, NULL);
	return real ? real : strdup(path);
}

/* Write the file @p part, then rename it to @p path. */
static bool write_part(const struct gz_text *text, const char *part, const char *path)
{
	FILE *file = fopen(part, "wbe");
	bool written = file && fwrite(text->bytes ? text->bytes : "", 1, text->length, file) ==
				       text->length;
	if (file && fclose(file) != 0)
		written = false;
	written = written && rename(part, path) == 0;
	if (file && !written) {
		const int saved = errno;
		unlink(part);
		errno = saved;
	}
	return written;
}

enum gz_result gz_text_write(const struct gz_text *text, const char *path, const struct gz_log *log)
{
	char *target = resolve_link(path), *part = NULL;
	if (text->failed || !target || asprintf(&part, "%s.%ld.part", target, (long)getpid()) < 0) {
		gz_err(log, "%s: not written: %s", path, gz_result_text(GZ_ERR_NO_MEM));
		free(target);
		return GZ_ERR_NO_MEM;
	}
	errno = 0;
	const bool written = write_part(text, part, target);
	if (!written)
		gz_err(log, "%s: cannot be written: %s; choose a writable folder with free space",
		       path, strerror(errno));
	free(part);
	free(target);
	return written ? GZ_OK : GZ_ERR_IO;
}

enum gz_result gz_text_add_file(struct gz_text *text, const char *path)
{
	char chunk[16384];
	FILE *file = fopen(path, "rb");
	if (!file)
		return errno == ENOENT ? GZ_ERR_NOT_FOUND : GZ_ERR_IO;
	size_t got;
	while ((got = fread(chunk, 1, sizeof chunk, file)) > 0)
		gz_text_add_bytes(text, chunk, got);
	const bool bad = ferror(file) != 0;
	fclose(file);
	if (bad)
		return GZ_ERR_IO;
	return text->failed ? GZ_ERR_NO_MEM : GZ_OK;
}

enum gz_result gz_text_load(struct gz_text *text, const struct gz_text_file *file,
			    const struct gz_log *log)
{
	FILE *stream = fopen(file->path, "re");
	if (!stream) {
		const int saved = errno;
		gz_err(log, "%s: cannot open the %s: %s; check its name and permissions",
		       file->path, file->what, strerror(saved));
		return saved == ENOENT || saved == ENOTDIR ? GZ_ERR_NOT_FOUND : GZ_ERR_IO;
	}
	char chunk[16384];
	size_t got, size = 0;
	enum gz_result result = GZ_OK;
	while (size <= file->size_max && (got = fread(chunk, 1, sizeof chunk, stream)) > 0) {
		gz_text_add_bytes(text, chunk, got);
		size += got;
	}
	if (ferror(stream)) {
		gz_err(log, "%s: cannot read the %s: %s; name a text file", file->path, file->what,
		       strerror(errno));
		result = GZ_ERR_IO;
	} else if (size > file->size_max) {
		gz_err(log, "%s: longer than %zu KiB; is this a %s?", file->path,
		       file->size_max / 1024, file->what);
		result = GZ_ERR_FORMAT;
	} else if (text->failed) {
		gz_err(log, "%s: no memory to read it", file->path);
		result = GZ_ERR_NO_MEM;
	}
	fclose(stream);
	return result;
}
