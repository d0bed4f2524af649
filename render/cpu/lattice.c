#include "render/cpu/lattice.h"

#include <stdlib.h>

/* Room behind each lattice, so that wide loads at its end stay inside. */
enum { PADDING_POINTS = 32 };

/* The first layer of spacing 1. A second one, by odd parameters, has room of its own, so that no
 * two threads write one pixel. */
static bool lies_in_picture(const struct gz_plan *plan, int layer)
{
	for (int earlier = 0; earlier < layer; earlier++)
		if (plan->layers[earlier].spacing == 1)
			return false;
	return plan->layers[layer].spacing == 1;
}

static size_t points_outside_picture(const struct gz_plan *plan)
{
	size_t points = 0;
	for (int i = 0; i < plan->layer_count; i++)
		if (!lies_in_picture(plan, i))
			points += (size_t)plan->layers[i].columns * (size_t)plan->layers[i].rows +
				  PADDING_POINTS;
	return points;
}

enum gz_result gz_lattices_prepare(struct gz_lattices *lattices, const struct gz_plan *plan,
				   struct gz_image *image)
{
	const size_t needed = points_outside_picture(plan);
	if (needed > lattices->capacity) {
		uint32_t *memory = realloc(lattices->memory, needed * sizeof *memory);
		if (!memory)
			return GZ_ERR_NO_MEM;
		lattices->memory = memory;
		lattices->capacity = needed;
	}
	lattices->count = plan->layer_count;
	uint32_t *next = lattices->memory;
	for (int i = 0; i < plan->layer_count; i++) {
		const struct gz_plan_layer *layer = &plan->layers[i];
		struct gz_lattice *lattice = &lattices->layers[i];
		lattice->spacing = layer->spacing;
		lattice->columns = layer->columns;
		lattice->rows = layer->rows;
		lattice->stride = (size_t)layer->columns;
		if (lies_in_picture(plan, i)) {
			/* Pixels are aligned to 64 bytes (image.h). */
			lattice->points = (uint32_t *)(void *)image->pixels;
			continue;
		}
		lattice->points = next;
		next += (size_t)layer->columns * (size_t)layer->rows + PADDING_POINTS;
	}
	return GZ_OK;
}

void gz_lattices_free(struct gz_lattices *lattices)
{
	free(lattices->memory);
	*lattices = (struct gz_lattices) { 0 };
}
