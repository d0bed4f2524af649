#include "daemon/zap.h"

#include <string.h>
#include <zmq.h>

/* A curve25519 public key. */
enum { KEY_BYTES = 32 };

enum { FRAME_VERSION, FRAME_ID, FRAME_DOMAIN, FRAME_ADDRESS, FRAME_IDENTITY, FRAME_MECHANISM };
enum { FRAME_KEY = GZ_ZAP_FRAMES - 1 };

static bool is_text(const struct gz_zap_frame *frame, const char *text)
{
	return frame->size == strlen(text) && memcmp(frame->bytes, text, frame->size) == 0;
}

/* What is logged must not steer a terminal. */
static void take_address(const struct gz_zap_frame *frame, char out[GZ_ADDRESS_SIZE])
{
	const unsigned char *bytes = frame->bytes;
	size_t size = frame->size < GZ_ADDRESS_SIZE ? frame->size : GZ_ADDRESS_SIZE - 1;
	for (size_t i = 0; i < size; i++)
		out[i] = bytes[i] > ' ' && bytes[i] < 0x7f ? (char)bytes[i] : '?';
	if (size == 0)
		out[size++] = '?';
	out[size] = '\0';
}

enum gz_result gz_zap_parse(const struct gz_zap_frame *frames, size_t count,
			    struct gz_zap_request *out)
{
	out->id_size = 0;
	if (count <= FRAME_ID || frames[FRAME_ID].size > sizeof out->id)
		return GZ_ERR_PROTOCOL;
	out->id_size = frames[FRAME_ID].size;
	if (out->id_size > 0)
		memcpy(out->id, frames[FRAME_ID].bytes, out->id_size);
	if (count <= FRAME_MECHANISM)
		return GZ_ERR_PROTOCOL;
	if (!is_text(&frames[FRAME_VERSION], "1.0") || !is_text(&frames[FRAME_MECHANISM], "CURVE"))
		return GZ_ERR_ACCESS;
	if (count != GZ_ZAP_FRAMES)
		return GZ_ERR_PROTOCOL;
	if (frames[FRAME_KEY].size != KEY_BYTES ||
	    !zmq_z85_encode(out->key, frames[FRAME_KEY].bytes, KEY_BYTES))
		return GZ_ERR_ACCESS;
	take_address(&frames[FRAME_ADDRESS], out->address);
	return GZ_OK;
}
