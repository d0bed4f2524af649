/**
 * @file
 * The pre-integrated tables of a backend, made when a frame first needs a step length.
 */
#ifndef GZ_RENDER_RAYCAST_SHARED_PREINTEGRATION_H
#define GZ_RENDER_RAYCAST_SHARED_PREINTEGRATION_H

#include "render/plan/plan.h"
#include "render/transfer/transfer_preintegrated.h"

/**
 * Zero-initialised holds nothing.
 *
 * A pair of cells of a table stands for segments between several entries at either end. The opacity
 * is negative where the pair cannot say whether a segment shows anything: only some entries of the
 * cells at its ends are visible, and none between the cells. The segment then shows something only
 * if an entry between its ends, or at either end, is visible (visible_before of struct
 * gz_transfer_table). This holds for the table of extinction, too, which has no marks.
 */
struct gz_preintegration {
	bool summed;
	struct gz_transfer_sums *sums;
	struct gz_transfer_entry *extinction;
	double length[GZ_PLAN_STEPS_MAX]; /**< step of each table, voxel lengths; 0 = no table */
	struct gz_transfer_entry *step[GZ_PLAN_STEPS_MAX];
};

/** The transfer function has changed; memory is kept. */
void gz_preintegration_forget(struct gz_preintegration *preintegration);

/** Make the tables for @p count step lengths, voxel lengths, and the one for any length, unless
 * they exist. GZ_ERR_NO_MEM: some tables are missing, the others are valid. */
enum gz_result gz_preintegration_make(struct gz_preintegration *preintegration,
				      const struct gz_transfer_table *table, const double lengths[],
				      int count, struct gz_workers *workers);

/** Free and zero. */
void gz_preintegration_free(struct gz_preintegration *preintegration);

#endif
