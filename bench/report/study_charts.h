/**
 * @file
 * The charts of a report.
 */
#ifndef GZ_BENCH_REPORT_STUDY_CHARTS_H
#define GZ_BENCH_REPORT_STUDY_CHARTS_H

#include "bench/report/charts.h"
#include "bench/report/summary.h"
#include "render/picture/image.h"

/**
 * Draw all charts of a study. Where there is a picture of a scene (gz_report_picture()), it lies
 * behind its maps of the gaze. Without gnuplot nothing is drawn, and the call succeeds.
 *
 * @retval GZ_ERR_IO, GZ_ERR_NO_MEM  logged; what was drawn before stays
 */
enum gz_result gz_study_charts_draw(const struct gz_summary *summary, struct gz_charts *charts);

/** Name of the chart of an error over time; see gz_charts_find(). */
void gz_pareto_chart_name(const struct gz_summary *summary, const struct gz_group *group,
			  enum gz_error_measure measure, char out_name[256]);

/** Name of the chart of entered JOD over time. */
void gz_jod_chart_name(const struct gz_summary *summary, const struct gz_group *group,
		       char out_name[256]);

/** How the entered JOD of a group were measured: of the first value, and that there are others.
 *  Empty if there is no value. */
void gz_jod_source(const struct gz_summary *summary, const struct gz_group *group,
		   char out_text[256]);

/** Name of the map of time (@p of_error false) or error over the gaze, of one series. */
void gz_map_chart_name(const struct gz_summary *summary, const struct gz_group *group,
		       size_t series, bool of_error, char out_name[256]);

/** Name of the chart of growth that begins with fit number @p scaling: "growth-pixels-1". False if
 *  the fit is shown in the chart of an earlier one. */
bool gz_growth_chart_name(const struct gz_summary *summary, size_t scaling, char out_name[256]);

/** The measure of error that a group's first chart, maps and advice are about: perceived FLIP, or
 *  the first that was measured. False if none was. */
bool gz_group_measure(const struct gz_group *group, enum gz_error_measure *out_measure);

/** Draw the maps of time and of error over the gaze of a group's series. Errors as of
 *  gz_study_charts_draw(). */
enum gz_result gz_maps_draw(const struct gz_summary *summary, const struct gz_group *group,
			    struct gz_charts *charts);

/**
 * The picture of one of the study's scenes with the first of its sizes, or smaller, by standard: as
 * FOLDER/standard-SCENE-TRANSFER.png holds it, else rendered from the scene's file and kept there.
 *
 * @param[in,out] picture  zeroed, or one to be replaced
 * @retval GZ_ERR_NOT_FOUND  there is neither, or the scene is not what it was: no transfer
 *                           function over its volume has the study's data_hash; a warning says so
 * @retval GZ_ERR_NO_MEM
 */
enum gz_result gz_report_picture(const struct gz_study *study, size_t scene, const char *folder,
				 const struct gz_log *log, struct gz_image *picture);

#endif
