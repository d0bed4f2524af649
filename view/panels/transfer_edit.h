/**
 * @file
 * Editing a transfer function: points that are added, moved, removed and coloured, with undo. No
 * drawing: view/panels/transfer_panel.h shows it.
 *
 * What is edited is always a valid transfer function: values rise, at most two points share one,
 * all numbers are 0 to 1, and there is at least one point.
 */
#ifndef GZ_VIEW_PANELS_TRANSFER_EDIT_H
#define GZ_VIEW_PANELS_TRANSFER_EDIT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "render/transfer/transfer.h"

/** Steps that can be taken back. */
#define GZ_TRANSFER_EDIT_STEPS 100

/** Between a point and a pair of points that share a value. Chosen: less than a 16-bit value's
 * share of the range, and written out by any file. */
#define GZ_TRANSFER_EDIT_GAP 1e-6

/** No point. */
#define GZ_TRANSFER_EDIT_NONE ((size_t)-1)

struct gz_transfer_edit;

/**
 * Begin with @p transfer, which is what its file has.
 *
 * @param[out] out_edit  owned by the caller: gz_transfer_edit_destroy()
 * @retval GZ_ERR_NO_MEM  no room for the steps; not logged
 */
enum gz_result gz_transfer_edit_create(const struct gz_transfer *transfer,
				       struct gz_transfer_edit **out_edit);

/** Free and set to NULL. Accepts a pointer to NULL. */
void gz_transfer_edit_destroy(struct gz_transfer_edit **edit);

/** As it is now. Valid until the next call that takes a mutable @p edit. */
const struct gz_transfer *gz_transfer_edit_now(const struct gz_transfer_edit *edit);

/** Whether it is @p transfer now. */
bool gz_transfer_edit_is(const struct gz_transfer_edit *edit, const struct gz_transfer *transfer);

/** A number that is another after each change, undo and redo counted in. */
uint64_t gz_transfer_edit_changes(const struct gz_transfer_edit *edit);

/** Whether it differs from what was begun with or gz_transfer_edit_saved() last. */
bool gz_transfer_edit_differs(const struct gz_transfer_edit *edit);

/** Forget all steps and begin anew with @p transfer: another scene is shown. */
void gz_transfer_edit_restart(struct gz_transfer_edit *edit, const struct gz_transfer *transfer);

/** A file has it as it is now. */
void gz_transfer_edit_saved(struct gz_transfer_edit *edit);

/** All changes until gz_transfer_edit_end() are one step to take back: a drag. None if they come
 *  to nothing. Ends an earlier one. */
void gz_transfer_edit_begin(struct gz_transfer_edit *edit);

/** Whether there is a drag. */
bool gz_transfer_edit_in_drag(const struct gz_transfer_edit *edit);

/** The drag has ended. Nothing if there is none. */
void gz_transfer_edit_end(struct gz_transfer_edit *edit);

/** Put @p transfer, valid, in its place: a preset, another file. One step. */
void gz_transfer_edit_replace(struct gz_transfer_edit *edit, const struct gz_transfer *transfer);

/**
 * Add a point with the colour that the function has there.
 *
 * @param value, opacity  0 to 1; those beyond are brought within
 * @return its number; GZ_TRANSFER_EDIT_NONE where there are GZ_TRANSFER_POINTS_MAX already, or two
 *         of this value
 */
size_t gz_transfer_edit_add(struct gz_transfer_edit *edit, double value, double opacity);

/** Whether it takes one point more. */
bool gz_transfer_edit_has_room(const struct gz_transfer_edit *edit);

/** Remove a point. @return false for the last one, which stays */
bool gz_transfer_edit_remove(struct gz_transfer_edit *edit, size_t point);

/** Move a point as far as its neighbours let it: to a neighbour's value at most, which makes a
 *  step, or, where that is a pair already, GZ_TRANSFER_EDIT_GAP before it. Opacity is brought to 0
 *  to 1. A number that is not finite leaves its coordinate as it is. */
void gz_transfer_edit_move(struct gz_transfer_edit *edit, size_t point, double value,
			   double opacity);

/** Colour a point; each part is brought to 0 to 1. */
void gz_transfer_edit_colour(struct gz_transfer_edit *edit, size_t point, const double rgb[3]);

/** How values between points are found. */
void gz_transfer_edit_interpolate(struct gz_transfer_edit *edit,
				  enum gz_transfer_interpolation interpolation);

/** The data values that 0 and 1 stand for. NULL: the volume's least and greatest. @return false
 *  where they are not finite and rising; nothing is changed */
bool gz_transfer_edit_range(struct gz_transfer_edit *edit, const double range[2]);

/** Take the last step back. @return false if there is none */
bool gz_transfer_edit_undo(struct gz_transfer_edit *edit);

/** Take a step again that was taken back. @return false if there is none */
bool gz_transfer_edit_redo(struct gz_transfer_edit *edit);

/** Whether gz_transfer_edit_undo() would do something. */
bool gz_transfer_edit_can_undo(const struct gz_transfer_edit *edit);

/** Whether gz_transfer_edit_redo() would do something. */
bool gz_transfer_edit_can_redo(const struct gz_transfer_edit *edit);

/** The point whose place on a plot is nearest to @p value, @p height, or GZ_TRANSFER_EDIT_NONE.
 *
 * @param value, height  of the place; height as of gz_transfer_axis_of()
 * @param per_value, per_height  units of distance in one of each, as pixels
 * @param reach  farther points do not count, in these units
 * @param logarithmic  of the axis
 */
size_t gz_transfer_edit_nearest(const struct gz_transfer_edit *edit, double value, double height,
				double per_value, double per_height, double reach,
				bool logarithmic);

/** Height on an axis of opacity, 0 to 1: the opacity itself or, logarithmic, log(1 + k a) / log(1 +
 *  k) with k = 10000 (chosen: opacities per voxel length of large see-through volumes, a
 *  hundredth and less, take up the lower half, and nothing stays 0). */
double gz_transfer_axis_of(double opacity, bool logarithmic);

/** The opacity at a height, 0 to 1. */
double gz_transfer_axis_opacity(double height, bool logarithmic);

#endif
