#include "view/window/uncovered.h"

#include <stdlib.h>

#include "view/panels/widgets.h"
#include "view/window/window_state.h"

static int compare_edges(const void *a, const void *b)
{
	const int first = *(const int *)a, second = *(const int *)b;
	return (first > second) - (first < second);
}

/* How far a place in a row is covered: to the end of a rectangle there, or not at all (to itself);
 * *out_next is where the next one begins, at most `end`. */
static int covered_until(const struct gz_pixel_rectangle *covered, int count, int x, int y, int end,
			 int *out_next)
{
	int until = x;
	*out_next = end;
	for (int i = 0; i < count; i++) {
		const struct gz_pixel_rectangle *place = &covered[i];
		const int left = place->left, right = place->left + place->width;
		if (y < place->bottom || y >= place->bottom + place->height)
			continue;
		if (left <= x && right > until)
			until = right;
		else if (left > x && left < *out_next)
			*out_next = left;
	}
	return until;
}

/* Draw what is not covered of some rows. */
static void draw_uncovered_rows(const struct gz_window *window, const int size_px[2],
				const struct gz_pixel_rectangle *covered, int count,
				const int rows[2])
{
	int x = 0;
	while (x < size_px[0]) {
		int next;
		const int until = covered_until(covered, count, x, rows[0], size_px[0], &next);
		if (until == x) {
			gz_quad_draw_part(&window->quad, size_px[0], size_px[1],
					  (const int[2]) { x, rows[0] },
					  (const int[2]) { next - x, rows[1] - rows[0] });
			x = next;
		} else {
			x = until;
		}
	}
}

void gz_window_draw_uncovered(const struct gz_window *window, int width, int height)
{
	struct gz_pixel_rectangle covered[GZ_WIDGETS_COVERED_MAX];
	int edges[2 * GZ_WIDGETS_COVERED_MAX + 2] = { 0, height }, edge_count = 2;
	const int count = gz_widgets_covered(covered), size_px[2] = { width, height };
	for (int i = 0; i < count; i++) {
		const int ends[2] = { covered[i].bottom, covered[i].bottom + covered[i].height };
		for (int end = 0; end < 2; end++)
			if (ends[end] > 0 && ends[end] < height)
				edges[edge_count++] = ends[end];
	}
	qsort(edges, (size_t)edge_count, sizeof edges[0], compare_edges);
	for (int i = 0; i + 1 < edge_count; i++)
		if (edges[i] < edges[i + 1])
			draw_uncovered_rows(window, size_px, covered, count, edges + i);
}
