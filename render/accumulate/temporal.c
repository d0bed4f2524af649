#include "render/accumulate/temporal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define AT(field) offsetof(struct gz_temporal_params, field)

const struct gz_option gz_temporal_options[] = {
	{ "temporal.keep_rays", GZ_OPTION_BOOL, AT(keep_rays), .preset = "yes",
	  .help = "while nothing but the gaze changes, take rays of earlier frames; pictures stay "
		  "the same" },
	{ "temporal.accumulate", GZ_OPTION_BOOL, AT(accumulate), .preset = "no",
	  .help = "keep what earlier frames saw, so that a still picture becomes sharp "
		  "everywhere" },
	{ "temporal.weight", GZ_OPTION_DOUBLE, AT(weight), 0, 0.98, .preset = "0.9",
	  .help = "share of earlier frames in pixels between rays while the camera moves" },
};
const size_t gz_temporal_option_count = sizeof gz_temporal_options / sizeof gz_temporal_options[0];

struct gz_temporal_params gz_temporal_default(void)
{
	struct gz_temporal_params params = { 0 };
	const struct gz_option_binding binding = {
		.options = gz_temporal_options,
		.count = gz_temporal_option_count,
		.target = &params,
	};
	gz_options_preset(&binding);
	return params;
}

/* How a pixel is known, one byte: the layer whose ray was cast there; BETWEEN + the layer whose
 * rays lie around it; or UNKNOWN. In a history, a pixel between rays holds BETWEEN + the number of
 * frames that it is the mean of. */
enum { BETWEEN = 16, MEAN_MAX = 64, UNKNOWN = 255 };

/* The fourth byte of a finished picture. In a history it is the depth of what the pixel shows. */
#define OPAQUE UINT32_C(0xFF000000)

enum {
	SHIFTS = GZ_TEMPORAL_SHIFTS,
	FRAMES = SHIFTS * SHIFTS, /* until every pixel was cast */
	ROWS_A_PART = 16,
};

/* A place of the history counts if what it shows lies no farther before or behind than this, world
 * units, which are edges of the volume. Chosen: what lies nearer is mostly of the same surface. */
#define DEPTH_SLACK 0.1

/* Error of the pixels between rays as a share of how far the rays around them are from the mean of
 * their neighbours, squared: by the second difference 1/16 for what is smooth, more for what is
 * not. Chosen: of 1/16 to 1, what gains most on the head (docs/results.md) without loss to any
 * method. */
#define BETWEEN_ERROR2 (1.0F / 8)

/* Shares of the history below this change no pixel. */
#define LEAST_WEIGHT (0.5F / 255)

/* R, G, B and a depth. */
typedef float four __attribute__((vector_size(16)));
typedef int32_t int4 __attribute__((vector_size(16)));
typedef uint8_t bytes4 __attribute__((vector_size(4)));

/* How the picture moves from the earlier frame to this one. */
struct movement {
	struct gz_ray_frame rays, rays_before;
	struct gz_ray_inverse before;
	struct gz_ray_depths depths, depths_before;
};

/* What the threads that join a frame share. */
struct join {
	struct gz_temporal *temporal;
	const struct gz_plan *plan;
	float weight;
	bool moves;          /* the camera does */
	bool knows_movement; /* and the history may be asked */
	struct movement movement;
	uint32_t *out;
};

/*
 * Shift of a frame. Each aligned run of 4^k frames has each shift of less than 2^k pixels once, so
 * a lattice of spacing 2^k has covered every pixel after 4^k frames. Wide lattices take longest, so
 * their large shifts also depend on the digits that change fastest.
 */
static void find_shift(unsigned frame, int shift[2])
{
	enum { DIGITS = 5 };
	unsigned digits[DIGITS];
	for (int k = 0; k < DIGITS; k++)
		digits[k] = frame >> (2 * k) & 3;
	digits[4] ^= digits[0];
	digits[3] ^= digits[1];
	shift[0] = shift[1] = 0;
	for (int k = 0; k < DIGITS; k++) { /* opposite corners first */
		shift[0] += (int)(digits[k] == 1 || digits[k] == 2) << k;
		shift[1] += (int)(digits[k] == 1 || digits[k] == 3) << k;
	}
}

static enum gz_result resize_history(struct gz_temporal *temporal, int width, int height)
{
	const size_t count = (size_t)width * (size_t)height;
	if (!temporal->workers && gz_workers_create(0, &temporal->workers) != GZ_OK)
		return GZ_ERR_NO_MEM;
	if (temporal->width == width && temporal->height == height)
		return GZ_OK;
	temporal->any = false;
	temporal->width = temporal->height = 0;
	uint8_t **const maps[] = { &temporal->kept, &temporal->cast };
	for (size_t i = 0; i < sizeof maps / sizeof maps[0]; i++) {
		free(*maps[i]);
		*maps[i] = malloc(count);
		if (!*maps[i])
			return GZ_ERR_NO_MEM;
	}
	free(temporal->errors);
	temporal->errors = malloc(count * sizeof *temporal->errors);
	if (!temporal->errors || gz_image_resize(&temporal->history, width, height) != GZ_OK ||
	    gz_image_resize(&temporal->moved, width, height) != GZ_OK)
		return GZ_ERR_NO_MEM;
	temporal->width = width;
	temporal->height = height;
	return GZ_OK;
}

enum gz_result gz_temporal_begin(struct gz_temporal *temporal,
				 const struct gz_temporal_content *content,
				 struct gz_plan_request *request, struct gz_display *display)
{
	if (request->width > GZ_IMAGE_SIDE_MAX - SHIFTS ||
	    request->height > GZ_IMAGE_SIDE_MAX - SHIFTS)
		return GZ_ERR_INVAL;
	const enum gz_result result = resize_history(temporal, request->width, request->height);
	if (result != GZ_OK)
		return result;
	if (!temporal->any || temporal->shown.serial != content->serial)
		gz_temporal_forget(temporal);
	find_shift(temporal->frame, temporal->shift);
	const double width = request->width, height = request->height;
	request->width += SHIFTS;
	request->height += SHIFTS;
	request->gaze.x = (float)((request->gaze.x * width + temporal->shift[0]) / request->width);
	request->gaze.y =
		(float)((request->gaze.y * height + temporal->shift[1]) / request->height);
	display->mm[0] *= request->width / width;
	display->mm[1] *= request->height / height;
	request->display = display;
	return GZ_OK;
}

void gz_temporal_place(const struct gz_temporal *temporal, struct gz_plan *plan)
{
	plan->view = (struct gz_plan_view) {
		.width = temporal->width,
		.height = temporal->height,
		.shift = { temporal->shift[0], temporal->shift[1] },
	};
}

static void mark_pixel(const struct gz_temporal *temporal, int x, int y, uint8_t how)
{
	if (x < 0 || y < 0 || x >= temporal->width || y >= temporal->height)
		return;
	uint8_t *cast = &temporal->cast[(size_t)y * (size_t)temporal->width + (size_t)x];
	*cast = how < *cast ? how : *cast;
}

/* Whether pixel (x, y) of the plan shows this layer alone. In a pyramid every layer does. */
static bool shows_alone(const struct gz_plan *plan, int layer, int x, int y)
{
	if (plan->reconstruction != GZ_RECONSTRUCT_REGIONS)
		return true;
	for (int before = 0; before < layer; before++)
		if (gz_region_holds(&plan->layers[before].region, x, y))
			return false;
	return gz_region_weight(&plan->layers[layer].region, x, y) >= 1;
}

/* Mark the pixels of a tile's rays. Some rays only support the interpolation of their neighbours:
 * those beside the region of their layer, or in its band. They are no pixel's colour. */
static void mark_tile_rays(const struct gz_temporal *temporal, const struct gz_plan *plan,
			   const struct gz_tile *tile)
{
	const int spacing = plan->layers[tile->layer].spacing;
	for (int ray = 0; ray < GZ_TILE_EDGE * GZ_TILE_EDGE; ray++) {
		const int x = tile->x + gz_tile_columns[tile->pattern][ray] * spacing;
		const int y = tile->y + gz_tile_rows[ray] * spacing;
		if (shows_alone(plan, tile->layer, x, y))
			mark_pixel(temporal, x - temporal->shift[0], y - temporal->shift[1],
				   tile->layer);
	}
}

/* Mark how the frame knows each pixel; where tiles overlap, the finest counts. */
static void mark_tiles(const struct gz_temporal *temporal, const struct gz_plan *plan)
{
	memset(temporal->cast, UNKNOWN, (size_t)temporal->width * (size_t)temporal->height);
	for (size_t t = 0; t < plan->tile_count; t++) {
		const struct gz_tile *tile = &plan->tiles[t];
		const int spacing = plan->layers[tile->layer].spacing;
		const int x0 = tile->x - temporal->shift[0], y0 = tile->y - temporal->shift[1];
		const int down = GZ_TILE_EDGE * spacing;
		const int across = tile->pattern == GZ_TILE_QUINCUNX ? 2 * down : down;
		for (int y = y0; y < y0 + down && (spacing > 1 || across > down); y++)
			for (int x = x0; x < x0 + across; x++)
				mark_pixel(temporal, x, y, (uint8_t)(BETWEEN + tile->layer));
		mark_tile_rays(temporal, plan, tile);
	}
}

static const uint8_t *frame_pixel(const struct gz_temporal *temporal, int x, int y)
{
	x += temporal->shift[0];
	y += temporal->shift[1];
	return temporal->frame_image.pixels +
	       4 * ((size_t)y * (size_t)temporal->frame_image.width + (size_t)x);
}

/* One pixel of a still picture. A ray's colour stays until the ray of a finer layer comes; between
 * rays the pixel is the mean of all frames. */
static void join_still(uint8_t *pixel, uint8_t *kept, const uint8_t *now, uint8_t cast)
{
	if (cast < BETWEEN) {
		if (cast <= *kept) {
			memcpy(pixel, now, 4);
			*kept = cast;
		}
		return;
	}
	if (*kept < BETWEEN)
		return;
	const int frames = *kept == UNKNOWN ? 0 : *kept - BETWEEN;
	for (int c = 0; c < 4; c++)
		pixel[c] = (uint8_t)((2 * (pixel[c] * frames + now[c]) + frames + 1) /
				     (2 * (frames + 1)));
	*kept = (uint8_t)(BETWEEN + (frames < MEAN_MAX ? frames + 1 : MEAN_MAX));
}

/* ---- a camera that moves ---- */

static int within(int i, int count)
{
	return i < 0 ? 0 : i < count ? i : count - 1;
}

static four four_of(const uint8_t *pixel)
{
	bytes4 bytes;
	memcpy(&bytes, pixel, sizeof bytes);
	return __builtin_convertvector(bytes, four);
}

static four select_four(int4 mask, four a, four b)
{
	return (four)((mask & (int4)a) | (~mask & (int4)b));
}

static four least_of(four a, four b)
{
	return select_four(a < b, a, b);
}

static four greatest_of(four a, four b)
{
	return select_four(a > b, a, b);
}

/* Of red, green and blue. */
static float squares_of(four x)
{
	const four square = x * x;
	return square[0] + square[1] + square[2];
}

/* Least and greatest colours in the 3x3 pixels a spacing apart around a pixel. */
static void neighbourhood_range(const struct join *join, int x, int y, int spacing, four *least,
				four *greatest)
{
	const struct gz_temporal *temporal = join->temporal;
	*least = *greatest = four_of(frame_pixel(temporal, x, y));
	for (int k = 0; k < 9; k++) {
		const int at_x = within(x + (k % 3 - 1) * spacing, temporal->width);
		const int at_y = within(y + (k / 3 - 1) * spacing, temporal->height);
		const four near = four_of(frame_pixel(temporal, at_x, at_y));
		*least = least_of(*least, near);
		*greatest = greatest_of(*greatest, near);
	}
}

/* How far a pixel is from the mean of those a spacing before and behind it, squared; of both axes.
 */
static float bend2_at(const struct gz_temporal *temporal, int x, int y, int spacing)
{
	const int left = within(x - spacing, temporal->width);
	const int right = within(x + spacing, temporal->width);
	const int above = within(y - spacing, temporal->height);
	const int below = within(y + spacing, temporal->height);
	const four here = four_of(frame_pixel(temporal, x, y));
	const four across =
		four_of(frame_pixel(temporal, left, y)) + four_of(frame_pixel(temporal, right, y));
	const four down =
		four_of(frame_pixel(temporal, x, above)) + four_of(frame_pixel(temporal, x, below));
	return squares_of(here - across * 0.5F) + squares_of(here - down * 0.5F);
}

static double depth_of(const struct gz_ray_depths *depths, uint8_t byte)
{
	return depths->nearest + (depths->farthest - depths->nearest) * byte / 255;
}

/* Pixel (x, y) of the rays: where its ray begins and goes. Returns the length of the direction. */
static double ray_of(const struct gz_ray_frame *rays, double x, double y, double origin[3],
		     double direction[3])
{
	double length2 = 0;
	for (int axis = 0; axis < 3; axis++) {
		origin[axis] = rays->origin00[axis] + x * rays->origin_dx[axis] +
			       y * rays->origin_dy[axis];
		direction[axis] = rays->direction00[axis] + x * rays->direction_dx[axis] +
				  y * rays->direction_dy[axis];
		length2 += direction[axis] * direction[axis];
	}
	return sqrt(length2);
}

/* The place in the earlier picture of what pixel (x, y) shows now, and its depth there. False: not
 * in view. */
static bool find_place(const struct movement *movement, int x, int y, uint8_t depth,
		       double place[2], double *out_depth)
{
	double origin[3], direction[3], world[3], moved[4];
	const double length = ray_of(&movement->rays, x, y, origin, direction);
	const double along = depth_of(&movement->depths, depth) / length;
	for (int axis = 0; axis < 3; axis++)
		world[axis] = origin[axis] + along * direction[axis];
	gz_ray_inverse_point(&movement->before, world, moved);
	if (!(moved[3] > 0))
		return false;
	place[0] = moved[0] / moved[2];
	place[1] = moved[1] / moved[2];
	*out_depth =
		moved[3] * ray_of(&movement->rays_before, place[0], place[1], origin, direction);
	return true;
}

/* Weights of four pixels in a row for a place between the second and the third: Catmull-Rom. */
static void cubic_weights(float t, float out_weights[4])
{
	out_weights[0] = ((1 - 0.5F * t) * t - 0.5F) * t;
	out_weights[1] = (1.5F * t - 2.5F) * t * t + 1;
	out_weights[2] = ((2 - 1.5F * t) * t + 0.5F) * t;
	out_weights[3] = (0.5F * t - 0.5F) * t * t;
}

/* The history at a place within it. */
static four sample_history(const struct gz_temporal *temporal, const double place[2])
{
	const int x = (int)place[0], y = (int)place[1];
	const int width = temporal->width, height = temporal->height;
	float across[4], down[4];
	four sum = { 0 };
	cubic_weights((float)(place[0] - x), across);
	cubic_weights((float)(place[1] - y), down);
	for (int row = 0; row < 4; row++) {
		const uint8_t *pixels = temporal->history.pixels +
					4 * (size_t)within(y + row - 1, height) * (size_t)width;
		four of_row = { 0 };
		for (int column = 0; column < 4; column++)
			of_row += across[column] *
				  four_of(pixels + 4 * within(x + column - 1, width));
		sum += down[row] * of_row;
	}
	return sum;
}

/* Find how the picture moves. False: nothing can be known of it. */
static bool find_movement(const struct gz_temporal *temporal,
			  const struct gz_temporal_content *content, struct movement *out_movement)
{
	const struct gz_camera *before = &temporal->shown.camera, *now = &content->camera;
	out_movement->depths = gz_camera_ray_depths(now);
	out_movement->depths_before = gz_camera_ray_depths(before);
	return content->deep && temporal->shown.deep &&
	       gz_camera_rays(now, temporal->width, temporal->height, &out_movement->rays) ==
		       GZ_OK &&
	       gz_camera_rays(before, temporal->width, temporal->height,
			      &out_movement->rays_before) == GZ_OK &&
	       gz_ray_inverse_make(&out_movement->rays_before, &out_movement->before);
}

/* What the history shows of a pixel. False: it does not show that. */
static bool find_said(const struct join *join, int x, int y, four *out_said)
{
	const struct gz_temporal *temporal = join->temporal;
	const int width = temporal->width, height = temporal->height;
	double place[2], depth;
	if (!find_place(&join->movement, x, y, frame_pixel(temporal, x, y)[3], place, &depth) ||
	    !(place[0] >= 0 && place[1] >= 0 && place[0] <= width - 1 && place[1] <= height - 1))
		return false;
	const size_t nearest = (size_t)(place[1] + 0.5) * (size_t)width + (size_t)(place[0] + 0.5);
	const double shown =
		depth_of(&join->movement.depths_before, temporal->history.pixels[4 * nearest + 3]);
	if (!(fabs(shown - depth) <= DEPTH_SLACK))
		return false;
	*out_said = sample_history(temporal, place);
	return true;
}

/* Whether the ray of a pixel has neighbours that others lie between. */
static bool is_apart(const struct join *join, uint8_t cast)
{
	return cast < GZ_PLAN_LAYERS_MAX && join->plan->layers[cast].spacing > 1;
}

/* Find the errors at the rays of some rows. */
static void judge_rows(void *user, size_t part, int worker)
{
	(void)worker;
	const struct join *join = user;
	const struct gz_temporal *temporal = join->temporal;
	const int from = (int)part * ROWS_A_PART;
	for (int y = from; y < from + ROWS_A_PART && y < temporal->height; y++)
		for (int x = 0; x < temporal->width; x++) {
			const size_t i = (size_t)y * (size_t)temporal->width + (size_t)x;
			const uint8_t cast = temporal->cast[i];
			four said;
			if (!is_apart(join, cast))
				continue;
			struct gz_temporal_errors *errors = &temporal->errors[i];
			errors->bend2 = bend2_at(temporal, x, y, join->plan->layers[cast].spacing);
			errors->said2 = INFINITY;
			if (errors->bend2 > 0 && find_said(join, x, y, &said))
				errors->said2 =
					squares_of(said - four_of(frame_pixel(temporal, x, y)));
		}
}

/* The pixels between four places of a lattice, at some of which rays were cast. */
struct cell {
	int left, spacing; /* spacing 0: none */
	float trust;
};

/* How far the history may be trusted in a cell, [0, 1]. It has said what the rays of this frame
 * would show. The share of two estimates in the best one is that of their errors: of the history,
 * the mean of what it said. */
static float trust_in(const struct join *join, int left, int top, int spacing)
{
	const struct gz_temporal *temporal = join->temporal;
	float between = 0, said = 0;
	for (int k = 0; k < 4; k++) {
		const int x = left + (k & 1) * spacing, y = top + (k >> 1) * spacing;
		if (x < 0 || y < 0 || x >= temporal->width || y >= temporal->height)
			continue;
		const size_t i = (size_t)y * (size_t)temporal->width + (size_t)x;
		if (!is_apart(join, temporal->cast[i]) || temporal->errors[i].bend2 <= 0)
			continue;
		between += BETWEEN_ERROR2 * temporal->errors[i].bend2;
		said += temporal->errors[i].said2;
	}
	return between > 0 ? between / (between + said) : 0;
}

/* Find the cell of a pixel, unless it is this one already. */
static void find_cell(const struct join *join, int x, int y, int spacing, struct cell *cell)
{
	const int *shift = join->temporal->shift;
	if (spacing < 1 || (cell->spacing == spacing && x - cell->left < spacing))
		return;
	cell->spacing = spacing;
	cell->left = x - (x + shift[0]) % spacing;
	cell->trust = trust_in(join, cell->left, y - (y + shift[1]) % spacing, spacing);
}

/* One pixel while the camera moves. A ray's colour is taken; between rays what the history shows is
 * mixed in, clamped to the range of the frame's neighbourhood, as far as it can be trusted. */
static void join_moved(const struct join *join, int x, int y, struct cell *cell)
{
	struct gz_temporal *temporal = join->temporal;
	const size_t i = (size_t)y * (size_t)temporal->width + (size_t)x;
	const uint8_t *now = frame_pixel(temporal, x, y);
	const uint8_t cast = temporal->cast[i];
	uint8_t *pixel = temporal->moved.pixels + 4 * i;
	four least, greatest, said;
	memcpy(pixel, now, 4);
	temporal->kept[i] = cast < BETWEEN ? cast : BETWEEN + 4; /* chosen: of 4 frames */
	if (cast < BETWEEN || cast == UNKNOWN || !join->knows_movement)
		return;
	const int spacing = join->plan->layers[cast - BETWEEN].spacing;
	find_cell(join, x, y, spacing, cell);
	const float weight = join->weight * cell->trust;
	if (weight < LEAST_WEIGHT || !find_said(join, x, y, &said))
		return;
	neighbourhood_range(join, x, y, spacing, &least, &greatest);
	const four here = four_of(now);
	const four mixed =
		here + (least_of(greatest_of(said, least), greatest) - here) * weight + 0.5F;
	for (int c = 0; c < 3; c++)
		pixel[c] = (uint8_t)mixed[c];
}

static void join_history_rows(void *user, size_t part, int worker)
{
	(void)worker;
	const struct join *join = user;
	struct gz_temporal *temporal = join->temporal;
	const int from = (int)part * ROWS_A_PART;
	for (int y = from; y < from + ROWS_A_PART && y < temporal->height; y++) {
		const size_t row = (size_t)y * (size_t)temporal->width;
		struct cell cell = { 0 };
		for (int x = 0; x < temporal->width; x++) {
			const size_t i = row + (size_t)x;
			uint8_t *pixel = temporal->history.pixels + 4 * i;
			if (join->moves)
				join_moved(join, x, y, &cell);
			else
				join_still(pixel, &temporal->kept[i], frame_pixel(temporal, x, y),
					   temporal->cast[i]);
		}
		const struct gz_image *joined = join->moves ? &temporal->moved : &temporal->history;
		const uint32_t *history = gz_image_words(joined) + row;
		for (int x = 0; x < temporal->width; x++)
			join->out[row + (size_t)x] = history[x] | OPAQUE;
	}
}

static void join_frame(struct join *join)
{
	struct gz_temporal *temporal = join->temporal;
	const size_t parts = ((size_t)temporal->height + ROWS_A_PART - 1) / ROWS_A_PART;
	if (join->knows_movement)
		gz_workers_run(temporal->workers, judge_rows, join, parts);
	gz_workers_run(temporal->workers, join_history_rows, join, parts);
	if (!join->moves)
		return;
	const struct gz_image image = temporal->history;
	temporal->history = temporal->moved;
	temporal->moved = image;
}

enum gz_result gz_temporal_end(struct gz_temporal *temporal,
			       const struct gz_temporal_params *params,
			       const struct gz_temporal_content *content,
			       const struct gz_plan *plan, struct gz_image *image)
{
	enum gz_result result = gz_image_resize(image, temporal->width, temporal->height);
	if (result != GZ_OK)
		return result;
	struct join join = {
		.temporal = temporal,
		.plan = plan,
		.out = (uint32_t *)(void *)image->pixels, /* aligned to 64 bytes (image.h) */
	};
	mark_tiles(temporal, plan);
	if (!temporal->any) {
		memset(temporal->kept, UNKNOWN, (size_t)temporal->width * (size_t)temporal->height);
	} else if (!gz_camera_same(&temporal->shown.camera, &content->camera)) {
		join.moves = true;
		join.weight = (float)params->weight;
		join.knows_movement = find_movement(temporal, content, &join.movement);
		temporal->still_frames = 0;
	}
	join_frame(&join);
	temporal->shown = *content;
	temporal->any = true;
	temporal->frame = (temporal->frame + 1) % FRAMES;
	temporal->still_frames++;
	return GZ_OK;
}

bool gz_temporal_settling(const struct gz_temporal *temporal)
{
	return temporal->any && temporal->still_frames < FRAMES;
}

void gz_temporal_forget(struct gz_temporal *temporal)
{
	temporal->any = false;
	temporal->frame = temporal->still_frames = 0;
}

void gz_temporal_free(struct gz_temporal *temporal)
{
	gz_workers_destroy(&temporal->workers);
	gz_image_free(&temporal->frame_image);
	gz_image_free(&temporal->history);
	gz_image_free(&temporal->moved);
	free(temporal->kept);
	free(temporal->errors);
	free(temporal->cast);
	*temporal = (struct gz_temporal) { 0 };
}
