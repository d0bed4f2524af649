#include "bench/report/published_times.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

/* published_times.json, embedded. */
extern const char gz_published_times_json[];

json_t *gz_published_times(void)
{
	json_t *all = json_loads(gz_published_times_json, JSON_REJECT_DUPLICATES, NULL);
	json_t *sources = json_incref(json_object_get(all, "sources"));
	for (size_t i = 0; i < json_array_size(sources); i++) {
		json_t *rows = json_object_get(json_array_get(sources, i), "rows");
		for (size_t k = 0; k < json_array_size(rows); k++)
			if (!json_object_get(json_array_get(rows, k), "slices"))
				json_object_set_new(json_array_get(rows, k), "slices",
						    json_integer(0));
	}
	json_decref(all);
	return sources;
}

static bool says(const json_t *row, const char *key, const char *text)
{
	const char *value = json_string_value(json_object_get(row, key));
	return value && strcmp(value, text) == 0;
}

double gz_published_ms(const json_t *source, size_t machine, const char *technique,
		       const char *effect, int slices)
{
	const json_t *rows = json_object_get(source, "rows");
	for (size_t i = 0; i < json_array_size(rows); i++) {
		const json_t *row = json_array_get(rows, i);
		const json_t *number = json_array_get(json_object_get(row, "frame_ms"), machine);
		if (says(row, "technique", technique) && says(row, "effect", effect) &&
		    json_integer_value(json_object_get(row, "slices")) == slices && number)
			return json_number_value(number);
	}
	return NAN;
}
