#include "view/draw/letters.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

enum { GLYPH_WIDTH = 5, GLYPH_HEIGHT = 7, GLYPH_ADVANCE = 6 };

/* Glyphs that fit into the height of a picture (chosen: readable at arm's length). */
#define GLYPHS_PER_HEIGHT 36

/* Share of the direction from which an axis counts: sin(20 degrees). */
#define LEAST_SHARE 0.3420201433256687

/* Rows from the top; the leftmost column is the highest of five bits. */
static const struct {
	char letter;
	uint8_t rows[GLYPH_HEIGHT];
} glyphs[] = {
	{ 'R', { 0x1E, 0x11, 0x11, 0x1E, 0x14, 0x12, 0x11 } },
	{ 'L', { 0x10, 0x10, 0x10, 0x10, 0x10, 0x10, 0x1F } },
	{ 'A', { 0x0E, 0x11, 0x11, 0x1F, 0x11, 0x11, 0x11 } },
	{ 'P', { 0x1E, 0x11, 0x11, 0x1E, 0x10, 0x10, 0x10 } },
	{ 'S', { 0x0F, 0x10, 0x10, 0x0E, 0x01, 0x01, 0x1E } },
	{ 'I', { 0x0E, 0x04, 0x04, 0x04, 0x04, 0x04, 0x0E } },
};

void gz_letters_of(const double direction[3], char out_letters[GZ_LETTERS_SIZE])
{
	static const char names[3][2] = { { 'L', 'R' }, { 'P', 'A' }, { 'I', 'S' } };
	double length = hypot(hypot(direction[0], direction[1]), direction[2]);
	bool taken[3] = { false, false, false };
	int count = 0;
	while (count < 3) {
		int strongest = -1;
		for (int axis = 0; axis < 3; axis++)
			if (!taken[axis] && fabs(direction[axis]) >= LEAST_SHARE * length &&
			    (strongest < 0 || fabs(direction[axis]) > fabs(direction[strongest])))
				strongest = axis;
		if (strongest < 0 || !(length > 0))
			break;
		taken[strongest] = true;
		out_letters[count++] = names[strongest][direction[strongest] > 0];
	}
	out_letters[count] = '\0';
}

static void both_ways(const double direction[3], char towards[GZ_LETTERS_SIZE],
		      char away[GZ_LETTERS_SIZE])
{
	const double back[3] = { -direction[0], -direction[1], -direction[2] };
	gz_letters_of(direction, towards);
	gz_letters_of(back, away);
}

enum gz_result gz_letters_of_camera(const struct gz_camera *camera, struct gz_letters *out_letters)
{
	struct gz_ray_frame rays;
	enum gz_result r = gz_camera_rays(camera, 2, 2, &rays);
	if (r != GZ_OK)
		return r;
	bool parallel = camera->projection == GZ_PROJECTION_ORTHOGRAPHIC;
	both_ways(parallel ? rays.origin_dx : rays.direction_dx, out_letters->right,
		  out_letters->left);
	both_ways(parallel ? rays.origin_dy : rays.direction_dy, out_letters->bottom,
		  out_letters->top);
	return GZ_OK;
}

static void fill_dot(struct gz_image *image, int left, int top, int size, uint8_t level)
{
	const uint8_t colour[4] = { level, level, level, 255 };
	for (int y = top < 0 ? 0 : top; y < top + size && y < image->height; y++)
		for (int x = left < 0 ? 0 : left; x < left + size && x < image->width; x++)
			memcpy(image->pixels + 4 * ((size_t)y * (size_t)image->width + (size_t)x),
			       colour, sizeof colour);
}

static const uint8_t *rows_of(char letter)
{
	for (size_t i = 0; i < sizeof glyphs / sizeof glyphs[0]; i++)
		if (glyphs[i].letter == letter)
			return glyphs[i].rows;
	return NULL;
}

/* How the dots of glyphs are drawn. */
struct pen {
	int dot;  /* size of a dot, px */
	int grow; /* px that each dot is larger on each side: the rim */
	uint8_t level;
};

static void draw_glyph(struct gz_image *image, const uint8_t *rows, int left, int top,
		       const struct pen *pen)
{
	for (int row = 0; row < GLYPH_HEIGHT; row++)
		for (int column = 0; column < GLYPH_WIDTH; column++)
			if (rows[row] >> (GLYPH_WIDTH - 1 - column) & 1)
				fill_dot(image, left + column * pen->dot - pen->grow,
					 top + row * pen->dot - pen->grow, pen->dot + 2 * pen->grow,
					 pen->level);
}

static int text_width(const char *text, int dot)
{
	return ((int)strlen(text) * GLYPH_ADVANCE - 1) * dot;
}

static void draw_text(struct gz_image *image, const char *text, int left, int top, int dot)
{
	const struct pen pens[] = { { dot, (dot + 1) / 2, 0 }, { dot, 0, 235 } }; /* rim, letter */
	for (size_t pen = 0; pen < sizeof pens / sizeof pens[0]; pen++)
		for (int i = 0; text[i]; i++)
			draw_glyph(image, rows_of(text[i]), left + i * GLYPH_ADVANCE * dot, top,
				   &pens[pen]);
}

void gz_letters_draw(const struct gz_letters *letters, struct gz_image *image)
{
	int dot = (int)lround(image->height / (double)(GLYPHS_PER_HEIGHT * GLYPH_HEIGHT));
	dot = dot < 1 ? 1 : dot;
	int height = GLYPH_HEIGHT * dot, margin = 2 * height;
	int middle_x = image->width / 2, middle_y = (image->height - height) / 2;
	int widest = text_width("RAS", dot);
	if (image->height < 3 * height + 2 * margin || image->width < 3 * widest + 2 * margin)
		return;
	draw_text(image, letters->left, height, middle_y, dot);
	draw_text(image, letters->right, image->width - height - text_width(letters->right, dot),
		  middle_y, dot);
	draw_text(image, letters->top, middle_x - text_width(letters->top, dot) / 2, margin, dot);
	draw_text(image, letters->bottom, middle_x - text_width(letters->bottom, dot) / 2,
		  image->height - margin - height, dot);
}
