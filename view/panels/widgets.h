/**
 * @file
 * Panels, widgets, and shapes drawn over the picture: Dear ImGui behind a C interface. Only
 * panels/widgets.cpp is C++ and uses Dear ImGui.
 *
 * Places and lengths are in the window's screen coordinates, like GLFW's cursor, from the top left
 * corner. Lengths marked "unscaled" are multiplied by gz_widgets_scale(). Texts are UTF-8 and
 * borrowed until the call returns. Call everything but gz_widgets_init(), gz_widgets_free(),
 * gz_widgets_covered(), gz_widgets_draw() and the questions about mouse and keyboard between
 * gz_widgets_begin() and gz_widgets_end(), on the thread with the window's OpenGL context.
 *
 * An id identifies a widget within its panel; it is also its text, unless it begins with "##".
 * gz_widgets_push_id() tells rows of a list apart.
 */
#ifndef GZ_VIEW_PANELS_WIDGETS_H
#define GZ_VIEW_PANELS_WIDGETS_H

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

/** Text, warnings, errors, and the ground behind text. */
extern const struct gz_paint gz_paint_plain, gz_paint_amber, gz_paint_red, gz_paint_ground;

/** What a shape is drawn on. */
enum gz_layer {
	GZ_LAYER_PICTURE, /**< over the picture, under the panels */
	GZ_LAYER_PANEL,   /**< in the open panel, over the widgets before */
	GZ_LAYER_TOP,     /**< over the panels */
};

/** The corner where a panel appears. */
enum gz_panel_at {
	GZ_PANEL_TOP_LEFT,
	GZ_PANEL_TOP_RIGHT,
	GZ_PANEL_BOTTOM_LEFT,
	GZ_PANEL_BOTTOM_RIGHT,
	GZ_PANEL_MIDDLE,
};

/** Where a panel appears. A panel with a title can be dragged, unless it is a dialog or in the
 *  middle. */
struct gz_panel_place {
	enum gz_panel_at at;
	float margin_top, margin_bottom; /**< kept free in addition to the usual margin */
	float width;                     /**< unscaled, limited by the window; 0: as needed */
	bool takes_keyboard; /**< it is a dialog: the first widget has the keyboard, and nothing
				below it can be clicked */
};

/** Mouse and keyboard on a canvas. */
struct gz_canvas {
	struct gz_place corner, size; /**< of its area */
	struct gz_place mouse;
	bool hovered;        /**< the mouse is over it */
	bool focused;        /**< it has the keyboard: clicked last, or reached by Tab */
	bool pressed;        /**< the left button went down on it since the last frame */
	bool double_pressed; /**< a double click */
	bool right_pressed;
	bool held;     /**< the left button went down on it and still is */
	bool released; /**< that button went up since the last frame */
	bool shift, control;
	float wheel;          /**< notches, up positive; 0 unless hovered */
	int arrow_x, arrow_y; /**< presses of the arrow keys, right and up positive; focused */
	int step;             /**< presses of Tab, with Shift negative; focused. Call
				 gz_widgets_focus_next() at the end of the canvas's points */
	bool delete_pressed;  /**< Delete or Backspace; focused */
	bool insert_pressed;  /**< Insert; focused */
};

/**
 * Set up Dear ImGui. The window's OpenGL context must be current. Callbacks that the window has are
 * kept and called first.
 *
 * @param scale  scale of the interface; 0: that of the display
 * @return false if Dear ImGui cannot be set up
 */
bool gz_widgets_init(struct GLFWwindow *window, double scale);

/** Take over the scale of the window's display, unless gz_widgets_init() was given one. Outside a
 *  frame. */
void gz_widgets_follow_scale(struct GLFWwindow *window);

/** Undo gz_widgets_init(); nothing if it was not called or failed. */
void gz_widgets_free(void);

/** Begin a frame. */
void gz_widgets_begin(void);

/** End the frame, which is laid out now, but not drawn. */
void gz_widgets_end(void);

/** A rectangle of the framebuffer, pixels from its lower left corner. It may reach beyond it. */
struct gz_pixel_rectangle {
	int left, bottom, width, height;
};

/** Most panels that cover what is beneath (chosen: more than there are). */
#define GZ_WIDGETS_COVERED_MAX 16

/** Where the frame that has ended hides all that is beneath: it need not be drawn there. May be
 *  asked between gz_widgets_end() and gz_widgets_draw(). @return the number of rectangles */
int gz_widgets_covered(struct gz_pixel_rectangle out_covered[GZ_WIDGETS_COVERED_MAX]);

/** Draw the frame that has ended over the content of the current framebuffer. */
void gz_widgets_draw(void);

/** Screen coordinates per unscaled one: 1, more on a display with small pixels. */
float gz_widgets_scale(void);

/** Size of the window. */
struct gz_place gz_widgets_room(void);

/** Height of a line of text. */
float gz_widgets_line_height(void);

/** Whether the mouse is over a panel or drags something of it, as of the last frame. */
bool gz_widgets_have_mouse(void);

/** Whether a panel lies at a place of the window, as of the last frame. Unlike
 *  gz_widgets_have_mouse() this is correct for a mouse that has moved since. */
bool gz_widgets_lie_at(float x, float y);

/** Whether a text field has the keyboard, as of the last frame: the window must not take keys. */
bool gz_widgets_have_text(void);

/** Whether keys navigate the panels, as of the last frame: the window must not take arrows, Tab,
 *  Space, Enter, Delete and Escape. */
bool gz_widgets_have_navigation(void);

/** Whether a dialog is open (struct gz_panel_place's takes_keyboard): the window must not take
 * keys, and nothing below the dialog can be clicked. */
bool gz_widgets_have_dialog(void);

/** Tell of a pressed key, so that short presses count too. @param key of GLFW */
void gz_widgets_note_key(int key);

/** Whether the mouse holds a widget, a text field is edited or an arrow key is held. All changes
 * until that ends are one step. */
bool gz_widgets_in_use(void);

/** From now on the mouse cursor stays as the window has it; else widgets show it in each frame.
 * After gz_widgets_init(). */
void gz_widgets_leave_cursor(void);

/** Take the keyboard from all widgets. */
void gz_widgets_release_keyboard(void);

/** Draw a line; thickness unscaled. */
void gz_draw_line(enum gz_layer layer, struct gz_place from, struct gz_place to,
		  struct gz_paint paint, float thickness);

/** Draw lines through @p count places; thickness unscaled. */
void gz_draw_lines(enum gz_layer layer, const struct gz_place *places, size_t count,
		   struct gz_paint paint, float thickness);

/** Draw a filled rectangle, its corners rounded by @p radius, unscaled. */
void gz_draw_rectangle(enum gz_layer layer, struct gz_place corner, struct gz_place opposite,
		       struct gz_paint paint, float radius);

/** Draw a filled rectangle that fades from its left colour to its right one. */
void gz_draw_fading_rectangle(enum gz_layer layer, struct gz_place corner, struct gz_place opposite,
			      struct gz_paint left, struct gz_paint right);

/** Draw a filled disc; radius unscaled. */
void gz_draw_disc(enum gz_layer layer, struct gz_place centre, float radius, struct gz_paint paint);

/** Draw a circle; radius and thickness unscaled. */
void gz_draw_circle(enum gz_layer layer, struct gz_place centre, float radius,
		    struct gz_paint paint, float thickness);

/** Draw a picture, the texture @p icon of view/draw/icon.h, between two corners. */
void gz_draw_icon(enum gz_layer layer, struct gz_place corner, struct gz_place opposite,
		  unsigned icon);

/** Draw a line of text, @p size times the usual size, its top left corner at @p at. */
void gz_draw_text(enum gz_layer layer, struct gz_place at, float size, struct gz_paint paint,
		  const char *text);

/** Size of a text, whose lines are separated by newlines. */
struct gz_place gz_text_room(float size, const char *text);

/** Draw lines of text on a dark ground, readable on any picture. @return lower right corner of the
 *  ground */
struct gz_place gz_draw_caption(enum gz_layer layer, struct gz_place at, struct gz_paint paint,
				const char *text);

/**
 * Begin a panel; call gz_panel_end() whatever this returns.
 *
 * @param title  unique; shown at its top unless it begins with "##"
 * @param[in,out] open  set to false when the panel's cross is clicked; NULL: it has no cross
 * @return false if its content is hidden, so that its widgets can be left out
 */
bool gz_panel_begin(const char *title, const struct gz_panel_place *place, bool *open);

/** Draw the panel that gz_panel_begin() began over all others, but not over menus and dialogs. */
void gz_panel_raise(void);

/** End the panel that gz_panel_begin() began. */
void gz_panel_end(void);

/** Put @p id before the ids of widgets until gz_widgets_pop_id(), so that equal ids differ. */
void gz_widgets_push_id(const char *id);

/** See gz_widgets_push_id(). */
void gz_widgets_pop_id(void);

/** If @p disabled, widgets until gz_widgets_enable() are grey and do nothing. Calls come in pairs.
 */
void gz_widgets_disable(bool disabled);

/** See gz_widgets_disable(). */
void gz_widgets_enable(void);

/** Put the next widget into the same line, @p share of the panel's width from the left; 0: right
 *  behind the last one. */
void gz_widgets_same_line(float share);

/** Width of the next widget, as a share of the panel; 0: the rest of the line. */
void gz_widgets_next_width(float share);

/** Give the keyboard to the next widget. */
void gz_widgets_focus_next(void);

/** Give the keyboard to the next canvas of the panel. */
void gz_widgets_focus_canvas(void);

/** Shorten a text to a share of the panel's width, with an ellipsis at its end, or at its beginning
 *  if the end is kept. */
void gz_widgets_elide(const char *text, float share, bool keep_end, char *out, size_t size);

/** A line between groups of widgets. */
void gz_widget_separator(void);

/** Text, wrapped at the panel's edge. */
void gz_widget_text(struct gz_paint paint, const char *text);

/** Text in one line, aligned with widgets beside it. */
void gz_widget_label(struct gz_paint paint, const char *text);

/** A text that appears while the mouse rests on the last widget, even a disabled one. */
void gz_widget_tooltip(const char *text);

/** Whether the last widget, which may be a text, was clicked. */
bool gz_widget_clicked(void);

/** A heading that folds what is below it. @return whether that is shown */
bool gz_widget_heading(const char *id, bool open_at_first);

/** A button. @return whether it was pressed */
bool gz_widget_button(const char *id);

/** A small button with an arrow to the left. @return whether it was pressed */
bool gz_widget_back_button(const char *id);

/** A box to tick. @return whether it was changed */
bool gz_widget_checkbox(const char *id, bool *value);

/** A box to tick, no higher than a line of text, for rows of a list. @return whether it was changed
 */
bool gz_widget_small_checkbox(const char *id, bool *value);

/** One of several. @param names NULL-terminated @return whether it was changed */
bool gz_widget_choice(const char *id, int *value, const char *const names[]);

/** A row of a list. @return whether it was clicked or Enter pressed on it */
bool gz_widget_row(const char *id, bool selected, bool *out_double_clicked);

/** A row of a list that its owner draws on, with GZ_LAYER_PANEL. */
struct gz_tall_row {
	float height;                 /**< unscaled */
	bool selected;                /**< it is marked */
	bool focused;                 /**< out: arrow keys have reached it */
	struct gz_place corner, size; /**< out: its area */
};

/** Such a row. @return whether it was clicked or Enter pressed on it */
bool gz_widget_tall_row(const char *id, struct gz_tall_row *row);

/** A row of two texts, the second @p width (unscaled) from the left. @param selected  it is marked
 *  @return whether it was clicked or Enter pressed on it */
bool gz_widget_pair_row(const char *id, float width, const char *left, const char *right,
			bool selected);

/** Begin @p count columns; widgets go into the first until gz_widget_columns_next(). */
void gz_widget_columns_begin(const char *id, int count);

/** Go on to the next column. */
void gz_widget_columns_next(void);

/** End the columns. */
void gz_widget_columns_end(void);

/** Begin a scrolling list, @p lines high, whose rows arrow keys reach; call gz_widget_list_end()
 *  whatever this returns. @return false if its content is hidden */
bool gz_widget_list_begin(const char *id, int lines);

/** End the list. */
void gz_widget_list_end(void);

/** How a number is edited. */
struct gz_number_range {
	double least, greatest; /**< limits, also for typed numbers */
	bool slider;            /**< a slider; else a drag changes it by @p speed per pixel */
	bool logarithmic;       /**< slider only; least above 0 */
	double speed;
	const char *format; /**< of printf, one number */
	const char *axes;   /**< a letter before each number: "xyz"; NULL: none */
};

/** Fields for @p count ints, 1 to 4. @return whether one was changed */
bool gz_widget_ints(const char *id, int *values, int count, const struct gz_number_range *range);

/** Fields for @p count doubles, 1 to 4. @return whether one was changed */
bool gz_widget_doubles(const char *id, double *values, int count,
		       const struct gz_number_range *range);

/** A field for red, green, blue, 0 to 1. @return whether it was changed */
bool gz_widget_colour(const char *id, double rgb[3]);

/**
 * A large colour field at the mouse, until a click elsewhere or Escape.
 *
 * @param open  show it from now on
 * @return whether @p rgb was changed
 */
bool gz_widget_colour_popup(const char *id, bool open, double rgb[3]);

/**
 * A field for a text of less than @p size bytes.
 *
 * @param by_enter  the text changes when Enter is pressed; else with each key
 * @return whether the text was changed, or Enter was pressed
 */
bool gz_widget_text_field(const char *id, char *text, size_t size, bool by_enter);

/** Whether Enter was pressed since the last frame. */
bool gz_widgets_enter_pressed(void);

/** Whether Enter was pressed in the last text field. */
bool gz_widget_entered(void);

/** Whether Enter was pressed and no widget of the dialog takes it. */
bool gz_dialog_entered(void);

/** Whether Escape was pressed. */
bool gz_dialog_escaped(void);

/** Presses of the arrow keys since the last frame, down positive. */
int gz_widgets_arrow_steps(void);

/** Scroll the panel so that the next widget is in its middle. */
void gz_widgets_scroll_here(void);

/** Unfold the next heading. */
void gz_widgets_unfold_next(void);

/** Begin the menu bar at the top of the window; call gz_menu_bar_end() whatever this returns.
 *  @return its height; 0: it is not shown */
float gz_menu_bar_begin(void);

/** A button at the right end of the bar, behind all menus. @return whether it was pressed */
bool gz_menu_bar_button(const char *text);

/** End the bar. */
void gz_menu_bar_end(void);

/** Begin a menu of the bar, or a submenu. @return whether it is open; only then call gz_menu_end()
 */
bool gz_menu_begin(const char *id);

/** End the menu. */
void gz_menu_end(void);

/** What a row of a menu shows. */
struct gz_menu_row {
	const char *name, *keys; /**< keys may be NULL */
	bool on;                 /**< it is marked */
	bool enabled;            /**< else it is grey */
};

/** A row of the open menu. @return whether it was chosen, which closes the menu */
bool gz_menu_choice(const struct gz_menu_row *row);

/** A line between rows of the open menu. */
void gz_menu_line(void);

/** Begin a menu at the mouse. @param open  show it from now on @return as gz_menu_begin(), but end
 *  it by gz_menu_popup_end() */
bool gz_menu_popup_begin(const char *id, bool open);

/** End that menu. */
void gz_menu_popup_end(void);

/** A small button in the upper right corner of the window, in no panel. @return whether it was
 *  pressed */
bool gz_corner_button(const char *text);

/** A progress bar with a text on it. @param share 0 to 1; below 0: not known */
void gz_widget_progress(double share, const char *text);

/** An area of @p height (unscaled) and the panel's width, to be drawn on with GZ_LAYER_PANEL. It
 * does not answer mouse and keyboard. */
void gz_widget_area(float height, struct gz_place *out_corner, struct gz_place *out_size);

/** Begin an area of @p height (unscaled) and the panel's width, to be drawn on with GZ_LAYER_PANEL
 * until gz_widget_canvas_end(). While it has the keyboard, arrows and Tab stay in it; Escape leaves
 * it. */
void gz_widget_canvas(const char *id, float height, struct gz_canvas *out_canvas);

/** End the canvas; widgets follow below it. */
void gz_widget_canvas_end(void);

#ifdef __cplusplus
}
#endif

#endif
