#include "view/panels/transfer_edit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define AXIS_K 10000.0

/* A ring of past, present and future functions. */
enum { SLOTS = GZ_TRANSFER_EDIT_STEPS + 1 };

struct gz_transfer_edit {
	struct gz_transfer slots[SLOTS];
	int now;          /* slot of the present function */
	int past, future; /* number of slots before and behind it */
	struct gz_transfer saved;
	uint64_t changes;
	bool dragging;
	bool drag_has_step;
};

static struct gz_transfer *present_transfer(struct gz_transfer_edit *edit)
{
	return &edit->slots[edit->now];
}

enum gz_result gz_transfer_edit_create(const struct gz_transfer *transfer,
				       struct gz_transfer_edit **out_edit)
{
	struct gz_transfer_edit *edit = calloc(1, sizeof *edit);
	if (!edit)
		return GZ_ERR_NO_MEM;
	gz_transfer_edit_restart(edit, transfer);
	*out_edit = edit;
	return GZ_OK;
}

void gz_transfer_edit_destroy(struct gz_transfer_edit **edit)
{
	free(*edit);
	*edit = NULL;
}

const struct gz_transfer *gz_transfer_edit_now(const struct gz_transfer_edit *edit)
{
	return &edit->slots[edit->now];
}

bool gz_transfer_edit_is(const struct gz_transfer_edit *edit, const struct gz_transfer *transfer)
{
	return gz_transfer_same(gz_transfer_edit_now(edit), transfer);
}

uint64_t gz_transfer_edit_changes(const struct gz_transfer_edit *edit)
{
	return edit->changes;
}

bool gz_transfer_edit_differs(const struct gz_transfer_edit *edit)
{
	return !gz_transfer_same(gz_transfer_edit_now(edit), &edit->saved);
}

void gz_transfer_edit_restart(struct gz_transfer_edit *edit, const struct gz_transfer *transfer)
{
	edit->saved = *transfer;
	edit->now = edit->past = edit->future = 0;
	*present_transfer(edit) = edit->saved;
	edit->dragging = false;
	edit->changes++;
}

void gz_transfer_edit_saved(struct gz_transfer_edit *edit)
{
	edit->saved = *gz_transfer_edit_now(edit);
}

static void step_back_once(struct gz_transfer_edit *edit)
{
	edit->now = (edit->now + SLOTS - 1) % SLOTS;
	edit->past--;
	edit->future++;
	edit->changes++;
}

void gz_transfer_edit_begin(struct gz_transfer_edit *edit)
{
	gz_transfer_edit_end(edit);
	edit->dragging = true;
	edit->drag_has_step = false;
}

bool gz_transfer_edit_in_drag(const struct gz_transfer_edit *edit)
{
	return edit->dragging;
}

void gz_transfer_edit_end(struct gz_transfer_edit *edit)
{
	if (edit->dragging && edit->drag_has_step) {
		const int before = (edit->now + SLOTS - 1) % SLOTS;
		if (gz_transfer_same(present_transfer(edit), &edit->slots[before])) {
			step_back_once(edit);
			edit->future = 0;
		}
	}
	edit->dragging = false;
}

/* The function to change: a new step, unless a drag has begun one. */
static struct gz_transfer *begin_change(struct gz_transfer_edit *edit)
{
	edit->changes++;
	if (edit->dragging && edit->drag_has_step)
		return present_transfer(edit);
	const int next = (edit->now + 1) % SLOTS;
	edit->slots[next] = *present_transfer(edit);
	edit->now = next;
	edit->past += edit->past < GZ_TRANSFER_EDIT_STEPS;
	edit->future = 0;
	edit->drag_has_step = true;
	return present_transfer(edit);
}

void gz_transfer_edit_replace(struct gz_transfer_edit *edit, const struct gz_transfer *transfer)
{
	if (!gz_transfer_same(transfer, present_transfer(edit)))
		*begin_change(edit) = *transfer;
}

static double within_0_1(double value)
{
	return value > 0 ? value < 1 ? value : 1 : 0;
}

bool gz_transfer_edit_has_room(const struct gz_transfer_edit *edit)
{
	return gz_transfer_edit_now(edit)->count < GZ_TRANSFER_POINTS_MAX;
}

size_t gz_transfer_edit_add(struct gz_transfer_edit *edit, double value, double opacity)
{
	const struct gz_transfer *now = present_transfer(edit);
	value = within_0_1(value);
	size_t at = 0, equal = 0;
	for (; at < now->count && now->points[at].value <= value; at++)
		equal += now->points[at].value == value;
	if (equal >= 2 || !gz_transfer_edit_has_room(edit))
		return GZ_TRANSFER_EDIT_NONE;
	double rgba[4];
	gz_transfer_evaluate(now, value, rgba);
	struct gz_transfer *transfer = begin_change(edit);
	struct gz_transfer_point *point = &transfer->points[at];
	memmove(point + 1, point, (transfer->count - at) * sizeof *point);
	transfer->count++;
	*point = (struct gz_transfer_point) {
		.value = value,
		.rgb = { rgba[0], rgba[1], rgba[2] },
		.opacity = within_0_1(opacity),
	};
	return at;
}

bool gz_transfer_edit_remove(struct gz_transfer_edit *edit, size_t point)
{
	if (present_transfer(edit)->count < 2 || point >= present_transfer(edit)->count)
		return false;
	struct gz_transfer *transfer = begin_change(edit);
	transfer->count--;
	memmove(&transfer->points[point], &transfer->points[point + 1],
		(transfer->count - point) * sizeof transfer->points[0]);
	return true;
}

/* The values that a point may have between its neighbours. */
static void room_of_point(const struct gz_transfer *transfer, size_t point, double *out_least,
			  double *out_greatest)
{
	const struct gz_transfer_point *p = &transfer->points[point];
	*out_least = 0;
	*out_greatest = 1;
	if (point >= 1) {
		const bool pair = point >= 2 && p[-1].value == p[-2].value;
		*out_least = fmin(p[-1].value + (pair ? GZ_TRANSFER_EDIT_GAP : 0), p->value);
	}
	if (point + 1 < transfer->count) {
		const bool pair = point + 2 < transfer->count && p[1].value == p[2].value;
		*out_greatest = fmax(p[1].value - (pair ? GZ_TRANSFER_EDIT_GAP : 0), p->value);
	}
}

void gz_transfer_edit_move(struct gz_transfer_edit *edit, size_t point, double value,
			   double opacity)
{
	const struct gz_transfer *now = present_transfer(edit);
	if (point >= now->count)
		return;
	struct gz_transfer_point moved = now->points[point];
	double least, greatest;
	room_of_point(now, point, &least, &greatest);
	if (isfinite(value))
		moved.value = fmin(fmax(value, least), greatest);
	if (isfinite(opacity))
		moved.opacity = within_0_1(opacity);
	if (!gz_transfer_point_same(&moved, &now->points[point]))
		begin_change(edit)->points[point] = moved;
}

void gz_transfer_edit_colour(struct gz_transfer_edit *edit, size_t point, const double rgb[3])
{
	if (point >= present_transfer(edit)->count)
		return;
	struct gz_transfer_point coloured = present_transfer(edit)->points[point];
	for (int i = 0; i < 3; i++)
		coloured.rgb[i] = within_0_1(rgb[i]);
	if (!gz_transfer_point_same(&coloured, &present_transfer(edit)->points[point]))
		begin_change(edit)->points[point] = coloured;
}

void gz_transfer_edit_interpolate(struct gz_transfer_edit *edit,
				  enum gz_transfer_interpolation interpolation)
{
	if (present_transfer(edit)->interpolation != interpolation)
		begin_change(edit)->interpolation = interpolation;
}

bool gz_transfer_edit_range(struct gz_transfer_edit *edit, const double range[2])
{
	const struct gz_transfer *now = present_transfer(edit);
	if (!range) {
		if (now->has_range)
			begin_change(edit)->has_range = false;
		return true;
	}
	if (!isfinite(range[0]) || !isfinite(range[1]) || !(range[0] < range[1]))
		return false;
	if (now->has_range && now->range[0] == range[0] && now->range[1] == range[1])
		return true;
	struct gz_transfer *transfer = begin_change(edit);
	transfer->has_range = true;
	memcpy(transfer->range, range, sizeof transfer->range);
	return true;
}

bool gz_transfer_edit_can_undo(const struct gz_transfer_edit *edit)
{
	return edit->past > 0;
}

int gz_transfer_edit_steps(const struct gz_transfer_edit *edit)
{
	return edit->past;
}

bool gz_transfer_edit_can_redo(const struct gz_transfer_edit *edit)
{
	return edit->future > 0;
}

bool gz_transfer_edit_undo(struct gz_transfer_edit *edit)
{
	gz_transfer_edit_end(edit);
	if (!gz_transfer_edit_can_undo(edit))
		return false;
	step_back_once(edit);
	return true;
}

bool gz_transfer_edit_redo(struct gz_transfer_edit *edit)
{
	gz_transfer_edit_end(edit);
	if (!gz_transfer_edit_can_redo(edit))
		return false;
	edit->now = (edit->now + 1) % SLOTS;
	edit->past++;
	edit->future--;
	edit->changes++;
	return true;
}

/* What one step changes from one function to the next, if they have as many points. */
static const char *name_of_change(const struct gz_transfer *before, const struct gz_transfer *after)
{
	size_t changed = 0, last = 0;
	for (size_t i = 0; i < before->count; i++)
		if (!gz_transfer_point_same(&before->points[i], &after->points[i])) {
			changed++;
			last = i;
		}
	const struct gz_transfer_point *a = &before->points[last], *b = &after->points[last];
	if (changed > 1)
		return "points replaced";
	if (changed == 1)
		return a->value == b->value && a->opacity == b->opacity ? "point coloured"
									: "point moved";
	return before->interpolation != after->interpolation ? "interpolation" : "range";
}

static const char *name_of_step(const struct gz_transfer *before, const struct gz_transfer *after)
{
	if (after->count == before->count)
		return name_of_change(before, after);
	if (after->count == before->count + 1)
		return "point added";
	return before->count == after->count + 1 ? "point removed" : "points replaced";
}

const char *gz_transfer_edit_step_name(struct gz_transfer_edit *edit, bool again)
{
	gz_transfer_edit_end(edit);
	if (again ? edit->future == 0 : edit->past == 0)
		return NULL;
	const int other = (edit->now + (again ? 1 : SLOTS - 1)) % SLOTS;
	return again ? name_of_step(&edit->slots[edit->now], &edit->slots[other])
		     : name_of_step(&edit->slots[other], &edit->slots[edit->now]);
}

size_t gz_transfer_edit_nearest(const struct gz_transfer_edit *edit,
				const struct gz_transfer_place *place, double reach)
{
	const struct gz_transfer *now = gz_transfer_edit_now(edit);
	size_t nearest = GZ_TRANSFER_EDIT_NONE;
	double least = reach;
	for (size_t i = 0; i < now->count; i++) {
		const double at = gz_transfer_axis_of(now->points[i].opacity, place->logarithmic);
		const double distance =
			hypot((now->points[i].value - place->value) * place->per_value,
			      (at - place->height) * place->per_height);
		if (distance <= least) {
			least = distance;
			nearest = i;
		}
	}
	return nearest;
}

double gz_transfer_axis_of(double opacity, bool logarithmic)
{
	return logarithmic ? log1p(AXIS_K * opacity) / log1p(AXIS_K) : opacity;
}

double gz_transfer_axis_opacity(double height, bool logarithmic)
{
	if (!logarithmic || height >= 1)
		return within_0_1(height);
	return within_0_1(expm1(within_0_1(height) * log1p(AXIS_K)) / AXIS_K);
}
