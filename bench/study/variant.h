/**
 * @file
 * A method with its options, from text: "acuity", "acuity:acuity_slope=0.0275:levels=yes".
 */
#ifndef GZ_BENCH_STUDY_VARIANT_H
#define GZ_BENCH_STUDY_VARIANT_H

#include "base/log.h"
#include "base/result.h"
#include "render/plan/plan.h"
#include "render/raycast/shared/ray_params.h"

/** How frames of a variant are made. */
struct gz_variant_settings {
	struct gz_foveation foveation;
	struct gz_ray_params rays;
};

/**
 * Read a variant over what a scene says. Its first part is the name of a method, or "method=" with
 * it; each further one is OPTION=VALUE with an option of the scene's sections [foveation] or
 * [render]. A table of spacings is only named: gz_scene_load_table().
 *
 * @param scene             of the scene: what is not given stays so
 * @param[out] out_settings may be @p scene
 * @retval GZ_ERR_INVAL  no such method or option, or a value out of range; logged with what is
 *                       allowed
 */
enum gz_result gz_variant_parse(const char *text, const struct gz_variant_settings *scene,
				const struct gz_log *log, struct gz_variant_settings *out_settings);

/**
 * Cut the next item off a list that commas separate.
 *
 * @param[in,out] list  moved behind the item; NULL behind the last
 * @param[out] item     the item, cut at @p size less 1
 * @return false at the end, and then nothing is written
 */
bool gz_list_next(const char **list, char *item, size_t size);

#endif
