#include "render/illustration/stipple_view.h"

#include <math.h>
#include <stdlib.h>

#include "render/plan/plan.h"

static bool plane_fits(const struct gz_plane *plane, enum gz_plane_kind kind,
		       const struct gz_plane *tone)
{
	return plane && plane->kind == kind && plane->words && plane->width == tone->width &&
	       plane->height == tone->height;
}

bool gz_stipple_view_valid(const struct gz_stipple_view *view)
{
	return view->rays && view->world_per_mm > 0 && isfinite(view->world_per_mm) &&
	       view->size_px >= 0.25 && view->size_px <= 64 && view->tolerance_px > 0 &&
	       view->tone && plane_fits(view->tone, GZ_PLANE_VALUE, view->tone) &&
	       plane_fits(view->depth, GZ_PLANE_VALUE, view->tone) &&
	       (!view->ids || plane_fits(view->ids, GZ_PLANE_ID, view->tone));
}

enum gz_result gz_stipple_scale_make(const struct gz_foveation *foveation,
				     const struct gz_display *display, struct gz_point gaze,
				     int width, int height, struct gz_stipple_scale *scale)
{
	const int columns = (width - 1) / GZ_STIPPLE_SCALE_STEP_PX + 2;
	const int rows = (height - 1) / GZ_STIPPLE_SCALE_STEP_PX + 2;
	const size_t count = (size_t)columns * (size_t)rows;
	if (count > scale->capacity) {
		float *factors = malloc(count * sizeof *factors);
		if (!factors)
			return GZ_ERR_NO_MEM;
		free(scale->factors);
		scale->factors = factors;
		scale->capacity = count;
	}
	scale->columns = columns;
	scale->rows = rows;
	float *factor = scale->factors;
	for (int y = 0; y < rows; y++)
		for (int x = 0; x < columns; x++) {
			const struct gz_point at = {
				(float)(x * GZ_STIPPLE_SCALE_STEP_PX) / (float)width,
				(float)(y * GZ_STIPPLE_SCALE_STEP_PX) / (float)height,
			};
			*factor++ = (float)fmax(1, gz_acuity_spacing_px(foveation, display, gaze,
									at, width, height));
		}
	return GZ_OK;
}

/* The lattice's interval that a place lies in, and its share of the way. */
static int find_interval(float at, int points, float *out_share)
{
	const float u = at / GZ_STIPPLE_SCALE_STEP_PX;
	int low = u > 0 ? (int)u : 0;
	low = low < points - 2 ? low : points - 2;
	const float share = u - (float)low;
	*out_share = share < 0 ? 0 : share > 1 ? 1 : share;
	return low;
}

float gz_stipple_scale_at(const struct gz_stipple_scale *scale, float x, float y)
{
	if (!scale || !scale->factors)
		return 1;
	float right, down;
	const int column = find_interval(x, scale->columns, &right);
	const int row = find_interval(y, scale->rows, &down);
	const float *above = scale->factors + (size_t)row * (size_t)scale->columns + column;
	const float *below = above + scale->columns;
	const float upper = above[0] + right * (above[1] - above[0]);
	const float lower = below[0] + right * (below[1] - below[0]);
	return upper + down * (lower - upper);
}

void gz_stipple_scale_free(struct gz_stipple_scale *scale)
{
	free(scale->factors);
	*scale = (struct gz_stipple_scale) { 0 };
}
