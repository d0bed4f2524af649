#include "render/mesh/label_names.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/text.h"
#include "render/data/text_head.h"

#define GZ_LOG_MODULE "labels"

#define BLANKS " \t"

/* Bytes of a file and of a row. Chosen: several times those of FreeSurfer's. */
#define FILE_SIZE_MAX ((size_t)8 << 20)
enum { ROW_SIZE = 1024, WORDS_MAX = 64 };

struct label_parser {
	const char *file;
	const struct gz_log *log;
	int line;
	const struct label_format *format; /* NULL before the first row */
	struct {
		int number, name, colour; /* of a dseg table, from 0; -1: none */
	} columns;
	struct gz_label_names names;
	size_t room;
};

/* A row, cut into words. */
struct label_row {
	char text[ROW_SIZE];   /* whole */
	char cut[ROW_SIZE];    /* with a NUL behind each word */
	char *word[WORDS_MAX]; /* in cut */
	int count;
};

/* A kind of file. */
struct label_format {
	/* Whether a file with this first row is one. */
	bool (*begins)(const struct label_row *row);
	/* Read a row. @return what is wrong with it; NULL: nothing. A name that stays empty is
	 * none, and the row is left out */
	const char *(*read)(const struct label_parser *parser, const struct label_row *row,
			    struct gz_label_name *out_name);
	bool has_heading; /* the first row names columns */
};

static enum gz_result refuse_label_row(const struct label_parser *parser, const char *what)
{
	gz_err(parser->log, "%s:%d: %s", parser->file, parser->line, what);
	return GZ_ERR_FORMAT;
}

/* ---- words ---- */

static bool is_whole(const char *word)
{
	long long value;
	return gz_number_parse_whole(word, &value);
}

static bool is_number(const char *word)
{
	double value;
	return gz_number_parse(word, &value);
}

static bool take_label_number(const char *word, int32_t *out_number)
{
	long long value;
	if (!gz_number_parse_whole(word, &value) || value < INT32_MIN || value > INT32_MAX)
		return false;
	*out_number = (int32_t)value;
	return true;
}

/* Red, green and blue as numbers from 0 to 255. */
static bool take_label_colour(char *const words[3], struct gz_label_name *name)
{
	for (int i = 0; i < 3; i++) {
		double value;
		if (!gz_number_parse(words[i], &value) || !(value >= 0 && value <= 255))
			return false;
		name->colour[i] = (float)(value / 255);
	}
	name->has_colour = true;
	return true;
}

/* Part of a row as a name, without blanks at its ends. False: too long, or with control
 * characters. */
static bool take_label_name(const char *from, size_t length, struct gz_label_name *name)
{
	while (length > 0 && strchr(BLANKS, from[0])) {
		from++;
		length--;
	}
	while (length > 0 && strchr(BLANKS, from[length - 1]))
		length--;
	if (length >= sizeof name->name)
		return false;
	for (size_t i = 0; i < length; i++)
		if ((unsigned char)from[i] < ' ' && from[i] != '\t')
			return false;
	memcpy(name->name, from, length);
	name->name[length] = '\0';
	return true;
}

static const char wrong_number[] = "a row begins with the whole number of a label";
static const char wrong_colour[] = "a colour is red, green and blue, each 0 to 255";
static const char wrong_name[] = "a name has at most 127 bytes and no control characters";

/* ---- colour tables ---- */

enum { TABLE_NUMBERS = 4 }; /* behind the name */

static bool begins_colour_table(const struct label_row *row)
{
	bool all = row->count >= 2 + TABLE_NUMBERS && is_whole(row->word[0]);
	for (int i = row->count - TABLE_NUMBERS; all && i < row->count; i++)
		all = is_number(row->word[i]);
	return all;
}

static const char *read_colour_table(const struct label_parser *parser, const struct label_row *row,
				     struct gz_label_name *out_name)
{
	(void)parser;
	if (row->count < 2 + TABLE_NUMBERS)
		return "a row of a colour table has a number, a name and four more numbers";
	char *const *colour = &row->word[row->count - TABLE_NUMBERS];
	const size_t from = (size_t)(row->word[1] - row->cut), to = (size_t)(colour[0] - row->cut);
	if (!take_label_number(row->word[0], &out_name->number))
		return wrong_number;
	if (!take_label_colour(colour, out_name))
		return wrong_colour;
	return take_label_name(row->text + from, to - from, out_name) ? NULL : wrong_name;
}

/* ---- label descriptions ---- */

enum { DESCRIPTION_NUMBERS = 7 }; /* before the name */

static bool begins_descriptions(const struct label_row *row)
{
	bool all = row->count > DESCRIPTION_NUMBERS && row->word[DESCRIPTION_NUMBERS][0] == '"';
	for (int i = 0; all && i < DESCRIPTION_NUMBERS; i++)
		all = is_number(row->word[i]);
	return all;
}

static const char *read_description(const struct label_parser *parser, const struct label_row *row,
				    struct gz_label_name *out_name)
{
	(void)parser;
	const char *open = strchr(row->text, '"');
	const char *close = open ? strrchr(open + 1, '"') : NULL;
	if (row->count <= DESCRIPTION_NUMBERS || !close)
		return "a label description has seven numbers and a name in quotes";
	if (!take_label_number(row->word[0], &out_name->number))
		return wrong_number;
	if (!take_label_colour(&row->word[1], out_name))
		return wrong_colour;
	return take_label_name(open + 1, (size_t)(close - open - 1), out_name) ? NULL : wrong_name;
}

/* ---- dseg tables ---- */

/* Column @p wanted of a row whose columns are separated by tabs. */
static bool find_column(const struct label_row *row, int wanted, const char **out_from,
			size_t *out_length)
{
	const char *at = row->text;
	for (int i = 0; i < wanted && at; i++) {
		at = strchr(at, '\t');
		at = at ? at + 1 : NULL;
	}
	if (wanted < 0 || !at)
		return false;
	*out_from = at;
	*out_length = strcspn(at, "\t");
	return true;
}

/* The place of the column with a name; -1: none has it. */
static int place_of_column(const struct label_row *row, const char *name)
{
	const char *from;
	size_t length;
	for (int i = 0; find_column(row, i, &from, &length); i++)
		if (length == strlen(name) && strncmp(from, name, length) == 0)
			return i;
	return -1;
}

static bool begins_dseg(const struct label_row *row)
{
	return place_of_column(row, "index") >= 0 && place_of_column(row, "name") >= 0;
}

/* A colour as #rrggbb. */
static bool take_hex_colour(const char *from, size_t length, struct gz_label_name *name)
{
	char digits[7] = "";
	if (length != sizeof digits || from[0] != '#' ||
	    strspn(from + 1, "0123456789abcdefABCDEF") < sizeof digits - 1)
		return false;
	memcpy(digits, from + 1, sizeof digits - 1);
	const unsigned long value = strtoul(digits, NULL, 16);
	for (int i = 0; i < 3; i++)
		name->colour[i] = (float)(value >> (16 - 8 * i) & 255) / 255;
	name->has_colour = true;
	return true;
}

static const char *read_dseg(const struct label_parser *parser, const struct label_row *row,
			     struct gz_label_name *out_name)
{
	char number[32];
	const char *from;
	size_t length;
	if (!find_column(row, parser->columns.number, &from, &length) || length >= sizeof number)
		return wrong_number;
	memcpy(number, from, length);
	number[length] = '\0';
	if (!take_label_number(number, &out_name->number))
		return "column index holds the whole number of a label";
	if (!find_column(row, parser->columns.name, &from, &length))
		return "the row has fewer columns than the heading";
	if (!take_label_name(from, length, out_name))
		return wrong_name;
	if (find_column(row, parser->columns.colour, &from, &length) && length > 0 &&
	    strncmp(from, "n/a", length) != 0 && !take_hex_colour(from, length, out_name))
		return "column color holds #rrggbb, or n/a";
	return NULL;
}

/* ---- lists ---- */

static bool begins_list(const struct label_row *row)
{
	return row->count >= 2 && is_whole(row->word[0]) && !is_number(row->word[1]);
}

static const char *read_list(const struct label_parser *parser, const struct label_row *row,
			     struct gz_label_name *out_name)
{
	(void)parser;
	if (!take_label_number(row->word[0], &out_name->number))
		return wrong_number;
	if (row->count < 2)
		return NULL;
	const char *from = row->text + (row->word[1] - row->cut);
	return take_label_name(from, strlen(from), out_name) ? NULL : wrong_name;
}

/* Cut off the number that each name of a list ends in, if all do and each is one word besides. */
static void cut_codes(struct gz_label_names *names)
{
	for (size_t i = 0; i < names->count; i++) {
		const char *blank = strpbrk(names->items[i].name, BLANKS);
		if (!blank || !is_whole(blank + strspn(blank, BLANKS)))
			return;
	}
	for (size_t i = 0; i < names->count; i++)
		names->items[i].name[strcspn(names->items[i].name, BLANKS)] = '\0';
}

/* ---- all formats ---- */

static const struct label_format list_format = { begins_list, read_list, false };
static const struct label_format dseg_format = { begins_dseg, read_dseg, true };

/* In the order in which they are tried. */
static const struct label_format *const label_formats[] = {
	&dseg_format,
	&(const struct label_format) { begins_descriptions, read_description, false },
	&(const struct label_format) { begins_colour_table, read_colour_table, false },
	&list_format,
};

static enum gz_result choose_label_format(struct label_parser *parser, const struct label_row *row)
{
	for (size_t i = 0; i < sizeof label_formats / sizeof label_formats[0]; i++)
		if (label_formats[i]->begins(row)) {
			parser->format = label_formats[i];
			parser->columns.number = place_of_column(row, "index");
			parser->columns.name = place_of_column(row, "name");
			parser->columns.colour = place_of_column(row, "color");
			return GZ_OK;
		}
	return refuse_label_row(parser, "no names of labels: a row has a number and a name, as in "
					"\"1 Precentral_L\", and perhaps a colour");
}

static enum gz_result append_label_name(struct label_parser *parser,
					const struct gz_label_name *name)
{
	struct gz_label_names *names = &parser->names;
	if (names->count == GZ_LABEL_NAMES_MAX) {
		gz_err(parser->log, "%s: more than %d rows", parser->file, GZ_LABEL_NAMES_MAX);
		return GZ_ERR_FULL;
	}
	if (names->count == parser->room) {
		const size_t room = parser->room ? 2 * parser->room : 64;
		struct gz_label_name *items = realloc(names->items, room * sizeof *items);
		if (!items) {
			gz_err(parser->log, "%s: no memory for the names of labels", parser->file);
			return GZ_ERR_NO_MEM;
		}
		names->items = items;
		parser->room = room;
	}
	names->items[names->count++] = *name;
	return GZ_OK;
}

static enum gz_result take_label_row(struct label_parser *parser, const struct label_row *row)
{
	if (!parser->format) {
		const enum gz_result result = choose_label_format(parser, row);
		if (result != GZ_OK || parser->format->has_heading)
			return result;
	}
	struct gz_label_name name = { .line = parser->line };
	const char *wrong = parser->format->read(parser, row, &name);
	if (wrong)
		return refuse_label_row(parser, wrong);
	return name.name[0] ? append_label_name(parser, &name) : GZ_OK;
}

/* Copy a row, and cut it into words. */
static enum gz_result cut_label_row(const struct label_parser *parser, const char *text,
				    size_t size, struct label_row *row)
{
	if (size > 0 && text[size - 1] == '\r')
		size--;
	if (memchr(text, '\0', size))
		return refuse_label_row(parser, "has a NUL byte; is this a text file?");
	if (size >= ROW_SIZE)
		return refuse_label_row(parser, "a row has at most 1023 bytes");
	memcpy(row->text, text, size);
	row->text[size] = '\0';
	memcpy(row->cut, row->text, size + 1);
	char *rest = row->cut;
	row->count = 0;
	for (char *word; row->count < WORDS_MAX && (word = gz_number_next_word(&rest, BLANKS));)
		row->word[row->count++] = word;
	return row->count < WORDS_MAX ? GZ_OK
				      : refuse_label_row(parser, "a row has at most 63 words");
}

static enum gz_result parse_label_rows(struct label_parser *parser, const char *text, size_t size)
{
	enum gz_result result = GZ_OK;
	for (size_t at = 0; at < size && result == GZ_OK;) {
		const char *end = memchr(text + at, '\n', size - at);
		const size_t length = end ? (size_t)(end - (text + at)) : size - at;
		struct label_row row;
		parser->line++;
		if (text[at] != '#') {
			result = cut_label_row(parser, text + at, length, &row);
			if (result == GZ_OK && row.count > 0)
				result = take_label_row(parser, &row);
		}
		at += length + 1;
	}
	if (result == GZ_OK && !parser->format)
		return refuse_label_row(parser, "no row names a label");
	return result;
}

static int compare_names(const void *a, const void *b)
{
	const struct gz_label_name *x = a, *y = b;
	return x->number != y->number ? (x->number > y->number) - (x->number < y->number)
				      : (x->line > y->line) - (x->line < y->line);
}

/* Sort the names; of those with one number the first stays. */
static void sort_label_names(struct label_parser *parser)
{
	struct gz_label_names *names = &parser->names;
	size_t kept = 0, twice = 0;
	qsort(names->items, names->count, sizeof *names->items, compare_names);
	for (size_t i = 0; i < names->count; i++) {
		if (kept > 0 && names->items[kept - 1].number == names->items[i].number) {
			if (twice++ == 0)
				gz_warn(parser->log,
					"%s:%d: label %" PRId32 " is named in line %d already, "
					"which counts",
					parser->file, names->items[i].line, names->items[i].number,
					names->items[kept - 1].line);
			continue;
		}
		names->items[kept++] = names->items[i];
	}
	names->count = kept;
}

enum gz_result gz_label_names_parse(const char *file, const char *text, size_t size,
				    const struct gz_log *log, struct gz_label_names *out_names)
{
	struct label_parser parser = { .file = file, .log = log };
	const bool marked = size >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0;
	const size_t from = marked ? 3 : 0;
	const enum gz_result result = parse_label_rows(&parser, text + from, size - from);
	if (result != GZ_OK) {
		gz_label_names_free(&parser.names);
		return result;
	}
	if (parser.format == &list_format)
		cut_codes(&parser.names);
	if (parser.names.count > 0)
		sort_label_names(&parser);
	*out_names = parser.names;
	return GZ_OK;
}

/* ---- segments in the header of a volume ---- */

/* What a header says about one segment, until all of its lines are read. */
struct label_segment {
	struct gz_label_name name;
	bool has_number, is_elsewhere; /* in another layer than the first */
};

/* The number in "Segment0_Name:=liver", and the key behind it; -1: another line. */
static int find_segment(const char *line, const char **out_key)
{
	static const char begin[] = "Segment";
	const char *digits = line + sizeof begin - 1;
	char *end;
	if (strncmp(line, begin, sizeof begin - 1) != 0 || *digits < '0' || *digits > '9')
		return -1;
	const unsigned long index = strtoul(digits, &end, 10);
	*out_key = end;
	return *end == '_' && index < GZ_LABEL_SEGMENTS_MAX ? (int)index : -1;
}

static const char *take_segment_name(char *text, struct label_segment *segment)
{
	return take_label_name(text, strlen(text), &segment->name) ? NULL : wrong_name;
}

static const char *take_segment_number(char *text, struct label_segment *segment)
{
	segment->has_number = take_label_number(text, &segment->name.number);
	return segment->has_number ? NULL : "a LabelValue is a whole number";
}

static const char *take_segment_colour(char *text, struct label_segment *segment)
{
	double colour[3];
	if (!gz_text_numbers(text, colour, 3))
		return "a Color is red, green and blue, each 0 to 1";
	segment->name.has_colour = true;
	for (int i = 0; i < 3; i++)
		segment->name.colour[i] = (float)fmin(fmax(colour[i], 0), 1);
	return NULL;
}

static const char *take_segment_layer(char *text, struct label_segment *segment)
{
	double layer;
	segment->is_elsewhere = gz_text_numbers(text, &layer, 1) && layer != 0;
	return NULL;
}

static const struct {
	const char *key;
	const char *(*take)(char *text, struct label_segment *segment);
} segment_keys[] = {
	{ "_Name:=", take_segment_name },
	{ "_LabelValue:=", take_segment_number },
	{ "_Color:=", take_segment_colour },
	{ "_Layer:=", take_segment_layer },
};

/* Take a line of a header. @return what is wrong with it; NULL: nothing */
static const char *take_segment_line(char *line, struct label_segment *segments)
{
	const char *key = NULL;
	const int index = find_segment(line, &key);
	for (size_t i = 0; index >= 0 && i < sizeof segment_keys / sizeof segment_keys[0]; i++) {
		const size_t length = strlen(segment_keys[i].key);
		if (strncmp(key, segment_keys[i].key, length) == 0)
			return segment_keys[i].take(line + (key - line) + length, &segments[index]);
	}
	return NULL;
}

static enum gz_result read_segments(struct label_parser *parser, struct gz_text_head *head,
				    struct label_segment *segments)
{
	enum gz_result result = GZ_OK;
	for (char *line; (line = gz_text_head_line(head)) && line[0];) {
		parser->line = head->line;
		const char *wrong = take_segment_line(line, segments);
		if (wrong)
			return refuse_label_row(parser, wrong);
	}
	for (int i = 0; i < GZ_LABEL_SEGMENTS_MAX && result == GZ_OK; i++) {
		segments[i].name.line = i + 1;
		if (segments[i].has_number && segments[i].name.name[0] && !segments[i].is_elsewhere)
			result = append_label_name(parser, &segments[i].name);
	}
	if (result == GZ_OK && parser->names.count == 0)
		return refuse_label_row(parser, "the header names no segment");
	return result;
}

static enum gz_result read_label_header(const char *path, const struct gz_log *log,
					struct gz_label_names *out_names)
{
	struct label_parser parser = { .file = path, .log = log };
	struct gz_text_head head = { 0 };
	struct label_segment *segments = calloc(GZ_LABEL_SEGMENTS_MAX, sizeof *segments);
	enum gz_result result = segments ? gz_text_head_open(&head, path, log) : GZ_ERR_NO_MEM;
	if (result == GZ_OK)
		result = read_segments(&parser, &head, segments);
	gz_text_head_free(&head);
	free(segments);
	if (result != GZ_OK) {
		gz_label_names_free(&parser.names);
		return result;
	}
	sort_label_names(&parser);
	*out_names = parser.names;
	return GZ_OK;
}

static bool is_nrrd(const char *path)
{
	return gz_path_ends(path, ".nrrd") || gz_path_ends(path, ".nhdr");
}

enum gz_result gz_label_names_read(const char *path, const struct gz_log *log,
				   struct gz_label_names *out_names)
{
	if (is_nrrd(path))
		return read_label_header(path, log, out_names);
	const struct gz_text_file file = { path, "names of labels", FILE_SIZE_MAX };
	struct gz_text text = { 0 };
	enum gz_result result = gz_text_load(&text, &file, log);
	if (result == GZ_OK)
		result = gz_label_names_parse(path, text.bytes ? text.bytes : "", text.length, log,
					      out_names);
	gz_text_free(&text);
	return result;
}

/* ---- where they are ---- */

/* Length of a path without one of the endings that a volume may have; the path's without one. */
static size_t length_without_ending(const char *path, size_t length, const char *const endings[])
{
	for (size_t i = 0; endings[i]; i++) {
		const size_t ending = strlen(endings[i]);
		char tail[16];
		if (length <= ending)
			continue;
		memcpy(tail, path + length - ending, ending);
		tail[ending] = '\0';
		if (gz_path_ends(tail, endings[i]))
			return length - ending;
	}
	return length;
}

bool gz_label_names_beside(const char *volume, char out_path[GZ_PATH_SIZE])
{
	static const char *const packings[] = { ".gz", ".zst", ".bz2", NULL };
	static const char *const endings[] = { ".nii", ".mgz", ".mgh", ".nrrd", ".nhdr", ".mha",
					       ".mhd", ".mnc", ".hdr", ".raw",  NULL };
	static const char *const files[] = { ".txt", ".label", ".ctbl", ".tsv", ".lut.txt" };
	const size_t whole = strlen(volume);
	const size_t unpacked = length_without_ending(volume, whole, packings);
	const size_t lengths[] = { unpacked, length_without_ending(volume, unpacked, endings),
				   whole };
	for (size_t i = 0; i < sizeof lengths / sizeof lengths[0]; i++)
		for (size_t k = 0; k < sizeof files / sizeof files[0]; k++)
			if (gz_text_print(out_path, GZ_PATH_SIZE, "%.*s%s", (int)lengths[i], volume,
					  files[k]) == GZ_OK &&
			    access(out_path, R_OK) == 0)
				return true;
	if (gz_path_beside(volume, "FreeSurferColorLUT.txt", out_path, GZ_PATH_SIZE) == GZ_OK &&
	    access(out_path, R_OK) == 0)
		return true;
	return is_nrrd(volume) && gz_text_print(out_path, GZ_PATH_SIZE, "%s", volume) == GZ_OK;
}

const struct gz_label_name *gz_label_names_find(const struct gz_label_names *names, int32_t number)
{
	size_t low = 0, high = names->count;
	while (low < high) {
		const size_t middle = low + (high - low) / 2;
		if (names->items[middle].number < number)
			low = middle + 1;
		else
			high = middle;
	}
	return low < names->count && names->items[low].number == number ? &names->items[low] : NULL;
}

void gz_label_names_free(struct gz_label_names *names)
{
	free(names->items);
	*names = (struct gz_label_names) { 0 };
}
