/**
 * @file
 * Scenes: settings with the volume and the transfer function that they name.
 */
#ifndef GZ_RENDER_SCENE_SCENE_H
#define GZ_RENDER_SCENE_SCENE_H

#include <stdbool.h>

#include "base/log.h"
#include "base/result.h"
#include "render/data/volume.h"
#include "render/mesh/label_surfaces.h"
#include "render/mesh/mesh.h"
#include "render/scene/scene_settings.h"
#include "render/technique/technique.h"
#include "render/transfer/transfer.h"

/** A scene, loaded. gz_scene_free() frees it. */
struct gz_scene {
	struct gz_scene_settings settings;
	bool has_display; /**< the scene describes the display */
	struct gz_volume volume;
	struct gz_transfer transfer;
	/** Of each of the settings' objects; empty for those of other kinds. NULL: no object has a
	 *  mesh. Of a scene of meshes and labels alone, the volume is empty space: their box. */
	struct gz_mesh *meshes;
	/** Likewise the surfaces of labels. NULL: no object has labels. */
	struct gz_label_surfaces *labels;
	/** Of each of the settings' objects with a mesh or labels: the file; owned. NULL: none has.
	 */
	char (*inputs)[GZ_PATH_SIZE];
	/** What became the origin of all meshes and labels of a scene without a volume, mm. */
	double centre[3];
};

/** Most objects that gz_scene_list_objects() lists: the volume, those of the settings and labels.
 */
#define GZ_SCENE_LISTED_MAX (1 + GZ_SCENE_OBJECTS_MAX + GZ_LABELS_MAX)

/**
 * Read a scene with its volume and transfer function. Relative paths are searched beside the scene,
 * then under $GAZECAST_DATA. Blocks until the volume is loaded.
 *
 * @param loading  of the volume, as for gz_volume_load(); NULL: in memory, without progress
 * @param[out] out_scene  owned by the caller; written on success only
 * @retval GZ_ERR_NOT_FOUND, GZ_ERR_FORMAT, GZ_ERR_IO, GZ_ERR_UNSUPPORTED, GZ_ERR_NO_MEM
 *                           logged, one line with the remedy
 * @retval GZ_ERR_CANCELLED  @p loading cancelled it; not logged
 */
enum gz_result gz_scene_load(const char *path, const struct gz_loading *loading,
			     const struct gz_log *log, struct gz_scene *out_scene);

/** gz_scene_load() with changed settings. @return also what source->change returned */
enum gz_result gz_scene_load_changed(const struct gz_scene_source *source,
				     const struct gz_loading *loading, const struct gz_log *log,
				     struct gz_scene *out_scene);

/** A scene whose settings are known. All pointers are borrowed until the call returns. */
struct gz_scene_parts {
	const char *name; /**< path beside which files are searched first; also used in messages */
	const struct gz_scene_settings *settings;
	bool has_display;
	const struct gz_transfer *transfer; /**< instead of the one that the settings name; NULL:
					       that one */
	bool volume_alone;                  /**< do not make a transfer function if none is named */
};

/** Load what settings name, like gz_scene_load(), with the same results. */
enum gz_result gz_scene_load_parts(const struct gz_scene_parts *parts,
				   const struct gz_loading *loading, const struct gz_log *log,
				   struct gz_scene *out_scene);

/** Which time point of a scene's series to load. All pointers are borrowed until the call returns.
 */
struct gz_scene_time_point {
	const char *name; /**< path beside which the scene's files are searched first */
	const struct gz_scene_settings
		*settings;          /**< of the scene; their own time point is ignored */
	int time_point;             /**< from 0 */
	const double *number_range; /**< of a time point that was loaded before */
};

/**
 * Load another time point of the volume of a scene. It has the value range of the whole series.
 *
 * @return what gz_volume_load() returns; logged
 *
 * Threads: any.
 */
enum gz_result gz_scene_load_time_point(const struct gz_scene_time_point *which,
					const struct gz_loading *loading, const struct gz_log *log,
					struct gz_volume *out_volume);

/**
 * Make the transfer function of a volume that comes without one, by its histogram.
 *
 * @param choice  index into gz_transfer_preset_choices: 0 is gz_transfer_preset_for()
 * @return what gz_histogram_count() returns; logged
 */
enum gz_result gz_transfer_of_volume(const struct gz_volume *volume, int choice,
				     const struct gz_log *log, struct gz_transfer *out_transfer);

/**
 * Check whether gz_scene_load_changed() would succeed, without loading the volume: the volume's
 * file must exist, and everything else is read and checked.
 *
 * @param[out] out_settings  as changed, with the table of spacings
 * @return what gz_scene_load_changed() returns; logged
 */
enum gz_result gz_scene_try(const struct gz_scene_source *source, const struct gz_log *log,
			    struct gz_scene_settings *out_settings);

/**
 * Read the table of spacings that foveation.table names into @p foveation. gz_scene_load() does
 * this for a scene's own settings; call it for settings that something else has changed.
 *
 * @param scene  path of the scene beside which the table is searched first
 * @retval GZ_OK             read, or none is named and the method needs none
 * @retval GZ_ERR_FORMAT     the method needs a table and none is named, or the table is refused;
 *                           logged
 * @retval GZ_ERR_NOT_FOUND, GZ_ERR_IO, GZ_ERR_NO_MEM  logged, one line with the remedy
 */
enum gz_result gz_scene_load_table(const char *scene, const struct gz_log *log,
				   struct gz_foveation *foveation);

/**
 * Find the folder that environment.cube names, and check its pictures without reading their pixels.
 * gz_scene_load() does this for a scene's own settings; call it for settings that something else
 * has changed.
 *
 * @param scene  path of the scene beside which the folder is searched first
 * @param[in,out] environment  its cube_path is written; "" if none is named
 * @retval GZ_OK             found, or none is named and the surroundings are others
 * @retval GZ_ERR_FORMAT     environment.kind is cube and no folder is named, or a picture is
 *                           refused; logged
 * @retval GZ_ERR_NOT_FOUND  no such folder, or a picture is missing; logged
 */
enum gz_result gz_scene_find_cube(const char *scene, const struct gz_log *log,
				  struct gz_environment *environment);

/**
 * Find the template of each object and that of the whole scene: gz_shading_template_named(), or a
 * file. gz_scene_load() does this for a scene's own settings; call it for settings that something
 * else has changed.
 *
 * @param scene  path of the scene beside which the files are searched first
 * @param[in,out] settings  their templates are written
 * @retval GZ_ERR_NOT_FOUND  no such template; logged with the names of those that there are
 * @return otherwise the failures of gz_shading_template_read(); logged
 */
enum gz_result gz_scene_find_templates(const char *scene, const struct gz_log *log,
				       struct gz_scene_settings *settings);

/**
 * Read one of the transfer functions that transfer.also names.
 *
 * @param scene  path of the scene beside which the file is searched first
 * @param file   its name in the scene
 * @retval GZ_ERR_NOT_FOUND, GZ_ERR_IO, GZ_ERR_FORMAT  logged, one line with the remedy
 */
enum gz_result gz_scene_load_transfer(const char *scene, const char *file, const struct gz_log *log,
				      struct gz_transfer *out_transfer);

/**
 * List the visible objects of a scene for gz_picture_maker_show(): the volume, number 1; the
 * meshes, whose numbers are 2 and their place among the settings' objects; and each label as an
 * object of its own, with its colour: gz_scene_label_id().
 *
 * @param scene  loaded; the list borrows from it
 * @param[out] out_objects  the first @p room of them; their revisions are 0
 * @return how many there are, at most GZ_SCENE_LISTED_MAX
 */
size_t gz_scene_list_objects(const struct gz_scene *scene, struct gz_object *out_objects,
			     size_t room);

/** The number of an object that is a label: 256 times 1 + its place among the labels of its object,
 *  plus 2 and the place of that object among the settings'. So the lowest byte tells the object. */
uint32_t gz_scene_label_id(size_t object, size_t label);

/** Which labels gz_scene_make_labels() makes. All pointers are borrowed. */
struct gz_scene_label_request {
	const char *name; /**< path beside which the scene's files are searched first */
	const struct gz_scene_settings *settings; /**< of the scene, with the labels' look */
	const double *centre;                     /**< of the scene, three numbers */
};

/**
 * Make the surfaces of a loaded scene's labels again, with another look. The scene stays as it is,
 * so that this can run beside threads that use it.
 *
 * @param[out] out_labels  in place of the scene's labels; written on GZ_OK; the caller frees them
 *                         with gz_scene_free_labels(). NULL: the scene has no labels
 * @return what gz_scene_load() returns; logged
 */
enum gz_result gz_scene_make_labels(const struct gz_scene_label_request *request,
				    const struct gz_log *log,
				    struct gz_label_surfaces **out_labels);

/** Free the surfaces of the labels of each of a scene's objects. Accepts NULL. */
void gz_scene_free_labels(const struct gz_scene *scene, struct gz_label_surfaces *labels);

/** The label with a number of gz_scene_label_id(); NULL: the object is none. Borrowed. */
const struct gz_label_surface *gz_scene_label_of(const struct gz_scene *scene, uint32_t id);

/** Free what the scene holds and zero it. */
void gz_scene_free(struct gz_scene *scene);

#endif
