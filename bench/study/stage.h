/**
 * @file
 * The scene under measurement: its volume, its picture makers, and the settings of its variants,
 * read from texts such as "acuity:acuity_slope=0.0275:levels=yes".
 */
#ifndef GZ_BENCH_STUDY_STAGE_H
#define GZ_BENCH_STUDY_STAGE_H

#include "base/log.h"
#include "base/result.h"
#include "bench/study/study.h"
#include "render/frame/picture_maker.h"
#include "render/plan/plan.h"
#include "render/raycast/shared/ray_params.h"
#include "render/scene/scene.h"

/** A backend of a study: "cpu", "gl", "cpu:threads=2:simd=avx2". */
struct gz_study_backend {
	char name[GZ_NAME_SIZE];
	int threads;             /**< cpu: 0 = one a processor */
	char simd[GZ_NAME_SIZE]; /**< cpu: "auto" unless given */
};

/** Read a backend. GZ_ERR_INVAL: no such backend or option; logged with those there are. */
enum gz_result gz_study_backend_parse(const char *text, const struct gz_log *log,
				      struct gz_study_backend *out_backend);

/** A stage. Zero-initialised is empty. */
struct gz_stage {
	const struct gz_log *log;
	struct gz_scene scene;
	char path[GZ_PATH_SIZE];              /**< of the scene; empty: none is loaded */
	char volume_hash[GZ_STUDY_HASH_SIZE]; /**< of the volume's voxels */
	struct gz_transfer transfer;          /**< that is shown: one of the scene's */
	uint64_t transfer_revision;
	struct gz_picture_maker *cpu; /**< makes converged pictures; may be NULL */
	struct gz_picture_maker *backends[GZ_STUDY_LIST_MAX]; /**< of the study; may be NULL */
	/** How each of them draws; they borrow its texts. */
	struct gz_study_backend backend_params[GZ_STUDY_LIST_MAX];
	struct gz_variant_settings *variants; /**< of the study, over the scene's */
	size_t entered; /**< 1 + place of the shown scene in the study's list; 0 = none */
};

/**
 * Load a scene, unless it is loaded already. SIGINT and SIGTERM stop it once
 * gz_command_catch_signals() has been called.
 *
 * @return what gz_scene_load() returns; logged
 */
enum gz_result gz_stage_load(struct gz_stage *stage, const char *path);

/** Number of transfer functions of the loaded scene: 1 plus those of transfer.also. */
size_t gz_stage_transfer_count(const struct gz_stage *stage);

/**
 * One of them.
 *
 * @param which      0 = transfer.file
 * @param[out] out_name  its file without folder and ".tf", cut at GZ_STUDY_TEXT_SIZE
 * @return what gz_scene_load_transfer() returns; logged
 */
enum gz_result gz_stage_transfer(const struct gz_stage *stage, size_t which,
				 char out_name[GZ_STUDY_TEXT_SIZE],
				 struct gz_transfer *out_transfer);

/**
 * Make ready to measure one of a study's scenes: a picture maker for each backend shows volume and
 * transfer function, and the settings of each variant are read.
 *
 * @param[out] out_descriptions  what each backend's picture maker says of itself; may be NULL
 * @return what loading, gz_picture_maker_show() and gz_variant_parse() return; logged
 */
enum gz_result gz_stage_enter(struct gz_stage *stage, const struct gz_study *study, size_t scene,
			      char (*out_descriptions)[GZ_STUDY_TEXT_SIZE]);

/**
 * Open another picture maker that shows what one of the stage's does, for pictures that follow from
 * the ones before.
 *
 * @param backend  place in the study's list
 * @param[out] out_maker  owned by the caller, who destroys it before the stage
 * @return what gz_picture_maker_create() and gz_picture_maker_show() return; logged
 */
enum gz_result gz_stage_open_maker(struct gz_stage *stage, size_t backend,
				   struct gz_picture_maker **out_maker);

/** Hash of a volume and a transfer function; equal hashes give equal pictures. */
enum gz_result gz_stage_data_hash(const struct gz_stage *stage, const struct gz_transfer *transfer,
				  char out_hex[GZ_STUDY_HASH_SIZE]);

/** Free what it holds and zero it. */
void gz_stage_free(struct gz_stage *stage);

/** How frames of a variant are made. */
struct gz_variant_settings {
	struct gz_foveation foveation;
	struct gz_ray_params rays;
};

/**
 * Read a variant over what a scene says. Its first part is the name of a method, or "method=" with
 * it; each further one is OPTION=VALUE with an option of the scene's sections [foveation] or
 * [render]. A table of spacings is only named: gz_scene_load_table().
 *
 * @param scene             of the scene: the defaults
 * @param[out] out_settings may be @p scene
 * @retval GZ_ERR_INVAL  no such method or option, or a value out of range; logged with the allowed
 *                       values
 */
enum gz_result gz_variant_parse(const char *text, const struct gz_variant_settings *scene,
				const struct gz_log *log, struct gz_variant_settings *out_settings);

/**
 * Cut the next item off a list that commas separate.
 *
 * @param[in,out] list  moved behind the item; NULL behind the last
 * @param[out] item     the item, cut at @p size less 1
 * @return false at the end, and then nothing is written
 */
bool gz_list_next(const char **list, char *item, size_t size);

#endif
