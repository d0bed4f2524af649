#include "render/raycast/shared/preintegration.h"

#include <math.h>
#include <stdlib.h>

void gz_preintegration_forget(struct gz_preintegration *preintegration)
{
	preintegration->summed = false;
	for (int i = 0; i < GZ_PLAN_STEPS_MAX; i++)
		preintegration->length[i] = 0;
}

static bool allocate_entries(struct gz_transfer_entry **entries)
{
	if (!*entries)
		*entries = malloc(GZ_PREINTEGRATED_ENTRIES * sizeof **entries);
	return *entries != NULL;
}

static enum gz_result sum_transfer(struct gz_preintegration *preintegration,
				   const struct gz_transfer_table *table,
				   struct gz_workers *workers)
{
	if (!preintegration->sums)
		preintegration->sums = malloc(sizeof *preintegration->sums);
	if (!preintegration->sums || !allocate_entries(&preintegration->extinction))
		return GZ_ERR_NO_MEM;
	gz_transfer_sums_make(table, preintegration->sums);
	gz_transfer_preintegrate_extinction(preintegration->sums, workers,
					    preintegration->extinction);
	preintegration->summed = true;
	return GZ_OK;
}

/* How many entries show something, of the cells from one to the one before another. */
static uint32_t visible_in_cells(const struct gz_transfer_table *table, int from, int to)
{
	const int entries = GZ_PREINTEGRATED_STRIDE(table->count);
	return table->visible_before[to * entries] - table->visible_before[from * entries];
}

static bool cell_is_full(const struct gz_transfer_table *table, int cell)
{
	return visible_in_cells(table, cell, cell + 1) ==
	       (uint32_t)GZ_PREINTEGRATED_STRIDE(table->count);
}

static void negate_opacity(struct gz_transfer_entry *entries, int front, int back)
{
	float *opacity = &entries[(size_t)front * GZ_PREINTEGRATED_SIZE + (size_t)back].opacity;
	*opacity = -fabsf(*opacity);
}

/* Mark the segments between a cell of which only some entries show something and those around it,
 * up to the next one that shows something and with it if it does so in part. */
static void mark_around(const struct gz_transfer_table *table, int cell, int towards,
			struct gz_transfer_entry *entries)
{
	for (int other = cell + towards; other >= 0 && other < GZ_PREINTEGRATED_SIZE;
	     other += towards) {
		if (cell_is_full(table, other))
			return;
		negate_opacity(entries, cell, other);
		negate_opacity(entries, other, cell);
		if (visible_in_cells(table, other, other + 1) > 0)
			return;
	}
}

static void mark_doubtful(const struct gz_transfer_table *table, struct gz_transfer_entry *entries)
{
	for (int cell = 0; cell < GZ_PREINTEGRATED_SIZE; cell++) {
		if (visible_in_cells(table, cell, cell + 1) == 0 || cell_is_full(table, cell))
			continue;
		negate_opacity(entries, cell, cell);
		mark_around(table, cell, -1, entries);
		mark_around(table, cell, 1, entries);
	}
}

enum gz_result gz_preintegration_make(struct gz_preintegration *preintegration,
				      const struct gz_transfer_table *table, const double lengths[],
				      int count, struct gz_workers *workers)
{
	enum gz_result result =
		preintegration->summed ? GZ_OK : sum_transfer(preintegration, table, workers);
	double missing[GZ_PLAN_STEPS_MAX];
	struct gz_transfer_entry *tables[GZ_PLAN_STEPS_MAX];
	int missing_count = 0;
	for (int i = 0; i < count && result == GZ_OK; i++) {
		if (preintegration->length[i] == lengths[i])
			continue;
		if (!allocate_entries(&preintegration->step[i]))
			result = GZ_ERR_NO_MEM;
		preintegration->length[i] = result == GZ_OK ? lengths[i] : 0;
		tables[missing_count] = preintegration->step[i];
		missing[missing_count] = lengths[i];
		missing_count += result == GZ_OK;
	}
	if (missing_count > 0)
		gz_transfer_preintegrate(preintegration->sums, missing, missing_count, workers,
					 tables);
	for (int i = 0; i < missing_count; i++)
		mark_doubtful(table, tables[i]);
	return result;
}

void gz_preintegration_free(struct gz_preintegration *preintegration)
{
	free(preintegration->sums);
	free(preintegration->extinction);
	for (int i = 0; i < GZ_PLAN_STEPS_MAX; i++)
		free(preintegration->step[i]);
	*preintegration = (struct gz_preintegration) { 0 };
}
