#include "drivers/gazepoint/gazepoint_protocol.h"

#include <expat.h>
#include <math.h>
#include <stdalign.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/random.h>

#include "base/text.h"

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

/* Without a line end within the longest record, drop what has arrived and what follows up to the
 * next line end. */
static enum gz_result skip_long_record(struct gz_gazepoint_framer *framer)
{
	bool first = !framer->skipping;
	framer->skipping = true;
	framer->begin = framer->end;
	return first ? GZ_ERR_PROTOCOL : GZ_ERR_TIMEOUT;
}

static bool is_record_padding(char c)
{
	return c == '\0' || c == '\r' || c == ' ' || c == '\t';
}

/* Some servers also send the NUL of a C string. */
static void trim_record(const char **text, size_t *size)
{
	while (*size > 0 && is_record_padding(**text)) {
		(*text)++;
		(*size)--;
	}
	while (*size > 0 && is_record_padding((*text)[*size - 1]))
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
			return longest || framer->skipping ? skip_long_record(framer)
							   : GZ_ERR_TIMEOUT;
		framer->begin += size + 1;
		if (framer->skipping) {
			framer->skipping = false;
			continue;
		}
		if (longest)
			return GZ_ERR_PROTOCOL;
		trim_record(&text, &size);
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
	TEXT,  /* char[] of size bytes */
};

/* An attribute, where its value goes, and the flag that says that it was sent. */
struct record_field {
	const char *name;
	enum field_type type;
	size_t offset;
	size_t size;
	size_t seen; /* offset of a bool; 0, the offset of kind, if there is none */
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

static const struct record_field data_fields[] = {
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

static const struct record_field answer_fields[] = {
	{ "ID", TEXT, AT(id), GZ_GAZEPOINT_ID_SIZE, 0 },
	{ "VALUE", TEXT, AT(value), GZ_NAME_SIZE, 0 },
	{ "FREQ", WHOLE, AT(frequency), 0, 0 },
	{ "WIDTH", REAL, AT(width), 0, 0 },
	{ "HEIGHT", REAL, AT(height), 0, 0 },
	{ "RATE", REAL, AT(rate_hz), 0, 0 },
	{ NULL, REAL, 0, 0, 0 },
};

static const struct record_field screen_fields[] = {
	{ "WIDTH", REAL, AT(width), 0, 0 },
	{ "HEIGHT", REAL, AT(height), 0, 0 },
	{ NULL, REAL, 0, 0, 0 },
};

static const struct record_field no_fields[] = { { NULL, REAL, 0, 0, 0 } };

static struct gz_gazepoint_record unmeasured_record(void)
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

/* "nan", "-nan(ind)", "1.#QNAN", "-1.#IND", "inf": what printf() of several C libraries prints. */
static bool is_unmeasured_text(const char *text)
{
	if (*text == '-' || *text == '+')
		text++;
	return strncasecmp(text, "nan", 3) == 0 || strncasecmp(text, "inf", 3) == 0 ||
	       strncmp(text, "1.#", 3) == 0;
}

static bool read_real_field(const char *text, double *out_value)
{
	return gz_number_parse(text, out_value) || is_unmeasured_text(text);
}

static bool read_flag_field(const char *text, bool *out_flag)
{
	long long value;
	if (!gz_number_parse_whole(text, &value))
		return false;
	*out_flag = value != 0;
	return true;
}

/* Store a value. @return whether @p text is valid for the field */
static bool read_record_field(struct gz_gazepoint_record *record, const struct record_field *field,
			      const char *text)
{
	void *at = (char *)record + field->offset;
	bool good = true;
	switch (field->type) {
	case REAL:
		good = read_real_field(text, at);
		break;
	case WHOLE:
		good = gz_number_parse_whole(text, at);
		break;
	case FLAG:
		good = read_flag_field(text, at);
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

/* The record that an element is read into. */
struct record_reading {
	struct gz_gazepoint_record record;
	bool good;
};

static const struct record_field *fields_of_element(struct gz_gazepoint_record *record,
						    const char *name)
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

static void read_record_element(struct record_reading *reading, const char *name,
				const char *const *attributes)
{
	const struct record_field *fields = fields_of_element(&reading->record, name);
	for (; attributes[0]; attributes += 2) {
		const struct record_field *field = fields;
		while (field->name && strcmp(field->name, attributes[0]) != 0)
			field++;
		if (field->name && !read_record_field(&reading->record, field, attributes[1]))
			reading->good = false;
	}
	bool answer = fields == answer_fields;
	if (answer && reading->record.id[0] == '\0')
		reading->good = false;
}

struct gz_gazepoint_xml {
	size_t used;
	unsigned long salt; /* of the hash tables of Expat: nobody can choose names that collide */
	alignas(max_align_t) unsigned char bytes[GZ_GAZEPOINT_XML_ARENA];
};

/* Memory of the parse that is running. A thread variable, because the memory functions of Expat
 * take no user pointer. */
static _Thread_local struct gz_gazepoint_xml *parsing;

/* The size of each piece is stored in front of it, for realloc(). */
union head {
	size_t size;
	max_align_t align;
};

static void *arena_malloc(size_t size)
{
	struct gz_gazepoint_xml *xml = parsing;
	size_t room = sizeof xml->bytes - xml->used;
	if (size > sizeof xml->bytes || room < sizeof(union head))
		return NULL;
	size_t rounded = (size + alignof(max_align_t) - 1) & ~(alignof(max_align_t) - 1);
	if (rounded > room - sizeof(union head))
		return NULL;
	union head *head = (union head *)(void *)(xml->bytes + xml->used);
	head->size = size;
	xml->used += sizeof *head + rounded;
	return head + 1;
}

static void *arena_realloc(void *old, size_t size)
{
	if (!old)
		return arena_malloc(size);
	size_t old_size = ((union head *)old - 1)->size;
	if (size <= old_size)
		return old;
	void *grown = arena_malloc(size);
	if (grown)
		memcpy(grown, old, old_size);
	return grown;
}

/* Everything is freed at once, by the next parse. */
static void arena_free(void *old)
{
	(void)old;
}

struct element_visit {
	XML_Parser parser;
	struct record_reading *reading;
	int elements;
};

static void XMLCALL on_element_start(void *user, const XML_Char *name, const XML_Char **attributes)
{
	struct element_visit *visit = user;
	if (++visit->elements > 1)
		XML_StopParser(visit->parser, XML_FALSE);
	else
		read_record_element(visit->reading, name, (const char *const *)attributes);
}

static void XMLCALL on_document_type(void *user, const XML_Char *name, const XML_Char *system,
				     const XML_Char *public, int has_internal_subset)
{
	const struct element_visit *visit = user;
	(void)name;
	(void)system;
	(void)public;
	(void)has_internal_subset;
	XML_StopParser(visit->parser, XML_FALSE);
}

enum gz_result gz_gazepoint_xml_create(struct gz_gazepoint_xml **out_xml)
{
	struct gz_gazepoint_xml *xml = calloc(1, sizeof *xml);
	if (!xml)
		return GZ_ERR_NO_MEM;
	/* If no random number is available yet, leave the salt at 0: Expat then finds its own. */
	if (getrandom(&xml->salt, sizeof xml->salt, GRND_NONBLOCK) < 0)
		xml->salt = 0;
	*out_xml = xml;
	return GZ_OK;
}

/* Use a new parser for each record: a damaged record cannot harm the next one, and the memory is
 * bounded. This takes a few microseconds. */
static enum gz_result parse_element(struct gz_gazepoint_xml *xml, const char *text, size_t size,
				    struct element_visit *visit)
{
	static const XML_Memory_Handling_Suite memory = { arena_malloc, arena_realloc, arena_free };
	if (size > INT32_MAX)
		return GZ_ERR_PROTOCOL;
	xml->used = 0;
	visit->parser = XML_ParserCreate_MM("UTF-8", &memory, NULL);
	if (!visit->parser)
		return GZ_ERR_PROTOCOL;
	XML_SetHashSalt(visit->parser, xml->salt);
	XML_SetUserData(visit->parser, visit);
	XML_SetStartElementHandler(visit->parser, on_element_start);
	XML_SetStartDoctypeDeclHandler(visit->parser, on_document_type);
	enum XML_Status status = XML_Parse(visit->parser, text, (int)size, XML_TRUE);
	/* Accept an element that is not closed: the only error of Expat is then its missing end. */
	bool whole =
		status == XML_STATUS_OK || XML_GetErrorCode(visit->parser) == XML_ERROR_NO_ELEMENTS;
	XML_ParserFree(visit->parser);
	return whole && visit->elements == 1 ? GZ_OK : GZ_ERR_PROTOCOL;
}

void gz_gazepoint_xml_destroy(struct gz_gazepoint_xml **xml)
{
	if (!xml || !*xml)
		return;
	free(*xml);
	*xml = NULL;
}

enum gz_result gz_gazepoint_parse(struct gz_gazepoint_xml *xml, const char *record, size_t size,
				  struct gz_gazepoint_record *out_record,
				  enum gz_malformed *out_malformed)
{
	struct record_reading reading = { .record = unmeasured_record(), .good = true };
	struct element_visit visit = { .reading = &reading };
	parsing = xml;
	enum gz_result result = parse_element(xml, record, size, &visit);
	parsing = NULL;
	if (result != GZ_OK) {
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

static bool is_believable_frequency(double frequency_hz)
{
	return frequency_hz >= 1e3 && frequency_hz <= 9e9;
}

int64_t gz_gazepoint_frequency_hz(long long sent)
{
	double bits;
	memcpy(&bits, &sent, sizeof bits);
	if (is_believable_frequency((double)sent))
		return sent;
	return is_believable_frequency(bits) ? llround(bits) : 0;
}
