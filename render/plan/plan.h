/**
 * @file
 * The foveation plan: which rays are cast and how long their steps are. A method only emits tiles;
 * one kernel per backend casts them, and one reconstruction fills the pixels between rays
 * (docs/foveation.md).
 *
 * A tile is a block of GZ_TILE_EDGE x GZ_TILE_EDGE rays. With a spacing of G pixels, ray positions
 * are multiples of G: the lattice is fixed to the screen, not to the gaze. A square tile takes
 * every lattice point of its block. A quincunx tile takes every second one, like the black fields
 * of a chessboard: a lattice of spacing G * sqrt(2), turned by 45 degrees, which is the rung
 * between G and 2G. Quincunx tiles come in pairs, one above the other, that fill a square of
 * 2 * GZ_TILE_EDGE spacings whose corner is a multiple of its edge.
 *
 * Lattice point (i, j) of spacing G is the ray through the centre of pixel (i * G, j * G). Points
 * may lie beyond the right and lower edge of the picture, so that every pixel lies between four
 * points.
 */
#ifndef GZ_RENDER_PLAN_H
#define GZ_RENDER_PLAN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "protocol/display.h"
#include "protocol/gaze.h"
#include "render/picture/camera.h"
#include "render/plan/foveation.h"
#include "render/plan/plan_constants.h"

/** Which lattice points of its block a tile takes. */
enum gz_tile_pattern {
	GZ_TILE_SQUARE,   /**< ray (c, r) at x + c * G, y + r * G */
	GZ_TILE_QUINCUNX, /**< ray (c, r) at x + (2c + r mod 2) * G, y + r * G: pyramids only */
	GZ_TILE_PATTERN_COUNT,
};

/** One block of rays. */
struct gz_tile {
	uint16_t x, y;   /**< pixel of the first ray; multiples of spacing * GZ_TILE_EDGE */
	uint8_t layer;   /**< index into the plan's layers: gives the spacing */
	uint8_t step;    /**< index into the plan's step multipliers */
	uint8_t pattern; /**< enum gz_tile_pattern */
	bool replaced;   /**< tiles of a later round lie over it (gz_plan_refine()) */
};

/** Columns and rows of a tile's rays, in spacings from its first: ray i = r * GZ_TILE_EDGE + c. */
extern const uint8_t gz_tile_columns[GZ_TILE_PATTERN_COUNT][GZ_TILE_EDGE * GZ_TILE_EDGE];
extern const uint8_t gz_tile_rows[GZ_TILE_EDGE * GZ_TILE_EDGE];

/** How much farther out the samples of each ray of a tile begin if steps are interleaved, in
 *  sixteenths of a step, by pattern and ray. Any four neighbours have four phases a quarter apart
 *  (Bayer's matrix, 1973), so what one ray misses the next ones see, and errors of the step
 * alternate from ray to ray instead of growing into bands (Keller and Heidrich, "Interleaved
 * sampling", 2001). */
extern const uint8_t gz_tile_phases[GZ_TILE_PATTERN_COUNT][GZ_TILE_EDGE * GZ_TILE_EDGE];

/** Phases that a step has in gz_tile_phases. */
#define GZ_TILE_PHASE_COUNT (GZ_TILE_EDGE * GZ_TILE_EDGE)

/** How pixels are made from lattice points. */
enum gz_reconstruction {
	GZ_RECONSTRUCT_DIRECT,  /**< one layer of spacing 1 is the picture */
	GZ_RECONSTRUCT_PYRAMID, /**< layer k has spacing 2^k; each lattice is filled from the next
				   coarser one */
	GZ_RECONSTRUCT_REGIONS, /**< each pixel takes the first layer whose region holds it,
				   bilinearly; within that layer's blend band it is mixed with the
				   layers behind by gz_region_weight() */
};

/** Where a layer of a region plan shows: a pixel belongs to it if the pixel's centre is inside. */
enum gz_region_shape { GZ_REGION_ALL, GZ_REGION_RECTANGLE, GZ_REGION_ELLIPSE };

/** The part of the picture in which a layer shows. */
struct gz_region {
	enum gz_region_shape shape;
	double centre_px[2];
	double half_px[2]; /**< half edges or semi-axes */
	double blend_px;   /**< width of the band inside the rim where the layer fades; 0 = none */
};

/** Whether a pixel belongs to a region. Plan and reconstruction both call this function, so
 * rounding at a rim cannot make them differ. Along an axis away from the centre, false never turns
 * to true again. */
bool gz_region_holds(const struct gz_region *region, double x, double y);

/** Columns of row @p y of a picture of @p width px that a region holds: [*out_from, *out_to), empty
 *  if there are none. */
void gz_region_columns(const struct gz_region *region, int y, int width, int *out_from,
		       int *out_to);

/**
 * Share of a layer in a pixel of its region, [0, 1]. The rest goes to the layers behind, by the
 * same rule. 1 without a band, 0 outside the region; within the band it is (1 - r) * min(half_px) /
 * blend_px, where r is max(|u|, |v|) for a rectangle and sqrt(u * u + v * v) for an ellipse, (u, v)
 * = (position - centre_px) / half_px.
 */
double gz_region_weight(const struct gz_region *region, double x, double y);

/** Cells of a node along an axis: between its points and the first ones of the next node. */
#define GZ_NODE_CELLS GZ_TILE_EDGE

/** How much the rays of a node (gz_plan_node_of()) differ from their neighbours. */
struct gz_node_contrast {
	/** By row and column of the cells: the greatest contrast of luminance at a cell's corners,
	 *  [0, 1]. */
	float luminance[GZ_NODE_CELLS][GZ_NODE_CELLS];
	/** The same of colour, in units of luminance's; 0 or more. */
	float colour[GZ_NODE_CELLS][GZ_NODE_CELLS];
};

/** One lattice of a plan. */
struct gz_plan_layer {
	int spacing;       /**< px */
	int columns, rows; /**< lattice points */
	struct gz_region region;
};

#define GZ_PLAN_SCALE_MAX     64
#define GZ_PLAN_SCALE_OUTSIDE 8 /**< chosen: spacings of 2 px at the fovea's rim become 16 */

/** More than any spacing in pixels. */
#define GZ_PLAN_FINER_MAX 1e6

/** The limit on growth of steps where a technique does not know what longer steps change. Chosen:
 *  docs/results.md, "Steps by what they change". */
#define GZ_PLAN_STEP_GROWTH 0.4

/** What one frame's plan is made from. gz_plan_request_make() fills in the usual values. */
struct gz_plan_request {
	const struct gz_foveation *foveation; /**< within the table's ranges */
	const struct gz_display *display;     /**< of the picture, which fills it */
	struct gz_point gaze; /**< normalised; may lie outside [0, 1]; NaN or infinite means lost:
				 the centre is used */
	int width, height;    /**< rays along each side, 1 to GZ_IMAGE_SIDE_MAX */
	double rays_per_px;   /**< rays per edge of a pixel of the picture, 1/16 to 16: sizes in px
				 are multiplied by it */
	/**
	 * How coarse a budget makes the plan, 1 to GZ_PLAN_SCALE_MAX: the cost falls as it rises.
	 * Outside the fovea (2.5 degrees around the gaze; for regions, the first one) spacings and
	 * steps grow by up to GZ_PLAN_SCALE_OUTSIDE, rising linearly from 2.5 to 5 degrees. Beyond
	 * that scale everything grows by scale / GZ_PLAN_SCALE_OUTSIDE, including the fovea.
	 * Methods with gz_method.can_be_coarser false ignore it.
	 */
	double scale;
	/**
	 * How much finer a pyramid is than its method asks, 1 to GZ_PLAN_FINER_MAX: spacings are
	 * divided by it, and steps by acuity are those of the spacings. Above 1 the plan has one
	 * round. Other plans ignore it. With GZ_PLAN_FINER_MAX every pixel has a ray.
	 */
	double finer;
	/** How lost the gaze is, [0, 1]: 0 trusts it; 1 gives a uniform plan of at most the same
	 *  cost. Methods that do not follow the gaze ignore it. */
	double widen;
	/**
	 * Limit of the acuity rule's steps, [0, 1]: steps of the scene per pixel between a tile's
	 * rays, and never less than one step. 1 limits nothing. Techniques set it from the scene
	 * (gz_detail_steps_per_px()).
	 */
	double steps_per_px;
	/**
	 * Limit of foveation.acuity_step_growth, [0, 1], unless foveation.acuity_step_error is 1.
	 * Techniques set it from what they show (gz_plan_step_growth()).
	 */
	double step_growth;
	/** The technique refines the plan while it draws (gz_plan_refine()): methods with
	 *  gz_method.refines or refines_edges emit the tiles of their first round. Otherwise they
	 * emit what they would need to show anything. Other methods ignore it. */
	bool refines;
};

/** Where a plan's pixels lie in the picture that the camera frames: the plan's pixel (x, y) is the
 *  picture's (x - shift[0], y - shift[1]). */
struct gz_plan_view {
	int width, height; /**< of the picture */
	int shift[2];
};

/** A plan. Zero-initialised is empty. Keep one plan for each kind of frame from frame to frame: its
 *  arrays are reused, and an unchanged request does not make it again. */
struct gz_plan {
	int width, height;
	struct gz_plan_view view; /**< same size and no shift, unless temporal.h shifts frames */
	double focus_px[2]; /**< the gaze that it was made for, or the centre if it was lost */
	enum gz_reconstruction reconstruction;
	enum gz_filter filter; /**< of a pyramid */
	enum gz_step_phase step_phase;
	int layer_count;
	struct gz_plan_layer layers[GZ_PLAN_LAYERS_MAX];
	int step_count;
	float steps[GZ_PLAN_STEPS_MAX]; /**< multipliers of the scene's step, 1 or more */
	size_t tile_count, tile_capacity;
	struct gz_tile *tiles; /**< in an order that keeps neighbours together */
	uint64_t ray_count;    /**< lattice points that the tiles cast */
	uint64_t serial;       /**< changes whenever the plan does; 0 before the first */
	bool refines;          /**< the tiles are those of a first round: see gz_plan_refine() */
	/** What gz_plan_update() made, before gz_plan_refine() appended to it. */
	struct {
		size_t tile_count;
		uint64_t ray_count;
	} first_round;
	struct {
		struct gz_plan_request request; /**< its pointers are not followed */
		struct gz_foveation foveation;
		struct gz_display display;
		bool valid;
	} made_for; /**< what the tiles were made for */
};

/** Whether every pixel has a ray of its own. */
bool gz_plan_is_whole(const struct gz_plan *plan);

/** Whether gz_plan_request.finer only adds rays as it rises, up to the picture of `standard`: the
 *  plan is a pyramid, steps are those of spacings or the scene's, and nothing asks for rays that
 * are finer than the method's at edges. */
bool gz_plan_can_grow(const struct gz_foveation *foveation);

/** Whether each of them also has the scene's own step: the picture is that of `standard`. */
bool gz_plan_is_exact(const struct gz_plan *plan);

/** Whether the acuity rule's steps, which step_growth limits, are those of the plan. */
bool gz_plan_steps_by_acuity(const struct gz_foveation *foveation);

/**
 * The growth with which the steps of tiles whose rays lie 8 px apart are a multiple of the scene's:
 * step_growth of struct gz_plan_request. Most rays far from the gaze are in such tiles or finer
 * ones.
 *
 * @param multiplier  0 or more; less than 1: no growth
 * @return 0 to 1
 */
double gz_plan_step_growth(double multiplier);

/** A request with one ray a pixel, scale 1 and widen 0, whose steps grow as if nothing were known
 * of what is shown. The pointers are borrowed. */
struct gz_plan_request gz_plan_request_make(const struct gz_foveation *foveation,
					    const struct gz_display *display, struct gz_point gaze,
					    int width, int height);

/**
 * Make the plan of one frame. A plan that was made for an equal request keeps its tiles.
 *
 * @param request        borrowed until the call returns
 * @param[in,out] plan   overwritten; its array grows where needed
 * @retval GZ_ERR_INVAL   a size or parameter is out of range, or the method needs a table and has
 *                        none
 * @retval GZ_ERR_NO_MEM  out of memory for the tiles
 *
 * Threads: one at a time per plan.
 */
enum gz_result gz_plan_update(const struct gz_plan_request *request, struct gz_plan *plan);

/** Whether two plans have the same tiles because they were made for equal requests and are not
 *  refined. */
bool gz_plan_same(const struct gz_plan *a, const struct gz_plan *b);

/** gz_plan_update() of gz_plan_request_make(). */
enum gz_result gz_plan_make(const struct gz_foveation *foveation, const struct gz_display *display,
			    struct gz_point gaze, int width, int height, struct gz_plan *plan);

/**
 * Append a further round of tiles to a plan that refines: each block of the last round in which the
 * eye could see more than its rays show is cast again with all the rays that it needs. Its new
 * tiles take the place of the old ones, which stay in the list, marked as replaced. Each part of a
 * block becomes as fine as the contrast between its rays asks for (gz_plan_contrast_spacing_px()),
 * but never finer than the acuity of the eye times foveation.contrast_finest. Of colour, half of
 * luminance's frequencies are seen. A method with gz_method.refines_edges takes
 * foveation.edge_finest times the acuity of the eye where the contrast of luminance is
 * foveation.edge_contrast or more.
 *
 * @param from       first tile of the last round
 * @param contrasts  of each tile from there on. Those of tiles of layer 0 and of tiles that are not
 *                   their node's first (gz_plan_node_of()) are not read
 * @retval GZ_ERR_NO_MEM  out of memory for the tiles; those of the earlier rounds are intact
 *
 * Without a new tile the plan stays as it is. gz_plan_update() takes all further rounds back.
 * Threads: one at a time per plan.
 */
enum gz_result gz_plan_refine(struct gz_plan *plan, size_t from,
			      const struct gz_node_contrast *contrasts);

/** Most rounds of a plan: 1 if it does not refine. */
int gz_plan_rounds(const struct gz_plan *plan);

/** Points along the edge of a tile's block and from there to the corner of the next: its node. A
 *  node is a square tile or two quincunx tiles.
 *
 * @param[out] out_level  layer of the square lattice of the node
 * @return whether the tile is its node's first
 */
bool gz_plan_node_of(const struct gz_tile *tile, int *out_level);

/**
 * Which rays of a tile are cast: those whose point lies on its layer's lattice or, in a pyramid, on
 * that of a coarser layer, which reaches farther.
 *
 * @return bit r * GZ_TILE_EDGE + c for the ray at column c, row r of the tile
 */
uint32_t gz_plan_tile_active(const struct gz_plan *plan, const struct gz_tile *tile);

/**
 * Whether rays with this step begin a phase of gz_tile_phases apart.
 *
 * @param step  index into the plan's step multipliers
 * @param lit   the technique lights surfaces
 */
bool gz_plan_interleaves(const struct gz_plan *plan, int step, bool lit);

/** A rectangle of a rasterised picture: pixels [from, to) along x and y, with one sample in each
 *  spacing x spacing block of them. */
struct gz_plan_rectangle {
	int from[2], to[2]; /**< from: multiples of spacing */
	int spacing;        /**< px */
};

/** Most rectangles of a plan. */
#define GZ_PLAN_RECTANGLES_MAX GZ_PLAN_LAYERS_MAX

/**
 * The plan for techniques that draw triangles instead of casting rays: nested rectangles, coarsest
 * first. The first is the whole picture. Each further one is finer, lies within the previous one
 * and encloses every tile that is finer than the previous one. At each pixel the last rectangle
 * that holds it is therefore at least as fine as the tiles are.
 *
 * @param plan  made by gz_plan_update()
 * @param[out] out_rectangles  the first so many of them are written
 * @return how many, 1 to GZ_PLAN_RECTANGLES_MAX
 */
int gz_plan_rectangles(const struct gz_plan *plan,
		       struct gz_plan_rectangle out_rectangles[GZ_PLAN_RECTANGLES_MAX]);

/**
 * The rays of a plan's pixels: those of the picture that the camera frames, shifted as plan->view
 * says.
 *
 * @retval GZ_ERR_INVAL  the camera is not valid, or the plan is empty; not logged
 */
enum gz_result gz_plan_rays(const struct gz_plan *plan, const struct gz_camera *camera,
			    struct gz_ray_frame *out_rays);

/**
 * Spacing of the rays that shows a contrast as finely as the eye can see it, px, not rounded;
 * infinite if the eye cannot see it at all. The highest frequency f at which a contrast of c is
 * seen at an eccentricity of e degrees follows from the threshold of Geisler and Perry, "A
 * real-time foveated multiresolution system for low-bandwidth video communication" (1998):
 * CT(f, e) = CT0 * exp(alpha * f * (e + e2) / e2), alpha .106, e2 2.3 degrees, CT0 =
 * foveation.contrast_threshold. Two rays a cycle: the spacing is 1 / (2 f) degrees.
 *
 * @param contrast  Michelson's, [0, 1]
 * @param gaze, pixel, width, height  as for gz_acuity_spacing_px()
 */
double gz_plan_contrast_spacing_px(const struct gz_foveation *foveation,
				   const struct gz_display *display, double contrast,
				   struct gz_point gaze, struct gz_point pixel, int width,
				   int height);

/** Free the tiles and zero the plan. */
void gz_plan_free(struct gz_plan *plan);

/**
 * Spacing that the eye resolves at a place, px, not rounded: omega(e) / 2 by the geometry of the
 * display, the smaller of both directions on the flat screen (docs/foveation.md).
 *
 * @param gaze, pixel    normalised places on the display
 * @param width, height  of the picture that fills the display, px
 */
double gz_acuity_spacing_px(const struct gz_foveation *foveation, const struct gz_display *display,
			    struct gz_point gaze, struct gz_point pixel, int width, int height);

#endif
