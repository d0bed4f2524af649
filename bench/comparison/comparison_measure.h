/**
 * @file
 * Measuring the series of one scene: frames, then errors. For comparison.c alone.
 */
#ifndef GZ_BENCH_COMPARISON_COMPARISON_MEASURE_H
#define GZ_BENCH_COMPARISON_COMPARISON_MEASURE_H

#include "base/workers.h"
#include "bench/comparison/comparison_list.h"
#include "bench/study/errors.h"

/** What the measuring of a scene needs. All pointers are borrowed. */
struct gz_comparison_job {
	const struct gz_comparison_request *request;
	const struct gz_comparison_stage *stage;
	struct gz_comparison_list *list;
	const struct gz_foveation *methods; /**< as many as rows of a series */
	size_t method_count;
	int frames;                        /**< counted ones of a row */
	const struct gz_camera *cameras;   /**< of each frame; NULL: the stage's camera turns */
	struct gz_comparison_scene *scene; /**< reference_db is set */
	const char *surface_hash;          /**< of the volume and @p surface */
	const struct gz_transfer *surface; /**< opaque from the isovalue on */
	const char *program;               /**< with its commit, for the names of references */
	struct gz_workers *workers;
	const struct gz_log *log;
	/** Of the scene, by series and method; frames are there. Measured values are set. */
	struct gz_comparison_row *rows;
};

/** Open the makers of all series and time their frames. @return GZ_ERR_CANCELLED, not logged, and
 *  what drawing returns; logged */
enum gz_result gz_comparison_time(const struct gz_comparison_job *job);

/** Compare the pictures of all series with their references and write them into the folder for
 *  pictures. @return as gz_comparison_time() */
enum gz_result gz_comparison_compare(const struct gz_comparison_job *job);

#endif
