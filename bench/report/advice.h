/**
 * @file
 * No more than the scene needs: the cheapest variant within a bound on the error.
 */
#ifndef GZ_BENCH_REPORT_ADVICE_H
#define GZ_BENCH_REPORT_ADVICE_H

#include "base/text.h"
#include "bench/report/summary.h"

/** Bound on perceived FLIP unless another is asked for. Chosen: what FLIP says of two greys that
 *  are one level of 255 apart, 0.029855 (data of its authors), which nobody tells apart. */
#define GZ_ADVICE_BOUND "0.03"

/** What is asked. */
struct gz_advice_question {
	enum gz_error_measure measure;
	enum gz_error_reference reference;
	double bound; /**< in the measure's own unit */
};

/** What is asked of a group unless something else is: perceived FLIP within GZ_ADVICE_BOUND,
 *  against what gz_group_reference() says. */
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
 * The variant that holds the bound at every measured point of each of these groups and takes least,
 * by the geometric mean of its times over those of standard where that was measured.
 *
 * @return its place in the study's list, or GZ_SERIES_NONE
 */
size_t gz_advice_choose(const struct gz_study *study, const struct gz_group *const *groups,
			size_t count, const struct gz_advice_question *question);

/**
 * The answer as a paragraph of plain words.
 *
 * @param series  what was found for the question, or GZ_SERIES_NONE
 * @param html  whether what counts is marked by <strong>, and texts are escaped
 */
void gz_advice_tell(const struct gz_study *study, const struct gz_group *group,
		    const struct gz_advice_question *question, size_t series, bool html,
		    struct gz_text *out);

#endif
