#include "render/raycast/gl/gl_rounds.h"

#include <stdlib.h>

#include <GL/glew.h>

/* Layer 0 is never asked for: no tile of it can be refined. */
static enum gz_result read_coarser_lattices(struct gz_gl_rounds *rounds,
					    const struct gz_gl_rounds_job *job)
{
	enum gz_result result = GZ_OK;
	glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
	for (int i = 1; i < rounds->lattices.count && result == GZ_OK; i++) {
		const struct gz_lattice *lattice = &rounds->lattices.layers[i];
		result =
			gz_gl_points_read(job->points, job->device, job->gl_plan->layer_first[i],
					  lattice->stride * (size_t)lattice->rows, lattice->points);
	}
	return result;
}

enum gz_result gz_gl_rounds_refine(struct gz_gl_rounds *rounds, const struct gz_gl_rounds_job *job)
{
	struct gz_lattices *lattices = &rounds->lattices;
	struct gz_plan *plan = job->plan;
	enum gz_result result = job->first == 0 ? gz_lattices_prepare(lattices, plan, NULL) : GZ_OK;
	if (result == GZ_OK)
		result = read_coarser_lattices(rounds, job);
	if (result != GZ_OK)
		return result;
	gz_lattices_unmark(lattices, plan, job->first);
	for (size_t i = job->first; i < plan->tile_count; i++)
		gz_lattices_mark(lattices, &plan->tiles[i]);
	size_t first = job->first;
	return gz_contrasts_plan_round(plan, &first, lattices, job->workers, &rounds->contrasts);
}

struct gz_plan gz_gl_rounds_part(const struct gz_plan *plan, size_t first)
{
	struct gz_plan part = *plan;
	part.tiles = plan->tiles + first;
	part.tile_count = plan->tile_count - first;
	part.made_for.valid = false;
	return part;
}

enum gz_result gz_gl_rounds_show(struct gz_gl_rounds *rounds, const struct gz_plan *plan,
				 struct gz_plan *out_shown)
{
	if (plan->tile_count > rounds->shown_capacity) {
		struct gz_tile *grown = realloc(rounds->shown, plan->tile_capacity * sizeof *grown);
		if (!grown)
			return GZ_ERR_NO_MEM;
		rounds->shown = grown;
		rounds->shown_capacity = plan->tile_capacity;
	}
	size_t count = 0;
	for (size_t i = 0; i < plan->tile_count; i++)
		if (!plan->tiles[i].replaced)
			rounds->shown[count++] = plan->tiles[i];
	*out_shown = gz_gl_rounds_part(plan, 0);
	out_shown->tiles = rounds->shown;
	out_shown->tile_count = count;
	return GZ_OK;
}

void gz_gl_rounds_free(struct gz_gl_rounds *rounds)
{
	gz_lattices_free(&rounds->lattices);
	gz_contrasts_free(&rounds->contrasts);
	free(rounds->shown);
	*rounds = (struct gz_gl_rounds) { 0 };
}
