/**
 * @file
 * One tile of rays at meshes: the weighted mean of the surface parameters where each ray ends.
 * Within this room.
 */
#ifndef GZ_RENDER_ILLUSTRATION_CPU_ILLUSTRATE_CAST_H
#define GZ_RENDER_ILLUSTRATION_CPU_ILLUSTRATE_CAST_H

#include <stdbool.h>
#include <stdint.h>

#include "render/illustration/shading_parameters.h"
#include "render/surface/cpu/embree.h"

/** Rays of a tile, which are one packet of Embree. */
#define GZ_ILLUSTRATE_RAYS 16

/** Steps of a normal's component from 0 to 1. */
#define GZ_ILLUSTRATE_NORMAL_STEPS 32767

/** What a ray reads of a vertex, side by side, so that a triangle takes few lines of the caches. */
struct gz_illustrate_vertex {
	int16_t normals[GZ_SHADING_LEVELS][3]; /**< times GZ_ILLUSTRATE_NORMAL_STEPS */
	float greatest, least; /**< curvatures, as shares of the mesh's scale; convex is positive */
	float distance_mm;     /**< to the chosen object; INFINITY: none is chosen */
};

/** One mesh. All pointers are borrowed. */
struct gz_illustrate_mesh {
	const uint32_t (*triangles)[3]; /**< in the order of the tree */
	const struct gz_illustrate_vertex *vertices;
	uint32_t id;      /**< of its object */
	unsigned look;    /**< which of struct gz_illustrate_cast.looks */
	bool transparent; /**< rays go on behind it */
};

/** Weights of the surface parameters, 0 or more. */
struct gz_illustrate_weights {
	float main_light, plateau_light, grazing_light, surface_shape, curvature, plain_light;
	float flat; /**< the tone if all of them are 0, [0, 1] */
};

/** How a surface becomes a tone. */
struct gz_illustrate_look {
	struct gz_illustrate_weights weights;
	int main_level; /**< of the normals under the main light */
	struct gz_grazing_light grazing;
};

/** Most layers of surfaces that a ray goes through. Chosen: more cannot be told apart. */
#define GZ_ILLUSTRATE_LAYERS_MAX 4

/** What all rays of a frame share. Lengths are in mm, in the frame of struct gz_mesh. */
struct gz_illustrate_cast {
	RTCScene tree;
	const struct gz_illustrate_mesh *meshes; /**< by the tree's numbers of geometries */
	unsigned mesh_count;
	/** The ray of pixel (x, y), as in struct gz_ray_frame. */
	float origin00[3], origin_dx[3], origin_dy[3];
	float direction00[3], direction_dx[3], direction_dy[3];
	bool clipped;
	float clip_least[3], clip_greatest[3]; /**< only what lies between shows */
	const struct gz_illustrate_look *looks;
	int layers;    /**< 1 to GZ_ILLUSTRATE_LAYERS_MAX; 1: no mesh is transparent */
	float lamp[3]; /**< unit vector towards the lamp of plain light */
};

/** The rays of a tile. */
struct gz_illustrate_tile {
	float x[GZ_ILLUSTRATE_RAYS], y[GZ_ILLUSTRATE_RAYS]; /**< pixels of its rays */
	uint32_t active;                                    /**< bit i: cast ray i */
};

/** What the rays found. Where there is nothing, ids are 0 and all else is INFINITY. */
struct gz_illustrate_hits {
	float tone[GZ_ILLUSTRATE_RAYS];        /**< weighted mean of the parameters, [0, 1] */
	float depth_mm[GZ_ILLUSTRATE_RAYS];    /**< along the ray */
	float distance_mm[GZ_ILLUSTRATE_RAYS]; /**< to the chosen object */
	uint32_t ids[GZ_ILLUSTRATE_RAYS];
};

/**
 * Cast a tile. What a ray finds depends on its pixel alone. A surface that is seen from behind is
 * shaded as if it faced the viewer. Threads: any number. Does not allocate.
 *
 * @param[out] out_hits  of each layer: the first surface, then, as long as those before it are
 *                       transparent, the next ones. The last layer is the next opaque surface:
 *                       transparent ones in between are left out
 */
void gz_illustrate_tile_cast(const struct gz_illustrate_cast *cast,
			     const struct gz_illustrate_tile *tile,
			     struct gz_illustrate_hits out_hits[GZ_ILLUSTRATE_LAYERS_MAX]);

#endif
