/* Houdini's .bgeo of version 5 ("classic"), as SPlisHSPlasH and other simulations write it with
 * Partio: "BgeoV" and nine big-endian numbers, the attributes of points, then for each point a
 * position of four numbers and its attributes. What follows the points is passed over. */
#include <inttypes.h>
#include <math.h>

#include "render/particles/particle_reader.h"

#define GZ_LOG_MODULE "particles"

#define BGEO_VERSION 5

/* Where the header has its numbers, bytes. */
enum { AT_VERSION = 5, AT_POINTS = 9, AT_POINT_ATTRIBUTES = 25, HEAD_BYTES = 41 };

/* Types of attributes. */
enum { TYPE_FLOAT = 0, TYPE_INT = 1, TYPE_INDEX = 4, TYPE_VECTOR = 5 };

enum { POSITION_WORDS = 4, WORD_BYTES = 4 };

/* What the header tells. */
struct bgeo_layout {
	uint64_t points, attributes;
	uint64_t words;    /* of a point */
	uint64_t value_at; /* the first word of the wanted value; 0: there is none */
	int value_words;
	unsigned there; /* bits of the values that the file has */
};

static bool recognise_bgeo(const char *path, const struct gz_file_start *start)
{
	(void)path;
	return gz_file_start_has(start, 0, "BgeoV", 5) ||
	       gz_file_start_has(start, 0, "\177NSJb", 5);
}

static uint64_t big_number(const uint8_t *bytes, enum gz_file_number type)
{
	const double number = gz_file_number_at(bytes, type, true);
	return number > 0 ? (uint64_t)number : 0;
}

static enum gz_result read_bgeo_head(struct gz_particle_reader *reader, struct bgeo_layout *layout)
{
	uint8_t bytes[HEAD_BYTES];
	enum gz_result result = gz_particle_take(reader, bytes, sizeof bytes);
	if (result != GZ_OK)
		return result;
	if (bytes[0] == 0x7f) {
		gz_err(reader->request->log,
		       "%s: a .bgeo of Houdini 12 or later; save it as .bgeo classic "
		       "(.bhclassic), or as .ply",
		       reader->request->path);
		return GZ_ERR_UNSUPPORTED;
	}
	if (bytes[0] != 'B' || bytes[4] != 'V')
		return gz_particle_refuse(reader, "does not begin as a .bgeo does");
	const uint64_t version = big_number(bytes + AT_VERSION, GZ_FILE_I32);
	if (version != BGEO_VERSION) {
		gz_err(reader->request->log, "%s: .bgeo of version %" PRIu64 "; 5 is read",
		       reader->request->path, version);
		return GZ_ERR_UNSUPPORTED;
	}
	layout->points = big_number(bytes + AT_POINTS, GZ_FILE_I32);
	layout->attributes = big_number(bytes + AT_POINT_ATTRIBUTES, GZ_FILE_I32);
	layout->words = POSITION_WORDS;
	return gz_particle_check_claim(reader, layout->points, POSITION_WORDS * WORD_BYTES,
				       "points");
}

/* The names that numbers of an attribute stand for. */
static enum gz_result pass_names(struct gz_particle_reader *reader)
{
	uint8_t bytes[4];
	enum gz_result result = gz_particle_take(reader, bytes, 4);
	const uint64_t count = result == GZ_OK ? big_number(bytes, GZ_FILE_I32) : 0;
	for (uint64_t i = 0; i < count && result == GZ_OK; i++) {
		result = gz_particle_take(reader, bytes, 2);
		if (result == GZ_OK)
			result = gz_particle_take(reader, NULL, big_number(bytes, GZ_FILE_U16));
	}
	return result;
}

static void note_attribute(struct bgeo_layout *layout, const char *name, uint64_t size, bool real,
			   enum gz_particle_value wanted)
{
	const enum gz_particle_value value = gz_particle_value_named(name);
	const uint64_t needs = value == GZ_PARTICLE_SPEED ? 3 : 1;
	if (!real || value == GZ_PARTICLE_FILL || size != needs)
		return;
	layout->there |= 1U << value;
	if (value == wanted) {
		layout->value_at = layout->words;
		layout->value_words = (int)needs;
	}
}

static enum gz_result read_attribute(struct gz_particle_reader *reader, struct bgeo_layout *layout)
{
	uint8_t bytes[6];
	char name[32] = "";
	enum gz_result result = gz_particle_take(reader, bytes, 2);
	if (result != GZ_OK)
		return result;
	const uint64_t length = big_number(bytes, GZ_FILE_U16);
	const uint64_t kept = length < sizeof name ? length : 0; /* longer ones mean nothing here */
	result = gz_particle_take(reader, name, kept);
	if (result == GZ_OK)
		result = gz_particle_take(reader, NULL, length - kept);
	if (result == GZ_OK)
		result = gz_particle_take(reader, bytes, 6);
	if (result != GZ_OK)
		return result;
	const uint64_t size = big_number(bytes, GZ_FILE_U16);
	const int type = (int)gz_file_number_at(bytes + 2, GZ_FILE_I32, true);
	if (type == TYPE_INDEX)
		result = pass_names(reader);
	else if (type == TYPE_FLOAT || type == TYPE_INT || type == TYPE_VECTOR)
		result = gz_particle_take(reader, NULL, size * WORD_BYTES);
	else
		return gz_particle_refuse(
			reader, "attribute %s has type %d; 0, 1, 4 and 5 are read", name, type);
	note_attribute(layout, name, size, type == TYPE_FLOAT || type == TYPE_VECTOR,
		       reader->request->value);
	layout->words += size;
	return result;
}

/* One point: its position, and the wanted value somewhere behind it. */
static enum gz_result add_point(struct gz_particle_reader *reader, const struct bgeo_layout *layout)
{
	double position[POSITION_WORDS], value[3] = { 0 };
	uint64_t used = POSITION_WORDS;
	enum gz_result result =
		gz_particle_read_numbers(reader, GZ_FILE_F32, position, POSITION_WORDS);
	if (result == GZ_OK && layout->value_words > 0) {
		result = gz_particle_take(reader, NULL, (layout->value_at - used) * WORD_BYTES);
		if (result == GZ_OK)
			result = gz_particle_read_numbers(reader, GZ_FILE_F32, value,
							  (uint64_t)layout->value_words);
		used = layout->value_at + (uint64_t)layout->value_words;
	}
	if (result == GZ_OK)
		result = gz_particle_take(reader, NULL, (layout->words - used) * WORD_BYTES);
	if (result != GZ_OK)
		return result;
	return gz_particle_add(
		reader, position,
		layout->value_words == 3
			? sqrt(value[0] * value[0] + value[1] * value[1] + value[2] * value[2])
			: value[0]);
}

static enum gz_result read_bgeo(struct gz_particle_reader *reader)
{
	struct bgeo_layout layout = { 0 };
	enum gz_result result = read_bgeo_head(reader, &layout);
	for (uint64_t i = 0; i < layout.attributes && result == GZ_OK; i++)
		result = read_attribute(reader, &layout);
	if (result == GZ_OK && reader->request->value != GZ_PARTICLE_FILL &&
	    layout.value_words == 0)
		return gz_particle_refuse_value(reader, layout.there);
	if (result == GZ_OK)
		result = gz_particle_check_claim(reader, layout.points, layout.words * WORD_BYTES,
						 "points");
	for (uint64_t i = 0; i < layout.points && result == GZ_OK; i++)
		result = add_point(reader, &layout);
	return result;
}

static enum gz_result load_bgeo(const struct gz_particle_request *request,
				struct gz_particles *out_particles)
{
	struct gz_particle_reader *reader = NULL;
	enum gz_result result = gz_particle_reader_open(request, &reader);
	if (result == GZ_OK) {
		reader->coding = GZ_PARTICLE_BIG_ENDIAN;
		result = gz_particle_one_step(reader);
	}
	if (result == GZ_OK)
		result = read_bgeo(reader);
	return gz_particle_reader_close(&reader, result, out_particles);
}

const struct gz_particle_format gz_particle_format_bgeo = {
	.name = "Houdini bgeo, classic",
	.endings = { ".bgeo", ".bgeo.gz", ".bhclassic" },
	.recognise = recognise_bgeo,
	.load = load_bgeo,
	.limits = "version 5: points, density, pressure and velocity; not the JSON of Houdini 12",
};
