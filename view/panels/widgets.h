/**
 * @file
 * What panels are made of: widgets, and shapes drawn over the picture. Dear ImGui behind a C
 * interface: panels/widgets.cpp is the one file of C++ here, and the one that knows of it.
 *
 * Places and lengths are in the window's screen coordinates, as GLFW's cursor is, from the top left
 * corner; lengths marked "unscaled" are multiplied by gz_widgets_scale(). Texts are UTF-8 and
 * borrowed until the call returns. Everything but gz_widgets_init(), gz_widgets_free() and the
 * questions about mouse and keyboard stands between gz_widgets_begin() and gz_widgets_end(), on the
 * thread with the window's OpenGL context.
 *
 * A widget is told from others of its panel by its id, which is not shown where it begins with
 * "##"; gz_widgets_push_id() tells rows of a list apart.
 */
#ifndef GZ_VIEW_WIDGETS_H
#define GZ_VIEW_WIDGETS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

struct GLFWwindow;

/** A place or a size. */
struct gz_place {
	float x, y;
};

/** Colour and opacity, 0 to 255. */
struct gz_paint {
	uint8_t red, green, blue, alpha;
};

/** Text on any picture, what is to be seen to, and what is wrong. */
extern const struct gz_paint gz_paint_plain, gz_paint_amber, gz_paint_red, gz_paint_ground;

/** What a shape is drawn on. */
enum gz_layer {
	GZ_LAYER_PICTURE, /**< over the picture, under the panels */
	GZ_LAYER_PANEL,   /**< in the panel that is open: shapes after widgets lie over them */
	GZ_LAYER_TOP,     /**< over the panels */
};

/** A corner or side that a panel keeps to. */
enum gz_panel_at {
	GZ_PANEL_TOP_LEFT,
	GZ_PANEL_TOP_RIGHT,
	GZ_PANEL_BOTTOM_LEFT,
	GZ_PANEL_BOTTOM_RIGHT,
	GZ_PANEL_MIDDLE,
};

/** Where a panel stands when it appears; one with a title that is neither a dialog nor in the
 * middle is then dragged by it. */
struct gz_panel_place {
	enum gz_panel_at at;
	float margin_top, margin_bottom; /**< kept free beyond the usual margin */
	float width;                     /**< unscaled, cut to the window; 0: as wide as it needs */
	bool takes_keyboard; /**< it is a dialog: the first widget has the keyboard, and nothing
				beneath it can be clicked */
};

/** What the mouse and the keyboard do to a canvas. */
struct gz_canvas {
	struct gz_place corner, size; /**< of its area */
	struct gz_place mouse;
	bool hovered;        /**< the mouse is over it */
	bool focused;        /**< keys are its own: it was clicked last, or reached by Tab */
	bool pressed;        /**< the left button went down on it since the last frame */
	bool double_pressed; /**< twice in short order */
	bool right_pressed;
	bool held;     /**< the left button went down on it and still is */
	bool released; /**< that button went up since the last frame */
	bool shift, control;
	float wheel;          /**< notches, up positive; 0 unless hovered */
	int arrow_x, arrow_y; /**< presses of the arrow keys, right and up positive; focused */
	int step;             /**< presses of Tab, with Shift negative; focused: whoever comes to
				 the end of what the canvas has calls gz_widgets_focus_next() */
	bool delete_pressed;  /**< Delete or Backspace; focused */
	bool insert_pressed;  /**< Insert; focused */
};

/**
 * Set up. The window's OpenGL context must be current; callbacks that the window has stay in force
 * and are called first.
 *
 * @param scale  of the interface; 0: what the display says
 * @return false if Dear ImGui cannot be set up
 */
bool gz_widgets_init(struct GLFWwindow *window, double scale);

/** The display may say another scale than before: the interface follows, unless one was asked for.
 *  Outside a frame. */
void gz_widgets_follow_scale(struct GLFWwindow *window);

/** Take down what gz_widgets_init() set up; nothing if it did not. */
void gz_widgets_free(void);

/** Begin a frame over what is in the current framebuffer. */
void gz_widgets_begin(void);

/** Draw the frame. */
void gz_widgets_end(void);

/** How many screen coordinates an unscaled one is: 1, more where a display has small pixels. */
float gz_widgets_scale(void);

/** Size of the window. */
struct gz_place gz_widgets_room(void);

/** Height of a line of text. */
float gz_widgets_line_height(void);

/** Whether the mouse is a panel's: over it, or dragging something of it. As of the last frame. */
bool gz_widgets_have_mouse(void);

/** Whether a panel lies at a place of the window, as of the last frame: whoever clicks there before
 *  the next one means the panel, though gz_widgets_have_mouse() does not know yet. */
bool gz_widgets_lie_at(float x, float y);

/** Whether a text is being typed: no key is the window's. As of the last frame. */
bool gz_widgets_have_text(void);

/** Whether somebody moves about in the panels by keys: arrows, Tab, Space, Enter, Delete and Escape
 * are not the window's. As of the last frame. */
bool gz_widgets_have_navigation(void);

/** Whether a dialog is open, a panel that takes the keyboard: no key is the window's, and nothing
 *  beneath it can be clicked. */
bool gz_widgets_have_dialog(void);

/** A key has been pressed, however shortly: what gz_widget_entered() and the like go by. @param key
 *  of GLFW */
void gz_widgets_note_key(int key);

/** Whether a widget is held by the mouse or typed in, or an arrow key is held: what changes until
 * that ends is one change. */
bool gz_widgets_in_use(void);

/** Give keys back to the window: no widget has them. */
void gz_widgets_release_keyboard(void);

/** A line, @p thickness wide, unscaled. */
void gz_draw_line(enum gz_layer layer, struct gz_place from, struct gz_place to,
		  struct gz_paint paint, float thickness);

/** Lines through @p count places. */
void gz_draw_lines(enum gz_layer layer, const struct gz_place *places, size_t count,
		   struct gz_paint paint, float thickness);

/** A filled rectangle, its corners round by @p radius, unscaled. */
void gz_draw_rectangle(enum gz_layer layer, struct gz_place corner, struct gz_place opposite,
		       struct gz_paint paint, float radius);

/** A filled rectangle that fades from its left colour to its right one. */
void gz_draw_fading_rectangle(enum gz_layer layer, struct gz_place corner, struct gz_place opposite,
			      struct gz_paint left, struct gz_paint right);

/** A filled disc; radius unscaled. */
void gz_draw_disc(enum gz_layer layer, struct gz_place centre, float radius, struct gz_paint paint);

/** A circle; radius and thickness unscaled. */
void gz_draw_circle(enum gz_layer layer, struct gz_place centre, float radius,
		    struct gz_paint paint, float thickness);

/** A line of text, @p size times the usual one, its top left corner at @p at. */
void gz_draw_text(enum gz_layer layer, struct gz_place at, float size, struct gz_paint paint,
		  const char *text);

/** Room that a text takes, lines parted by newlines. */
struct gz_place gz_text_room(float size, const char *text);

/** Lines of text on a dark ground, so that they read on any picture. @return the ground's lower
 * right corner */
struct gz_place gz_draw_caption(enum gz_layer layer, struct gz_place at, struct gz_paint paint,
				const char *text);

/**
 * Open a panel; gz_panel_end() closes it, whatever this returns.
 *
 * @param title  unique; shown at its top unless it begins with "##"
 * @param open   in: whether it is there at all; out: false once its cross was clicked. NULL: it has
 *               no cross
 * @return whether its content is seen; else widgets in it can be left out
 */
bool gz_panel_begin(const char *title, const struct gz_panel_place *place, bool *open);

/** Close the panel that gz_panel_begin() opened. */
void gz_panel_end(void);

/** Tell widgets apart that have the same id, until gz_widgets_pop_id(). */
void gz_widgets_push_id(const char *id);

/** See gz_widgets_push_id(). */
void gz_widgets_pop_id(void);

/** Widgets until gz_widgets_enable() are grey and do nothing, if @p disabled. Calls pair up. */
void gz_widgets_disable(bool disabled);

/** See gz_widgets_disable(). */
void gz_widgets_enable(void);

/** The next widget stands in the same line as the last one, @p share of the panel's width from its
 * left, or right behind it where that is 0. */
void gz_widgets_same_line(float share);

/** The next widget is so wide: a share of the panel; 0: the rest of the line. */
void gz_widgets_next_width(float share);

/** The next widget has the keyboard from now on. */
void gz_widgets_focus_next(void);

/** The next canvas of the panel has the keyboard from now on. */
void gz_widgets_focus_canvas(void);

/** A line between groups of widgets. */
void gz_widget_separator(void);

/** Text, wrapped at the panel's edge. */
void gz_widget_text(struct gz_paint paint, const char *text);

/** Text in one line, in the height of widgets beside it. */
void gz_widget_label(const char *text);

/** A text that appears while the mouse rests on the last widget, also a grey one. */
void gz_widget_tooltip(const char *text);

/** Whether the mouse has just been pressed on the last widget, a text as well. */
bool gz_widget_clicked(void);

/** A heading that folds away what is below it. @return whether that is shown */
bool gz_widget_heading(const char *id, bool open_at_first);

/** @return whether it was pressed */
bool gz_widget_button(const char *id);

/** A box to tick. @return whether it was changed */
bool gz_widget_checkbox(const char *id, bool *value);

/** One of several. @param names NULL-terminated @return whether it was changed */
bool gz_widget_choice(const char *id, int *value, const char *const names[]);

/** A row of a list. @return whether it was clicked or Enter pressed on it */
bool gz_widget_row(const char *id, bool selected, bool *out_double_clicked);

/** A row of two texts, the second @p width (unscaled) from the left. @return whether it was clicked
 *  or Enter pressed on it */
bool gz_widget_pair_row(const char *id, float width, const char *left, const char *right);

/** What follows stands in the first of @p count columns, until gz_widget_columns_next(). */
void gz_widget_columns_begin(const char *id, int count);

/** What follows stands in the next column. */
void gz_widget_columns_next(void);

/** See gz_widget_columns_begin(). */
void gz_widget_columns_end(void);

/** A list that scrolls, @p lines high, whose rows are reached by the arrow keys as widgets are;
 * gz_widget_list_end() ends it in any case. */
bool gz_widget_list_begin(const char *id, int lines);

/** See gz_widget_list_begin(). */
void gz_widget_list_end(void);

/** How numbers are set. */
struct gz_number_range {
	double least, greatest; /**< kept to, also where they are typed */
	bool slider;            /**< else dragged, by @p speed a pixel */
	bool logarithmic;       /**< slider only; least above 0 */
	double speed;
	const char *format; /**< of printf, one number */
};

/** @p count ints, 1 to 4. @return whether one was changed */
bool gz_widget_ints(const char *id, int *values, int count, const struct gz_number_range *range);

/** @p count doubles, 1 to 4. @return whether one was changed */
bool gz_widget_doubles(const char *id, double *values, int count,
		       const struct gz_number_range *range);

/** Red, green, blue, 0 to 1. @return whether it was changed */
bool gz_widget_colour(const char *id, double rgb[3]);

/**
 * The same, larger, at the mouse until it is clicked elsewhere or Escape is pressed.
 *
 * @param open  it appears now
 * @return whether @p rgb was changed
 */
bool gz_widget_colour_popup(const char *id, bool open, double rgb[3]);

/**
 * A field for a text of less than @p size bytes.
 *
 * @param by_enter  true: the text changes when Enter is pressed, as a whole; false: at each key
 * @return whether it has changed, or Enter was pressed
 */
bool gz_widget_text_field(const char *id, char *text, size_t size, bool by_enter);

/** Whether Enter was pressed since the last frame. */
bool gz_widgets_enter_pressed(void);

/** Whether Enter was pressed in the last text field. */
bool gz_widget_entered(void);

/** Whether Enter was pressed and no widget of the dialog answers it. */
bool gz_dialog_entered(void);

/** Whether Escape was pressed. */
bool gz_dialog_escaped(void);

/** A bar, @p share of it full, with a text on it; below 0: something is going on, nobody knows how
 * far. */
void gz_widget_progress(double share, const char *text);

/** An area of @p height (unscaled) across the panel to draw on with GZ_LAYER_PANEL; mouse and
 * keyboard do nothing to it. */
void gz_widget_area(float height, struct gz_place *out_corner, struct gz_place *out_size);

/** An area of @p height (unscaled) across the panel to draw on with GZ_LAYER_PANEL, until
 * gz_widget_canvas_end(). While it has the keyboard, arrows and Tab do not lead out of it; Escape
 * does. */
void gz_widget_canvas(const char *id, float height, struct gz_canvas *out_canvas);

/** Widgets are below it again. */
void gz_widget_canvas_end(void);

#ifdef __cplusplus
}
#endif

#endif
