/* Drawings for print: gz_illustrate_drawing_print(). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "render/illustration/shared/illustrate_drawing.h"
#include "render/illustration/stipple_png.h"
#include "render/illustration/stipple_svg.h"

#define GZ_LOG_MODULE "illustration"

#define MM_PER_INCH 25.4

/* Ink of a pixel below which there is no line. */
#define FAINTEST_LINE 0.04F

/* Marks of a picture, without order. */
struct printed_marks {
	struct gz_stipple_disc *discs;
	struct gz_stipple_piece *pieces;
	size_t disc_count, piece_count;
};

/* How dark a line is at a pixel; 0: there is none, or the pixel is outside. */
static float line_at(const struct gz_illustrate_drawing *drawing, int x, int y)
{
	if (x < 0 || y < 0 || x >= drawing->width || y >= drawing->height)
		return 0;
	const float ink = 1 - drawing->shown_lines[(size_t)y * (size_t)drawing->width + (size_t)x];
	return ink < FAINTEST_LINE ? 0 : fminf(ink, 1);
}

/* Where a piece of a line leads from a pixel. */
static const int steps[4][2] = { { 1, 0 }, { 0, 1 }, { 1, 1 }, { -1, 1 } };

/* Whether a line leads from a pixel to a neighbour: on a diagonal, only if none leads there by a
 * neighbour of both. */
static bool leads(const struct gz_illustrate_drawing *drawing, int x, int y, const int step[2])
{
	if (line_at(drawing, x + step[0], y + step[1]) == 0)
		return false;
	return step[0] == 0 || step[1] == 0 ||
	       (line_at(drawing, x + step[0], y) == 0 && line_at(drawing, x, y + step[1]) == 0);
}

static bool is_alone(const struct gz_illustrate_drawing *drawing, int x, int y)
{
	for (int down = -1; down <= 1; down++)
		for (int right = -1; right <= 1; right++)
			if ((down != 0 || right != 0) && line_at(drawing, x + right, y + down) > 0)
				return false;
	return true;
}

/* Add the pieces of lines that lead from a row in one direction; those to the right follow each
 * other. Without room they are only counted. */
static void add_row(const struct gz_illustrate_drawing *drawing, int y, const int step[2],
		    struct printed_marks *marks)
{
	for (int x = 0; x < drawing->width; x++) {
		const float ink = line_at(drawing, x, y);
		if (ink == 0 || !leads(drawing, x, y, step))
			continue;
		if (marks->pieces)
			marks->pieces[marks->piece_count] = (struct gz_stipple_piece) {
				.from = { (float)x, (float)y },
				.to = { (float)(x + step[0]), (float)(y + step[1]) },
				.from_width = ink,
				.to_width = line_at(drawing, x + step[0], y + step[1]),
			};
		marks->piece_count++;
	}
}

static void add_lonely(const struct gz_illustrate_drawing *drawing, int y,
		       struct printed_marks *marks)
{
	for (int x = 0; x < drawing->width; x++) {
		const float ink = line_at(drawing, x, y);
		if (ink == 0 || !is_alone(drawing, x, y))
			continue;
		if (marks->discs)
			marks->discs[marks->disc_count] =
				(struct gz_stipple_disc) { (float)x, (float)y, ink / 2 };
		marks->disc_count++;
	}
}

static void add_lines(const struct gz_illustrate_drawing *drawing, struct printed_marks *marks)
{
	marks->disc_count = drawing->discs.count;
	marks->piece_count = drawing->lines.count;
	for (int y = 0; y < drawing->height; y++) {
		for (int k = 0; k < 4; k++)
			add_row(drawing, y, steps[k], marks);
		add_lonely(drawing, y, marks);
	}
}

static void free_printed(struct printed_marks *marks)
{
	free(marks->discs);
	free(marks->pieces);
}

/* All marks of a drawing with its lines, pixels @p scale times as large. */
static enum gz_result gather_marks(const struct gz_illustrate_drawing *drawing, float scale,
				   struct printed_marks *marks)
{
	add_lines(drawing, marks); /* counts */
	marks->discs = malloc((marks->disc_count + 1) * sizeof *marks->discs);
	marks->pieces = malloc((marks->piece_count + 1) * sizeof *marks->pieces);
	if (!marks->discs || !marks->pieces)
		return GZ_ERR_NO_MEM;
	if (drawing->discs.count > 0)
		memcpy(marks->discs, drawing->discs.discs,
		       drawing->discs.count * sizeof *marks->discs);
	if (drawing->lines.count > 0)
		memcpy(marks->pieces, drawing->lines.pieces,
		       drawing->lines.count * sizeof *marks->pieces);
	add_lines(drawing, marks);
	/* The middle of the first pixel is 0; its corner stays. */
	const float shift = (scale - 1) / 2;
	for (size_t i = 0; i < marks->disc_count; i++) {
		struct gz_stipple_disc *disc = &marks->discs[i];
		*disc = (struct gz_stipple_disc) { disc->x * scale + shift, disc->y * scale + shift,
						   fminf(disc->radius * scale,
							 GZ_STIPPLE_MARK_MAX_PX) };
	}
	for (size_t i = 0; i < marks->piece_count; i++) {
		struct gz_stipple_piece *piece = &marks->pieces[i];
		for (int axis = 0; axis < 2; axis++) {
			piece->from[axis] = piece->from[axis] * scale + shift;
			piece->to[axis] = piece->to[axis] * scale + shift;
		}
		piece->from_width = fminf(piece->from_width * scale, GZ_STIPPLE_MARK_MAX_PX);
		piece->to_width = fminf(piece->to_width * scale, GZ_STIPPLE_MARK_MAX_PX);
	}
	return GZ_OK;
}

static enum gz_result print_svg(const struct gz_illustrate_drawing *drawing,
				const struct gz_print *print, const struct printed_marks *marks,
				const struct gz_log *log)
{
	const int size_px[2] = { drawing->width, drawing->height };
	struct gz_stipple_svg svg;
	const enum gz_result result = gz_stipple_svg_open(&svg, print->path, size_px,
							  print->width_mm / drawing->width, log);
	if (result != GZ_OK)
		return result;
	gz_stipple_svg_add_discs(&svg, marks->discs, marks->disc_count);
	gz_stipple_svg_add_pieces(&svg, marks->pieces, marks->piece_count);
	return gz_stipple_svg_close(&svg);
}

static enum gz_result print_png(const struct gz_print *print, const int size_px[2],
				const struct printed_marks *marks, struct gz_workers *workers,
				const struct gz_log *log)
{
	const struct gz_stipple_marks all = { marks->discs, marks->disc_count, marks->pieces,
					      marks->piece_count };
	return gz_stipple_write_png(&all, size_px, GZ_STIPPLE_STRIP_ROWS, workers, print->path,
				    log);
}

/* Size of the file's pixels; for SVG those of the picture. */
static enum gz_result find_print_size(const struct gz_illustrate_drawing *drawing,
				      const struct gz_print *print, const struct gz_log *log,
				      int out_size_px[2])
{
	const bool png = gz_path_ends(print->path, ".png");
	if (!drawing->drawn || drawing->width < 1) {
		gz_err(log,
		       "%s: the picture is grey, so there are no marks to print; set "
		       "illustration.drawing to stipples or hatches, and illustration.show to "
		       "shading",
		       print->path);
		return GZ_ERR_INVAL;
	}
	if (!png && !gz_path_ends(print->path, ".svg")) {
		gz_err(log, "%s: unknown ending; use .svg or .png", print->path);
		return GZ_ERR_INVAL;
	}
	const double width =
		png ? round(print->width_mm / MM_PER_INCH * print->dpi) : drawing->width;
	const double height = round(width * drawing->height / drawing->width);
	if (!(print->width_mm > 0) || !(width >= 1) || !(height >= 1) ||
	    !(fmax(width, height) <= GZ_STIPPLE_SIDE_MAX)) {
		gz_err(log,
		       "%s: %g mm at %g dpi are not 1 to %d pixels a side; change the width or "
		       "the resolution",
		       print->path, print->width_mm, print->dpi, GZ_STIPPLE_SIDE_MAX);
		return GZ_ERR_INVAL;
	}
	out_size_px[0] = (int)width;
	out_size_px[1] = (int)height;
	return GZ_OK;
}

enum gz_result gz_illustrate_drawing_print(const struct gz_illustrate_drawing *drawing,
					   const struct gz_print *print, struct gz_workers *workers,
					   const struct gz_log *log)
{
	struct printed_marks marks = { 0 };
	int size_px[2];
	enum gz_result result = find_print_size(drawing, print, log, size_px);
	if (result != GZ_OK)
		return result;
	const bool png = gz_path_ends(print->path, ".png");
	result = gather_marks(drawing, (float)size_px[0] / (float)drawing->width, &marks);
	if (result == GZ_OK)
		result = png ? print_png(print, size_px, &marks, workers, log)
			     : print_svg(drawing, print, &marks, log);
	free_printed(&marks);
	return result;
}
