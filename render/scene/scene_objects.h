/**
 * @file
 * The objects of a scene: sections [object NAME]. A scene with a section [volume] and no objects
 * shows that volume alone.
 */
#ifndef GZ_RENDER_SCENE_SCENE_OBJECTS_H
#define GZ_RENDER_SCENE_SCENE_OBJECTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/option.h"
#include "base/result.h"
#include "base/sizes.h"
#include "render/illustration/shading_template.h"
#include "render/technique/technique.h"

/** Most objects of a scene. */
#define GZ_SCENE_OBJECTS_MAX 32

/** Bytes of a section's name with its NUL (base/ini.h). */
#define GZ_SCENE_SECTION_SIZE 50

/** Bytes of a file name in an object with its NUL: a scene's line holds fewer (base/ini.h). */
#define GZ_SCENE_FILE_SIZE 256

/** One object. Names of files are empty if they are not given. */
struct gz_scene_object {
	char section[GZ_SCENE_SECTION_SIZE]; /**< "object NAME" */
	int technique;                       /**< index into gz_techniques */
	char volume[GZ_SCENE_FILE_SIZE];
	char transfer[GZ_SCENE_FILE_SIZE]; /**< of the volume; empty: gz_scene_transfer_name() */
	char labels[GZ_SCENE_FILE_SIZE];
	char mesh[GZ_SCENE_FILE_SIZE];
	char particles[GZ_SCENE_FILE_SIZE];
	bool visible;
	char regions[GZ_SCENE_FILE_SIZE]; /**< of labels: which are shown; empty: all */
	struct gz_object_style style;
	char template_name[GZ_SCENE_FILE_SIZE]; /**< of illustrations: gz_shading_template_named(),
						   or a file; empty: none */
	struct gz_shading_template shading_template; /**< what it names, once it is found */
};

/** All objects of a scene. Zero-initialised has none. */
struct gz_scene_objects {
	size_t count;
	struct gz_scene_object items[GZ_SCENE_OBJECTS_MAX];
};

/** Options of an object, and how many of them, the last ones, can change while it is shown. */
#define GZ_SCENE_OBJECT_OPTIONS       13
#define GZ_SCENE_OBJECT_SHOWN_OPTIONS 6

/** Table over struct gz_scene_object. Its keys are "object.<name>"; those of one object are
 *  "object NAME.<name>". */
extern const struct gz_option gz_scene_object_options[GZ_SCENE_OBJECT_OPTIONS];

/** The table of one object, under its own keys. */
struct gz_scene_object_table {
	struct gz_option options[GZ_SCENE_OBJECT_OPTIONS];
	char keys[GZ_SCENE_OBJECT_OPTIONS][GZ_SCENE_SECTION_SIZE + 16];
};

/** Fill @p table with the options of an object, under the object's own keys. The binding borrows
 *  both. */
struct gz_option_binding gz_scene_object_bind(struct gz_scene_object *object,
					      struct gz_scene_object_table *table);

/** gz_scene_object_bind() for the options that can change while the object is shown: visible,
 *  importance, transparency, drawing, hatch_direction, template. */
struct gz_option_binding gz_scene_object_bind_shown(struct gz_scene_object *object,
						    struct gz_scene_object_table *table);

/** The object's name: its section without the word "object". Borrowed from @p object. */
const char *gz_scene_object_name(const struct gz_scene_object *object);

/** Index of the object with this section; -1 if there is none. */
int gz_scene_objects_find(const struct gz_scene_objects *objects, const char *section);

/**
 * Find the sections [object NAME] of a scene's text. Each becomes an object with presets.
 *
 * @param name  the text's name in messages; if @p text is NULL, the file to read
 * @param text  @p size bytes, or NULL
 * @param[out] out_objects  in their order
 * @retval GZ_ERR_FORMAT  more than GZ_SCENE_OBJECTS_MAX, or a section without a name; logged
 * @return otherwise what gz_ini_read_text() or gz_ini_read_file() returns; logged
 */
enum gz_result gz_scene_objects_scan(const char *name, const char *text, size_t size,
				     const struct gz_log *log,
				     struct gz_scene_objects *out_objects);

/**
 * Check that each object has exactly one kind of data, and that its technique shows that kind.
 *
 * @param name  the objects' source in messages
 * @retval GZ_ERR_FORMAT  refused; logged with the key and the remedy
 */
enum gz_result gz_scene_objects_check(const struct gz_scene_objects *objects, const char *name,
				      const struct gz_log *log);

/**
 * Make the only object of a scene: a mesh, by the technique that shows meshes.
 *
 * @param file  the mesh's path
 * @retval GZ_ERR_FULL  the path is too long; not logged
 */
enum gz_result gz_scene_objects_of_mesh(const char *file, struct gz_scene_objects *out_objects);

/**
 * Whether a label of an object is shown: what its regions say. They are names or numbers of labels,
 * separated by blanks, in which * stands for any text and ? for any character. One after a minus
 * takes labels away again. Of regions that all begin with a minus, the others are shown.
 *
 * @param name  of the label; "": it has none
 */
bool gz_scene_object_has_region(const struct gz_scene_object *object, int32_t number,
				const char *name);

/** The kinds of data that an object is given, as bits of enum gz_object_data. */
unsigned gz_scene_object_kinds(const struct gz_scene_object *object);

/** Whether both have the same sections with equal values. */
bool gz_scene_objects_same(const struct gz_scene_objects *a, const struct gz_scene_objects *b);

#endif
