/* Meshes of PLY files. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "base/vector.h"
#include "render/data/ply_head.h"
#include "render/mesh/mesh_parse.h"
#include "render/mesh/mesh_read.h"

#define GZ_LOG_MODULE "mesh"

/* Longest number of a text, bytes with its NUL. Chosen: a double needs 24. */
enum { NUMBER_SIZE = 64 };

/* Longest line of a header, bytes with its NUL. Chosen: comments are longer than anything else. */
enum { HEAD_LINE_SIZE = 1024 };

/* Longest header that is looked at before a file is read, bytes. Chosen: comments fit. */
enum { HEAD_MOST = 1 << 16 };

/* What a property is used for. */
enum ply_use {
	USE_X,
	USE_Y,
	USE_Z,
	USE_NX,
	USE_NY,
	USE_NZ,
	USE_CORNERS, /* the list of a face's vertices */
	USE_NONE,
	USE_COUNT,
};

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
	const struct gz_ply_element *vertices, *faces; /* NULL: the file has none */
	enum ply_use uses[GZ_PLY_PROPERTIES_MAX];
	struct gz_mesh mesh;
	size_t triangles; /* so far */
};

static enum gz_result refuse_ply(const struct ply_reader *reader, const char *what, uint64_t item)
{
	gz_err(reader->log, "%s: %s %llu; write the mesh again as PLY", reader->name, what,
	       (unsigned long long)item);
	return GZ_ERR_FORMAT;
}

static enum gz_result refuse_head(const struct ply_reader *reader, const char *what)
{
	gz_err(reader->log, "%s:%zu: %s; write the mesh again as PLY", reader->name,
	       reader->head.lines, what);
	return GZ_ERR_FORMAT;
}

/* Take the lines of the header, with LF or CR LF at their ends. */
static enum gz_result read_head_lines(struct ply_reader *reader)
{
	struct ply_numbers *numbers = &reader->numbers;
	char line[HEAD_LINE_SIZE];
	for (bool end = false; !end;) {
		const size_t rest = (size_t)(numbers->end - numbers->at);
		const unsigned char *newline = rest > 0 ? memchr(numbers->at, '\n', rest) : NULL;
		const size_t length = newline ? (size_t)(newline - numbers->at) : 0;
		const char *fault = !newline                ? "the header is cut off"
				    : length >= sizeof line ? "a line of the header is too long"
							    : NULL;
		if (fault) {
			reader->head.lines++;
			return refuse_head(reader, fault);
		}
		memcpy(line, numbers->at, length);
		line[length] = '\0';
		numbers->at = newline + 1;
		fault = gz_ply_head_take_line(&reader->head, line, &end);
		if (fault)
			return refuse_head(reader, fault);
	}
	numbers->format = reader->head.format;
	return GZ_OK;
}

static enum ply_use use_of(const struct ply_reader *reader, const struct gz_ply_element *element,
			   const struct gz_ply_property *property)
{
	static const char *const numbers[] = { "x", "y", "z", "nx", "ny", "nz" };
	const char *name = property->name;
	if (element == reader->faces && property->is_list &&
	    (strcmp(name, "vertex_indices") == 0 || strcmp(name, "vertex_index") == 0))
		return USE_CORNERS;
	for (int i = 0; element == reader->vertices && !property->is_list && i < USE_CORNERS; i++)
		if (strcmp(name, numbers[i]) == 0)
			return (enum ply_use)i;
	return USE_NONE;
}

/* Find out what the element's properties are used for, as bits. */
static enum gz_result note_uses(struct ply_reader *reader, const struct gz_ply_element *element,
				unsigned *out_uses)
{
	*out_uses = 0;
	for (size_t i = 0; i < element->property_count; i++) {
		const size_t number = element->first_property + i;
		const enum ply_use use = use_of(reader, element, &reader->head.properties[number]);
		if (use != USE_NONE && *out_uses & 1U << use)
			return refuse_head(reader, "a property is there twice");
		*out_uses |= 1U << use;
		reader->uses[number] = use;
	}
	return element->property_count > 0 || element->count == 0
		       ? GZ_OK
		       : refuse_head(reader, "an element has no properties");
}

static enum gz_result note_element(struct ply_reader *reader, const struct gz_ply_element *element)
{
	const bool vertices = strcmp(element->name, "vertex") == 0;
	const bool faces = strcmp(element->name, "face") == 0;
	if ((vertices && reader->vertices) || (faces && reader->faces))
		return refuse_head(reader, "an element is there twice");
	if (faces && !reader->vertices)
		return refuse_head(reader, "faces come before the vertices");
	reader->vertices = vertices ? element : reader->vertices;
	reader->faces = faces ? element : reader->faces;
	return GZ_OK;
}

/* There is one element of vertices with x, y and z, and at most one of faces, after it, with a list
 * of corners. */
static enum gz_result check_head(struct ply_reader *reader)
{
	const struct gz_ply_head *head = &reader->head;
	const unsigned place = 1U << USE_X | 1U << USE_Y | 1U << USE_Z;
	unsigned of_vertices = 0, of_faces = 1U << USE_CORNERS, uses = 0;
	enum gz_result result = GZ_OK;
	for (size_t i = 0; i < head->element_count && result == GZ_OK; i++) {
		const struct gz_ply_element *element = &head->elements[i];
		result = note_element(reader, element);
		if (result == GZ_OK)
			result = note_uses(reader, element, &uses);
		of_vertices = element == reader->vertices ? uses : of_vertices;
		of_faces = element == reader->faces ? uses : of_faces;
	}
	if (result == GZ_OK && (of_vertices & place) != place)
		return refuse_head(reader, "there are no vertices with x, y and z");
	if (result == GZ_OK && !(of_faces & 1U << USE_CORNERS))
		return refuse_head(reader, "faces have no list vertex_indices");
	return result;
}

static enum gz_result read_head(struct ply_reader *reader)
{
	const enum gz_result result = read_head_lines(reader);
	return result == GZ_OK ? check_head(reader) : result;
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

/* The next number; false if there is none. A binary file may give NaN or an infinity. */
static bool next_number(struct ply_numbers *numbers, enum gz_file_number type, double *out_value)
{
	const size_t size = gz_file_number_size(type);
	if (numbers->format == GZ_PLY_TEXT)
		return next_text_number(numbers, out_value);
	if ((size_t)(numbers->end - numbers->at) < size)
		return false;
	*out_value = gz_file_number_at(numbers->at, type, numbers->format == GZ_PLY_BIG_ENDIAN);
	numbers->at += size;
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
		const uint64_t bytes = count * gz_file_number_size(property->type);
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
	double values[USE_COUNT] = { 0 };
	for (size_t i = 0; i < element->property_count; i++) {
		const size_t number = element->first_property + i;
		const struct gz_ply_property *property = &reader->head.properties[number];
		double *value = &values[reader->uses[number]];
		if (property->is_list ? !skip_property(&reader->numbers, property)
				      : !next_number(&reader->numbers, property->type, value))
			return refuse_ply(reader, "cut off, or not a number, in vertex", index);
	}
	for (int axis = 0; axis < 3; axis++) {
		if (!(fabs(values[axis]) <= GZ_MESH_COORDINATE_MAX))
			return refuse_ply(reader, "coordinates beyond 1e18 in vertex", index);
		reader->mesh.positions[index][axis] = (float)values[axis];
	}
	if (!gz_normalise3(&values[USE_NX])) /* filled in later */
		memset(&values[USE_NX], 0, 3 * sizeof values[0]);
	for (int axis = 0; axis < 3; axis++)
		reader->mesh.normals[index][axis] = (float)values[USE_NX + axis];
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
		const size_t number = element->first_property + i;
		const struct gz_ply_property *property = &reader->head.properties[number];
		if (reader->uses[number] == USE_CORNERS)
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

/* Refuse a number of items that the file has no room for, before memory is taken for them. */
static enum gz_result check_element_room(const struct ply_reader *reader,
					 const struct gz_ply_element *element)
{
	const uint64_t rest = (uint64_t)(reader->numbers.end - reader->numbers.at);
	const uint64_t blank = reader->head.format == GZ_PLY_TEXT ? 1 : 0;
	const uint64_t least = gz_ply_item_bytes(&reader->head, element);
	if (element->count == 0 || (rest + blank) / element->count >= least)
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
			if (!skip_property(&reader->numbers,
					   &reader->head.properties[element->first_property + k]))
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
		result = element == reader->vertices ? read_vertices(reader, element)
			 : element == reader->faces  ? read_faces(reader, element)
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
	reader->numbers.at = bytes;
	reader->numbers.end = (const unsigned char *)bytes + size;
	enum gz_result result = read_head(reader);
	if (result == GZ_OK)
		result = read_elements(reader);
	if (result == GZ_OK)
		*out_mesh = reader->mesh;
	else
		gz_mesh_free(&reader->mesh);
	free(reader);
	return result;
}

bool gz_mesh_ply_has_faces(const char *path)
{
	FILE *file = fopen(path, "rb");
	struct ply_reader *reader = calloc(1, sizeof *reader);
	unsigned char *bytes = malloc(HEAD_MOST);
	bool faces = false;
	if (file && reader && bytes) {
		reader->numbers.at = bytes;
		reader->numbers.end = bytes + fread(bytes, 1, HEAD_MOST, file);
		faces = read_head(reader) == GZ_OK && reader->faces && reader->faces->count > 0;
	}
	if (file)
		fclose(file);
	free(reader);
	free(bytes);
	return faces;
}
