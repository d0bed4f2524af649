/**
 * @file
 * The commands of gazebench. Each command is one file with one table.
 */
#ifndef GZ_BENCH_GAZEBENCH_GAZEBENCH_H
#define GZ_BENCH_GAZEBENCH_GAZEBENCH_H

#include "base/command.h"

/** Exit statuses, as in gazebench(1). */
enum gazebench_exit {
	GAZEBENCH_DONE = GZ_EXIT_DONE,
	GAZEBENCH_FAILED = GZ_EXIT_FAILED,
	GAZEBENCH_USAGE = GZ_EXIT_USAGE,
	GAZEBENCH_PARTIAL = 3,  /**< run: interrupted, or the disk is full; it can be resumed */
	GAZEBENCH_UNSTABLE = 4, /**< stability: a row does not hold */
};

/** The commit that the program was built from; "unknown" outside a repository, "-dirty" behind it
 *  where files were changed. */
extern const char gazebench_commit[];

extern const struct gz_command gazebench_run;        /**< measure: make a study */
extern const struct gz_command gazebench_merge;      /**< join the shards of a study */
extern const struct gz_command gazebench_report;     /**< charts, tables, report.html */
extern const struct gz_command gazebench_suggest;    /**< the cheapest setting within a bound */
extern const struct gz_command gazebench_accumulate; /**< gain of keeping earlier frames */
extern const struct gz_command gazebench_clip;      /**< sequences for metrics of moving pictures */
extern const struct gz_command gazebench_compare;   /**< how far two pictures are apart */
extern const struct gz_command gazebench_filter;    /**< lag and jitter of the gaze filter */
extern const struct gz_command gazebench_answers;   /**< an experiment, summed up */
extern const struct gz_command gazebench_stability; /**< where methods fail, on a scene */
extern const struct gz_command gazebench_techniques; /**< the techniques compared */

#endif
