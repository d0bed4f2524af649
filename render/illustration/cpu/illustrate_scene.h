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

/** What vertices were made of. */
struct gz_illustrate_key {
	bool known; /**< they are there */
	const struct gz_volume *volume;
	const struct gz_mesh *mesh;
	uint64_t revision;
	double isovalue; /**< of a volume's surface */
};

/** A template of some objects. */
struct gz_illustrate_template {
	const struct gz_shading_template *said; /**< borrowed; NULL: none */
};

/** One object's vertices. */
struct gz_illustrate_item {
	unsigned look; /**< its template: see struct gz_illustrate_scene */
	float opacity; /**< [0, 1] */
	struct gz_illustrate_key key;
	struct gz_illustrate_vertex *vertices; /**< of the mesh that is shown; NULL: not made */
};

/** All of it. Zero-initialised with log set and the tree opened, it shows nothing. */
struct gz_illustrate_scene {
	const struct gz_log *log; /**< may be NULL; borrowed */
	struct gz_surface_meshes meshes;
	struct gz_surface_tree tree;
	struct gz_illustrate_item *items; /**< of the meshes; count of them */
	size_t count;
	struct gz_illustrate_mesh *listed; /**< as rays read them */
	float *importances;                /**< of object 1 to id_count */
	float *opacities;                  /**< likewise; 1 where there is no object */
	unsigned *looks;                   /**< likewise; 0 where there is no object */
	size_t id_count;
	/** The templates of all objects, each once; the first is none. */
	struct gz_illustrate_template *templates;
	size_t template_count;
	bool transparent;               /**< any object is */
	uint32_t measured_id;           /**< object that distances are to; 0: none */
	double centre_mm[3], radius_mm; /**< of a ball around all vertices */
	unsigned made;                  /**< how often any of it was made */
	bool built;                     /**< tree and ball are those of the items' keys */
};

/** gz_illustrate_caster_show(). */
enum gz_result gz_illustrate_scene_show(struct gz_illustrate_scene *scene,
					const struct gz_object *objects, size_t count);

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
