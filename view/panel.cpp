#include "view/panel.h"

#include <imgui.h>

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>

#include <GLFW/glfw3.h>

namespace
{

/* Pixels of the unscaled interface (chosen: as Dear ImGui's own style). */
constexpr float MARGIN = 8;
constexpr float PADDING = 5;
constexpr float CROSS_ARM = 12;

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

void gz_panel_draw(const struct gz_panel_content *content)
{
	ImGui_ImplOpenGL3_NewFrame();
	ImGui_ImplGlfw_NewFrame();
	ImGui::NewFrame();
	/* Straight into the draw list: a window would need a second frame to find its size. */
	ImDrawList *list = ImGui::GetForegroundDrawList();
	if (content->cross)
		draw_cross(list, content->cross_at[0], content->cross_at[1]);
	ImU32 colour = content->warn ? IM_COL32(255, 190, 60, 255) : IM_COL32(235, 235, 235, 255);
	float below = draw_text(list, MARGIN, content->line, colour);
	if (content->keys)
		draw_text(list, below + PADDING, content->keys, IM_COL32(235, 235, 235, 255));
	ImGui::Render();
	ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

void gz_panel_free(void)
{
	if (!ImGui::GetCurrentContext())
		return;
	ImGui_ImplOpenGL3_Shutdown();
	ImGui_ImplGlfw_Shutdown();
	ImGui::DestroyContext();
}
