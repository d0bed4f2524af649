/**
 * @file
 * Editing a transfer function with undo and redo: add, move, remove and colour points.
 * view/panels/transfer_panel.h draws it.
 *
 * The transfer function is valid at any time: values rise, at most two points share a value, all
 * numbers are 0 to 1, and there is at least one point.
 */
#ifndef GZ_VIEW_PANELS_TRANSFER_EDIT_H
#define GZ_VIEW_PANELS_TRANSFER_EDIT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "render/transfer/transfer.h"

/** Most steps that can be undone. */
#define GZ_TRANSFER_EDIT_STEPS 100

/** Least distance between a point and a pair of points that share a value. Chosen: less than a
 *  16-bit value's share of the range, and kept by any file. */
#define GZ_TRANSFER_EDIT_GAP 1e-6

/** No point. */
#define GZ_TRANSFER_EDIT_NONE ((size_t)-1)

struct gz_transfer_edit;

/**
 * Begin with @p transfer, which is not changed yet.
 *
 * @param[out] out_edit  owned by the caller: gz_transfer_edit_destroy()
 * @retval GZ_ERR_NO_MEM  no room for the steps; not logged
 */
enum gz_result gz_transfer_edit_create(const struct gz_transfer *transfer,
				       struct gz_transfer_edit **out_edit);

/** Free and set to NULL. Accepts a pointer to NULL. */
void gz_transfer_edit_destroy(struct gz_transfer_edit **edit);

/** The present transfer function. Valid until the next call that takes a mutable @p edit. */
const struct gz_transfer *gz_transfer_edit_now(const struct gz_transfer_edit *edit);

/** Whether the present one equals @p transfer. */
bool gz_transfer_edit_is(const struct gz_transfer_edit *edit, const struct gz_transfer *transfer);

/** A number that changes with each change, undo and redo. */
uint64_t gz_transfer_edit_changes(const struct gz_transfer_edit *edit);

/** Whether the present one differs from the first one, or from the one at the last
 *  gz_transfer_edit_saved(). */
bool gz_transfer_edit_differs(const struct gz_transfer_edit *edit);

/** Forget all steps and begin again with @p transfer: another scene is shown. */
void gz_transfer_edit_restart(struct gz_transfer_edit *edit, const struct gz_transfer *transfer);

/** The present one has been saved. */
void gz_transfer_edit_saved(struct gz_transfer_edit *edit);

/** Begin a drag: all changes until gz_transfer_edit_end() are one step, or none if they cancel out.
 *  Ends a drag that goes on. */
void gz_transfer_edit_begin(struct gz_transfer_edit *edit);

/** Whether a drag goes on. */
bool gz_transfer_edit_in_drag(const struct gz_transfer_edit *edit);

/** End the drag, if one goes on. */
void gz_transfer_edit_end(struct gz_transfer_edit *edit);

/** Replace it by @p transfer, which is valid: a preset, another file. One step. */
void gz_transfer_edit_replace(struct gz_transfer_edit *edit, const struct gz_transfer *transfer);

/**
 * Add a point with the colour that the function has at @p value.
 *
 * @param value, opacity  limited to 0 to 1
 * @return its index; GZ_TRANSFER_EDIT_NONE if there are GZ_TRANSFER_POINTS_MAX points already, or
 * two of this value
 */
size_t gz_transfer_edit_add(struct gz_transfer_edit *edit, double value, double opacity);

/** Whether there is room for another point. */
bool gz_transfer_edit_has_room(const struct gz_transfer_edit *edit);

/** Remove a point. @return false for the only point, which stays */
bool gz_transfer_edit_remove(struct gz_transfer_edit *edit, size_t point);

/** Move a point between its neighbours: up to the value of a neighbour, which makes a jump, or up
 * to GZ_TRANSFER_EDIT_GAP before a pair that shares a value. Opacity is limited to 0 to 1. A number
 * that is not finite leaves its coordinate unchanged. */
void gz_transfer_edit_move(struct gz_transfer_edit *edit, size_t point, double value,
			   double opacity);

/** Set the colour of a point; each part is limited to 0 to 1. */
void gz_transfer_edit_colour(struct gz_transfer_edit *edit, size_t point, const double rgb[3]);

/** Set the interpolation between points. */
void gz_transfer_edit_interpolate(struct gz_transfer_edit *edit,
				  enum gz_transfer_interpolation interpolation);

/** Set the data values of 0 and 1; NULL: the least and greatest of the volume. @return false if
 * they are not finite and rising; nothing is changed then */
bool gz_transfer_edit_range(struct gz_transfer_edit *edit, const double range[2]);

/** Undo the last step. @return false if there is none */
bool gz_transfer_edit_undo(struct gz_transfer_edit *edit);

/** Redo the last step that was undone. @return false if there is none */
bool gz_transfer_edit_redo(struct gz_transfer_edit *edit);

/** Whether a step can be undone. */
bool gz_transfer_edit_can_undo(const struct gz_transfer_edit *edit);

/** How many steps can be undone. */
int gz_transfer_edit_steps(const struct gz_transfer_edit *edit);

/** Whether a step can be redone. */
bool gz_transfer_edit_can_redo(const struct gz_transfer_edit *edit);

/** What the step does that the next undo takes back, or the next redo does: "point moved". Static
 * text; NULL: there is none. A drag ends first. @param again  of the next redo */
const char *gz_transfer_edit_step_name(struct gz_transfer_edit *edit, bool again);

/** A place on a plot of the function. */
struct gz_transfer_place {
	double value;      /**< 0 to 1 within the function's range */
	double height;     /**< on the axis of opacity: gz_transfer_axis_of() */
	double per_value;  /**< px that a value of 1 is wide */
	double per_height; /**< px that a height of 1 is high */
	bool logarithmic;  /**< the axis of opacity is */
};

/** The point nearest to @p place. @param reach px; farther points do not count @return its index;
 *  GZ_TRANSFER_EDIT_NONE: no point is in reach */
size_t gz_transfer_edit_nearest(const struct gz_transfer_edit *edit,
				const struct gz_transfer_place *place, double reach);

/** Height of an opacity a on its axis, 0 to 1: a itself or, on a logarithmic axis, log(1 + k a) /
 *  log(1 + k) with k = 10000 (chosen: the lower half shows opacities per voxel length up to a
 *  hundredth, as large translucent volumes have; 0 stays at 0). */
double gz_transfer_axis_of(double opacity, bool logarithmic);

/** The opacity at a height, limited to 0 to 1. */
double gz_transfer_axis_opacity(double height, bool logarithmic);

#endif
