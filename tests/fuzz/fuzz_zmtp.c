/* What a reader sends over TCP: the same frames whatever the pieces in which the bytes come, and
 * all bytes read. The first byte is the size of the pieces. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/zmtp_input.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

struct sums {
	uint64_t frames, sizes, topic_sizes, topic_bytes, unknown;
};

static void require(bool holds)
{
	if (!holds)
		abort();
}

static void add_frame(struct sums *sums, const struct gz_zmtp_frame *frame)
{
	if (frame->kind == GZ_ZMTP_UNKNOWN) {
		sums->unknown += frame->size;
		return;
	}
	sums->frames++;
	sums->sizes += frame->size;
	if (frame->kind != GZ_ZMTP_SUBSCRIBE)
		return;
	require(frame->topic_size < frame->size);
	sums->topic_sizes += frame->topic_size;
	for (size_t i = 0; i < frame->topic_size && i < GZ_ZMTP_TOPIC_SIZE; i++)
		sums->topic_bytes = sums->topic_bytes * 31 + frame->topic[i];
}

static struct sums read_in_pieces(const uint8_t *data, size_t size, size_t piece)
{
	struct gz_zmtp_input input = { 0 };
	struct gz_zmtp_frame frame;
	struct sums sums = { 0 };
	for (size_t at = 0; at < size; at += piece) {
		const unsigned char *bytes = data + at;
		size_t left = size - at < piece ? size - at : piece;
		while (gz_zmtp_next(&input, &bytes, &left, &frame))
			add_frame(&sums, &frame);
		require(left == 0 && bytes == data + at + (size - at < piece ? size - at : piece));
	}
	return sums;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	if (size < 2)
		return 0;
	struct sums whole = read_in_pieces(data + 1, size - 1, size - 1);
	struct sums pieces = read_in_pieces(data + 1, size - 1, (size_t)data[0] % 64 + 1);
	require(memcmp(&whole, &pieces, sizeof whole) == 0);
	require(whole.sizes + whole.unknown <= size - 1);
	return 0;
}
