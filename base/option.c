#include "base/option.h"

#include <stdlib.h>
#include <string.h>

#include "base/option_internal.h"

enum gz_result gz_options_preset(const struct gz_option_binding *binding)
{
	enum gz_result result = GZ_OK;
	for (size_t i = 0; i < binding->count; i++) {
		const struct gz_option *option = &binding->options[i];
		if (!option->preset)
			continue;
		enum gz_result parsed =
			gz_option_parse(option, option->preset, binding->target, NULL, 0);
		if (parsed != GZ_OK)
			result = parsed;
	}
	return result;
}

const struct gz_option *gz_options_find(const struct gz_option_binding *bindings, size_t count,
					const char *key, size_t *out_binding)
{
	for (size_t b = 0; b < count; b++) {
		for (size_t i = 0; i < bindings[b].count; i++) {
			if (strcmp(bindings[b].options[i].key, key) != 0)
				continue;
			if (out_binding)
				*out_binding = b;
			return &bindings[b].options[i];
		}
	}
	return NULL;
}

/* Longest key compared by edit distance, with its NUL; chosen, no table comes near it. */
enum { NEAR_KEY_SIZE = 64 };

/* Levenshtein distance by one row: Wagner and Fischer, "The String-to-String Correction Problem",
 * J. ACM 21(1), 1974, algorithm X. */
static size_t edit_distance(const char *a, const char *b)
{
	size_t row[NEAR_KEY_SIZE];
	size_t width = strlen(b);
	for (size_t j = 0; j <= width; j++)
		row[j] = j;
	for (size_t i = 0; a[i]; i++) {
		size_t diagonal = row[0];
		row[0] = i + 1;
		for (size_t j = 0; j < width; j++) {
			size_t best = diagonal + (a[i] != b[j]);
			if (row[j + 1] + 1 < best)
				best = row[j + 1] + 1;
			if (row[j] + 1 < best)
				best = row[j] + 1;
			diagonal = row[j + 1];
			row[j + 1] = best;
		}
	}
	return row[width];
}

static const char *after_section(const char *key)
{
	const char *dot = strrchr(key, '.');
	return dot ? dot + 1 : key;
}

const char *gz_options_nearest(const struct gz_option_binding *bindings, size_t count,
			       const char *key)
{
	const char *nearest = NULL;
	/* Near means at most a third of the key mistyped, at least two letters; chosen. */
	size_t least = strlen(key) / 3 > 2 ? strlen(key) / 3 : 2;
	if (strlen(key) >= NEAR_KEY_SIZE)
		return NULL;
	for (size_t b = 0; b < count; b++) {
		for (size_t i = 0; i < bindings[b].count; i++) {
			const char *known = bindings[b].options[i].key;
			if (strlen(known) >= NEAR_KEY_SIZE)
				continue;
			size_t distance = edit_distance(key, known);
			/* The right name without its section, or under a wrong one, is a near miss.
			 */
			if (strcmp(after_section(key), after_section(known)) == 0 && distance > 1)
				distance = 1;
			if (distance > least || (nearest && distance == least))
				continue;
			least = distance;
			nearest = known;
		}
	}
	return nearest;
}

enum gz_result gz_option_reader_init(struct gz_option_reader *reader,
				     const struct gz_option_binding *bindings, size_t count)
{
	size_t options = 0;
	for (size_t b = 0; b < count; b++)
		options += bindings[b].count;
	int *places = calloc(options + 1, sizeof *places);
	if (!places)
		return GZ_ERR_NO_MEM;
	*reader = (struct gz_option_reader) {
		.bindings = bindings,
		.count = count,
		.first_place = places,
	};
	return GZ_OK;
}

void gz_option_reader_free(struct gz_option_reader *reader)
{
	free(reader->first_place);
	reader->first_place = NULL;
}

static void refuse_unknown(const struct gz_option_reader *reader, const char *key, char *message,
			   size_t message_size)
{
	const char *near = gz_options_nearest(reader->bindings, reader->count, key);
	if (near)
		snprintf(message, message_size, "unknown key; did you mean %s?", near);
	else
		snprintf(message, message_size, "unknown key; --help lists them all");
}

enum gz_result gz_option_reader_set(struct gz_option_reader *reader, const char *key,
				    const char *text, int place, int *out_first, char *message,
				    size_t message_size)
{
	size_t b = 0;
	const struct gz_option *option = gz_options_find(reader->bindings, reader->count, key, &b);
	*out_first = 0;
	if (!option) {
		refuse_unknown(reader, key, message, message_size);
		return GZ_ERR_NOT_FOUND;
	}

	size_t index = (size_t)(option - reader->bindings[b].options);
	int *first = &reader->first_place[index];
	for (size_t before = 0; before < b; before++)
		first += reader->bindings[before].count;
	if (*first) {
		*out_first = *first;
		snprintf(message, message_size, "given twice; keep one of the two");
		return GZ_ERR_INVAL;
	}

	enum gz_result result =
		gz_option_parse(option, text, reader->bindings[b].target, message, message_size);
	if (result != GZ_OK)
		return result;
	*first = place;
	if (reader->bindings[b].given)
		reader->bindings[b].given[index] = true;
	return GZ_OK;
}
