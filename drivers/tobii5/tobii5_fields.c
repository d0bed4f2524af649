#include "drivers/tobii5/tobii5_fields.h"

#include <math.h>
#include <string.h>

#include "base/clock.h"
#include "drivers/device/big_endian.h"
#include "drivers/device/little_endian.h"
#include "drivers/tobii5/tobii5_frame.h"

enum field_type {
	TYPE_U32 = 2,
	TYPE_FIX16 = 3,
	TYPE_FIX42 = 4,
	TYPE_TAG = 5,
	TYPE_I64 = 6,
	TYPE_U64 = 7,
	TYPE_LIST = 23,
};

enum {
	PREFIX_SIZE = 2,
	FIELD_HEAD_SIZE = 5,
	TAG_ROW = 0x0bb8, /* the low half */
	TAG_COLUMN = 0x20bb9,
	TAG_POINT = 0x21f40,
	TAG_POINT_3D = 0x31f41,
	TAG_END_OF_AREA = 0x10100, /* a struct with one u32, whose meaning is not described */
	END_OF_AREA = 0x3039,
	MEMBERS_MAX = 0xfff,
	NUMBERS_MAX = 3,
};

static const double FIX16_ONE = 65536.0;
static const double FIX42_ONE = 4398046511104.0;

struct field_cursor {
	const unsigned char *bytes;
	size_t size;
};

struct field {
	uint8_t type;
	uint32_t size;
	const unsigned char *body;
};

/* A field with all its members. */
struct field_value {
	uint32_t shape;            /* its type, or its tag if it is a struct */
	const unsigned char *body; /* of the field itself */
	double numbers[NUMBERS_MAX];
	int count; /* of the numbers within it, which may be more */
};

static bool is_field_size_right(uint8_t type, uint32_t size)
{
	switch (type) {
	case TYPE_U32:
	case TYPE_FIX16:
	case TYPE_TAG:
		return size == 4;
	case TYPE_FIX42:
	case TYPE_I64:
	case TYPE_U64:
		return size == 8;
	default:
		return true;
	}
}

static enum gz_result read_field(struct field_cursor *cursor, struct field *out_field,
				 enum gz_malformed *out_malformed)
{
	*out_malformed = GZ_MALFORMED_SHORT;
	if (cursor->size < FIELD_HEAD_SIZE)
		return GZ_ERR_PROTOCOL;
	struct field field = { cursor->bytes[0], gz_read_u32be(cursor->bytes + 1),
			       cursor->bytes + FIELD_HEAD_SIZE };
	if (field.size > cursor->size - FIELD_HEAD_SIZE)
		return GZ_ERR_PROTOCOL;
	*out_malformed = GZ_MALFORMED_SYNTAX;
	if (!is_field_size_right(field.type, field.size))
		return GZ_ERR_PROTOCOL;
	cursor->bytes += FIELD_HEAD_SIZE + field.size;
	cursor->size -= FIELD_HEAD_SIZE + field.size;
	*out_field = field;
	return GZ_OK;
}

static uint32_t members_of_tag(uint32_t tag)
{
	return tag >> 16 & MEMBERS_MAX;
}

static void append_number(struct field_value *value, const struct field *field)
{
	double number;
	if (field->type == TYPE_U32)
		number = gz_read_u32be(field->body);
	else if (field->type == TYPE_FIX16)
		number = gz_read_i32be(field->body) / FIX16_ONE;
	else if (field->type == TYPE_FIX42)
		number = (double)gz_read_i64be(field->body) / FIX42_ONE;
	else
		return;
	if (value->count < NUMBERS_MAX)
		value->numbers[value->count] = number;
	value->count++;
}

/* Read a field and, if it begins a struct, all fields within it, however deep. */
static enum gz_result read_value(struct field_cursor *cursor, struct field_value *out_value,
				 enum gz_malformed *out_malformed)
{
	struct field_value value = { 0 };
	/* Each field has at least FIELD_HEAD_SIZE bytes, so this does not overflow. */
	for (uint64_t left = 1; left > 0; left--) {
		struct field field;
		enum gz_result result = read_field(cursor, &field, out_malformed);
		if (result != GZ_OK)
			return result;
		bool is_struct = field.type == TYPE_TAG;
		uint32_t tag = is_struct ? gz_read_u32be(field.body) : 0;
		if (!value.body) {
			value.body = field.body;
			value.shape = is_struct ? tag : field.type;
		}
		if (is_struct)
			left += members_of_tag(tag);
		else
			append_number(&value, &field);
	}
	*out_value = value;
	return GZ_OK;
}

static enum gz_result read_tag(struct field_cursor *cursor, uint32_t *out_tag,
			       enum gz_malformed *out_malformed)
{
	struct field field;
	enum gz_result result = read_field(cursor, &field, out_malformed);
	if (result != GZ_OK)
		return result;
	*out_malformed = GZ_MALFORMED_SYNTAX;
	if (field.type != TYPE_TAG)
		return GZ_ERR_PROTOCOL;
	*out_tag = gz_read_u32be(field.body);
	return GZ_OK;
}

static enum gz_result skip_prefix(struct field_cursor *cursor)
{
	if (cursor->size < PREFIX_SIZE)
		return GZ_ERR_PROTOCOL;
	cursor->bytes += PREFIX_SIZE;
	cursor->size -= PREFIX_SIZE;
	return GZ_OK;
}

/* Numbers of the columns that are read. */
enum column_number {
	COLUMN_TIME = 0x01,
	COLUMN_COUNTER = 0x14,
	COLUMN_POINT = 0x20,
	COLUMN_POINT_KNOWN = 0x21,
	COLUMN_COUNT = 0x2d, /* one above the last described */
};

/* Those of an eye. */
struct eye_columns {
	uint8_t origin, target, point, pupil, unseen, point_known;
};

static const struct eye_columns eye_columns[GZ_EYE_COUNT] = {
	[GZ_EYE_LEFT] = { 0x02, 0x04, 0x05, 0x06, 0x07, 0x1e },
	[GZ_EYE_RIGHT] = { 0x08, 0x0a, 0x0b, 0x0c, 0x0d, 0x1f },
};

/* The shape of each described column. Those without one have not been seen. */
static const uint32_t column_shapes[COLUMN_COUNT] = {
	[0x01] = TYPE_I64,     [0x02] = TAG_POINT_3D, [0x03] = TAG_POINT_3D, [0x04] = TAG_POINT_3D,
	[0x05] = TAG_POINT,    [0x06] = TYPE_FIX16,   [0x07] = TYPE_U32,     [0x08] = TAG_POINT_3D,
	[0x09] = TAG_POINT_3D, [0x0a] = TAG_POINT_3D, [0x0b] = TAG_POINT,    [0x0c] = TYPE_FIX16,
	[0x0d] = TYPE_U32,     [0x0e] = TYPE_U32,     [0x11] = TYPE_U32,     [0x14] = TYPE_U32,
	[0x15] = TYPE_U32,     [0x16] = TYPE_U32,     [0x17] = TAG_POINT_3D, [0x18] = TAG_POINT_3D,
	[0x19] = TAG_POINT,    [0x1a] = TAG_POINT,    [0x1b] = TYPE_U32,     [0x1c] = TAG_POINT,
	[0x1d] = TYPE_U32,     [0x1e] = TYPE_U32,     [0x1f] = TYPE_U32,     [0x20] = TAG_POINT,
	[0x21] = TYPE_U32,     [0x22] = TAG_POINT_3D, [0x23] = TYPE_U32,     [0x24] = TAG_POINT_3D,
	[0x25] = TAG_POINT_3D, [0x26] = TYPE_U32,     [0x27] = TAG_POINT_3D, [0x28] = TYPE_U32,
	[0x29] = TYPE_FIX16,   [0x2a] = TYPE_U32,     [0x2b] = TYPE_FIX16,   [0x2c] = TYPE_U32,
};

/* A row as it was sent. */
struct gaze_row {
	bool known[COLUMN_COUNT];
	double numbers[COLUMN_COUNT][NUMBERS_MAX];
	int64_t time_us;
	uint32_t strange;
};

static int numbers_of_shape(uint32_t shape)
{
	switch (shape) {
	case TAG_POINT:
		return 2;
	case TAG_POINT_3D:
		return 3;
	case TYPE_I64:
		return 0;
	default:
		return 1;
	}
}

static void put_column(struct gaze_row *row, uint32_t number, const struct field_value *value)
{
	bool is_described = number < COLUMN_COUNT && column_shapes[number] != 0 &&
			    value->shape == column_shapes[number] &&
			    value->count == numbers_of_shape(value->shape);
	if (!is_described) {
		row->strange = number ? number : UINT32_MAX;
		return;
	}
	row->known[number] = true;
	memcpy(row->numbers[number], value->numbers, sizeof value->numbers);
	if (number == COLUMN_TIME)
		row->time_us = gz_read_i64be(value->body);
}

static enum gz_result read_column(struct field_cursor *cursor, struct gaze_row *row,
				  enum gz_malformed *out_malformed)
{
	uint32_t tag;
	struct field_value number, value;
	enum gz_result result = read_tag(cursor, &tag, out_malformed);
	if (result == GZ_OK)
		result = read_value(cursor, &number, out_malformed);
	if (result != GZ_OK)
		return result;
	*out_malformed = GZ_MALFORMED_SYNTAX;
	if (tag != TAG_COLUMN || number.shape != TYPE_U32)
		return GZ_ERR_PROTOCOL;
	result = read_value(cursor, &value, out_malformed);
	if (result == GZ_OK)
		put_column(row, gz_read_u32be(number.body), &value);
	return result;
}

static enum gz_result read_row(struct field_cursor *cursor, struct gaze_row *row,
			       enum gz_malformed *out_malformed)
{
	uint32_t tag;
	*out_malformed = GZ_MALFORMED_SHORT;
	if (skip_prefix(cursor) != GZ_OK)
		return GZ_ERR_PROTOCOL;
	enum gz_result result = read_tag(cursor, &tag, out_malformed);
	if (result != GZ_OK)
		return result;
	*out_malformed = GZ_MALFORMED_SYNTAX;
	if ((tag & 0xffff) != TAG_ROW)
		return GZ_ERR_PROTOCOL;
	for (uint32_t i = 0; i < members_of_tag(tag) && result == GZ_OK; i++)
		result = read_column(cursor, row, out_malformed);
	return result;
}

/* Whether a column is known and not 0. */
static bool is_column_set(const struct gaze_row *row, int number)
{
	return row->known[number] && row->numbers[number][0] != 0;
}

/* Whether a column is known and 0. */
static bool is_column_clear(const struct gaze_row *row, int number)
{
	return row->known[number] && row->numbers[number][0] == 0;
}

static void copy_column_3d(const struct gaze_row *row, int number, float out_vector[3])
{
	for (int i = 0; i < 3; i++)
		out_vector[i] = (float)row->numbers[number][i];
}

static struct gz_point point_of_column(const struct gaze_row *row, int number)
{
	return (struct gz_point) { (float)row->numbers[number][0], (float)row->numbers[number][1] };
}

/* Unit vector from the eye to where it looks; stays NaN if both are the same place. */
static void aim_tobii5_eye(const struct gaze_row *row, const struct eye_columns *columns,
			   float out_direction[3])
{
	double step[3], square = 0;
	for (int i = 0; i < 3; i++) {
		step[i] = row->numbers[columns->target][i] - row->numbers[columns->origin][i];
		square += step[i] * step[i];
	}
	for (int i = 0; i < 3 && square > 0; i++)
		out_direction[i] = (float)(step[i] / sqrt(square));
}

/* Whether the tracker sees an eye: it says so, and the eye is in front of the tracker. The place of
 * an eye that is not seen is 0. A 4C does not say it as an Eye Tracker 5 does; there, a known point
 * says it. */
static bool is_tobii5_eye_seen(const struct gaze_row *row, const struct eye_columns *columns)
{
	bool is_stated = is_column_clear(row, columns->unseen) ||
			 (!row->known[columns->unseen] && is_column_set(row, columns->point_known));
	return is_stated && row->known[columns->origin] && row->numbers[columns->origin][2] > 0;
}

/* An eye that is not seen keeps nothing: its numbers are 0 and -1 then. */
static void fill_tobii5_eye(const struct gaze_row *row, const struct eye_columns *columns,
			    struct gz_eye_sample *eye)
{
	if (!is_tobii5_eye_seen(row, columns))
		return;
	if (row->known[columns->pupil] && row->numbers[columns->pupil][0] > 0)
		eye->pupil_mm = (float)row->numbers[columns->pupil][0];
	copy_column_3d(row, columns->origin, eye->origin_mm);
	if (!row->known[columns->point] || is_column_clear(row, columns->point_known))
		return;
	eye->point = point_of_column(row, columns->point);
	eye->valid = true;
	if (row->known[columns->target])
		aim_tobii5_eye(row, columns, eye->direction);
}

static void fill_tobii5_gaze(const struct gaze_row *row, struct gz_tobii5_gaze *gaze)
{
	struct gz_sample nothing = gz_sample_unmeasured();
	*gaze = (struct gz_tobii5_gaze) {
		.device_ns = row->time_us * GZ_NS_PER_US,
		.has_counter = row->known[COLUMN_COUNTER],
		.counter = (uint32_t)row->numbers[COLUMN_COUNTER][0],
		.point = nothing.point,
		.strange = row->strange,
	};
	memcpy(gaze->eye, nothing.eye, sizeof gaze->eye);
	for (int eye = 0; eye < GZ_EYE_COUNT; eye++)
		fill_tobii5_eye(row, &eye_columns[eye], &gaze->eye[eye]);
	if (row->known[COLUMN_POINT] && is_column_set(row, COLUMN_POINT_KNOWN)) {
		gaze->point = point_of_column(row, COLUMN_POINT);
		gaze->valid = true;
	}
}

enum gz_result gz_tobii5_parse_gaze(const unsigned char *bytes, size_t size,
				    struct gz_tobii5_gaze *out_gaze,
				    enum gz_malformed *out_malformed)
{
	struct field_cursor cursor = { bytes, size };
	struct gaze_row row = { 0 };
	enum gz_malformed reason;
	enum gz_result result = read_row(&cursor, &row, &reason);
	if (result != GZ_OK) {
		*out_malformed = reason;
		return result;
	}
	if (!row.known[COLUMN_TIME] || row.time_us > INT64_MAX / GZ_NS_PER_US ||
	    row.time_us <= INT64_MIN / GZ_NS_PER_US) {
		*out_malformed = GZ_MALFORMED_VALUE;
		return GZ_ERR_PROTOCOL;
	}
	fill_tobii5_gaze(&row, out_gaze);
	return GZ_OK;
}

enum gz_result gz_tobii5_parse_area(const unsigned char *bytes, size_t size,
				    struct gz_tobii5_area *out_area)
{
	struct field_cursor cursor = { bytes, size };
	struct gz_tobii5_area area;
	if (skip_prefix(&cursor) != GZ_OK)
		return GZ_ERR_PROTOCOL;
	for (int corner = 0; corner < GZ_TOBII5_CORNER_COUNT; corner++) {
		struct field_value value;
		enum gz_malformed ignored;
		if (read_value(&cursor, &value, &ignored) != GZ_OK || value.shape != TAG_POINT_3D ||
		    value.count != 3)
			return GZ_ERR_PROTOCOL;
		memcpy(area.corner_mm[corner], value.numbers, sizeof area.corner_mm[corner]);
	}
	*out_area = area;
	return GZ_OK;
}

struct gz_tobii5_area gz_tobii5_area_make(const struct gz_tobii5_screen_params *params)
{
	double tilt = params->tilt_deg * (M_PI / 180);
	double left_mm = params->offset_mm[0] - params->size_mm[0] / 2;
	double bottom_mm = params->offset_mm[1];
	double top_mm = bottom_mm + params->size_mm[1] * cos(tilt);
	double bottom_z_mm = params->offset_mm[2];
	double top_z_mm = bottom_z_mm - params->size_mm[1] * sin(tilt);
	return (struct gz_tobii5_area) {
		.corner_mm = {
			[GZ_TOBII5_TOP_LEFT] = { left_mm, top_mm, top_z_mm },
			[GZ_TOBII5_TOP_RIGHT] = { left_mm + params->size_mm[0], top_mm, top_z_mm },
			[GZ_TOBII5_BOTTOM_LEFT] = { left_mm, bottom_mm, bottom_z_mm },
		},
	};
}

static double distance_of_corners(const double a_mm[3], const double b_mm[3])
{
	double square = 0;
	for (int i = 0; i < 3; i++)
		square += (a_mm[i] - b_mm[i]) * (a_mm[i] - b_mm[i]);
	return sqrt(square);
}

void gz_tobii5_area_size(const struct gz_tobii5_area *area, double out_mm[2])
{
	const double *top_left_mm = area->corner_mm[GZ_TOBII5_TOP_LEFT];
	out_mm[0] = distance_of_corners(top_left_mm, area->corner_mm[GZ_TOBII5_TOP_RIGHT]);
	out_mm[1] = distance_of_corners(top_left_mm, area->corner_mm[GZ_TOBII5_BOTTOM_LEFT]);
}

bool gz_tobii5_area_is_screen(const struct gz_tobii5_area *area)
{
	double size_mm[2];
	gz_tobii5_area_size(area, size_mm);
	return size_mm[0] >= 50 && size_mm[0] <= 5000 && size_mm[1] >= 50 && size_mm[1] <= 5000;
}

bool gz_tobii5_area_is_near(const struct gz_tobii5_area *a, const struct gz_tobii5_area *b)
{
	for (int corner = 0; corner < GZ_TOBII5_CORNER_COUNT; corner++)
		if (distance_of_corners(a->corner_mm[corner], b->corner_mm[corner]) > 1)
			return false;
	return true;
}

static unsigned char *print_u32_field(unsigned char *at, uint8_t type, uint32_t value)
{
	at[0] = type;
	gz_write_u32be(at + 1, 4);
	gz_write_u32be(at + FIELD_HEAD_SIZE, value);
	return at + FIELD_HEAD_SIZE + 4;
}

static unsigned char *print_length_field(unsigned char *at, double length_mm)
{
	at[0] = TYPE_FIX42;
	gz_write_u32be(at + 1, 8);
	gz_write_i64be(at + FIELD_HEAD_SIZE, (int64_t)llrint(length_mm * FIX42_ONE));
	return at + FIELD_HEAD_SIZE + 8;
}

/* A list of @p count numbers: @p first, and each one more than the one before. */
static unsigned char *print_list_field(unsigned char *at, uint32_t count, uint32_t first)
{
	at[0] = TYPE_LIST;
	gz_write_u32be(at + 1, 4 + 4 * count);
	gz_write_u32be(at + FIELD_HEAD_SIZE, count);
	at += FIELD_HEAD_SIZE + 4;
	for (uint32_t i = 0; i < count; i++, at += 4)
		gz_write_u32be(at, first + i);
	return at;
}

static unsigned char *print_area_fields(unsigned char *at, const struct gz_tobii5_area *area)
{
	for (int corner = 0; corner < GZ_TOBII5_CORNER_COUNT; corner++) {
		at = print_u32_field(at, TYPE_TAG, TAG_POINT_3D);
		for (int i = 0; i < 3; i++)
			at = print_length_field(at, area->corner_mm[corner][i]);
	}
	at = print_u32_field(at, TYPE_TAG, TAG_END_OF_AREA);
	return print_u32_field(at, TYPE_U32, END_OF_AREA);
}

/* Write the payload. @return its end; @p at if there is none */
static unsigned char *print_tobii5_payload(enum gz_tobii5_request request,
					   const struct gz_tobii5_area *area, unsigned char *at)
{
	unsigned char *fields = at + PREFIX_SIZE;
	if (request == GZ_TOBII5_GET_AREA)
		return at;
	memset(at, 0, PREFIX_SIZE);
	switch (request) {
	case GZ_TOBII5_HELLO: /* versions: the major number in the upper half */
		return print_list_field(fields, 9, 0x10000);
	case GZ_TOBII5_SUBSCRIBE: /* the stream, and an empty list */
		return print_list_field(print_u32_field(fields, TYPE_U32, GZ_TOBII5_GAZE), 0, 0);
	default:
		return print_area_fields(fields, area);
	}
}

size_t gz_tobii5_print_request(enum gz_tobii5_request request, uint32_t number,
			       const struct gz_tobii5_area *area,
			       unsigned char bytes[GZ_TOBII5_REQUEST_MAX])
{
	static const uint32_t operations[] = {
		[GZ_TOBII5_HELLO] = 0x3e8,
		[GZ_TOBII5_GET_AREA] = 0x596,
		[GZ_TOBII5_SET_AREA] = 0x5a0,
		[GZ_TOBII5_SUBSCRIBE] = 0x4c4,
	};
	unsigned char *head = bytes + GZ_TOBII5_ENVELOPE_SIZE;
	unsigned char *payload = head + GZ_TOBII5_HEAD_SIZE;
	uint32_t payload_size = (uint32_t)(print_tobii5_payload(request, area, payload) - payload);
	memset(bytes, 0, GZ_TOBII5_ENVELOPE_SIZE + GZ_TOBII5_HEAD_SIZE);
	gz_write_u32le(bytes + 4, GZ_TOBII5_HEAD_SIZE + payload_size);
	gz_write_u32be(head, GZ_TOBII5_REQUEST);
	gz_write_u32be(head + 4, number);
	gz_write_u32be(head + 12, operations[request]);
	gz_write_u32be(head + 20, payload_size);
	return GZ_TOBII5_ENVELOPE_SIZE + GZ_TOBII5_HEAD_SIZE + payload_size;
}
