/**
 * @file
 * Copies of a scene with the settings of a variant; all else stays as its author wrote it.
 */
#ifndef GZ_BENCH_REPORT_SCENE_EDIT_H
#define GZ_BENCH_REPORT_SCENE_EDIT_H

#include "base/log.h"
#include "base/result.h"
#include "base/text.h"
#include "bench/study/study.h"

/**
 * Set everything that a variant says, in the sections where scenes have it.
 *
 * @retval GZ_ERR_INVAL  the variant has an option that scenes do not have; logged
 */
enum gz_result gz_scene_text_set_variant(struct gz_text *text,
					 const struct gz_study_variant *variant,
					 const struct gz_log *log);

/**
 * Write a copy of a scene with a variant's settings.
 *
 * @param scene  file to copy
 * @param copy   file to make; must not be there, and what the scene names by relative paths must be
 *               found from it
 * @retval GZ_ERR_BUSY       @p copy is there; logged
 * @retval GZ_ERR_NOT_FOUND  no such scene, or a file of it would not be found; logged
 * @retval GZ_ERR_FORMAT     the scene is refused; logged
 * @retval GZ_ERR_INVAL      of gz_scene_text_set_variant()
 * @retval GZ_ERR_IO, GZ_ERR_NO_MEM  logged
 */
enum gz_result gz_scene_copy_with(const char *scene, const char *copy,
				  const struct gz_study_variant *variant, const struct gz_log *log);

#endif
