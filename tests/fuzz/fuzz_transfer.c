/* Transfer functions from anywhere: whatever the bytes, what is read keeps the header's promises.
 */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include "render/transfer/transfer.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool holds)
{
	if (!holds)
		abort();
}

static bool is_fraction(double x)
{
	return x >= 0 && x <= 1;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct gz_transfer t;
	double rgba[4];
	if (gz_transfer_parse("fuzz", (const char *)data, size, NULL, &t) != GZ_OK)
		return 0;
	require(t.count >= 1 && t.count <= GZ_TRANSFER_POINTS_MAX);
	require(!t.has_range || t.range[0] < t.range[1]);
	for (size_t i = 0; i < t.count; i++)
		require(is_fraction(t.points[i].value) && is_fraction(t.points[i].opacity));
	for (size_t i = 1; i < t.count; i++)
		require(t.points[i].value >= t.points[i - 1].value);
	for (int i = -1; i <= 33; i++) {
		gz_transfer_evaluate(&t, i / 32.0, rgba);
		for (int c = 0; c < 4; c++)
			require(rgba[c] >= -1e-12 && rgba[c] <= 1 + 1e-12);
	}
	return 0;
}
