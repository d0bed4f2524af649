#include "render/mesh/ply_head.h"

#include <stdio.h>
#include <string.h>

#include "base/text.h"

#define GZ_LOG_MODULE "mesh"

/* Longest line of a header, bytes with its NUL, and words of it that count. Chosen: comments are
 * longer than anything else. */
enum { HEAD_LINE_SIZE = 1024, HEAD_WORDS = 6 };

const uint8_t gz_ply_type_sizes[GZ_PLY_TYPE_COUNT] = { 1, 1, 2, 2, 4, 4, 4, 8 };

/* A header while it is read. */
struct head_reader {
	const char *name;
	const struct gz_log *log;
	const char *at, *end;
	int line;
	char text[HEAD_LINE_SIZE];
	char *words[HEAD_WORDS]; /* of the present line */
	int word_count;
	struct gz_ply_head *head;
};

static enum gz_result refuse_head(const struct head_reader *reader, const char *what)
{
	gz_err(reader->log, "%s:%d: %s; write the mesh again as PLY", reader->name, reader->line,
	       what);
	return GZ_ERR_FORMAT;
}

/* Read the next line, with LF or CR LF at its end, and cut it into words. */
static enum gz_result next_head_line(struct head_reader *reader)
{
	const size_t rest = (size_t)(reader->end - reader->at);
	const char *newline = rest > 0 ? memchr(reader->at, '\n', rest) : NULL;
	reader->line++;
	if (!newline)
		return refuse_head(reader, "the header is cut off");
	size_t length = (size_t)(newline - reader->at);
	if (length >= sizeof reader->text)
		return refuse_head(reader, "a line of the header is too long");
	memcpy(reader->text, reader->at, length);
	reader->at = newline + 1;
	if (length > 0 && reader->text[length - 1] == '\r')
		length--;
	reader->text[length] = '\0';
	reader->word_count = 0;
	char *rest_of_line, *word = strtok_r(reader->text, " \t", &rest_of_line);
	for (; word && reader->word_count < HEAD_WORDS; word = strtok_r(NULL, " \t", &rest_of_line))
		reader->words[reader->word_count++] = word;
	return GZ_OK;
}

static bool first_word_is(const struct head_reader *reader, const char *word)
{
	return reader->word_count > 0 && strcmp(reader->words[0], word) == 0;
}

static enum gz_result read_format_line(struct head_reader *reader)
{
	static const char *const formats[] = { "ascii", "binary_little_endian",
					       "binary_big_endian" };
	if (reader->word_count != 3 || strcmp(reader->words[2], "1.0") != 0)
		return refuse_head(reader, "not a format of PLY 1.0");
	for (int i = 0; i < 3; i++)
		if (strcmp(reader->words[1], formats[i]) == 0) {
			reader->head->format = (enum gz_ply_format)i;
			return GZ_OK;
		}
	return refuse_head(reader, "not a format of PLY 1.0");
}

static const struct gz_ply_element *element_of(const struct gz_ply_head *head,
					       enum gz_ply_kind kind)
{
	for (size_t i = 0; i < head->element_count; i++)
		if (head->elements[i].kind == kind)
			return &head->elements[i];
	return NULL;
}

static enum gz_result read_element_line(struct head_reader *reader)
{
	struct gz_ply_head *head = reader->head;
	long long count;
	if (reader->word_count != 3 || !gz_number_parse_whole(reader->words[2], &count) ||
	    count < 0)
		return refuse_head(reader, "not an element with a name and a number of items");
	if (head->element_count == GZ_PLY_ELEMENTS_MAX)
		return refuse_head(reader, "more than 16 elements");
	const enum gz_ply_kind kind = strcmp(reader->words[1], "vertex") == 0 ? GZ_PLY_VERTEX
				      : strcmp(reader->words[1], "face") == 0 ? GZ_PLY_FACE
									      : GZ_PLY_OTHER;
	if (kind != GZ_PLY_OTHER && element_of(head, kind))
		return refuse_head(reader, "the element is there twice");
	if (kind == GZ_PLY_FACE && !element_of(head, GZ_PLY_VERTEX))
		return refuse_head(reader, "faces stand in front of the vertices");
	struct gz_ply_element *element = &head->elements[head->element_count++];
	*element = (struct gz_ply_element) { .kind = kind, .count = (uint64_t)count };
	return GZ_OK;
}

static bool find_ply_type(const char *word, enum gz_ply_type *out_type)
{
	/* Each type has a name of the first PLY and one with its bits. */
	static const char *const names[GZ_PLY_TYPE_COUNT][2] = {
		[GZ_PLY_INT8] = { "char", "int8" },
		[GZ_PLY_UINT8] = { "uchar", "uint8" },
		[GZ_PLY_INT16] = { "short", "int16" },
		[GZ_PLY_UINT16] = { "ushort", "uint16" },
		[GZ_PLY_INT32] = { "int", "int32" },
		[GZ_PLY_UINT32] = { "uint", "uint32" },
		[GZ_PLY_FLOAT32] = { "float", "float32" },
		[GZ_PLY_FLOAT64] = { "double", "float64" },
	};
	for (int i = 0; i < GZ_PLY_TYPE_COUNT; i++)
		if (strcmp(word, names[i][0]) == 0 || strcmp(word, names[i][1]) == 0) {
			*out_type = (enum gz_ply_type)i;
			return true;
		}
	return false;
}

static enum gz_ply_use use_of(enum gz_ply_kind kind, bool is_list, const char *name)
{
	static const char *const numbers[] = { "x", "y", "z", "nx", "ny", "nz" };
	if (kind == GZ_PLY_FACE && is_list &&
	    (strcmp(name, "vertex_indices") == 0 || strcmp(name, "vertex_index") == 0))
		return GZ_PLY_CORNERS;
	for (int i = 0; kind == GZ_PLY_VERTEX && !is_list && i < 6; i++)
		if (strcmp(name, numbers[i]) == 0)
			return (enum gz_ply_use)i;
	return GZ_PLY_UNUSED;
}

static bool has_use(const struct gz_ply_element *element, enum gz_ply_use use)
{
	for (size_t i = 0; i < element->property_count; i++)
		if (element->properties[i].use == use)
			return true;
	return false;
}

static enum gz_result read_property_line(struct head_reader *reader)
{
	struct gz_ply_head *head = reader->head;
	struct gz_ply_property property = { 0 };
	if (head->element_count == 0)
		return refuse_head(reader, "a property stands in front of all elements");
	struct gz_ply_element *element = &head->elements[head->element_count - 1];
	property.is_list = reader->word_count == 5 && strcmp(reader->words[1], "list") == 0;
	const int type = property.is_list ? 3 : 1;
	if (reader->word_count != type + 2 || !find_ply_type(reader->words[type], &property.type) ||
	    (property.is_list && (!find_ply_type(reader->words[2], &property.count_type) ||
				  property.count_type >= GZ_PLY_FLOAT32)))
		return refuse_head(reader, "not a property with a type and a name");
	if (element->property_count == GZ_PLY_PROPERTIES_MAX)
		return refuse_head(reader, "more than 64 properties");
	property.use = use_of(element->kind, property.is_list, reader->words[type + 1]);
	if (property.use != GZ_PLY_UNUSED && has_use(element, property.use))
		return refuse_head(reader, "the property is there twice");
	element->properties[element->property_count++] = property;
	return GZ_OK;
}

static enum gz_result check_head(const struct head_reader *reader)
{
	const struct gz_ply_element *vertices = element_of(reader->head, GZ_PLY_VERTEX);
	const struct gz_ply_element *faces = element_of(reader->head, GZ_PLY_FACE);
	if (!vertices || !has_use(vertices, GZ_PLY_X) || !has_use(vertices, GZ_PLY_Y) ||
	    !has_use(vertices, GZ_PLY_Z))
		return refuse_head(reader, "there are no vertices with x, y and z");
	if (faces && !has_use(faces, GZ_PLY_CORNERS))
		return refuse_head(reader, "faces have no list vertex_indices");
	for (size_t i = 0; i < reader->head->element_count; i++)
		if (reader->head->elements[i].property_count == 0 &&
		    reader->head->elements[i].count > 0)
			return refuse_head(reader, "an element has no properties");
	return GZ_OK;
}

static enum gz_result read_head_lines(struct head_reader *reader)
{
	bool has_format = false;
	for (;;) {
		enum gz_result result = next_head_line(reader);
		if (result != GZ_OK)
			return result;
		if (first_word_is(reader, "end_header"))
			return has_format ? check_head(reader)
					  : refuse_head(reader, "there is no format");
		if (first_word_is(reader, "format")) {
			has_format = true;
			result = read_format_line(reader);
		} else if (first_word_is(reader, "element")) {
			result = read_element_line(reader);
		} else if (first_word_is(reader, "property")) {
			result = read_property_line(reader);
		} else if (!first_word_is(reader, "comment") &&
			   !first_word_is(reader, "obj_info")) {
			result = refuse_head(reader, "not a line of a PLY header");
		}
		if (result != GZ_OK)
			return result;
	}
}

enum gz_result gz_ply_head_read(const char *name, const void *bytes, size_t size,
				const struct gz_log *log, struct gz_ply_head *out_head)
{
	*out_head = (struct gz_ply_head) { 0 };
	struct head_reader reader = {
		.name = name,
		.log = log,
		.at = bytes,
		.end = (const char *)bytes + size,
		.head = out_head,
	};
	enum gz_result result = next_head_line(&reader);
	if (result == GZ_OK && (reader.word_count != 1 || !first_word_is(&reader, "ply")))
		result = refuse_head(&reader, "does not begin with ply");
	if (result == GZ_OK)
		result = read_head_lines(&reader);
	out_head->size = (size_t)(reader.at - (const char *)bytes);
	return result;
}
