/**
 * @file
 * A study: the request, the machine, and one row for every frame. A run makes it, reports and
 * suggestions read it, its folder stores it (bench/study/study_folder.h).
 *
 * Nothing is averaged before it is stored.
 */
#ifndef GZ_BENCH_STUDY_STUDY_H
#define GZ_BENCH_STUDY_STUDY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/option.h"
#include "base/result.h"
#include "bench/study/camera_path.h"
#include "protocol/display.h"
#include "protocol/gaze.h"
#include "render/picture/camera.h"
#include "render/picture/image.h"

#define GZ_STUDY_HASH_SIZE    65  /**< SHA-256 in hexadecimal with its NUL */
#define GZ_STUDY_TEXT_SIZE    256 /**< bytes of any name below with its NUL */
#define GZ_STUDY_LIST_MAX     64  /**< methods, sizes, backends */
#define GZ_STUDY_SCENES_MAX   256 /**< each counted once for each of its transfer functions */
#define GZ_STUDY_POINTS_MAX   100000
#define GZ_STUDY_FRAMES_MAX   1000 /**< counted frames of one point */
#define GZ_STUDY_SEED_DEFAULT 1

/** A scene of the study with one of its transfer functions. */
struct gz_study_scene {
	char name[GZ_STUDY_TEXT_SIZE];     /**< file name without folder and ".scene" */
	char path[GZ_PATH_SIZE];           /**< as given */
	char transfer[GZ_STUDY_TEXT_SIZE]; /**< file name of the transfer function without ".tf" */
	/** Of what the scene says of rays and foveation, the tables that variants name, the
	 *  transfer function and the volume's voxels: two scenes of one hash show the same to the
	 *  same camera. */
	char hash[GZ_STUDY_HASH_SIZE];
	char data_hash[GZ_STUDY_HASH_SIZE]; /**< of volume and transfer function alone */
	int dims[3];                        /**< of the volume */
	struct gz_camera camera;
	struct gz_display display; /**< of the picture, at the first of the sizes */
	bool display_known;        /**< else the default stands in: see gz_study_display() */
};

/** References of the errors. */
enum gz_study_accuracy {
	GZ_STUDY_ACCURACY_NONE,
	GZ_STUDY_ACCURACY_STANDARD, /**< against standard; the converged picture is left out */
	GZ_STUDY_ACCURACY_ALL,
	GZ_STUDY_ACCURACY_COUNT,
};

/** "none", "standard", "all"; NULL-terminated. */
extern const char *const gz_study_accuracy_names[];

/** A method with its options. */
struct gz_study_variant {
	/** As given: "acuity", "acuity:acuity_slope=0.0275", any keys of [foveation] and [render].
	 *  "standard" is always among them, as the first. */
	char text[GZ_STUDY_TEXT_SIZE];
	char method[GZ_NAME_SIZE]; /**< name of the method alone: variants of one are one curve */
};

/** Where the gaze is, and which camera sees it. */
struct gz_study_point {
	struct gz_point gaze; /**< normalised, may lie outside the picture */
	uint32_t camera;      /**< 0 = the scene's own, else the n-th random one */
};

/** The machine and the program, for readers and to distinguish shards of different programs. */
struct gz_study_machine {
	char host_cpu[GZ_STUDY_TEXT_SIZE]; /**< "AMD EPYC 9R14, 2 processors" */
	char memory[GZ_STUDY_TEXT_SIZE];
	char system[GZ_STUDY_TEXT_SIZE];   /**< kernel and distribution */
	char compiler[GZ_STUDY_TEXT_SIZE]; /**< with the build type */
	char commit[GZ_STUDY_TEXT_SIZE];   /**< of the program; "unknown" outside a repository */
	char program[GZ_STUDY_TEXT_SIZE];  /**< "gazebench 0.1.0" */
	/** Description of each backend by gz_picture_maker_describe(), GPU and driver included. */
	char backends[GZ_STUDY_LIST_MAX][GZ_STUDY_TEXT_SIZE];
	/** What copying a picture of each of the study's sizes takes, by gz_study_copy_ms(): no
	 *  frame takes less. NaN in studies of versions that did not measure it. */
	double copy_ms[GZ_STUDY_LIST_MAX];
};

/** How far a picture is from its reference; NaN where it was not measured. Which pixels count: all,
 *  those of the fovea, or all weighted by what the eye sees there. PSNR is infinite for equality.
 */
struct gz_study_errors {
	double psnr_db, ssim, flip;
	double foveal_psnr_db, foveal_ssim, foveal_flip;
	double perceived_psnr_db, perceived_ssim, perceived_flip;
};

/** One counted frame; bench/study/columns.h names what is measured. */
struct gz_study_row {
	uint16_t scene, size, backend, variant; /**< places in the study's lists */
	uint32_t point;                         /**< place in the study's points */
	uint32_t frame;                         /**< 0, 1, … of this point */
	struct gz_point gaze;
	double plan_ms, cast_ms, reconstruct_ms;
	double frame_ms; /**< wall time of the whole frame, plan included */
	double gpu_ms;   /**< GL_TIME_ELAPSED; NaN without a device clock */
	/** What the technique prepared and keeps between frames; of a point's first counted frame,
	 *  with its warm-up frames. NaN in studies of versions that did not measure it. */
	double prepare_ms;
	uint64_t rays, samples;
	/** Of the picture at this gaze with the camera not turned: the same for all frames of one
	 *  point and variant. */
	struct gz_study_errors converged; /**< against the converged picture */
	struct gz_study_errors standard;  /**< against standard, of the same backend */
	/** Mean change of the picture while the gaze trembles by a pixel and nothing else moves,
	 *  weighted as perceived errors are, in levels of 255; NaN where it was not measured. */
	double flicker;
	/** How much the eye sees come and go that does not in pictures of standard, while the
	 * camera turns and the gaze rests (metrics/temporal.h): weighted as perceived errors are,
	 * in levels of 255. NaN where it was not measured, and in studies of versions that did not.
	 */
	double turning_error;
	/** The same while the camera follows the study's camera path; NaN without one. */
	double camera_path_error;
	/** How far the converged picture is from one of half its step, PSNR: what its own error may
	 *  be; NaN where there is no converged picture. */
	double reference_db;
};

/** A study, whole or so far. Zero-initialised is empty. */
struct gz_study {
	struct gz_study_scene *scenes;
	size_t scene_count; /**< each scene once for each of its transfer functions */
	struct gz_study_variant *variants;
	size_t variant_count;
	int (*sizes)[2]; /**< px */
	size_t size_count;
	/** As given: "cpu", "gl", "cpu:threads=2", "cpu:simd=avx2". */
	char (*backends)[GZ_NAME_SIZE];
	size_t backend_count;
	char path[GZ_PATH_SIZE]; /**< of the gaze, as given: "sweep:s", "random:256", "log.gzl" */
	double min_move_px; /**< points nearer than this to the one before were left out; 0 = none
			     */
	bool per_cell;      /**< one point was kept in each cell of a 10 x 10 grid */
	char path_hash[GZ_STUDY_HASH_SIZE]; /**< of the points themselves */
	struct gz_study_point *points;
	size_t point_count;
	uint32_t camera_count; /**< random ones; 0 = only the scene's own */
	uint64_t seed;
	int frames_per_point;
	int warm_up_frames; /**< of each variant at each point, not counted */
	enum gz_study_accuracy accuracy;
	/** File with a camera for each frame while the camera_path_error is measured, as given;
	 *  empty: none. */
	char camera_path[GZ_PATH_SIZE];
	char camera_path_hash[GZ_STUDY_HASH_SIZE]; /**< of its cameras in all scenes; or empty */
	/** Its cameras, by scene; NULL: there is no path, or the study was read from a folder. */
	struct gz_camera_path *camera_paths;
	/** Acuity bound: the share of pixels' rays that the eye needs at all, of each scene, size
	 *  and point; scene_count * size_count * point_count values, points fastest. */
	double *bound_rays;
	struct gz_study_machine machine;
	/** This study holds the units u with u % shard_count == shard. A unit is one scene, size,
	 *  backend and point with all frames of all variants, which are measured in turn, so that
	 *  their ratios are of one run: gz_study_unit_row(). */
	int shard, shard_count;
	bool complete; /**< every row of the shard is there */

	/** Of whole units, sorted by scene, size, backend, point, variant, frame. */
	struct gz_study_row *rows;
	size_t row_count;
};

/** Units of the whole study, all shards together. */
size_t gz_study_unit_count(const struct gz_study *study);

/** Units of the study's own shard. */
size_t gz_study_shard_unit_count(const struct gz_study *study);

/** Rows of one unit: variants times frames. */
size_t gz_study_unit_rows(const struct gz_study *study);

/**
 * Row @p k of unit @p unit before it is measured: scene, size, backend, variant, point, frame and
 * gaze are set; measured values are 0, or NaN where measuring is optional.
 *
 * @param unit  below gz_study_unit_count(); points count fastest, then backends, sizes, scenes
 * @param k     below gz_study_unit_rows()
 */
struct gz_study_row gz_study_unit_row(const struct gz_study *study, size_t unit, size_t k);

/**
 * The camera of a point: 0 is the scene's; the n-th random one looks at the same place from as far
 * away, in a direction that is uniform over the sphere, by the study's seed: the same bits on every
 * machine.
 */
struct gz_camera gz_study_camera(const struct gz_study *study, size_t scene, uint32_t camera);

/** Geometry of a scene's pictures at one of the sizes, which fill the display: its pixels are the
 *  picture's. Where no display is known it is gz_display_default(), which has square pixels. */
struct gz_display gz_study_display(const struct gz_study *study, size_t scene, size_t size);

/** A file's name without folder and, where it has it, @p ending; cut at GZ_STUDY_TEXT_SIZE. */
void gz_study_file_name(const char *path, const char *ending, char out_name[GZ_STUDY_TEXT_SIZE]);

/**
 * Whether two studies were requested differently: lists, hashes, points, frames, program and
 * commit; not the machine, the shard and the progress. Hashes of scenes count, their paths do not.
 *
 * @param[out] what  on true, the first difference: "size 2 is 640x480, and was 800x600"
 * @param size       bytes of @p what
 */
bool gz_study_differs(const struct gz_study *study, const struct gz_study *was, char *what,
		      size_t size);

/** All errors NaN. */
struct gz_study_errors gz_study_errors_unmeasured(void);

/** Free what it holds and zero it. */
void gz_study_free(struct gz_study *study);

/** Describe this machine and build: host_cpu, memory, system and compiler. "unknown" stands for
 *  what cannot be told. */
void gz_study_machine_describe(struct gz_study_machine *out_machine);

/** Time that one thread takes to copy a picture of RGBA8, ms: the median of some. NaN without
 *  memory for it. */
double gz_study_copy_ms(int width, int height);

/**
 * The commit of a program, so that two programs of one commit are told apart where somebody has
 * changed files since: behind a commit that does not say all, "unknown" or one that ends with
 * "-dirty", stand the first digits of the SHA-256 of the program's own file.
 *
 * @param commit        as cmake/commit.cmake tells it
 * @param file          of the program: "/proc/self/exe" is the one that runs. One that cannot be
 *                      read adds nothing
 * @param[out] out_text  "0123abc", "0123abc-dirty-89ab01cd45ef"
 */
void gz_study_identify(const char *commit, const char *file, char out_text[GZ_STUDY_TEXT_SIZE]);

#endif
