/**
 * @file
 * Triangle meshes in a bounding volume hierarchy of Embree.
 */
#ifndef GZ_RENDER_SURFACE_CPU_SURFACE_TREE_H
#define GZ_RENDER_SURFACE_CPU_SURFACE_TREE_H

#include <stddef.h>

#include "base/log.h"
#include "base/result.h"
#include "render/mesh/mesh.h"
#include "render/surface/cpu/embree.h"

/** A device of Embree with one tree. Zero-initialised is empty. */
struct gz_surface_tree {
	RTCDevice device;
	RTCScene scene; /**< NULL before the first gz_surface_tree_build() */
	const struct gz_log *log;
	_Atomic ptrdiff_t bytes; /**< that Embree has allocated for the tree */
};

/**
 * Open the device.
 *
 * @param isa  instruction set, as Embree's configuration names it
 * @param log  outlives the tree
 * @retval GZ_ERR_UNSUPPORTED  Embree refuses this machine; logged
 */
enum gz_result gz_surface_tree_open(struct gz_surface_tree *tree, const char *isa,
				    const struct gz_log *log);

/**
 * Build the tree again. Mesh i becomes geometry i. The tree is built by one thread, because several
 * threads order triangles by chance, and of two triangles at equal distance the first one counts.
 *
 * @param meshes  borrowed until the next build; empty ones have no geometry
 * @retval GZ_ERR_NO_MEM  logged; the tree is empty
 */
enum gz_result gz_surface_tree_build(struct gz_surface_tree *tree, const struct gz_mesh meshes[],
				     size_t count);

/** Free and zero. */
void gz_surface_tree_close(struct gz_surface_tree *tree);

#endif
