/**
 * @file
 * The rays of earlier pictures, tile by tile. While nothing but the gaze changes, a tile that was
 * cast before with the same steps has the same rays: its points are kept and need not be cast
 * again. Lattices are fixed to the screen, so most tiles of a plan are those of the plan before it.
 */
#ifndef GZ_RENDER_RECONSTRUCT_CPU_KEPT_TILES_H
#define GZ_RENDER_RECONSTRUCT_CPU_KEPT_TILES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "render/plan/plan.h"

/** Words of one tile in one plane. */
#define GZ_KEPT_TILE_WORDS (GZ_TILE_EDGE * GZ_TILE_EDGE)

/** What the points of a tile are of. */
struct gz_kept_stamp {
	uint32_t generation; /**< gz_kept_tiles.generation; 0: of nothing */
	float step;          /**< multiplier of the scene's step */
};

/** All tiles that a layer can have with one pattern. */
struct gz_kept_shelf {
	int columns;                  /**< tiles in a row */
	int width_px, height_px;      /**< of a tile */
	struct gz_kept_stamp *stamps; /**< row by row */
	uint32_t *words;              /**< GZ_KEPT_TILE_WORDS for each plane of each tile */
};

/** Which tiles a plan can have, and how many words each of their rays has. */
struct gz_kept_layout {
	int width, height, layer_count, planes;
	enum gz_reconstruction reconstruction;
	int spacings[GZ_PLAN_LAYERS_MAX]; /**< px; 0 behind the last layer */
};

/** The kept tiles of one picture. Zero-initialised is empty; keep it from picture to picture. Those
 *  of a pyramid take some 9 bytes a pixel and plane, of which the system gives what is used. */
struct gz_kept_tiles {
	struct gz_kept_shelf shelves[GZ_PLAN_LAYERS_MAX][GZ_TILE_PATTERN_COUNT];
	struct gz_kept_layout layout; /**< of the last picture's plan */
	uint64_t content;             /**< number of what its rays show; 0: nothing yet */
	uint32_t generation; /**< goes up when the content changes; 0: there are no shelves */
};

/**
 * Begin a picture.
 *
 * @param content  number of what decides the rays besides the plan, not 0. Another one than that of
 *                 the picture before forgets all tiles; so does a plan with other layers or of
 *                 another size
 * @param planes   words of each ray, 1 or more
 * @return whether tiles are kept. They are not in the first picture after such a change: while the
 *         camera turns each picture is the first, and keeping would be in vain. They are not if
 *         memory is lacking, either. Then every tile is cast
 */
bool gz_kept_tiles_begin(struct gz_kept_tiles *kept, const struct gz_plan *plan, uint64_t content,
			 int planes);

/**
 * Find the points of a tile: those of earlier pictures, or room for new ones.
 *
 * @param tile  of the plan of gz_kept_tiles_begin()
 * @param[out] out_known  whether the points are there. If not, the caller casts and stores them
 *                        before the picture ends
 * @return GZ_KEPT_TILE_WORDS words for each plane, plane after plane
 *
 * Threads: any number, each with tiles of its own.
 */
uint32_t *gz_kept_tiles_take(struct gz_kept_tiles *kept, const struct gz_plan *plan,
			     const struct gz_tile *tile, bool *out_known);

/** Forget all tiles and free their memory. */
void gz_kept_tiles_free(struct gz_kept_tiles *kept);

#endif
