/**
 * @file
 * The lattices on which surfaces are found, on the host, and the planes of a picture that are made
 * of them with the filters of rays' planes (render/reconstruct/cpu/). Within this room and for
 * tests.
 */
#ifndef GZ_RENDER_ILLUSTRATION_GL_ILLUSTRATE_POINTS_H
#define GZ_RENDER_ILLUSTRATION_GL_ILLUSTRATE_POINTS_H

#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "base/workers.h"
#include "render/illustration/shared/illustrate_picture.h"
#include "render/layers/raster_layers.h"

/** What shaders/illustrate.frag finds at a point. */
enum gz_illustrate_vector {
	GZ_ILLUSTRATE_VECTOR_TONE,
	GZ_ILLUSTRATE_VECTOR_DEPTH,    /**< mm */
	GZ_ILLUSTRATE_VECTOR_OBJECT,   /**< its number, negative if it is transparent; 0: nothing */
	GZ_ILLUSTRATE_VECTOR_DISTANCE, /**< mm; not finite: none is chosen */
	GZ_ILLUSTRATE_VECTOR_SIZE,
};

/** The points of one lattice, row by row, without gaps. */
struct gz_illustrate_lattice {
	struct gz_raster_layer layer;
	float (*vectors)[GZ_ILLUSTRATE_VECTOR_SIZE]; /**< filled by the device */
	uint32_t *planes[GZ_ILLUSTRATE_FOUND];       /**< the same, as planes */
};

/** All lattices of a picture, coarsest first. Zero-initialised is empty; keep it from picture to
 *  picture. */
struct gz_illustrate_points {
	struct gz_illustrate_lattice lattices[GZ_PLAN_RECTANGLES_MAX];
	int count;
	int plane_count; /**< those that are made: struct gz_illustrate_picture */
	uint32_t *rows;  /**< two rows of the picture for each thread */
	uint32_t *memory;
	size_t capacity; /**< words */
};

/** Lay out the lattices of a plan. What they hold is undefined. @param threads  that will make
 *  planes @retval GZ_ERR_NO_MEM */
enum gz_result gz_illustrate_points_prepare(struct gz_illustrate_points *points,
					    const struct gz_plan *plan, int plane_count,
					    int threads);

/** Make the planes of a picture, of the plan's size, from the vectors of all lattices. The same
 *  bits for any number of threads. */
void gz_illustrate_points_to_planes(struct gz_illustrate_points *points, struct gz_workers *workers,
				    struct gz_plane planes[GZ_ILLUSTRATE_FOUND]);

/** Free and zero. */
void gz_illustrate_points_free(struct gz_illustrate_points *points);

#endif
