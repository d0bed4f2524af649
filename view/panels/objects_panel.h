/**
 * @file
 * The panel that lists the objects of a scene, and the regions of labels, with what each is shown
 * by: visible, importance, transparency, template. Inside a frame of panels/widgets.h.
 */
#ifndef GZ_VIEW_PANELS_OBJECTS_PANEL_H
#define GZ_VIEW_PANELS_OBJECTS_PANEL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "render/scene/scene.h"

/** Size of the text of a row with its NUL, bytes. */
enum { GZ_OBJECT_ROW_SIZE = GZ_LABEL_NAME_SIZE + 80 };

/** A row: an object, or a region of one. */
struct gz_object_row {
	int object; /**< index among the settings' objects; -1: the volume of section [volume] */
	int label;  /**< index among the labels of the object; -1: the object itself */
};

/** The panel. Zero-initialised lists nothing. */
struct gz_objects_panel {
	bool open;
	struct gz_object_row *rows; /**< of the scene; owned. NULL: not listed */
	size_t count;
	size_t selected;    /**< index of a row; count: none */
	bool reveal;        /**< the selected row is scrolled to */
	uint32_t looked_at; /**< number of the object under the gaze, which is marked; 0: none */
	float margin_top, margin_bottom;
};

/** List the rows of a scene, if that has not been done. Without memory there are none. */
void gz_objects_panel_list(struct gz_objects_panel *panel, const struct gz_scene *scene);

/** Forget the rows: another scene, or other labels. */
void gz_objects_panel_forget(struct gz_objects_panel *panel);

/** Print a row: "hippocampus", "37 Hippocampus_L". */
void gz_objects_panel_print(const struct gz_scene *scene, const struct gz_object_row *row,
			    char out_text[GZ_OBJECT_ROW_SIZE]);

/** Index of the row with a number of gz_scene_list_objects(); panel->count: there is none. */
size_t gz_objects_panel_find(const struct gz_objects_panel *panel, const struct gz_scene *scene,
			     uint32_t id);

/** What a draw of the panel did. */
enum gz_objects_outcome {
	GZ_OBJECTS_SAME,
	GZ_OBJECTS_CHANGED,
	GZ_OBJECTS_FULL, /**< no more regions can have a way of their own */
};

/**
 * Draw the panel at the left of the window.
 *
 * @param scene  shown; the panel lists it
 * @param[in,out] settings  of the scene, as the user has changed them
 */
enum gz_objects_outcome gz_objects_panel_draw(struct gz_objects_panel *panel,
					      const struct gz_scene *scene,
					      struct gz_scene_settings *settings);

#endif
