#include "view/panels/panel_places.h"

#include <math.h>
#include <stddef.h>

/* Places along an axis that are tried: at the edges of the room, and beside the other panels. */
enum { EDGES_MAX = 2 * GZ_PANEL_OTHERS_MAX + 2 };

/* What is being placed: the panel, or a title. */
struct placed {
	float size[2], wanted[2];
	const struct gz_panel_other *own; /* not in its own way; NULL: the panel, which is new */
};

static float overlap(float a, float a_size, float b, float b_size)
{
	return fmaxf(0, fminf(a + a_size, b + b_size) - fmaxf(a, b));
}

/* Area of others that is covered from a corner on. */
static float covered_area(const struct gz_panel_placing *placing, const struct placed *placed,
			  const float corner[2])
{
	float area = 0;
	for (int i = 0; i < placing->count; i++) {
		const struct gz_panel_rectangle *at = &placing->others[i].at;
		if (&placing->others[i] != placed->own)
			area += overlap(corner[0], placed->size[0], at->x, at->width) *
				overlap(corner[1], placed->size[1], at->y, at->height);
	}
	return area;
}

static int possible_edges(const struct gz_panel_placing *placing, const struct placed *placed,
			  int axis, float edges[EDGES_MAX])
{
	const struct gz_panel_rectangle *room = &placing->room;
	const float size = placed->size[axis];
	int count = 0;
	edges[count++] = axis ? room->y : room->x;
	edges[count++] = (axis ? room->y + room->height : room->x + room->width) - size;
	for (int i = 0; i < placing->count; i++) {
		const struct gz_panel_rectangle *at = &placing->others[i].at;
		const float from = axis ? at->y : at->x, length = axis ? at->height : at->width;
		if (&placing->others[i] == placed->own)
			continue;
		edges[count++] = from + length + placing->gap;
		edges[count++] = from - size - placing->gap;
	}
	return count;
}

static bool has_room(const struct gz_panel_rectangle *room, const struct placed *placed,
		     const float corner[2])
{
	return corner[0] >= room->x && corner[1] >= room->y &&
	       corner[0] + placed->size[0] <= room->x + room->width + 1 &&
	       corner[1] + placed->size[1] <= room->y + room->height + 1;
}

/* The place nearest to the wanted one of those that cover least. @return the area covered */
static float least_covering(const struct gz_panel_placing *placing, const struct placed *placed,
			    float best[2])
{
	float x[EDGES_MAX], y[EDGES_MAX], best_way = 0;
	const int columns = possible_edges(placing, placed, 0, x);
	const int rows = possible_edges(placing, placed, 1, y);
	best[0] = placed->wanted[0];
	best[1] = placed->wanted[1];
	float best_area = covered_area(placing, placed, best);
	for (int i = 0; i < columns * rows; i++) {
		const float at[2] = { x[i % columns], y[i / columns] };
		if (!has_room(&placing->room, placed, at))
			continue;
		const float area = covered_area(placing, placed, at);
		const float way =
			fabsf(at[0] - placed->wanted[0]) + fabsf(at[1] - placed->wanted[1]);
		if (area < best_area || (area == best_area && way < best_way)) {
			best[0] = at[0];
			best[1] = at[1];
			best_area = area;
			best_way = way;
		}
	}
	return best_area;
}

/* Fold the earliest panel that is not folded. @return whether there is one */
static bool fold_earliest(struct gz_panel_placing *placing)
{
	struct gz_panel_other *earliest = NULL;
	float corner[2];
	for (int i = 0; i < placing->count; i++) {
		struct gz_panel_other *other = &placing->others[i];
		if (!other->folded && (!earliest || other->opened < earliest->opened))
			earliest = other;
	}
	if (!earliest)
		return false;
	earliest->folded = true;
	earliest->at.height = earliest->title_height;
	const struct placed title = {
		.size = { earliest->at.width, earliest->title_height },
		.wanted = { earliest->at.x, placing->room.y },
		.own = earliest,
	};
	least_covering(placing, &title, corner);
	earliest->at.x = corner[0];
	earliest->at.y = corner[1];
	return true;
}

void gz_panel_find_place(struct gz_panel_placing *placing, float out_corner[2])
{
	const struct placed panel = {
		.size = { placing->width, placing->height },
		.wanted = { placing->wanted[0], placing->wanted[1] },
	};
	struct gz_panel_placing folded = *placing;
	float corner[2];
	if (least_covering(placing, &panel, out_corner) == 0)
		return;
	while (fold_earliest(&folded))
		if (least_covering(&folded, &panel, corner) == 0) {
			*placing = folded;
			out_corner[0] = corner[0];
			out_corner[1] = corner[1];
			return;
		}
}
