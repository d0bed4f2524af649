#include "render/data/raw_name.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "render/data/volume.h"

/* Words for types; longer ones before those that they begin with. -1 ends a row. */
static const struct {
	const char *word;
	int types[GZ_RAW_NAMED_TYPES];
} type_words[] = {
	{ "unsigned_char", { GZ_RAW_UINT8, -1 } },
	{ "unsigned_short", { GZ_RAW_UINT16, -1 } },
	{ "unsigned_int", { GZ_RAW_UINT32, -1 } },
	{ "uint8", { GZ_RAW_UINT8, -1 } },
	{ "uint16", { GZ_RAW_UINT16, -1 } },
	{ "uint32", { GZ_RAW_UINT32, -1 } },
	{ "float32", { GZ_RAW_FLOAT32, -1 } },
	{ "float64", { GZ_RAW_FLOAT64, -1 } },
	{ "double", { GZ_RAW_FLOAT64, -1 } },
	{ "float", { GZ_RAW_FLOAT32, -1 } },
	{ "ushort", { GZ_RAW_UINT16, -1 } },
	{ "uchar", { GZ_RAW_UINT8, -1 } },
	{ "ubyte", { GZ_RAW_UINT8, -1 } },
	{ "schar", { GZ_RAW_INT8, -1 } },
	{ "sbyte", { GZ_RAW_INT8, -1 } },
	{ "short", { GZ_RAW_INT16, -1 } },
	{ "byte", { GZ_RAW_UINT8, -1 } },
	{ "char", { GZ_RAW_UINT8, GZ_RAW_INT8, -1 } },
	{ "int8", { GZ_RAW_INT8, -1 } },
	{ "int16", { GZ_RAW_INT16, -1 } },
	{ "int32", { GZ_RAW_INT32, -1 } },
	{ "uint", { GZ_RAW_UINT32, -1 } },
	{ "int", { GZ_RAW_INT32, -1 } },
	{ "u8", { GZ_RAW_UINT8, -1 } },
	{ "u16", { GZ_RAW_UINT16, -1 } },
	{ "u32", { GZ_RAW_UINT32, -1 } },
	{ "i8", { GZ_RAW_INT8, -1 } },
	{ "i16", { GZ_RAW_INT16, -1 } },
	{ "i32", { GZ_RAW_INT32, -1 } },
	{ "s8", { GZ_RAW_INT8, -1 } },
	{ "s16", { GZ_RAW_INT16, -1 } },
	{ "s32", { GZ_RAW_INT32, -1 } },
	{ "f32", { GZ_RAW_FLOAT32, -1 } },
	{ "f64", { GZ_RAW_FLOAT64, -1 } },
	{ "8ubit", { GZ_RAW_UINT8, -1 } },
	{ "8bit", { GZ_RAW_UINT8, GZ_RAW_INT8, -1 } },
	{ "16bit", { GZ_RAW_UINT16, GZ_RAW_INT16, -1 } },
	{ "32bit", { GZ_RAW_FLOAT32, GZ_RAW_INT32, GZ_RAW_UINT32 } },
	{ "64bit", { GZ_RAW_FLOAT64, -1 } },
	{ "8u", { GZ_RAW_UINT8, -1 } },
	{ "16u", { GZ_RAW_UINT16, -1 } },
	{ "8s", { GZ_RAW_INT8, -1 } },
	{ "16s", { GZ_RAW_INT16, -1 } },
	{ "32f", { GZ_RAW_FLOAT32, -1 } },
	{ "64f", { GZ_RAW_FLOAT64, -1 } },
};

/* Words for byte orders; the first that stands by itself, or behind a type, counts. */
static const struct {
	const char *word;
	bool is_big;
} order_words[] = {
	{ "bigendian", true }, { "littleendian", false }, { "big", true }, { "little", false },
	{ "msb", true },       { "lsb", false },          { "be", true },  { "le", false },
};

static const char *const endings[] = { ".zst", ".gz", ".raw", ".bin", ".dat", ".vol", ".img" };

static bool is_word(char c)
{
	return isalnum((unsigned char)c) != 0;
}

/* The name without folder and endings, in lower case; the sign of multiplication becomes an x. */
static void take_text(const char *path, char out_text[GZ_RAW_NAME_SIZE])
{
	const char *slash = strrchr(path, '/');
	const char *from = slash ? slash + 1 : path;
	size_t used = 0;
	for (; *from && used + 1 < GZ_RAW_NAME_SIZE; from++) {
		if (strncmp(from, "\xc3\x97", 2) == 0) {
			out_text[used++] = 'x';
			from++;
			continue;
		}
		out_text[used++] = (char)tolower((unsigned char)*from);
	}
	out_text[used] = '\0';
	for (size_t i = 0; i < sizeof endings / sizeof endings[0]; i++) {
		const size_t length = strlen(endings[i]);
		if (used > length && strcmp(out_text + used - length, endings[i]) == 0) {
			used -= length;
			out_text[used] = '\0';
		}
	}
}

/* Where a number that begins here ends. A dot belongs to it where one fraction follows: several
 * dots join whole numbers. */
static size_t number_end(const char *text, size_t at, bool *out_whole)
{
	size_t end = at;
	*out_whole = true;
	while (isdigit((unsigned char)text[end]))
		end++;
	const bool joined = at > 1 && text[at - 1] == '.' && isdigit((unsigned char)text[at - 2]);
	if (text[end] != '.' || !isdigit((unsigned char)text[end + 1]) || joined)
		return end;
	size_t after = end + 1;
	while (isdigit((unsigned char)text[after]))
		after++;
	if (text[after] == '.' && isdigit((unsigned char)text[after + 1]))
		return end;
	*out_whole = false;
	return after;
}

/* Whether a number is part of a word: behind a letter that is no x between two numbers, or before
 * one that belongs to a type, as in "16bit". */
static bool is_glued(const char *text, size_t start, size_t end)
{
	const bool joined =
		start > 1 && text[start - 1] == 'x' && isdigit((unsigned char)text[start - 2]);
	if (start > 0 && isalpha((unsigned char)text[start - 1]) && !joined)
		return true;
	return isalpha((unsigned char)text[end]) && text[end] != 'x' &&
	       strncmp(text + end, "mm", 2) != 0;
}

static void take_numbers(struct gz_raw_name *name)
{
	const char *text = name->text;
	for (size_t at = 0; text[at] && name->number_count < GZ_RAW_NUMBERS_MAX;) {
		if (!isdigit((unsigned char)text[at])) {
			at++;
			continue;
		}
		struct gz_raw_number *number = &name->numbers[name->number_count++];
		const size_t end = number_end(text, at, &number->is_whole);
		char copy[GZ_RAW_NAME_SIZE];
		snprintf(copy, sizeof copy, "%.*s", (int)(end - at), text + at);
		number->value = strtod(copy, NULL);
		number->is_glued = is_glued(text, at, end);
		const char joint = text[end];
		number->joint =
			joint && strchr("x_-.,*", joint) && isdigit((unsigned char)text[end + 1])
				? joint
				: '\0';
		at = end;
	}
}

/* Whether a word stands at a place by itself: no letter before it, nor digit but behind a number's
 * own letters, and behind it the end, a byte order or something that is no letter. */
static bool stands_alone(const char *text, size_t at, size_t length)
{
	const char first = text[at], before = at > 0 ? text[at - 1] : '\0';
	if (isalpha((unsigned char)before) && before != 'x')
		return false;
	if (isdigit((unsigned char)first) && isdigit((unsigned char)before))
		return false;
	const char *after = text + at + length;
	if (!is_word(*after))
		return true;
	if (*after == 's' && !is_word(after[1])) /* bits, bytes */
		return true;
	for (size_t i = 0; i < sizeof order_words / sizeof order_words[0]; i++) {
		const size_t word = strlen(order_words[i].word);
		if (strncmp(after, order_words[i].word, word) == 0 && !is_word(after[word]))
			return true;
	}
	return false;
}

static bool has_word(const char *text, const char *word)
{
	for (const char *at = strstr(text, word); at; at = strstr(at + 1, word))
		if (stands_alone(text, (size_t)(at - text), strlen(word)))
			return true;
	return false;
}

static void take_type(struct gz_raw_name *name)
{
	for (size_t i = 0; i < sizeof type_words / sizeof type_words[0]; i++) {
		if (!has_word(name->text, type_words[i].word))
			continue;
		name->type_word = type_words[i].word;
		for (size_t k = 0; k < GZ_RAW_NAMED_TYPES && type_words[i].types[k] >= 0; k++)
			name->types[name->type_count++] = type_words[i].types[k];
		return;
	}
}

/* An order stands by itself, or right behind a type: "int16be". */
static bool has_order(const char *text, const char *word)
{
	const size_t length = strlen(word);
	for (const char *at = strstr(text, word); at; at = strstr(at + 1, word)) {
		const char before = at > text ? at[-1] : '\0';
		const bool behind_type = isdigit((unsigned char)before) ||
					 (at - text >= 5 && strncmp(at - 5, "short", 5) == 0) ||
					 (at - text >= 5 && strncmp(at - 5, "float", 5) == 0);
		if ((!is_word(before) || behind_type) && !is_word(at[length]))
			return true;
	}
	return false;
}

static void take_order(struct gz_raw_name *name)
{
	for (size_t i = 0; i < sizeof order_words / sizeof order_words[0]; i++)
		if (has_order(name->text, order_words[i].word)) {
			name->big_endian = order_words[i].is_big;
			return;
		}
}

static bool are_joined(const struct gz_raw_number *numbers)
{
	return numbers[0].joint && numbers[0].joint == numbers[1].joint;
}

/* Three joined numbers of which one has decimals, or that follow three whole ones joined by x; else
 * one with decimals before "mm". */
static void take_spacing(struct gz_raw_name *name)
{
	size_t triples = 0;
	for (size_t i = 0; i + 2 < name->number_count; i++) {
		const struct gz_raw_number *n = &name->numbers[i];
		if (!are_joined(n))
			continue;
		const bool whole = n[0].is_whole && n[1].is_whole && n[2].is_whole;
		if (whole && (triples++ == 0 || n[0].joint != 'x')) {
			i += n[0].joint == 'x' ? 2 : 0;
			continue;
		}
		if (!(n[0].value > 0 && n[1].value > 0 && n[2].value > 0))
			continue;
		for (int axis = 0; axis < 3; axis++)
			name->spacing[axis] = n[axis].value;
		name->has_spacing = true;
		return;
	}
	const char *unit = strstr(name->text, "mm");
	if (!unit || unit == name->text || !isdigit((unsigned char)unit[-1]) || is_word(unit[2]))
		return;
	const char *start = unit;
	while (start > name->text && (isdigit((unsigned char)start[-1]) || start[-1] == '.'))
		start--;
	const double edge = strtod(start, NULL);
	if (!(edge > 0))
		return;
	name->spacing[0] = name->spacing[1] = name->spacing[2] = edge;
	name->has_spacing = true;
}

void gz_raw_name_read(const char *path, struct gz_raw_name *out_name)
{
	*out_name = (struct gz_raw_name) { .spacing = { 1, 1, 1 } };
	take_text(path, out_name->text);
	take_numbers(out_name);
	take_type(out_name);
	take_order(out_name);
	take_spacing(out_name);
}

size_t gz_raw_types_of_bits(int bits, int out_types[GZ_RAW_NAMED_TYPES])
{
	static const struct {
		int bits, types[GZ_RAW_NAMED_TYPES];
	} rows[] = {
		{ 8, { GZ_RAW_UINT8, GZ_RAW_INT8, -1 } },
		{ 16, { GZ_RAW_UINT16, GZ_RAW_INT16, -1 } },
		{ 32, { GZ_RAW_FLOAT32, GZ_RAW_INT32, GZ_RAW_UINT32 } },
		{ 64, { GZ_RAW_FLOAT64, -1, -1 } },
	};
	size_t count = 0;
	for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++)
		for (size_t k = 0; k < GZ_RAW_NAMED_TYPES; k++)
			if (rows[i].bits == bits && rows[i].types[k] >= 0)
				out_types[count++] = rows[i].types[k];
	return count;
}
