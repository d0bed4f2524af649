/* Untrusted transfers of a Tobii Eye Tracker 5, from frames to gaze and display area. The first
 * byte says how long the transfers are. */
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/tobii5/tobii5_session.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool holds)
{
	if (!holds)
		abort();
}

static void check_point(struct gz_point point, bool valid)
{
	require(!isinf(point.x) && !isinf(point.y));
	require(isnan(point.x) == isnan(point.y) && (!valid || !isnan(point.x)));
}

static void check_gaze(const struct gz_tobii5_frame *frame)
{
	struct gz_tobii5_gaze gaze;
	enum gz_malformed malformed = GZ_MALFORMED_COUNT;
	size_t size = frame->size < GZ_TOBII5_PAYLOAD_MAX ? frame->size : GZ_TOBII5_PAYLOAD_MAX;
	/* An exact allocation, so that a sanitizer sees the first byte read past the end. */
	unsigned char *bytes = malloc(size ? size : 1);
	require(bytes != NULL);
	memcpy(bytes, frame->payload, size);
	if (gz_tobii5_parse_gaze(bytes, size, &gaze, &malformed) == GZ_OK) {
		require(malformed == GZ_MALFORMED_COUNT);
		check_point(gaze.point, gaze.valid);
		for (int i = 0; i < GZ_EYE_COUNT; i++) {
			const struct gz_eye_sample *eye = &gaze.eye[i];
			check_point(eye->point, eye->valid);
			require(isnan(eye->pupil_mm) || eye->pupil_mm > 0);
			for (int k = 0; k < 3; k++)
				require(!isinf(eye->origin_mm[k]) &&
					!(fabsf(eye->direction[k]) > 1.0001f));
		}
	} else {
		require(malformed < GZ_MALFORMED_COUNT && malformed != GZ_MALFORMED_STALE);
	}
	struct gz_tobii5_area area;
	if (gz_tobii5_parse_area(bytes, size, &area) == GZ_OK)
		require(gz_tobii5_area_is_near(&area, &area));
	free(bytes);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static struct gz_tobii5_reader reader;
	struct gz_tobii5_session session;
	unsigned char request[GZ_TOBII5_REQUEST_MAX];
	int64_t now_ns = 0;
	if (size == 0)
		return 0;
	reader = (struct gz_tobii5_reader) { 0 };
	gz_tobii5_session_begin(&session, NULL, now_ns);
	size_t step = data[0] ? (size_t)data[0] * 8 : size;
	for (size_t at = 1; at < size; at += step) {
		struct gz_tobii5_frame frame;
		enum gz_malformed malformed;
		enum gz_result result;
		gz_tobii5_reader_take(&reader, data + at, step < size - at ? step : size - at);
		while ((result = gz_tobii5_reader_next(&reader, &frame, &malformed)) !=
		       GZ_ERR_END) {
			if (result != GZ_OK)
				continue;
			require(frame.size <= GZ_TOBII5_FRAME_MAX);
			gz_tobii5_session_take(&session, &frame, now_ns);
			check_gaze(&frame);
		}
		require(gz_tobii5_session_ask(&session, now_ns, request) <= sizeof request);
		now_ns += 1000000000;
	}
	return 0;
}
