#include "view/panels/welcome_panel.h"

#include <math.h>

#include "view/panels/widgets.h"

/* Times the usual size (chosen: read from the other side of a desk). */
#define TITLE_SIZE 2.0f
#define TEXT_SIZE  1.3f

/* One line in the middle. @return its lower edge */
static float draw_line(float y, float size, struct gz_paint paint, const char *text)
{
	const struct gz_place room = gz_text_room(size, text);
	const float x = floorf((gz_widgets_room().x - room.x) / 2);
	gz_draw_text(GZ_LAYER_PICTURE, (struct gz_place) { x, floorf(y) }, size, paint, text);
	return y + room.y;
}

void gz_welcome_panel_draw(void)
{
	const struct gz_paint faint = { 170, 175, 185, 255 };
	const float gap = gz_widgets_line_height() / 2;
	float y = gz_widgets_room().y * 0.35f;
	y = draw_line(y, TITLE_SIZE, gz_paint_plain, "gazeview") + 2 * gap;
	y = draw_line(y, TEXT_SIZE, gz_paint_plain, "Drop a volume or a scene here,");
	y = draw_line(y, TEXT_SIZE, gz_paint_plain, "or press Ctrl+O to open one.") + gap;
	draw_line(y, 1, faint, "H: all keys   N: messages   Q: quit");
}
