/**
 * @file
 * Occlusion and shadows of a volume some of whose values stand out. While these fade in or out,
 * grids are blended of those without and with all of the emphasis, which are made once: making them
 * anew in each frame would take longer than the frame.
 *
 * A cell's number is (1 - s) a + s b, rounded, with the share s of the emphasis, a of the plain
 * function and b of the one with all of the emphasis. At both ends it is exact. In between it is
 * not quite what the function of that share would have: how much a voxel fills or lets through is
 * no straight line over its opacity.
 */
#ifndef GZ_RENDER_RAYCAST_CPU_FADED_LIGHT_H
#define GZ_RENDER_RAYCAST_CPU_FADED_LIGHT_H

#include <stdbool.h>
#include <stdint.h>

#include "render/raycast/cpu/light_grid.h"
#include "render/raycast/shared/lighting.h"
#include "render/transfer/transfer.h"

/** Grids of one transfer function. */
struct gz_faded_grids {
	struct gz_lighting lighting;
	struct gz_light_grid light_grid;
};

/** Zero-initialised holds nothing. */
struct gz_faded_light {
	struct gz_faded_grids shown; /**< what frames take */
	bool known;                  /**< there is a function: */
	struct gz_transfer transfer;
	double least, greatest; /**< values that stand out in ends[1] */
	/** Without and with all of the emphasis; tables are NULL until a frame needs them. */
	struct gz_faded_grids ends[2];
	struct gz_transfer_table *tables[2];
	bool baked[2];
	/** Serials of what the grids of @ref shown are blended of; 0: of nothing. */
	uint64_t occlusion_of[2], shadows_of[2], light_of[2];
};

/** The volume has changed; memory is kept. */
void gz_faded_light_forget(struct gz_faded_light *light);

/** Use another function, which is copied. @return whether it is the last one but for its emphasis
 */
bool gz_faded_light_set_transfer(struct gz_faded_light *light, const struct gz_transfer *transfer);

/**
 * What gz_lighting_prepare() does, for shown.lighting.
 *
 * @param table  baked of the present function for @p volume; both are borrowed until the next call
 */
enum gz_result gz_faded_light_prepare(struct gz_faded_light *light, const struct gz_volume *volume,
				      const struct gz_transfer_table *table,
				      const struct gz_ray_params *rays, struct gz_workers *workers,
				      const struct gz_log *log);

/** What gz_light_grid_make() does, for shown.light_grid. After gz_faded_light_prepare().
 *
 * @param request  its lighting is not read */
enum gz_result gz_faded_light_make_grid(struct gz_faded_light *light,
					const struct gz_light_grid_request *request);

/** Free and zero. */
void gz_faded_light_free(struct gz_faded_light *light);

#endif
