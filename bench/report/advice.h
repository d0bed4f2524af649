/**
 * @file
 * No more than the scene needs: the cheapest variant within a bound on the error, and copies of a
 * scene with its settings, in which all else stays as its author wrote it.
 */
#ifndef GZ_BENCH_REPORT_ADVICE_H
#define GZ_BENCH_REPORT_ADVICE_H

#include "base/log.h"
#include "base/result.h"
#include "base/text.h"
#include "bench/report/summary.h"
#include "bench/study/study.h"

/** Bound on perceived FLIP unless another is asked for. Chosen: what FLIP says of two greys that
 *  are one level of 255 apart, 0.029855 (data of its authors), which nobody can distinguish. */
#define GZ_ADVICE_BOUND "0.03"

/** A question. */
struct gz_advice_question {
	enum gz_error_measure measure;
	enum gz_error_reference reference;
	double bound; /**< in the measure's own unit */
};

/** The default question about a group: perceived FLIP within GZ_ADVICE_BOUND against
 *  gz_group_reference(). */
struct gz_advice_question gz_advice_preset(const struct gz_group *group);

/** Place of the cheapest series that holds the bound at every measured point, or
 *  GZ_SERIES_NONE. */
size_t gz_advice_find(const struct gz_group *group, const struct gz_advice_question *question);

/** Place of the series whose worst error is least, standard left out; GZ_SERIES_NONE where none was
 *  measured. */
size_t gz_advice_nearest(const struct gz_group *group, const struct gz_advice_question *question);

/** Whether any series of these groups has an error of this kind. */
bool gz_advice_has_errors(const struct gz_group *const *groups, size_t count,
			  const struct gz_advice_question *question);

/**
 * The variant that holds the bound at every measured point of each of these groups and has the
 * least time: the geometric mean over the groups, relative to standard if that was measured.
 *
 * @return its place in the study's list, or GZ_SERIES_NONE
 */
size_t gz_advice_choose(const struct gz_study *study, const struct gz_group *const *groups,
			size_t count, const struct gz_advice_question *question);

/**
 * Append the answer as a paragraph of text.
 *
 * @param series  the answer to the question, or GZ_SERIES_NONE
 * @param html    mark the important words by <strong> and escape texts
 */
void gz_advice_tell(const struct gz_study *study, const struct gz_group *group,
		    const struct gz_advice_question *question, size_t series, bool html,
		    struct gz_text *out);

/**
 * Set all options of a variant in the sections where scenes have them.
 *
 * @retval GZ_ERR_INVAL  the variant has an option that scenes do not have; logged
 */
enum gz_result gz_scene_text_set_variant(struct gz_text *text,
					 const struct gz_study_variant *variant,
					 const struct gz_log *log);

/**
 * Write a copy of a scene with a variant's settings. Names of files that the copy would not find
 * are changed as by gz_scene_move_files(); all other lines stay byte for byte.
 *
 * @param scene  file to copy
 * @param copy   file to make; it must not exist, its folder must
 * @retval GZ_ERR_BUSY       @p copy exists; logged
 * @retval GZ_ERR_NOT_FOUND  no such scene; logged
 * @retval GZ_ERR_FULL       the path of a file is too long for a scene; logged
 * @retval GZ_ERR_FORMAT     the scene is refused; logged
 * @retval GZ_ERR_INVAL      of gz_scene_text_set_variant() and gz_scene_move_files()
 * @retval GZ_ERR_IO, GZ_ERR_NO_MEM  logged
 */
enum gz_result gz_scene_copy_with(const char *scene, const char *copy,
				  const struct gz_study_variant *variant, const struct gz_log *log);

#endif
