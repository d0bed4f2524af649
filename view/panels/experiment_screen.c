#include "view/panels/experiment_screen.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Shares of the window (chosen). */
#define TEXT_WIDTH  0.8f
#define NOTE_SIZE   0.7f /* of the text */
#define NOTE_BOTTOM 0.03f
#define BAR_WIDTH   0.3f
#define BAR_HEIGHT  0.012f
#define BAR_BOTTOM  0.1f
/* The cross's arms, share of its width, and no thinner than this. */
#define CROSS_THICKNESS 0.1f
#define CROSS_LEAST     2.0f
/* From line to line, of a line's height. */
#define LEADING 1.35f

/* Longest line on the screen with its NUL, bytes, and the most of them. */
enum { LINE_SIZE = 512, LINES_MAX = 128 };

/* Dark on light and light on dark, by the luminance of Rec. 709. */
static struct gz_paint ink(const struct gz_experiment_look *look)
{
	const double light =
		0.2126 * look->ground[0] + 0.7152 * look->ground[1] + 0.0722 * look->ground[2];
	return light > 0.35 ? (struct gz_paint) { 16, 16, 16, 255 }
			    : (struct gz_paint) { 224, 224, 224, 255 };
}

/* The size of text, in the interface's own, that makes a line so high. */
static float size_of(const struct gz_experiment_look *look)
{
	const float usual = gz_text_room(1, "M").y;
	return usual > 0 ? (float)look->text_size * gz_widgets_room().y / usual : 1;
}

/* Lines as they are shown. */
struct lines {
	char line[LINES_MAX][LINE_SIZE];
	int count;
};

static float width_of(const char *text, size_t length, float size)
{
	char line[LINE_SIZE];
	snprintf(line, sizeof line, "%.*s", (int)length, text);
	return gz_text_room(size, line).x;
}

/* How much of the line fits: whole words, at least one. */
static size_t fit(const char *text, size_t length, float size, float room)
{
	size_t good = length < LINE_SIZE - 1 ? length : LINE_SIZE - 1;
	while (width_of(text, good, size) > room) {
		size_t shorter = good;
		while (shorter > 0 && text[shorter - 1] != ' ')
			shorter--;
		while (shorter > 0 && text[shorter - 1] == ' ')
			shorter--;
		if (shorter == 0)
			return good;
		good = shorter;
	}
	return good;
}

static void wrap(const char *text, float size, float room, struct lines *lines)
{
	lines->count = 0;
	while (*text && lines->count < LINES_MAX) {
		const size_t length = strcspn(text, "\n");
		const size_t fitting = fit(text, length, size, room);
		snprintf(lines->line[lines->count++], LINE_SIZE, "%.*s", (int)fitting, text);
		text += fitting;
		if (fitting < length)
			text += strspn(text, " ");
		else if (*text == '\n')
			text++;
	}
}

static void draw_centred(const char *line, float y, float size, struct gz_paint paint)
{
	const float width = gz_text_room(size, line).x;
	const struct gz_place at = { floorf((gz_widgets_room().x - width) / 2), floorf(y) };
	gz_draw_text(GZ_LAYER_TOP, at, size, paint, line);
}

void gz_experiment_screen_text(const struct gz_experiment_look *look, const char *text)
{
	struct lines lines;
	const struct gz_place room = gz_widgets_room();
	const float size = size_of(look), height = LEADING * gz_text_room(size, "M").y;
	wrap(text, size, TEXT_WIDTH * room.x, &lines);
	float y = (room.y - (float)lines.count * height) / 2;
	for (int i = 0; i < lines.count; i++, y += height)
		draw_centred(lines.line[i], y, size, ink(look));
}

void gz_experiment_screen_note(const struct gz_experiment_look *look, const char *text)
{
	const float size = NOTE_SIZE * size_of(look);
	const float y = (1 - NOTE_BOTTOM) * gz_widgets_room().y - gz_text_room(size, "M").y;
	draw_centred(text, y, size, ink(look));
}

void gz_experiment_screen_cross(const struct gz_experiment_look *look, float across)
{
	const struct gz_place room = gz_widgets_room();
	const float x = floorf(room.x / 2), y = floorf(room.y / 2), arm = fmaxf(3, across / 2);
	const float half = fmaxf(CROSS_LEAST, CROSS_THICKNESS * across) / 2;
	gz_draw_rectangle(GZ_LAYER_TOP, (struct gz_place) { x - arm, y - half },
			  (struct gz_place) { x + arm, y + half }, ink(look), 0);
	gz_draw_rectangle(GZ_LAYER_TOP, (struct gz_place) { x - half, y - arm },
			  (struct gz_place) { x + half, y + arm }, ink(look), 0);
}

void gz_experiment_screen_bar(const struct gz_experiment_look *look, double share)
{
	const struct gz_place room = gz_widgets_room();
	const struct gz_paint paint = ink(look);
	const struct gz_paint faint = { paint.red, paint.green, paint.blue, 60 };
	const float left = (1 - BAR_WIDTH) / 2 * room.x, width = BAR_WIDTH * room.x;
	const float top = (1 - BAR_BOTTOM) * room.y, bottom = top + BAR_HEIGHT * room.y;
	const float full = (float)fmin(1, fmax(0, share)) * width;
	gz_draw_rectangle(GZ_LAYER_TOP, (struct gz_place) { left, top },
			  (struct gz_place) { left + width, bottom }, faint, 0);
	gz_draw_rectangle(GZ_LAYER_TOP, (struct gz_place) { left, top },
			  (struct gz_place) { left + full, bottom }, paint, 0);
}
