/**
 * @file
 * From a request to a study without rows: lists are parsed, scenes loaded and hashed, the path
 * made.
 */
#ifndef GZ_BENCH_STUDY_ASK_H
#define GZ_BENCH_STUDY_ASK_H

#include "base/log.h"
#include "base/result.h"
#include "bench/study/gaze_path.h"
#include "bench/study/stage.h"
#include "bench/study/study.h"

/** A request. */
struct gz_study_request {
	const char *const *scenes; /**< paths */
	size_t scene_count;
	const char *methods;     /**< "acuity,mdc:mdc_spacing=3": see bench/study/variant.h */
	const char *sizes;       /**< "1024x1024,640x480" */
	const char *backends;    /**< "cpu,gl": see gz_study_backend_parse() */
	const char *path;        /**< see bench/study/gaze_path.h */
	const char *camera_path; /**< file (bench/study/camera_path.h); NULL: none */
	double min_move_px;
	bool per_cell;
	uint32_t cameras;
	uint64_t seed;
	int frames, warm_up;
	int shard, shard_count; /**< shard from 0 */
	enum gz_study_accuracy accuracy;
	double display_mm[2];       /**< 0 = not given */
	double display_distance_mm; /**< 0 = not given */
	const char *program, *commit;
};

/**
 * Check the lists and the path of a request without reading any file; of a recording only the name
 * is checked.
 *
 * @retval GZ_ERR_INVAL   one is wrong; logged with the allowed values
 * @retval GZ_ERR_NO_MEM  logged
 */
enum gz_result gz_study_check(const struct gz_study_request *request, const struct gz_log *log);

/**
 * Make the requested study.
 *
 * @param stage           loads the scenes; afterwards it may hold one of them
 * @param[out] out_study  without rows, incomplete; backends are not described yet. The caller's:
 *                        gz_study_free()
 * @retval GZ_ERR_INVAL   something is missing, doubled or too large, or the recording is of
 *                        another display; logged with the remedy
 * @return else what loading scenes, paths and transfer functions return; logged
 */
enum gz_result gz_study_ask(const struct gz_study_request *request, struct gz_stage *stage,
			    const struct gz_log *log, struct gz_study *out_study);

#endif
