/**
 * @file
 * The meshes of a picture: those of its objects, and those that are made of volumes at the
 * isovalue and kept while it stays.
 */
#ifndef GZ_RENDER_SURFACE_SHARED_SURFACE_MESHES_H
#define GZ_RENDER_SURFACE_SHARED_SURFACE_MESHES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "base/workers.h"
#include "render/mesh/mesh.h"
#include "render/technique/technique.h"

/** Most vertices and triangles of a mesh: kernels and OpenGL count corners in 31 bits. */
#define GZ_SURFACE_ELEMENTS_MAX ((size_t)INT32_MAX / 3)

/** One object, and the mesh that was made for it. */
struct gz_surface_item {
	struct gz_object object;
	struct gz_mesh made; /**< of the object's volume */
	double isovalue;     /**< of it */
	bool current;        /**< it is made */
};

/** All of them. Zero-initialised with log set, it shows nothing. */
struct gz_surface_meshes {
	const struct gz_log *log; /**< may be NULL; borrowed */
	struct gz_surface_item *items;
	struct gz_mesh *shown; /**< of each item, borrowed: gz_surface_meshes_make() lists them */
	size_t count;
	double world_mm;      /**< mm of a world unit */
	bool listed;          /**< shown is what the objects and the isovalue ask for */
	bool without_volumes; /**< volumes are shown without triangles: their meshes are empty */
};

/**
 * Show these objects from now on. Meshes are made later, when the isovalue is known; those that
 * were made of the same data are kept.
 *
 * @param objects  volumes in memory, and meshes; all of one world, the first one's volume's box.
 *                 What they point to is borrowed until the next call
 * @retval GZ_ERR_INVAL        no objects
 * @retval GZ_ERR_UNSUPPORTED  a volume of bricks, or an object without a volume; logged
 * @retval GZ_ERR_NO_MEM       out of memory
 */
enum gz_result gz_surface_meshes_show(struct gz_surface_meshes *meshes,
				      const struct gz_object *objects, size_t count);

/**
 * Make the meshes that are not there, and list all of them in meshes->shown.
 *
 * @param[out] out_new  whether meshes->shown has changed
 * @retval GZ_ERR_FULL  a mesh has more than GZ_SURFACE_ELEMENTS_MAX elements; logged
 * @return otherwise what gz_isosurface_make() returns; logged
 */
enum gz_result gz_surface_meshes_make(struct gz_surface_meshes *meshes, double isovalue,
				      struct gz_workers *workers, bool *out_new);

/** Say whether volumes are shown without triangles, from the next gz_surface_meshes_make() on.
 * Those that were made are kept. */
void gz_surface_meshes_without_volumes(struct gz_surface_meshes *meshes, bool without);

/** Take the meshes that others have made of the same data. */
void gz_surface_meshes_take(struct gz_surface_meshes *meshes, struct gz_surface_meshes *from);

/** Bytes of the meshes that were made. */
size_t gz_surface_meshes_bytes(const struct gz_surface_meshes *meshes);

/** Triangles of all meshes that are listed. */
size_t gz_surface_meshes_triangles(const struct gz_surface_meshes *meshes);

/** Free all of it; log stays. */
void gz_surface_meshes_free(struct gz_surface_meshes *meshes);

#endif
