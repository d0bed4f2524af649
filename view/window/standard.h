/**
 * @file
 * Pictures by method standard of what is on the screen, made beside the frames: for comparing, for
 * the refined picture, and for those that are saved. Internal to view/; main thread only.
 */
#ifndef GZ_VIEW_WINDOW_STANDARD_H
#define GZ_VIEW_WINDOW_STANDARD_H

#include "view/frame/reference.h"

struct gz_window;

/** Start a worker for the scene shown; it wakes the window's loop when a picture is finished.
 * Unless
 *  @p urgent it gives way to the frames. Stop
 *  it in scene_leaving, data_leaving and gl_close. @return what gz_reference_worker_start()
 * returns; not logged */
enum gz_result gz_window_start_standard(const struct gz_window *window, bool urgent,
					struct gz_reference_worker **out_worker);

/** Ask for the picture on the screen with @p width times @p height px, with the transfer function
 * as it is shown. There was a frame of this scene. @param rays  gz_frame_rays(), or with changes */
void gz_window_ask_for_standard(const struct gz_window *window, struct gz_reference_worker *worker,
				const struct gz_ray_params *rays, int width, int height);

#endif
