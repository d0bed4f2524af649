#include "render/data/tar_member.h"

#include <string.h>

#define GZ_LOG_MODULE "volume"

/* Where a header has its fields, bytes. */
enum {
	AT_NAME = 0,
	AT_SIZE = 124,
	AT_SUM = 148,
	AT_TYPE = 156,
	AT_MAGIC = 257,
	NAME_SIZE = 100,
	SIZE_SIZE = 12,
	SUM_SIZE = 8,
};

/* Octal digits, which end with a blank, a NUL or the field. */
static bool read_octal(const uint8_t *field, size_t size, uint64_t *out_number)
{
	uint64_t number = 0;
	size_t at = 0;
	while (at < size && field[at] == ' ')
		at++;
	const size_t first = at;
	for (; at < size && field[at] >= '0' && field[at] <= '7'; at++)
		number = number * 8 + (field[at] - '0');
	*out_number = number;
	return at > first && (at == size || field[at] == ' ' || field[at] == 0);
}

/* The sum of all bytes, with blanks where it stands itself. */
static uint64_t sum_of(const uint8_t *block)
{
	uint64_t sum = (uint64_t)' ' * SUM_SIZE;
	for (size_t at = 0; at < GZ_TAR_BLOCK; at++)
		sum += at < AT_SUM || at >= AT_SUM + SUM_SIZE ? block[at] : 0;
	return sum;
}

bool gz_tar_header_decode(const uint8_t block[GZ_TAR_BLOCK], struct gz_tar_member *out_member)
{
	struct gz_tar_member member = { .is_file = block[AT_TYPE] == '0' || block[AT_TYPE] == 0 };
	uint64_t sum;
	char name[NAME_SIZE + 1] = { 0 };
	if (memcmp(block + AT_MAGIC, "ustar", 5) != 0 ||
	    !read_octal(block + AT_SUM, SUM_SIZE, &sum) || sum != sum_of(block) ||
	    !read_octal(block + AT_SIZE, SIZE_SIZE, &member.size))
		return false;
	memcpy(name, block + AT_NAME, NAME_SIZE);
	const char *slash = strrchr(name, '/');
	strcpy(member.name, slash ? slash + 1 : name);
	*out_member = member;
	return true;
}

/* A size has twelve octal digits at most, so that nothing wraps. */
uint64_t gz_tar_padded_size(uint64_t size)
{
	return (size + GZ_TAR_BLOCK - 1) / GZ_TAR_BLOCK * GZ_TAR_BLOCK;
}

static bool all_zero(const uint8_t *block, size_t size)
{
	size_t at = 0;
	while (at < size && block[at] == 0)
		at++;
	return at == size;
}

enum gz_result gz_tar_find(struct gz_byte_stream *stream, const char *name, const char *path,
			   const struct gz_log *log, uint64_t *out_size)
{
	for (;;) {
		struct gz_tar_member member;
		uint8_t block[GZ_TAR_BLOCK];
		size_t got = 0;
		enum gz_result result = gz_byte_stream_read(stream, block, sizeof block, &got);
		if (result != GZ_OK)
			return result;
		if (all_zero(block, got)) /* or no byte at all */
			return GZ_ERR_NOT_FOUND;
		if (got < sizeof block || !gz_tar_header_decode(block, &member)) {
			gz_err(log, "%s: damaged, or not a tar file; fetch it again", path);
			return GZ_ERR_FORMAT;
		}
		if (member.is_file && strcmp(member.name, name) == 0) {
			*out_size = member.size;
			return GZ_OK;
		}
		result = gz_byte_stream_skip(stream, gz_tar_padded_size(member.size));
		if (result != GZ_OK)
			return result;
	}
}
