#include "view/panels/widgets.h"

#include <cfloat>
#include <cmath>
#include <cstdio>
#include <cstring>

#include <imgui.h>
#include <imgui_internal.h>

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>

#include <GLFW/glfw3.h>

#include <unistd.h>

#include "view/panels/panel_places.h"
#include "view/panels/panel_sheets.hpp"

namespace
{

/* Screen coordinates of the unscaled interface (chosen: as Dear ImGui's own style). */
constexpr float MARGIN = 8;
constexpr float PADDING = 5;
constexpr float PANEL_ALPHA = 0.85F;    /* of what lies on the picture without a title */
constexpr float PANEL_SHARE_MAX = 0.9F; /* of the window's width */

/* Frames after which Dear ImGui has answered a key. */
constexpr int FRAMES_TO_ANSWER = 4;

/* Height of a line of text, as of Dear ImGui's own font: panels have the same height with any font.
 */
constexpr float FONT_PX = 13;

/* Large text is drawn with a font of this many times the size. */
constexpr float LARGE = 2;

/* Where distributions keep a font with the characters below: Debian and Ubuntu, Fedora, Arch,
 * openSUSE. */
const char *const FONT_FILES[] = {
	"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
	"/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",
	"/usr/share/fonts/dejavu/DejaVuSans.ttf",
	"/usr/share/fonts/TTF/DejaVuSans.ttf",
	"/usr/share/fonts/truetype/DejaVuSans.ttf",
	"/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf",
	"/usr/share/fonts/truetype/noto/NotoSans-Regular.ttf",
};

/* From and to: Latin, Greek, Cyrillic, dashes and dots, primes, arrows, signs of comparison. */
const ImWchar GLYPHS[] = { 0x20,   0x17f,  0x386,  0x3ce,  0x400,  0x45f,  0x2010, 0x2026,
			   0x2032, 0x2033, 0x2190, 0x2193, 0x2248, 0x2265, 0 };

/* Size of the longest text that can be typed, a path with its NUL, bytes. */
constexpr size_t TEXT_SIZE = 4096;

/* Keys that canvases answer, and their GLFW codes. */
enum Key { LEFT, RIGHT, UP, DOWN, TAB, DELETE_KEY, BACKSPACE, INSERT, ESCAPE, KEYS };
constexpr int GLFW_KEYS[KEYS] = { GLFW_KEY_LEFT,      GLFW_KEY_RIGHT,  GLFW_KEY_UP,
				  GLFW_KEY_DOWN,      GLFW_KEY_TAB,    GLFW_KEY_DELETE,
				  GLFW_KEY_BACKSPACE, GLFW_KEY_INSERT, GLFW_KEY_ESCAPE };

/* Most keys that are remembered from one frame to the next (chosen: nobody presses more). */
constexpr int NOTED_MAX = 8;

/* State kept from frame to frame. */
struct Memory {
	int noted[NOTED_MAX]; /* of GLFW */
	int noted_count;
	bool held[NOTED_MAX];               /* down for this frame only */
	int presses[KEYS];                  /* since the last one, repetition included */
	bool dialog_drawn;                  /* in this frame so far */
	bool dialog_was_open;               /* in the last one */
	bool enter_pressed, escape_pressed; /* since the last one */
	int frames_since_tab;               /* Dear ImGui answers it after some */
	bool in_columns;
	bool in_bar;          /* the menu bar is being drawn */
	int opened;           /* number of panels opened so far */
	bool canvas_by_click; /* a click gave the canvas its keyboard */
	float scale;          /* of the fonts and the style there are */
	float asked_scale;    /* 0: what the display says */
	gz_panels::Sheets sheets;
};

Memory &memory()
{
	return *static_cast<Memory *>(ImGui::GetIO().UserData);
}

float interface_scale(GLFWwindow *window)
{
	float x = 1, y = 1;
	int width = 0, height = 0, width_px = 0, height_px = 0;
	if (memory().asked_scale > 0)
		return memory().asked_scale;
	glfwGetWindowContentScale(window, &x, &y);
	/* A screen coordinate may be several pixels already. */
	glfwGetWindowSize(window, &width, &height);
	glfwGetFramebufferSize(window, &width_px, &height_px);
	if (width > 0 && width_px > width)
		x *= static_cast<float>(width) / static_cast<float>(width_px);
	return x > 1 ? x : 1;
}

const char *font_file()
{
	for (const char *file : FONT_FILES)
		if (access(file, R_OK) == 0)
			return file;
	return nullptr;
}

/* Dear ImGui's own font is a bitmap, which looks right at whole multiples only. */
void add_font(const char *file, float px)
{
	ImFontConfig config;
	config.OversampleH = 2;
	if (file && ImGui::GetIO().Fonts->AddFontFromFileTTF(file, px, &config, GLYPHS))
		return;
	config.OversampleH = 1;
	config.PixelSnapH = true;
	config.SizePixels = FONT_PX * fmaxf(1, roundf(px / FONT_PX));
	ImGui::GetIO().Fonts->AddFontDefault(&config);
}

/* Fonts are rasterised at the size they are shown in; scaled letters would be blurred. */
void make_interface(float scale)
{
	const char *file = font_file();
	ImGui::GetIO().Fonts->Clear();
	add_font(file, roundf(FONT_PX * scale));
	add_font(file, roundf(LARGE * FONT_PX * scale));
	ImGui::GetStyle() = ImGuiStyle();
	ImGui::GetStyle().Colors[ImGuiCol_PopupBg].w = 1; /* no text shines through menus */
	ImGui::GetStyle().ScaleAllSizes(scale);
	memory().scale = scale;
}

/* The font whose letters are scaled least. */
ImFont *font_for(float size)
{
	const ImFontAtlas *fonts = ImGui::GetIO().Fonts;
	return fonts->Fonts[size > (1 + LARGE) / 2 ? 1 : 0];
}

ImVec2 vector_of(gz_place place)
{
	return ImVec2(place.x, place.y);
}

gz_place place_of(ImVec2 vector)
{
	return gz_place { vector.x, vector.y };
}

ImU32 colour(gz_paint paint)
{
	return IM_COL32(paint.red, paint.green, paint.blue, paint.alpha);
}

ImDrawList *list_of(gz_layer layer)
{
	switch (layer) {
	case GZ_LAYER_PANEL:
		return ImGui::GetWindowDrawList();
	case GZ_LAYER_TOP:
		return ImGui::GetForegroundDrawList();
	case GZ_LAYER_PICTURE:
		break;
	}
	return ImGui::GetBackgroundDrawList();
}

void set_panel_place(const gz_panel_place &place, bool movable)
{
	const float scale = gz_widgets_scale(), margin = MARGIN * scale;
	const ImVec2 room = ImGui::GetIO().DisplaySize;
	const float top = margin + place.margin_top, bottom = room.y - margin - place.margin_bottom;
	const bool right = place.at == GZ_PANEL_TOP_RIGHT || place.at == GZ_PANEL_BOTTOM_RIGHT;
	const bool low = place.at == GZ_PANEL_BOTTOM_LEFT || place.at == GZ_PANEL_BOTTOM_RIGHT;
	ImVec2 at(right ? room.x - margin : margin, low ? bottom : top);
	ImVec2 pivot(right ? 1.0F : 0.0F, low ? 1.0F : 0.0F);
	if (place.at == GZ_PANEL_MIDDLE) {
		at = ImVec2(room.x / 2, (place.margin_top + room.y - place.margin_bottom) / 2);
		pivot = ImVec2(0.5F, 0.5F);
	}
	ImGui::SetNextWindowPos(at, movable ? ImGuiCond_Appearing : ImGuiCond_Always, pivot);
	const float width_max = room.x * PANEL_SHARE_MAX;
	const float height_max = bottom > top ? bottom - top : 1;
	const float width = fminf(place.width * scale, width_max);
	ImGui::SetNextWindowSizeConstraints(ImVec2(width, 0),
					    ImVec2(width > 0 ? width : width_max, height_max));
}

/* Numbers of one type, with limits of that type. */
struct Numbers {
	ImGuiDataType type;
	void *values;
	int count;
	const void *least, *greatest;
};

bool draw_numbers(const char *id, const Numbers &numbers, const gz_number_range &range);

/* Each number in a field of its own, with its letter. */
bool draw_lettered_numbers(const char *id, const Numbers &numbers, const gz_number_range &range)
{
	const size_t size = numbers.type == ImGuiDataType_Double ? sizeof(double) : sizeof(int);
	gz_number_range alone = range;
	bool changed = false;
	char format[32];
	alone.axes = nullptr;
	alone.format = format;
	ImGui::PushID(id);
	ImGui::PushMultiItemsWidths(numbers.count, ImGui::CalcItemWidth());
	for (int i = 0; i < numbers.count; i++) {
		Numbers one = numbers;
		one.values = static_cast<char *>(numbers.values) + static_cast<size_t>(i) * size;
		one.count = 1;
		snprintf(format, sizeof format, "%c %s", range.axes[i], range.format);
		if (i > 0)
			ImGui::SameLine(0, ImGui::GetStyle().ItemInnerSpacing.x);
		ImGui::PushID(i);
		changed |= draw_numbers("", one, alone);
		ImGui::PopID();
		ImGui::PopItemWidth();
	}
	ImGui::PopID();
	return changed;
}

bool draw_numbers(const char *id, const Numbers &numbers, const gz_number_range &range)
{
	if (range.axes)
		return draw_lettered_numbers(id, numbers, range);
	ImGuiSliderFlags flags = ImGuiSliderFlags_AlwaysClamp;
	if (!range.slider)
		return ImGui::DragScalarN(id, numbers.type, numbers.values, numbers.count,
					  static_cast<float>(range.speed), numbers.least,
					  numbers.greatest, range.format, flags);
	if (range.logarithmic)
		flags |= ImGuiSliderFlags_Logarithmic;
	return ImGui::SliderScalarN(id, numbers.type, numbers.values, numbers.count, numbers.least,
				    numbers.greatest, range.format, flags);
}

void destroy_context()
{
	delete &memory();
	ImGui::DestroyContext();
}

/* A canvas is a child window without keyboard navigation; no other window is. */
bool canvas_has_keyboard()
{
	const ImGuiWindow *window = ImGui::GetCurrentContext()->NavWindow;
	return window && window->WasActive && (window->Flags & ImGuiWindowFlags_NoNavInputs);
}

/* The keyboard that a click gave the canvas is the picture's again while the mouse is over it. */
bool canvas_lends_keyboard()
{
	return memory().canvas_by_click && !ImGui::GetIO().WantCaptureMouse;
}

/* Under this name a panel remembers that its canvas gets the keyboard. */
ImGuiID focus_mark()
{
	return ImGui::GetID("##canvas has the keyboard");
}

/* Arrow keys navigate panels only after Tab or in a dialog. Otherwise a panel that is open or was
 * clicked would take them from the camera. */
void let_keys_lead()
{
	ImGuiIO &io = ImGui::GetIO();
	Memory &kept = memory();
	if (kept.frames_since_tab < FRAMES_TO_ANSWER)
		kept.frames_since_tab++;
	if (io.NavVisible || kept.dialog_drawn || kept.frames_since_tab < FRAMES_TO_ANSWER ||
	    ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopup))
		io.ConfigFlags |= ImGuiConfigFlags_NavEnableKeyboard;
	else
		io.ConfigFlags &= ~ImGuiConfigFlags_NavEnableKeyboard;
}

/* Dear ImGui before 1.87 samples keys once a frame. A key that was pressed and released in between
 * is held down for one frame, so that it counts. */
#if IMGUI_VERSION_NUM < 18700
void hold_brief_keys()
{
	Memory &kept = memory();
	for (int i = 0; i < kept.noted_count; i++) {
		bool &down = ImGui::GetIO().KeysDown[kept.noted[i]];
		kept.held[i] = !down;
		down = true;
	}
}

void let_go_of_brief_keys()
{
	Memory &kept = memory();
	for (int i = 0; i < kept.noted_count; i++)
		if (kept.held[i])
			ImGui::GetIO().KeysDown[kept.noted[i]] = false;
	kept.noted_count = 0;
}
#else
void hold_brief_keys()
{
}

void let_go_of_brief_keys()
{
	memory().noted_count = 0;
}
#endif

/* Enter on the focused widget; Dear ImGui itself answers Space only. */
bool entered_by_keys()
{
	return memory().enter_pressed && ImGui::GetIO().NavVisible && ImGui::IsItemFocused();
}

void read_keys(gz_canvas &canvas)
{
	const int *presses = memory().presses;
	canvas.arrow_x = presses[RIGHT] - presses[LEFT];
	canvas.arrow_y = presses[UP] - presses[DOWN];
	canvas.step = canvas.shift ? -presses[TAB] : presses[TAB];
	canvas.delete_pressed = presses[DELETE_KEY] > 0 || presses[BACKSPACE] > 0;
	canvas.insert_pressed = presses[INSERT] > 0;
	if (presses[ESCAPE] > 0)
		gz_widgets_release_keyboard();
}

/* A panel that others must not cover when they open. */
bool is_in_the_way(const ImGuiWindow *window, const ImGuiWindow *own)
{
	const int other = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove |
			  ImGuiWindowFlags_Popup | ImGuiWindowFlags_Tooltip |
			  ImGuiWindowFlags_ChildWindow;
	return window != own && window->WasActive && !(window->Flags & other);
}

/* What gz_panel_find_place() is told about panels that are shown. */
void list_others(const ImGuiWindow *own, gz_panel_placing &placing, ImGuiWindow **windows)
{
	for (ImGuiWindow *window : ImGui::GetCurrentContext()->Windows) {
		if (!is_in_the_way(window, own) || placing.count == GZ_PANEL_OTHERS_MAX)
			continue;
		const ImRect at = window->Collapsed ? window->TitleBarRect() : window->Rect();
		gz_panel_other &other = placing.others[placing.count];
		other = {};
		other.at = { at.Min.x, at.Min.y, at.GetWidth(), at.GetHeight() };
		other.title_height = window->TitleBarHeight();
		other.opened = *window->StateStorage.GetIntRef(ImHashStr("##opened"));
		other.folded = window->Collapsed;
		windows[placing.count++] = window;
	}
}

/* Fold those that have to make room. */
void fold_others(const gz_panel_placing &placing, ImGuiWindow **windows)
{
	for (int i = 0; i < placing.count; i++)
		if (placing.others[i].folded && !windows[i]->Collapsed) {
			const gz_panel_rectangle &at = placing.others[i].at;
			ImGui::SetWindowCollapsed(windows[i], true);
			ImGui::SetWindowPos(windows[i], ImVec2(at.x, at.y));
		}
}

void place_panel(const ImGuiWindow *own, const gz_panel_place &place)
{
	const float margin = MARGIN * gz_widgets_scale();
	const ImVec2 all = ImGui::GetIO().DisplaySize,
		     size = ImGui::CalcWindowNextAutoFitSize(const_cast<ImGuiWindow *>(own));
	const bool right = place.at == GZ_PANEL_TOP_RIGHT || place.at == GZ_PANEL_BOTTOM_RIGHT;
	const bool low = place.at == GZ_PANEL_BOTTOM_LEFT || place.at == GZ_PANEL_BOTTOM_RIGHT;
	ImGuiWindow *windows[GZ_PANEL_OTHERS_MAX];
	gz_panel_placing placing = {};
	float corner[2];
	placing.room = { margin, margin + place.margin_top, all.x - 2 * margin,
			 all.y - 2 * margin - place.margin_top - place.margin_bottom };
	placing.gap = margin;
	placing.width = size.x;
	placing.height = size.y;
	placing.wanted[0] = right ? all.x - margin - size.x : margin;
	placing.wanted[1] = low ? all.y - margin - place.margin_bottom - size.y : placing.room.y;
	list_others(own, placing, windows);
	gz_panel_find_place(&placing, corner);
	fold_others(placing, windows);
	ImGui::SetNextWindowPos(ImVec2(corner[0], corner[1]));
}

/* A panel that has opened moves to a free place, once: its size is known from its first frame, in
 * which it is not shown. */
void avoid_other_panels(const char *title, const gz_panel_place &place)
{
	ImGuiWindow *own = ImGui::FindWindowByName(title);
	if (!own)
		return;
	bool *placed = own->StateStorage.GetBoolRef(ImHashStr("##placed"));
	if (own->WasActive && !*placed) {
		own->StateStorage.SetInt(ImHashStr("##opened"), ++memory().opened);
		place_panel(own, place);
	}
	if (!own->WasActive) /* it opens, and may have been folded when it was closed */
		ImGui::SetNextWindowCollapsed(false);
	*placed = own->WasActive;
}

} // namespace

const gz_paint gz_paint_plain = { 235, 235, 235, 255 };
const gz_paint gz_paint_amber = { 255, 190, 60, 255 };
const gz_paint gz_paint_red = { 255, 96, 80, 255 };
const gz_paint gz_paint_ground = { 0, 0, 0, 160 };

bool gz_widgets_init(GLFWwindow *window, double scale)
{
	IMGUI_CHECKVERSION();
	ImGui::CreateContext();
	ImGuiIO &io = ImGui::GetIO();
	io.IniFilename = nullptr; /* a viewer leaves no files behind */
	io.UserData = new Memory {};
	io.ConfigFlags |= ImGuiConfigFlags_NavEnableKeyboard;
	memory().asked_scale = static_cast<float>(scale);
	make_interface(interface_scale(window));
	if (!ImGui_ImplGlfw_InitForOpenGL(window, true)) {
		destroy_context();
		return false;
	}
	if (!ImGui_ImplOpenGL3_Init("#version 330 core")) {
		ImGui_ImplGlfw_Shutdown();
		destroy_context();
		return false;
	}
	return true;
}

void gz_widgets_leave_cursor(void)
{
	if (ImGui::GetCurrentContext())
		ImGui::GetIO().ConfigFlags |= ImGuiConfigFlags_NoMouseCursorChange;
}

void gz_widgets_follow_scale(GLFWwindow *window)
{
	const float scale = interface_scale(window);
	if (!ImGui::GetCurrentContext() || scale == memory().scale)
		return;
	make_interface(scale);
	memory().sheets.free();
	ImGui_ImplOpenGL3_DestroyFontsTexture();
	ImGui_ImplOpenGL3_CreateFontsTexture();
}

void gz_widgets_free(void)
{
	if (!ImGui::GetCurrentContext())
		return;
	memory().sheets.free();
	ImGui_ImplOpenGL3_Shutdown();
	ImGui_ImplGlfw_Shutdown();
	destroy_context();
}

void gz_widgets_begin(void)
{
	ImGui_ImplOpenGL3_NewFrame();
	ImGui_ImplGlfw_NewFrame();
	let_keys_lead();
	hold_brief_keys();
	ImGui::NewFrame();
	memory().sheets.begin();
	memory().dialog_was_open = memory().dialog_drawn;
	memory().dialog_drawn = false;
}

void gz_widgets_end(void)
{
	ImGui::Render();
	let_go_of_brief_keys();
	memset(memory().presses, 0, sizeof memory().presses);
	memory().enter_pressed = memory().escape_pressed = false;
}

int gz_widgets_covered(gz_pixel_rectangle out_covered[GZ_WIDGETS_COVERED_MAX])
{
	return memory().sheets.covered(ImGui::GetDrawData(), out_covered);
}

void gz_widgets_draw(void)
{
	memory().sheets.draw(ImGui::GetDrawData());
}

float gz_widgets_scale(void)
{
	return memory().scale;
}

gz_place gz_widgets_room(void)
{
	return place_of(ImGui::GetIO().DisplaySize);
}

float gz_widgets_line_height(void)
{
	return ImGui::GetFontSize();
}

bool gz_widgets_have_mouse(void)
{
	return ImGui::GetCurrentContext() &&
	       (ImGui::GetIO().WantCaptureMouse || gz_widgets_have_dialog());
}

bool gz_widgets_lie_at(float x, float y)
{
	if (!ImGui::GetCurrentContext())
		return false;
	for (const ImGuiWindow *window : ImGui::GetCurrentContext()->Windows)
		if (window->WasActive && !(window->Flags & ImGuiWindowFlags_NoMouseInputs) &&
		    window->Rect().Contains(ImVec2(x, y)))
			return true;
	return false;
}

bool gz_widgets_have_text(void)
{
	return ImGui::GetCurrentContext() && ImGui::GetIO().WantTextInput;
}

bool gz_widgets_have_navigation(void)
{
	return ImGui::GetCurrentContext() &&
	       (ImGui::GetIO().NavVisible || (canvas_has_keyboard() && !canvas_lends_keyboard()) ||
		ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopup));
}

bool gz_widgets_in_use(void)
{
	static const ImGuiKey arrows[] = { ImGuiKey_LeftArrow, ImGuiKey_RightArrow,
					   ImGuiKey_UpArrow, ImGuiKey_DownArrow };
	for (const ImGuiKey key : arrows)
		if (ImGui::IsKeyDown(ImGui::GetKeyIndex(key)))
			return true;
	return ImGui::IsAnyItemActive();
}

bool gz_widgets_have_dialog(void)
{
	return ImGui::GetCurrentContext() && (memory().dialog_drawn || memory().dialog_was_open);
}

void gz_widgets_note_key(int key)
{
	if (!ImGui::GetCurrentContext())
		return;
	if (key == GLFW_KEY_ENTER || key == GLFW_KEY_KP_ENTER)
		memory().enter_pressed = true;
	if (key == GLFW_KEY_ESCAPE)
		memory().escape_pressed = true;
	if (key == GLFW_KEY_TAB)
		memory().frames_since_tab = 0;
	for (int i = 0; i < KEYS; i++)
		memory().presses[i] += key == GLFW_KEYS[i];
	Memory &kept = memory();
	if (key >= 0 && key <= GLFW_KEY_LAST && kept.noted_count < NOTED_MAX)
		kept.noted[kept.noted_count++] = key;
}

void gz_widgets_release_keyboard(void)
{
	ImGui::SetWindowFocus(nullptr);
}

void gz_draw_line(gz_layer layer, gz_place from, gz_place to, gz_paint paint, float thickness)
{
	list_of(layer)->AddLine(vector_of(from), vector_of(to), colour(paint),
				thickness * gz_widgets_scale());
}

void gz_draw_lines(gz_layer layer, const gz_place *places, size_t count, gz_paint paint,
		   float thickness)
{
	for (size_t i = 0; i < count; i++)
		list_of(layer)->PathLineTo(vector_of(places[i]));
	list_of(layer)->PathStroke(colour(paint), 0, thickness * gz_widgets_scale());
}

void gz_draw_rectangle(gz_layer layer, gz_place corner, gz_place opposite, gz_paint paint,
		       float radius)
{
	list_of(layer)->AddRectFilled(vector_of(corner), vector_of(opposite), colour(paint),
				      radius * gz_widgets_scale());
}

void gz_draw_fading_rectangle(gz_layer layer, gz_place corner, gz_place opposite, gz_paint left,
			      gz_paint right)
{
	list_of(layer)->AddRectFilledMultiColor(vector_of(corner), vector_of(opposite),
						colour(left), colour(right), colour(right),
						colour(left));
}

void gz_draw_disc(gz_layer layer, gz_place centre, float radius, gz_paint paint)
{
	list_of(layer)->AddCircleFilled(vector_of(centre), radius * gz_widgets_scale(),
					colour(paint));
}

void gz_draw_circle(gz_layer layer, gz_place centre, float radius, gz_paint paint, float thickness)
{
	const float scale = gz_widgets_scale();
	list_of(layer)->AddCircle(vector_of(centre), radius * scale, colour(paint), 0,
				  thickness * scale);
}

void gz_draw_icon(gz_layer layer, gz_place corner, gz_place opposite, unsigned icon)
{
	list_of(layer)->AddImage((ImTextureID)(intptr_t)icon, vector_of(corner),
				 vector_of(opposite));
}

void gz_draw_text(gz_layer layer, gz_place at, float size, gz_paint paint, const char *text)
{
	list_of(layer)->AddText(font_for(size), size * ImGui::GetFontSize(), vector_of(at),
				colour(paint), text);
}

gz_place gz_text_room(float size, const char *text)
{
	return place_of(
		font_for(size)->CalcTextSizeA(size * ImGui::GetFontSize(), FLT_MAX, 0, text));
}

gz_place gz_draw_caption(gz_layer layer, gz_place at, gz_paint paint, const char *text)
{
	const float padding = PADDING * gz_widgets_scale();
	const gz_place size = gz_text_room(1, text);
	const gz_place opposite = { at.x + size.x + 2 * padding, at.y + size.y + 2 * padding };
	gz_draw_rectangle(layer, at, opposite, gz_paint_ground, PADDING);
	gz_draw_text(layer, gz_place { at.x + padding, at.y + padding }, 1, paint, text);
	return opposite;
}

/* Begin a panel on an opaque ground if it has a title and is not folded. */
static bool begin_on_ground(const char *title, bool *open, int flags)
{
	const bool opaque = !(flags & ImGuiWindowFlags_NoTitleBar) && memory().sheets.has_room();
	ImGui::SetNextWindowBgAlpha(opaque ? 0 : PANEL_ALPHA);
	const bool shown = ImGui::Begin(title, open, flags);
	if (opaque && shown)
		memory().sheets.add(ImGui::GetCurrentWindow());
	return shown;
}

bool gz_panel_begin(const char *title, const gz_panel_place *place, bool *open)
{
	int flags = ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings;
	const bool titled = strncmp(title, "##", 2) != 0;
	const bool movable = titled && !place->takes_keyboard && place->at != GZ_PANEL_MIDDLE;
	if (!titled)
		flags |= ImGuiWindowFlags_NoTitleBar;
	if (!movable)
		flags |= ImGuiWindowFlags_NoMove;
	set_panel_place(*place, movable);
	if (movable)
		avoid_other_panels(title, *place);
	if (!place->takes_keyboard)
		return begin_on_ground(title, open, flags | ImGuiWindowFlags_NoFocusOnAppearing);
	memory().dialog_drawn = true;
	const ImVec2 room = ImGui::GetIO().DisplaySize;
	list_of(GZ_LAYER_PICTURE)->AddRectFilled(ImVec2(0, 0), room, IM_COL32(0, 0, 0, 110));
	return begin_on_ground(title, open, flags | ImGuiWindowFlags_NoCollapse);
}

void gz_panel_raise(void)
{
	if (!gz_widgets_have_dialog() && !ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopup))
		ImGui::BringWindowToDisplayFront(ImGui::GetCurrentWindow());
}

void gz_panel_end(void)
{
	ImGui::End();
}

void gz_widgets_push_id(const char *id)
{
	ImGui::PushID(id);
}

void gz_widgets_pop_id(void)
{
	ImGui::PopID();
}

void gz_widgets_disable(bool disabled)
{
	ImGui::BeginDisabled(disabled);
}

void gz_widgets_enable(void)
{
	ImGui::EndDisabled();
}

void gz_widgets_same_line(float share)
{
	ImGui::SameLine(ImGui::GetWindowContentRegionMax().x * share);
}

void gz_widgets_next_width(float share)
{
	ImGui::SetNextItemWidth(share > 0 ? ImGui::GetWindowContentRegionMax().x * share
					  : -FLT_MIN);
}

void gz_widgets_focus_next(void)
{
	ImGui::SetKeyboardFocusHere();
}

void gz_widgets_focus_canvas(void)
{
	ImGui::GetStateStorage()->SetBool(focus_mark(), true);
}

/* Bytes of a character of UTF-8 that follow its first one. */
static bool follows_in_character(char byte)
{
	return (byte & 0xc0) == 0x80;
}

void gz_widgets_elide(const char *text, float share, bool keep_end, char *out, size_t size)
{
	const float width = ImGui::GetWindowContentRegionMax().x * share;
	const size_t length = strlen(text);
	size_t from = 0, to = length;
	snprintf(out, size, "%s", text);
	while (to > from && ImGui::CalcTextSize(out).x > width) {
		do {
			if (keep_end)
				from++;
			else
				to--;
		} while (from < to && follows_in_character(text[keep_end ? from : to]));
		snprintf(out, size, "%s%.*s%s", keep_end ? "…" : "", static_cast<int>(to - from),
			 text + from, keep_end ? "" : "…");
	}
}

void gz_widget_separator(void)
{
	ImGui::Separator();
}

void gz_widget_text(gz_paint paint, const char *text)
{
	ImGui::PushStyleColor(ImGuiCol_Text, colour(paint));
	ImGui::PushTextWrapPos(0);
	ImGui::TextUnformatted(text);
	ImGui::PopTextWrapPos();
	ImGui::PopStyleColor();
}

void gz_widget_label(gz_paint paint, const char *text)
{
	ImGui::PushStyleColor(ImGuiCol_Text, colour(paint));
	ImGui::AlignTextToFramePadding();
	ImGui::TextUnformatted(text);
	ImGui::PopStyleColor();
}

void gz_widget_tooltip(const char *text)
{
	if (ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled))
		ImGui::SetTooltip("%s", text);
}

bool gz_widget_clicked(void)
{
	return ImGui::IsItemClicked();
}

bool gz_widget_heading(const char *id, bool open_at_first)
{
	return ImGui::CollapsingHeader(id, open_at_first ? ImGuiTreeNodeFlags_DefaultOpen : 0);
}

bool gz_widget_button(const char *id)
{
	return ImGui::Button(id) || entered_by_keys();
}

bool gz_widget_back_button(const char *id)
{
	return ImGui::ArrowButton(id, ImGuiDir_Left) || entered_by_keys();
}

bool gz_widget_checkbox(const char *id, bool *value)
{
	return ImGui::Checkbox(id, value);
}

bool gz_widget_small_checkbox(const char *id, bool *value)
{
	ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, ImVec2(0, 0));
	const bool changed = ImGui::Checkbox(id, value);
	ImGui::PopStyleVar();
	return changed;
}

bool gz_widget_choice(const char *id, int *value, const char *const names[])
{
	int count = 0;
	while (names[count])
		count++;
	return ImGui::Combo(id, value, names, count);
}

bool gz_widget_row(const char *id, bool selected, bool *out_double_clicked)
{
	const bool chosen =
		ImGui::Selectable(id, selected, ImGuiSelectableFlags_AllowDoubleClick) ||
		entered_by_keys();
	if (out_double_clicked)
		*out_double_clicked = chosen && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left);
	return chosen;
}

bool gz_widget_tall_row(const char *id, gz_tall_row *row)
{
	const ImVec2 size(0, row->height * gz_widgets_scale());
	row->corner = place_of(ImGui::GetCursorScreenPos());
	const bool chosen = ImGui::Selectable(id, row->selected, 0, size) || entered_by_keys();
	row->size = place_of(ImGui::GetItemRectSize());
	row->focused = ImGui::GetIO().NavVisible && ImGui::IsItemFocused();
	return chosen;
}

bool gz_widget_pair_row(const char *id, float width, const char *left, const char *right,
			bool selected)
{
	const float start = ImGui::GetCursorPosX();
	const bool chosen = ImGui::Selectable(id, selected);
	ImGui::SameLine();
	ImGui::SetCursorPosX(start);
	ImGui::TextUnformatted(left);
	ImGui::SameLine();
	ImGui::SetCursorPosX(start + width * gz_widgets_scale());
	ImGui::TextUnformatted(right);
	return chosen;
}

void gz_widget_columns_begin(const char *id, int count)
{
	memory().in_columns = ImGui::BeginTable(id, count, ImGuiTableFlags_SizingStretchSame);
	gz_widget_columns_next();
}

void gz_widget_columns_next(void)
{
	if (memory().in_columns)
		ImGui::TableNextColumn();
}

void gz_widget_columns_end(void)
{
	if (memory().in_columns)
		ImGui::EndTable();
}

bool gz_widget_list_begin(const char *id, int lines)
{
	const float height = static_cast<float>(lines) * ImGui::GetTextLineHeightWithSpacing();
	return ImGui::BeginChild(id, ImVec2(0, height), true, ImGuiWindowFlags_NavFlattened);
}

void gz_widget_list_end(void)
{
	ImGui::EndChild();
}

bool gz_widget_ints(const char *id, int *values, int count, const gz_number_range *range)
{
	const int least = static_cast<int>(range->least);
	const int greatest = static_cast<int>(range->greatest);
	return draw_numbers(id, { ImGuiDataType_S32, values, count, &least, &greatest }, *range);
}

bool gz_widget_doubles(const char *id, double *values, int count, const gz_number_range *range)
{
	return draw_numbers(
		id, { ImGuiDataType_Double, values, count, &range->least, &range->greatest },
		*range);
}

static void to_shown(const double rgb[3], float shown[3])
{
	for (int i = 0; i < 3; i++)
		shown[i] = static_cast<float>(rgb[i]);
}

static bool from_shown(const float shown[3], double rgb[3])
{
	for (int i = 0; i < 3; i++)
		rgb[i] = shown[i] < 0 ? 0 : shown[i] > 1 ? 1 : static_cast<double>(shown[i]);
	return true;
}

bool gz_widget_colour(const char *id, double rgb[3])
{
	float shown[3];
	to_shown(rgb, shown);
	return ImGui::ColorEdit3(id, shown, ImGuiColorEditFlags_Float) && from_shown(shown, rgb);
}

bool gz_widget_colour_popup(const char *id, bool open, double rgb[3])
{
	float shown[3];
	to_shown(rgb, shown);
	if (open)
		ImGui::OpenPopup(id);
	if (!ImGui::BeginPopup(id))
		return false;
	const bool changed = ImGui::ColorPicker3("##colour", shown, ImGuiColorEditFlags_Float);
	ImGui::EndPopup();
	return changed && from_shown(shown, rgb);
}

/* Dear ImGui keeps what is typed until Enter is pressed; @p text changes then. */
bool gz_widget_text_field(const char *id, char *text, size_t size, bool by_enter)
{
	char typed[TEXT_SIZE];
	if (size > sizeof typed)
		return false;
	snprintf(typed, size, "%s", text);
	if (!ImGui::InputText(id, typed, size, by_enter ? ImGuiInputTextFlags_EnterReturnsTrue : 0))
		return false;
	snprintf(text, size, "%s", typed);
	return true;
}

bool gz_widgets_enter_pressed(void)
{
	return memory().enter_pressed;
}

bool gz_widget_entered(void)
{
	return memory().enter_pressed && (ImGui::IsItemActive() || ImGui::IsItemDeactivated());
}

bool gz_dialog_entered(void)
{
	const ImGuiIO &io = ImGui::GetIO();
	return memory().enter_pressed && !io.NavVisible && !io.WantTextInput;
}

bool gz_dialog_escaped(void)
{
	return memory().escape_pressed;
}

int gz_widgets_arrow_steps(void)
{
	return memory().presses[DOWN] - memory().presses[UP];
}

void gz_widgets_scroll_here(void)
{
	ImGui::SetScrollHereY();
}

void gz_widgets_unfold_next(void)
{
	ImGui::SetNextItemOpen(true);
}

float gz_menu_bar_begin(void)
{
	memory().in_bar = ImGui::BeginMainMenuBar();
	return memory().in_bar ? ImGui::GetWindowHeight() : 0;
}

bool gz_menu_bar_button(const char *text)
{
	const ImGuiStyle &style = ImGui::GetStyle();
	const float width = ImGui::CalcTextSize(text).x + style.ItemSpacing.x;
	const float left = ImGui::GetWindowWidth() - width - style.WindowPadding.x;
	if (left < ImGui::GetCursorPosX()) /* the window is too narrow */
		return false;
	ImGui::SetCursorPosX(left);
	return ImGui::MenuItem(text);
}

void gz_menu_bar_end(void)
{
	if (memory().in_bar)
		ImGui::EndMainMenuBar();
}

bool gz_menu_begin(const char *id)
{
	return ImGui::BeginMenu(id);
}

void gz_menu_end(void)
{
	ImGui::EndMenu();
}

bool gz_menu_choice(const gz_menu_row *row)
{
	return ImGui::MenuItem(row->name, row->keys, row->on, row->enabled);
}

void gz_menu_line(void)
{
	ImGui::Separator();
}

bool gz_menu_popup_begin(const char *id, bool open)
{
	if (open)
		ImGui::OpenPopup(id);
	return ImGui::BeginPopup(id);
}

void gz_menu_popup_end(void)
{
	ImGui::EndPopup();
}

bool gz_corner_button(const char *text)
{
	const float margin = MARGIN * gz_widgets_scale();
	ImGui::SetNextWindowPos(ImVec2(ImGui::GetIO().DisplaySize.x - margin, margin),
				ImGuiCond_Always, ImVec2(1, 0));
	ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0, 0));
	ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 0);
	ImGui::Begin("##corner", nullptr,
		     ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize |
			     ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoMove |
			     ImGuiWindowFlags_NoBackground | ImGuiWindowFlags_NoFocusOnAppearing);
	const bool pressed = ImGui::SmallButton(text);
	ImGui::End();
	ImGui::PopStyleVar(2);
	return pressed;
}

void gz_widget_progress(double share, const char *text)
{
	ImGui::ProgressBar(share < 0 ? 0 : static_cast<float>(share), ImVec2(-FLT_MIN, 0), text);
}

void gz_widget_area(float height, gz_place *out_corner, gz_place *out_size)
{
	const ImVec2 size(fmaxf(1, ImGui::GetContentRegionAvail().x), height * gz_widgets_scale());
	*out_corner = place_of(ImGui::GetCursorScreenPos());
	*out_size = place_of(size);
	ImGui::Dummy(size);
}

void gz_widget_canvas(const char *id, float height, gz_canvas *out_canvas)
{
	const ImGuiIO &io = ImGui::GetIO();
	const ImVec2 size(fmaxf(1, ImGui::GetContentRegionAvail().x), height * gz_widgets_scale());
	bool *take = ImGui::GetStateStorage()->GetBoolRef(focus_mark());
	ImGui::BeginChild(id, size, false,
			  ImGuiWindowFlags_NoNavInputs | ImGuiWindowFlags_NoScrollbar |
				  ImGuiWindowFlags_NoScrollWithMouse);
	const ImVec2 corner = ImGui::GetCursorScreenPos();
	ImGui::InvisibleButton(id, size);
	if (*take)
		ImGui::SetFocusID(ImGui::GetItemID(), ImGui::GetCurrentWindow());
	if (*take)
		ImGui::SetWindowFocus();
	if (*take)
		memory().canvas_by_click = false;
	*take = false;
	gz_canvas canvas = {};
	canvas.corner = place_of(corner);
	canvas.size = place_of(size);
	canvas.mouse = place_of(io.MousePos);
	canvas.hovered = ImGui::IsItemHovered();
	canvas.focused = ImGui::IsWindowFocused();
	canvas.pressed = ImGui::IsItemActivated() && ImGui::IsMouseDown(ImGuiMouseButton_Left);
	canvas.double_pressed =
		canvas.hovered && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left);
	canvas.right_pressed = canvas.hovered && ImGui::IsMouseClicked(ImGuiMouseButton_Right);
	canvas.held = ImGui::IsItemActive();
	canvas.released = ImGui::IsItemDeactivated();
	canvas.shift = io.KeyShift;
	canvas.control = io.KeyCtrl;
	canvas.wheel = canvas.hovered ? io.MouseWheel : 0;
	if (canvas.pressed || canvas.right_pressed)
		memory().canvas_by_click = true;
	if (canvas.focused && !canvas_lends_keyboard())
		read_keys(canvas);
	*out_canvas = canvas;
}

void gz_widget_canvas_end(void)
{
	ImGui::EndChild();
}
