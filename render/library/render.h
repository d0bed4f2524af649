/**
 * @file
 * The foveated renderer as a library: a volume, a transfer function, a camera and a gaze become a
 * picture in the caller's memory. Link with `pkg-config --cflags --libs gazecast-render`.
 *
 * Handles are opaque, and no struct of ours is passed: everything that a scene file can set is set
 * by its key and its text ("camera.eye", "0 -2 0"), as docs/scenes.md lists them. A program for
 * this header runs with every later library of the same soname: functions and cost names are added,
 * never changed.
 *
 * World units: the volume's longest edge is 1, its centre is the origin, z is up. Gaze: fractions
 * of the picture, origin top left, (1, 1) bottom right.
 *
 * Threads: one at a time for each renderer; several renderers may work beside each other. After a
 * failure gz_renderer_message() says what is wrong and what to do.
 */
#ifndef GZ_RENDER_LIBRARY_RENDER_H
#define GZ_RENDER_LIBRARY_RENDER_H

#include <stddef.h>
#include <stdint.h>

#include "base/result.h"

#ifdef __cplusplus
extern "C" {
#endif

/** A renderer with what it shows. */
struct gz_renderer;

/**
 * Create a renderer that shows nothing yet. Every key has its preset.
 *
 * @param backend  "cpu", "gl" (OpenGL 4.3, without a window) or "auto": gl if a graphics card
 *                 provides it; NULL is "auto"
 * @param threads  of the backend cpu, 1 to 256; 0: one for each processor
 * @param[out] out_renderer  owned by the caller: gz_renderer_close()
 * @retval GZ_ERR_INVAL   no such backend, or too many threads
 * @retval GZ_ERR_NO_MEM  out of memory
 */
enum gz_result gz_renderer_open(const char *backend, int threads,
				struct gz_renderer **out_renderer);

/**
 * Show a scene file, or any volume that gazeview opens. What was shown is freed, every key takes
 * the file's value or its preset, and an earlier transfer function is dropped. A volume gets a
 * transfer function by its histogram and a camera that sees all of it. Blocks until the volume is
 * loaded.
 *
 * @param path  relative names in a scene are searched beside it, then under $GAZECAST_DATA
 * @retval GZ_ERR_NOT_FOUND, GZ_ERR_FORMAT, GZ_ERR_IO, GZ_ERR_UNSUPPORTED, GZ_ERR_INVAL,
 * GZ_ERR_NO_MEM what was shown is unchanged
 */
enum gz_result gz_renderer_load(struct gz_renderer *renderer, const char *path);

/**
 * Show voxels of the caller's memory, which are copied. Keys keep their values, and so does what
 * gz_renderer_set_transfer() has set. If neither gz_renderer_set() nor a scene has placed the
 * camera, it is moved until it sees all of the volume.
 *
 * @param type     "uint8", "int8", "uint16", "int16", "uint32", "int32", "float32" or "float64";
 * host byte order. Not a number and infinities become the least finite value
 * @param dims     voxels along x, y and z, each 1 to 16384; x varies fastest
 * @param spacing  of voxel centres along x, y and z, mm, above 0; NULL: 1 1 1
 * @param voxels   dims[0] * dims[1] * dims[2] numbers without gaps
 * @param size     of @p voxels, bytes
 * @retval GZ_ERR_INVAL   a value is outside its range, or @p size is not what the others say
 * @retval GZ_ERR_FORMAT  dims and spacing that no volume can have together
 * @retval GZ_ERR_NO_MEM  out of memory
 */
enum gz_result gz_renderer_set_volume(struct gz_renderer *renderer, const char *type,
				      const int dims[3], const double spacing[3],
				      const void *voxels, size_t size);

/**
 * Set the transfer function, for the volume that is shown and those that follow.
 *
 * @param text  of a .tf file (docs/scenes.md): lines "value r g b a", all 0 to 1; "range LO HI"
 * says which data values 0 and 1 stand for, by default the least and the greatest. NULL: one by the
 * histogram of each volume
 * @retval GZ_ERR_FORMAT  refused
 * @retval GZ_ERR_NO_MEM  out of memory
 */
enum gz_result gz_renderer_set_transfer(struct gz_renderer *renderer, const char *text);

/**
 * Set a key of the sections camera, render, display, light, clip, environment, isosurface, slices
 * or foveation of a scene file. Values that contradict each other are refused by
 * gz_renderer_draw().
 *
 * @param key    such as "foveation.method" or "camera.eye"
 * @param value  as a scene file has it
 * @retval GZ_ERR_NOT_FOUND  no such key, or one of another section
 * @retval GZ_ERR_INVAL      the value is refused; the key keeps its value
 */
enum gz_result gz_renderer_set(struct gz_renderer *renderer, const char *key, const char *value);

/**
 * Get the value of a key that gz_renderer_set() sets, as text that it takes.
 *
 * @param[out] text  @p size bytes
 * @retval GZ_ERR_NOT_FOUND  no such key
 * @retval GZ_ERR_FULL       @p size is too small; 4096 always suffices
 */
enum gz_result gz_renderer_get(struct gz_renderer *renderer, const char *key, char *text,
			       size_t size);

/**
 * Draw one picture. With the method "standard" (foveation.method) every pixel gets its rays; the
 * others are sharp at the gaze.
 *
 * @param width, height  of the picture, px, 1 to 16384. It fills the display (display.mm and
 *                       display.distance_mm, by default 50.4 degrees wide at 60 cm)
 * @param gaze           two numbers, finite, also outside 0 to 1; NULL: the picture's centre
 * @param[out] rgba      height rows of width pixels, row 0 on top, each R, G, B, A of 8 bits, A =
 * 255
 * @param size           of @p rgba, bytes: width * height * 4
 * @retval GZ_ERR_INVAL        nothing is shown, or a size or the gaze is out of range
 * @retval GZ_ERR_FORMAT       keys contradict each other
 * @retval GZ_ERR_NOT_FOUND, GZ_ERR_IO  a file that foveation.table or environment.cube names
 * @retval GZ_ERR_UNSUPPORTED  the technique or the backend cannot show this
 * @retval GZ_ERR_NO_MEM       out of memory
 */
enum gz_result gz_renderer_draw(struct gz_renderer *renderer, int width, int height,
				const double gaze[2], uint8_t *rgba, size_t size);

/** The name of the cost with this number, from 0: "total_ms" (wall time of gz_renderer_draw()
 * without copying), "plan_ms", "prepare_ms" (what later pictures reuse), "cast_ms",
 * "reconstruct_ms", "rays", "samples" (of the data) and "kept_rays" (of the rays, those that an
 * earlier picture cast while nothing but the gaze has changed). NULL after the last. Static text.
 */
const char *gz_renderer_cost_name(size_t number);

/** A cost of the last picture; NaN before the first, and for a number beyond the last name. */
double gz_renderer_cost(const struct gz_renderer *renderer, size_t number);

/** What draws, such as "cpu: avx2, 2 threads"; "" before the first picture. Valid until the next
 * call. */
const char *gz_renderer_describe(struct gz_renderer *renderer);

/** What the last call that failed, or else the last warning, said; "" if there was none. Valid
 * until the next call. */
const char *gz_renderer_message(const struct gz_renderer *renderer);

/** Free everything and set *renderer to NULL. Accepts a pointer to NULL. */
void gz_renderer_close(struct gz_renderer **renderer);

#ifdef __cplusplus
}
#endif

#endif
