/**
 * @file
 * The drawers of a picture: one for each technique of its objects. Opaque techniques are drawn
 * first, and the last one makes the picture. For the picture maker alone.
 */
#ifndef GZ_RENDER_FRAME_DRAWERS_H
#define GZ_RENDER_FRAME_DRAWERS_H

#include <stdbool.h>
#include <stddef.h>

#include "base/log.h"
#include "base/result.h"
#include "render/technique/technique.h"

/** Most techniques of a picture. Chosen: more than there are. */
#define GZ_DRAWERS_MAX 8

/** One technique, and the objects that it draws. */
struct gz_technique_drawer {
	const struct gz_technique *technique;
	struct gz_drawer *drawer;  /**< NULL: not open */
	struct gz_object *objects; /**< in the array of struct gz_drawers */
	size_t object_count;
};

/** All drawers of a picture. Zero-initialised with log, backend and backend_params set, it shows
 *  nothing. One thread at a time may use it. */
struct gz_drawers {
	const struct gz_log *log;                         /**< may be NULL; borrowed */
	const char *backend;                              /**< "auto", NULL, or a name; borrowed */
	const struct gz_backend_params *backend_params;   /**< borrowed */
	struct gz_technique_drawer items[GZ_DRAWERS_MAX]; /**< in the order of drawing */
	size_t count;                                     /**< 0: nothing is shown */
	struct gz_object *objects;                        /**< of all items */
	struct gz_ray_hits hits;                          /**< of all opaque techniques */
};

/**
 * Show these objects from the next picture on. Drawers of techniques that stay are kept. If this
 * fails, the objects are known, and the drawers are those for which it has succeeded.
 *
 * @retval GZ_ERR_UNSUPPORTED  no objects, too many, or techniques that do not share a picture;
 * logged. Nothing is shown then
 * @return otherwise the failures of gz_technique.create and gz_drawer_ops.show
 */
enum gz_result gz_drawers_show(struct gz_drawers *drawers, const struct gz_object *objects,
			       size_t count);

/** The drawer that makes the picture; NULL if nothing is shown. */
struct gz_drawer *gz_drawers_last(const struct gz_drawers *drawers);

/** Draw all that is shown as gz_drawer_ops.draw does. The times of all drawers are added up; a ray
 *  that several techniques cast counts once. @param shot  without hits */
enum gz_result gz_drawers_draw(struct gz_drawers *drawers, const struct gz_shot *shot,
			       struct gz_image *image, struct gz_frame_stats *out_stats);

/** Find what is at a place of a picture, among the objects of the techniques that can tell.
 *  @return what gz_drawer_ops.pick returns */
enum gz_result gz_drawers_pick(struct gz_drawers *drawers, const struct gz_pick_request *request,
			       struct gz_pick *out_pick);

/** Let cpu draw in place of the last drawer's backend. */
enum gz_result gz_drawers_take_cpu(struct gz_drawers *drawers);

/** gz_technique_settings_same() for all techniques. */
bool gz_drawers_settings_same(const struct gz_drawers *drawers, const void *a, const void *b);

/** Close all drawers. Nothing is shown from now on. */
void gz_drawers_close(struct gz_drawers *drawers);

/** Close all drawers and free the memory. */
void gz_drawers_free(struct gz_drawers *drawers);

#endif
