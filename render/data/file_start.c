#include "render/data/file_start.h"

#include <string.h>

enum gz_coding gz_coding_of_bytes(const uint8_t *bytes, size_t size)
{
	/* bzip2 by its header and the magic number of its first block. RFC 1952, section 2.3.1; RFC
	 * 8878, sections 3.1.1 and 3.1.2 (skippable frames, which parallel compressors write
	 * first). */
	static const uint8_t gzip[] = { 0x1f, 0x8b }, zstd[] = { 0x28, 0xb5, 0x2f, 0xfd },
			     skippable[] = { 0x2a, 0x4d, 0x18 };
	if (size >= sizeof gzip && memcmp(bytes, gzip, sizeof gzip) == 0)
		return GZ_CODING_ZLIB;
	if (size >= sizeof zstd && memcmp(bytes, zstd, sizeof zstd) == 0)
		return GZ_CODING_ZSTD;
	if (size >= 10 && memcmp(bytes, "BZh", 3) == 0 && memcmp(bytes + 4, "1AY&SY", 6) == 0)
		return GZ_CODING_BZIP2;
	if (size >= 1 + sizeof skippable && bytes[0] >> 4 == 5 &&
	    memcmp(bytes + 1, skippable, sizeof skippable) == 0)
		return GZ_CODING_ZSTD;
	return GZ_CODING_PLAIN;
}

/* Up to `size` bytes, decoded; fewer if the file ends. */
static bool read_file_start(const char *path, enum gz_coding coding, uint8_t *bytes, size_t size,
			    size_t *out_got)
{
	struct gz_byte_stream *stream = NULL;
	enum gz_result result = gz_byte_stream_open(path, coding, 0, NULL, &stream);
	if (result == GZ_OK)
		result = gz_byte_stream_read(stream, bytes, size, out_got);
	gz_byte_stream_close(&stream);
	return result == GZ_OK;
}

enum gz_coding gz_coding_of_file(const char *path)
{
	uint8_t bytes[16];
	size_t got = 0;
	if (!read_file_start(path, GZ_CODING_PLAIN, bytes, sizeof bytes, &got))
		return GZ_CODING_PLAIN;
	return gz_coding_of_bytes(bytes, got);
}

bool gz_file_start_read(const char *path, struct gz_file_start *out_start)
{
	struct gz_file_start start = { 0 };
	if (!read_file_start(path, GZ_CODING_PLAIN, start.bytes, sizeof start.bytes, &start.size))
		return false;
	start.coding = gz_coding_of_bytes(start.bytes, start.size);
	if (start.coding != GZ_CODING_PLAIN &&
	    !read_file_start(path, start.coding, start.bytes, sizeof start.bytes, &start.size))
		return false;
	*out_start = start;
	return true;
}

bool gz_file_start_has(const struct gz_file_start *start, size_t at, const void *magic, size_t size)
{
	return start->size >= at + size && memcmp(start->bytes + at, magic, size) == 0;
}

size_t gz_file_number_size(enum gz_file_number type)
{
	static const size_t sizes[GZ_FILE_NUMBER_COUNT] = { 1, 1, 2, 2, 4, 4, 8, 8, 4, 8 };
	return sizes[type];
}

double gz_file_number_at(const uint8_t *bytes, enum gz_file_number type, bool big_endian)
{
	const size_t size = gz_file_number_size(type);
	uint64_t bits = 0;
	for (size_t i = 0; i < size; i++)
		bits |= (uint64_t)bytes[big_endian ? size - 1 - i : i] << 8 * i;
	const uint32_t word = (uint32_t)bits;
	float real;
	double number;
	memcpy(&real, &word, sizeof real);
	memcpy(&number, &bits, sizeof number);
	switch (type) {
	case GZ_FILE_I8:
		return (int8_t)bits;
	case GZ_FILE_I16:
		return (int16_t)bits;
	case GZ_FILE_I32:
		return (int32_t)bits;
	case GZ_FILE_I64:
		return (double)(int64_t)bits;
	case GZ_FILE_U8:
	case GZ_FILE_U16:
	case GZ_FILE_U32:
	case GZ_FILE_U64:
		return (double)bits;
	case GZ_FILE_F32:
		return (double)real;
	case GZ_FILE_F64:
	case GZ_FILE_NUMBER_COUNT:
		break;
	}
	return number;
}
