#include "render/raycast/cpu/faded_light.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/light/light_cells.h"

#define GZ_LOG_MODULE "render"

/* Units of a share when cells are blended: the product with a cell fits into 32 bits. */
#define SHARE_UNIT 65536U

static void forget_grids(struct gz_faded_grids *grids)
{
	gz_lighting_forget(&grids->lighting);
	gz_light_grid_forget(&grids->light_grid);
}

/* What is shown is no longer blended of the ends. */
static void forget_shown(struct gz_faded_light *light)
{
	forget_grids(&light->shown);
	memset(light->occlusion_of, 0, sizeof light->occlusion_of);
	memset(light->shadows_of, 0, sizeof light->shadows_of);
	memset(light->light_of, 0, sizeof light->light_of);
}

static void forget_end(struct gz_faded_light *light, int end)
{
	forget_grids(&light->ends[end]);
	light->baked[end] = false;
}

void gz_faded_light_forget(struct gz_faded_light *light)
{
	forget_shown(light);
	for (int end = 0; end < 2; end++)
		forget_end(light, end);
	light->known = false;
}

/* The end that a function is; -1: it lies between them. */
static int end_of(const struct gz_transfer *transfer)
{
	const double share = transfer->emphasis.share;
	return share <= 0 ? 0 : share >= 1 ? 1 : -1;
}

/* Let what is shown and an end change places. Serials only grow, so that no copy elsewhere is taken
 * for current. */
static void swap_with_end(struct gz_faded_light *light, int end)
{
	struct gz_faded_grids *shown = &light->shown, *other = &light->ends[end];
	const uint64_t serials[3] = {
		shown->lighting.serial + other->lighting.serial + 1,
		shown->lighting.shadow_serial + other->lighting.shadow_serial + 1,
		shown->light_grid.serial + other->light_grid.serial + 1,
	};
	const struct gz_faded_grids held = *shown;
	*shown = *other;
	*other = held;
	shown->lighting.serial = other->lighting.serial = serials[0];
	shown->lighting.shadow_serial = other->lighting.shadow_serial = serials[1];
	shown->light_grid.serial = other->light_grid.serial = serials[2];
}

static bool same_but_emphasis(const struct gz_transfer *a, const struct gz_transfer *b)
{
	struct gz_transfer other = *b;
	other.emphasis = a->emphasis;
	return gz_transfer_same(a, &other);
}

bool gz_faded_light_set_transfer(struct gz_faded_light *light, const struct gz_transfer *transfer)
{
	const struct gz_transfer_emphasis *emphasis = &transfer->emphasis;
	const bool same = light->known && same_but_emphasis(&light->transfer, transfer);
	if (!same)
		gz_faded_light_forget(light);
	else if (end_of(&light->transfer) >= 0)
		swap_with_end(light, end_of(&light->transfer));
	forget_shown(light);
	if (emphasis->share > 0 &&
	    (light->least != emphasis->least || light->greatest != emphasis->greatest)) {
		forget_end(light, 1);
		light->least = emphasis->least;
		light->greatest = emphasis->greatest;
	}
	light->transfer = *transfer;
	light->known = true;
	if (end_of(transfer) >= 0)
		swap_with_end(light, end_of(transfer));
	return same;
}

/* Bake the table of an end. */
static enum gz_result bake_end(struct gz_faded_light *light, const struct gz_volume *volume,
			       int end)
{
	if (light->baked[end])
		return GZ_OK;
	if (!light->tables[end])
		light->tables[end] = malloc(sizeof *light->tables[end]);
	if (!light->tables[end])
		return GZ_ERR_NO_MEM;
	struct gz_transfer transfer = light->transfer;
	transfer.emphasis.share = end;
	gz_transfer_table_bake(&transfer, volume, light->tables[end]);
	light->baked[end] = true;
	return GZ_OK;
}

static enum gz_result prepare_ends(struct gz_faded_light *light, const struct gz_volume *volume,
				   const struct gz_ray_params *rays, struct gz_workers *workers,
				   const struct gz_log *log)
{
	for (int end = 0; end < 2; end++) {
		struct gz_lighting *lighting = &light->ends[end].lighting;
		enum gz_result result = bake_end(light, volume, end);
		if (result == GZ_OK)
			result = gz_lighting_prepare(lighting, volume, light->tables[end], rays,
						     workers, log);
		else
			gz_err(log, "no memory for tables of the transfer function");
		if (result != GZ_OK)
			return result;
		light->shown.lighting.spent_ms += gz_lighting_take_spent_ms(lighting);
	}
	return GZ_OK;
}

static uint32_t weight_of(const struct gz_faded_light *light)
{
	return (uint32_t)lrint(light->transfer.emphasis.share * SHARE_UNIT);
}

static void blend_cells(const uint16_t *restrict plain, const uint16_t *restrict raised,
			size_t count, uint32_t weight, uint16_t *restrict out_cells)
{
	for (size_t i = 0; i < count; i++)
		out_cells[i] = (uint16_t)((plain[i] * (SHARE_UNIT - weight) + raised[i] * weight +
					   SHARE_UNIT / 2) /
					  SHARE_UNIT);
}

/* Whether a grid is blended of those that the ends have now. */
static bool is_blended(const uint64_t of[2], uint64_t plain, uint64_t raised)
{
	return of[0] == plain && of[1] == raised;
}

static void note_blended(uint64_t of[2], uint64_t plain, uint64_t raised)
{
	of[0] = plain;
	of[1] = raised;
}

static size_t count_cells(const int dims[3])
{
	return (size_t)dims[0] * (size_t)dims[1] * (size_t)dims[2];
}

static enum gz_result blend_occlusion(struct gz_faded_light *light)
{
	const struct gz_lighting *plain = &light->ends[0].lighting;
	const struct gz_lighting *raised = &light->ends[1].lighting;
	struct gz_lighting *shown = &light->shown.lighting;
	struct gz_occlusion *out = &shown->occlusion;
	const size_t count = count_cells(plain->occlusion.dims);
	if (is_blended(light->occlusion_of, plain->serial, raised->serial))
		return GZ_OK;
	if (gz_light_cells_reserve(count, &out->cells, &out->capacity) != GZ_OK)
		return GZ_ERR_NO_MEM;
	memcpy(out->dims, plain->occlusion.dims, sizeof out->dims);
	memcpy(out->edge, plain->occlusion.edge, sizeof out->edge);
	blend_cells(plain->occlusion.cells, raised->occlusion.cells, count, weight_of(light),
		    out->cells);
	note_blended(light->occlusion_of, plain->serial, raised->serial);
	shown->current = true;
	shown->serial++;
	return GZ_OK;
}

static enum gz_result blend_shadows(struct gz_faded_light *light)
{
	const struct gz_lighting *plain = &light->ends[0].lighting;
	const struct gz_lighting *raised = &light->ends[1].lighting;
	struct gz_lighting *shown = &light->shown.lighting;
	const struct gz_shadow_level *last = &plain->shadows.level[plain->shadows.count - 1];
	const size_t count = last->first + count_cells(last->dims);
	struct gz_shadow_cells blended = plain->shadows;
	if (is_blended(light->shadows_of, plain->shadow_serial, raised->shadow_serial))
		return GZ_OK;
	blended.cells = shown->shadows.cells;
	blended.capacity = shown->shadows.capacity;
	const enum gz_result result =
		gz_light_cells_reserve(count, &blended.cells, &blended.capacity);
	shown->shadows = blended;
	if (result != GZ_OK)
		return result;
	blend_cells(plain->shadows.cells, raised->shadows.cells, count, weight_of(light),
		    blended.cells);
	note_blended(light->shadows_of, plain->shadow_serial, raised->shadow_serial);
	shown->shadow_serial++;
	return GZ_OK;
}

enum gz_result gz_faded_light_prepare(struct gz_faded_light *light, const struct gz_volume *volume,
				      const struct gz_transfer_table *table,
				      const struct gz_ray_params *rays, struct gz_workers *workers,
				      const struct gz_log *log)
{
	struct gz_lighting *shown = &light->shown.lighting;
	if (end_of(&light->transfer) >= 0)
		return gz_lighting_prepare(shown, volume, table, rays, workers, log);
	enum gz_result result = prepare_ends(light, volume, rays, workers, log);
	if (result != GZ_OK)
		return result;
	shown->volume = volume;
	shown->table = table;
	if (gz_lighting_wants_occlusion(rays))
		result = blend_occlusion(light);
	if (result == GZ_OK && rays->light.shadow_steps > 0)
		result = blend_shadows(light);
	if (result != GZ_OK)
		gz_err(log, "no memory for light: set light.occlusion and light.shadow_steps to 0");
	return result;
}

static enum gz_result blend_grid(struct gz_faded_light *light)
{
	const struct gz_light_grid *plain = &light->ends[0].light_grid;
	const struct gz_light_grid *raised = &light->ends[1].light_grid;
	struct gz_light_grid *out = &light->shown.light_grid;
	const size_t count = count_cells(plain->dims);
	if (is_blended(light->light_of, plain->serial, raised->serial))
		return GZ_OK;
	if (gz_light_cells_reserve(count, &out->cells, &out->capacity) != GZ_OK)
		return GZ_ERR_NO_MEM;
	memcpy(out->dims, plain->dims, sizeof out->dims);
	memcpy(out->edge, plain->edge, sizeof out->edge);
	blend_cells(plain->cells, raised->cells, count, weight_of(light), out->cells);
	note_blended(light->light_of, plain->serial, raised->serial);
	out->serial++;
	return GZ_OK;
}

enum gz_result gz_faded_light_make_grid(struct gz_faded_light *light,
					const struct gz_light_grid_request *request)
{
	struct gz_light_grid_request wanted = *request;
	if (end_of(&light->transfer) >= 0) {
		wanted.lighting = &light->shown.lighting;
		return gz_light_grid_make(&wanted, &light->shown.light_grid);
	}
	for (int end = 0; end < 2; end++) {
		wanted.lighting = &light->ends[end].lighting;
		const enum gz_result result =
			gz_light_grid_make(&wanted, &light->ends[end].light_grid);
		if (result != GZ_OK)
			return result;
	}
	const enum gz_result result = blend_grid(light);
	if (result != GZ_OK)
		gz_err(request->log, "no memory for shadows: set light.shadow_steps to 0");
	return result;
}

void gz_faded_light_free(struct gz_faded_light *light)
{
	struct gz_faded_grids *const all[] = { &light->shown, &light->ends[0], &light->ends[1] };
	for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
		gz_lighting_free(&all[i]->lighting);
		gz_light_grid_free(&all[i]->light_grid);
	}
	for (int end = 0; end < 2; end++)
		free(light->tables[end]);
	*light = (struct gz_faded_light) { 0 };
}
