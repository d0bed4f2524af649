#include "render/illustration/shared/illustrate_drawing.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Sizes of marks that struct gz_stipple_view allows. */
#define MARK_LEAST_PX 0.25
#define MARK_MOST_PX  64

/* Rows of the picture that a thread writes at once. */
enum { PART_ROWS = 16 };

static enum gz_result make_plane_room(struct gz_illustrate_drawing *drawing, size_t pixels)
{
	if (drawing->room >= pixels)
		return GZ_OK;
	free(drawing->before);
	free(drawing->outlines);
	free(drawing->layer_lines);
	free(drawing->paper);
	drawing->paper = malloc(pixels * sizeof *drawing->paper);
	drawing->before = malloc(pixels * sizeof *drawing->before);
	drawing->outlines = malloc(pixels * sizeof *drawing->outlines);
	drawing->layer_lines = malloc(pixels * sizeof *drawing->layer_lines);
	const bool complete =
		drawing->before && drawing->outlines && drawing->layer_lines && drawing->paper;
	drawing->room = complete ? pixels : 0;
	return drawing->room > 0 ? GZ_OK : GZ_ERR_NO_MEM;
}

/* Marks grow away from the gaze, unless every pixel is cast. */
static enum gz_result make_mark_scale(const struct gz_plan *plan, struct gz_stipple_scale *scale)
{
	if (!plan->made_for.valid || plan->reconstruction == GZ_RECONSTRUCT_DIRECT) {
		gz_stipple_scale_free(scale);
		return GZ_OK;
	}
	const struct gz_point gaze = { (float)(plan->focus_px[0] / plan->width),
				       (float)(plan->focus_px[1] / plan->height) };
	return gz_stipple_scale_make(&plan->made_for.foveation, &plan->made_for.display, gaze,
				     plan->width, plan->height, scale);
}

/* The rays of a shot's pixels, mm. */
static enum gz_result find_rays(const struct gz_illustrate_shot *shot, double world_mm,
				struct gz_ray_frame *out_rays)
{
	const enum gz_result result = gz_plan_rays(shot->plan, shot->camera, out_rays);
	for (int axis = 0; axis < 3 && result == GZ_OK; axis++) {
		out_rays->origin00[axis] *= world_mm;
		out_rays->origin_dx[axis] *= world_mm;
		out_rays->origin_dy[axis] *= world_mm;
	}
	return result;
}

static enum gz_result make_id_room(struct gz_illustrate_drawing *drawing, size_t ids)
{
	if (drawing->ids_room >= ids)
		return GZ_OK;
	free(drawing->grey_ids);
	free(drawing->hatched_ids);
	free(drawing->stippled_ids);
	drawing->grey_ids = malloc(ids * sizeof *drawing->grey_ids);
	drawing->hatched_ids = malloc(ids * sizeof *drawing->hatched_ids);
	drawing->stippled_ids = malloc(ids * sizeof *drawing->stippled_ids);
	const bool complete = drawing->grey_ids && drawing->hatched_ids && drawing->stippled_ids;
	drawing->ids_room = complete ? ids : 0;
	return drawing->ids_room > 0 ? GZ_OK : GZ_ERR_NO_MEM;
}

/* Find which objects are grey and which hatched, and whether any are drawn. */
static enum gz_result sort_objects(struct gz_illustrate_drawing *drawing,
				   const struct gz_illustrate_scene *scene)
{
	drawing->drawn = drawing->mixed = false;
	const enum gz_result result = make_id_room(drawing, scene->id_count);
	if (result != GZ_OK)
		return result;
	memset(drawing->grey_ids, 0, scene->id_count * sizeof *drawing->grey_ids);
	memset(drawing->hatched_ids, 0, scene->id_count * sizeof *drawing->hatched_ids);
	memset(drawing->stippled_ids, 0, scene->id_count * sizeof *drawing->stippled_ids);
	for (size_t i = 0; i < scene->count; i++) {
		const enum gz_illustration_drawing kind =
			gz_illustrate_item_drawn(&scene->items[i], drawing->look);
		const size_t index = scene->meshes.items[i].object.id - 1;
		drawing->grey_ids[index] = kind == GZ_DRAWING_GREY;
		drawing->hatched_ids[index] = kind == GZ_DRAWING_HATCHES;
		drawing->stippled_ids[index] = kind == GZ_DRAWING_STIPPLES;
		drawing->drawn = drawing->drawn || kind != GZ_DRAWING_GREY;
		drawing->mixed = drawing->mixed || kind == GZ_DRAWING_GREY;
	}
	return GZ_OK;
}

enum gz_result gz_illustrate_drawing_begin(struct gz_illustrate_drawing *drawing,
					   const struct gz_illustrate_scene *scene,
					   const struct gz_illustrate_shot *shot)
{
	const struct gz_plan *plan = shot->plan;
	const size_t pixels = (size_t)plan->width * (size_t)plan->height;
	drawing->look = shot->look;
	enum gz_result result = sort_objects(drawing, scene);
	if (result != GZ_OK || !drawing->drawn)
		return result;
	result = make_plane_room(drawing, pixels);
	if (result == GZ_OK)
		result = gz_plane_resize(&drawing->tone, GZ_PLANE_VALUE, plan->width, plan->height);
	if (result == GZ_OK)
		result = make_mark_scale(plan, &drawing->scale);
	if (result == GZ_OK)
		result = find_rays(shot, scene->meshes.world_mm, &drawing->rays);
	if (result != GZ_OK)
		return result;
	const double rate = plan->made_for.valid ? plan->made_for.request.rays_per_px : 1;
	drawing->pen_px = shot->look->pen_width * rate;
	drawing->width = plan->width;
	drawing->height = plan->height;
	drawing->discs.count = drawing->lines.count = 0;
	drawing->begun = false;
	for (size_t i = 0; i < pixels && drawing->mixed; i++)
		drawing->paper[i] = 1;
	return GZ_OK;
}

/* Before the first of several layers the paper is white. */
static void begin_layers(struct gz_illustrate_drawing *drawing)
{
	const size_t pixels = (size_t)drawing->width * (size_t)drawing->height;
	for (size_t i = 0; i < pixels && !drawing->begun; i++)
		drawing->before[i] = drawing->outlines[i] = 1;
	drawing->begun = true;
	drawing->shown_lines = drawing->outlines;
}

/* Find the tone of a layer's marks, and go on to what is behind it. That of the only layer is its
 * brightness. */
static struct gz_plane take_layer(struct gz_illustrate_drawing *drawing,
				  const struct gz_drawn_layer *layer)
{
	const size_t pixels = (size_t)drawing->width * (size_t)drawing->height;
	if (layer->alone) {
		drawing->shown_lines = drawing->layer_lines;
		return (struct gz_plane) { .kind = GZ_PLANE_VALUE,
					   .width = drawing->width,
					   .height = drawing->height,
					   .words = (uint32_t *)(void *)layer->brightness };
	}
	begin_layers(drawing);
	for (size_t i = 0; i < pixels; i++) {
		const float before = drawing->before[i];
		const float tone = before > 0 ? layer->brightness[i] / before : 1;
		memcpy(&drawing->tone.words[i], &tone, sizeof tone);
		drawing->before[i] = layer->brightness[i];
	}
	for (size_t i = 0; i < pixels; i++)
		drawing->outlines[i] -= 1 - drawing->layer_lines[i];
	return drawing->tone;
}

/* Darken the paper where a layer's object is grey. */
static void add_grey(struct gz_illustrate_drawing *drawing, const struct gz_illustrate_scene *scene,
		     const struct gz_plane *tones, const struct gz_plane *ids)
{
	const size_t pixels = (size_t)drawing->width * (size_t)drawing->height;
	for (size_t i = 0; i < pixels; i++) {
		const size_t id = ids->words[i];
		float tone;
		if (id < 1 || id > scene->id_count || !drawing->grey_ids[id - 1])
			continue;
		memcpy(&tone, &tones->words[i], sizeof tone);
		drawing->paper[i] *= fminf(fmaxf(tone, 0), 1);
	}
}

/* Choose the marks of one object. */
static enum gz_result choose_marks(struct gz_illustrate_drawing *drawing,
				   const struct gz_illustrate_item *item,
				   struct gz_stipple_view *view, struct gz_workers *workers)
{
	static const enum gz_hatch_layer layers[GZ_HATCH_DIRECTIONS] = { GZ_HATCH_FIRST,
									 GZ_HATCH_CROSS };
	const enum gz_illustration_drawing kind = gz_illustrate_item_drawn(item, drawing->look);
	const int first = (int)gz_illustrate_item_direction(item, drawing->look);
	const double size_px = kind == GZ_DRAWING_STIPPLES ? drawing->pen_px / 2 : drawing->pen_px;
	enum gz_result result = GZ_OK;
	view->size_px = fmin(fmax(size_px, MARK_LEAST_PX), MARK_MOST_PX);
	if (kind == GZ_DRAWING_GREY)
		return GZ_OK;
	if (kind == GZ_DRAWING_STIPPLES)
		return gz_stipple_choose(&item->marks.points, view, workers, &drawing->discs);
	for (int i = 0; i < GZ_HATCH_DIRECTIONS && result == GZ_OK; i++)
		result = gz_hatch_choose(&item->marks.strokes[(first + i) % GZ_HATCH_DIRECTIONS],
					 view, layers[i], workers, &drawing->lines);
	return result;
}

/* Make a layer's marks as dark as its tone around each place. @param first_disc, first_line  of the
 * layer */
static enum gz_result balance_layer(struct gz_illustrate_drawing *drawing,
				    const struct gz_illustrate_scene *scene,
				    const struct gz_plane *tone, const struct gz_plane *ids,
				    size_t first_disc, size_t first_line,
				    struct gz_workers *workers)
{
	struct gz_mark_target target = {
		.tone = tone,
		.ids = ids,
		.drawn = drawing->stippled_ids,
		.drawn_count = scene->id_count,
		.size_px = fmin(fmax(drawing->pen_px, MARK_LEAST_PX), MARK_MOST_PX),
		.scale = drawing->scale.factors ? &drawing->scale : NULL,
	};
	enum gz_result result = GZ_OK;
	if (drawing->discs.count > first_disc)
		result = gz_mark_balance_discs(&drawing->balance, &target,
					       drawing->discs.discs + first_disc,
					       drawing->discs.count - first_disc, workers);
	target.drawn = drawing->hatched_ids;
	if (result == GZ_OK && drawing->lines.count > first_line)
		result = gz_mark_balance_lines(&drawing->balance, &target,
					       drawing->lines.pieces + first_line,
					       drawing->lines.count - first_line, workers);
	return result;
}

enum gz_result gz_illustrate_drawing_add(struct gz_illustrate_drawing *drawing,
					 const struct gz_illustrate_scene *scene,
					 const struct gz_drawn_layer *layer,
					 struct gz_workers *workers)
{
	enum gz_result result = GZ_OK;
	const struct gz_plane tone = take_layer(drawing, layer); /* whose words are another's */
	const size_t first_disc = drawing->discs.count, first_line = drawing->lines.count;
	if (drawing->mixed)
		add_grey(drawing, scene, &tone, layer->ids);
	for (size_t i = 0; i < scene->count && result == GZ_OK; i++) {
		struct gz_stipple_view view = {
			.rays = &drawing->rays,
			.world_per_mm = 1,
			.tone = &tone,
			.depth = layer->depth,
			.ids = layer->ids,
			.id = scene->meshes.items[i].object.id,
			.tolerance_px = GZ_STIPPLE_TOLERANCE_PX,
			.scale = drawing->scale.factors ? &drawing->scale : NULL,
			.backs = true,
		};
		result = choose_marks(drawing, &scene->items[i], &view, workers);
	}
	if (result == GZ_OK)
		result = balance_layer(drawing, scene, &tone, layer->ids, first_disc, first_line,
				       workers);
	return result;
}

/* What grey objects leave of what ink leaves of a pixel. */
static uint32_t paper_left(const struct gz_illustrate_drawing *drawing, size_t pixel,
			   uint32_t white)
{
	return drawing->mixed ? (uint32_t)((float)white * drawing->paper[pixel] + 0.5F) : white;
}

/* Paper and ink, and lines over them. */
static void write_rows(void *user, size_t part, int worker)
{
	const struct gz_illustrate_drawing *drawing = ((const void *const *)user)[0];
	struct gz_image *image = ((void *const *)user)[1];
	const int first = (int)part * PART_ROWS;
	(void)worker;
	for (int y = first; y < first + PART_ROWS && y < drawing->height; y++) {
		const size_t from = (size_t)y * (size_t)drawing->width;
		const uint8_t *ink = drawing->sheet.ink + (size_t)y * drawing->sheet.stride;
		const float *outlines = drawing->shown_lines + from;
		uint32_t *pixels = gz_image_words(image) + from;
		for (int x = 0; x < drawing->width; x++) {
			const uint32_t paper = paper_left(drawing, from + (size_t)x, 255U - ink[x]);
			const float left = outlines[x] < 0 ? 0 : outlines[x];
			const uint32_t line = (uint32_t)(int)(left * 255 + 0.5F);
			const uint32_t grey = line < paper ? line : paper;
			pixels[x] = UINT32_C(0xFF000000) | grey << 16 | grey << 8 | grey;
		}
	}
}

enum gz_result gz_illustrate_drawing_finish(struct gz_illustrate_drawing *drawing,
					    struct gz_workers *workers, struct gz_image *image)
{
	struct gz_stipple_sheet *sheet = &drawing->sheet;
	void *both[2] = { drawing, image };
	enum gz_result result = gz_stipple_sheet_clear(sheet, drawing->width, drawing->height);
	if (result == GZ_OK)
		result = gz_stipple_sheet_add_discs(sheet, drawing->discs.discs,
						    drawing->discs.count, workers);
	if (result == GZ_OK)
		result = gz_stipple_sheet_add_pieces(sheet, drawing->lines.pieces,
						     drawing->lines.count, workers);
	if (result == GZ_OK)
		gz_workers_run(workers, write_rows, both,
			       ((size_t)drawing->height + PART_ROWS - 1) / PART_ROWS);
	return result;
}

void gz_illustrate_drawing_free(struct gz_illustrate_drawing *drawing)
{
	gz_stipple_scale_free(&drawing->scale);
	gz_stipple_discs_free(&drawing->discs);
	gz_hatch_lines_free(&drawing->lines);
	gz_mark_balance_free(&drawing->balance);
	gz_stipple_sheet_free(&drawing->sheet);
	gz_plane_free(&drawing->tone);
	free(drawing->before);
	free(drawing->outlines);
	free(drawing->layer_lines);
	free(drawing->paper);
	free(drawing->grey_ids);
	free(drawing->hatched_ids);
	free(drawing->stippled_ids);
	*drawing = (struct gz_illustrate_drawing) { 0 };
}
