/**
 * @file
 * Scenes: an INI file that says what is shown and how. Whatever a panel can set has a key here.
 */
#ifndef GZ_RENDER_SCENE_SCENE_H
#define GZ_RENDER_SCENE_SCENE_H

#include <stdbool.h>

#include "base/log.h"
#include "base/option.h"
#include "base/result.h"
#include "protocol/display.h"
#include "protocol/gaze.h"
#include "render/accumulate/temporal.h"
#include "render/attention/attention.h"
#include "render/data/volume.h"
#include "render/picture/camera.h"
#include "render/plan/plan.h"
#include "render/raycast/shared/raycaster.h"
#include "render/scene/scene_objects.h"
#include "render/scene/view_settings.h"
#include "render/technique/technique.h"
#include "render/transfer/transfer.h"

/** The settings of a scene, as its table reads them. */
struct gz_scene_settings {
	char volume_file[GZ_PATH_SIZE]; /**< empty for a procedural volume */
	int volume_procedural;          /**< enum gz_procedural + 1; 0 = none */
	int dims[3];                    /**< raw and procedural */
	int type;                       /**< enum gz_raw_type; of a procedural volume, too */
	int endian;                     /**< 0 little, 1 big */
	double spacing[3];
	int memory_mib;                   /**< for bricks; 0 = a quarter of the machine's memory */
	char transfer_file[GZ_PATH_SIZE]; /**< empty: one is made for the volume */
	char transfer_also[GZ_PATH_SIZE]; /**< names of further ones, parted by blanks: for studies
					     of several; a scene is shown with transfer_file */
	struct gz_scene_objects objects;  /**< beside the volume, or instead of it */
	struct gz_camera camera;
	struct gz_ray_params rays;
	double image_sampling_rate; /**< rays per pixel edge, may exceed 1 */
	struct gz_foveation foveation;
	struct gz_attention_params attention;
	struct gz_temporal_params temporal;
	struct gz_view_settings view;
	struct gz_display display;
};

/** A scene, loaded. */
struct gz_scene {
	struct gz_scene_settings settings;
	bool has_display; /**< the scene says what the display is */
	struct gz_volume volume;
	struct gz_transfer transfer;
};

/** The tables of a scene's keys, in the order of its file. Each object has a table of its own
 *  beside these (gz_scene_object_bind()). */
enum gz_scene_table {
	GZ_SCENE_VOLUME,
	GZ_SCENE_TRANSFER,
	GZ_SCENE_CAMERA,
	GZ_SCENE_IMAGE,
	GZ_SCENE_DISPLAY,
	GZ_SCENE_RAYS,
	GZ_SCENE_LIGHT,
	GZ_SCENE_CLIP,
	GZ_SCENE_FOVEATION,
	GZ_SCENE_ATTENTION,
	GZ_SCENE_TEMPORAL,
	GZ_SCENE_VIEW,
	GZ_SCENE_TABLE_COUNT,
};

/**
 * Bind every table to @p settings: "volume.file", "camera.eye", …
 *
 * @param settings           what the bindings set; must outlive them
 * @param[out] out_bindings  by enum gz_scene_table; no flags of what was given
 */
void gz_scene_bind(struct gz_scene_settings *settings,
		   struct gz_option_binding out_bindings[GZ_SCENE_TABLE_COUNT]);

/** Every key's preset, and neither a volume nor a transfer function. @return GZ_OK, since tests
 *  assert that presets parse */
enum gz_result gz_scene_settings_preset(struct gz_scene_settings *out_settings);

/** Whether every option has equal values, and the tables of spacings are the same. */
bool gz_scene_settings_same(const struct gz_scene_settings *a, const struct gz_scene_settings *b);

/** The enum gz_raw_type that a procedural volume has where volume.type is not given.
 *  @param volume_procedural  enum gz_procedural + 1 */
int gz_scene_procedural_type(int volume_procedural);

/**
 * Check what the tables cannot say of each value by itself: that the camera looks somewhere, the
 * clip box holds something and the light has a direction. What volume and display need is not
 * asked. An up vector that says nothing is told in a warning: gz_camera_rays() replaces it.
 *
 * @param name  stands for where they come from in messages
 * @param log   may be NULL
 * @retval GZ_ERR_FORMAT  refused; logged with the key and the remedy
 */
enum gz_result gz_scene_settings_check(const struct gz_scene_settings *settings, const char *name,
				       const struct gz_log *log);

/**
 * Read the settings of a scene from text, without its files.
 *
 * @param name  stands for the file in messages
 * @param[out] out_settings     every setting, given or preset
 * @param[out] out_has_display  the text says what the display is
 * @retval GZ_ERR_FORMAT  refused; logged with file, line or key, and remedy
 */
enum gz_result gz_scene_parse(const char *name, const char *text, size_t size,
			      const struct gz_log *log, struct gz_scene_settings *out_settings,
			      bool *out_has_display);

/**
 * Read a scene with its volume and transfer function. Relative paths are looked up beside the
 * scene, then under $GAZECAST_DATA.
 *
 * @param loading  of the volume: see gz_volume_load(); NULL for nobody to tell, and in memory
 * @param[out] out_scene  filled; the caller frees it with gz_scene_free()
 * @retval GZ_ERR_NOT_FOUND, GZ_ERR_FORMAT, GZ_ERR_IO, GZ_ERR_UNSUPPORTED, GZ_ERR_NO_MEM  logged,
 * one line with the remedy
 * @retval GZ_ERR_CANCELLED  @p loading said so; not logged
 */
enum gz_result gz_scene_load(const char *path, const struct gz_loading *loading,
			     const struct gz_log *log, struct gz_scene *out_scene);

/** Changes settings that a scene's text has given. What it returns but GZ_OK, it has logged. */
typedef enum gz_result gz_scene_change(void *user, struct gz_scene_settings *settings);

/**
 * As gz_scene_load(), with settings that take the place of the scene's own.
 *
 * @param change  called once, before the settings are checked and before any file that they name
 *                is read; volume, transfer and display stay as the scene has them. NULL: nothing
 * @param user    handed to @p change
 * @return also what @p change returned
 */
enum gz_result gz_scene_load_changed(const char *path, gz_scene_change *change, void *user,
				     const struct gz_loading *loading, const struct gz_log *log,
				     struct gz_scene *out_scene);

/** A scene whose settings are known already. */
struct gz_scene_parts {
	const char *name; /**< path beside which files are looked up first */
	const struct gz_scene_settings *settings;
	bool has_display;
	const struct gz_transfer *transfer; /**< in place of the one that the settings name; NULL:
					       that one */
	bool volume_alone; /**< none is made where none is named: whoever loads only wants voxels */
};

/** Load what settings name, as gz_scene_load() does for those of a file. @return as that */
enum gz_result gz_scene_load_parts(const struct gz_scene_parts *parts,
				   const struct gz_loading *loading, const struct gz_log *log,
				   struct gz_scene *out_scene);

/** The transfer function of a volume that comes without one: GZ_PRESET_DEFAULT, by its histogram.
 *  @return what gz_histogram_count() returns; logged */
enum gz_result gz_transfer_of_volume(const struct gz_volume *volume, const struct gz_log *log,
				     struct gz_transfer *out_transfer);

/**
 * Whether gz_scene_load_changed() would find all that a scene needs: everything is read and checked
 * but the volume, which must only be there.
 *
 * @param[out] out_settings  as changed, with the table of spacings
 * @return what gz_scene_load_changed() returns; logged
 */
enum gz_result gz_scene_try(const char *path, gz_scene_change *change, void *user,
			    const struct gz_log *log, struct gz_scene_settings *out_settings);

/**
 * Read the table of spacings that foveation.table names into @p foveation; gz_scene_load() does it
 * for the scene's own settings, this is for those that something else has changed.
 *
 * @param scene  path of the scene beside which the table is looked up first
 * @retval GZ_OK             read, or none is named and the method needs none
 * @retval GZ_ERR_FORMAT     the method is table and none is named, or the table is refused; logged
 * @retval GZ_ERR_NOT_FOUND, GZ_ERR_IO, GZ_ERR_NO_MEM  logged, one line with the remedy
 */
enum gz_result gz_scene_load_table(const char *scene, const struct gz_log *log,
				   struct gz_foveation *foveation);

/**
 * Read one of the transfer functions that transfer.also names.
 *
 * @param scene  path of the scene beside which the file is looked up first
 * @param file   its name there
 * @retval GZ_ERR_NOT_FOUND, GZ_ERR_IO, GZ_ERR_FORMAT  logged, one line with the remedy
 */
enum gz_result gz_scene_load_transfer(const char *scene, const char *file, const struct gz_log *log,
				      struct gz_transfer *out_transfer);

/**
 * List the things that a scene shows, for gz_picture_maker_show().
 *
 * @param scene  loaded; the list borrows from it
 * @param[out] out_objects  the first @p room of them; their revisions are 0
 * @return how many there are
 */
size_t gz_scene_list_objects(const struct gz_scene *scene, struct gz_object *out_objects,
			     size_t room);

/** Free what it holds and zero it. */
void gz_scene_free(struct gz_scene *scene);

#endif
