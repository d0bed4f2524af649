#include "render/accumulate/temporal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define AT(field) offsetof(struct gz_temporal_params, field)

const struct gz_option gz_temporal_options[] = {
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

enum {
	SHIFTS = GZ_TEMPORAL_SHIFTS,
	FRAMES = SHIFTS * SHIFTS, /* until every pixel was cast */
	GRID = 16,                /* px between places where movement is computed; linear between */
	ROWS_A_PART = 16,
};

/* How far the camera may turn around the volume within a history, degrees. Chosen: the error stays
 * below that of single frames at any speed (tests/render/test_temporal.c). */
#define PARALLAX_DEG 0.7

/* What the threads that join a frame share. */
struct join {
	struct gz_temporal *temporal;
	const struct gz_plan *plan;
	double weight;
	const struct gz_camera *before; /* NULL: the camera is still */
	struct gz_ray_frame rays;
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
	uint8_t **const maps[] = { &temporal->kept, &temporal->kept_moved, &temporal->cast };
	for (size_t i = 0; i < sizeof maps / sizeof maps[0]; i++) {
		free(*maps[i]);
		*maps[i] = malloc(count);
		if (!*maps[i])
			return GZ_ERR_NO_MEM;
	}
	if (gz_image_resize(&temporal->history, width, height) != GZ_OK ||
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
		for (int y = y0; y < y0 + down && spacing > 1; y++)
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

/* Least and greatest value of each channel in the 3x3 pixels a spacing apart around a pixel. */
static void neighbourhood_range(const struct join *join, int x, int y, int spacing, int least[4],
				int greatest[4])
{
	const struct gz_temporal *temporal = join->temporal;
	for (int c = 0; c < 4; c++) {
		least[c] = 255;
		greatest[c] = 0;
	}
	for (int k = 0; k < 9; k++) {
		int at_x = x + (k % 3 - 1) * spacing, at_y = y + (k / 3 - 1) * spacing;
		at_x = at_x < 0 ? 0 : at_x < temporal->width ? at_x : temporal->width - 1;
		at_y = at_y < 0 ? 0 : at_y < temporal->height ? at_y : temporal->height - 1;
		const uint8_t *near = frame_pixel(temporal, at_x, at_y);
		for (int c = 0; c < 4; c++) {
			least[c] = near[c] < least[c] ? near[c] : least[c];
			greatest[c] = near[c] > greatest[c] ? near[c] : greatest[c];
		}
	}
}

/* One pixel while the camera moves. A ray's colour is taken; between rays the history is mixed in,
 * clamped to the range of the frame's neighbourhood. */
static void join_moved(const struct join *join, int x, int y, uint8_t *pixel, uint8_t *kept,
		       uint8_t cast)
{
	const uint8_t *now = frame_pixel(join->temporal, x, y);
	if (cast < BETWEEN || *kept == UNKNOWN) {
		memcpy(pixel, now, 4);
	} else {
		int least[4], greatest[4];
		const int spacing = join->plan->layers[cast - BETWEEN].spacing;
		neighbourhood_range(join, x, y, spacing, least, greatest);
		for (int c = 0; c < 4; c++) {
			const double before = fmin(fmax(pixel[c], least[c]), greatest[c]);
			pixel[c] = (uint8_t)(now[c] + (before - now[c]) * join->weight + 0.5);
		}
	}
	*kept = cast < BETWEEN ? cast : BETWEEN + 4; /* chosen: counts as the mean of 4 frames */
}

static void join_history_rows(void *user, size_t part, int worker)
{
	(void)worker;
	const struct join *join = user;
	struct gz_temporal *temporal = join->temporal;
	const int from = (int)part * ROWS_A_PART;
	for (int y = from; y < from + ROWS_A_PART && y < temporal->height; y++) {
		const size_t row = (size_t)y * (size_t)temporal->width;
		for (int x = 0; x < temporal->width; x++) {
			const size_t i = row + (size_t)x;
			uint8_t *pixel = temporal->history.pixels + 4 * i;
			if (join->before)
				join_moved(join, x, y, pixel, &temporal->kept[i],
					   temporal->cast[i]);
			else
				join_still(pixel, &temporal->kept[i], frame_pixel(temporal, x, y),
					   temporal->cast[i]);
		}
		memcpy(join->out + row, temporal->history.pixels + 4 * row,
		       (size_t)temporal->width * 4);
	}
}

/* The place in the earlier frame of what pixel (x, y) shows now. Rays do not know the depth of
 * their colour, so the point of the ray nearest to the volume's centre stands for it. NAN: not in
 * view. */
static void find_movement(const struct join *join, int x, int y, double place[2])
{
	double origin[3], direction[3], world[3], along = 0, length2 = 0;
	for (int axis = 0; axis < 3; axis++) {
		origin[axis] = join->rays.origin00[axis] + x * join->rays.origin_dx[axis] +
			       y * join->rays.origin_dy[axis];
		direction[axis] = join->rays.direction00[axis] + x * join->rays.direction_dx[axis] +
				  y * join->rays.direction_dy[axis];
		along -= origin[axis] * direction[axis];
		length2 += direction[axis] * direction[axis];
	}
	for (int axis = 0; axis < 3; axis++)
		world[axis] = origin[axis] + direction[axis] * fmax(along / length2, 1e-3);
	struct gz_point point;
	const int width = join->temporal->width, height = join->temporal->height;
	if (!gz_camera_project(join->before, width, height, world, &point)) {
		place[0] = place[1] = NAN;
		return;
	}
	place[0] = (double)point.x * width - 0.5;
	place[1] = (double)point.y * height - 0.5;
}

/* A pixel of the history, interpolated between four; false beyond its edges. */
static bool sample_history(const struct gz_temporal *temporal, double x, double y, uint8_t *pixel)
{
	if (!(x >= 0 && y >= 0 && x <= temporal->width - 1 && y <= temporal->height - 1))
		return false;
	const int x0 = (int)x, y0 = (int)y;
	const int x1 = x0 + 1 < temporal->width ? x0 + 1 : x0;
	const int y1 = y0 + 1 < temporal->height ? y0 + 1 : y0;
	const double u = x - x0, v = y - y0;
	const uint8_t *above = temporal->history.pixels + 4 * (size_t)y0 * (size_t)temporal->width;
	const uint8_t *below = temporal->history.pixels + 4 * (size_t)y1 * (size_t)temporal->width;
	for (int c = 0; c < 4; c++)
		pixel[c] =
			(uint8_t)((above[4 * x0 + c] * (1 - u) + above[4 * x1 + c] * u) * (1 - v) +
				  (below[4 * x0 + c] * (1 - u) + below[4 * x1 + c] * u) * v + 0.5);
	return true;
}

/* Move rows of the history to where the camera sees them now, one square of the grid at a time. */
static void move_rows(void *user, size_t part, int worker)
{
	(void)worker;
	const struct join *join = user;
	struct gz_temporal *temporal = join->temporal;
	const int top = (int)part * GRID;
	for (int left = 0; left < temporal->width; left += GRID) {
		double corners[4][2];
		for (int k = 0; k < 4; k++)
			find_movement(join, left + (k & 1) * GRID, top + (k >> 1) * GRID,
				      corners[k]);
		for (int y = top; y < top + GRID && y < temporal->height; y++)
			for (int x = left; x < left + GRID && x < temporal->width; x++) {
				const double u = (double)(x - left) / GRID;
				const double v = (double)(y - top) / GRID;
				double at[2];
				for (int axis = 0; axis < 2; axis++)
					at[axis] = (corners[0][axis] * (1 - u) +
						    corners[1][axis] * u) *
							   (1 - v) +
						   (corners[2][axis] * (1 - u) +
						    corners[3][axis] * u) *
							   v;
				const size_t i = (size_t)y * (size_t)temporal->width + (size_t)x;
				const bool known = sample_history(temporal, at[0], at[1],
								  temporal->moved.pixels + 4 * i);
				temporal->kept_moved[i] = known ? BETWEEN : UNKNOWN;
			}
	}
}

/* Angle that the camera moved around the volume's centre. */
static double parallax_deg(const struct gz_camera *before, const struct gz_camera *now)
{
	double product = 0, before2 = 0, now2 = 0;
	for (int axis = 0; axis < 3; axis++) {
		product += before->eye[axis] * now->eye[axis];
		before2 += before->eye[axis] * before->eye[axis];
		now2 += now->eye[axis] * now->eye[axis];
	}
	const double cosine = product / sqrt(before2 * now2);
	return cosine >= 1 ? 0 : cosine > -1 ? acos(cosine) * 180 / M_PI : 180; /* NAN too */
}

/* Content in front of or behind the place that stands for a ray moves differently. A weighted mean
 * reaches back over 1 / (1 - weight) frames; the weight is limited so that the camera turns by at
 * most PARALLAX_DEG within them. */
static double history_weight(double weight, double deg)
{
	return fmax(fmin(weight, 1 - deg / PARALLAX_DEG), 0);
}

static void move_history(struct join *join)
{
	struct gz_temporal *temporal = join->temporal;
	gz_workers_run(temporal->workers, move_rows, join,
		       ((size_t)temporal->height + GRID - 1) / GRID);
	const struct gz_image image = temporal->history;
	temporal->history = temporal->moved;
	temporal->moved = image;
	uint8_t *const kept = temporal->kept;
	temporal->kept = temporal->kept_moved;
	temporal->kept_moved = kept;
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
	} else if (!gz_camera_same(&temporal->shown.camera, &content->camera) &&
		   gz_camera_rays(&content->camera, temporal->width, temporal->height,
				  &join.rays) == GZ_OK) {
		join.before = &temporal->shown.camera;
		join.weight =
			history_weight(params->weight, parallax_deg(join.before, &content->camera));
		move_history(&join);
		temporal->still_frames = 0;
	}
	gz_workers_run(temporal->workers, join_history_rows, &join,
		       ((size_t)temporal->height + ROWS_A_PART - 1) / ROWS_A_PART);
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
	free(temporal->kept_moved);
	free(temporal->cast);
	*temporal = (struct gz_temporal) { 0 };
}
