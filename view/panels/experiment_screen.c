#include "view/panels/experiment_screen.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "view/panels/marks.h"

/* Shares of the window (chosen). */
#define TEXT_WIDTH     0.8f
#define NOTE_SIZE      0.7f /* of the text */
#define NOTE_BOTTOM    0.03f
#define BAR_WIDTH      0.3f
#define BAR_HEIGHT     0.012f
#define BAR_BOTTOM     0.1f
#define BUTTONS_MIDDLE 0.78f /* of the row, from above */
#define BUTTONS_WIDTH  0.92f /* at most, all together */
#define BUTTON_LEAST   0.12f
#define TEXT_BOTTOM    0.68f /* texts end above it, if they can */
/* Of a button, in heights of a line. */
#define BUTTON_HEIGHT 3.0f
#define BUTTON_MARGIN 2.0f
#define BUTTON_GAP    0.6f
#define BUTTON_KEY    0.6f /* size of its key */
/* The cross's arms, share of its width, and no thinner than this. */
#define CROSS_THICKNESS 0.1f
#define CROSS_LEAST     2.0f
/* From line to line, of a line's height. */
#define LEADING 1.35f

/* Size of a line with its NUL, bytes, and most lines of a screen. */
enum { LINE_SIZE = 512, LINES_MAX = 128 };

/* Dark on a light ground and light on a dark one, by the luminance of Rec. 709. */
static struct gz_paint ink_of(const struct gz_experiment_look *look)
{
	const double light =
		0.2126 * look->ground[0] + 0.7152 * look->ground[1] + 0.0722 * look->ground[2];
	return light > 0.35 ? (struct gz_paint) { 16, 16, 16, 255 }
			    : (struct gz_paint) { 224, 224, 224, 255 };
}

/* The size of text, times the interface's, that makes a line as high as asked for. */
static float text_size_of(const struct gz_experiment_look *look)
{
	const float usual = gz_text_room(1, "M").y;
	return usual > 0 ? (float)look->text_size * gz_widgets_room().y / usual : 1;
}

/* The lines of a text, wrapped. */
struct screen_lines {
	char line[LINES_MAX][LINE_SIZE];
	int count;
};

static void wrap_text(const char *text, float size, float width, struct screen_lines *lines)
{
	lines->count = 0;
	while (*text && lines->count < LINES_MAX) {
		const size_t fitting = gz_marks_fit(text, size, width);
		snprintf(lines->line[lines->count++], LINE_SIZE, "%.*s", (int)fitting, text);
		text += fitting;
		if (*text == '\n')
			text++;
		else
			text += strspn(text, " ");
	}
}

void gz_experiment_screen_text(const struct gz_experiment_look *look, const char *text)
{
	struct screen_lines lines;
	const struct gz_place room = gz_widgets_room();
	const float size = text_size_of(look), height = LEADING * gz_text_room(size, "M").y;
	wrap_text(text, size, TEXT_WIDTH * room.x, &lines);
	const float all = (float)lines.count * height;
	float y = fmaxf(0, fminf((room.y - all) / 2, TEXT_BOTTOM * room.y - all));
	for (int i = 0; i < lines.count; i++, y += height)
		gz_marks_draw_centred(GZ_LAYER_TOP, y, size, ink_of(look), lines.line[i]);
}

static void print_button_name(const char *name, char text[LINE_SIZE])
{
	snprintf(text, LINE_SIZE, "%s", name);
	for (char *letter = text; *letter; letter++)
		if (*letter == '_')
			*letter = ' ';
}

/* Width of the widest button at this size of text. */
static float button_width(const struct gz_experiment_button *buttons, size_t count, float size)
{
	char name[LINE_SIZE];
	float widest = 0;
	for (size_t i = 0; i < count; i++) {
		print_button_name(buttons[i].name, name);
		widest = fmaxf(widest, gz_text_room(size, name).x);
	}
	return widest + BUTTON_MARGIN * gz_text_room(size, "M").y;
}

static void draw_in_middle(const struct gz_experiment_button *button, float y, float size,
			   struct gz_paint paint, const char *text)
{
	const float width = gz_text_room(size, text).x;
	const struct gz_place at = { (button->corner.x + button->opposite.x - width) / 2, y };
	gz_draw_text(GZ_LAYER_TOP, at, size, paint, text);
}

static void draw_button(const struct gz_experiment_look *look,
			const struct gz_experiment_button *button, float size, bool bright)
{
	const struct gz_paint ink = ink_of(look);
	const struct gz_paint ground = { ink.red, ink.green, ink.blue, bright ? 90 : 40 };
	const float line = gz_text_room(size, "M").y;
	const float spare = button->opposite.y - button->corner.y - line * (1.2f + BUTTON_KEY);
	char name[LINE_SIZE];
	print_button_name(button->name, name);
	gz_draw_rectangle(GZ_LAYER_TOP, button->corner, button->opposite, ground, 6);
	draw_in_middle(button, button->corner.y + spare / 2, size, ink, name);
	draw_in_middle(button, button->corner.y + spare / 2 + 1.2f * line, BUTTON_KEY * size, ink,
		       button->key);
}

int gz_experiment_button_at(const struct gz_experiment_button *buttons, size_t count,
			    struct gz_place place)
{
	for (size_t i = 0; i < count; i++)
		if (place.x >= buttons[i].corner.x && place.x < buttons[i].opposite.x &&
		    place.y >= buttons[i].corner.y && place.y < buttons[i].opposite.y)
			return (int)i;
	return -1;
}

void gz_experiment_screen_buttons(const struct gz_experiment_look *look,
				  struct gz_experiment_button *buttons, size_t count,
				  const struct gz_place *mouse)
{
	const struct gz_place room = gz_widgets_room();
	float size = text_size_of(look);
	const float line = gz_text_room(size, "M").y, gap = BUTTON_GAP * line;
	const float share = BUTTONS_WIDTH * room.x / (float)(count ? count : 1) - gap;
	const float wanted = button_width(buttons, count, size);
	size *= fminf(1, share / wanted);
	const float width = fminf(share, fmaxf(wanted, BUTTON_LEAST * room.x));
	const float half = BUTTON_HEIGHT * line / 2, step = width + gap;
	const float left = (room.x - (float)count * step + gap) / 2;
	for (size_t i = 0; i < count; i++) {
		const float x = left + (float)i * step;
		buttons[i].corner = (struct gz_place) { x, BUTTONS_MIDDLE * room.y - half };
		buttons[i].opposite =
			(struct gz_place) { x + width, BUTTONS_MIDDLE * room.y + half };
	}
	const int bright = mouse ? gz_experiment_button_at(buttons, count, *mouse) : -1;
	for (size_t i = 0; i < count; i++)
		draw_button(look, &buttons[i], size, (int)i == bright);
}

void gz_experiment_screen_note(const struct gz_experiment_look *look, const char *text)
{
	const float size = NOTE_SIZE * text_size_of(look);
	const float y = (1 - NOTE_BOTTOM) * gz_widgets_room().y - gz_text_room(size, "M").y;
	gz_marks_draw_centred(GZ_LAYER_TOP, y, size, ink_of(look), text);
}

void gz_experiment_screen_cross(const struct gz_experiment_look *look, float across)
{
	const struct gz_place room = gz_widgets_room();
	const float x = floorf(room.x / 2), y = floorf(room.y / 2), arm = fmaxf(3, across / 2);
	const float half = fmaxf(CROSS_LEAST, CROSS_THICKNESS * across) / 2;
	gz_draw_rectangle(GZ_LAYER_TOP, (struct gz_place) { x - arm, y - half },
			  (struct gz_place) { x + arm, y + half }, ink_of(look), 0);
	gz_draw_rectangle(GZ_LAYER_TOP, (struct gz_place) { x - half, y - arm },
			  (struct gz_place) { x + half, y + arm }, ink_of(look), 0);
}

void gz_experiment_screen_bar(const struct gz_experiment_look *look, double share)
{
	const struct gz_place room = gz_widgets_room();
	const struct gz_paint paint = ink_of(look);
	const struct gz_paint faint = { paint.red, paint.green, paint.blue, 60 };
	const float left = (1 - BAR_WIDTH) / 2 * room.x, width = BAR_WIDTH * room.x;
	const float top = (1 - BAR_BOTTOM) * room.y, bottom = top + BAR_HEIGHT * room.y;
	const float full = (float)fmin(1, fmax(0, share)) * width;
	gz_draw_rectangle(GZ_LAYER_TOP, (struct gz_place) { left, top },
			  (struct gz_place) { left + width, bottom }, faint, 0);
	gz_draw_rectangle(GZ_LAYER_TOP, (struct gz_place) { left, top },
			  (struct gz_place) { left + full, bottom }, paint, 0);
}
