#include "view/panels/open_panel.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "view/panels/widgets.h"

/* Unscaled (chosen: a path of usual length is seen whole). */
#define WIDTH 620.0f
/* What is above and below the list, unscaled, and what a line of it takes. */
#define AROUND_LIST 190.0f
#define LINE_HEIGHT 1.35f

enum { LINES_LEAST = 3, LINES_MOST = 18, LABEL_SIZE = GZ_FOLDER_NAME_SIZE + 64 };

/* Another folder; the present one stays where that cannot be read, and the dialog says why. */
static void enter(struct gz_open_panel *panel, const char *path)
{
	panel->message[0] = '\0';
	if (gz_folder_read(path, &panel->filter, &panel->folder, panel->message,
			   sizeof panel->message) != GZ_OK)
		return;
	panel->typed[0] = '\0';
	panel->focus_wanted = true;
}

void gz_open_panel_show(struct gz_open_panel *panel, const char *folder,
			const struct gz_recent *recent)
{
	const char *home = getenv("HOME");
	const char *const places[] = { folder, home ? home : "/", "/" };
	panel->open = panel->focus_wanted = true;
	panel->recent = recent;
	panel->typed[0] = panel->message[0] = '\0';
	for (size_t i = 0; i < sizeof places / sizeof places[0]; i++)
		if (gz_folder_read(places[i], &panel->filter, &panel->folder, panel->message,
				   sizeof panel->message) == GZ_OK)
			return;
}

static bool is_folder(const char *path)
{
	struct stat status;
	return stat(path, &status) == 0 && S_ISDIR(status.st_mode);
}

/* A folder is entered, a file is what was looked for. */
static bool take(struct gz_open_panel *panel, const char *name, char out_path[GZ_PATH_SIZE])
{
	struct stat status;
	panel->message[0] = '\0';
	if (gz_folder_path_of(&panel->folder, name, out_path) != GZ_OK) {
		snprintf(panel->message, sizeof panel->message, "the path is too long");
		return false;
	}
	if (is_folder(out_path)) {
		enter(panel, out_path);
		return false;
	}
	if (stat(out_path, &status) == 0)
		return true;
	snprintf(panel->message, sizeof panel->message, "%.200s: there is no such file", out_path);
	return false;
}

/* Enter in the field: what is typed, if it is there, else the entry that it stands for. */
static bool take_typed(struct gz_open_panel *panel, char out_path[GZ_PATH_SIZE])
{
	char path[GZ_PATH_SIZE];
	struct stat status;
	const size_t found = gz_folder_find(&panel->folder, panel->typed);
	panel->focus_wanted = true;
	if (!panel->typed[0])
		return false;
	if (found < panel->folder.count &&
	    (gz_folder_path_of(&panel->folder, panel->typed, path) != GZ_OK ||
	     stat(path, &status) != 0))
		return take(panel, panel->folder.entries[found].name, out_path);
	return take(panel, panel->typed, out_path);
}

static void print_size(uint64_t bytes, char *text, size_t size)
{
	static const char *const units[] = { "B", "KiB", "MiB", "GiB", "TiB" };
	double number = (double)bytes;
	size_t unit = 0;
	for (; number >= 1024 && unit + 1 < sizeof units / sizeof units[0]; unit++)
		number /= 1024;
	snprintf(text, size, unit == 0 || number >= 100 ? "%.0f %s" : "%.1f %s", number,
		 units[unit]);
}

static const char *kind_name(const struct gz_folder_entry *entry)
{
	if (entry->is_folder)
		return "folder";
	switch (entry->kind) {
	case GZ_FILE_SCENE:
		return "scene";
	case GZ_FILE_VOLUME:
		return "volume";
	case GZ_FILE_RAW:
		return "raw volume";
	case GZ_FILE_PICTURE:
		return "picture";
	case GZ_FILE_TRANSFER:
		return "transfer function";
	case GZ_FILE_GAZE_LOG:
		return "gaze log";
	case GZ_FILE_OTHER:
		break;
	}
	return "";
}

static bool draw_entry(struct gz_open_panel *panel, size_t index, bool selected,
		       char out_path[GZ_PATH_SIZE])
{
	const struct gz_folder_entry *entry = &panel->folder.entries[index];
	char label[LABEL_SIZE], size[32] = "";
	snprintf(label, sizeof label, "%s%s##%zu", entry->name, entry->is_folder ? "/" : "", index);
	const bool chosen = gz_widget_row(label, selected, NULL);
	if (!entry->is_folder)
		print_size(entry->bytes, size, sizeof size);
	gz_widgets_same_line(0.62f);
	gz_widget_text(gz_paint_plain, kind_name(entry));
	gz_widgets_same_line(0.84f);
	gz_widget_text(gz_paint_plain, size);
	if (!chosen)
		return false;
	/* The entry is gone once another folder is read. */
	char name[GZ_FOLDER_NAME_SIZE];
	memcpy(name, entry->name, sizeof name);
	return take(panel, name, out_path);
}

/* As long as the window has room. */
static int list_lines(void)
{
	const float room = gz_widgets_room().y - AROUND_LIST * gz_widgets_scale();
	const int lines = (int)(room / (LINE_HEIGHT * gz_widgets_line_height()));
	return lines < LINES_LEAST ? LINES_LEAST : lines > LINES_MOST ? LINES_MOST : lines;
}

static bool draw_entries(struct gz_open_panel *panel, char out_path[GZ_PATH_SIZE])
{
	const size_t found = gz_folder_find(&panel->folder, panel->typed);
	char path[GZ_PATH_SIZE];
	bool chosen = false;
	snprintf(path, sizeof path, "%s", panel->folder.path);
	if (gz_widget_list_begin("##entries", list_lines())) {
		if (gz_widget_row("../", false, NULL))
			chosen = take(panel, "..", out_path);
		/* Reading another folder ends the list. */
		for (size_t i = 0; i < panel->folder.count && !chosen; i++) {
			chosen = draw_entry(panel, i, i == found, out_path);
			if (strcmp(path, panel->folder.path) != 0)
				break;
		}
	}
	gz_widget_list_end();
	return chosen;
}

static bool draw_recent(const struct gz_open_panel *panel, char out_path[GZ_PATH_SIZE])
{
	bool chosen = false;
	if (!panel->recent || panel->recent->count == 0 || !gz_widget_heading("Recent", false))
		return false;
	for (size_t i = 0; i < panel->recent->count; i++)
		if (gz_widget_row(panel->recent->paths[i], false, NULL)) {
			memcpy(out_path, panel->recent->paths[i], GZ_PATH_SIZE);
			chosen = true;
		}
	return chosen;
}

static void draw_filter(struct gz_open_panel *panel)
{
	char label[64] = "all files";
	bool changed;
	if (panel->folder.others > 0)
		snprintf(label, sizeof label, "all files (%zu more)##all", panel->folder.others);
	else
		snprintf(label, sizeof label, "all files##all");
	changed = gz_widget_checkbox(label, &panel->filter.others);
	gz_widgets_same_line(0);
	changed |= gz_widget_checkbox("hidden ones", &panel->filter.hidden);
	if (changed)
		enter(panel, panel->folder.path);
}

static bool draw_field(struct gz_open_panel *panel, char out_path[GZ_PATH_SIZE])
{
	gz_widget_text(gz_paint_plain, panel->folder.path);
	if (panel->focus_wanted)
		gz_widgets_focus_next();
	panel->focus_wanted = false;
	gz_widgets_next_width(0);
	gz_widget_text_field("##path", panel->typed, sizeof panel->typed, false);
	const bool entered = gz_widget_entered();
	gz_widget_tooltip("a path, or the beginning of a name below; Enter opens");
	return entered && take_typed(panel, out_path);
}

bool gz_open_panel_draw(struct gz_open_panel *panel, char out_path[GZ_PATH_SIZE])
{
	const struct gz_panel_place place = { .at = GZ_PANEL_MIDDLE,
					      .width = WIDTH,
					      .takes_keyboard = true };
	bool chosen = false;
	if (!panel->open)
		return false;
	if (gz_panel_begin("Open a scene or a volume", &place, &panel->open)) {
		chosen = draw_field(panel, out_path);
		if (!chosen)
			chosen = draw_entries(panel, out_path);
		draw_filter(panel);
		if (!chosen)
			chosen = draw_recent(panel, out_path);
		if (panel->message[0])
			gz_widget_text(gz_paint_amber, panel->message);
		if (gz_widget_button("Open") && !chosen)
			chosen = take_typed(panel, out_path);
		gz_widgets_same_line(0);
		if (gz_widget_button("Cancel") || gz_dialog_escaped())
			panel->open = false;
	}
	gz_panel_end();
	return chosen && panel->open;
}

void gz_open_panel_close(struct gz_open_panel *panel)
{
	gz_folder_free(&panel->folder);
	panel->open = false;
}
