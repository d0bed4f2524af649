/**
 * @file
 * One tile of rays through triangle meshes: what the kernels of all instruction sets share.
 */
#ifndef GZ_RENDER_SURFACE_CPU_SURFACE_CAST_H
#define GZ_RENDER_SURFACE_CPU_SURFACE_CAST_H

#include <stdbool.h>
#include <stdint.h>

#include "render/plan/plan.h"
#include "render/raycast/cpu/cast.h"
#include "render/surface/cpu/embree.h"
#include "render/surface/cpu/surface_normals.h"
#include "render/surface/shared/surface_frame.h"
#include "render/technique/shade.h"

/** Rays of a tile, which are one packet. */
#define GZ_SURFACE_RAYS 16

_Static_assert(GZ_TILE_EDGE *GZ_TILE_EDGE == GZ_SURFACE_RAYS, "a tile is a packet");

/** One mesh as the kernels read it. All pointers are borrowed. */
struct gz_surface_mesh {
	const float *positions;                  /**< three numbers for each vertex; mm */
	const uint32_t *triangles;               /**< three vertices each */
	const struct gz_corner_normals *normals; /**< of each triangle */
	uint32_t id;                             /**< of its object */
	float colour[3];                         /**< of its object, or the settings' */
};

/** Halvings of the part of a ray in which it crosses a field's isovalue. Chosen: that part is at
 * most two voxels long, so places are found to 2^-17 of a voxel, as far as single precision goes.
 */
#define GZ_FIELD_BISECTIONS 18
/** A ray goes at least so far at a time, finest voxel edges, or rounding could hold it on a face.
 */
#define GZ_FIELD_ONWARD (1.0F / 128)

/** A volume whose surface is found without triangles. */
struct gz_surface_field {
	bool on;         /**< there is one */
	unsigned number; /**< its number among the meshes, where it is an empty one */
	/** What sample_trilinear() and look_up_cell() read: voxels, dims, last, stride, reach,
	 *  cell_last and cell_stride. Cells are empty that the surface does not cross. */
	struct gz_cast voxels;
	enum gz_voxel_type type;
	float value;            /**< the isovalue as it is stored */
	float voxels_per_mm[3]; /**< along each axis */
	float step_mm;          /**< the finest voxel edge */
};

/** What all rays of a frame share. Lengths and places are in mm, in the frame of struct gz_mesh. */
struct gz_surface_cast {
	RTCScene tree;
	const struct gz_surface_mesh *meshes; /**< by the tree's numbers of geometries */
	unsigned mesh_count;
	struct gz_surface_field field;
	struct gz_surface_frame frame;
	const struct gz_shade *shades; /**< of others on the surfaces */
	size_t shade_count;
};

/** The rays of a tile. */
struct gz_surface_tile {
	float x[GZ_SURFACE_RAYS], y[GZ_SURFACE_RAYS]; /**< pixels of its rays */
	uint32_t active;                              /**< bit i: cast ray i */
	float step;    /**< of its rays, times that of the scene: gz_shade_places.step */
	bool coherent; /**< rays lie close together: a hint that changes nothing but the time */
};

/** What the rays of a tile found; valid for active rays. */
struct gz_surface_hits {
	uint32_t pixels[GZ_SURFACE_RAYS]; /**< R, G, B, 255 in memory order */
	float depth[GZ_SURFACE_RAYS];     /**< along the ray, world units; INFINITY: nothing */
	uint32_t ids[GZ_SURFACE_RAYS];    /**< of the objects; 0: nothing */
};

/**
 * Cast a tile.
 *
 * Threads: any number. What a ray finds depends only on its pixel.
 */
typedef void gz_surface_tile_function(const struct gz_surface_cast *cast,
				      const struct gz_surface_tile *tile,
				      struct gz_surface_hits *out_hits);

/** Find which places the light reaches past the surfaces: gz_shade.find, with 1 or 0 for a share.
 */
typedef void gz_surface_lit_function(const struct gz_surface_cast *cast,
				     const struct gz_shade_places *places,
				     float out_shares[GZ_SHADE_PLACES]);

_Static_assert(GZ_SHADE_PLACES == GZ_SURFACE_RAYS, "the places of a shade are a packet");

/** The kernel of one instruction set. */
struct gz_surface_kernel {
	const char *name; /**< as in struct gz_cast_kernels */
	const char *isa;  /**< the same set in the configuration of Embree's devices */
	gz_surface_tile_function *tile;
	gz_surface_lit_function *lit;
};

extern const struct gz_surface_kernel gz_surface_portable;
#ifdef GZ_CAST_X86
extern const struct gz_surface_kernel gz_surface_avx2;
extern const struct gz_surface_kernel gz_surface_avx512;
#endif

#endif
