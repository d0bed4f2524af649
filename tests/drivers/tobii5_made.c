#include "tobii5_made.h"

#include <math.h>
#include <string.h>

#include "frame_bytes.h"

static unsigned char *put_big(unsigned char *bytes, size_t size, uint64_t value)
{
	for (size_t i = 0; i < size; i++)
		*bytes++ = (unsigned char)(value >> (8 * (size - 1 - i)));
	return bytes;
}

static uint32_t get_big(const unsigned char *bytes)
{
	uint32_t value = 0;
	for (int i = 0; i < 4; i++)
		value = value << 8 | bytes[i];
	return value;
}

static unsigned char *put_field(unsigned char *bytes, uint8_t type, uint32_t size, uint64_t value)
{
	*bytes++ = type;
	return put_big(put_big(bytes, 4, size), size, value);
}

static unsigned char *put_tag(unsigned char *bytes, uint32_t tag)
{
	return put_field(bytes, 5, 4, tag);
}

static unsigned char *put_fraction(unsigned char *bytes, double value)
{
	return put_field(bytes, 4, 8, (uint64_t)llround(ldexp(value, 42)));
}

static unsigned char *put_column(unsigned char *bytes, uint32_t number)
{
	return put_field(put_tag(bytes, 0x20bb9), 2, 4, number);
}

static unsigned char *put_u32_column(unsigned char *bytes, uint32_t number, uint32_t value)
{
	return put_field(put_column(bytes, number), 2, 4, value);
}

static unsigned char *put_fix_column(unsigned char *bytes, uint32_t number, double value)
{
	return put_field(put_column(bytes, number), 3, 4, (uint32_t)(int32_t)lround(value * 65536));
}

static unsigned char *put_point_column(unsigned char *bytes, uint32_t number, const double point[2])
{
	bytes = put_tag(put_column(bytes, number), 0x21f40);
	return put_fraction(put_fraction(bytes, point[0]), point[1]);
}

static unsigned char *put_place(unsigned char *bytes, const double place[3])
{
	bytes = put_tag(bytes, 0x31f41);
	for (int i = 0; i < 3; i++)
		bytes = put_fraction(bytes, place[i]);
	return bytes;
}

static unsigned char *put_place_column(unsigned char *bytes, uint32_t number, const double place[3])
{
	return put_place(put_column(bytes, number), place);
}

static const double nowhere[3], beside[2] = { -1, -1 };

/* The six columns of an eye, of which the first has this number. */
static unsigned char *put_eye_columns(unsigned char *bytes, uint32_t first,
				      const struct tobii5_made_gaze *gaze, int eye)
{
	bool seen = gaze->eye[eye].seen;
	bytes = put_place_column(bytes, first, seen ? gaze->eye[eye].origin_mm : nowhere);
	bytes = put_place_column(bytes, first + 1, nowhere);
	bytes = put_place_column(bytes, first + 2, seen ? gaze->eye[eye].target_mm : nowhere);
	bytes = put_point_column(bytes, first + 3, seen ? gaze->eye[eye].point : beside);
	bytes = put_fix_column(bytes, first + 4, seen ? gaze->eye[eye].pupil_mm : -1);
	return gaze->lacks_seen ? bytes : put_u32_column(bytes, first + 5, seen ? 0 : 4);
}

/* Columns 0x0e to 0x1b. */
static unsigned char *put_status_columns(unsigned char *bytes, const struct tobii5_made_gaze *gaze)
{
	bool left = gaze->eye[GZ_EYE_LEFT].seen, right = gaze->eye[GZ_EYE_RIGHT].seen;
	bytes = put_u32_column(bytes, 0x0e, 0);
	bytes = put_u32_column(bytes, 0x11, 4);
	bytes = put_u32_column(bytes, 0x14, gaze->counter);
	bytes = put_u32_column(bytes, 0x15, left);
	bytes = put_u32_column(bytes, 0x16, right);
	bytes = put_place_column(bytes, 0x17, nowhere);
	bytes = put_place_column(bytes, 0x18, nowhere);
	bytes = put_point_column(bytes, 0x19, beside);
	bytes = put_point_column(bytes, 0x1a, beside);
	return put_u32_column(bytes, 0x1b, left && right);
}

/* Columns 0x1c to 0x2c. The smoothed point differs from the other one. */
static unsigned char *put_common_columns(unsigned char *bytes, const struct tobii5_made_gaze *gaze)
{
	static const double smoothed[2] = { 0.125, 0.125 };
	bytes = put_point_column(bytes, 0x1c, smoothed);
	bytes = put_u32_column(bytes, 0x1d, gaze->known);
	bytes = put_u32_column(bytes, 0x1e, gaze->eye[GZ_EYE_LEFT].seen);
	bytes = put_u32_column(bytes, 0x1f, gaze->eye[GZ_EYE_RIGHT].seen);
	bytes = put_point_column(bytes, 0x20, gaze->known ? gaze->point : beside);
	bytes = put_u32_column(bytes, 0x21, gaze->known);
	for (uint32_t number = 0x22; number <= 0x28; number++) {
		if (number == 0x23 || number == 0x26 || number == 0x28)
			bytes = put_u32_column(bytes, number, 0);
		else
			bytes = put_place_column(bytes, number, nowhere);
	}
	bytes = put_fix_column(bytes, 0x29, -1);
	bytes = put_u32_column(bytes, 0x2a, 0);
	bytes = put_fix_column(bytes, 0x2b, -1);
	return put_u32_column(bytes, 0x2c, 0);
}

size_t tobii5_made_frame(uint32_t kind, uint32_t number, uint32_t operation,
			 const unsigned char *payload, size_t size, unsigned char *bytes)
{
	unsigned char *end = frame_put(bytes, 4, 1);
	end = frame_put(end, 4, TOBII5_MADE_OVERHEAD + size);
	end = put_big(put_big(put_big(end, 4, kind), 4, number), 4, 0);
	end = put_big(put_big(put_big(end, 4, operation), 4, 0), 4, size);
	if (size > 0)
		memcpy(end, payload, size);
	return TOBII5_MADE_OVERHEAD + size;
}

size_t tobii5_made_gaze(const struct tobii5_made_gaze *gaze, unsigned char bytes[TOBII5_MADE_MAX])
{
	unsigned char payload[TOBII5_MADE_MAX] = { 0, 0 };
	uint32_t columns = gaze->lacks_seen ? 38 : 40;
	unsigned char *end = put_tag(payload + 2, columns << 16 | 0x0bb8);
	end = put_field(put_column(end, 0x01), 6, 8, (uint64_t)gaze->time_us);
	end = put_eye_columns(end, 0x02, gaze, GZ_EYE_LEFT);
	end = put_eye_columns(end, 0x08, gaze, GZ_EYE_RIGHT);
	end = put_common_columns(put_status_columns(end, gaze), gaze);
	return tobii5_made_frame(0x53, 0, 0x500, payload, (size_t)(end - payload), bytes);
}

struct tobii5_made_gaze tobii5_made_looking(uint32_t number, double x, double y)
{
	struct tobii5_made_gaze gaze = {
		.time_us = 5000000 + (int64_t)number * 30270,
		.counter = 1000 + 4 * number,
		.known = true,
		.point = { x, y },
	};
	for (int i = 0; i < GZ_EYE_COUNT; i++) {
		gaze.eye[i].seen = true;
		gaze.eye[i].point[0] = x;
		gaze.eye[i].point[1] = y;
		gaze.eye[i].origin_mm[0] = i == GZ_EYE_LEFT ? -32 : 32;
		gaze.eye[i].origin_mm[1] = 150;
		gaze.eye[i].origin_mm[2] = 600;
		gaze.eye[i].target_mm[0] = (x - 0.5) * 500;
		gaze.eye[i].target_mm[1] = (1 - y) * 300;
		gaze.eye[i].pupil_mm = i == GZ_EYE_LEFT ? 3.25 : 3.5;
	}
	return gaze;
}

void tobii5_played_set_screen(struct tobii5_played *played)
{
	static const double screen_mm[3][3] = { { -250, 300, 0 }, { 250, 300, 0 }, { -250, 0, 0 } };
	memcpy(played->corner_mm, screen_mm, sizeof screen_mm);
}

/* The area of a request to set it: each corner is a tag and three numbers, 48 bytes. */
static void take_area(struct tobii5_played *played, const unsigned char *payload)
{
	for (int corner = 0; corner < 3; corner++) {
		for (int i = 0; i < 3; i++) {
			const unsigned char *body = payload + 2 + 48 * corner + 9 + 13 * i + 5;
			int64_t bits = (int64_t)((uint64_t)get_big(body) << 32 | get_big(body + 4));
			played->next_mm[corner][i] = ldexp((double)bits, -42);
		}
	}
	played->late_left = played->late_answers;
	played->area_sets++;
	if (!played->keeps_area && played->late_left == 0)
		memcpy(played->corner_mm, played->next_mm, sizeof played->corner_mm);
}

static size_t answer_area(struct tobii5_played *played, uint32_t number, unsigned char *reply)
{
	unsigned char payload[256] = { 0, 0 };
	unsigned char *end = payload + 2;
	played->area_requests++;
	for (int corner = 0; corner < 3; corner++)
		end = put_place(end, played->corner_mm[corner]);
	end = put_field(put_tag(end, 0x10100), 2, 4, 0x3039);
	if (played->late_left > 0 && --played->late_left == 0 && !played->keeps_area)
		memcpy(played->corner_mm, played->next_mm, sizeof played->corner_mm);
	return tobii5_made_frame(0x52, number, 0x596, payload, (size_t)(end - payload), reply);
}

size_t tobii5_played_answer(struct tobii5_played *played, const unsigned char *request, size_t size,
			    unsigned char *reply)
{
	static const unsigned char empty[2];
	if (played->is_mute || size < TOBII5_MADE_OVERHEAD || get_big(request + 8) != 0x51 ||
	    request[0] != 0 || get_big(request + 28) != size - TOBII5_MADE_OVERHEAD) {
		played->unknown += !played->is_mute;
		return 0;
	}
	uint32_t number = get_big(request + 12), operation = get_big(request + 20);
	switch (operation) {
	case 0x3e8:
		played->hellos++;
		return tobii5_made_frame(0x52, number, operation, empty, 2, reply);
	case 0x596:
		return played->hides_area ? 0 : answer_area(played, number, reply);
	case 0x5a0:
		take_area(played, request + TOBII5_MADE_OVERHEAD);
		return 0;
	case 0x4c4:
		played->subscriptions++;
		played->is_subscribed = true;
		return 0;
	default:
		played->unknown++;
		return 0;
	}
}
