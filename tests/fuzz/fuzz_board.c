/* A board in shared memory that is no daemon's: reading ends, and gives only what lies in it. The
 * input is the head, the newest and the tail (8 bytes each), then
 * the beginning of the messages. */
#include <fcntl.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "protocol/board/board.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { SIZE_AT = 8, HEAD_AT = 64, TAIL_AT = 128, WHOLE = GZ_BOARD_HEADER_SIZE + GZ_BOARD_SIZE_MIN };

static void require(bool holds)
{
	if (!holds)
		abort();
}

static int make_fuzzed_memory(const uint8_t *data, size_t size)
{
	static uint8_t memory[WHOLE];
	const uint64_t claimed = GZ_BOARD_SIZE_MIN;
	memset(memory, 0, sizeof memory);
	memcpy(memory, GZ_BOARD_MAGIC, 8);
	memcpy(memory + SIZE_AT, &claimed, sizeof claimed);
	memcpy(memory + HEAD_AT, data, 16);
	memcpy(memory + TAIL_AT, data + 16, 8);
	memcpy(memory + GZ_BOARD_HEADER_SIZE, data + 24,
	       size - 24 < GZ_BOARD_SIZE_MIN ? size - 24 : GZ_BOARD_SIZE_MIN);
	int fd = memfd_create("fuzz-board", MFD_CLOEXEC | MFD_ALLOW_SEALING);
	require(fd >= 0 && write(fd, memory, sizeof memory) == (ssize_t)sizeof memory);
	require(fcntl(fd, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_WRITE) == 0);
	return fd;
}

/* Read every byte of a message, so that a sanitizer sees where it lies. */
static void use_record(const struct gz_board_record *record)
{
	unsigned sum = 0;
	require(record->topic_size <= GZ_BOARD_TOPIC_MAX && record->body_size <= GZ_BOARD_BODY_MAX);
	for (size_t i = 0; i < record->topic_size; i++)
		sum += (unsigned char)record->topic[i];
	for (size_t i = 0; i < record->body_size; i++)
		sum += ((const unsigned char *)record->body)[i];
	require(sum <= 255 * (record->topic_size + record->body_size));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct gz_board_reader *reader = NULL;
	struct gz_board_record record;
	if (size < 24)
		return 0;
	int fd = make_fuzzed_memory(data, size);
	require(gz_board_open(fd, &reader) == GZ_OK);
	close(fd);
	if (gz_board_newest(reader, &record) == GZ_OK)
		use_record(&record);
	/* A message has three words or more. */
	for (int left = GZ_BOARD_SIZE_MIN / 24; gz_board_next(reader, &record) == GZ_OK; left--) {
		require(left > 0);
		use_record(&record);
	}
	gz_board_skip(reader, INT64_MAX);
	gz_board_close(&reader);
	return 0;
}
