#include "render/illustration/hatch_lines.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/illustration/stipple_project.h"

enum {
	PART_STROKES = 64,
	TONES = 17,
};

/* Lines never grow further for want of strokes. Chosen: what is wider is no hatching. */
#define WIDENING_MAX 8.0F

/* Ink above which a second layer helps the first. Chosen by eye: crossed strokes are for shadows.
 */
#define CROSS_FROM 0.45F

/* Densities of ink 0, 1/16, ... 16/16 of DARKEST: measured on squares with straight and with bent
 * strokes of 1, 1.5 and 3 px, which differ by less than 1 %. */
#define DARKEST 0.98F
static const float densities[TONES] = { 0.000F, 0.061F, 0.121F, 0.183F, 0.245F, 0.307F,
					0.370F, 0.433F, 0.495F, 0.559F, 0.625F, 0.692F,
					0.763F, 0.840F, 0.930F, 1.053F, 1.433F };

float gz_hatch_layer_ink(enum gz_hatch_layer layer, float ink)
{
	if (layer == GZ_HATCH_ONLY)
		return ink;
	const float first = ink < CROSS_FROM ? ink : CROSS_FROM + 0.5F * (ink - CROSS_FROM);
	return layer == GZ_HATCH_FIRST ? first : 1 - (1 - ink) / (1 - first);
}

float gz_hatch_density(float ink)
{
	const float at = ink * ((TONES - 1) / DARKEST);
	if (!(at > 0))
		return 0;
	if (at >= TONES - 1)
		return densities[TONES - 1];
	const size_t low = (size_t)at;
	return densities[low] + (at - (float)low) * (densities[low + 1] - densities[low]);
}

/* Lighter tones have thinner lines instead of fewer. Chosen by eye: a line by itself, far from
 * others, is no tone. */
#define THINNER_BELOW 0.25F

struct hatch_choice {
	const struct gz_hatch_strokes *strokes;
	struct gz_stipple_projector projector;
	enum gz_hatch_layer layer;
	float width;                     /* of lines at the gaze, px */
	struct gz_stipple_piece *pieces; /* a place for each node */
	uint32_t *counts;                /* of pieces, by stroke */
};

/* A node in the picture. */
struct hatch_spot {
	struct gz_stipple_spot spot;
	bool seen;
};

static struct hatch_spot find_spot(const struct hatch_choice *choice,
				   const struct gz_hatch_node *node)
{
	struct hatch_spot found;
	found.seen =
		gz_stipple_project(&choice->projector, node->place, node->normal, &found.spot) &&
		gz_stipple_spot_near(&choice->projector, &found.spot) &&
		gz_stipple_spot_seen(&choice->projector, node->normal, &found.spot);
	return found;
}

/* The width of a stroke at a place; 0 where it does not show. @param px_per_mm  along the stroke */
static float width_at(const struct hatch_choice *choice, float before_mm,
		      const struct gz_stipple_spot *spot, float px_per_mm)
{
	const struct gz_hatch_strokes *strokes = choice->strokes;
	const float ink =
		gz_hatch_layer_ink(choice->layer, gz_stipple_ink_at(&choice->projector, spot));
	const float width = choice->width *
			    gz_stipple_scale_at(choice->projector.view->scale, spot->x, spot->y);
	const float density = gz_hatch_density(ink);
	const float thin = density < THINNER_BELOW ? density / THINNER_BELOW : 1;
	const float limit = fmaxf(density, THINNER_BELOW) / (width * (1 - GZ_HATCH_TAPER / 2)) *
			    spot->px2_per_mm2 / px_per_mm * (float)strokes->area_mm2;
	/* with too few strokes, all of them are as they are in a view that they suffice for, but
	 * wider */
	const float there = fminf(limit, (float)strokes->length_mm);
	if (!(before_mm < there))
		return 0;
	const float left = (there - before_mm) / (GZ_HATCH_TAPER * there);
	return thin * width * fminf(limit / there, WIDENING_MAX) * (left < 1 ? left : 1);
}

/* The piece between two nodes that are seen, if any of it shows. */
static bool make_piece(const struct hatch_choice *choice, const struct gz_hatch_stroke *stroke,
		       const struct gz_hatch_node *nodes, const struct hatch_spot spots[2],
		       struct gz_stipple_piece *out_piece)
{
	float square_mm = 0;
	for (int axis = 0; axis < 3; axis++) {
		const float step = nodes[1].place[axis] - nodes[0].place[axis];
		square_mm += step * step;
	}
	const float right = spots[1].spot.x - spots[0].spot.x;
	const float down = spots[1].spot.y - spots[0].spot.y;
	const float square_px = right * right + down * down;
	if (!(square_px > 0) || !(square_mm > 0))
		return false;
	const float px_per_mm = sqrtf(square_px / square_mm);
	*out_piece = (struct gz_stipple_piece) {
		.from = { spots[0].spot.x, spots[0].spot.y },
		.to = { spots[1].spot.x, spots[1].spot.y },
		.from_width = width_at(choice, stroke->before_mm, &spots[0].spot, px_per_mm),
		.to_width = width_at(choice, stroke->before_mm, &spots[1].spot, px_per_mm),
	};
	return out_piece->from_width > 0 || out_piece->to_width > 0;
}

/* How wide a stroke is at a node for its being near an end: 0 at the end, 1 within. */
static float pointed_at(const struct gz_hatch_stroke *stroke, uint32_t node)
{
	const uint32_t from_end = stroke->count - 1 - node;
	const uint32_t steps = node < from_end ? node : from_end;
	return steps < GZ_HATCH_POINTED ? (float)steps / GZ_HATCH_POINTED : 1;
}

static uint32_t choose_in_stroke(const struct hatch_choice *choice,
				 const struct gz_hatch_stroke *stroke)
{
	const struct gz_hatch_node *nodes = choice->strokes->nodes + stroke->first;
	struct gz_stipple_piece *pieces = choice->pieces + stroke->first;
	struct hatch_spot spots[2];
	uint32_t count = 0;
	spots[0] = find_spot(choice, &nodes[0]);
	for (uint32_t i = 0; i + 1 < stroke->count; i++) {
		spots[1] = find_spot(choice, &nodes[i + 1]);
		if (spots[0].seen && spots[1].seen &&
		    make_piece(choice, stroke, nodes + i, spots, &pieces[count])) {
			pieces[count].from_width *= pointed_at(stroke, i);
			pieces[count++].to_width *= pointed_at(stroke, i + 1);
		}
		spots[0] = spots[1];
	}
	return count;
}

static void choose_in_strokes(void *user, size_t part, int worker)
{
	(void)worker;
	const struct hatch_choice *choice = user;
	const size_t begin = part * PART_STROKES;
	for (size_t i = begin; i < begin + PART_STROKES && i < choice->strokes->stroke_count; i++)
		choice->counts[i] = choose_in_stroke(choice, &choice->strokes->strokes[i]);
}

static enum gz_result reserve_pieces(struct gz_hatch_lines *lines, size_t more)
{
	const size_t wanted = lines->count + more;
	if (wanted <= lines->capacity)
		return GZ_OK;
	struct gz_stipple_piece *grown = realloc(lines->pieces, wanted * sizeof *grown);
	if (!grown)
		return GZ_ERR_NO_MEM;
	lines->pieces = grown;
	lines->capacity = wanted;
	return GZ_OK;
}

/* Moves the pieces of all strokes together. */
static void gather_pieces(const struct hatch_choice *choice, struct gz_hatch_lines *lines)
{
	for (size_t i = 0; i < choice->strokes->stroke_count; i++) {
		memmove(lines->pieces + lines->count,
			choice->pieces + choice->strokes->strokes[i].first,
			choice->counts[i] * sizeof *lines->pieces);
		lines->count += choice->counts[i];
	}
}

enum gz_result gz_hatch_choose(const struct gz_hatch_strokes *strokes,
			       const struct gz_stipple_view *view, enum gz_hatch_layer layer,
			       struct gz_workers *workers, struct gz_hatch_lines *lines)
{
	struct hatch_choice choice = { .strokes = strokes, .layer = layer };
	if (!gz_stipple_view_valid(view) || !gz_stipple_projector_make(view, &choice.projector))
		return GZ_ERR_INVAL;
	if (strokes->stroke_count == 0)
		return GZ_OK;
	choice.width = (float)view->size_px;
	choice.counts = calloc(strokes->stroke_count, sizeof *choice.counts);
	if (!choice.counts || reserve_pieces(lines, strokes->node_count) != GZ_OK) {
		free(choice.counts);
		return GZ_ERR_NO_MEM;
	}
	choice.pieces = lines->pieces + lines->count;
	const size_t parts = (strokes->stroke_count + PART_STROKES - 1) / PART_STROKES;
	if (workers)
		gz_workers_run(workers, choose_in_strokes, &choice, parts);
	else
		for (size_t part = 0; part < parts; part++)
			choose_in_strokes(&choice, part, 0);
	gather_pieces(&choice, lines);
	free(choice.counts);
	return GZ_OK;
}

void gz_hatch_lines_free(struct gz_hatch_lines *lines)
{
	free(lines->pieces);
	*lines = (struct gz_hatch_lines) { 0 };
}
