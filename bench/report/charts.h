/**
 * @file
 * Charts drawn by gnuplot, run as a child process without a shell. The scripts are
 * bench/report/charts/; files pass the data to them.
 *
 * Each chart is drawn on three canvases: as SVG for wide pages, which is also FOLDER/NAME.svg, as
 * SVG for narrow pages, and as FOLDER/NAME.png.
 *
 * Methods keep their colours in every report. They differ in lightness and in shape of their points
 * too, so that no one needs to tell hues apart, and each is dark (or light) enough to be read as
 * text: contrast of at least 4.5 (WCAG 2.2, 1.4.3).
 */
#ifndef GZ_BENCH_REPORT_CHARTS_H
#define GZ_BENCH_REPORT_CHARTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "base/text.h"
#include "protocol/gaze.h"

/** Where a chart is drawn. */
enum gz_canvas_kind { GZ_CANVAS_WIDE, GZ_CANVAS_NARROW, GZ_CANVAS_PNG, GZ_CANVAS_KINDS };

/** Size and margins of a canvas, px; of a PNG those before it is scaled by two. */
struct gz_canvas {
	enum gz_canvas_kind kind;
	int width, height;
	int left, right, top, bottom; /**< round the area that is plotted */
	int font_px;
};

/** A chart that was drawn. */
struct gz_chart {
	char name[GZ_PATH_SIZE];    /**< of its files, without ending */
	char *svg[GZ_CANVAS_KINDS]; /**< texts; NULL for GZ_CANVAS_PNG */
};

/** Draws charts into a folder. */
struct gz_charts {
	const struct gz_log *log;
	char folder[GZ_PATH_SIZE];
	char work[GZ_PATH_SIZE]; /**< a folder of its own, inside; empty where nothing is drawn */
	bool available;          /**< false without gnuplot: drawing does nothing */
	struct gz_chart *charts;
	size_t count;
};

/**
 * Prepare drawing into @p folder. Without gnuplot a warning says so, and @p available is false.
 *
 * @retval GZ_ERR_IO, GZ_ERR_NO_MEM  logged; nothing is held
 */
enum gz_result gz_charts_open(const char *folder, const struct gz_log *log,
			      struct gz_charts *out_charts);

/** Remove the working folder, free what it holds and zero it. */
void gz_charts_close(struct gz_charts *charts);

/** Canvas for a picture of @p width and @p height (wide; the narrow one keeps its own shape). */
struct gz_canvas gz_canvas_of(enum gz_canvas_kind kind);

/** Path of a file in the working folder. */
void gz_charts_path(const struct gz_charts *charts, const char *file, char out_path[GZ_PATH_SIZE]);

/** A line "name = 'text'" of settings.gp, whatever the text is. */
void gz_chart_set_text(struct gz_text *settings, const char *name, const char *text);

/** @p text as one cell of a table: what would end the cell or the line is a blank. */
void gz_chart_add_cell(struct gz_text *table, const char *text);

/**
 * Draw a chart on one canvas.
 *
 * @param script    name of the embedded script: "curves.gp"
 * @param name      of the chart, the same for each of its canvases
 * @param settings  lines for settings.gp; canvas and file are added
 * @param table     becomes data.tsv
 * @retval GZ_ERR_IO, GZ_ERR_NO_MEM  logged
 */
enum gz_result gz_charts_draw(struct gz_charts *charts, const char *script, const char *name,
			      const struct gz_canvas *canvas, const struct gz_text *settings,
			      const struct gz_text *table);

/** The chart of this name, or NULL. */
const struct gz_chart *gz_charts_find(const struct gz_charts *charts, const char *name);

/** Colours that are no method's. */
#define GZ_COLOUR_INK  0x1b1f24 /**< axes, text */
#define GZ_COLOUR_GRID 0xdfe3e8 /**< lines of the grid */
#define GZ_COLOUR_MUTE 0x5c6570 /**< secondary text */
#define GZ_COLOUR_PALE 0xcdd3da /**< the front, behind everything */
#define GZ_COLOUR_PAGE 0xfdfdfe /**< halos: the page itself */

/** How a method looks. */
struct gz_method_look {
	uint32_t colour; /**< on a light page, 0xRRGGBB */
	int point;       /**< gnuplot's type of point */
};

/** The look of a method; all unknown methods share one look. */
struct gz_method_look gz_method_look(const char *method);

/** Add to @p out the SVG @p svg of gnuplot, with a style that turns its colours on dark pages. */
void gz_palette_add_dark(struct gz_text *out, const char *svg);

/**
 * Run a program in @p folder, in the locale "C.UTF-8", without input; what it prints goes to the
 * file @p output inside the folder.
 *
 * @param arguments  [0] is the program, looked up in $PATH; NULL behind the last
 * @param[out] out_status  what it exited with, or -1 if a signal ended it
 * @retval GZ_ERR_NOT_FOUND  there is no such program
 * @retval GZ_ERR_IO         it cannot be started
 */
enum gz_result gz_child_run(const char *folder, char *const *arguments, const char *output,
			    int *out_status);

#endif
