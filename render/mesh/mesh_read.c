#include "render/mesh/mesh_read.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/text.h"
#include "base/vector.h"
#include "render/mesh/mesh_file.h"
#include "render/mesh/mesh_parse.h"
#include "render/mesh/ply_head.h"

#define GZ_LOG_MODULE "mesh"

/* Longest number of a text, bytes with its NUL. Chosen: a double needs 24. */
enum { NUMBER_SIZE = 64 };

/* Longest header that is looked at before a file is read, bytes. Chosen: comments fit. */
enum { HEAD_MOST = 1 << 16 };

/* Numbers of a PLY file, in turn. */
struct ply_numbers {
	enum gz_ply_format format;
	const unsigned char *at, *end;
};

/* A PLY file while it is read. */
struct ply_reader {
	const char *name;
	const struct gz_log *log;
	struct ply_numbers numbers;
	struct gz_ply_head head;
	struct gz_mesh mesh;
	size_t triangles; /* so far */
};

static enum gz_result refuse_ply(const struct ply_reader *reader, const char *what, uint64_t item)
{
	gz_err(reader->log, "%s: %s %llu; write the mesh again as PLY", reader->name, what,
	       (unsigned long long)item);
	return GZ_ERR_FORMAT;
}

static bool is_blank(unsigned char c)
{
	return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

static bool next_text_number(struct ply_numbers *numbers, double *out_value)
{
	char word[NUMBER_SIZE];
	size_t length = 0;
	while (numbers->at < numbers->end && is_blank(*numbers->at))
		numbers->at++;
	while (numbers->at < numbers->end && !is_blank(*numbers->at)) {
		if (length + 1 == sizeof word)
			return false;
		word[length++] = (char)*numbers->at++;
	}
	word[length] = '\0';
	return gz_number_parse(word, out_value);
}

static double number_of_bits(enum gz_ply_type type, uint64_t bits)
{
	float single;
	double whole;
	const uint32_t low = (uint32_t)bits;
	switch (type) {
	case GZ_PLY_INT8:
		return (int8_t)bits;
	case GZ_PLY_UINT8:
		return (uint8_t)bits;
	case GZ_PLY_INT16:
		return (int16_t)bits;
	case GZ_PLY_UINT16:
		return (uint16_t)bits;
	case GZ_PLY_INT32:
		return (int32_t)bits;
	case GZ_PLY_UINT32:
		return low;
	case GZ_PLY_FLOAT32:
		memcpy(&single, &low, sizeof single);
		return (double)single;
	case GZ_PLY_FLOAT64:
	case GZ_PLY_TYPE_COUNT:
		break;
	}
	memcpy(&whole, &bits, sizeof whole);
	return whole;
}

/* The next number; false if there is none. A binary file may give NaN or an infinity. */
static bool next_number(struct ply_numbers *numbers, enum gz_ply_type type, double *out_value)
{
	const size_t size = gz_ply_type_sizes[type];
	uint64_t bits = 0;
	if (numbers->format == GZ_PLY_TEXT)
		return next_text_number(numbers, out_value);
	if ((size_t)(numbers->end - numbers->at) < size)
		return false;
	for (size_t i = 0; i < size; i++) {
		const size_t place = numbers->format == GZ_PLY_BIG_ENDIAN ? size - 1 - i : i;
		bits |= (uint64_t)numbers->at[i] << (8 * place);
	}
	numbers->at += size;
	*out_value = number_of_bits(type, bits);
	return true;
}

/* The number of a list's items. */
static bool next_list_count(struct ply_numbers *numbers, const struct gz_ply_property *property,
			    uint64_t *out_count)
{
	double count;
	if (!next_number(numbers, property->count_type, &count) || !(count >= 0) ||
	    count > UINT32_MAX || count != floor(count))
		return false;
	*out_count = (uint64_t)count;
	return true;
}

static bool skip_property(struct ply_numbers *numbers, const struct gz_ply_property *property)
{
	uint64_t count = 1;
	double value;
	if (property->is_list && !next_list_count(numbers, property, &count))
		return false;
	if (numbers->format != GZ_PLY_TEXT) {
		const uint64_t bytes = count * gz_ply_type_sizes[property->type];
		if (bytes > (uint64_t)(numbers->end - numbers->at))
			return false;
		numbers->at += bytes;
		return true;
	}
	for (; count > 0; count--)
		if (!next_number(numbers, property->type, &value))
			return false;
	return true;
}

static enum gz_result read_vertex(struct ply_reader *reader, const struct gz_ply_element *element,
				  size_t index)
{
	double values[GZ_PLY_NZ + 1] = { 0 };
	for (size_t i = 0; i < element->property_count; i++) {
		const struct gz_ply_property *property = &element->properties[i];
		const bool wanted = property->use != GZ_PLY_UNUSED;
		if (wanted ? !next_number(&reader->numbers, property->type, &values[property->use])
			   : !skip_property(&reader->numbers, property))
			return refuse_ply(reader, "cut off, or not a number, in vertex", index);
	}
	for (int axis = 0; axis < 3; axis++) {
		if (!(fabs(values[axis]) <= GZ_MESH_COORDINATE_MAX))
			return refuse_ply(reader, "coordinates beyond 1e18 in vertex", index);
		reader->mesh.positions[index][axis] = (float)values[axis];
	}
	if (!gz_normalise3(&values[GZ_PLY_NX])) /* filled in later */
		memset(&values[GZ_PLY_NX], 0, 3 * sizeof values[0]);
	for (int axis = 0; axis < 3; axis++)
		reader->mesh.normals[index][axis] = (float)values[GZ_PLY_NX + axis];
	return GZ_OK;
}

/* Read the corners of a face. With `store`, keep its triangles; otherwise only count them. */
static enum gz_result read_corners(struct ply_reader *reader,
				   const struct gz_ply_property *property, size_t face, bool store)
{
	uint64_t count;
	uint32_t first = 0, before = 0;
	if (!next_list_count(&reader->numbers, property, &count))
		return refuse_ply(reader, "cut off, or no number of corners, in face", face);
	for (uint64_t i = 0; i < count; i++) {
		double value;
		if (!next_number(&reader->numbers, property->type, &value))
			return refuse_ply(reader, "cut off, or not a number, in face", face);
		if (!(value >= 0 && value < (double)reader->mesh.vertex_count) ||
		    value != floor(value))
			return refuse_ply(reader, "a corner that is not a vertex in face", face);
		const uint32_t corner = (uint32_t)value;
		if (i >= 2) {
			const uint32_t triangle[3] = { first, before, corner };
			if (store)
				memcpy(reader->mesh.triangles[reader->triangles], triangle,
				       sizeof triangle);
			reader->triangles++;
		}
		first = i == 0 ? corner : first;
		before = corner;
	}
	return GZ_OK;
}

static enum gz_result read_face(struct ply_reader *reader, const struct gz_ply_element *element,
				size_t index, bool store)
{
	enum gz_result result = GZ_OK;
	for (size_t i = 0; i < element->property_count && result == GZ_OK; i++) {
		const struct gz_ply_property *property = &element->properties[i];
		if (property->use == GZ_PLY_CORNERS)
			result = read_corners(reader, property, index, store);
		else if (!skip_property(&reader->numbers, property))
			result = refuse_ply(reader, "cut off, or not a number, in face", index);
	}
	return result;
}

static enum gz_result read_all_faces(struct ply_reader *reader,
				     const struct gz_ply_element *element, bool store)
{
	enum gz_result result = GZ_OK;
	reader->triangles = 0;
	for (size_t i = 0; i < element->count && result == GZ_OK; i++)
		result = read_face(reader, element, i, store);
	return result;
}

/* The fewest bytes that an item takes. */
static uint64_t least_bytes(const struct ply_reader *reader, const struct gz_ply_element *element)
{
	uint64_t bytes = 0;
	for (size_t i = 0; i < element->property_count; i++) {
		const struct gz_ply_property *property = &element->properties[i];
		if (reader->head.format == GZ_PLY_TEXT)
			bytes += 1; /* a digit; the last one needs no blank */
		else
			bytes += gz_ply_type_sizes[property->is_list ? property->count_type
								     : property->type];
	}
	return bytes;
}

/* Refuse a number of items that the file has no room for, before memory is taken for them. */
static enum gz_result check_element_room(const struct ply_reader *reader,
					 const struct gz_ply_element *element)
{
	const uint64_t rest = (uint64_t)(reader->numbers.end - reader->numbers.at);
	if (element->count == 0 || rest / element->count >= least_bytes(reader, element))
		return GZ_OK;
	return refuse_ply(reader,
			  "too short for the items that its header claims:", element->count);
}

static enum gz_result read_vertices(struct ply_reader *reader, const struct gz_ply_element *element)
{
	enum gz_result result =
		gz_mesh_take(reader->name, element->count, 0, reader->log, &reader->mesh);
	for (size_t i = 0; i < element->count && result == GZ_OK; i++)
		result = read_vertex(reader, element, i);
	return result;
}

/* Count the triangles, make room for them beside the vertices, and read them. */
static enum gz_result read_faces(struct ply_reader *reader, const struct gz_ply_element *element)
{
	const struct ply_numbers start = reader->numbers;
	struct gz_mesh whole;
	enum gz_result result = read_all_faces(reader, element, false);
	if (result == GZ_OK)
		result = gz_mesh_take(reader->name, reader->mesh.vertex_count, reader->triangles,
				      reader->log, &whole);
	if (result != GZ_OK)
		return result;
	if (reader->mesh.vertex_count > 0) {
		const size_t bytes = reader->mesh.vertex_count * sizeof whole.positions[0];
		memcpy(whole.positions, reader->mesh.positions, bytes);
		memcpy(whole.normals, reader->mesh.normals, bytes);
	}
	gz_mesh_free(&reader->mesh);
	reader->mesh = whole;
	reader->numbers = start;
	return read_all_faces(reader, element, true);
}

static enum gz_result skip_elements(struct ply_reader *reader, const struct gz_ply_element *element)
{
	for (uint64_t i = 0; i < element->count; i++)
		for (size_t k = 0; k < element->property_count; k++)
			if (!skip_property(&reader->numbers, &element->properties[k]))
				return refuse_ply(reader, "cut off, or not a number, in item", i);
	return GZ_OK;
}

static enum gz_result read_elements(struct ply_reader *reader)
{
	enum gz_result result = GZ_OK;
	for (size_t i = 0; i < reader->head.element_count && result == GZ_OK; i++) {
		const struct gz_ply_element *element = &reader->head.elements[i];
		result = check_element_room(reader, element);
		if (result != GZ_OK)
			return result;
		result = element->kind == GZ_PLY_VERTEX ? read_vertices(reader, element)
			 : element->kind == GZ_PLY_FACE ? read_faces(reader, element)
							: skip_elements(reader, element);
	}
	return result == GZ_OK ? gz_mesh_fill_normals(reader->name, reader->log, &reader->mesh)
			       : result;
}

enum gz_result gz_mesh_parse_ply(const char *name, const void *bytes, size_t size,
				 const struct gz_log *log, struct gz_mesh *out_mesh)
{
	struct ply_reader *reader = calloc(1, sizeof *reader);
	if (!reader) {
		gz_err(log, "%s: no memory to read it", name);
		return GZ_ERR_NO_MEM;
	}
	reader->name = name;
	reader->log = log;
	enum gz_result result = gz_ply_head_read(name, bytes, size, log, &reader->head);
	if (result == GZ_OK) {
		reader->numbers = (struct ply_numbers) {
			.format = reader->head.format,
			.at = (const unsigned char *)bytes + reader->head.size,
			.end = (const unsigned char *)bytes + size,
		};
		result = read_elements(reader);
	}
	if (result == GZ_OK)
		*out_mesh = reader->mesh;
	else
		gz_mesh_free(&reader->mesh);
	free(reader);
	return result;
}

/* The formats, by the endings of names. */
static const struct {
	const char *ending;
	gz_mesh_parser *parse;
} mesh_formats[] = {
	{ ".ply", gz_mesh_parse_ply },
	{ ".obj", gz_mesh_parse_obj },
	{ ".stl", gz_mesh_parse_stl },
};

static gz_mesh_parser *mesh_parser_of(const char *path)
{
	for (size_t i = 0; i < sizeof mesh_formats / sizeof mesh_formats[0]; i++)
		if (gz_path_ends(path, mesh_formats[i].ending))
			return mesh_formats[i].parse;
	return NULL;
}

enum gz_result gz_mesh_read(const char *path, const struct gz_log *log, struct gz_mesh *out_mesh)
{
	gz_mesh_parser *parse = mesh_parser_of(path);
	struct gz_text text = { 0 };
	if (!parse) {
		gz_err(log, "%s: meshes are read from " GZ_MESH_ENDINGS " files; convert it", path);
		return GZ_ERR_UNSUPPORTED;
	}
	enum gz_result result = gz_text_add_file(&text, path);
	if (result != GZ_OK)
		gz_err(log, "%s: cannot be read: %s", path, gz_result_text(result));
	else
		result = parse(path, text.bytes ? text.bytes : "", text.length, log, out_mesh);
	gz_text_free(&text);
	return result;
}

/* Whether a file is a PLY whose header has faces. */
static bool ply_has_faces(const char *path)
{
	FILE *file = fopen(path, "rb");
	struct gz_ply_head *head = malloc(sizeof *head);
	char *bytes = malloc(HEAD_MOST);
	bool faces = false;
	if (file && head && bytes) {
		const size_t size = fread(bytes, 1, HEAD_MOST, file);
		const bool known = gz_ply_head_read(path, bytes, size, NULL, head) == GZ_OK;
		for (size_t i = 0; known && i < head->element_count; i++)
			faces = faces || (head->elements[i].kind == GZ_PLY_FACE &&
					  head->elements[i].count > 0);
	}
	if (file)
		fclose(file);
	free(head);
	free(bytes);
	return faces;
}

bool gz_mesh_has_faces(const char *path)
{
	gz_mesh_parser *parse = mesh_parser_of(path);
	return parse == gz_mesh_parse_ply ? ply_has_faces(path) : parse != NULL;
}

void gz_mesh_move(struct gz_mesh *mesh, const double origin[3])
{
	for (size_t v = 0; v < mesh->vertex_count; v++)
		for (int axis = 0; axis < 3; axis++)
			mesh->positions[v][axis] =
				(float)((double)mesh->positions[v][axis] - origin[axis]);
}

void gz_mesh_bound(const struct gz_mesh *mesh, double least[3], double greatest[3])
{
	for (size_t v = 0; v < mesh->vertex_count; v++)
		for (int axis = 0; axis < 3; axis++) {
			const double at = (double)mesh->positions[v][axis];
			least[axis] = fmin(least[axis], at);
			greatest[axis] = fmax(greatest[axis], at);
		}
}
