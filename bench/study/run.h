/**
 * @file
 * Running a study: it is written unit by unit into its folder, so that an interrupted run can be
 * resumed.
 */
#ifndef GZ_BENCH_STUDY_RUN_H
#define GZ_BENCH_STUDY_RUN_H

#include "base/log.h"
#include "base/result.h"
#include "bench/study/ask.h"

/** Progress of a run. */
struct gz_study_progress {
	size_t units;     /**< of the shard */
	size_t done;      /**< of them */
	double share;     /**< done of the whole work, units by their pixels */
	double left_s;    /**< estimated time left, s; NaN before there is an estimate */
	const char *what; /**< scene measured next; valid during the call */
};

/** Result of a run. */
struct gz_study_outcome {
	size_t units, done; /**< of the shard; done ones are in the folder */
	size_t resumed;     /**< units of done that were there before the run */
	size_t rows;        /**< in the folder */
	bool complete;
};

/** Receives progress reports. */
struct gz_study_listener {
	/** Called before each unit and at the end; NULL: no reports. */
	void (*progress)(void *user, const struct gz_study_progress *progress);
	void *user;
};

/**
 * Run a study, or resume one.
 *
 * @param request   what is asked
 * @param folder    created if missing; or the folder of the same study
 * @param cache     folder for references; NULL: they are not kept
 * @param listener  copied
 * @param[out] out_outcome  filled once the folder is open, even if the run ends early
 * @retval GZ_ERR_CANCELLED  SIGINT or SIGTERM has arrived; the folder holds whole units; not logged
 * @retval GZ_ERR_FULL       the disk is full; the folder holds whole units; logged
 * @return else what gz_study_ask(), gz_study_writer_open() and gz_picture_make() return; logged
 */
enum gz_result gz_study_run(const struct gz_study_request *request, const char *folder,
			    const char *cache, struct gz_study_listener listener,
			    const struct gz_log *log, struct gz_study_outcome *out_outcome);

#endif
