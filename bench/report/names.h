/**
 * @file
 * Readable names of variants and groups of a study, and names for their files.
 */
#ifndef GZ_BENCH_REPORT_NAMES_H
#define GZ_BENCH_REPORT_NAMES_H

#include <stddef.h>

#include "bench/report/summary.h"

/** Bytes of any of these texts with its NUL; longer ones are cut. */
#define GZ_NAMES_SIZE 256

/** "acuity, slope 0.0275, levels yes": a variant in words. */
void gz_variant_words(const struct gz_study_variant *variant, char out_words[GZ_NAMES_SIZE]);

/**
 * What distinguishes a variant from the others of its curve: "0.0275" if they differ in one option
 * only, otherwise "slope 0.0275, levels yes"; "preset" for the method without options among others,
 * empty for the only variant.
 */
void gz_variant_label(const struct gz_study *study, const struct gz_group *group,
		      const struct gz_curve *curve, size_t series, char out_label[GZ_NAMES_SIZE]);

/** A curve's name: "acuity", or "acuity, slope" if its variants differ in one option. */
void gz_curve_name(const struct gz_study *study, const struct gz_group *group,
		   const struct gz_curve *curve, char out_name[GZ_NAMES_SIZE]);

/** "head (bone) at 1024×1024 on cpu": with the transfer function if its name differs. */
void gz_group_words(const struct gz_study *study, const struct gz_group *group,
		    char out_words[GZ_NAMES_SIZE]);

/** What stays the same in a fit of growth: "head on cpu", "all scenes at 1024×1024 on cpu". */
void gz_growth_words(const struct gz_study *study, const struct gz_scaling *scaling,
		     char out_words[GZ_NAMES_SIZE]);

/** "head", or "head (bone)". */
void gz_scene_words(const struct gz_study_scene *scene, char out_words[GZ_NAMES_SIZE]);

/**
 * Name of a chart's files: @p kind alone in a study of one group, else with the group's scene,
 * transfer function, size and backend. Bytes other than letters, digits, '.', '_' and '-' become
 * '-'.
 *
 * @param group  NULL for none
 */
void gz_chart_name(const struct gz_summary *summary, const char *kind, const struct gz_group *group,
		   char out_name[GZ_NAMES_SIZE]);

#endif
