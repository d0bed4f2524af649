#include "render/data/ply_head.h"

#include <string.h>

#include "base/text.h"

/* Words of a line that count: "property list uchar int vertex_indices". One more shows that a line
 * has too many. */
enum { LINE_WORDS = 6 };

/* A line in words. */
struct ply_line {
	const char *words[LINE_WORDS];
	int count;
};

static struct ply_line cut_line(char *text)
{
	struct ply_line line = { .count = 0 };
	const char *word = gz_number_next_word(&text, " \t\r");
	for (; word && line.count < LINE_WORDS; word = gz_number_next_word(&text, " \t\r"))
		line.words[line.count++] = word;
	return line;
}

static void take_ply_name(const char *name, char out[GZ_PLY_NAME_SIZE])
{
	const size_t length = strlen(name);
	const size_t kept = length < GZ_PLY_NAME_SIZE ? length : GZ_PLY_NAME_SIZE - 1;
	memcpy(out, name, kept);
	out[kept] = '\0';
}

static const char *take_format_line(struct gz_ply_head *head, const struct ply_line *line)
{
	static const char *const formats[] = { "ascii", "binary_little_endian",
					       "binary_big_endian" };
	for (int i = 0; line->count == 3 && strcmp(line->words[2], "1.0") == 0 && i < 3; i++)
		if (strcmp(line->words[1], formats[i]) == 0) {
			head->format = (enum gz_ply_format)i;
			head->has_format = true;
			return NULL;
		}
	return "the PLY format is not ascii, binary_little_endian or binary_big_endian 1.0";
}

static const char *take_element_line(struct gz_ply_head *head, const struct ply_line *line)
{
	long long count;
	if (line->count != 3 || !gz_number_parse_whole(line->words[2], &count) || count < 0)
		return "a PLY element without a name and a number of items";
	if (head->element_count == GZ_PLY_ELEMENTS_MAX)
		return "more than 32 PLY elements";
	struct gz_ply_element *element = &head->elements[head->element_count++];
	*element = (struct gz_ply_element) { .count = (uint64_t)count,
					     .first_property = head->property_count };
	take_ply_name(line->words[1], element->name);
	return NULL;
}

static bool find_ply_type(const char *word, enum gz_file_number *out_type)
{
	/* Each type has a name of the first PLY and one with its bits. */
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
		if (strcmp(word, types[i].names[0]) == 0 || strcmp(word, types[i].names[1]) == 0) {
			*out_type = types[i].type;
			return true;
		}
	return false;
}

static const char *take_property_line(struct gz_ply_head *head, const struct ply_line *line)
{
	struct gz_ply_property property = { .is_list = line->count == 5 &&
						       strcmp(line->words[1], "list") == 0 };
	const int type = property.is_list ? 3 : 1;
	if (head->element_count == 0)
		return "a PLY property in front of all elements";
	if (line->count != type + 2 || !find_ply_type(line->words[type], &property.type) ||
	    (property.is_list && (!find_ply_type(line->words[2], &property.count_type) ||
				  property.count_type >= GZ_FILE_F32)))
		return "a PLY property without a known type and a name";
	if (head->property_count == GZ_PLY_PROPERTIES_MAX)
		return "more than 256 PLY properties";
	take_ply_name(line->words[type + 1], property.name);
	head->properties[head->property_count++] = property;
	head->elements[head->element_count - 1].property_count++;
	return NULL;
}

const char *gz_ply_head_take_line(struct gz_ply_head *head, char *text, bool *out_end)
{
	const struct ply_line line = cut_line(text);
	const char *first = line.count > 0 ? line.words[0] : "comment";
	*out_end = false;
	if (head->lines++ == 0)
		return line.count == 1 && strcmp(first, "ply") == 0 ? NULL
								    : "does not begin with ply";
	if (strcmp(first, "end_header") == 0) {
		*out_end = head->has_format;
		return head->has_format ? NULL : "its PLY header has no format";
	}
	if (strcmp(first, "format") == 0)
		return take_format_line(head, &line);
	if (strcmp(first, "element") == 0)
		return take_element_line(head, &line);
	if (strcmp(first, "property") == 0)
		return take_property_line(head, &line);
	return strcmp(first, "comment") == 0 || strcmp(first, "obj_info") == 0
		       ? NULL
		       : "not a line of a PLY header";
}

uint64_t gz_ply_item_bytes(const struct gz_ply_head *head, const struct gz_ply_element *element)
{
	uint64_t bytes = 0;
	for (size_t i = 0; i < element->property_count; i++) {
		const struct gz_ply_property *property =
			&head->properties[element->first_property + i];
		bytes += head->format == GZ_PLY_TEXT
				 ? 2
				 : gz_file_number_size(property->is_list ? property->count_type
									 : property->type);
	}
	return bytes;
}
