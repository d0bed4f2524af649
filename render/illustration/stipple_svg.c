#include "render/illustration/stipple_svg.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "base/text.h"

/* Longest text that is added at once, bytes: six numbers of at most 16 characters and their
 * elements. */
#define TEXT_MAX 256

static void flush_block(struct gz_stipple_svg *svg)
{
	if (svg->result == GZ_OK)
		svg->result = gz_part_file_write(&svg->file, svg->block, svg->used, svg->written);
	svg->written += svg->used;
	svg->used = 0;
}

static void add_text(struct gz_stipple_svg *svg, const char *text)
{
	const size_t length = strlen(text);
	if (svg->used + length > sizeof svg->block)
		flush_block(svg);
	memcpy(svg->block + svg->used, text, length);
	svg->used += length;
}

/* A length of the picture, in mm to the micrometre, which is finer than any printer. */
static void add_length(struct gz_stipple_svg *svg, const char *before, double px)
{
	char number[TEXT_MAX];
	if (gz_text_print(number, sizeof number, "%.3f", px * svg->mm_per_px) != GZ_OK)
		return;
	gz_number_normalise_point(number);
	add_text(svg, before);
	add_text(svg, number);
}

enum gz_result gz_stipple_svg_open(struct gz_stipple_svg *svg, const char *path,
				   const int size_px[2], double mm_per_px, const struct gz_log *log)
{
	if (size_px[0] < 1 || size_px[1] < 1 || !(mm_per_px > 0) || !isfinite(mm_per_px))
		return GZ_ERR_INVAL;
	const enum gz_result result = gz_part_file_open(&svg->file, path, log);
	if (result != GZ_OK)
		return result;
	svg->mm_per_px = mm_per_px;
	svg->result = GZ_OK;
	svg->written = 0;
	svg->used = 0;
	add_text(svg, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
		      "<svg xmlns=\"http://www.w3.org/2000/svg\" version=\"1.1\"");
	add_length(svg, " width=\"", size_px[0]);
	add_length(svg, "mm\" height=\"", size_px[1]);
	add_length(svg, "mm\" viewBox=\"0 0 ", size_px[0]);
	add_length(svg, " ", size_px[1]);
	add_text(svg, "\">\n");
	return GZ_OK;
}

void gz_stipple_svg_add_discs(struct gz_stipple_svg *svg, const struct gz_stipple_disc *discs,
			      size_t count)
{
	add_text(svg, "<g>\n");
	for (size_t i = 0; i < count; i++) {
		add_length(svg, "<circle cx=\"", (double)discs[i].x + 0.5);
		add_length(svg, "\" cy=\"", (double)discs[i].y + 0.5);
		add_length(svg, "\" r=\"", (double)discs[i].radius);
		add_text(svg, "\"/>\n");
	}
	add_text(svg, "</g>\n");
}

/* Whether a piece begins where the one before it ended. */
static bool piece_goes_on(const struct gz_stipple_piece *before,
			  const struct gz_stipple_piece *piece)
{
	return before->to[0] == piece->from[0] && before->to[1] == piece->from[1];
}

/* The unit vector to the left of a way, or zero. */
static void left_of(const float from[2], const float to[2], double out[2])
{
	const double x = (double)to[0] - (double)from[0], y = (double)to[1] - (double)from[1];
	const double length = sqrt(x * x + y * y);
	out[0] = length > 0 ? y / length : 0;
	out[1] = length > 0 ? -x / length : 0;
}

/* A corner of a line's outline: beside node number of count + 1. @param side  1 left, -1 right */
static void add_corner(struct gz_stipple_svg *svg, const struct gz_stipple_piece *line,
		       size_t count, size_t node, int side)
{
	const struct gz_stipple_piece *next = &line[node < count ? node : count - 1];
	const struct gz_stipple_piece *before = &line[node > 0 ? node - 1 : 0];
	const float *at = node < count ? next->from : next->to;
	const double width = (double)(node < count ? next->from_width : next->to_width);
	double left[2];
	left_of(before->from, next->to, left);
	add_length(svg, node == 0 && side > 0 ? "<path d=\"M" : "L",
		   (double)at[0] + 0.5 + side * left[0] * width / 2);
	add_length(svg, " ", (double)at[1] + 0.5 + side * left[1] * width / 2);
}

static void add_line(struct gz_stipple_svg *svg, const struct gz_stipple_piece *line, size_t count)
{
	for (size_t node = 0; node <= count; node++)
		add_corner(svg, line, count, node, 1);
	for (size_t node = count + 1; node > 0; node--)
		add_corner(svg, line, count, node - 1, -1);
	add_text(svg, "Z\"/>\n");
}

void gz_stipple_svg_add_pieces(struct gz_stipple_svg *svg, const struct gz_stipple_piece *pieces,
			       size_t count)
{
	add_text(svg, "<g>\n");
	for (size_t first = 0, next; first < count; first = next) {
		for (next = first + 1; next < count; next++)
			if (!piece_goes_on(&pieces[next - 1], &pieces[next]))
				break;
		add_line(svg, pieces + first, next - first);
	}
	add_text(svg, "</g>\n");
}

enum gz_result gz_stipple_svg_close(struct gz_stipple_svg *svg)
{
	add_text(svg, "</svg>\n");
	flush_block(svg);
	return gz_part_file_close(&svg->file, svg->result);
}
