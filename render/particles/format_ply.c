/* PLY: a text header of elements and their properties, then the elements as text or binary. The
 * points are the element "vertex"; elements before it are passed over, those behind it not read.
 * Turk, "The PLY Polygon File Format", 1994. */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "render/particles/particle_reader.h"

#define GZ_LOG_MODULE "particles"

#define BLANKS " \t"

/* Chosen: more than scanners and simulations write. */
enum { ELEMENTS_MAX = 32, PROPERTIES_MAX = 256 };

/* What a property of a vertex is for. */
enum ply_role {
	ROLE_X,
	ROLE_Y,
	ROLE_Z,
	ROLE_DENSITY,
	ROLE_PRESSURE,
	ROLE_VX,
	ROLE_VY,
	ROLE_VZ,
	ROLE_COUNT,
	ROLE_NONE = ROLE_COUNT,
};

static const char *const role_names[ROLE_COUNT] = { "x",        "y",  "z",  "density",
						    "pressure", "vx", "vy", "vz" };

struct ply_property {
	bool list;
	enum gz_file_number count_type, type;
	enum ply_role role;
};

struct ply_element {
	bool vertices;
	uint64_t count;
	size_t first, properties;
};

struct ply_head {
	size_t element_count, property_count;
	struct ply_element elements[ELEMENTS_MAX];
	struct ply_property properties[PROPERTIES_MAX];
	bool coded; /* the line "format" was there */
};

static bool recognise_ply(const char *path, const struct gz_file_start *start)
{
	(void)path;
	return gz_file_start_has(start, 0, "ply\n", 4) || gz_file_start_has(start, 0, "ply\r\n", 5);
}

static bool ply_type(const char *word, enum gz_file_number *out_type)
{
	static const struct {
		const char *names[2];
		enum gz_file_number type;
	} types[] = {
		{ { "char", "int8" }, GZ_FILE_I8 },      { { "uchar", "uint8" }, GZ_FILE_U8 },
		{ { "short", "int16" }, GZ_FILE_I16 },   { { "ushort", "uint16" }, GZ_FILE_U16 },
		{ { "int", "int32" }, GZ_FILE_I32 },     { { "uint", "uint32" }, GZ_FILE_U32 },
		{ { "float", "float32" }, GZ_FILE_F32 }, { { "double", "float64" }, GZ_FILE_F64 },
	};
	for (size_t i = 0; i < sizeof types / sizeof types[0]; i++)
		for (int k = 0; k < 2; k++)
			if (strcmp(word, types[i].names[k]) == 0) {
				*out_type = types[i].type;
				return true;
			}
	return false;
}

static enum gz_result take_ply_format(struct gz_particle_reader *reader, struct ply_head *head,
				      char *rest)
{
	static const char *const names[] = { "ascii", "binary_little_endian", "binary_big_endian" };
	const char *word = gz_number_next_word(&rest, BLANKS);
	for (int i = 0; word && i < 3; i++)
		if (strcmp(word, names[i]) == 0) {
			reader->coding = (enum gz_particle_coding)i;
			head->coded = true;
			return GZ_OK;
		}
	return gz_particle_refuse(reader,
				  "format %.40s; ascii, binary_little_endian and "
				  "binary_big_endian are read",
				  word ? word : "is missing");
}

static enum gz_result take_element(struct gz_particle_reader *reader, struct ply_head *head,
				   char *rest)
{
	const char *name = gz_number_next_word(&rest, BLANKS);
	const char *count = name ? gz_number_next_word(&rest, BLANKS) : NULL;
	long long number = -1;
	if (!count || !gz_number_parse_whole(count, &number) || number < 0)
		return gz_particle_refuse(reader, "a PLY element without a number of items");
	if (head->element_count == ELEMENTS_MAX)
		return gz_particle_refuse(reader, "more than %d PLY elements are not read",
					  ELEMENTS_MAX);
	head->elements[head->element_count++] =
		(struct ply_element) { .vertices = strcmp(name, "vertex") == 0,
				       .count = (uint64_t)number,
				       .first = head->property_count };
	return GZ_OK;
}

static enum ply_role role_named(const char *name)
{
	int role = 0;
	while (role < ROLE_COUNT && strcmp(name, role_names[role]) != 0)
		role++;
	return (enum ply_role)role;
}

static enum gz_result take_property(struct gz_particle_reader *reader, struct ply_head *head,
				    char *rest)
{
	struct ply_property property = { .role = ROLE_NONE };
	const char *word = gz_number_next_word(&rest, BLANKS);
	property.list = word && strcmp(word, "list") == 0;
	bool known = word != NULL;
	if (property.list) {
		word = gz_number_next_word(&rest, BLANKS);
		known = word && ply_type(word, &property.count_type);
		word = gz_number_next_word(&rest, BLANKS);
	}
	known = known && word && ply_type(word, &property.type);
	const char *name = known ? gz_number_next_word(&rest, BLANKS) : NULL;
	if (!name || head->element_count == 0)
		return gz_particle_refuse(reader, "a PLY property without a known type and a name");
	if (head->property_count == PROPERTIES_MAX)
		return gz_particle_refuse(reader, "more than %d PLY properties are not read",
					  PROPERTIES_MAX);
	struct ply_element *element = &head->elements[head->element_count - 1];
	if (element->vertices && !property.list)
		property.role = role_named(name);
	head->properties[head->property_count++] = property;
	element->properties++;
	return GZ_OK;
}

static enum gz_result take_head_line(struct gz_particle_reader *reader, struct ply_head *head,
				     char *line, bool *out_end)
{
	char *rest = line;
	const char *word = gz_number_next_word(&rest, BLANKS);
	*out_end = word && strcmp(word, "end_header") == 0;
	if (!word || *out_end || strcmp(word, "comment") == 0 || strcmp(word, "obj_info") == 0)
		return GZ_OK;
	if (strcmp(word, "format") == 0)
		return take_ply_format(reader, head, rest);
	if (strcmp(word, "element") == 0)
		return take_element(reader, head, rest);
	if (strcmp(word, "property") == 0)
		return take_property(reader, head, rest);
	return gz_particle_refuse(reader, "%.40s is no line of a PLY header", word);
}

static enum gz_result read_ply_head(struct gz_particle_reader *reader, struct ply_head *head)
{
	char line[GZ_PARTICLE_LINE_MAX];
	bool end = false;
	enum gz_result result = gz_particle_take_line(reader, line);
	if (result == GZ_OK && strcmp(line, "ply") != 0)
		return gz_particle_refuse(reader, "does not begin as a PLY does");
	while (result == GZ_OK && !end) {
		result = gz_particle_take_line(reader, line);
		if (result == GZ_OK)
			result = take_head_line(reader, head, line, &end);
	}
	if (result == GZ_ERR_NOT_FOUND)
		return gz_particle_refuse(reader, "truncated: its PLY header has no end");
	if (result == GZ_OK && !head->coded)
		return gz_particle_refuse(reader, "its PLY header has no line format");
	return result;
}

/* Pass over a list, or read one number. */
static enum gz_result read_property(struct gz_particle_reader *reader,
				    const struct ply_property *property, double *out_number)
{
	double count = 0;
	if (!property->list)
		return gz_particle_read_numbers(reader, property->type, out_number, 1);
	const enum gz_result result =
		gz_particle_read_numbers(reader, property->count_type, &count, 1);
	if (result != GZ_OK)
		return result;
	if (!(count >= 0 && count <= UINT32_MAX && count == floor(count)))
		return gz_particle_refuse(reader, "a PLY list of %g items", count);
	return gz_particle_read_numbers(reader, property->type, NULL, (uint64_t)count);
}

static enum gz_result pass_element(struct gz_particle_reader *reader, const struct ply_head *head,
				   const struct ply_element *element)
{
	enum gz_result result = GZ_OK;
	double number;
	if (element->properties == 0)
		return GZ_OK;
	for (uint64_t i = 0; i < element->count && result == GZ_OK; i++)
		for (size_t k = 0; k < element->properties && result == GZ_OK; k++)
			result = read_property(reader, &head->properties[element->first + k],
					       &number);
	return result;
}

static double ply_value(const double roles[ROLE_COUNT], enum gz_particle_value value)
{
	if (value == GZ_PARTICLE_SPEED)
		return sqrt(roles[ROLE_VX] * roles[ROLE_VX] + roles[ROLE_VY] * roles[ROLE_VY] +
			    roles[ROLE_VZ] * roles[ROLE_VZ]);
	return value == GZ_PARTICLE_PRESSURE ? roles[ROLE_PRESSURE] : roles[ROLE_DENSITY];
}

static enum gz_result add_vertex(struct gz_particle_reader *reader, const struct ply_head *head,
				 const struct ply_element *element)
{
	double roles[ROLE_COUNT + 1] = { 0 };
	for (size_t k = 0; k < element->properties; k++) {
		const struct ply_property *property = &head->properties[element->first + k];
		const enum gz_result result =
			read_property(reader, property, &roles[property->role]);
		if (result != GZ_OK)
			return result;
	}
	return gz_particle_add(reader, roles, ply_value(roles, reader->request->value));
}

/* Which roles the vertices have, as bits, and the least bytes of a vertex. */
static unsigned roles_of(const struct gz_particle_reader *reader, const struct ply_head *head,
			 const struct ply_element *element, uint64_t *out_bytes)
{
	unsigned there = 0;
	uint64_t bytes = 0;
	for (size_t k = 0; k < element->properties; k++) {
		const struct ply_property *property = &head->properties[element->first + k];
		there |= 1U << property->role;
		bytes += reader->coding == GZ_PARTICLE_TEXT
				 ? 2
				 : gz_file_number_size(property->list ? property->count_type
								      : property->type);
	}
	/* The last number of a text may have nothing behind it. */
	*out_bytes = reader->coding == GZ_PARTICLE_TEXT && bytes > 0 ? bytes - 1 : bytes;
	return there;
}

static enum gz_result check_roles(const struct gz_particle_reader *reader, unsigned there)
{
	static const unsigned needs[GZ_PARTICLE_VALUE_COUNT] = {
		[GZ_PARTICLE_DENSITY] = 1U << ROLE_DENSITY,
		[GZ_PARTICLE_PRESSURE] = 1U << ROLE_PRESSURE,
		[GZ_PARTICLE_SPEED] = 1U << ROLE_VX | 1U << ROLE_VY | 1U << ROLE_VZ,
	};
	const unsigned position = 1U << ROLE_X | 1U << ROLE_Y | 1U << ROLE_Z;
	unsigned values = 0;
	if ((there & position) != position)
		return gz_particle_refuse(reader, "its vertices have no x, y and z");
	for (int i = 1; i < GZ_PARTICLE_VALUE_COUNT; i++)
		if ((there & needs[i]) == needs[i])
			values |= 1U << i;
	const enum gz_particle_value wanted = reader->request->value;
	return wanted == GZ_PARTICLE_FILL || values & 1U << wanted
		       ? GZ_OK
		       : gz_particle_refuse_value(reader, values);
}

static enum gz_result read_vertices(struct gz_particle_reader *reader, const struct ply_head *head,
				    const struct ply_element *element)
{
	uint64_t bytes = 0;
	const unsigned there = roles_of(reader, head, element, &bytes);
	enum gz_result result = check_roles(reader, there);
	if (result == GZ_OK)
		result = gz_particle_check_claim(reader, element->count, bytes, "vertices");
	for (uint64_t i = 0; i < element->count && result == GZ_OK; i++)
		result = add_vertex(reader, head, element);
	return result;
}

static enum gz_result read_ply(struct gz_particle_reader *reader)
{
	struct ply_head *head = calloc(1, sizeof *head);
	enum gz_result result = head ? read_ply_head(reader, head) : GZ_ERR_NO_MEM;
	bool found = false;
	for (size_t i = 0; result == GZ_OK && i < head->element_count && !found; i++) {
		found = head->elements[i].vertices;
		result = found ? read_vertices(reader, head, &head->elements[i])
			       : pass_element(reader, head, &head->elements[i]);
	}
	if (result == GZ_OK && !found)
		result = gz_particle_refuse(reader, "a PLY without the element vertex");
	free(head);
	return result;
}

static enum gz_result load_ply(const struct gz_particle_request *request,
			       struct gz_particles *out_particles)
{
	struct gz_particle_reader *reader = NULL;
	enum gz_result result = gz_particle_reader_open(request, &reader);
	if (result == GZ_OK)
		result = gz_particle_one_step(reader);
	if (result == GZ_OK)
		result = read_ply(reader);
	return gz_particle_reader_close(&reader, result, out_particles);
}

const struct gz_particle_format gz_particle_format_ply = {
	.name = "PLY",
	.endings = { ".ply", ".ply.gz" },
	.recognise = recognise_ply,
	.load = load_ply,
	.limits = "vertices as points, with density, pressure and vx vy vz; faces are not used",
};
