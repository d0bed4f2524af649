/**
 * @file
 * gazeview without a window: renders a sequence of frames into files, writes a volume or a
 * mesh, or lists series. At a terminal, a bar shows the progress of loading.
 */
#ifndef GZ_VIEW_HEADLESS_HEADLESS_H
#define GZ_VIEW_HEADLESS_HEADLESS_H

#include <signal.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "render/data/volume.h"
#include "render/scene/scene.h"
#include "view/options/options.h"

/**
 * Render options->frames pictures, or all frames of options->replay, and print a line on stdout for
 * each.
 *
 * With a live gaze, frame k is rendered no earlier than k / fps seconds after the first. Any other
 * gaze is read at time k / fps, and frames follow as fast as possible.
 *
 * @param[out] out_signal  SIGINT or SIGTERM if one ended the sequence between two frames, else 0
 * @return GZ_OK also after a signal; otherwise the first error, logged
 */
enum gz_result gz_view_headless(const struct gz_view_options *options, const struct gz_log *log,
				int *out_signal);

/**
 * gazeview --write-volume: load or generate the volume of the scene that the options name and write
 * it. The ending chooses the format: bricks (.gzb) or NRRD (.nrrd). Meanwhile a volume larger than
 * a quarter of the machine's memory is kept in an unnamed file beside the new one.
 *
 * @retval GZ_ERR_UNSUPPORTED  another ending, or the volume is stored in bricks already; logged
 * @return otherwise the results of gz_scene_open(), gz_bricks_write() and gz_nrrd_write(); logged
 *         except GZ_ERR_CANCELLED, which a signal causes
 */
enum gz_result gz_view_write_volume(const struct gz_view_options *options,
				    const struct gz_log *log);

/**
 * gazeview --write-mesh: make the surface of the scene's volume at options->isovalue, write it, and
 * print a line about it on stdout. An isovalue that the data do not reach gives an empty mesh and a
 * warning. Of a scene with labels, write the surfaces of all labels instead, and print a line about
 * each.
 *
 * @retval GZ_ERR_INVAL        there are no labels, and no isovalue is given; logged
 * @retval GZ_ERR_UNSUPPORTED  another ending, or the volume is stored in bricks; logged
 * @return otherwise the results of gz_scene_open(), gz_isosurface_make() and gz_mesh_write();
 * logged except GZ_ERR_CANCELLED, which a signal causes
 */
enum gz_result gz_view_write_mesh(const struct gz_view_options *options, const struct gz_log *log);

/**
 * Load or generate the volume of the scene that the options name, with a bar.
 *
 * @param where  the folder for a large volume, as in gz_volume_load(); NULL: in memory
 * @param[out] out_scene  written on GZ_OK: its volume and settings; gz_scene_free()
 * @return the results of gz_scene_open()
 */
enum gz_result gz_view_load_volume(const struct gz_view_options *options,
				   const struct gz_loading *where, const struct gz_log *log,
				   struct gz_scene *out_scene);

/** Load all of the scene that the options name, with a bar. @param[out] out_scene  written on
 * GZ_OK; gz_scene_free() @return the results of gz_scene_open() */
enum gz_result gz_view_load_scene(const struct gz_view_options *options, const struct gz_log *log,
				  struct gz_scene *out_scene);

/**
 * gazeview --list-objects: print what the scene that the options name shows, one object a line, on
 * stdout. Each label of a label volume is an object, with its name if that is known.
 *
 * @return the results of gz_scene_open(); logged except GZ_ERR_CANCELLED, which a signal causes
 */
enum gz_result gz_view_list_objects(const struct gz_view_options *options,
				    const struct gz_log *log);

/**
 * gazeview --list-series: print the DICOM series of the folder or file that the options name as
 * their scene, one a line, on stdout.
 *
 * @return what gz_series_list_read() returns; logged except GZ_ERR_CANCELLED, which a signal causes
 */
enum gz_result gz_view_list_series(const struct gz_view_options *options, const struct gz_log *log);

/** The bar. Pass its loading to gz_scene_open(); it must not move until gz_loading_bar_end(). */
struct gz_loading_bar {
	struct gz_loading loading;
	const struct gz_log *log;
	int64_t begin_ns, next_ns;
	bool terminal; /**< stderr is a terminal */
	bool drawn;    /**< the bar is shown, or the line has been written */
	struct sigaction interrupt, terminate; /**< previous handlers */
};

/**
 * Start a bar. If stderr is a terminal, it appears after 0.3 s and is redrawn in place; otherwise
 * one line is logged after a second. SIGINT and SIGTERM cancel the loading until
 * gz_loading_bar_end(); a second signal of the same kind ends the program. Only one bar may exist
 * in a process.
 */
void gz_loading_bar_begin(struct gz_loading_bar *bar, const struct gz_log *log);

/** Clear the bar, restore the signal handlers, and raise the signal that cancelled the loading, if
 * any, for the previous handler. */
void gz_loading_bar_end(struct gz_loading_bar *bar);

/**
 * Print the text of a bar without control characters, at most 78 columns.
 *
 * @param what     what is loaded; the beginning of a long text is cut
 * @param share    fraction done, 0 to 1
 * @param spent_s  time so far, s; gives the time left once share is above 0.01
 */
void gz_loading_bar_text(const char *what, double share, double spent_s, char *out, size_t size);

#endif
