/* Tables of spacings from untrusted bytes: a table that is read keeps the header's promises and
 * makes a plan. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include "render/plan/method.h"
#include "render/plan/plan.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool holds)
{
	if (!holds)
		abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	enum { WIDTH = 150, HEIGHT = 90 };
	static struct gz_plan plan; /* kept, so that its array is not made anew each time */
	struct gz_foveation foveation = gz_foveation_default();
	if (gz_spacing_table_parse("fuzz", (const char *)data, size, NULL, &foveation.table) !=
	    GZ_OK)
		return 0;
	require(gz_spacing_table_valid(&foveation.table));
	const struct gz_display display = gz_display_default(WIDTH, HEIGHT);
	foveation.method = GZ_METHOD_TABLE;
	require(gz_plan_make(&foveation, &display, (struct gz_point) { 0.3F, 0.6F }, WIDTH, HEIGHT,
			     &plan) == GZ_OK);
	require(plan.ray_count > 0 && plan.ray_count <= (uint64_t)2 * WIDTH * HEIGHT);
	for (int i = 0; i < plan.step_count; i++)
		require(plan.steps[i] >= 1 && plan.steps[i] <= 16.001F);
	struct gz_plan_rectangle rectangles[GZ_PLAN_RECTANGLES_MAX];
	const int count = gz_plan_rectangles(&plan, rectangles);
	require(count >= 1 && count <= GZ_PLAN_RECTANGLES_MAX);
	require(rectangles[0].to[0] == WIDTH && rectangles[0].to[1] == HEIGHT);
	return 0;
}
