/* PLY: a text header of elements and their properties, then the elements as text or binary. The
 * points are the element "vertex"; elements before it are passed over, those behind it not read.
 * Turk, "The PLY Polygon File Format", 1994. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/data/ply_head.h"
#include "render/particles/particle_reader.h"

#define GZ_LOG_MODULE "particles"

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

/* A header, and what its properties are for. */
struct ply_points {
	struct gz_ply_head head;
	enum ply_role roles[GZ_PLY_PROPERTIES_MAX];
};

static bool recognise_ply(const char *path, const struct gz_file_start *start)
{
	(void)path;
	return gz_file_start_has(start, 0, "ply\n", 4) || gz_file_start_has(start, 0, "ply\r\n", 5);
}

static enum gz_result read_ply_lines(struct gz_particle_reader *reader, struct gz_ply_head *head)
{
	char line[GZ_PARTICLE_LINE_MAX];
	enum gz_result result = GZ_OK;
	for (bool end = false; !end && result == GZ_OK;) {
		result = gz_particle_take_line(reader, line);
		const char *fault =
			result == GZ_OK ? gz_ply_head_take_line(head, line, &end) : NULL;
		if (fault)
			return gz_particle_refuse(reader, "%s", fault);
	}
	return result == GZ_ERR_NOT_FOUND
		       ? gz_particle_refuse(reader, "truncated: its PLY header has no end")
		       : result;
}

static enum ply_role role_named(const char *name)
{
	int role = 0;
	while (role < ROLE_COUNT && strcmp(name, role_names[role]) != 0)
		role++;
	return (enum ply_role)role;
}

static bool has_vertices(const struct gz_ply_element *element)
{
	return strcmp(element->name, "vertex") == 0;
}

static enum gz_result read_ply_head(struct gz_particle_reader *reader, struct ply_points *points)
{
	static const enum gz_particle_coding codings[] = {
		[GZ_PLY_TEXT] = GZ_PARTICLE_TEXT,
		[GZ_PLY_LITTLE_ENDIAN] = GZ_PARTICLE_LITTLE_ENDIAN,
		[GZ_PLY_BIG_ENDIAN] = GZ_PARTICLE_BIG_ENDIAN,
	};
	const struct gz_ply_head *head = &points->head;
	const enum gz_result result = read_ply_lines(reader, &points->head);
	for (size_t i = 0; i < head->property_count; i++)
		points->roles[i] = ROLE_NONE;
	for (size_t i = 0; i < head->element_count; i++) {
		const struct gz_ply_element *element = &head->elements[i];
		for (size_t k = 0; has_vertices(element) && k < element->property_count; k++) {
			const size_t number = element->first_property + k;
			if (!head->properties[number].is_list)
				points->roles[number] = role_named(head->properties[number].name);
		}
	}
	reader->coding = codings[head->format];
	return result;
}

/* Pass over a list, or read one number. */
static enum gz_result read_property(struct gz_particle_reader *reader,
				    const struct gz_ply_property *property, double *out_number)
{
	double count = 0;
	if (!property->is_list)
		return gz_particle_read_numbers(reader, property->type, out_number, 1);
	const enum gz_result result =
		gz_particle_read_numbers(reader, property->count_type, &count, 1);
	if (result != GZ_OK)
		return result;
	if (!(count >= 0 && count <= UINT32_MAX && count == floor(count)))
		return gz_particle_refuse(reader, "a PLY list of %g items", count);
	return gz_particle_read_numbers(reader, property->type, NULL, (uint64_t)count);
}

static enum gz_result pass_element(struct gz_particle_reader *reader,
				   const struct gz_ply_head *head,
				   const struct gz_ply_element *element)
{
	const struct gz_ply_property *properties = &head->properties[element->first_property];
	enum gz_result result = GZ_OK;
	double number;
	if (element->property_count == 0)
		return GZ_OK;
	for (uint64_t i = 0; i < element->count && result == GZ_OK; i++)
		for (size_t k = 0; k < element->property_count && result == GZ_OK; k++)
			result = read_property(reader, &properties[k], &number);
	return result;
}

static double ply_value(const double roles[ROLE_COUNT], enum gz_particle_value value)
{
	if (value == GZ_PARTICLE_SPEED)
		return sqrt(roles[ROLE_VX] * roles[ROLE_VX] + roles[ROLE_VY] * roles[ROLE_VY] +
			    roles[ROLE_VZ] * roles[ROLE_VZ]);
	return value == GZ_PARTICLE_PRESSURE ? roles[ROLE_PRESSURE] : roles[ROLE_DENSITY];
}

static enum gz_result add_vertex(struct gz_particle_reader *reader, const struct ply_points *points,
				 const struct gz_ply_element *element)
{
	double roles[ROLE_COUNT + 1] = { 0 };
	for (size_t k = 0; k < element->property_count; k++) {
		const size_t number = element->first_property + k;
		const enum gz_result result = read_property(
			reader, &points->head.properties[number], &roles[points->roles[number]]);
		if (result != GZ_OK)
			return result;
	}
	return gz_particle_add(reader, roles, ply_value(roles, reader->request->value));
}

/* Which roles the vertices have, as bits. */
static unsigned roles_of(const struct ply_points *points, const struct gz_ply_element *element)
{
	unsigned there = 0;
	for (size_t k = 0; k < element->property_count; k++)
		there |= 1U << points->roles[element->first_property + k];
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

static enum gz_result read_vertices(struct gz_particle_reader *reader,
				    const struct ply_points *points,
				    const struct gz_ply_element *element)
{
	/* The last number of a text may have nothing behind it. */
	const uint64_t blank = reader->coding == GZ_PARTICLE_TEXT ? 1 : 0;
	const uint64_t bytes = gz_ply_item_bytes(&points->head, element);
	enum gz_result result = check_roles(reader, roles_of(points, element));
	if (result == GZ_OK)
		result = gz_particle_check_claim(reader, element->count, bytes - blank, "vertices");
	for (uint64_t i = 0; i < element->count && result == GZ_OK; i++)
		result = add_vertex(reader, points, element);
	return result;
}

static enum gz_result read_ply(struct gz_particle_reader *reader)
{
	struct ply_points *points = calloc(1, sizeof *points);
	enum gz_result result = points ? read_ply_head(reader, points) : GZ_ERR_NO_MEM;
	bool found = false;
	for (size_t i = 0; result == GZ_OK && i < points->head.element_count && !found; i++) {
		const struct gz_ply_element *element = &points->head.elements[i];
		found = has_vertices(element);
		result = found ? read_vertices(reader, points, element)
			       : pass_element(reader, &points->head, element);
	}
	if (result == GZ_OK && !found)
		result = gz_particle_refuse(reader, "a PLY without the element vertex");
	free(points);
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
