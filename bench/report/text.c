#include "bench/report/text.h"

#include <errno.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "protocol/gaze.h"

#define GZ_LOG_MODULE "report"

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

void gz_text_add_escaped(struct gz_text *text, const char *plain)
{
	for (; *plain; plain++) {
		switch (*plain) {
		case '&':
			gz_text_add(text, "&amp;");
			break;
		case '<':
			gz_text_add(text, "&lt;");
			break;
		case '>':
			gz_text_add(text, "&gt;");
			break;
		case '"':
			gz_text_add(text, "&quot;");
			break;
		case '\'':
			gz_text_add(text, "&#39;");
			break;
		default:
			if ((unsigned char)*plain >= ' ' || *plain == '\n' || *plain == '\t')
				gz_text_add_bytes(text, plain, 1);
		}
	}
}

void gz_text_add_base64(struct gz_text *text, const void *bytes, size_t size)
{
	static const char digits[] =
		"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
	const unsigned char *from = bytes;
	for (size_t i = 0; i < size; i += 3) {
		const size_t here = size - i < 3 ? size - i : 3;
		uint32_t group = (uint32_t)from[i] << 16;
		if (here > 1)
			group |= (uint32_t)from[i + 1] << 8;
		if (here > 2)
			group |= from[i + 2];
		const char four[4] = { digits[group >> 18], digits[group >> 12 & 63],
				       here > 1 ? digits[group >> 6 & 63] : '=',
				       here > 2 ? digits[group & 63] : '=' };
		gz_text_add_bytes(text, four, sizeof four);
	}
}

void gz_text_free(struct gz_text *text)
{
	free(text->bytes);
	*text = (struct gz_text) { 0 };
}

enum gz_result gz_text_write(const struct gz_text *text, const char *path, const struct gz_log *log)
{
	if (text->failed) {
		gz_err(log, "%s: not written: %s", path, gz_result_text(GZ_ERR_NO_MEM));
		return GZ_ERR_NO_MEM;
	}
	char part[GZ_PATH_SIZE + 8];
	snprintf(part, sizeof part, "%s.part", path);
	FILE *file = fopen(part, "wb");
	bool written = file && fwrite(text->bytes ? text->bytes : "", 1, text->length, file) ==
				       text->length;
	if (file && fclose(file) != 0)
		written = false;
	if (written && rename(part, path) == 0)
		return GZ_OK;
	gz_err(log, "%s: cannot be written: %s", path, strerror(errno));
	unlink(part);
	return GZ_ERR_IO;
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
