/**
 * @file
 * The picture of a scene that lies behind maps of the gaze.
 */
#ifndef GZ_BENCH_REPORT_PICTURE_H
#define GZ_BENCH_REPORT_PICTURE_H

#include "base/log.h"
#include "base/result.h"
#include "bench/study/study.h"
#include "render/picture/image.h"

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
