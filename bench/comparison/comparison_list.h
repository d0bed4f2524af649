/**
 * @file
 * What is compared: the series of a scene that this machine can draw. For comparison.c alone.
 */
#ifndef GZ_BENCH_COMPARISON_COMPARISON_LIST_H
#define GZ_BENCH_COMPARISON_COMPARISON_LIST_H

#include "bench/comparison/comparison.h"
#include "render/frame/picture_maker.h"
#include "render/raycast/shared/ray_params.h"

/** A scene to be drawn. All pointers are borrowed. */
struct gz_comparison_stage {
	const struct gz_volume *volume;
	const struct gz_transfer *transfer;
	const struct gz_camera *camera;
	const struct gz_display *display;
	const struct gz_ray_params *rays; /**< of the scene, with the isovalue */
};

/** A way to draw. */
struct gz_comparison_series {
	const struct gz_technique *technique;
	const char *backend;
	size_t effect; /**< index into gz_effects */
	int slices;    /**< 0: none */
	struct gz_ray_params rays;
	struct gz_picture_maker *maker;
	double prepare_ms;
};

/** A list that grows. Zero-initialised is empty. */
struct gz_comparison_list {
	struct gz_comparison_series *series;
	size_t count;
	struct gz_comparison_gap *gaps;
	size_t gap_count;
	/** Whether the ray caster of converged pictures has an effect, by effect. */
	bool converged_has[GZ_EFFECT_COUNT];
};

/** The backend of converged pictures. */
extern const char gz_comparison_reference_backend[];

/** Make a picture maker that shows the stage's volume. @return its failures; logged */
enum gz_result gz_comparison_open(const struct gz_comparison_stage *stage,
				  const struct gz_technique *technique, const char *backend,
				  const struct gz_log *log, struct gz_picture_maker **out_maker);

/**
 * List the series of a scene: each technique that shows volumes, each of its backends that runs
 * here, each effect that changes its picture, and 64, 128 and 512 slices if it has any, as far as
 * they are asked for. What is missing is listed too. Makers are not opened.
 * @retval GZ_ERR_NO_MEM  out of memory
 */
enum gz_result gz_comparison_list_make(const struct gz_comparison_stage *stage,
				       const struct gz_comparison_request *request,
				       struct gz_comparison_list *out_list);

/** Free what it holds, makers too, and zero it. */
void gz_comparison_list_free(struct gz_comparison_list *list);

#endif
