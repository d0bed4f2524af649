#include "drivers/gazepoint/gazepoint_protocol.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "base/number.h"

char *gz_gazepoint_framer_room(struct gz_gazepoint_framer *framer, size_t *out_size)
{
	size_t unread = framer->end - framer->begin;
	if (framer->begin > 0)
		memmove(framer->bytes, framer->bytes + framer->begin, unread);
	framer->begin = 0;
	framer->end = unread;
	*out_size = sizeof framer->bytes - unread;
	return framer->bytes + unread;
}

void gz_gazepoint_framer_add(struct gz_gazepoint_framer *framer, size_t size)
{
	framer->end += size;
}

/* No line end within the longest record: what is here is thrown away, and what follows up to the
 * next line end. */
static enum gz_result skip_long(struct gz_gazepoint_framer *framer)
{
	bool first = !framer->skipping;
	framer->skipping = true;
	framer->begin = framer->end;
	return first ? GZ_ERR_PROTOCOL : GZ_ERR_TIMEOUT;
}

static bool is_padding(char c)
{
	return c == '\0' || c == '\r' || c == ' ' || c == '\t';
}

/* Some servers count the NUL of a C string to what they send. */
static void trim(const char **text, size_t *size)
{
	while (*size > 0 && is_padding(**text)) {
		(*text)++;
		(*size)--;
	}
	while (*size > 0 && is_padding((*text)[*size - 1]))
		(*size)--;
}

enum gz_result gz_gazepoint_framer_next(struct gz_gazepoint_framer *framer, const char **out_record,
					size_t *out_size)
{
	for (;;) {
		const char *text = framer->bytes + framer->begin;
		size_t unread = framer->end - framer->begin;
		const char *newline = unread > 0 ? memchr(text, '\n', unread) : NULL;
		size_t size = newline ? (size_t)(newline - text) : unread;
		bool longest = size >= GZ_GAZEPOINT_RECORD_MAX;
		if (!newline)
			return longest || framer->skipping ? skip_long(framer) : GZ_ERR_TIMEOUT;
		framer->begin += size + 1;
		if (framer->skipping) {
			framer->skipping = false;
			continue;
		}
		if (longest)
			return GZ_ERR_PROTOCOL;
		trim(&text, &size);
		if (size == 0)
			continue;
		*out_record = text;
		*out_size = size;
		return GZ_OK;
	}
}

enum field_type {
	REAL,  /* double */
	WHOLE, /* long long */
	FLAG,  /* bool */
	TEXT,  /* char[], its size in size */
};

/* An attribute, where it goes, and what says that it came. */
struct field {
	const char *name;
	enum field_type type;
	size_t offset;
	size_t size;
	size_t seen; /* offset of a bool; 0, which is kind, if there is none */
};

#define AT(member) offsetof(struct gz_gazepoint_record, member)

#define EYE_FIELDS(letter, side)                                               \
	{ letter "POGX", REAL, AT(eye[side].point[0]), 0, AT(has_eye[side]) }, \
		{ letter "POGY", REAL, AT(eye[side].point[1]), 0, 0 },         \
		{ letter "POGV", FLAG, AT(eye[side].valid), 0, 0 },            \
		{ letter "EYEX", REAL, AT(eye[side].origin_m[0]), 0, 0 },      \
		{ letter "EYEY", REAL, AT(eye[side].origin_m[1]), 0, 0 },      \
		{ letter "EYEZ", REAL, AT(eye[side].origin_m[2]), 0, 0 },      \
		{ letter "PUPILD", REAL, AT(eye[side].pupil_m), 0, 0 },        \
		{ letter "PUPILV", FLAG, AT(eye[side].origin_valid), 0, 0 },   \
		{ letter "PMM", REAL, AT(eye[side].pupil_mm), 0, 0 },          \
	{                                                                      \
		letter "PMMV", FLAG, AT(eye[side].pupil_mm_valid), 0, 0        \
	}

static const struct field data_fields[] = {
	{ "CNT", WHOLE, AT(counter), 0, AT(has_counter) },
	{ "TIME", REAL, AT(time_s), 0, 0 },
	{ "TIME_TICK", WHOLE, AT(tick), 0, AT(has_tick) },
	{ "BPOGX", REAL, AT(best[0]), 0, AT(has_best) },
	{ "BPOGY", REAL, AT(best[1]), 0, 0 },
	{ "BPOGV", FLAG, AT(best_valid), 0, 0 },
	EYE_FIELDS("L", GZ_EYE_LEFT),
	EYE_FIELDS("R", GZ_EYE_RIGHT),
	{ NULL, REAL, 0, 0, 0 },
};

static const struct field answer_fields[] = {
	{ "ID", TEXT, AT(id), GZ_GAZEPOINT_ID_SIZE, 0 },
	{ "VALUE", TEXT, AT(value), GZ_NAME_SIZE, 0 },
	{ "FREQ", WHOLE, AT(frequency), 0, 0 },
	{ "WIDTH", REAL, AT(width), 0, 0 },
	{ "HEIGHT", REAL, AT(height), 0, 0 },
	{ "RATE", REAL, AT(rate_hz), 0, 0 },
	{ NULL, REAL, 0, 0, 0 },
};

static const struct field screen_fields[] = {
	{ "WIDTH", REAL, AT(width), 0, 0 },
	{ "HEIGHT", REAL, AT(height), 0, 0 },
	{ NULL, REAL, 0, 0, 0 },
};

static const struct field no_fields[] = { { NULL, REAL, 0, 0, 0 } };

static struct gz_gazepoint_record unmeasured(void)
{
	struct gz_gazepoint_record record = {
		.time_s = NAN,
		.best = { NAN, NAN },
		.width = NAN,
		.height = NAN,
		.rate_hz = NAN,
	};
	for (int eye = 0; eye < GZ_EYE_COUNT; eye++)
		record.eye[eye] = (struct gz_gazepoint_eye) {
			.point = { NAN, NAN },
			.origin_m = { NAN, NAN, NAN },
			.pupil_m = NAN,
			.pupil_mm = NAN,
		};
	return record;
}

/* "nan", "-nan(ind)", "1.#QNAN", "-1.#IND", "inf": printf() of several C libraries. */
static bool says_unmeasured(const char *text)
{
	if (*text == '-' || *text == '+')
		text++;
	return strncasecmp(text, "nan", 3) == 0 || strncasecmp(text, "inf", 3) == 0 ||
	       strncmp(text, "1.#", 3) == 0;
}

static bool take_real(const char *text, double *out_value)
{
	return gz_number_parse(text, out_value) || says_unmeasured(text);
}

static bool take_flag(const char *text, bool *out_flag)
{
	long long value;
	if (!gz_number_parse_whole(text, &value))
		return false;
	*out_flag = value != 0;
	return true;
}

/* @return whether @p text can be what the field holds */
static bool take_field(struct gz_gazepoint_record *record, const struct field *field,
		       const char *text)
{
	void *at = (char *)record + field->offset;
	bool good = true;
	switch (field->type) {
	case REAL:
		good = take_real(text, at);
		break;
	case WHOLE:
		good = gz_number_parse_whole(text, at);
		break;
	case FLAG:
		good = take_flag(text, at);
		break;
	case TEXT:
		if (strlen(text) < field->size)
			strcpy(at, text);
		break;
	}
	if (good && field->seen)
		*(bool *)((char *)record + field->seen) = true;
	return good;
}

/* What the element is to be read into. */
struct reading {
	struct gz_gazepoint_record record;
	bool good;
};

static const struct field *fields_of(struct gz_gazepoint_record *record, const char *name)
{
	if (strcmp(name, "REC") == 0) {
		record->kind = GZ_GAZEPOINT_DATA;
		return data_fields;
	}
	if (strcmp(name, "ACK") == 0 || strcmp(name, "NACK") == 0) {
		record->kind = name[0] == 'A' ? GZ_GAZEPOINT_ACK : GZ_GAZEPOINT_NACK;
		return answer_fields;
	}
	if (strcmp(name, "UPDATE") == 0) {
		record->kind = GZ_GAZEPOINT_UPDATE;
		return screen_fields;
	}
	record->kind = GZ_GAZEPOINT_OTHER;
	return no_fields;
}

static void take_element(void *user, const char *name, const char *const *attributes)
{
	struct reading *reading = user;
	const struct field *fields = fields_of(&reading->record, name);
	for (; attributes[0]; attributes += 2) {
		const struct field *field = fields;
		while (field->name && strcmp(field->name, attributes[0]) != 0)
			field++;
		if (field->name && !take_field(&reading->record, field, attributes[1]))
			reading->good = false;
	}
	bool answer = fields == answer_fields;
	if (answer && reading->record.id[0] == '\0')
		reading->good = false;
}

enum gz_result gz_gazepoint_parse(struct gz_gazepoint_xml *xml, const char *record, size_t size,
				  struct gz_gazepoint_record *out_record,
				  enum gz_malformed *out_malformed)
{
	struct reading reading = { .record = unmeasured(), .good = true };
	if (gz_gazepoint_xml_read(xml, record, size, take_element, &reading) != GZ_OK) {
		*out_malformed = GZ_MALFORMED_SYNTAX;
		return GZ_ERR_PROTOCOL;
	}
	if (!reading.good) {
		*out_malformed = GZ_MALFORMED_VALUE;
		return GZ_ERR_PROTOCOL;
	}
	*out_record = reading.record;
	return GZ_OK;
}

static bool believable(double frequency_hz)
{
	return frequency_hz >= 1e3 && frequency_hz <= 9e9;
}

int64_t gz_gazepoint_frequency_hz(long long sent)
{
	double bits;
	memcpy(&bits, &sent, sizeof bits);
	if (believable((double)sent))
		return sent;
	return believable(bits) ? llround(bits) : 0;
}
