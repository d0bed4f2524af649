/**
 * @file
 * What an illustration shows: meshes, and what shading knows of their vertices.
 */
#ifndef GZ_RENDER_ILLUSTRATION_SHARED_ILLUSTRATE_SCENE_H
#define GZ_RENDER_ILLUSTRATION_SHARED_ILLUSTRATE_SCENE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "base/workers.h"
#include "render/illustration/shading_constants.h"
#include "render/illustration/shared/illustrate_marks.h"
#include "render/illustration/shared/illustrate_shot.h"
#include "render/surface/shared/surface_meshes.h"

/** Steps of a normal's component from 0 to 1. */
#define GZ_ILLUSTRATE_NORMAL_STEPS 32767

/** What shading reads of a vertex, side by side, so that a triangle takes few lines of the caches.
 */
struct gz_illustrate_vertex {
	int16_t normals[GZ_SHADING_LEVELS][3]; /**< times GZ_ILLUSTRATE_NORMAL_STEPS */
	float greatest, least; /**< curvatures, as shares of the mesh's scale; convex is positive */
	float distance_mm;     /**< to the chosen object; INFINITY: none is chosen */
};

/** One mesh. All pointers are borrowed. */
struct gz_illustrate_mesh {
	const uint32_t (*triangles)[3]; /**< in the order of struct gz_mesh */
	const struct gz_illustrate_vertex *vertices;
	uint32_t id;      /**< of its object */
	unsigned look;    /**< its template: struct gz_illustrate_scene.templates */
	bool transparent; /**< what is behind it shows */
};

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
	unsigned look;                    /**< its template: see struct gz_illustrate_scene */
	float opacity;                    /**< [0, 1] */
	int said_drawing, said_direction; /**< as struct gz_object_style has them */
	struct gz_illustrate_key key;
	struct gz_illustrate_vertex *vertices; /**< of the mesh that is shown; NULL: not made */
	float (*along)[3];                     /**< likewise; where they bend most, of length 1 */
	struct gz_illustrate_marks marks;      /**< likewise */
	bool keeps;                            /**< what is made of the mesh is kept in files */
};

/** All of it. Zero-initialised with log and waits_for_marks set, it shows nothing. */
struct gz_illustrate_scene {
	const struct gz_log *log; /**< may be NULL; borrowed */
	bool waits_for_marks;     /**< pictures wait until their marks are made */
	struct gz_surface_meshes meshes;
	struct gz_illustrate_item *items; /**< of the meshes; count of them */
	size_t count;
	struct gz_illustrate_mesh *listed; /**< as rays and shaders read them */
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
	uint64_t made;                  /**< how often any of it was made */
	uint64_t meshes_made;           /**< how often the list of meshes became another */
	bool built;                     /**< the ball is that of the items' keys */
	bool marks_coming;              /**< the last picture lacks marks that are being made */
	struct gz_marks_maker *maker;   /**< makes them; NULL: none does */
	uint64_t maker_for;             /**< the meshes_made of its marks */
};

/**
 * Show these objects from the next picture on. Surfaces and what shading knows of them are made
 * when that picture is prepared.
 *
 * What is known of meshes that stay is kept: another style costs nothing.
 *
 * @param objects  as for gz_surface_meshes_show(); ids are 1 to GZ_ILLUSTRATE_ID_MAX. Templates are
 *                 borrowed, too
 * @retval GZ_ERR_INVAL        no objects, or an id or style out of range
 * @retval GZ_ERR_UNSUPPORTED  a volume of bricks, or an object without a volume; logged
 * @retval GZ_ERR_NO_MEM       out of memory
 */
enum gz_result gz_illustrate_scene_show(struct gz_illustrate_scene *scene,
					const struct gz_object *objects, size_t count);

/** The object from which a shot wants distances; 0: it wants none. @param shot  its look is valid
 */
uint32_t gz_illustrate_shot_measured(const struct gz_illustrate_shot *shot);

/**
 * Check a shot, and make what is missing for it. A chosen object that is not shown leaves all
 * distances infinite.
 *
 * @param workers  share the work; the same bits for any number
 * @retval GZ_ERR_INVAL        nothing is shown, the settings are not valid, or the plan is empty
 * @retval GZ_ERR_FULL         a surface has too many triangles; logged
 * @retval GZ_ERR_UNSUPPORTED  distances need Embree, which is not in this build; logged
 * @retval GZ_ERR_NO_MEM       out of memory
 * @return otherwise what making surfaces returns; logged
 */
enum gz_result gz_illustrate_scene_prepare(struct gz_illustrate_scene *scene,
					   const struct gz_illustrate_shot *shot,
					   struct gz_workers *workers);

/** Bytes of gz_illustrate_kept_name() with its NUL. */
#define GZ_ILLUSTRATE_KEPT_SIZE 80
/** Bytes of what it says was made, with its NUL. */
#define GZ_ILLUSTRATE_WHAT_SIZE 24

/** How the name of a file ends that keeps what was made of an object: by the object's own name,
 *  which other scenes of the same input give it too, not by its place in this one.
 *  @param what  the ending's last part, less than GZ_ILLUSTRATE_WHAT_SIZE bytes */
void gz_illustrate_kept_name(const struct gz_object *object, const char *what,
			     char out_ending[GZ_ILLUSTRATE_KEPT_SIZE]);

/** Free all but the log. Waits for a thread that makes marks. */
void gz_illustrate_scene_free(struct gz_illustrate_scene *scene);

#endif
