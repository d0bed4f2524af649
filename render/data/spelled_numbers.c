#include "render/data/spelled_numbers.h"

#include <ctype.h>
#include <math.h>
#include <string.h>
#include <strings.h>

#include "base/text.h"
#include "render/data/volume_import.h"

#define GZ_LOG_MODULE "volume"

/* More digits may not fit a double exactly. */
#define EXACT_DIGITS 15

/* What numbers of a type may be. Floats: anything. */
static const struct {
	double least, greatest;
} integer_ranges[GZ_RAW_TYPE_COUNT] = {
	[GZ_RAW_UINT8] = { 0, UINT8_MAX },   [GZ_RAW_INT8] = { INT8_MIN, INT8_MAX },
	[GZ_RAW_UINT16] = { 0, UINT16_MAX }, [GZ_RAW_INT16] = { INT16_MIN, INT16_MAX },
	[GZ_RAW_UINT32] = { 0, UINT32_MAX }, [GZ_RAW_INT32] = { INT32_MIN, INT32_MAX },
};

/* The next character; -1 at the end. */
static enum gz_result next_character(struct gz_spelled_numbers *numbers, int *out_character)
{
	if (numbers->at == numbers->size) {
		numbers->at = numbers->size = 0;
		const enum gz_result result =
			gz_byte_stream_read(numbers->bytes, numbers->characters,
					    sizeof numbers->characters, &numbers->size);
		if (result != GZ_OK)
			return result;
	}
	*out_character = numbers->at < numbers->size
				 ? (unsigned char)numbers->characters[numbers->at++]
				 : -1;
	return GZ_OK;
}

static enum gz_result refuse_word(const struct gz_spelled_numbers *numbers, const char *word)
{
	gz_err(numbers->log, "%s: number %llu, \"%.20s\", does not fit %s", numbers->path,
	       (unsigned long long)numbers->count + 1, word, gz_raw_type_names[numbers->type]);
	return GZ_ERR_FORMAT;
}

static bool is_separator(int character)
{
	return character == ',' || isspace(character);
}

/* The next word, empty at the end. */
static enum gz_result next_word(struct gz_spelled_numbers *numbers,
				char word[GZ_SPELLED_WORD_MAX + 1])
{
	size_t length = 0;
	int character = ' ';
	enum gz_result result = GZ_OK;
	while (result == GZ_OK && is_separator(character))
		result = next_character(numbers, &character);
	while (result == GZ_OK && character >= 0 && !is_separator(character)) {
		word[length < GZ_SPELLED_WORD_MAX ? length : GZ_SPELLED_WORD_MAX] = (char)character;
		if (length++ == GZ_SPELLED_WORD_MAX) {
			word[GZ_SPELLED_WORD_MAX] = '\0';
			return refuse_word(numbers, word);
		}
		result = next_character(numbers, &character);
	}
	word[length] = '\0';
	return result == GZ_OK && strlen(word) < length ? refuse_word(numbers, word) : result;
}

/* Digits alone, which most words are. */
static bool parse_digits(const char *word, double *out_value)
{
	const bool negative = word[0] == '-';
	const char *digits = word + negative;
	const size_t count = strspn(digits, "0123456789");
	int64_t value = 0;
	if (count < 1 || count > EXACT_DIGITS || digits[count])
		return false;
	for (size_t i = 0; i < count; i++)
		value = 10 * value + (digits[i] - '0');
	*out_value = (double)(negative ? -value : value);
	return true;
}

static bool parse_not_finite(const char *word, double *out_value)
{
	const bool negative = word[0] == '-';
	const char *name = word + (negative || word[0] == '+');
	const bool is_nan = strcasecmp(name, "nan") == 0;
	if (!is_nan && strcasecmp(name, "inf") != 0 && strcasecmp(name, "infinity") != 0)
		return false;
	*out_value = is_nan ? (double)NAN : negative ? (double)-INFINITY : (double)INFINITY;
	return true;
}

static bool parse_spelled(const char *word, enum gz_raw_type type, double *out_value)
{
	const bool real = type == GZ_RAW_FLOAT32 || type == GZ_RAW_FLOAT64;
	if (!parse_digits(word, out_value) && !gz_number_parse(word, out_value) &&
	    !(real && parse_not_finite(word, out_value)))
		return false;
	return real ||
	       (*out_value == rint(*out_value) && *out_value >= integer_ranges[type].least &&
		*out_value <= integer_ranges[type].greatest);
}

/* Integers wrap to their two's complement. A double beyond float is an infinity, as if converted.
 */
static void put_spelled(double value, enum gz_raw_type type, uint8_t *out)
{
	const size_t size = gz_raw_type_size(type);
	const uint32_t word = type < GZ_RAW_FLOAT32 ? (uint32_t)(int64_t)value : 0;
	const uint16_t half = (uint16_t)word;
	const float real = (float)value;
	if (type == GZ_RAW_FLOAT64)
		memcpy(out, &value, sizeof value);
	else if (type == GZ_RAW_FLOAT32)
		memcpy(out, &real, sizeof real);
	else if (size == sizeof word)
		memcpy(out, &word, sizeof word);
	else if (size == sizeof half)
		memcpy(out, &half, sizeof half);
	else
		out[0] = (uint8_t)word;
}

enum gz_result gz_spelled_text_read(void *user, void *buffer, size_t size, size_t *out_got)
{
	struct gz_spelled_numbers *numbers = user;
	const size_t each = gz_raw_type_size(numbers->type);
	size_t got = 0;
	while (got + each <= size) {
		char word[GZ_SPELLED_WORD_MAX + 1];
		double value;
		const enum gz_result result = next_word(numbers, word);
		if (result != GZ_OK)
			return result;
		if (!word[0])
			break;
		if (!parse_spelled(word, numbers->type, &value))
			return refuse_word(numbers, word);
		put_spelled(value, numbers->type, (uint8_t *)buffer + got);
		numbers->count++;
		got += each;
	}
	*out_got = got;
	return GZ_OK;
}

static int hex_digit(int character)
{
	return isdigit(character) ? character - '0' : tolower(character) - 'a' + 10;
}

/* The next digit that is not blank; -1 at the end. */
static enum gz_result next_hex_digit(struct gz_spelled_numbers *numbers, int *out_digit)
{
	int character = ' ';
	enum gz_result result = GZ_OK;
	while (result == GZ_OK && character >= 0 && isspace(character))
		result = next_character(numbers, &character);
	if (result != GZ_OK)
		return result;
	if (character >= 0 && !isxdigit(character)) {
		gz_err(numbers->log, "%s: byte %llu: not two hexadecimal digits", numbers->path,
		       (unsigned long long)numbers->count + 1);
		return GZ_ERR_FORMAT;
	}
	*out_digit = character < 0 ? -1 : hex_digit(character);
	return GZ_OK;
}

enum gz_result gz_spelled_hex_read(void *user, void *buffer, size_t size, size_t *out_got)
{
	struct gz_spelled_numbers *numbers = user;
	uint8_t *out = buffer;
	size_t got = 0;
	while (got < size) {
		int high = -1, low = -1;
		enum gz_result result = next_hex_digit(numbers, &high);
		if (result == GZ_OK && high >= 0)
			result = next_hex_digit(numbers, &low);
		if (result != GZ_OK)
			return result;
		if (high < 0 || low < 0)
			break;
		out[got++] = (uint8_t)(high << 4 | low);
		numbers->count++;
	}
	*out_got = got;
	return GZ_OK;
}
