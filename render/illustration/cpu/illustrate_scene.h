/**
 * @file
 * What an illustration shows: meshes, their tree, and what shading knows of their vertices. Within
 * this room.
 */
#ifndef GZ_RENDER_ILLUSTRATION_CPU_ILLUSTRATE_SCENE_H
#define GZ_RENDER_ILLUSTRATION_CPU_ILLUSTRATE_SCENE_H

#include <stdbool.h>

#include "render/illustration/cpu/illustrate_cast.h"
#include "render/illustration/cpu/illustrate_caster.h"
#include "render/surface/cpu/surface_tree.h"
#include "render/surface/shared/surface_meshes.h"

/** One object's vertices. */
struct gz_illustrate_item {
	const char *input;                     /**< borrowed; NULL: nothing is kept */
	struct gz_illustrate_vertex *vertices; /**< of the mesh that is shown; NULL: not made */
};

/** All of it. Zero-initialised with log set and the tree opened, it shows nothing. */
struct gz_illustrate_scene {
	const struct gz_log *log; /**< may be NULL; borrowed */
	struct gz_surface_meshes meshes;
	struct gz_surface_tree tree;
	struct gz_illustrate_item *items;  /**< meshes.count */
	struct gz_illustrate_mesh *listed; /**< as rays read them */
	float *importances;                /**< of object 1 to importance_count */
	size_t importance_count;
	uint32_t measured_id;           /**< object that distances are to; 0: none */
	double centre_mm[3], radius_mm; /**< of a ball around all vertices */
	unsigned made;                  /**< how often any of it was made */
	bool current;                   /**< tree, vertices and ball are those of meshes.shown */
};

/** gz_illustrate_caster_show(). */
enum gz_result gz_illustrate_scene_show(struct gz_illustrate_scene *scene,
					const struct gz_object *objects,
					const struct gz_illustrated *each, size_t count);

/**
 * Make what is missing for a picture.
 *
 * @param chosen_id  object from which distances are wanted; 0: none. An object that is not shown
 *                   leaves all distances infinite
 * @return as gz_illustrate_caster_draw()
 */
enum gz_result gz_illustrate_scene_prepare(struct gz_illustrate_scene *scene, double isovalue,
					   uint32_t chosen_id, struct gz_workers *workers);

/** Free all but the log. */
void gz_illustrate_scene_free(struct gz_illustrate_scene *scene);

#endif
