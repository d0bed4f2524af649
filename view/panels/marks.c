#include "view/panels/marks.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Unscaled lengths, and sizes of text relative to the interface's (chosen: Dear ImGui's style). */
#define MARGIN        8.0f
#define PADDING       5.0f
#define CROSS_ARM     12.0f
#define LETTER_SIZE   2.0f
#define LETTER_MARGIN 36.0f /* below the text line */
#define MESSAGE_SIZE  2.0f
#define DOT_RADIUS    5.0f

/* Size of a line with its NUL, bytes. */
enum { LINE_SIZE = 512 };

/* Size of the text at the bottom with its NUL, bytes. */
enum { TEXT_SIZE = 1024 };

float gz_marks_draw_caption(float below, struct gz_paint paint, const char *text)
{
	const float scale = gz_widgets_scale();
	const struct gz_place at = { MARGIN * scale,
				     below > 0 ? below + PADDING * scale : MARGIN * scale };
	return gz_draw_caption(GZ_LAYER_PICTURE, at, paint, text).y;
}

static float width_of_bytes(const char *text, size_t length, float size)
{
	char line[LINE_SIZE];
	snprintf(line, sizeof line, "%.*s", (int)length, text);
	return gz_text_room(size, line).x;
}

size_t gz_marks_fit(const char *text, float size, float width)
{
	const size_t length = strcspn(text, "\n");
	size_t fitting = length < LINE_SIZE - 1 ? length : LINE_SIZE - 1;
	while (width_of_bytes(text, fitting, size) > width) {
		size_t shorter = fitting;
		while (shorter > 0 && text[shorter - 1] != ' ')
			shorter--;
		while (shorter > 0 && text[shorter - 1] == ' ')
			shorter--;
		if (shorter == 0)
			break;
		fitting = shorter;
	}
	return fitting;
}

/* Turn blanks into newlines so that each line is at most @p width wide, if its words allow it. */
static void break_lines(char *text, float width)
{
	while (*text) {
		char *end = text + gz_marks_fit(text, 1, width);
		end += strspn(end, " ");
		if (*end && *end != '\n' && end[-1] == ' ')
			*--end = '\n';
		text = end + (*end == '\n');
	}
}

float gz_marks_draw_low_caption(struct gz_paint paint, const char *text)
{
	char wrapped[TEXT_SIZE];
	const float scale = gz_widgets_scale(), side = MARGIN * scale, edge = PADDING * scale;
	const struct gz_place room = gz_widgets_room();
	snprintf(wrapped, sizeof wrapped, "%s", text);
	break_lines(wrapped, room.x - 2 * (side + edge));
	const float height = gz_text_room(1, wrapped).y + 2 * edge;
	const struct gz_place at = { side, floorf(room.y - side - height) };
	gz_draw_caption(GZ_LAYER_PICTURE, at, paint, wrapped);
	return room.y - at.y;
}

/* Light in dark, so that it shows on any picture. */
void gz_marks_draw_cross(struct gz_place at)
{
	static const struct {
		struct gz_paint paint;
		float thickness;
	} strokes[] = { { { 0, 0, 0, 200 }, 5 }, { { 255, 64, 64, 255 }, 3 } };
	const float arm = CROSS_ARM * gz_widgets_scale();
	for (size_t i = 0; i < sizeof strokes / sizeof strokes[0]; i++) {
		gz_draw_line(GZ_LAYER_TOP, (struct gz_place) { at.x - arm, at.y },
			     (struct gz_place) { at.x + arm + 1, at.y }, strokes[i].paint,
			     strokes[i].thickness);
		gz_draw_line(GZ_LAYER_TOP, (struct gz_place) { at.x, at.y - arm },
			     (struct gz_place) { at.x, at.y + arm + 1 }, strokes[i].paint,
			     strokes[i].thickness);
	}
}

/* The letters of one edge. x and y: 0 at the left or top, 1 at the right or bottom. */
static void draw_letter(const char *text, float x, float y, struct gz_place corner,
			struct gz_place opposite)
{
	static const struct gz_place around[] = { { -1, 0 }, { 1, 0 }, { 0, -1 }, { 0, 1 } };
	const struct gz_paint dark = { 0, 0, 0, 255 };
	const float scale = gz_widgets_scale(), side = MARGIN * scale, top = LETTER_MARGIN * scale;
	const struct gz_place size = gz_text_room(LETTER_SIZE, text);
	const struct gz_place room = { opposite.x - corner.x, opposite.y - corner.y };
	const struct gz_place at = {
		floorf(corner.x + side + x * (room.x - 2 * side - size.x)),
		floorf(corner.y + top + y * (room.y - 2 * top - size.y)),
	};
	for (size_t i = 0; i < sizeof around / sizeof around[0]; i++)
		gz_draw_text(GZ_LAYER_PICTURE,
			     (struct gz_place) { at.x + around[i].x, at.y + around[i].y },
			     LETTER_SIZE, dark, text);
	gz_draw_text(GZ_LAYER_PICTURE, at, LETTER_SIZE, gz_paint_plain, text);
}

void gz_marks_draw_letters(const struct gz_letters *letters, struct gz_place corner,
			   struct gz_place opposite)
{
	draw_letter(letters->left, 0, 0.5f, corner, opposite);
	draw_letter(letters->right, 1, 0.5f, corner, opposite);
	draw_letter(letters->top, 0.5f, 0, corner, opposite);
	draw_letter(letters->bottom, 0.5f, 1, corner, opposite);
}

void gz_marks_draw_running(int row, const char *what, bool recording, int64_t seconds)
{
	const struct gz_paint red = { 255, 48, 48, 255 };
	const float scale = gz_widgets_scale(), height = gz_text_room(1, "M").y;
	char text[LINE_SIZE];
	/* Blanks as wide as the dot and its distance from the text. */
	const float blank = gz_text_room(1, " ").x;
	const int blanks = recording ? (int)ceilf((2 * DOT_RADIUS + PADDING) * scale / blank) : 0;
	snprintf(text, sizeof text, "%*s%s %lld:%02lld", blanks, "", what,
		 (long long)(seconds / 60), (long long)(seconds % 60));
	const struct gz_place window = gz_widgets_room(), room = gz_text_room(1, text);
	const float step = height + 3 * PADDING * scale;
	const struct gz_place at = {
		floorf(window.x - room.x - (MARGIN + 2 * PADDING) * scale),
		floorf(window.y - MARGIN * scale - step * (float)(row + 1)),
	};
	const struct gz_place end = gz_draw_caption(GZ_LAYER_TOP, at, gz_paint_plain, text);
	if (recording)
		gz_draw_disc(GZ_LAYER_TOP,
			     (struct gz_place) { at.x + (PADDING + DOT_RADIUS) * scale,
						 (at.y + end.y) / 2 },
			     DOT_RADIUS, red);
}

float gz_marks_draw_centred(enum gz_layer layer, float y, float size, struct gz_paint paint,
			    const char *text)
{
	const struct gz_place room = gz_text_room(size, text);
	const struct gz_place at = { floorf((gz_widgets_room().x - room.x) / 2), floorf(y) };
	gz_draw_text(layer, at, size, paint, text);
	return y + room.y;
}

void gz_marks_draw_message(const char *text)
{
	const struct gz_paint dark = { 20, 20, 20, 255 };
	const float height = gz_text_room(MESSAGE_SIZE, "M").y;
	float y = (gz_widgets_room().y - gz_text_room(MESSAGE_SIZE, text).y) / 2;
	for (const char *at = text; *at; y += height) {
		char line[LINE_SIZE];
		const size_t length = strcspn(at, "\n");
		snprintf(line, sizeof line, "%.*s", (int)length, at);
		gz_marks_draw_centred(GZ_LAYER_TOP, y, MESSAGE_SIZE, dark, line);
		at += length + (at[length] == '\n');
	}
}

/* ---- legend ---- */

/* Unscaled (chosen: six numbers stand apart). */
#define LEGEND_PADDING 6.0f
#define LEGEND_WIDTH   240.0f
#define LEGEND_BAR     12.0f

/* Pieces of the bar, each of which fades. */
enum { PIECES = 18 };

struct legend_scale {
	struct gz_place corner; /* of the bar */
	float width, height;
};

static struct gz_paint paint_of_share(double share)
{
	uint8_t rgb[3];
	gz_viridis(share, rgb);
	return (struct gz_paint) { rgb[0], rgb[1], rgb[2], 255 };
}

static void draw_legend_bar(const struct legend_scale *scale)
{
	for (int i = 0; i < PIECES; i++) {
		const float left = scale->corner.x + scale->width * (float)i / PIECES;
		const float right = scale->corner.x + scale->width * (float)(i + 1) / PIECES;
		gz_draw_fading_rectangle(
			GZ_LAYER_PICTURE, (struct gz_place) { left, scale->corner.y },
			(struct gz_place) { right, scale->corner.y + scale->height },
			paint_of_share((double)i / PIECES),
			paint_of_share((double)(i + 1) / PIECES));
	}
}

static void draw_legend_number(const struct legend_scale *scale, double share, double number)
{
	char text[32];
	snprintf(text, sizeof text, "%.3g", number);
	const struct gz_place room = gz_text_room(1, text);
	const struct gz_place at = {
		scale->corner.x + (float)share * (scale->width - room.x),
		scale->corner.y + scale->height,
	};
	gz_draw_text(GZ_LAYER_PICTURE, at, 1, gz_paint_plain, text);
}

/* A line over the bar, from the least to the greatest value of the plan. */
static void draw_legend_span(const struct legend_scale *scale, double from, double to)
{
	const float left = scale->corner.x + (float)from * scale->width;
	const float right = scale->corner.x + (float)to * scale->width;
	const float unit = gz_widgets_scale(), y = scale->corner.y - 2 * unit;
	gz_draw_rectangle(GZ_LAYER_PICTURE, (struct gz_place) { left - unit, y - 2 * unit },
			  (struct gz_place) { right + unit, y }, gz_paint_plain, 0);
}

float gz_marks_draw_legend(float below, enum gz_view_overlay overlay,
			   const struct gz_plan_cells *cells, double rays_per_px)
{
	const bool steps = overlay == GZ_OVERLAY_STEP;
	const double per_number = steps ? 1 : rays_per_px;
	const float unit = gz_widgets_scale(), line = gz_widgets_line_height();
	const struct gz_place corner = { MARGIN * unit, below + MARGIN * unit };
	const float padding = LEGEND_PADDING * unit;
	const struct legend_scale scale = {
		.corner = { corner.x + padding, corner.y + 2 * padding + line },
		.width = LEGEND_WIDTH * unit,
		.height = LEGEND_BAR * unit,
	};
	const struct gz_place end = { scale.corner.x + scale.width + padding,
				      scale.corner.y + scale.height + line + padding };
	gz_draw_rectangle(GZ_LAYER_PICTURE, corner, end, gz_paint_ground, LEGEND_PADDING);
	gz_draw_text(GZ_LAYER_PICTURE,
		     (struct gz_place) { corner.x + padding, corner.y + padding / 2 }, 1,
		     gz_paint_plain, steps ? "step length, times the scene's" : "ray spacing, px");
	draw_legend_bar(&scale);
	draw_legend_span(&scale, gz_plan_cells_share(cells->least, cells->end),
			 gz_plan_cells_share(cells->most, cells->end));
	for (double value = 1; value <= cells->end; value *= 2)
		draw_legend_number(&scale, gz_plan_cells_share(value, cells->end),
				   value / per_number);
	return end.y;
}
