/**
 * @file
 * Makes the surfaces of a scene's labels again on a thread of its own, so that the frames need not
 * wait for them.
 */
#ifndef GZ_VIEW_FRAME_LABEL_CHANGE_H
#define GZ_VIEW_FRAME_LABEL_CHANGE_H

#include <stdbool.h>

#include "base/log.h"
#include "base/result.h"
#include "render/scene/scene.h"

/** Surfaces in the making. One thread at a time may use it. */
struct gz_label_change;

/**
 * Start the thread.
 *
 * @param request   copied, but for its name, which outlives the change
 * @param finished  called on the thread, at the end; may be NULL
 * @param log       outlives the change; may be NULL
 * @param[out] out_change  the caller ends it with gz_label_change_take()
 * @retval GZ_ERR_NO_MEM  out of memory, or no thread; not logged
 */
enum gz_result gz_label_change_start(const struct gz_scene_label_request *request,
				     void (*finished)(void *user), const struct gz_log *log,
				     struct gz_label_change **out_change);

/** Whether the thread has ended. */
bool gz_label_change_finished(struct gz_label_change *change);

/** The look that was asked for. */
const struct gz_label_look *gz_label_change_look(const struct gz_label_change *change);

/**
 * Wait until the thread ends, take what it has made, and set the pointer to NULL.
 *
 * @param[out] out_labels  written on GZ_OK; owned by the caller
 * @return what gz_scene_make_labels() has returned
 */
enum gz_result gz_label_change_take(struct gz_label_change **change,
				    struct gz_label_surfaces **out_labels);

#endif
