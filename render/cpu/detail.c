#include "render/cpu/detail.h"

#define GZ_LOG_MODULE "cpu"

enum gz_result gz_detail_start(struct gz_detail *detail, const struct gz_volume *volume)
{
	gz_detail_free(detail);
	const enum gz_result result = gz_macrocells_build(volume, &detail->cells[0]);
	if (result == GZ_OK)
		gz_levels_start(&detail->levels, volume);
	return result;
}

void gz_detail_classify(struct gz_detail *detail, const struct gz_transfer_table *table)
{
	for (int i = 0; i < detail->levels.count; i++)
		gz_macrocells_classify(&detail->cells[i], table);
}

static enum gz_result build(struct gz_detail *detail, struct gz_workers *workers,
			    const struct gz_transfer_table *table)
{
	enum gz_result result = gz_levels_build(&detail->levels, workers);
	for (int i = 1; i < detail->levels.count && result == GZ_OK; i++) {
		result = gz_macrocells_build(&detail->levels.level[i].volume, &detail->cells[i]);
		if (result == GZ_OK)
			gz_macrocells_classify(&detail->cells[i], table);
	}
	return result;
}

void gz_detail_make_levels(struct gz_detail *detail, struct gz_workers *workers,
			   const struct gz_transfer_table *table, const struct gz_log *log)
{
	if (detail->levels.count != 1 || detail->failed)
		return;
	if (build(detail, workers, table) == GZ_OK)
		return;
	gz_warn(log, "no memory for coarser levels of the volume: all rays take the full one");
	detail->failed = true;
	const struct gz_volume volume = detail->levels.level[0].volume;
	gz_levels_start(&detail->levels, &volume);
	for (int i = 1; i < GZ_LEVELS_MAX; i++)
		gz_macrocells_free(&detail->cells[i]);
}

void gz_detail_free(struct gz_detail *detail)
{
	gz_levels_free(&detail->levels);
	for (int i = 0; i < GZ_LEVELS_MAX; i++)
		gz_macrocells_free(&detail->cells[i]);
	*detail = (struct gz_detail) { 0 };
}
