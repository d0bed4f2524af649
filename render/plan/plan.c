#include "render/plan/plan.h"

#include <math.h>
#include <stdlib.h>

#include "render/picture/image.h"
#include "render/plan/plan_context.h"

static bool request_valid(const struct gz_plan_request *request)
{
	if (request->width < 1 || request->height < 1 || request->width > GZ_IMAGE_SIDE_MAX ||
	    request->height > GZ_IMAGE_SIDE_MAX)
		return false;
	return request->rays_per_px >= 0.0625 && request->rays_per_px <= 16 &&
	       request->scale >= 1 && request->scale <= GZ_PLAN_SCALE_MAX && request->finer >= 1 &&
	       request->finer <= GZ_PLAN_FINER_MAX && request->widen >= 0 && request->widen <= 1 &&
	       request->steps_per_px >= 0 && request->steps_per_px <= 1 &&
	       request->step_growth >= 0 && request->step_growth <= 1 &&
	       gz_display_valid(request->display) && gz_foveation_valid(request->foveation);
}

static bool same_place(float a, float b)
{
	return a == b || (isnan(a) && isnan(b));
}

static bool tiles_follow_gaze(const struct gz_plan_request *request)
{
	const bool all_pixels =
		request->finer >= GZ_PLAN_FINER_MAX && gz_plan_can_grow(request->foveation);
	return gz_foveation_follows_gaze(request->foveation) && !all_pixels;
}

static bool same_request(const struct gz_plan_request *a, const struct gz_plan_request *b)
{
	return a->width == b->width && a->height == b->height && a->rays_per_px == b->rays_per_px &&
	       a->scale == b->scale && a->finer == b->finer && a->widen == b->widen &&
	       a->steps_per_px == b->steps_per_px && a->step_growth == b->step_growth &&
	       a->refines == b->refines &&
	       ((same_place(a->gaze.x, b->gaze.x) && same_place(a->gaze.y, b->gaze.y)) ||
		!tiles_follow_gaze(b)) &&
	       gz_display_same(a->display, b->display) &&
	       gz_foveation_same(a->foveation, b->foveation);
}

/* The request that a plan was made for, with pointers that hold. */
static struct gz_plan_request made_for(const struct gz_plan *plan)
{
	struct gz_plan_request request = plan->made_for.request;
	request.foveation = &plan->made_for.foveation;
	request.display = &plan->made_for.display;
	return request;
}

static bool is_made_for(const struct gz_plan *plan, const struct gz_plan_request *request)
{
	const struct gz_plan_request made = made_for(plan);
	return plan->serial != 0 && plan->made_for.valid && same_request(&made, request);
}

static bool is_refined(const struct gz_plan *plan)
{
	return plan->tile_count != plan->first_round.tile_count;
}

/* Whether every pixel has a ray whose step is at most so many times the scene's. */
static bool all_cast_by(const struct gz_plan *plan, float step_max)
{
	for (size_t i = 0; i < plan->tile_count; i++) {
		const struct gz_tile *tile = &plan->tiles[i];
		const bool whole = plan->layers[tile->layer].spacing == 1 &&
				   tile->pattern == GZ_TILE_SQUARE &&
				   plan->steps[tile->step] <= step_max;
		if (!tile->replaced && !whole)
			return false;
	}
	return true;
}

bool gz_plan_is_whole(const struct gz_plan *plan)
{
	return all_cast_by(plan, INFINITY);
}

bool gz_plan_is_exact(const struct gz_plan *plan)
{
	return all_cast_by(plan, 1);
}

bool gz_plan_same(const struct gz_plan *a, const struct gz_plan *b)
{
	const struct gz_plan_request request = made_for(b);
	return b->made_for.valid && !is_refined(a) && !is_refined(b) && is_made_for(a, &request);
}

static void take_refinement_back(struct gz_plan *plan)
{
	if (!is_refined(plan))
		return;
	plan->serial++;
	plan->tile_count = plan->first_round.tile_count;
	plan->ray_count = plan->first_round.ray_count;
	for (size_t i = 0; i < plan->tile_count; i++)
		plan->tiles[i].replaced = false;
}

static void remember(struct gz_plan *plan, const struct gz_plan_request *request)
{
	plan->made_for.request = *request;
	plan->made_for.foveation = *request->foveation;
	plan->made_for.display = *request->display;
	plan->made_for.valid = true;
}

static enum gz_result make_tiles(const struct gz_plan_request *request, struct gz_plan *plan)
{
	struct gz_plan_context context;
	gz_plan_context_make(request, &context);
	plan->width = request->width;
	plan->height = request->height;
	plan->filter = (enum gz_filter)request->foveation->filter;
	plan->step_phase = (enum gz_step_phase)request->foveation->step_phase;
	plan->tile_count = 0;
	plan->layer_count = 0;
	plan->ray_count = 0;
	plan->refines = context.round == GZ_ROUND_FIRST;
	gz_plan_make_steps(&context, plan);
	const enum gz_result result = gz_method_of(request->foveation)->is_pyramid
					      ? gz_plan_ladder(&context, plan)
					      : gz_plan_regions(&context, plan);
	plan->first_round.tile_count = plan->tile_count;
	plan->first_round.ray_count = plan->ray_count;
	return result;
}

/* Done even if the tiles stay: bricks are fetched by the focus, and the view may have been shifted
 * since. */
static void aim_plan(const struct gz_plan_request *request, struct gz_plan *plan)
{
	const bool known = isfinite(request->gaze.x) && isfinite(request->gaze.y);
	plan->view = (struct gz_plan_view) { request->width, request->height, { 0, 0 } };
	plan->focus_px[0] = (known ? (double)request->gaze.x : 0.5) * request->width - 0.5;
	plan->focus_px[1] = (known ? (double)request->gaze.y : 0.5) * request->height - 0.5;
}

enum gz_result gz_plan_update(const struct gz_plan_request *request, struct gz_plan *plan)
{
	if (!request_valid(request))
		return GZ_ERR_INVAL;
	aim_plan(request, plan);
	if (is_made_for(plan, request)) {
		take_refinement_back(plan);
		return GZ_OK;
	}
	plan->made_for.valid = false;
	plan->serial++;
	const enum gz_result result = make_tiles(request, plan);
	if (result == GZ_OK)
		remember(plan, request);
	return result;
}

enum gz_result gz_plan_refine(struct gz_plan *plan, size_t from,
			      const struct gz_node_contrast *contrasts)
{
	const struct gz_plan_request request = made_for(plan);
	const size_t before = plan->tile_count;
	struct gz_plan_context context;
	gz_plan_context_make(&request, &context);
	context.round = GZ_ROUND_FURTHER;
	const enum gz_result result = gz_plan_ladder_refine(&context, plan, from, contrasts);
	plan->serial += plan->tile_count != before;
	return result;
}

int gz_plan_rounds(const struct gz_plan *plan)
{
	const struct gz_foveation *foveation = &plan->made_for.foveation;
	if (!plan->refines)
		return 1;
	return gz_method_of(foveation)->refines ? foveation->contrast_rounds : 2;
}

struct gz_plan_request gz_plan_request_make(const struct gz_foveation *foveation,
					    const struct gz_display *display, struct gz_point gaze,
					    int width, int height)
{
	return (struct gz_plan_request) {
		.foveation = foveation,
		.display = display,
		.gaze = gaze,
		.width = width,
		.height = height,
		.rays_per_px = 1,
		.scale = 1,
		.finer = 1,
		.steps_per_px = 1,
		.step_growth = GZ_PLAN_STEP_GROWTH,
	};
}

enum gz_result gz_plan_make(const struct gz_foveation *foveation, const struct gz_display *display,
			    struct gz_point gaze, int width, int height, struct gz_plan *plan)
{
	const struct gz_plan_request request =
		gz_plan_request_make(foveation, display, gaze, width, height);
	return gz_plan_update(&request, plan);
}

const uint8_t gz_tile_columns[GZ_TILE_PATTERN_COUNT][GZ_TILE_EDGE * GZ_TILE_EDGE] = {
	[GZ_TILE_SQUARE] = { 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3 },
	[GZ_TILE_QUINCUNX] = { 0, 2, 4, 6, 1, 3, 5, 7, 0, 2, 4, 6, 1, 3, 5, 7 },
};
const uint8_t gz_tile_rows[GZ_TILE_EDGE * GZ_TILE_EDGE] = {
	0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3,
};

/* Of Bayer's 4 x 4 matrix. A quincunx is taken as a square lattice turned by 45 degrees: ray (x, y)
 * at column (x + y) / 2, row (x - y) / 2 of the matrix. */
const uint8_t gz_tile_phases[GZ_TILE_PATTERN_COUNT][GZ_TILE_EDGE * GZ_TILE_EDGE] = {
	[GZ_TILE_SQUARE] = { 0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5 },
	[GZ_TILE_QUINCUNX] = { 0, 4, 1, 5, 8, 14, 9, 15, 7, 2, 6, 3, 13, 10, 12, 11 },
};

bool gz_plan_interleaves(const struct gz_plan *plan, int step, bool lit)
{
	return plan->steps[step] > 1 && (plan->step_phase == GZ_STEP_PHASE_INTERLEAVED ||
					 (plan->step_phase == GZ_STEP_PHASE_LIT && lit));
}

enum gz_result gz_plan_reserve(struct gz_plan *plan, size_t count)
{
	const size_t needed = plan->tile_count + count;
	if (needed <= plan->tile_capacity)
		return GZ_OK;
	const size_t capacity = needed > 2 * plan->tile_capacity ? needed : 2 * plan->tile_capacity;
	struct gz_tile *tiles = realloc(plan->tiles, capacity * sizeof *tiles);
	if (!tiles)
		return GZ_ERR_NO_MEM;
	plan->tiles = tiles;
	plan->tile_capacity = capacity;
	return GZ_OK;
}

void gz_plan_append(struct gz_plan *plan, struct gz_tile tile)
{
	const uint32_t active = gz_plan_tile_active(plan, &tile);
	if (active == 0)
		return;
	plan->ray_count += (uint64_t)__builtin_popcount(active);
	plan->tiles[plan->tile_count++] = tile;
}

struct gz_plan_layer gz_plan_layer_make(int width, int height, int spacing, struct gz_region region)
{
	return (struct gz_plan_layer) {
		.spacing = spacing,
		.columns = (width - 1 + spacing - 1) / spacing + 1,
		.rows = (height - 1 + spacing - 1) / spacing + 1,
		.region = region,
	};
}

/* Whether a pixel position lies on the lattice of a layer or, in a pyramid, of a coarser one. */
static bool on_lattice(const struct gz_plan *plan, int layer, int x, int y)
{
	const int last =
		plan->reconstruction == GZ_RECONSTRUCT_PYRAMID ? plan->layer_count - 1 : layer;
	for (int i = layer; i <= last; i++) {
		const struct gz_plan_layer *lattice = &plan->layers[i];
		const int spacing = lattice->spacing;
		if (x % spacing == 0 && y % spacing == 0 && x / spacing < lattice->columns &&
		    y / spacing < lattice->rows)
			return true;
	}
	return false;
}

uint32_t gz_plan_tile_active(const struct gz_plan *plan, const struct gz_tile *tile)
{
	const struct gz_plan_layer *layer = &plan->layers[tile->layer];
	const uint8_t *columns = gz_tile_columns[tile->pattern];
	const int last = GZ_TILE_EDGE * GZ_TILE_EDGE - 1;
	if (tile->x + columns[last] * layer->spacing <= (layer->columns - 1) * layer->spacing &&
	    tile->y + gz_tile_rows[last] * layer->spacing <= (layer->rows - 1) * layer->spacing)
		return 0xFFFF; /* wholly inside: the usual case */
	uint32_t active = 0;
	for (int i = 0; i <= last; i++)
		if (on_lattice(plan, tile->layer, tile->x + columns[i] * layer->spacing,
			       tile->y + gz_tile_rows[i] * layer->spacing))
			active |= 1U << i;
	return active;
}

/* Grow a rectangle around a tile. A quincunx tile counts with the spacing of the square lattice
 * that it thins out, which is finer than its own. */
static void enclose_tile(const struct gz_plan *plan, const struct gz_tile *tile,
			 struct gz_plan_rectangle *rectangle)
{
	const int down = GZ_TILE_EDGE * plan->layers[tile->layer].spacing;
	const int across = tile->pattern == GZ_TILE_QUINCUNX ? 2 * down : down;
	const int from[2] = { tile->x, tile->y };
	const int to[2] = { tile->x + across, tile->y + down };
	const int size[2] = { plan->width, plan->height };
	for (int axis = 0; axis < 2; axis++) {
		if (from[axis] < rectangle->from[axis])
			rectangle->from[axis] = from[axis];
		const int end = to[axis] < size[axis] ? to[axis] : size[axis];
		if (end > rectangle->to[axis])
			rectangle->to[axis] = end;
	}
}

/* The rectangle that encloses all tiles of spacing @p spacing or finer; false if there are none. */
static bool enclose_layers(const struct gz_plan *plan, int spacing,
			   struct gz_plan_rectangle *out_rectangle)
{
	bool any = false;
	*out_rectangle = (struct gz_plan_rectangle) {
		.from = { plan->width, plan->height },
		.spacing = 1,
	};
	for (size_t i = 0; i < plan->tile_count; i++) {
		const struct gz_tile *tile = &plan->tiles[i];
		const int own = plan->layers[tile->layer].spacing;
		if (own > spacing || tile->x >= plan->width || tile->y >= plan->height)
			continue;
		enclose_tile(plan, tile, out_rectangle);
		if (own > out_rectangle->spacing)
			out_rectangle->spacing = own;
		any = true;
	}
	for (int axis = 0; axis < 2 && any; axis++)
		out_rectangle->from[axis] -= out_rectangle->from[axis] % out_rectangle->spacing;
	return any;
}

static void enclose_rectangle(const struct gz_plan_rectangle *inner,
			      struct gz_plan_rectangle *outer)
{
	for (int axis = 0; axis < 2; axis++)
		while (outer->from[axis] > inner->from[axis])
			outer->from[axis] -= outer->spacing;
}

int gz_plan_rectangles(const struct gz_plan *plan,
		       struct gz_plan_rectangle out_rectangles[GZ_PLAN_RECTANGLES_MAX])
{
	int count = 0, spacing = GZ_PYRAMID_SPACING_MAX;
	struct gz_plan_rectangle rectangle;
	while (spacing > 0 && enclose_layers(plan, spacing, &rectangle)) {
		/* Its corner was rounded down to its own spacing, perhaps out of the coarser ones.
		 */
		for (int i = 0; i < count; i++)
			enclose_rectangle(&rectangle, &out_rectangles[i]);
		out_rectangles[count++] = rectangle;
		spacing = rectangle.spacing - 1;
	}
	out_rectangles[0].from[0] = out_rectangles[0].from[1] = 0;
	out_rectangles[0].to[0] = plan->width;
	out_rectangles[0].to[1] = plan->height;
	return count;
}

/* Move rays of the picture's pixels to those of the plan, whose pixel (0, 0) is the picture's
 * -shift. */
static void shift_rays(const int shift[2], struct gz_ray_frame *rays)
{
	for (int axis = 0; axis < 3; axis++) {
		rays->origin00[axis] -=
			shift[0] * rays->origin_dx[axis] + shift[1] * rays->origin_dy[axis];
		rays->direction00[axis] -=
			shift[0] * rays->direction_dx[axis] + shift[1] * rays->direction_dy[axis];
	}
}

enum gz_result gz_plan_rays(const struct gz_plan *plan, const struct gz_camera *camera,
			    struct gz_ray_frame *out_rays)
{
	const enum gz_result result =
		gz_camera_rays(camera, plan->view.width, plan->view.height, out_rays);
	if (result == GZ_OK)
		shift_rays(plan->view.shift, out_rays);
	return result;
}

void gz_plan_free(struct gz_plan *plan)
{
	free(plan->tiles);
	*plan = (struct gz_plan) { 0 };
}
