/**
 * @file
 * How much of the light arrives where: a grid around the volume, which samples look up instead of
 * walking towards the light each for itself. struct gz_light has the formula.
 */
#ifndef GZ_RENDER_RAYCAST_CPU_LIGHT_GRID_H
#define GZ_RENDER_RAYCAST_CPU_LIGHT_GRID_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "base/workers.h"
#include "render/data/clip_region.h"
#include "render/raycast/cpu/light_walk.h"
#include "render/raycast/shared/macrocells.h"
#include "render/raycast/shared/shadow_cells.h"
#include "render/technique/shade.h"

/** What a grid was made of, beside the volume and the transfer function. */
struct gz_light_grid_key {
	int steps;
	float reach, towards[3];
	struct gz_clip_region clip;
	bool nearest, everywhere;
	uint64_t shades[GZ_SHADES_MAX]; /**< revisions; 0: none */
};

/** The grid. Zero-initialised is empty; its memory is reused when it is made again. */
struct gz_light_grid {
	int dims[3];     /**< cells */
	int edge[3];     /**< voxels of a cell along each axis */
	uint16_t *cells; /**< shares of GZ_LIGHT_GRID_UNIT; x fastest; padding follows */
	size_t capacity; /**< cells allocated */
	bool current;    /**< it is for the present volume and transfer function, and for key */
	struct gz_light_grid_key key;
	uint64_t serial; /**< increased whenever it is made */
};

/** What to make a grid of. All pointers are borrowed until the call returns. */
struct gz_light_grid_request {
	const struct gz_lighting *lighting; /**< prepared for rays, which have shadows */
	gz_cast_arriving_function *arriving;
	const struct gz_ray_params *rays;
	const struct gz_ray_frame *ray_frame;
	/** Of the full volume and the transfer function: only cells around what shows are made. */
	const struct gz_macrocells *cells;
	bool everywhere; /**< make all cells: samples may show something elsewhere */
	/** What others keep back of the light before it enters the volume and within it. What is
	 *  nearer to a cell than GZ_SHADOW_START keeps nothing back, as in the volume. */
	const struct gz_shade *shades;
	size_t shade_count;
	struct gz_workers *workers; /**< NULL: the calling thread alone */
	const struct gz_log *log;   /**< may be NULL */
};

/** The volume or the transfer function has changed; memory is kept. */
void gz_light_grid_forget(struct gz_light_grid *grid);

/** Choose the cells: those of the finest level of shadow cells that has at most
 *  GZ_LIGHT_GRID_MOST, else of the coarsest. @return how many they are */
size_t gz_light_grid_lay_out(const struct gz_shadow_cells *shadows, struct gz_light_grid *grid);

/**
 * Make the grid if it is not there. A shade of unknown revision is asked anew. It has the same bits
 * for any number of threads.
 *
 * @retval GZ_ERR_NO_MEM       there is no grid; logged
 * @retval GZ_ERR_UNSUPPORTED  of gz_light_walk_make(); logged
 */
enum gz_result gz_light_grid_make(const struct gz_light_grid_request *request,
				  struct gz_light_grid *grid);

/** Free and zero. */
void gz_light_grid_free(struct gz_light_grid *grid);

#endif
