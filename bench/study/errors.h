/**
 * @file
 * Errors of a variant's picture against a reference.
 *
 * The reference is the converged picture: every pixel, a step of 1/8 voxel length, no ray ended
 * early, no coarser levels, no jitter. It is made a second time with half the step; how far both
 * are apart is what the reference itself may be wrong by. Both are made by the cpu backend and kept
 * as PNG in a folder, by the hash of all that they depend on, so that each camera, scene and size
 * is made once.
 */
#ifndef GZ_BENCH_STUDY_ERRORS_H
#define GZ_BENCH_STUDY_ERRORS_H

#include "base/log.h"
#include "base/result.h"
#include "bench/metrics/metrics.h"
#include "bench/study/study.h"
#include "render/frame/picture_maker.h"
#include "render/picture/image.h"
#include "render/raycast/shared/ray_params.h"

/** The error of each pixel, by each metric. Zero-initialised is empty. */
struct gz_error_maps {
	struct gz_map squared, ssim, flip;
	bool has_ssim; /**< no: the picture is smaller than the window */
};

/** Weights of pixels for one gaze point. Zero-initialised is empty; keep it to reuse its buffers.
 */
struct gz_error_weights {
	struct gz_map foveal, perceived;           /**< of every pixel */
	struct gz_map foveal_ssim, perceived_ssim; /**< of those that SSIM has a value for */
	bool any_foveal;                           /**< some of the fovea lies in the picture */
};

/**
 * Weigh the pixels of a picture.
 *
 * @param display  geometry of the picture, which fills it
 * @retval GZ_ERR_INVAL, GZ_ERR_NO_MEM
 */
enum gz_result gz_error_weights_make(struct gz_error_weights *weights,
				     const struct gz_display *display, struct gz_point gaze,
				     int width, int height, struct gz_workers *workers);

/** Compare two pictures of one size. @p px_per_deg: 1 to 1000, for FLIP. GZ_ERR_INVAL,
 *  GZ_ERR_NO_MEM. */
enum gz_result gz_error_maps_make(struct gz_error_maps *maps, const struct gz_image *reference,
				  const struct gz_image *test, double px_per_deg,
				  struct gz_workers *workers);

/** The errors of a picture, by weights of its size. Foveal ones are NaN where no pixel lies in the
 *  fovea. */
struct gz_study_errors gz_error_maps_weigh(const struct gz_error_maps *maps,
					   const struct gz_error_weights *weights);

/** The errors of a picture against itself, with the same NaN. */
struct gz_study_errors gz_errors_none(const struct gz_error_weights *weights, bool has_ssim);

/**
 * How much a picture changes: the mean of its channels' absolute differences in levels of 255,
 * weighted as perceived errors are.
 *
 * @param scratch  overwritten
 * @retval GZ_ERR_INVAL   the sizes differ
 * @retval GZ_ERR_NO_MEM  no room
 */
enum gz_result gz_errors_change(const struct gz_image *before, const struct gz_image *after,
				const struct gz_error_weights *weights, struct gz_map *scratch,
				double *out_change);

/** Free and zero. */
void gz_error_maps_free(struct gz_error_maps *maps);
void gz_error_weights_free(struct gz_error_weights *weights);

/** Samples per voxel length of the converged picture. */
#define GZ_REFERENCE_RATE 8

/** Below this PSNR between both pictures there is a warning, dB. Chosen: an error of a quarter of a
 * grey level, which is far below any that is measured against it. */
#define GZ_REFERENCE_LEAST_DB 60

/** What a converged picture shows. */
struct gz_reference_request {
	struct gz_picture_maker *maker; /**< cpu, which shows volume and transfer function */
	const char *data_hash;          /**< of volume and transfer function */
	const char *program;            /**< what makes it, with its commit */
	const struct gz_camera *camera;
	const struct gz_ray_params *rays; /**< of the scene */
	const struct gz_display *display; /**< any that is valid */
	int width, height;
	const char *cache; /**< folder, created if missing; NULL: nothing is kept */
};

/**
 * The converged picture: from the cache, or made and kept there. If the cache cannot be
 * written, there is a warning and nothing is kept.
 *
 * @param[in,out] image      the picture
 * @param[in,out] half_step  that of half the step
 * @param[out] out_db        PSNR between both, infinite where they are the same
 * @param[out] out_made      it was not in the cache
 * @retval GZ_ERR_CANCELLED  SIGINT or SIGTERM has arrived (gz_command_catch_signals()); not logged
 * @retval GZ_ERR_NO_MEM     logged; and what gz_picture_make() returns
 */
enum gz_result gz_reference_get(const struct gz_reference_request *request,
				const struct gz_log *log, struct gz_image *image,
				struct gz_image *half_step, double *out_db, bool *out_made);

/** Ray settings of a converged picture, from those of a scene. */
struct gz_ray_params gz_reference_rays(const struct gz_ray_params *rays, double rate);

/**
 * The folder where references are kept: @p given or, where that is empty, "gazecast/references" in
 * $XDG_CACHE_HOME or in ~/.cache (XDG Base Directory Specification).
 *
 * @param room  for its name, valid as long as what is returned is used
 * @return NULL where none is given and neither is known, or the name is too long
 */
const char *gz_reference_cache(const char *given, char room[GZ_PATH_SIZE]);

#endif
