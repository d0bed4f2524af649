#include "daemon/zmtp_input.h"

#include <string.h>

enum { GREETING, FLAGS, LENGTH, BODY, UNKNOWN };

/* The greeting begins with a signature of ten bytes and the version. */
enum { SIGNATURE_END = 9, VERSION_AT = 10, GREETING_2_SIZE = 12, GREETING_3_SIZE = 64 };
enum { VERSION_1 = 0, VERSION_2 = 1 };

enum { FLAG_MORE = 1, FLAG_LARGE = 2, FLAG_COMMAND = 4 };

/* A command begins with the length of its name. */
static const char subscribe_command[] = "\x09SUBSCRIBE";
enum { SUBSCRIBE_SIZE = sizeof subscribe_command - 1 };

_Static_assert(sizeof((struct gz_zmtp_input *)0)->head == GZ_ZMTP_TOPIC_SIZE + SUBSCRIBE_SIZE,
	       "a topic is kept whole behind its command");

/* Without this signature the bytes are those of an older version. */
static bool contradicts_signature(size_t at, unsigned char byte)
{
	return (at == 0 && byte != 0xff) || (at == SIGNATURE_END && (byte & 1) == 0) ||
	       (at == VERSION_AT && byte == VERSION_1);
}

static void take_greeting_byte(struct gz_zmtp_input *input, unsigned char byte)
{
	size_t at = input->greeting++;
	if (at == VERSION_AT)
		input->flags = byte; /* the version, until the greeting ends */
	if (contradicts_signature(at, byte))
		input->phase = UNKNOWN;
	else if (at > VERSION_AT &&
		 (size_t)input->greeting ==
			 (input->flags == VERSION_2 ? GREETING_2_SIZE : GREETING_3_SIZE))
		input->phase = FLAGS;
}

static void begin_body(struct gz_zmtp_input *input)
{
	input->left = input->length;
	input->kept = 0;
	input->phase = BODY;
}

static void take_header_byte(struct gz_zmtp_input *input, unsigned char byte)
{
	if (input->phase == FLAGS) {
		input->flags = byte;
		input->length = 0;
		input->length_left = byte & FLAG_LARGE ? 8 : 1;
		input->phase = LENGTH;
		return;
	}
	input->length = input->length << 8 | byte;
	if (--input->length_left == 0)
		begin_body(input);
}

/* Take a part of the body. @return how many bytes */
static size_t take_body(struct gz_zmtp_input *input, const unsigned char *bytes, size_t size)
{
	size_t part = size < input->left ? size : (size_t)input->left;
	size_t room = sizeof input->head - input->kept;
	size_t kept = part < room ? part : room;
	memcpy(input->head + input->kept, bytes, kept);
	input->kept = (uint8_t)(input->kept + kept);
	input->left -= part;
	return part;
}

static struct gz_zmtp_frame ended_frame(const struct gz_zmtp_input *input)
{
	size_t header = input->flags & FLAG_LARGE ? 9 : 2;
	struct gz_zmtp_frame frame = { .kind = GZ_ZMTP_MESSAGE,
				       .size = input->length + header,
				       .body_size = input->length,
				       .more = (input->flags & (FLAG_MORE | FLAG_COMMAND)) ==
					       FLAG_MORE };
	size_t before = 1;
	bool subscribes = input->kept > 0 && input->head[0] == 1;
	if (input->flags & FLAG_COMMAND) {
		frame.kind = GZ_ZMTP_COMMAND;
		before = SUBSCRIBE_SIZE;
		subscribes = input->kept >= SUBSCRIBE_SIZE &&
			     memcmp(input->head, subscribe_command, SUBSCRIBE_SIZE) == 0;
	}
	if (subscribes) {
		frame.kind = GZ_ZMTP_SUBSCRIBE;
		frame.topic = input->head + before;
		frame.topic_size = input->length - before;
	}
	return frame;
}

/* Take at least one byte, if there is one or a body without bytes ends here. @return how many */
static size_t take_some(struct gz_zmtp_input *input, const unsigned char *bytes, size_t size)
{
	if (input->phase == BODY)
		return take_body(input, bytes, size);
	if (input->phase == GREETING)
		take_greeting_byte(input, bytes[0]);
	else
		take_header_byte(input, bytes[0]);
	return 1;
}

bool gz_zmtp_next(struct gz_zmtp_input *input, const unsigned char **bytes, size_t *size,
		  struct gz_zmtp_frame *out_frame)
{
	while (*size > 0) {
		size_t taken = input->phase == UNKNOWN ? *size : take_some(input, *bytes, *size);
		*bytes += taken;
		*size -= taken;
		if (input->phase == UNKNOWN) {
			*out_frame =
				(struct gz_zmtp_frame) { .kind = GZ_ZMTP_UNKNOWN, .size = taken };
			return true;
		}
		if (input->phase == BODY && input->left == 0) {
			input->phase = FLAGS;
			*out_frame = ended_frame(input);
			return true;
		}
	}
	return false;
}
