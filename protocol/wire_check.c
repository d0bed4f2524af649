#include <stdbool.h>
#include <stdint.h>

#include "protocol/wire.h"

/* Walks a MessagePack value (the format's specification, "Formats") without a stack of its own
 * depth: what is still owed on each level is enough. */
struct walk {
	const unsigned char *next;
	size_t left;
	size_t depth;                     /* levels in owed */
	uint64_t owed[GZ_WIRE_DEPTH_MAX]; /* values to come on each open level */
};

static bool skip(struct walk *walk, uint64_t bytes)
{
	if (bytes > walk->left)
		return false;
	walk->next += bytes;
	walk->left -= bytes;
	return true;
}

/* A big-endian length of 1, 2 or 4 bytes. */
static bool read_length(struct walk *walk, size_t bytes, uint64_t *out_length)
{
	if (bytes > walk->left)
		return false;
	uint64_t length = 0;
	for (size_t i = 0; i < bytes; i++)
		length = length << 8 | walk->next[i];
	*out_length = length;
	return skip(walk, bytes);
}

/* Open a map or array of @p values values, each of at least one byte. */
static bool enter(struct walk *walk, uint64_t values)
{
	if (values > walk->left || walk->depth == GZ_WIRE_DEPTH_MAX)
		return false;
	walk->owed[walk->depth++] = values;
	return true;
}

/* A length of @p length_bytes bytes, then that many bytes and @p extra more. */
static bool skip_counted(struct walk *walk, size_t length_bytes, uint64_t extra)
{
	uint64_t length;
	return read_length(walk, length_bytes, &length) && skip(walk, length + extra);
}

/* A count of @p length_bytes bytes, then @p each values for each. */
static bool enter_counted(struct walk *walk, size_t length_bytes, uint64_t each)
{
	uint64_t count;
	return read_length(walk, length_bytes, &count) && enter(walk, count * each);
}

/* The formats 0xc0 to 0xdf, that have a byte of their own. */
static bool walk_tagged(struct walk *walk, unsigned char tag)
{
	switch (tag) {
	case 0xc0: /* nil, false, true */
	case 0xc2:
	case 0xc3:
		return true;
	case 0xc4: /* bin 8, 16, 32 */
	case 0xc5:
	case 0xc6:
		return skip_counted(walk, (size_t)1 << (tag - 0xc4), 0);
	case 0xc7: /* ext 8, 16, 32: a type byte and the data */
	case 0xc8:
	case 0xc9:
		return skip_counted(walk, (size_t)1 << (tag - 0xc7), 1);
	case 0xca: /* float 32, 64 */
	case 0xcb:
		return skip(walk, tag == 0xca ? 4 : 8);
	case 0xcc: /* uint 8, 16, 32, 64 */
	case 0xcd:
	case 0xce:
	case 0xcf:
		return skip(walk, UINT64_C(1) << (tag - 0xcc));
	case 0xd0: /* int 8, 16, 32, 64 */
	case 0xd1:
	case 0xd2:
	case 0xd3:
		return skip(walk, UINT64_C(1) << (tag - 0xd0));
	case 0xd4: /* fixext 1, 2, 4, 8, 16: a type byte and the data */
	case 0xd5:
	case 0xd6:
	case 0xd7:
	case 0xd8:
		return skip(walk, 1 + (UINT64_C(1) << (tag - 0xd4)));
	case 0xd9: /* str 8, 16, 32 */
	case 0xda:
	case 0xdb:
		return skip_counted(walk, (size_t)1 << (tag - 0xd9), 0);
	case 0xdc: /* array 16, 32 */
	case 0xdd:
		return enter_counted(walk, tag == 0xdc ? 2 : 4, 1);
	case 0xde: /* map 16, 32 */
	case 0xdf:
		return enter_counted(walk, tag == 0xde ? 2 : 4, 2);
	default: /* 0xc1 is never used */
		return false;
	}
}

static bool walk_value(struct walk *walk)
{
	if (walk->left == 0)
		return false;
	unsigned char tag = *walk->next;
	skip(walk, 1);
	if (tag < 0x80 || tag >= 0xe0) /* fixint */
		return true;
	if (tag < 0x90) /* fixmap */
		return enter(walk, 2 * (uint64_t)(tag & 0x0f));
	if (tag < 0xa0) /* fixarray */
		return enter(walk, tag & 0x0f);
	if (tag < 0xc0) /* fixstr */
		return skip(walk, tag & 0x1f);
	return walk_tagged(walk, tag);
}

enum gz_result gz_wire_check(const void *bytes, size_t size)
{
	struct walk walk = { .next = bytes, .left = size };
	if (!walk_value(&walk))
		return GZ_ERR_PROTOCOL;
	while (walk.depth > 0) {
		if (walk.owed[walk.depth - 1] == 0) {
			walk.depth--;
			continue;
		}
		walk.owed[walk.depth - 1]--;
		if (!walk_value(&walk))
			return GZ_ERR_PROTOCOL;
	}
	return walk.left == 0 ? GZ_OK : GZ_ERR_PROTOCOL;
}
