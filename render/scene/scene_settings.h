/**
 * @file
 * The settings of a scene and the scene file: an INI file that says what is shown and how.
 * Everything that a panel can set has a key here (docs/scenes.md).
 */
#ifndef GZ_RENDER_SCENE_SCENE_SETTINGS_H
#define GZ_RENDER_SCENE_SCENE_SETTINGS_H

#include <stdbool.h>
#include <stddef.h>

#include "base/log.h"
#include "base/option.h"
#include "base/result.h"
#include "protocol/display.h"
#include "protocol/gaze.h"
#include "render/accumulate/temporal.h"
#include "render/attention/attention.h"
#include "render/data/volume.h"
#include "render/mesh/label_surfaces.h"
#include "render/particles/particle_grid.h"
#include "render/picture/camera.h"
#include "render/plan/foveation.h"
#include "render/raycast/shared/ray_params.h"
#include "render/scene/scene_objects.h"
#include "render/scene/scene_regions.h"
#include "render/scene/view_settings.h"
#include "render/technique/technique.h"

/** Size of a DICOM UID with its NUL (PS3.5, 9.1), bytes. */
#define GZ_SERIES_SIZE 65

/** Size of the sentence that says where a file is to be had, with its NUL, bytes. Chosen: no line
 * of a scene is longer. */
#define GZ_SCENE_SOURCE_SIZE 200

/** All settings of a scene. */
struct gz_scene_settings {
	char volume_file[GZ_PATH_SIZE]; /**< empty for a procedural volume, or if an object has it
					 */
	char volume_source[GZ_SCENE_SOURCE_SIZE]; /**< where the file is to be had */
	char volume_series[GZ_SERIES_SIZE];       /**< UID of a DICOM series; empty: the only one */
	int volume_procedural;                    /**< enum gz_procedural + 1; 0 = none */
	int dims[3];       /**< raw files and procedural volumes; 0 = not given */
	int type;          /**< enum gz_raw_type; raw files and procedural volumes */
	int endian;        /**< raw files: 0 little, 1 big */
	double spacing[3]; /**< mm; raw files and procedural volumes; 0: not known */
	int channels;      /**< numbers of a voxel; raw files */
	int opacity;       /**< enum gz_opacity_source */
	int resample;      /**< enum gz_resampling; DICOM */
	int time_point;    /**< of a series, from 1 */
	int memory_mib;    /**< for bricks; 0 = a quarter of the machine's memory */
	struct gz_particle_grid particles; /**< how a file of particles becomes a volume */
	/** Of a series of files that has been loaded. No key: found with the first time point. */
	struct gz_particle_frame particle_frame;
	struct gz_label_look labels;      /**< how labels become surfaces */
	char transfer_file[GZ_PATH_SIZE]; /**< empty: the object's, or one made for the volume */
	int transfer_preset;              /**< enum gz_transfer_preset + 1 of the one that is made;
					     0: gz_transfer_preset_for() */
	char transfer_also[GZ_PATH_SIZE]; /**< further ones for studies, separated by blanks */
	struct gz_scene_objects objects;  /**< sections [object NAME] */
	struct gz_scene_regions regions;  /**< sections [region NUMBER] */
	struct gz_camera camera;
	struct gz_ray_params rays;
	int technique;              /**< of all objects: index into gz_techniques + 1; 0: each
				       object's own */
	double image_sampling_rate; /**< rays per pixel edge, may exceed 1 */
	struct gz_foveation foveation;
	struct gz_attention_params attention;
	struct gz_temporal_params temporal;
	struct gz_view_settings view;
	struct gz_display display; /**< valid only if the scene has a display */
};

/** The option tables of a scene, in the order of its file. Each object and each region has a table
 *  of its own in addition (gz_scene_object_bind(), gz_scene_region_bind()). */
enum gz_scene_table {
	GZ_SCENE_VOLUME,
	GZ_SCENE_PARTICLES,
	GZ_SCENE_LABELS,
	GZ_SCENE_TRANSFER,
	GZ_SCENE_CAMERA,
	GZ_SCENE_IMAGE,
	GZ_SCENE_DISPLAY,
	GZ_SCENE_RAYS,
	GZ_SCENE_LIGHT,
	GZ_SCENE_CLIP,
	GZ_SCENE_ENVIRONMENT,
	GZ_SCENE_ISOSURFACE,
	GZ_SCENE_SLICES,
	GZ_SCENE_ILLUSTRATION,
	GZ_SCENE_ILLUSTRATION_COMBINED,
	GZ_SCENE_SHADING_MAP,
	GZ_SCENE_FOVEATION,
	GZ_SCENE_ATTENTION,
	GZ_SCENE_TEMPORAL,
	GZ_SCENE_VIEW,
	GZ_SCENE_TABLE_COUNT,
};

/**
 * Bind every table to @p settings: "volume.file", "camera.eye", …
 *
 * @param settings           borrowed; must outlive the bindings
 * @param[out] out_bindings  indexed by enum gz_scene_table; without flags of given keys
 */
void gz_scene_bind(struct gz_scene_settings *settings,
		   struct gz_option_binding out_bindings[GZ_SCENE_TABLE_COUNT]);

/** Set every key to its preset; no volume, no transfer function, no objects. @return GZ_OK; tests
 *  check that every preset parses */
enum gz_result gz_scene_settings_preset(struct gz_scene_settings *out_settings);

/** Whether all options have equal values, and the objects, regions and tables of spacings are the
 *  same. */
bool gz_scene_settings_same(const struct gz_scene_settings *a, const struct gz_scene_settings *b);

/**
 * Take over how other settings show objects and regions: visible, importance, transparency,
 * template.
 *
 * @param[in,out] settings  with the same objects
 * @return whether anything has changed
 */
bool gz_scene_show_as(const struct gz_scene_settings *wanted, struct gz_scene_settings *settings);

/** Whether the same templates are named for the whole scene, for each object and each region. */
bool gz_scene_templates_same(const struct gz_scene_settings *a, const struct gz_scene_settings *b);

/** The enum gz_raw_type of a procedural volume for which volume.type is not given.
 *  @param volume_procedural  enum gz_procedural + 1 */
int gz_scene_procedural_type(int volume_procedural);

/**
 * The type of the voxels of a procedural volume.
 *
 * @param settings  with volume_procedural above 0
 * @return false if volume.type is not one that procedural volumes can have
 */
bool gz_scene_made_type(const struct gz_scene_settings *settings, enum gz_voxel_type *out_type);

/** Whether an object shows the volume, or the one made of particles. */
bool gz_scene_shows_volume(const struct gz_scene_object *object);

/** The first object whose volume or particles the scene shows; others show the same data by other
 * techniques. NULL if section [volume] names them. Borrowed. */
const struct gz_scene_object *gz_scene_volume_object(const struct gz_scene_settings *settings);

/** The object that names the transfer function; NULL: none does. Borrowed. */
const struct gz_scene_object *gz_scene_transfer_object(const struct gz_scene_settings *settings);

/** The technique that draws an object: render.technique, or the object's own. @param object  NULL:
 *  the volume of section [volume]. Static. */
const struct gz_technique *gz_scene_technique(const struct gz_scene_settings *settings,
					      const struct gz_scene_object *object);

/** Whether the scene has a volume; otherwise it shows meshes alone. */
bool gz_scene_has_volume(const struct gz_scene_settings *settings);

/** The technique that draws the volume (of several objects, the first), or the first object of a
 * scene without one. Static. */
const struct gz_technique *gz_scene_main_technique(const struct gz_scene_settings *settings);

/** Whether a technique draws anything of the scene. */
bool gz_scene_draws_by(const struct gz_scene_settings *settings,
		       const struct gz_technique *technique);

/** The file of the transfer function that is used: transfer.file if given, else that of
 * gz_scene_transfer_object(). "" = one is made for the volume. Borrowed. */
const char *gz_scene_transfer_name(const struct gz_scene_settings *settings);

/**
 * Check what single values cannot show: that the camera looks somewhere, the clip box is not empty,
 * the clip plane and the light have a direction and stored views are valid. Does not check volume
 * and display. Warns if the camera's up vector has no effect; gz_camera_rays() then replaces it.
 *
 * @param name  the settings' source in messages
 * @param log   may be NULL
 * @retval GZ_ERR_FORMAT  refused; logged with the key and the remedy
 */
enum gz_result gz_scene_settings_check(const struct gz_scene_settings *settings, const char *name,
				       const struct gz_log *log);

/**
 * Read the settings of a scene from text. Does not open the files that it names.
 *
 * @param name  the file's name in messages
 * @param[out] out_settings     every setting, given or preset
 * @param[out] out_has_display  whether the text describes the display
 * @retval GZ_ERR_FORMAT  refused; logged with file, line or key, and remedy
 * @retval GZ_ERR_NO_MEM  out of memory
 */
enum gz_result gz_scene_parse(const char *name, const char *text, size_t size,
			      const struct gz_log *log, struct gz_scene_settings *out_settings,
			      bool *out_has_display);

/** Changes the settings that a scene file gives. Logs any failure that it returns. */
typedef enum gz_result gz_scene_change(void *user, struct gz_scene_settings *settings);

/** A scene file to read. All pointers are borrowed until the call returns. */
struct gz_scene_source {
	const char *path;
	gz_scene_change *change; /**< called once, before the changed settings are checked and
				    before any file that they name is read. It must leave volume and
				    display as they are. NULL: none */
	void *user;              /**< passed to change */
};

/**
 * Read the settings of a scene file, and change them. Does not open the files that it names.
 *
 * @param[out] out_settings     every setting, given or preset, as changed
 * @param[out] out_has_display  whether the file describes the display
 * @retval GZ_ERR_NOT_FOUND, GZ_ERR_IO, GZ_ERR_FORMAT, GZ_ERR_NO_MEM  logged
 * @return also what source->change returned
 */
enum gz_result gz_scene_read(const struct gz_scene_source *source, const struct gz_log *log,
			     struct gz_scene_settings *out_settings, bool *out_has_display);

#endif
