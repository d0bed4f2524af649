#include "view/panels/marks.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Screen coordinates of the unscaled interface (chosen: as Dear ImGui's own style). */
#define MARGIN        8.0f
#define PADDING       5.0f
#define CROSS_ARM     12.0f
#define LETTER_SIZE   2.0f
#define LETTER_MARGIN 36.0f /* below the text line */
#define MESSAGE_SIZE  2.0f
#define DOT_RADIUS    5.0f

/* Longest line of a message with its end. */
enum { LINE_SIZE = 512 };

/* Longest text at the bottom with its end. */
enum { TEXT_SIZE = 1024 };

float gz_marks_draw_caption(float below, struct gz_paint paint, const char *text)
{
	const float scale = gz_widgets_scale();
	const struct gz_place at = { MARGIN * scale,
				     below > 0 ? below + PADDING * scale : MARGIN * scale };
	return gz_draw_caption(GZ_LAYER_PICTURE, at, paint, text).y;
}

/* Where a line that begins at @p text, ends at @p end and is wider than @p width is to be broken:
 * its last blank before that; NULL: nowhere. */
static char *break_of(char *text, const char *end, float width)
{
	char *at = NULL;
	for (char *blank = text; blank < end; blank++) {
		if (*blank != ' ')
			continue;
		*blank = '\0';
		const bool fits = gz_text_room(1, text).x <= width;
		*blank = ' ';
		if (!fits)
			break;
		at = blank;
	}
	return at;
}

/* Break lines at blanks so that each is at most @p width wide, where its words let it. */
static void wrap(char *text, float width)
{
	while (*text) {
		char *end = text + strcspn(text, "\n"), *blank = NULL;
		const char kept = *end;
		*end = '\0';
		if (gz_text_room(1, text).x > width)
			blank = break_of(text, end, width);
		*end = kept;
		if (blank)
			*blank = '\n';
		text = blank ? blank + 1 : end + (*end != '\0');
	}
}

float gz_marks_draw_low_caption(struct gz_paint paint, const char *text)
{
	char wrapped[TEXT_SIZE];
	const float scale = gz_widgets_scale(), side = MARGIN * scale, edge = PADDING * scale;
	const struct gz_place room = gz_widgets_room();
	snprintf(wrapped, sizeof wrapped, "%s", text);
	wrap(wrapped, room.x - 2 * (side + edge));
	const float height = gz_text_room(1, wrapped).y + 2 * edge;
	const struct gz_place at = { side, floorf(room.y - side - height) };
	gz_draw_caption(GZ_LAYER_TOP, at, paint, wrapped);
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

/* One of them at a place of the window: 0 at the left or top, 1 at the right or bottom. */
static void draw_letter(const char *text, float x, float y)
{
	static const struct gz_place around[] = { { -1, 0 }, { 1, 0 }, { 0, -1 }, { 0, 1 } };
	const struct gz_paint dark = { 0, 0, 0, 255 };
	const float scale = gz_widgets_scale(), side = MARGIN * scale, top = LETTER_MARGIN * scale;
	const struct gz_place room = gz_widgets_room(), size = gz_text_room(LETTER_SIZE, text);
	const struct gz_place at = { floorf(side + x * (room.x - 2 * side - size.x)),
				     floorf(top + y * (room.y - 2 * top - size.y)) };
	for (size_t i = 0; i < sizeof around / sizeof around[0]; i++)
		gz_draw_text(GZ_LAYER_PICTURE,
			     (struct gz_place) { at.x + around[i].x, at.y + around[i].y },
			     LETTER_SIZE, dark, text);
	gz_draw_text(GZ_LAYER_PICTURE, at, LETTER_SIZE, gz_paint_plain, text);
}

void gz_marks_draw_letters(const struct gz_letters *letters)
{
	draw_letter(letters->left, 0, 0.5f);
	draw_letter(letters->right, 1, 0.5f);
	draw_letter(letters->top, 0.5f, 0);
	draw_letter(letters->bottom, 0.5f, 1);
}

void gz_marks_draw_running(int row, const char *what, bool recording, int64_t seconds)
{
	const struct gz_paint red = { 255, 48, 48, 255 };
	const float scale = gz_widgets_scale(), height = gz_text_room(1, "M").y;
	char text[LINE_SIZE];
	/* As wide as the dot and its distance from the text. */
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

void gz_marks_draw_message(const char *text)
{
	const struct gz_paint dark = { 20, 20, 20, 255 };
	const struct gz_place room = gz_widgets_room();
	const float height = gz_text_room(MESSAGE_SIZE, "M").y;
	float y = (room.y - gz_text_room(MESSAGE_SIZE, text).y) / 2;
	for (const char *at = text; *at; y += height) {
		char line[LINE_SIZE];
		const int length = (int)strcspn(at, "\n");
		snprintf(line, sizeof line, "%.*s", length, at);
		const float width = gz_text_room(MESSAGE_SIZE, line).x;
		gz_draw_text(GZ_LAYER_TOP,
			     (struct gz_place) { floorf((room.x - width) / 2), floorf(y) },
			     MESSAGE_SIZE, dark, line);
		at += length + (at[length] == '\n');
	}
}
