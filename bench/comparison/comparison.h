/**
 * @file
 * A comparison of techniques: the same volume drawn by each technique and backend that this machine
 * has, with each effect that they have, by each method. Nothing is averaged before it is stored.
 */
#ifndef GZ_BENCH_COMPARISON_COMPARISON_H
#define GZ_BENCH_COMPARISON_COMPARISON_H

#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/option.h"
#include "base/result.h"
#include "bench/comparison/effects.h"
#include "bench/study/study.h"
#include "render/technique/technique.h"

/** What is asked. All pointers are borrowed while the comparison lives. */
struct gz_comparison_request {
	const char *const *scenes; /**< paths */
	size_t scene_count;
	const char *methods;     /**< beside standard: "acuity", as for gz_study_request */
	const char *backends;    /**< "cpu,gl"; empty: all that run here */
	const char *techniques;  /**< "raycast,slices"; empty: all */
	const char *effects;     /**< "none,shadow"; empty: all */
	int width, height;       /**< px */
	int frames;              /**< of each method; 0: as many as the camera path has, or 6 */
	int warm_up;             /**< frames before those; at least 1 */
	double turn_deg;         /**< that the camera turns a frame, without a camera path */
	const char *camera_path; /**< file (bench/study/camera_path.h); NULL: the camera turns */
	double isovalue;         /**< of surfaces; NaN: gz_comparison_isovalue() */
	bool errors;             /**< compare with the converged ray cast */
	const char *cache;       /**< folder of converged pictures; NULL: they are not kept */
	const char *pictures;    /**< folder for a picture of each series; NULL: none */
	const char *program, *commit;
};

/** One frame. */
struct gz_comparison_frame {
	double frame_ms; /**< wall time of the whole frame */
	double cast_ms, reconstruct_ms;
	double prepare_ms; /**< part of it that later frames reuse */
	double gpu_ms;     /**< NaN without a device clock */
	uint64_t rays, samples;
};

/** A picture's reference. */
enum gz_comparison_reference {
	GZ_REFERENCE_NONE, /**< not measured, or there is nothing that it should look like */
	/** The converged ray cast of the scene's transfer function with the same effect. */
	GZ_REFERENCE_VOLUME,
	/** The converged ray cast of matter that is opaque from the isovalue on: what an opaque
	 *  surface should look like. */
	GZ_REFERENCE_SURFACE,
	/** The surface where rays meet it in the voxels, with the same effect: for hard shadows and
	 *  glass, which translucent matter has not. */
	GZ_REFERENCE_VOXELS,
	GZ_REFERENCE_COUNT
};

/** One method of one series. */
struct gz_comparison_row {
	size_t scene; /**< place in the comparison's lists */
	const struct gz_technique *technique;
	const char *backend; /**< static text */
	const struct gz_effect *effect;
	int slices;    /**< 0: the technique has none */
	size_t method; /**< place in the comparison's list; 0 = standard */
	/** What it computes once: meshes and trees, textures, cells to skip. Of the series: the
	 *  same in the rows of all methods. */
	double prepare_ms;
	char device[GZ_STUDY_TEXT_SIZE];    /**< what draws: "avx512, 2 threads" */
	struct gz_comparison_frame *frames; /**< as many as the comparison has; counted ones */
	enum gz_comparison_reference reference;
	struct gz_study_errors converged; /**< against the reference; NaN without one */
	struct gz_study_errors standard;  /**< against the series' own standard; 0 for it */
};

/** Why a series is missing. */
enum gz_comparison_absence {
	GZ_ABSENT_BACKEND, /**< the backend does not run here, or cannot show the volume */
	GZ_ABSENT_EFFECT,  /**< refused, or it changes no pixel */
};

/** A series that is not there. */
struct gz_comparison_gap {
	size_t scene;
	const struct gz_technique *technique;
	const char *backend;
	const struct gz_effect *effect; /**< of GZ_ABSENT_EFFECT */
	enum gz_comparison_absence why;
};

/** A scene that is compared. */
struct gz_comparison_scene {
	char name[GZ_STUDY_TEXT_SIZE]; /**< of its file, without folder and ending */
	char path[GZ_PATH_SIZE];
	char data_hash[GZ_STUDY_HASH_SIZE]; /**< of volume and transfer function */
	int dims[3];
	double isovalue;
	/** PSNR of converged pictures against those of half their step, the worst; NaN: none. */
	double reference_db;
};

/** What came of it. Zero-initialised is empty. */
struct gz_comparison {
	struct gz_comparison_scene *scenes;
	size_t scene_count;
	char (*methods)[GZ_STUDY_TEXT_SIZE]; /**< the first is "standard" */
	size_t method_count;
	int width, height, frames, warm_up;
	double turn_deg;                /**< of no meaning with a camera path */
	char camera_path[GZ_PATH_SIZE]; /**< empty: the camera turns */
	struct gz_study_machine machine;
	struct gz_comparison_row *rows; /**< by scene, technique, backend, effect, slices, method */
	size_t row_count;
	struct gz_comparison_gap *gaps;
	size_t gap_count;
};

/** Check lists and names without reading a file. GZ_ERR_INVAL: logged with what is allowed. */
enum gz_result gz_comparison_check(const struct gz_comparison_request *request,
				   const struct gz_log *log);

/**
 * Measure.
 *
 * A series is a technique by a backend with an effect and, if it has slices, a number of them. Each
 * has a drawer of its own. In a round each method of each series renders a frame in turn; then the
 * camera turns, or takes the next place of the camera path, at whose first it warms up. Gaze and
 * plan are at the middle. Errors are those of one more picture from the scene's camera.
 *
 * @param[out] out_comparison  the caller's: gz_comparison_free()
 * @retval GZ_ERR_INVAL        the camera path has fewer cameras than frames are asked for, or more
 *                             than a row may have (GZ_STUDY_FRAMES_MAX); logged
 * @retval GZ_ERR_CANCELLED    SIGINT or SIGTERM has arrived; not logged
 * @retval GZ_ERR_UNSUPPORTED  a scene of meshes or bricks; logged
 * @return otherwise what loading scenes, reading the path and drawing return; logged
 */
enum gz_result gz_comparison_run(const struct gz_comparison_request *request,
				 const struct gz_log *log, struct gz_comparison *out_comparison);

/**
 * The isovalue of a scene: its own if it lies within the data; else the least value at which its
 * transfer function has half of its greatest opacity, which is where what is seen begins.
 *
 * @param own    isosurface.isovalue of the scene
 * @param range  least and greatest value of the data
 */
double gz_comparison_isovalue(double own, const double range[2],
			      const struct gz_transfer *transfer);

/** Free what it holds and zero it. */
void gz_comparison_free(struct gz_comparison *comparison);

#endif
