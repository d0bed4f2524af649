/* Transfer functions from and to text: docs/scenes.md has the grammar. */
#include <string.h>

#include "base/text.h"
#include "render/transfer/transfer.h"

#define GZ_LOG_MODULE "transfer"

#define BLANKS    " \t\r"
#define LINE_SIZE 256
/* Chosen: a hundred times what GZ_TRANSFER_POINTS_MAX points need. */
#define FILE_SIZE_MAX ((size_t)1 << 20)

struct parser {
	const char *name;
	const struct gz_log *log;
	int line;
	bool has_interpolation;
	struct gz_transfer transfer;
};

static enum gz_result refuse_transfer_line(const struct parser *parser, const char *key,
					   const char *what)
{
	gz_err(parser->log, "%s:%d: %.40s: %s", parser->name, parser->line, key, what);
	return GZ_ERR_FORMAT;
}

/* Read the rest of a line as exactly `count` numbers. */
static bool take_line_numbers(char *rest, double *out, int count)
{
	for (int i = 0; i < count; i++) {
		char *word = gz_number_next_word(&rest, BLANKS);
		if (!word || !gz_number_parse(word, &out[i]))
			return false;
	}
	return !gz_number_next_word(&rest, BLANKS);
}

static enum gz_result take_range(struct parser *parser, char *rest)
{
	double range[2];
	if (parser->transfer.has_range)
		return refuse_transfer_line(parser, "range", "given twice; keep one");
	if (!take_line_numbers(rest, range, 2) || !(range[0] < range[1]))
		return refuse_transfer_line(parser, "range",
					    "write two finite numbers, the lower first");
	parser->transfer.has_range = true;
	memcpy(parser->transfer.range, range, sizeof range);
	return GZ_OK;
}

static enum gz_result take_interpolation(struct parser *parser, char *rest)
{
	char *word = gz_number_next_word(&rest, BLANKS);
	if (parser->has_interpolation)
		return refuse_transfer_line(parser, "interpolation", "given twice; keep one");
	if (!word || gz_number_next_word(&rest, BLANKS))
		return refuse_transfer_line(parser, "interpolation", "write linear or quadratic");
	if (strcmp(word, "linear") == 0)
		parser->transfer.interpolation = GZ_TRANSFER_LINEAR;
	else if (strcmp(word, "quadratic") == 0)
		parser->transfer.interpolation = GZ_TRANSFER_QUADRATIC;
	else
		return refuse_transfer_line(parser, word, "unknown; write linear or quadratic");
	parser->has_interpolation = true;
	return GZ_OK;
}

static enum gz_result append_point(struct parser *parser, const double numbers[5])
{
	struct gz_transfer *transfer = &parser->transfer;
	size_t count = transfer->count;
	if (count == GZ_TRANSFER_POINTS_MAX)
		return refuse_transfer_line(parser, "point", "one too many; at most 256 are read");
	if (count > 0 && numbers[0] < transfer->points[count - 1].value)
		return refuse_transfer_line(parser, "value",
					    "below that of the point above; let values rise");
	if (count > 1 && numbers[0] <= transfer->points[count - 2].value)
		return refuse_transfer_line(parser, "value",
					    "given a third time; two points make a step");
	transfer->points[transfer->count++] = (struct gz_transfer_point) {
		.value = numbers[0],
		.rgb = { numbers[1], numbers[2], numbers[3] },
		.opacity = numbers[4],
	};
	return GZ_OK;
}

static enum gz_result take_point_line(struct parser *parser, const char *value, char *rest)
{
	static const char *const names[5] = { "value", "red", "green", "blue", "opacity" };
	double numbers[5];
	if (!gz_number_parse(value, &numbers[0]))
		return refuse_transfer_line(
			parser, value,
			"unknown word; write a point \"value r g b a\", range or "
			"interpolation");
	if (!take_line_numbers(rest, numbers + 1, 4))
		return refuse_transfer_line(parser, "point",
					    "write five numbers from 0 to 1: value r g b a");
	for (int i = 0; i < 5; i++)
		if (!(numbers[i] >= 0 && numbers[i] <= 1))
			return refuse_transfer_line(parser, names[i],
						    "out of range; allowed: 0 to 1");
	return append_point(parser, numbers);
}

static enum gz_result take_transfer_line(struct parser *parser, char *line)
{
	line[strcspn(line, "#")] = '\0';
	char *rest = line;
	char *word = gz_number_next_word(&rest, BLANKS);
	if (!word)
		return GZ_OK;
	if (strcmp(word, "range") == 0)
		return take_range(parser, rest);
	if (strcmp(word, "interpolation") == 0)
		return take_interpolation(parser, rest);
	return take_point_line(parser, word, rest);
}

/* Copy a line without its comment. */
static enum gz_result copy_line(const struct parser *parser, const char *text, size_t size,
				char out_line[LINE_SIZE])
{
	const char *comment = memchr(text, '#', size);
	size_t used = comment ? (size_t)(comment - text) : size;
	if (memchr(text, '\0', used))
		return refuse_transfer_line(parser, "line", "has a NUL byte; is this a text file?");
	if (used >= LINE_SIZE)
		return refuse_transfer_line(parser, "line", "longer than 255 bytes; shorten it");
	memcpy(out_line, text, used);
	out_line[used] = '\0';
	return GZ_OK;
}

enum gz_result gz_transfer_parse(const char *name, const char *text, size_t size,
				 const struct gz_log *log, struct gz_transfer *out_transfer)
{
	struct parser parser = { .name = name, .log = log };
	for (size_t at = 0; at < size;) {
		const char *end = memchr(text + at, '\n', size - at);
		size_t length = end ? (size_t)(end - (text + at)) : size - at;
		char line[LINE_SIZE];
		parser.line++;
		enum gz_result result = copy_line(&parser, text + at, length, line);
		if (result == GZ_OK)
			result = take_transfer_line(&parser, line);
		if (result != GZ_OK)
			return result;
		at += length + 1;
	}
	if (parser.transfer.count == 0) {
		gz_err(log, "%s: no control point; write at least one line \"value r g b a\"",
		       name);
		return GZ_ERR_FORMAT;
	}
	*out_transfer = parser.transfer;
	return GZ_OK;
}

enum gz_result gz_transfer_load(const char *path, const struct gz_log *log,
				struct gz_transfer *out_transfer)
{
	const struct gz_text_file file = { path, "transfer function", FILE_SIZE_MAX };
	struct gz_text text = { 0 };
	enum gz_result result = gz_text_load(&text, &file, log);
	if (result == GZ_OK)
		result = gz_transfer_parse(path, text.bytes ? text.bytes : "", text.length, log,
					   out_transfer);
	gz_text_free(&text);
	return result;
}

static void print_point_numbers(const double *numbers, int count, const char *before,
				struct gz_text *text)
{
	for (int i = 0; i < count; i++) {
		char number[GZ_NUMBER_SIZE];
		gz_number_print(numbers[i], number);
		gz_text_add(text, "%s%s", i == 0 ? before : " ", number);
	}
}

void gz_transfer_print(const struct gz_transfer *transfer, struct gz_text *text)
{
	gz_text_add(text, "# value r g b a\n");
	if (transfer->has_range) {
		print_point_numbers(transfer->range, 2, "range ", text);
		gz_text_add(text, "\n");
	}
	if (transfer->interpolation == GZ_TRANSFER_QUADRATIC)
		gz_text_add(text, "interpolation quadratic\n");
	for (size_t i = 0; i < transfer->count; i++) {
		const struct gz_transfer_point *point = &transfer->points[i];
		print_point_numbers(&point->value, 1, "", text);
		print_point_numbers(point->rgb, 3, "  ", text);
		print_point_numbers(&point->opacity, 1, "  ", text);
		gz_text_add(text, "\n");
	}
}

enum gz_result gz_transfer_write(const struct gz_transfer *transfer, const char *path,
				 const struct gz_log *log)
{
	struct gz_text text = { 0 };
	struct gz_transfer read;
	enum gz_result result = GZ_ERR_INVAL;
	if (transfer->count <= GZ_TRANSFER_POINTS_MAX)
		gz_transfer_print(transfer, &text);
	if (text.failed || gz_transfer_parse(path, text.bytes, text.length, log, &read) == GZ_OK)
		result = gz_text_write(&text, path, log);
	gz_text_free(&text);
	return result;
}
