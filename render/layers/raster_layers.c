#include "render/layers/raster_layers.h"

#include <string.h>

static int greater(int a, int b)
{
	return a > b ? a : b;
}

static int lesser(int a, int b)
{
	return a < b ? a : b;
}

/* The lattice that covers a rectangle and its band, along one axis of a picture of `size` px. */
static void cover_axis(struct gz_raster_layer *layer, int axis, int size)
{
	const int spacing = layer->spacing;
	const int least = greater(layer->solid[0][axis] - layer->band, 0);
	const int last = lesser(layer->solid[1][axis] + layer->band, size) - 1;
	layer->from[axis] = least - least % spacing;
	/* Every pixel lies between two points. */
	layer->points[axis] = (last - layer->from[axis] + spacing - 1) / spacing + 1;
}

/* A point colours the pixels less than a spacing away. Those within the solid rectangle of the
 * finer layer do not show it. */
static void hide_axis(struct gz_raster_layer *layer, const struct gz_raster_layer *finer, int axis,
		      int size)
{
	const int spacing = layer->spacing;
	const int from = finer->solid[0][axis], to = finer->solid[1][axis];
	int *hidden_from = &layer->hidden[0][axis], *hidden_to = &layer->hidden[1][axis];
	*hidden_from = greater(from - layer->from[axis] + 2 * (spacing - 1), 0) / spacing;
	*hidden_to = greater(to - layer->from[axis], 0) / spacing;
	if (from <= 0)
		*hidden_from = 0;
	if (to >= size)
		*hidden_to = layer->points[axis];
	*hidden_to = lesser(*hidden_to, layer->points[axis]);
}

int gz_raster_layers_make(const struct gz_plan *plan,
			  struct gz_raster_layer out_layers[GZ_PLAN_RECTANGLES_MAX])
{
	struct gz_plan_rectangle rectangles[GZ_PLAN_RECTANGLES_MAX];
	const int count = gz_plan_rectangles(plan, rectangles);
	const int size[2] = { plan->width, plan->height };
	for (int i = 0; i < count; i++) {
		struct gz_raster_layer *layer = &out_layers[i];
		*layer = (struct gz_raster_layer) {
			.spacing = rectangles[i].spacing,
			.band = i > 0 ? GZ_RASTER_BAND_SPACINGS * rectangles[i - 1].spacing : 0,
		};
		memcpy(layer->solid[0], rectangles[i].from, sizeof layer->solid[0]);
		memcpy(layer->solid[1], rectangles[i].to, sizeof layer->solid[1]);
		for (int axis = 0; axis < 2; axis++)
			cover_axis(layer, axis, size[axis]);
	}
	for (int i = 0; i + 1 < count; i++)
		for (int axis = 0; axis < 2; axis++)
			hide_axis(&out_layers[i], &out_layers[i + 1], axis, size[axis]);
	return count;
}

/* How far a number lies outside of [from, to). */
static int outside(int number, int from, int to)
{
	return greater(greater(from - number, number - to + 1), 0);
}

float gz_raster_layer_share(const struct gz_raster_layer *layer, int x, int y)
{
	const int away = greater(outside(x, layer->solid[0][0], layer->solid[1][0]),
				 outside(y, layer->solid[0][1], layer->solid[1][1]));
	const float along = (float)lesser(away, layer->band + 1) / (float)(layer->band + 1);
	return 1 - along * along * (3 - 2 * along);
}

uint64_t gz_raster_layer_drawn(const struct gz_raster_layer *layer)
{
	uint64_t hidden = 1;
	for (int axis = 0; axis < 2; axis++)
		hidden *= (uint64_t)greater(layer->hidden[1][axis] - layer->hidden[0][axis], 0);
	return (uint64_t)layer->points[0] * (uint64_t)layer->points[1] - hidden;
}
