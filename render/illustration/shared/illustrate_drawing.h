/**
 * @file
 * A picture that is drawn by marks: those of all layers of surfaces, and lines over them.
 *
 * Each layer is drawn by marks of its own objects. Marks of different layers cover each other by
 * chance, so a layer is drawn with the tone M / N, where N is the brightness of the layers before
 * it, and M the brightness with it. What of a layer is grey darkens the paper by that tone.
 */
#ifndef GZ_RENDER_ILLUSTRATION_SHARED_ILLUSTRATE_DRAWING_H
#define GZ_RENDER_ILLUSTRATION_SHARED_ILLUSTRATE_DRAWING_H

#include <stdbool.h>
#include <stddef.h>

#include "base/log.h"
#include "base/result.h"
#include "base/workers.h"
#include "render/illustration/hatch_lines.h"
#include "render/illustration/illustration_look.h"
#include "render/illustration/mark_balance.h"
#include "render/illustration/shared/illustrate_scene.h"
#include "render/illustration/stipple_points.h"
#include "render/picture/image.h"
#include "render/picture/plane.h"
#include "render/technique/technique.h"

/** The marks of a picture. Zero-initialised is empty; keep it from picture to picture. */
struct gz_illustrate_drawing {
	bool drawn; /**< marks draw at least one object; otherwise nothing is done here */
	bool mixed; /**< and at least one is grey */
	int width, height;
	double pen_px;                 /**< width of the pen at the gaze, pixels of this picture */
	struct gz_ray_frame rays;      /**< of the picture's pixels, mm */
	struct gz_stipple_scale scale; /**< without factors: 1 everywhere */
	struct gz_stipple_discs discs;
	struct gz_hatch_lines lines;
	struct gz_mark_balance balance; /**< of the lines of a layer */
	struct gz_stipple_sheet sheet;
	struct gz_plane tone; /**< of a layer of several */
	float *before;        /**< brightness of the layers before it */
	float *outlines;      /**< brightness that the lines of all layers leave */
	float *layer_lines;   /**< those of a layer: struct gz_shading_frame.lines_apart */
	float *paper;         /**< what grey objects leave of the paper's brightness */
	size_t room;          /**< pixels of these four */
	/** Of objects from 1 on: which are grey, hatched and stippled. */
	bool *grey_ids, *hatched_ids, *stippled_ids;
	size_t ids_room;                         /**< of all three */
	const struct gz_illustration_look *look; /**< of the picture, while it is made; borrowed */
	bool begun;                              /**< there is a layer of several */
	const float *shown_lines; /**< the lines of the picture: one of the two planes above */
};

/**
 * Begin the picture of a shot.
 *
 * @param scene  prepared for the shot
 * @retval GZ_ERR_INVAL   the camera is not valid
 * @retval GZ_ERR_NO_MEM  out of memory
 */
enum gz_result gz_illustrate_drawing_begin(struct gz_illustrate_drawing *drawing,
					   const struct gz_illustrate_scene *scene,
					   const struct gz_illustrate_shot *shot);

/** A layer of surfaces. All pointers are borrowed. */
struct gz_drawn_layer {
	const struct gz_plane *depth, *ids; /**< as struct gz_illustrate_picture has them */
	/** Brightness of this layer and those before it, as far as they hide it; what is behind
	 *  counts as white. */
	const float *brightness;
	bool alone; /**< the only layer of the picture */
};

/** Add the marks of a layer. Its lines are in drawing->layer_lines. @retval GZ_ERR_NO_MEM */
enum gz_result gz_illustrate_drawing_add(struct gz_illustrate_drawing *drawing,
					 const struct gz_illustrate_scene *scene,
					 const struct gz_drawn_layer *layer,
					 struct gz_workers *workers);

/** Draw what was added. The same bits for any number of threads. @param image  of the picture's
 *  size; every pixel is written @retval GZ_ERR_NO_MEM */
enum gz_result gz_illustrate_drawing_finish(struct gz_illustrate_drawing *drawing,
					    struct gz_workers *workers, struct gz_image *image);

/**
 * Write the marks of the last picture as a file for print, and lines as strokes between their
 * pixels. Marks keep their share of the picture's width.
 *
 * @param log  may be NULL
 * @retval GZ_ERR_INVAL   no marks drew the last picture, the ending is neither .svg nor .png, or a
 *                        size is out of range: a PNG has 1 to GZ_STIPPLE_SIDE_MAX pixels a side;
 *                        logged
 * @retval GZ_ERR_NO_MEM  out of memory; no file is left
 * @return otherwise as gz_stipple_write_png() and gz_stipple_svg_close()
 */
enum gz_result gz_illustrate_drawing_print(const struct gz_illustrate_drawing *drawing,
					   const struct gz_print *print, struct gz_workers *workers,
					   const struct gz_log *log);

/** Free all and zero it. */
void gz_illustrate_drawing_free(struct gz_illustrate_drawing *drawing);

#endif
