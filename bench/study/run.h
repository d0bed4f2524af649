/**
 * @file
 * Running a study: unit by unit into its folder, so that whatever ends it, it can be gone on with.
 */
#ifndef GZ_BENCH_STUDY_RUN_H
#define GZ_BENCH_STUDY_RUN_H

#include "base/log.h"
#include "base/result.h"
#include "bench/study/ask.h"

/** How far a run is. */
struct gz_study_progress {
	size_t units;     /**< of the shard */
	size_t done;      /**< of them */
	double share;     /**< done of the whole work, units by their pixels */
	double left_s;    /**< seconds that the rest may take; NaN while that cannot be told */
	const char *what; /**< scene that is measured next; valid during the call */
};

/** What came of a run. */
struct gz_study_outcome {
	size_t units, done; /**< of the shard; done ones are in the folder */
	size_t resumed;     /**< of done: those that were there before */
	size_t rows;        /**< in the folder */
	bool complete;
};

/** Who is told how far a run is. */
struct gz_study_listener {
	/** Before each unit and at the end; NULL: nobody is told. */
	void (*progress)(void *user, const struct gz_study_progress *progress);
	void *user;
};

/**
 * Run a study, or resume one.
 *
 * @param request   what is asked
 * @param folder    made where it is not there; or one of the same study
 * @param cache     folder of references; NULL: none are kept
 * @param listener  copied
 * @param[out] out_outcome  filled once the folder is open, also where the run ends early
 * @retval GZ_ERR_CANCELLED  SIGINT or SIGTERM has arrived; the folder holds whole units; not logged
 * @retval GZ_ERR_FULL       the disk is full; the folder holds whole units; logged
 * @return else what gz_study_ask(), gz_study_writer_open() and gz_picture_make() return; logged
 */
enum gz_result gz_study_run(const struct gz_study_request *request, const char *folder,
			    const char *cache, struct gz_study_listener listener,
			    const struct gz_log *log, struct gz_study_outcome *out_outcome);

#endif
