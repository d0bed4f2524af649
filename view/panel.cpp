#include "view/panel.h"

#include <cfloat>
#include <cmath>
#include <cstring>

#include <imgui.h>

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>

#include <GLFW/glfw3.h>

#include "view/letters.h"
#include "view/panel_settings.h"

namespace
{

/* Pixels of the unscaled interface (chosen: as Dear ImGui's own style). */
constexpr float MARGIN = 8;
constexpr float PADDING = 5;
constexpr float CROSS_ARM = 12;
constexpr float LETTER_SCALE = 2;
constexpr float LETTER_MARGIN = 36; /* below the text line */
constexpr float MESSAGE_SCALE = 2;

float interface_scale(GLFWwindow *window)
{
	float x = 1, y = 1;
	glfwGetWindowContentScale(window, &x, &y);
	return x > 1 ? x : 1;
}

/* A text on a dark ground, so that it reads on any picture. Returns the lower edge. */
float draw_text(ImDrawList *list, float top, const char *text, ImU32 colour)
{
	ImVec2 size = ImGui::CalcTextSize(text);
	ImVec2 corner(MARGIN, top);
	ImVec2 opposite(corner.x + size.x + 2 * PADDING, corner.y + size.y + 2 * PADDING);
	list->AddRectFilled(corner, opposite, IM_COL32(0, 0, 0, 160), PADDING);
	list->AddText(ImVec2(corner.x + PADDING, corner.y + PADDING), colour, text);
	return opposite.y;
}

/* Light in dark, so that it shows on any picture. */
void draw_cross(ImDrawList *list, float x, float y)
{
	const struct {
		ImU32 colour;
		float thickness;
	} strokes[] = { { IM_COL32(0, 0, 0, 200), 5 }, { IM_COL32(255, 64, 64, 255), 3 } };
	for (const auto &stroke : strokes) {
		list->AddLine(ImVec2(x - CROSS_ARM, y), ImVec2(x + CROSS_ARM + 1, y), stroke.colour,
			      stroke.thickness);
		list->AddLine(ImVec2(x, y - CROSS_ARM), ImVec2(x, y + CROSS_ARM + 1), stroke.colour,
			      stroke.thickness);
	}
}

/* One of them at a place of the window: 0 at the left or top, 1 at the right or bottom. */
void draw_letter(ImDrawList *list, const char *text, float x, float y)
{
	ImFont *font = ImGui::GetFont();
	float height = LETTER_SCALE * ImGui::GetFontSize();
	ImVec2 room = ImGui::GetIO().DisplaySize;
	ImVec2 size = font->CalcTextSizeA(height, FLT_MAX, 0, text);
	ImVec2 at(floorf(MARGIN + x * (room.x - 2 * MARGIN - size.x)),
		  floorf(LETTER_MARGIN + y * (room.y - 2 * LETTER_MARGIN - size.y)));
	const ImVec2 around[] = { { -1, 0 }, { 1, 0 }, { 0, -1 }, { 0, 1 } };
	for (const ImVec2 &by : around)
		list->AddText(font, height, ImVec2(at.x + by.x, at.y + by.y),
			      IM_COL32(0, 0, 0, 255), text);
	list->AddText(font, height, at, IM_COL32(235, 235, 235, 255), text);
}

void draw_letters(ImDrawList *list, const gz_letters &letters)
{
	draw_letter(list, letters.left, 0, 0.5F);
	draw_letter(list, letters.right, 1, 0.5F);
	draw_letter(list, letters.top, 0.5F, 0);
	draw_letter(list, letters.bottom, 0.5F, 1);
}

void begin_frame()
{
	ImGui_ImplOpenGL3_NewFrame();
	ImGui_ImplGlfw_NewFrame();
	ImGui::NewFrame();
}

void end_frame()
{
	ImGui::Render();
	ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

} // namespace

bool gz_panel_init(GLFWwindow *window)
{
	IMGUI_CHECKVERSION();
	ImGui::CreateContext();
	ImGuiIO &io = ImGui::GetIO();
	io.IniFilename = nullptr; /* a viewer leaves no files behind */
	io.FontGlobalScale = interface_scale(window);
	if (!ImGui_ImplGlfw_InitForOpenGL(window, true)) {
		ImGui::DestroyContext();
		return false;
	}
	if (!ImGui_ImplOpenGL3_Init("#version 330 core")) {
		ImGui_ImplGlfw_Shutdown();
		ImGui::DestroyContext();
		return false;
	}
	return true;
}

bool gz_panel_draw(const struct gz_panel_content *content)
{
	begin_frame();
	float below_line = MARGIN + ImGui::GetFontSize() + 3 * PADDING;
	bool changed = content->settings && gz_panel_draw_settings(below_line, *content);
	/* Straight into the draw list: a window would need a second frame to find its size. */
	ImDrawList *list = ImGui::GetForegroundDrawList();
	if (content->letters)
		draw_letters(ImGui::GetBackgroundDrawList(), *content->letters);
	if (content->cross)
		draw_cross(list, content->cross_at[0], content->cross_at[1]);
	ImU32 colour = content->warn ? IM_COL32(255, 190, 60, 255) : IM_COL32(235, 235, 235, 255);
	float below = draw_text(list, MARGIN, content->line, colour);
	if (content->keys)
		draw_text(list, below + PADDING, content->keys, IM_COL32(235, 235, 235, 255));
	end_frame();
	return changed;
}

bool gz_panel_has_mouse(void)
{
	return ImGui::GetCurrentContext() && ImGui::GetIO().WantCaptureMouse;
}

bool gz_panel_has_keyboard(void)
{
	return ImGui::GetCurrentContext() && ImGui::GetIO().WantTextInput;
}

void gz_panel_draw_message(const char *text)
{
	begin_frame();
	ImDrawList *list = ImGui::GetForegroundDrawList();
	ImFont *font = ImGui::GetFont();
	float height = MESSAGE_SCALE * ImGui::GetFontSize();
	ImVec2 room = ImGui::GetIO().DisplaySize;
	float y = (room.y - font->CalcTextSizeA(height, FLT_MAX, 0, text).y) / 2;
	for (const char *line = text, *end; *line; line = *end ? end + 1 : end, y += height) {
		end = line + strcspn(line, "\n");
		float width = font->CalcTextSizeA(height, FLT_MAX, 0, line, end).x;
		list->AddText(font, height, ImVec2(floorf((room.x - width) / 2), floorf(y)),
			      IM_COL32(20, 20, 20, 255), line, end);
	}
	end_frame();
}

void gz_panel_free(void)
{
	if (!ImGui::GetCurrentContext())
		return;
	ImGui_ImplOpenGL3_Shutdown();
	ImGui_ImplGlfw_Shutdown();
	ImGui::DestroyContext();
}
