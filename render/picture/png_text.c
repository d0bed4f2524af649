#include "render/picture/png_text.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

enum { HEAD_BYTES = 8, CRC_BYTES = 4, TYPE_BYTES = 4, KEYWORD_MAX = 79 };

/* A chunk's data may be so much longer than its text: keyword, language, translated keyword. */
enum { AROUND_TEXT = 1024 };

struct chunk {
	uint32_t length;
	unsigned char type[TYPE_BYTES];
};

static uint32_t big_endian(const unsigned char bytes[4])
{
	return (uint32_t)bytes[0] << 24 | (uint32_t)bytes[1] << 16 | (uint32_t)bytes[2] << 8 |
	       (uint32_t)bytes[3];
}

static bool read_head(FILE *file, struct chunk *out_chunk)
{
	unsigned char head[HEAD_BYTES];
	if (fread(head, 1, sizeof head, file) != sizeof head)
		return false;
	out_chunk->length = big_endian(head);
	memcpy(out_chunk->type, head + 4, TYPE_BYTES);
	return out_chunk->length <= INT32_MAX; /* section 5.3 */
}

static bool is_type(const struct chunk *chunk, const char *type)
{
	return memcmp(chunk->type, type, TYPE_BYTES) == 0;
}

static bool is_text(const struct chunk *chunk)
{
	return is_type(chunk, "tEXt") || is_type(chunk, "zTXt") || is_type(chunk, "iTXt");
}

/* A chunk's data, piece by piece, so that no claimed length takes memory; then its checksum. */
static enum gz_result read_data(FILE *file, const struct chunk *chunk, struct gz_text *data)
{
	unsigned char piece[4096], crc_bytes[CRC_BYTES];
	uLong crc = crc32(0, chunk->type, TYPE_BYTES);
	for (size_t left = chunk->length; left > 0;) {
		const size_t wanted = left < sizeof piece ? left : sizeof piece;
		if (fread(piece, 1, wanted, file) != wanted)
			return GZ_ERR_FORMAT;
		crc = crc32(crc, piece, (uInt)wanted);
		gz_text_add_bytes(data, (const char *)piece, wanted);
		left -= wanted;
	}
	if (fread(crc_bytes, 1, sizeof crc_bytes, file) != sizeof crc_bytes ||
	    big_endian(crc_bytes) != crc)
		return GZ_ERR_FORMAT;
	return data->failed ? GZ_ERR_NO_MEM : GZ_OK;
}

static enum gz_result add_plain(const char *bytes, size_t size, struct gz_text *out_text)
{
	if (size > GZ_PNG_TEXT_MAX)
		return GZ_ERR_FORMAT;
	gz_text_add_bytes(out_text, bytes, size);
	return out_text->failed ? GZ_ERR_NO_MEM : GZ_OK;
}

static enum gz_result add_inflated(const char *bytes, size_t size, struct gz_text *out_text)
{
	unsigned char *plain = malloc(GZ_PNG_TEXT_MAX);
	uLongf length = GZ_PNG_TEXT_MAX;
	if (!plain)
		return GZ_ERR_NO_MEM;
	enum gz_result result = GZ_ERR_FORMAT;
	if (uncompress(plain, &length, (const Bytef *)bytes, size) == Z_OK)
		result = add_plain((const char *)plain, length, out_text);
	free(plain);
	return result;
}

/* Behind the NUL of the next string; NULL where there is none. */
static const char *behind_string(const char *at, const char *end)
{
	const char *nul = at < end ? memchr(at, '\0', (size_t)(end - at)) : NULL;
	return nul ? nul + 1 : NULL;
}

/* The text of a chunk whose keyword ends before @p at. */
static enum gz_result take_text(const struct chunk *chunk, const char *at, const char *end,
				struct gz_text *out_text)
{
	bool compressed = false;
	if (is_type(chunk, "zTXt")) {
		if (at == end || at[0] != 0)
			return GZ_ERR_FORMAT;
		compressed = true;
		at++;
	} else if (is_type(chunk, "iTXt")) {
		if (end - at < 2 || at[0] < 0 || at[0] > 1 || at[1] != 0)
			return GZ_ERR_FORMAT;
		compressed = at[0] == 1;
		at = behind_string(at + 2, end);
		at = at ? behind_string(at, end) : NULL;
		if (!at)
			return GZ_ERR_FORMAT;
	}
	return compressed ? add_inflated(at, (size_t)(end - at), out_text)
			  : add_plain(at, (size_t)(end - at), out_text);
}

/* Reads a chunk of text; GZ_ERR_NOT_FOUND where it has another keyword. */
static enum gz_result try_chunk(FILE *file, const struct chunk *chunk, const char *keyword,
				struct gz_text *out_text)
{
	struct gz_text data = { 0 };
	enum gz_result result = read_data(file, chunk, &data);
	const size_t length = strlen(keyword);
	if (result == GZ_OK)
		result = data.length > length && memcmp(data.bytes, keyword, length + 1) == 0
				 ? take_text(chunk, data.bytes + length + 1,
					     data.bytes + data.length, out_text)
				 : GZ_ERR_NOT_FOUND;
	gz_text_free(&data);
	return result;
}

enum gz_result gz_png_text_find(FILE *file, const char *keyword, struct gz_text *out_text)
{
	static const unsigned char signature[HEAD_BYTES] = { 0x89, 'P',  'N',  'G',
							     '\r', '\n', 0x1a, '\n' };
	unsigned char start[HEAD_BYTES];
	struct chunk chunk;
	if (fread(start, 1, sizeof start, file) != sizeof start ||
	    memcmp(start, signature, sizeof start) != 0 || strlen(keyword) > KEYWORD_MAX)
		return GZ_ERR_FORMAT;
	while (read_head(file, &chunk)) {
		if (is_type(&chunk, "IEND"))
			return GZ_ERR_NOT_FOUND;
		if (is_text(&chunk) && chunk.length <= GZ_PNG_TEXT_MAX + AROUND_TEXT) {
			const enum gz_result result = try_chunk(file, &chunk, keyword, out_text);
			if (result != GZ_ERR_NOT_FOUND)
				return result;
		} else if (fseeko(file, (off_t)chunk.length + CRC_BYTES, SEEK_CUR) != 0) {
			return GZ_ERR_FORMAT;
		}
	}
	return GZ_ERR_FORMAT;
}
