/**
 * @file
 * Makes a second picture maker ready on a thread of its own, so that what takes longer than a
 * frame, such as the triangles of a new isovalue, does not hold up the frames.
 */
#ifndef GZ_VIEW_FRAME_SPARE_H
#define GZ_VIEW_FRAME_SPARE_H

#include <stdbool.h>
#include <stddef.h>

#include "base/log.h"
#include "base/result.h"
#include "render/frame/picture_maker.h"
#include "render/scene/scene_settings.h"

/** A picture maker in the making. One thread at a time may use it. */
struct gz_spare;

/** What it is made ready for. All pointers are borrowed until gz_spare_drop(). */
struct gz_spare_request {
	const struct gz_object *objects; /**< what it shows; the list is copied */
	size_t object_count;
	const struct gz_scene_settings *settings; /**< of the pictures; copied */
	struct gz_backend_params params;          /**< of the cpu backend, which draws */
	void (*finished)(void *user);             /**< on the thread, at the end; may be NULL */
	const struct gz_log *log;
};

/**
 * Start the thread.
 *
 * @param[out] out_spare  the caller ends it with gz_spare_take() or gz_spare_drop()
 * @retval GZ_ERR_NO_MEM  out of memory, or no thread; not logged
 */
enum gz_result gz_spare_start(const struct gz_spare_request *request, struct gz_spare **out_spare);

/** Whether the thread has ended. */
bool gz_spare_finished(struct gz_spare *spare);

/** Whether it was started for pictures like these: the isovalue and the technique are the same. */
bool gz_spare_suits(const struct gz_spare *spare, const struct gz_scene_settings *settings);

/**
 * Take the maker of a thread that has ended, and set the pointer to NULL.
 *
 * @param[out] out_maker  written on GZ_OK; owned by the caller
 * @return why there is none; logged
 */
enum gz_result gz_spare_take(struct gz_spare **spare, struct gz_picture_maker **out_maker);

/** Wait until the thread ends, drop what it has made, and set the pointer to NULL. Accepts a
 * pointer to NULL. */
void gz_spare_drop(struct gz_spare **spare);

#endif
