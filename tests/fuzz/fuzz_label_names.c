/* Files of label names from anywhere: what is read keeps the header's promises. */
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "render/mesh/label_names.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool holds)
{
	if (!holds)
		abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct gz_label_names names;
	if (gz_label_names_parse("fuzz", (const char *)data, size, NULL, &names) != GZ_OK)
		return 0;
	require(names.count <= GZ_LABEL_NAMES_MAX);
	for (size_t i = 0; i < names.count; i++) {
		const struct gz_label_name *item = &names.items[i];
		require(i == 0 || names.items[i - 1].number < item->number);
		require(gz_label_names_find(&names, item->number) == item);
		const size_t length = strnlen(item->name, sizeof item->name);
		require(length > 0 && length < sizeof item->name);
		for (int c = 0; c < 3; c++)
			require(!item->has_colour ||
				(item->colour[c] >= 0 && item->colour[c] <= 1));
	}
	gz_label_names_free(&names);
	return 0;
}
