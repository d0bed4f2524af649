/**
 * @file
 * Pictures beside the standard one, or less it, without a window: what view.compare asks for.
 */
#ifndef GZ_VIEW_FRAME_COMPARISON_H
#define GZ_VIEW_FRAME_COMPARISON_H

#include "base/log.h"
#include "base/result.h"
#include "render/picture/image.h"
#include "view/frame/frame.h"

/** Makes standard pictures and joins them with frames. One thread at a time may use it. */
struct gz_comparison;

/**
 * Start it.
 *
 * @param maker    of the frames, with a renderer; borrowed, as its scene, until
 *                 gz_comparison_stop()
 * @param options  threads and memory of the renderer
 * @param[out] out_comparison  the caller stops it with gz_comparison_stop()
 * @return what gz_reference_worker_start() returns; logged
 */
enum gz_result gz_comparison_start(const struct gz_frame_maker *maker,
				   const struct gz_view_options *options, const struct gz_log *log,
				   struct gz_comparison **out_comparison);

/**
 * Make the standard picture of a frame, and join both: with GZ_COMPARE_SPLIT it takes the place of
 * the frame from view.split on, with GZ_COMPARE_DIFFERENCE the absolute difference of each colour,
 * times view.difference_gain, takes the place of all of it.
 *
 * @param request        of the frame
 * @param[in,out] image  the frame
 * @return why there is no standard picture; logged
 */
enum gz_result gz_comparison_join(struct gz_comparison *comparison,
				  const struct gz_frame_request *request, struct gz_image *image);

/** Stop and free it, and set the pointer to NULL. Call it before the data of the scene change.
 *  Accepts a pointer to NULL. */
void gz_comparison_stop(struct gz_comparison **comparison);

/* Within this room and its tests: */

/** Put the columns of @p standard into @p image from @p split on, a share of its width. Both have
 *  one size. */
void gz_comparison_split(struct gz_image *image, const struct gz_image *standard, double split);

/** Replace each colour of @p image by its absolute difference from @p standard, times @p gain, and
 *  make it opaque. Both have one size. */
void gz_comparison_subtract(struct gz_image *image, const struct gz_image *standard, double gain);

#endif
