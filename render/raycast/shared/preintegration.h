/**
 * @file
 * The pre-integrated tables of a backend, made when a frame first asks for a step length.
 */
#ifndef GZ_RENDER_RAYCAST_SHARED_PREINTEGRATION_H
#define GZ_RENDER_RAYCAST_SHARED_PREINTEGRATION_H

#include "render/plan/plan.h"
#include "render/transfer/transfer_preintegrated.h"

/** Zero-initialised holds nothing. */
struct gz_preintegration {
	bool summed;
	struct gz_transfer_sums *sums;
	struct gz_transfer_entry *extinction;
	double length[GZ_PLAN_STEPS_MAX]; /**< of the tables, voxel lengths; 0 = none */
	struct gz_transfer_entry *step[GZ_PLAN_STEPS_MAX];
};

/** The transfer function has changed; memory is kept. */
void gz_preintegration_forget(struct gz_preintegration *preintegration);

/** Make the tables of some step lengths unless they are there, and that for any length.
 *  GZ_ERR_NO_MEM: some tables are missing, those there are right. */
enum gz_result gz_preintegration_make(struct gz_preintegration *preintegration,
				      const struct gz_transfer_table *table, const double lengths[],
				      int count, struct gz_workers *workers);

/** Free and zero. */
void gz_preintegration_free(struct gz_preintegration *preintegration);

#endif
