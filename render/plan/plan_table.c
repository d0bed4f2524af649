/* Tables of spacings from text: docs/scenes.md has the grammar. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/number.h"
#include "render/plan/plan.h"

#define GZ_LOG_MODULE "plan"

#define BLANKS    " \t\r"
#define LINE_SIZE 256
/* Chosen: ten times what GZ_SPACING_TABLE_MAX rows and their comments need. */
#define FILE_SIZE_MAX ((size_t)1 << 16)

struct parser {
	const char *name;
	const struct gz_log *log;
	int line;
	bool has_unit;
	struct gz_spacing_table table;
};

/* What each column may be. */
static const struct {
	const char *name;
	double min, max;
	const char *allowed;
} columns[3] = {
	{ "eccentricity", 0, 180, "out of range; allowed: 0 to 180 degrees" },
	{ "spacing", 0.001, 1000, "out of range; allowed: 0.001 to 1000" },
	{ "step", 1, 16, "out of range; allowed: 1 to 16" },
};

static enum gz_result refuse(const struct parser *parser, const char *key, const char *what)
{
	gz_err(parser->log, "%s:%d: %.40s: %s", parser->name, parser->line, key, what);
	return GZ_ERR_FORMAT;
}

static enum gz_result take_unit(struct parser *parser, char *rest)
{
	const char *word = gz_number_next_word(&rest, BLANKS);
	if (parser->has_unit)
		return refuse(parser, "unit", "given twice; keep one");
	if (!word || gz_number_next_word(&rest, BLANKS) ||
	    (strcmp(word, "px") != 0 && strcmp(word, "deg") != 0))
		return refuse(parser, "unit", "write px or deg");
	parser->has_unit = true;
	parser->table.in_deg = strcmp(word, "deg") == 0;
	return GZ_OK;
}

static enum gz_result append_row(struct parser *parser, const double numbers[3])
{
	struct gz_spacing_table *table = &parser->table;
	if (table->count == GZ_SPACING_TABLE_MAX)
		return refuse(parser, "row", "one too many; at most 64 are read");
	if (table->count > 0) {
		const struct gz_spacing_row *above = &table->rows[table->count - 1];
		if (numbers[0] <= above->eccentricity_deg)
			return refuse(parser, "eccentricity",
				      "not above that of the row before; let them rise");
		if (numbers[1] < above->spacing || numbers[2] < above->step)
			return refuse(parser, numbers[1] < above->spacing ? "spacing" : "step",
				      "below that of the row before; outwards it may only grow");
	}
	table->rows[table->count++] = (struct gz_spacing_row) {
		.eccentricity_deg = numbers[0],
		.spacing = numbers[1],
		.step = numbers[2],
	};
	return GZ_OK;
}

static enum gz_result take_row(struct parser *parser, const char *first, char *rest)
{
	double numbers[3];
	if (!gz_number_parse(first, &numbers[0]))
		return refuse(
			parser, first,
			"unknown word; write a row \"eccentricity_deg spacing step\" or unit");
	for (int i = 1; i < 3; i++) {
		const char *word = gz_number_next_word(&rest, BLANKS);
		if (!word || !gz_number_parse(word, &numbers[i]))
			return refuse(parser, "row",
				      "write three numbers: eccentricity_deg spacing step");
	}
	if (gz_number_next_word(&rest, BLANKS))
		return refuse(parser, "row", "more than three numbers; write one row a line");
	for (int i = 0; i < 3; i++)
		if (!(numbers[i] >= columns[i].min && numbers[i] <= columns[i].max))
			return refuse(parser, columns[i].name, columns[i].allowed);
	return append_row(parser, numbers);
}

static enum gz_result take_line(struct parser *parser, const char *text, size_t size)
{
	char line[LINE_SIZE];
	const char *comment = memchr(text, '#', size);
	const size_t used = comment ? (size_t)(comment - text) : size;
	if (memchr(text, '\0', used))
		return refuse(parser, "line", "has a NUL byte; is this a text file?");
	if (used >= LINE_SIZE)
		return refuse(parser, "line", "longer than 255 bytes; shorten it");
	memcpy(line, text, used);
	line[used] = '\0';
	char *rest = line;
	const char *word = gz_number_next_word(&rest, BLANKS);
	if (!word)
		return GZ_OK;
	return strcmp(word, "unit") == 0 ? take_unit(parser, rest) : take_row(parser, word, rest);
}

enum gz_result gz_spacing_table_parse(const char *name, const char *text, size_t size,
				      const struct gz_log *log, struct gz_spacing_table *out_table)
{
	struct parser parser = { .name = name, .log = log };
	for (size_t at = 0; at < size;) {
		const char *end = memchr(text + at, '\n', size - at);
		const size_t length = end ? (size_t)(end - (text + at)) : size - at;
		parser.line++;
		const enum gz_result result = take_line(&parser, text + at, length);
		if (result != GZ_OK)
			return result;
		at += length + 1;
	}
	if (parser.table.count == 0) {
		gz_err(log, "%s: no row; write at least one line \"eccentricity_deg spacing step\"",
		       name);
		return GZ_ERR_FORMAT;
	}
	*out_table = parser.table;
	return GZ_OK;
}

static enum gz_result parse_stream(FILE *file, const char *path, const struct gz_log *log,
				   struct gz_spacing_table *out_table)
{
	char *text = malloc(FILE_SIZE_MAX + 1);
	if (!text) {
		gz_err(log, "%s: no memory to read it", path);
		return GZ_ERR_NO_MEM;
	}
	enum gz_result result;
	const size_t size = fread(text, 1, FILE_SIZE_MAX + 1, file);
	if (ferror(file)) {
		gz_err(log, "%s: cannot read the table of spacings: %s; name a text file", path,
		       strerror(errno));
		result = GZ_ERR_IO;
	} else if (size > FILE_SIZE_MAX) {
		gz_err(log, "%s: longer than 64 KiB; is this a table of spacings?", path);
		result = GZ_ERR_FORMAT;
	} else {
		result = gz_spacing_table_parse(path, text, size, log, out_table);
	}
	free(text);
	return result;
}

enum gz_result gz_spacing_table_load(const char *path, const struct gz_log *log,
				     struct gz_spacing_table *out_table)
{
	FILE *file = fopen(path, "re");
	if (!file) {
		const int saved = errno;
		gz_err(log,
		       "%s: cannot open the table of spacings: %s; check its name and permissions",
		       path, strerror(saved));
		return saved == ENOENT || saved == ENOTDIR ? GZ_ERR_NOT_FOUND : GZ_ERR_IO;
	}
	const enum gz_result result = parse_stream(file, path, log, out_table);
	fclose(file);
	return result;
}

static bool row_valid(const struct gz_spacing_row *row)
{
	const double numbers[3] = { row->eccentricity_deg, row->spacing, row->step };
	for (int i = 0; i < 3; i++)
		if (!(numbers[i] >= columns[i].min && numbers[i] <= columns[i].max))
			return false;
	return true;
}

bool gz_spacing_table_valid(const struct gz_spacing_table *table)
{
	if (table->count < 1 || table->count > GZ_SPACING_TABLE_MAX)
		return false;
	for (int i = 0; i < table->count; i++) {
		const struct gz_spacing_row *row = &table->rows[i];
		if (!row_valid(row))
			return false;
		if (i > 0 && !(row->eccentricity_deg > row[-1].eccentricity_deg &&
			       row->spacing >= row[-1].spacing && row->step >= row[-1].step))
			return false;
	}
	return true;
}
