#include "base/text.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define GZ_LOG_MODULE "text"

static bool grow(struct gz_text *text, size_t more)
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
	if (!grow(text, size))
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
	if (length > 0 && grow(text, (size_t)length)) {
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

/* Where a link leads, so that it stays one; else the path itself. Freed by the caller. */
static char *target_of(const char *path)
{
	char *real = realpath(path, NULL);
	return real ? real : strdup(path);
}

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
	char *target = target_of(path), *part = NULL;
	if (text->failed || !target || asprintf(&part, "%s.%ld.part", target, (long)getpid()) < 0) {
		gz_err(log, "%s: not written: %s", path, gz_result_text(GZ_ERR_NO_MEM));
		free(target);
		return GZ_ERR_NO_MEM;
	}
	errno = 0;
	const bool written = write_part(text, part, target);
	if (!written)
		gz_err(log, "%s: cannot be written: %s; name a writable folder with free space",
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
