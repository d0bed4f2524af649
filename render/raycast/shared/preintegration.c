#include "render/raycast/shared/preintegration.h"

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
