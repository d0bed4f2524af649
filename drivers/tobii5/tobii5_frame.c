#include "drivers/tobii5/tobii5_frame.h"

#include <string.h>

#include "drivers/device/big_endian.h"
#include "drivers/device/little_endian.h"

enum {
	AT_LENGTH = 4, /* of an envelope */
	AT_NUMBER = 4, /* of a frame */
	AT_OPERATION = 12,
	AT_PAYLOAD_SIZE = 20,
};

static const unsigned char from_tracker[AT_LENGTH] = { 1, 0, 0, 0 };

static bool is_tobii5_kind(uint32_t kind)
{
	return kind >= GZ_TOBII5_REQUEST && kind <= GZ_TOBII5_NOTIFICATION;
}

/* Whether a transfer holds the beginning of a frame whose two lengths agree. */
static bool begins_tobii5_frame(const unsigned char *bytes, size_t size)
{
	const unsigned char *head = bytes + GZ_TOBII5_ENVELOPE_SIZE;
	uint32_t overhead = GZ_TOBII5_ENVELOPE_SIZE + GZ_TOBII5_HEAD_SIZE;
	return size >= overhead && memcmp(bytes, from_tracker, sizeof from_tracker) == 0 &&
	       is_tobii5_kind(gz_read_u32be(head)) &&
	       gz_read_u32le(bytes + AT_LENGTH) - overhead == gz_read_u32be(head + AT_PAYLOAD_SIZE);
}

/* Whether a transfer is one envelope with all that it announces. */
static bool is_tobii5_envelope(const unsigned char *bytes, size_t size)
{
	return size >= GZ_TOBII5_ENVELOPE_SIZE &&
	       memcmp(bytes, from_tracker, sizeof from_tracker) == 0 &&
	       gz_read_u32le(bytes + AT_LENGTH) == size;
}

static bool is_within_frame(const struct gz_tobii5_reader *reader)
{
	return reader->head_got > 0;
}

static bool is_between_frames(const struct gz_tobii5_reader *reader)
{
	return !is_within_frame(reader) && reader->envelope_got == 0 && reader->envelope_left == 0;
}

static void forget_tobii5_frame(struct gz_tobii5_reader *reader)
{
	reader->envelope_got = reader->envelope_left = 0;
	reader->head_got = reader->payload_size = reader->payload_got = 0;
}

void gz_tobii5_reader_take(struct gz_tobii5_reader *reader, const unsigned char *bytes, size_t size)
{
	reader->bytes = bytes;
	reader->size = size;
	reader->is_start = true;
	reader->is_torn = !is_between_frames(reader) && begins_tobii5_frame(bytes, size);
	if (is_within_frame(reader) && is_tobii5_envelope(bytes, size))
		reader->envelope_left = 0; /* what the last one announced comes in this one */
}

static enum gz_result refuse_tobii5_bytes(struct gz_tobii5_reader *reader, enum gz_malformed reason,
					  enum gz_malformed *out_malformed)
{
	forget_tobii5_frame(reader);
	reader->size = 0;
	*out_malformed = reason;
	return GZ_ERR_PROTOCOL;
}

/* Move as much of the transfer as there is to @p to, of which @p got of @p wanted bytes are there.
 * @return whether all are there now */
static bool fill_tobii5_bytes(struct gz_tobii5_reader *reader, unsigned char *to, uint32_t *got,
			      uint32_t wanted)
{
	uint32_t count = wanted - *got;
	if (count > reader->size)
		count = (uint32_t)reader->size;
	memcpy(to + *got, reader->bytes, count);
	reader->bytes += count;
	reader->size -= count;
	*got += count;
	return *got == wanted;
}

/* Whether the transfer continues a frame without an envelope of its own. */
static bool is_bare_continuation(const struct gz_tobii5_reader *reader)
{
	size_t count = reader->size < sizeof from_tracker ? reader->size : sizeof from_tracker;
	return reader->is_start && is_within_frame(reader) && reader->envelope_got == 0 &&
	       memcmp(reader->bytes, from_tracker, count) != 0;
}

static enum gz_result read_tobii5_envelope(struct gz_tobii5_reader *reader,
					   enum gz_malformed *out_malformed)
{
	if (is_bare_continuation(reader)) {
		reader->envelope_left = (uint32_t)reader->size;
		return GZ_OK;
	}
	if (!fill_tobii5_bytes(reader, reader->envelope, &reader->envelope_got,
			       GZ_TOBII5_ENVELOPE_SIZE))
		return GZ_OK;
	uint32_t length = gz_read_u32le(reader->envelope + AT_LENGTH);
	reader->envelope_got = 0;
	if (memcmp(reader->envelope, from_tracker, sizeof from_tracker) != 0 ||
	    length < GZ_TOBII5_ENVELOPE_SIZE)
		return refuse_tobii5_bytes(reader, GZ_MALFORMED_SYNTAX, out_malformed);
	reader->envelope_left = length - GZ_TOBII5_ENVELOPE_SIZE;
	return GZ_OK;
}

static enum gz_result read_tobii5_head(struct gz_tobii5_reader *reader,
				       enum gz_malformed *out_malformed)
{
	uint32_t before = reader->head_got, wanted = GZ_TOBII5_HEAD_SIZE;
	if (wanted - before > reader->envelope_left)
		wanted = before + reader->envelope_left;
	fill_tobii5_bytes(reader, reader->head, &reader->head_got, wanted);
	reader->envelope_left -= reader->head_got - before;
	if (reader->head_got < GZ_TOBII5_HEAD_SIZE)
		return GZ_OK;
	reader->payload_size = gz_read_u32be(reader->head + AT_PAYLOAD_SIZE);
	if (!is_tobii5_kind(gz_read_u32be(reader->head)))
		return refuse_tobii5_bytes(reader, GZ_MALFORMED_SYNTAX, out_malformed);
	if (reader->payload_size > GZ_TOBII5_FRAME_MAX)
		return refuse_tobii5_bytes(reader, GZ_MALFORMED_LONG, out_malformed);
	return GZ_OK;
}

/* Read what the envelope holds of the payload; keep what there is room for. */
static void read_tobii5_payload(struct gz_tobii5_reader *reader)
{
	uint32_t count = reader->payload_size - reader->payload_got;
	if (count > reader->envelope_left)
		count = reader->envelope_left;
	if (count > reader->size)
		count = (uint32_t)reader->size;
	if (reader->payload_got < GZ_TOBII5_PAYLOAD_MAX) {
		uint32_t room = GZ_TOBII5_PAYLOAD_MAX - reader->payload_got;
		memcpy(reader->payload + reader->payload_got, reader->bytes,
		       count < room ? count : room);
	}
	reader->bytes += count;
	reader->size -= count;
	reader->payload_got += count;
	reader->envelope_left -= count;
}

static bool is_tobii5_frame_complete(const struct gz_tobii5_reader *reader)
{
	return reader->head_got == GZ_TOBII5_HEAD_SIZE &&
	       reader->payload_got == reader->payload_size;
}

/* Read the next piece: an envelope, a head, or some payload. */
static enum gz_result read_tobii5_piece(struct gz_tobii5_reader *reader,
					enum gz_malformed *out_malformed)
{
	enum gz_result result = GZ_OK;
	if (reader->envelope_left == 0)
		result = read_tobii5_envelope(reader, out_malformed);
	else if (reader->head_got < GZ_TOBII5_HEAD_SIZE)
		result = read_tobii5_head(reader, out_malformed);
	else
		read_tobii5_payload(reader);
	reader->is_start = false;
	return result;
}

enum gz_result gz_tobii5_reader_next(struct gz_tobii5_reader *reader,
				     struct gz_tobii5_frame *out_frame,
				     enum gz_malformed *out_malformed)
{
	if (reader->is_torn) {
		reader->is_torn = false;
		forget_tobii5_frame(reader);
		*out_malformed = GZ_MALFORMED_SHORT;
		return GZ_ERR_PROTOCOL;
	}
	while (reader->size > 0) {
		enum gz_result result = read_tobii5_piece(reader, out_malformed);
		if (result != GZ_OK)
			return result;
		if (!is_tobii5_frame_complete(reader))
			continue;
		*out_frame = (struct gz_tobii5_frame) {
			.kind = (enum gz_tobii5_kind)gz_read_u32be(reader->head),
			.number = gz_read_u32be(reader->head + AT_NUMBER),
			.operation = gz_read_u32be(reader->head + AT_OPERATION),
			.size = reader->payload_size,
			.payload = reader->payload,
		};
		reader->head_got = reader->payload_size = reader->payload_got = 0;
		return GZ_OK;
	}
	return GZ_ERR_END;
}
