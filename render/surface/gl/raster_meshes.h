/**
 * @file
 * Meshes on the graphics device. They are uploaded once, and drawn by every frame until they
 * change. All calls need a current context.
 */
#ifndef GZ_RENDER_SURFACE_GL_RASTER_MESHES_H
#define GZ_RENDER_SURFACE_GL_RASTER_MESHES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "render/layers/raster_layers.h"
#include "render/opengl/gl_device.h"
#include "render/surface/gl/raster_clusters.h"
#include "render/surface/gl/raster_view.h"
#include "render/surface/shared/surface_frame.h"
#include "render/surface/shared/surface_meshes.h"

/** Attributes of a vertex in shaders. */
enum gz_raster_attribute { GZ_RASTER_POSITION, GZ_RASTER_NORMAL };

/** An attribute that vertices have beside their position. */
struct gz_raster_field {
	unsigned location;
	int components; /**< 1 to 4 */
	unsigned type;  /**< OpenGL's; whole numbers are read as shares of their greatest one */
	size_t offset;  /**< bytes from the start of the vertex */
};

/** What vertices are beside their positions: one struct for each. All pointers are borrowed. */
struct gz_raster_vertices {
	const struct gz_raster_field *fields;
	int count;
	size_t stride;           /**< bytes of a vertex */
	const void *const *data; /**< of each mesh */
};

/** One mesh; OpenGL's names. */
struct gz_raster_mesh {
	unsigned vertices;   /**< vertex array; 0: the mesh has no triangles */
	unsigned buffers[3]; /**< positions, what is beside them, triangles */
	int corners;         /**< three a triangle */
	struct gz_raster_clusters clusters;
	struct gz_raster_run *runs; /**< room for as many as there are clusters */
	/** Room for as many, as OpenGL takes them: how many corners, and from which byte on. */
	int *run_corners;
	const void **run_offsets;
	uint32_t id;              /**< of the object */
	struct gz_raster_box box; /**< around its vertices */
};

/** All of them. Zero-initialised is empty. */
struct gz_raster_meshes {
	struct gz_raster_mesh *items;
	size_t count;
	struct gz_raster_box box; /**< around all vertices */
	uint64_t serial;          /**< increased by every upload */
	bool uploaded;
};

/**
 * Upload the meshes that are listed, in place of those there are.
 *
 * @param vertices  NULL: beside positions are the meshes' normals, at GZ_RASTER_NORMAL
 * @retval GZ_ERR_NO_MEM     the device has no room, or the host for the list; logged
 * @retval GZ_ERR_NO_DEVICE  the context is lost; logged
 */
enum gz_result gz_raster_meshes_upload(struct gz_raster_meshes *meshes,
				       const struct gz_gl_device *device,
				       const struct gz_surface_meshes *listed,
				       const struct gz_raster_vertices *vertices,
				       const struct gz_log *log);

/** Draw all triangles with the program in use. */
void gz_raster_meshes_draw(const struct gz_raster_meshes *meshes);

/** Where a program takes the numbers of an object: locations of uniforms. */
struct gz_raster_locations {
	int id, colour;
};

/** Whether a mesh has triangles that may lie on a lattice. */
bool gz_raster_mesh_in_view(const struct gz_raster_mesh *mesh, const struct gz_raster_view *view,
			    const struct gz_raster_layer *lattice);

/** Draw what an eye may see on a lattice of a mesh that has triangles: those that two neighbours
 *  share only from the front, because both lie at the same place. */
void gz_raster_mesh_draw_seen(const struct gz_raster_mesh *mesh, const struct gz_raster_view *view,
			      const struct gz_raster_layer *lattice);

/** Draw what an eye sees of all meshes on a lattice. Sets each object's id and colour. */
void gz_raster_meshes_draw_seen(const struct gz_raster_meshes *meshes,
				const struct gz_surface_meshes *listed,
				const struct gz_surface_look *look,
				const struct gz_raster_view *view,
				const struct gz_raster_layer *lattice,
				struct gz_raster_locations locations);

/** Delete and forget them. */
void gz_raster_meshes_free(struct gz_raster_meshes *meshes);

/** Forget them without a context: a lost one took them with it. */
void gz_raster_meshes_forget(struct gz_raster_meshes *meshes);

#endif
