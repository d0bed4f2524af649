/**
 * @file
 * Illustrations of surfaces by rays: the plan's rays find tone, depth and objects, those three
 * planes are reconstructed, and the picture is composed of them at full resolution
 * (render/illustration/shading_picture.h).
 */
#ifndef GZ_RENDER_ILLUSTRATION_CPU_ILLUSTRATE_CASTER_H
#define GZ_RENDER_ILLUSTRATION_CPU_ILLUSTRATE_CASTER_H

#include <stdbool.h>
#include <stddef.h>

#include "base/log.h"
#include "base/result.h"
#include "render/illustration/shared/illustrate_shot.h"
#include "render/picture/image.h"
#include "render/technique/technique.h"

/** Surfaces, what shading knows of them, and the threads that cast. One thread at a time may use
 * it.
 */
struct gz_illustrate_caster;

/** Whether there is one in this build: it needs Embree. If not, gz_illustrate_caster_create() says
 *  so and fails with GZ_ERR_UNSUPPORTED. */
bool gz_illustrate_caster_present(void);

/** Check parameters before there is anything to show. @param params  not NULL @return the failures
 *  of gz_illustrate_caster_create() but GZ_ERR_NO_MEM; logged */
enum gz_result gz_illustrate_caster_check(const struct gz_backend_params *params,
					  const struct gz_log *log);

/**
 * Make a caster that shows nothing.
 *
 * @param params  NULL: the defaults
 * @param log     outlives the caster; may be NULL
 * @param[out] out_caster  owned by the caller; gz_illustrate_caster_destroy()
 * @retval GZ_ERR_UNSUPPORTED  no Embree, or this processor lacks the instruction set; logged
 * @retval GZ_ERR_INVAL        the number of threads is out of range; logged
 * @retval GZ_ERR_NO_MEM       out of memory
 */
enum gz_result gz_illustrate_caster_create(const struct gz_backend_params *params,
					   const struct gz_log *log,
					   struct gz_illustrate_caster **out_caster);

/** gz_illustrate_scene_show(). */
enum gz_result gz_illustrate_caster_show(struct gz_illustrate_caster *caster,
					 const struct gz_object *objects, size_t count);

/**
 * Draw a picture of the plan's size and write every pixel. The background is white. The same bits
 * for any number of threads.
 *
 * Transparent objects show what is behind them: each layer of surfaces has a shading map of its
 * own, with the tone curve of the front layer, and they are blended by depth. The nearest three
 * transparent surfaces of a ray show, and the next opaque one behind them.
 *
 * @param planes     NULL: no planes are wanted
 * @param out_stats  may be NULL
 * @retval GZ_ERR_INVAL   nothing is shown, the camera or the settings are not valid, or the plan is
 *                        empty
 * @retval GZ_ERR_FULL    a surface has too many triangles; logged
 * @retval GZ_ERR_NO_MEM  out of memory
 * @return otherwise what making surfaces returns; logged
 */
enum gz_result gz_illustrate_caster_draw(struct gz_illustrate_caster *caster,
					 const struct gz_illustrate_shot *shot,
					 struct gz_image *image,
					 const struct gz_illustrate_planes *planes,
					 struct gz_frame_stats *out_stats);

/** Find what is at a place of a picture. @param shot  its plan is not used @return the failures of
 * gz_illustrate_caster_draw() */
enum gz_result gz_illustrate_caster_pick(struct gz_illustrate_caster *caster,
					 const struct gz_illustrate_shot *shot,
					 const struct gz_pick_request *request,
					 struct gz_pick *out_pick);

/** Write the marks that drew the last picture. @return as gz_illustrate_drawing_print() */
enum gz_result gz_illustrate_caster_print(const struct gz_illustrate_caster *caster,
					  const struct gz_print *print);

/** Triangles of all that is shown, as of the last picture. */
size_t gz_illustrate_caster_triangles(const struct gz_illustrate_caster *caster);

/** One line for reports, such as "avx2, 2 threads"; owned by the caster. */
const char *gz_illustrate_caster_describe(const struct gz_illustrate_caster *caster);

/** Destroy the caster and set the pointer to NULL. Accepts a pointer to NULL. */
void gz_illustrate_caster_destroy(struct gz_illustrate_caster **caster);

#endif
