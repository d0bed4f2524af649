/**
 * @file
 * Where the gaze goes in a study: a curve, a grid, random places, one place, a table, or a
 * recording.
 *
 *   sweep:s[:N]       the mirrored S of Bauer 2018: x = 1/2 + .4 sin(2 pi t), y = .05 + .9 t, at N
 *                     points t = (i + 1/2) / N; 584 as in his table 5.1 unless N is given
 *   grid:NxM          the middles of N columns and M rows of equal cells, row by row
 *   random:N          N places, uniform over the picture, by the seed
 *   centre            the middle of the picture, which is where a camera's look_at appears
 *   X,Y               one place, normalised
 *   FILE.csv          places of a table (gaze_path_table.h), as shares of the picture
 *   FILE.csv:WxH      the same in pixels of a picture of this size
 *   FILE.gzl          a recording, run through the daemon's pipeline in process with the recorded
 *                     settings: one point for each fixation, at its centre, in their order
 *   FILE.gzl:samples  the same, one point for each sample while gaze is there
 */
#ifndef GZ_BENCH_STUDY_GAZE_PATH_H
#define GZ_BENCH_STUDY_GAZE_PATH_H

#include "base/log.h"
#include "base/result.h"
#include "bench/study/study.h"

/** Default number of points of sweep:s: Bauer 2018, table 5.1. */
#define GZ_GAZE_PATH_SWEEP_POINTS 584

/** How a path is made. */
struct gz_gaze_path_settings {
	const char *text; /**< as above */
	uint64_t seed;
	uint32_t cameras;   /**< points take random cameras 1 to so many in turn; 0 = the scene's */
	double min_move_px; /**< leave out points nearer than this to the one before; 0 = none */
	int size[2];        /**< px of the picture that min_move_px is measured on */
	bool per_cell;      /**< keep the first point in each cell of a 10 x 10 grid over the
				 picture, and none outside (Bauer 2018, 3.2.8) */
};

/** A path. Zero-initialised is empty. */
struct gz_gaze_path {
	struct gz_study_point *points;
	size_t count;
	size_t capacity;           /**< of points */
	bool has_display;          /**< of a recording that says so */
	struct gz_display display; /**< that the recording was made on */
};

/**
 * Make a path.
 *
 * @param[out] out_path  1 to GZ_STUDY_POINTS_MAX points; the caller's: gz_gaze_path_free()
 * @retval GZ_ERR_INVAL      no such path; logged with the possible ones
 * @retval GZ_ERR_FORMAT     a recording that is none, or without valid gaze; a table with a line
 *                           that is no place, or without places; logged
 * @retval GZ_ERR_NOT_FOUND, GZ_ERR_IO, GZ_ERR_NO_MEM  logged
 */
enum gz_result gz_gaze_path_make(const struct gz_gaze_path_settings *settings,
				 const struct gz_log *log, struct gz_gaze_path *out_path);

/** Check the form of a path; the content of files is not read.
 *  GZ_ERR_INVAL: logged with the possible ones; GZ_ERR_NO_MEM. */
enum gz_result gz_gaze_path_check(const char *text, const struct gz_log *log);

/** The point at @p t of the S, [0, 1]. */
struct gz_point gz_gaze_path_s(double t);

/** Whether both appear under the same angles, to a hundredth; pixels are not compared. */
bool gz_gaze_path_same_display(const struct gz_display *a, const struct gz_display *b);

/** Free what it holds and zero it. */
void gz_gaze_path_free(struct gz_gaze_path *path);

#endif
