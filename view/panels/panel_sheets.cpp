#include "view/panels/panel_sheets.hpp"

#include <cmath>
#include <cstring>

#include <imgui_internal.h>

#include <backends/imgui_impl_opengl3.h>

#include <GL/glew.h>

using gz_panels::Content;
using gz_panels::Sheet;

namespace
{

/* Lists of one frame that are drawn by one call (chosen: panels, their children, and marks). */
constexpr int RUN_MAX = 64;

/* Lists that wait to be drawn, in their order. */
struct Run {
	ImDrawList *lists[RUN_MAX];
	int count;
};

template <typename Item> bool same(const ImVector<Item> &a, const ImVector<Item> &b)
{
	return a.Size == b.Size &&
	       (a.Size == 0 || memcmp(a.Data, b.Data, static_cast<size_t>(a.size_in_bytes())) == 0);
}

bool is_content(const Content &content, const ImDrawList &list)
{
	return same(content.vertices, list.VtxBuffer) && same(content.indices, list.IdxBuffer) &&
	       same(content.commands, list.CmdBuffer);
}

/* What shows other textures than letters may change without its list. */
bool is_of_letters(const ImDrawList &list)
{
	for (const ImDrawCmd &command : list.CmdBuffer)
		if (command.UserCallback || command.GetTexID() != ImGui::GetIO().Fonts->TexID)
			return false;
	return true;
}

/* The pixels that a window touches. Lists are drawn there at the same places as without a sheet. */
gz_pixel_rectangle place_of_window(const ImGuiWindow *window, const ImDrawData *data)
{
	const ImVec2 scale = data->FramebufferScale;
	const ImRect room = window->Rect();
	const int left = static_cast<int>(floorf((room.Min.x - data->DisplayPos.x) * scale.x));
	const int right = static_cast<int>(ceilf((room.Max.x - data->DisplayPos.x) * scale.x));
	const int top = static_cast<int>(floorf((room.Min.y - data->DisplayPos.y) * scale.y));
	const int bottom = static_cast<int>(ceilf((room.Max.y - data->DisplayPos.y) * scale.y));
	const int height = static_cast<int>(data->DisplaySize.y * scale.y);
	return gz_pixel_rectangle { left, height - bottom, right - left, bottom - top };
}

bool is_same_place(const gz_pixel_rectangle &a, const gz_pixel_rectangle &b)
{
	return a.left == b.left && a.bottom == b.bottom && a.width == b.width &&
	       a.height == b.height;
}

void set_clear_colour()
{
	const ImVec4 ground = ImGui::GetStyle().Colors[ImGuiCol_WindowBg];
	glClearColor(ground.x, ground.y, ground.z, 1);
}

void clear_place(const gz_pixel_rectangle &place)
{
	glEnable(GL_SCISSOR_TEST);
	glScissor(place.left, place.bottom, place.width, place.height);
	set_clear_colour();
	glClear(GL_COLOR_BUFFER_BIT);
	glDisable(GL_SCISSOR_TEST);
}

/* Draw some lists of a frame. */
void draw_lists(const ImDrawData *data, ImDrawList **lists, int count)
{
	ImDrawData some = *data;
#if IMGUI_VERSION_NUM >= 18980
	some.CmdLists.resize(0);
	for (int i = 0; i < count; i++)
		some.CmdLists.push_back(lists[i]);
#else
	some.CmdLists = lists;
#endif
	some.CmdListsCount = count;
	if (count > 0)
		ImGui_ImplOpenGL3_RenderDrawData(&some);
}

void draw_run(const ImDrawData *data, Run &run)
{
	draw_lists(data, run.lists, run.count);
	run.count = 0;
}

void free_sheet(Sheet &sheet)
{
	if (sheet.texture)
		glDeleteTextures(1, &sheet.texture);
	if (sheet.framebuffer)
		glDeleteFramebuffers(1, &sheet.framebuffer);
	sheet.texture = sheet.framebuffer = 0;
	sheet.drawn = false;
}

/* Make the texture of a sheet. @return false if the driver refuses */
bool make_texture(Sheet &sheet)
{
	free_sheet(sheet);
	glGenTextures(1, &sheet.texture);
	glBindTexture(GL_TEXTURE_2D, sheet.texture);
	glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, sheet.place.width, sheet.place.height, 0, GL_RGBA,
		     GL_UNSIGNED_BYTE, nullptr);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
	glGenFramebuffers(1, &sheet.framebuffer);
	glBindFramebuffer(GL_FRAMEBUFFER, sheet.framebuffer);
	glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, sheet.texture,
			       0);
	return glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
}

/* Draw a panel into its texture. */
void draw_texture(const ImDrawData *data, Sheet &sheet, ImDrawList *list)
{
	ImDrawData moved = *data;
	const ImVec2 scale = data->FramebufferScale;
	const float height = data->DisplaySize.y * scale.y;
	const float top = height - static_cast<float>(sheet.place.bottom + sheet.place.height);
	moved.DisplayPos.x += static_cast<float>(sheet.place.left) / scale.x;
	moved.DisplayPos.y += top / scale.y;
	moved.DisplaySize = ImVec2(static_cast<float>(sheet.place.width) / scale.x,
				   static_cast<float>(sheet.place.height) / scale.y);
	GLint target = 0;
	glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &target);
	if (make_texture(sheet)) {
		set_clear_colour();
		glClear(GL_COLOR_BUFFER_BIT);
		draw_lists(&moved, &list, 1);
		sheet.drawn = true;
	}
	glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(target));
}

void copy_texture(const Sheet &sheet)
{
	const gz_pixel_rectangle &at = sheet.place;
	glDisable(GL_SCISSOR_TEST);
	glBindFramebuffer(GL_READ_FRAMEBUFFER, sheet.framebuffer);
	glBlitFramebuffer(0, 0, at.width, at.height, at.left, at.bottom, at.left + at.width,
			  at.bottom + at.height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
	glBindFramebuffer(GL_READ_FRAMEBUFFER, 0); /* nobody else reads from another one */
}

/* Keep what a list draws. @return whether it is what it was in the last frame */
bool keep_content(Sheet &sheet, const ImDrawList &list, const gz_pixel_rectangle &place)
{
	if (is_content(sheet.content, list) && is_same_place(sheet.place, place))
		return true;
	sheet.content.vertices = list.VtxBuffer;
	sheet.content.indices = list.IdxBuffer;
	sheet.content.commands = list.CmdBuffer;
	sheet.place = place;
	sheet.drawn = false;
	return false;
}

bool is_shown(const ImGuiWindow *window)
{
	return window->Active && !window->Hidden;
}

void draw_panel(const ImDrawData *data, Sheet &sheet, ImDrawList *list, Run &run)
{
	const gz_pixel_rectangle place = place_of_window(sheet.window, data);
	const bool rests = keep_content(sheet, *list, place) && is_of_letters(*list);
	draw_run(data, run);
	if (rests && !sheet.drawn)
		draw_texture(data, sheet, list);
	if (rests && sheet.drawn) {
		copy_texture(sheet);
		return;
	}
	clear_place(place);
	run.lists[run.count++] = list;
}

} // namespace

void gz_panels::Sheets::begin()
{
	for (Sheet &sheet : sheets)
		sheet.in_frame = false;
}

bool gz_panels::Sheets::has_room() const
{
	int count = 0;
	for (const Sheet &sheet : sheets)
		count += sheet.in_frame;
	return count < GZ_WIDGETS_COVERED_MAX;
}

void gz_panels::Sheets::add(ImGuiWindow *window)
{
	Sheet *place = nullptr;
	for (Sheet &sheet : sheets)
		if (sheet.window == window || (!place && !sheet.in_frame))
			place = &sheet;
	if (place->window != window)
		free_sheet(*place);
	place->window = window;
	place->in_frame = true;
}

int gz_panels::Sheets::covered(const ImDrawData *data, gz_pixel_rectangle *out) const
{
	int count = 0;
	for (const Sheet &sheet : sheets)
		if (sheet.in_frame && is_shown(sheet.window))
			out[count++] = place_of_window(sheet.window, data);
	return count;
}

Sheet *gz_panels::Sheets::of_list(const ImDrawList *list)
{
	for (Sheet &sheet : sheets)
		if (sheet.in_frame && sheet.window->DrawList == list)
			return &sheet;
	return nullptr;
}

void gz_panels::Sheets::draw(ImDrawData *data)
{
	Run run = {};
	for (int i = 0; i < data->CmdListsCount; i++) {
		ImDrawList *list = data->CmdLists[i];
		Sheet *sheet = of_list(list);
		if (run.count == RUN_MAX)
			draw_run(data, run);
		if (sheet)
			draw_panel(data, *sheet, list, run);
		else
			run.lists[run.count++] = list;
	}
	draw_run(data, run);
}

void gz_panels::Sheets::free()
{
	for (Sheet &sheet : sheets) {
		free_sheet(sheet);
		sheet.in_frame = false;
		sheet.window = nullptr;
	}
}
