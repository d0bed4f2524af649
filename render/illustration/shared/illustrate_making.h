/**
 * @file
 * Making the marks of objects: an order of what is to be made, which needs nothing of the scene any
 * more, and a thread that carries an order out while grey pictures go on. Within this room.
 */
#ifndef GZ_RENDER_ILLUSTRATION_SHARED_ILLUSTRATE_MAKING_H
#define GZ_RENDER_ILLUSTRATION_SHARED_ILLUSTRATE_MAKING_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>

#include "base/log.h"
#include "base/result.h"
#include "base/workers.h"
#include "render/illustration/hatch_strokes.h"
#include "render/illustration/illustration_look.h"
#include "render/illustration/stipple_points.h"
#include "render/mesh/mesh.h"
#include "render/mesh/mesh_curvature.h"

/** Directions of the strokes of an object: along, and around. */
#define GZ_HATCH_DIRECTIONS 2

/** The marks of an object. Zero-initialised has none. */
struct gz_illustrate_marks {
	/** For how many points of the whole scene they were made; 0: they were not. */
	unsigned points_for, strokes_for;
	struct gz_stipple_points points;
	struct gz_hatch_strokes strokes[GZ_HATCH_DIRECTIONS];
};

/** Free them. */
void gz_illustrate_marks_free(struct gz_illustrate_marks *marks);

/** The marks of one object, to be made. */
struct gz_marks_task {
	size_t item;                       /**< its place in the scene */
	enum gz_illustration_drawing kind; /**< stipples or hatches */
	size_t points;                     /**< as many, or strokes that start from as many */
	struct gz_mesh mesh;               /**< owned if the order says so */
	struct gz_curvature *curvatures;   /**< of its vertices, of any scale, for hatches; owned */
	bool keeps;                        /**< in files */
	char *input;                       /**< as struct gz_mesh_cache_place has it; owned */
	char *name;                        /**< how endings of files begin; owned */
	struct gz_illustrate_marks made;   /**< owned */
	/* While strokes are made: */
	struct gz_mesh_points starts;
	float (*directions)[3];
	enum gz_result results[GZ_HATCH_DIRECTIONS];
};

/** All that is to be made for a picture. */
struct gz_marks_order {
	const struct gz_log *log; /**< may be NULL; borrowed */
	unsigned in_all;          /**< points of the whole scene */
	size_t count;
	struct gz_marks_task *tasks; /**< owned */
	bool owns_meshes;
	atomic_bool stopped; /**< what is not made yet is left out */
};

/** Carry an order out. The same marks for any number of threads.
 *  @retval GZ_ERR_NO_MEM  out of memory */
enum gz_result gz_marks_order_make(struct gz_marks_order *order, struct gz_workers *workers);

/** Free all that an order owns and zero it. */
void gz_marks_order_free(struct gz_marks_order *order);

/** A thread that carries an order out. */
struct gz_marks_maker;

/**
 * Start one.
 *
 * @param order    moved into the maker on GZ_OK; it owns its meshes
 * @param threads  that share the work
 * @param[out] out_maker  owned by the caller; gz_marks_maker_end()
 * @retval GZ_ERR_NO_MEM  out of memory, or the thread cannot be started
 */
enum gz_result gz_marks_maker_start(struct gz_marks_order *order, int threads,
				    struct gz_marks_maker **out_maker);

/** Whether it is done. */
bool gz_marks_maker_done(const struct gz_marks_maker *maker);

/** What it makes is not wanted any more: it is done soon. */
void gz_marks_maker_stop(struct gz_marks_maker *maker);

/**
 * Wait until a maker is done, free it and set the pointer to NULL. Accepts a pointer to NULL.
 *
 * @param[out] out_order  gets the order with what was made; NULL: that is freed
 * @return as gz_marks_order_make()
 */
enum gz_result gz_marks_maker_end(struct gz_marks_maker **maker, struct gz_marks_order *out_order);

#endif
