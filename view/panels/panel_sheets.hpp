/* How panels are drawn: their ground is opaque, and a panel that stays as it was is copied from a
 * texture instead of being drawn again. Software OpenGL needs most of its time for panels to blend
 * their rectangles; a copy takes as long as the picture, which need not be drawn beneath. */
#ifndef GZ_VIEW_PANELS_PANEL_SHEETS_HPP
#define GZ_VIEW_PANELS_PANEL_SHEETS_HPP

#include <imgui.h>

#include "view/panels/widgets.h"

struct ImGuiWindow;

namespace gz_panels
{

/* What a list draws, to be compared with the next frame's. */
struct Content {
	ImVector<ImDrawVert> vertices;
	ImVector<ImDrawIdx> indices;
	ImVector<ImDrawCmd> commands;
};

/* A panel with an opaque ground. */
struct Sheet {
	ImGuiWindow *window; /* null: free */
	bool in_frame;
	Content content;
	gz_pixel_rectangle place; /* of the content */
	unsigned texture, framebuffer;
	bool drawn; /* the texture shows the content */
};

/* All of them. Zero-initialised; free() before the context goes. */
class Sheets
{
      public:
	/* A frame begins: no panel has an opaque ground. */
	void begin();

	/* Whether add() can take one more in this frame. */
	bool has_room() const;

	/* Give a window an opaque ground in this frame. Its own must have an opacity of 0. */
	void add(ImGuiWindow *window);

	/* The places of windows with an opaque ground. -> their number, at most
	 * GZ_WIDGETS_COVERED_MAX */
	int covered(const ImDrawData *data, gz_pixel_rectangle *out) const;

	/* Draw a frame into the current framebuffer, which is that of the window. */
	void draw(ImDrawData *data);

	/* Delete all textures. They come back when they are needed. */
	void free();

      private:
	Sheet sheets[GZ_WIDGETS_COVERED_MAX];

	Sheet *of_list(const ImDrawList *list);
};

} // namespace gz_panels

#endif
