/* Kept computations of meshes, from anywhere: whatever the bytes, what is taken is finite. The key
 * is the one that the file names, so that the fuzzer gets past it. */
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "render/mesh/cache/mesh_cache.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { KEY_AT = 24 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	float values[12];
	const struct gz_mesh_cache_array arrays[2] = { { values, 5 }, { values + 5, 7 } };
	struct gz_mesh_key key = { { 0 } };
	if (size >= KEY_AT + sizeof key)
		memcpy(&key, data + KEY_AT, sizeof key);
	if (gz_mesh_cache_parse("fuzz", data, size, &key, arrays, 2, NULL) != GZ_OK)
		return 0;
	for (int i = 0; i < 12; i++)
		if (!isfinite(values[i]))
			abort();
	return 0;
}
