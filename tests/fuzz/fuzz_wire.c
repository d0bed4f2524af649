/* Untrusted messages: the bounds check and every decoder behind it. */
#include <math.h>
#include <msgpack.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include "protocol/wire.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool holds)
{
	if (!holds)
		abort();
}

/* What passes the check msgpack-c reads to its end. */
static void check_agrees(const uint8_t *data, size_t size)
{
	if (gz_wire_check(data, size) != GZ_OK)
		return;
	msgpack_unpacked unpacked;
	size_t offset = 0;
	msgpack_unpacked_init(&unpacked);
	require(msgpack_unpack_next(&unpacked, (const char *)data, size, &offset) ==
		MSGPACK_UNPACK_SUCCESS);
	require(offset == size);
	msgpack_unpacked_destroy(&unpacked);
}

/* What decodes can be drawn, and is encoded to something that decodes again. */
static void check_gaze(const struct gz_gaze *gaze)
{
	struct gz_display display = gz_display_default(1920, 1080);
	struct gz_wire_message message;
	struct gz_gaze again;
	require(isfinite(gaze->point.x) && isfinite(gaze->point.y));
	require(isnan(gaze->confidence) || (gaze->confidence >= 0 && gaze->confidence <= 1));
	require(gaze->event < GZ_EVENT_COUNT && gaze->final_event < GZ_EVENT_COUNT);
	require(gz_wire_encode_gaze(gaze, &display, &message) == GZ_OK);
	require(gz_wire_decode_gaze(message.bytes, message.size, &again) == GZ_OK);
	require(again.host_ns == gaze->host_ns && again.seq == gaze->seq);
	require(again.point.x == gaze->point.x && again.point.y == gaze->point.y);
}

static void check_status(const struct gz_status *status)
{
	struct gz_wire_message message;
	struct gz_status again;
	require(gz_wire_encode_status(status, &message) == GZ_OK);
	require(gz_wire_decode_status(message.bytes, message.size, &again) == GZ_OK);
	require(again.samples == status->samples);
}

static void check_surface(const uint8_t *data, size_t size)
{
	struct gz_surface_gaze entries[16];
	size_t count = 0;
	if (gz_wire_decode_surface(data, size, entries, 16, &count) != GZ_OK)
		return;
	require(count <= 16);
	for (size_t i = 0; i < count; i++) {
		require(isfinite(entries[i].point.x) && isfinite(entries[i].point.y));
		require(!(entries[i].confidence < 0) && !(entries[i].confidence > 1));
	}
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct gz_gaze gaze;
	struct gz_fixation fixation;
	struct gz_blink blink;
	struct gz_saccade saccade;
	struct gz_status status;
	check_agrees(data, size);
	if (gz_wire_decode_gaze(data, size, &gaze) == GZ_OK)
		check_gaze(&gaze);
	if (gz_wire_decode_status(data, size, &status) == GZ_OK)
		check_status(&status);
	if (gz_wire_decode_fixation(data, size, &fixation) == GZ_OK)
		require(fixation.duration_ns >= 0);
	if (gz_wire_decode_saccade(data, size, &saccade) == GZ_OK)
		require(saccade.duration_ns >= 0);
	gz_wire_decode_blink(data, size, &blink);
	struct gz_viewer_pointer pointer;
	if (gz_wire_decode_pointer(data, size, &pointer) == GZ_OK && pointer.known)
		require(isfinite(pointer.point.x) && isfinite(pointer.point.y));
	struct gz_viewer_window window;
	if (gz_wire_decode_window(data, size, &window) == GZ_OK && window.known)
		require(window.rect_px[2] > 0 && window.rect_px[3] > 0);
	check_surface(data, size);
	struct gz_notification notification;
	if (gz_wire_decode_notification(data, size, &notification) == GZ_OK)
		require(notification.subject[0] != '\0');
	struct gz_annotation annotation;
	gz_wire_decode_annotation(data, size, &annotation);
	return 0;
}
