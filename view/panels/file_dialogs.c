#include "view/panels/file_dialogs.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "view/panels/widgets.h"

/* Unscaled widths (chosen: a usual path is seen whole; a file name, and a bar that moves). */
#define WIDTH          620.0f
#define PROGRESS_WIDTH 360.0f

/* ---- open ---- */

/* Unscaled height of what is above and below the list of a folder, and that of its lines, times the
 * text's. */
#define AROUND_LIST 190.0f
#define LINE_HEIGHT 1.35f
/* Of the panel's width, for a name: the kind and the size follow. */
#define NAME_SHARE 0.57f

enum { LINES_LEAST = 3, LINES_MOST = 18, ENTRY_SIZE = GZ_FOLDER_NAME_SIZE + 64 };

/* If the folder cannot be read, the present one stays and the dialog says why. */
static void enter_folder(struct gz_open_panel *panel, const char *path)
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

static bool is_existing_folder(const char *path)
{
	struct stat status;
	return stat(path, &status) == 0 && S_ISDIR(status.st_mode);
}

/* @return whether it is a file; a folder is entered. */
static bool take_entry(struct gz_open_panel *panel, const char *name, char out_path[GZ_PATH_SIZE])
{
	struct stat status;
	panel->message[0] = '\0';
	if (gz_folder_path_of(&panel->folder, name, out_path) != GZ_OK) {
		snprintf(panel->message, sizeof panel->message, "the path is too long");
		return false;
	}
	if (is_existing_folder(out_path)) {
		enter_folder(panel, out_path);
		return false;
	}
	if (stat(out_path, &status) == 0)
		return true;
	snprintf(panel->message, sizeof panel->message, "%.200s: no such file", out_path);
	return false;
}

/* Enter in the field: the path that is typed, if it exists, else the entry that begins with it. */
static bool take_typed_path(struct gz_open_panel *panel, char out_path[GZ_PATH_SIZE])
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
		return take_entry(panel, panel->folder.entries[found].name, out_path);
	return take_entry(panel, panel->typed, out_path);
}

static bool take_whole_folder(const struct gz_open_panel *panel, char out_path[GZ_PATH_SIZE])
{
	return (size_t)snprintf(out_path, GZ_PATH_SIZE, "%s", panel->folder.path) < GZ_PATH_SIZE;
}

static void print_file_size(uint64_t bytes, char *text, size_t size)
{
	static const char *const units[] = { "B", "KiB", "MiB", "GiB", "TiB" };
	double number = (double)bytes;
	size_t unit = 0;
	for (; number >= 1024 && unit + 1 < sizeof units / sizeof units[0]; unit++)
		number /= 1024;
	snprintf(text, size, unit == 0 || number >= 100 ? "%.0f %s" : "%.1f %s", number,
		 units[unit]);
}

static const char *file_kind_name(const struct gz_folder_entry *entry)
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

static bool draw_folder_entry(struct gz_open_panel *panel, size_t index, bool selected,
			      char out_path[GZ_PATH_SIZE])
{
	const struct gz_folder_entry *entry = &panel->folder.entries[index];
	char label[ENTRY_SIZE + 32], name[ENTRY_SIZE], size[32] = "";
	gz_widgets_elide(entry->name, NAME_SHARE, false, name, sizeof name);
	snprintf(label, sizeof label, "%s%s##%zu", name, entry->is_folder ? "/" : "", index);
	const bool chosen = gz_widget_row(label, selected, NULL);
	if (!entry->is_folder)
		print_file_size(entry->bytes, size, sizeof size);
	gz_widgets_same_line(0.62f);
	gz_widget_text(gz_paint_plain, file_kind_name(entry));
	gz_widgets_same_line(0.84f);
	gz_widget_text(gz_paint_plain, size);
	if (!chosen)
		return false;
	/* Reading another folder frees the entry. */
	memcpy(name, entry->name, sizeof entry->name);
	return take_entry(panel, name, out_path);
}

/* As many as the window has room for. */
static int folder_list_lines(void)
{
	const float room = gz_widgets_room().y - AROUND_LIST * gz_widgets_scale();
	const int lines = (int)(room / (LINE_HEIGHT * gz_widgets_line_height()));
	return lines < LINES_LEAST ? LINES_LEAST : lines > LINES_MOST ? LINES_MOST : lines;
}

static bool draw_folder_entries(struct gz_open_panel *panel, char out_path[GZ_PATH_SIZE])
{
	const size_t found = gz_folder_find(&panel->folder, panel->typed);
	char path[GZ_PATH_SIZE];
	bool chosen = false;
	snprintf(path, sizeof path, "%s", panel->folder.path);
	if (gz_widget_list_begin("##entries", folder_list_lines())) {
		if (gz_widget_row("../", false, NULL))
			chosen = take_entry(panel, "..", out_path);
		/* Reading another folder ends the list. */
		for (size_t i = 0; i < panel->folder.count && !chosen; i++) {
			chosen = draw_folder_entry(panel, i, i == found, out_path);
			if (strcmp(path, panel->folder.path) != 0)
				break;
		}
	}
	gz_widget_list_end();
	return chosen;
}

static bool draw_recent_files(const struct gz_open_panel *panel, char out_path[GZ_PATH_SIZE])
{
	bool chosen = false;
	if (!panel->recent || panel->recent->count == 0 || !gz_widget_heading("Recent", false))
		return false;
	for (size_t i = 0; i < panel->recent->count; i++) {
		char name[GZ_PATH_SIZE], label[GZ_PATH_SIZE + 32];
		gz_widgets_elide(panel->recent->paths[i], 0.95F, true, name, sizeof name);
		snprintf(label, sizeof label, "%s##recent %zu", name, i);
		if (gz_widget_row(label, false, NULL)) {
			memcpy(out_path, panel->recent->paths[i], GZ_PATH_SIZE);
			chosen = true;
		}
	}
	return chosen;
}

static void draw_folder_filter(struct gz_open_panel *panel)
{
	char label[64];
	bool changed;
	if (panel->folder.others > 0)
		snprintf(label, sizeof label, "all files (%zu more)##all", panel->folder.others);
	else
		snprintf(label, sizeof label, "all files##all");
	changed = gz_widget_checkbox(label, &panel->filter.others);
	gz_widgets_same_line(0);
	changed |= gz_widget_checkbox("hidden files", &panel->filter.hidden);
	if (changed)
		enter_folder(panel, panel->folder.path);
}

static bool draw_path_field(struct gz_open_panel *panel, char out_path[GZ_PATH_SIZE])
{
	gz_widget_text(gz_paint_plain, panel->folder.path);
	if (panel->focus_wanted)
		gz_widgets_focus_next();
	panel->focus_wanted = false;
	gz_widgets_next_width(0);
	gz_widget_text_field("##path", panel->typed, sizeof panel->typed, false);
	const bool entered = gz_widget_entered();
	gz_widget_tooltip("a path, or the beginning of a name below; Enter opens it");
	return entered && take_typed_path(panel, out_path);
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
		chosen = draw_path_field(panel, out_path);
		if (!chosen)
			chosen = draw_folder_entries(panel, out_path);
		draw_folder_filter(panel);
		if (!chosen)
			chosen = draw_recent_files(panel, out_path);
		if (panel->message[0])
			gz_widget_text(gz_paint_amber, panel->message);
		if (gz_widget_button("Open") && !chosen)
			chosen = take_typed_path(panel, out_path);
		gz_widgets_same_line(0);
		if (gz_widget_button("Open folder") && !chosen)
			chosen = take_whole_folder(panel, out_path);
		gz_widget_tooltip("the DICOM series in this folder, or in those below");
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

/* ---- layout of a raw volume ---- */

/* Where the fields of a raw layout begin, as a share of the panel. */
#define LABEL_SHARE 0.25f

enum { LAYOUT_LINE_SIZE = 320, LAYOUT_LINES = 6 };

void gz_raw_panel_show(struct gz_raw_panel *panel, const char *path)
{
	*panel = (struct gz_raw_panel) {
		.open = true,
		.bytes = gz_raw_file_bytes(path),
		.layout = { .dims = { 1, 1, 1 } },
	};
	snprintf(panel->path, sizeof panel->path, "%s", path);
	panel->count = gz_raw_guess(path, panel->bytes, panel->guesses, GZ_RAW_GUESSES_MAX);
	if (panel->count > 0)
		panel->layout = panel->guesses[0].layout;
	struct gz_raw_layout named;
	if (gz_raw_name_contradicts(path, panel->bytes, &named))
		snprintf(panel->warning, sizeof panel->warning,
			 "The name says %d x %d x %d %s, which is %llu bytes. The file has %llu: "
			 "it may be incomplete.",
			 named.dims[0], named.dims[1], named.dims[2], gz_raw_type_names[named.type],
			 (unsigned long long)gz_raw_layout_bytes(&named),
			 (unsigned long long)panel->bytes);
}

static bool is_same_layout(const struct gz_raw_layout *a, const struct gz_raw_layout *b)
{
	return memcmp(a->dims, b->dims, sizeof a->dims) == 0 && a->type == b->type;
}

/* @return whether one was opened, by a double click or Enter. */
static bool draw_layout_guesses(struct gz_raw_panel *panel)
{
	const char *reason = "None of these.";
	bool opened = false;
	if (panel->warning[0])
		gz_widget_text(gz_paint_amber, panel->warning);
	if (panel->count == 0) {
		gz_widget_text(gz_paint_amber, "The layout cannot be guessed from name and size: "
					       "fill in the fields.");
		return false;
	}
	const struct gz_raw_layout now = panel->layout;
	if (gz_widget_list_begin("##guesses", LAYOUT_LINES))
		for (size_t i = 0; i < panel->count; i++) {
			const struct gz_raw_layout *layout = &panel->guesses[i].layout;
			char label[LAYOUT_LINE_SIZE];
			bool twice = false;
			snprintf(label, sizeof label, "%d x %d x %d  %s##%zu", layout->dims[0],
				 layout->dims[1], layout->dims[2], gz_raw_type_names[layout->type],
				 i);
			if (gz_widget_row(label, is_same_layout(layout, &now), &twice)) {
				panel->layout = *layout;
				opened |= twice || gz_widgets_enter_pressed();
			}
			gz_widgets_same_line(0.3f);
			gz_widget_label(gz_paint_plain, panel->guesses[i].reason);
			if (is_same_layout(layout, &now))
				reason = panel->guesses[i].reason;
		}
	gz_widget_list_end();
	gz_widget_text(gz_paint_plain, reason);
	return opened;
}

static void draw_layout_label(const char *text, const char *tip)
{
	gz_widget_label(gz_paint_plain, text);
	gz_widget_tooltip(tip);
	gz_widgets_same_line(LABEL_SHARE);
	gz_widgets_next_width(0);
}

static void draw_layout_fields(struct gz_raw_panel *panel)
{
	static const char *const orders[] = { "little endian", "big endian", NULL };
	static const char *const contents[] = { "a value", "red green blue", "red green blue alpha",
						NULL };
	const struct gz_number_range voxels = {
		.least = 1, .greatest = GZ_VOLUME_DIM_MAX, .speed = 0.25, .format = "%d"
	};
	const struct gz_number_range spacing = {
		.least = 0, .greatest = 1e9, .speed = 0.005, .format = "%.6g"
	};
	int type = (int)panel->layout.type, order = panel->layout.big_endian;
	int content = panel->layout.channels > 1 ? panel->layout.channels - 2 : 0;
	draw_layout_label("voxels x y z",
			  "along each axis, x fastest in the file; Ctrl+click to type");
	gz_widget_ints("##dims", panel->layout.dims, 3, &voxels);
	draw_layout_label("a voxel is", "one number, or a colour of three or four");
	gz_widget_choice("##content", &content, contents);
	draw_layout_label("type", "of a number");
	gz_widget_choice("##type", &type, gz_raw_type_names);
	draw_layout_label("byte order", "of numbers of more than one byte");
	gz_widget_choice("##order", &order, orders);
	draw_layout_label("spacing x y z", "between voxels, mm; 0: not known");
	gz_widget_doubles("##spacing", panel->layout.spacing, 3, &spacing);
	panel->layout.type = (enum gz_raw_type)type;
	panel->layout.channels = content > 0 ? content + 2 : 1;
	panel->layout.big_endian = order == 1;
}

/* @return whether the layout has the size of the file. */
static bool draw_layout_bytes(const struct gz_raw_panel *panel)
{
	const uint64_t expected = gz_raw_layout_bytes(&panel->layout);
	const bool fits = panel->bytes == 0 || expected == panel->bytes;
	const char *bytes = expected == 1 ? "byte" : "bytes";
	char line[LAYOUT_LINE_SIZE];
	if (panel->bytes == 0)
		snprintf(line, sizeof line,
			 "%" PRIu64 " %s expected; the size of the file is known once it is read",
			 expected, bytes);
	else
		snprintf(line, sizeof line, "%" PRIu64 " %s expected, %" PRIu64 " there%s",
			 expected, bytes, panel->bytes, fits ? "" : ": wrong layout");
	gz_widget_text(fits ? gz_paint_plain : gz_paint_amber, line);
	return fits;
}

bool gz_raw_panel_draw(struct gz_raw_panel *panel)
{
	const struct gz_panel_place place = { .at = GZ_PANEL_MIDDLE,
					      .width = WIDTH,
					      .takes_keyboard = true };
	bool confirmed = false;
	if (!panel->open)
		return false;
	if (gz_panel_begin("Raw volume: what does it hold?", &place, &panel->open)) {
		gz_widget_text(gz_paint_plain, panel->path);
		const bool opened = draw_layout_guesses(panel);
		draw_layout_fields(panel);
		const bool fits = draw_layout_bytes(panel);
		gz_widgets_disable(!fits);
		confirmed = gz_widget_button("Open");
		gz_widgets_enable();
		confirmed = fits && (confirmed || opened || gz_dialog_entered());
		gz_widgets_same_line(0);
		if (gz_widget_button("Cancel") || gz_dialog_escaped())
			panel->open = false;
	}
	gz_panel_end();
	confirmed = confirmed && panel->open;
	panel->open = panel->open && !confirmed;
	return confirmed;
}

/* ---- save ---- */

void gz_save_panel_show(struct gz_save_panel *panel, const struct gz_save_words *words,
			const char *path)
{
	*panel = (struct gz_save_panel) { .open = true, .words = words, .focus_wanted = true };
	snprintf(panel->path, sizeof panel->path, "%s", path);
}

void gz_save_panel_ask(struct gz_save_panel *panel, const char *question)
{
	snprintf(panel->question, sizeof panel->question, "%s", question);
	memcpy(panel->asked, panel->path, sizeof panel->asked);
	panel->focus_wanted = true;
}

static bool is_question_open(const struct gz_save_panel *panel)
{
	return panel->question[0] && strcmp(panel->path, panel->asked) == 0;
}

static bool draw_save_field(struct gz_save_panel *panel)
{
	gz_widget_text(gz_paint_plain, panel->words->what);
	if (panel->focus_wanted)
		gz_widgets_focus_next();
	panel->focus_wanted = false;
	gz_widgets_next_width(0);
	if (gz_widget_text_field("##path", panel->path, sizeof panel->path, false))
		panel->message[0] = '\0';
	return gz_widget_entered();
}

bool gz_save_panel_draw(struct gz_save_panel *panel, bool *out_sure)
{
	const struct gz_panel_place place = { .at = GZ_PANEL_MIDDLE,
					      .width = WIDTH,
					      .takes_keyboard = true };
	bool saved = false;
	if (!panel->open)
		return false;
	if (gz_panel_begin(panel->words->title, &place, &panel->open)) {
		saved = draw_save_field(panel);
		const bool asked = is_question_open(panel);
		*out_sure = asked;
		if (asked)
			gz_widget_text(gz_paint_amber, panel->question);
		if (panel->message[0])
			gz_widget_text(gz_paint_amber, panel->message);
		saved |= gz_widget_button(asked ? "Replace" : panel->words->verb);
		gz_widgets_same_line(0);
		if (gz_widget_button("Cancel") || gz_dialog_escaped())
			panel->open = false;
	}
	gz_panel_end();
	return saved && panel->open && panel->path[0];
}

/* ---- progress ---- */

/* Share and seconds from which the time left is shown (chosen: earlier it is a guess). */
#define SHARE_LEAST 0.05
#define SPENT_LEAST 0.5

/* Longer names lose their beginning. */
enum { NAME_COLUMNS = 48 };

void gz_progress_text(double share, double spent_s, char *text, size_t size)
{
	if (share < 0)
		text[0] = '\0';
	else if (share < SHARE_LEAST || spent_s < SPENT_LEAST)
		snprintf(text, size, "%.0f %%", 100 * share);
	else
		snprintf(text, size, "%.0f %%, %.0f s left", 100 * share,
			 spent_s / share * (1 - share));
}

bool gz_progress_panel_draw(const char *title, const char *what, double share, double spent_s)
{
	const struct gz_panel_place place = { .at = GZ_PANEL_MIDDLE, .width = PROGRESS_WIDTH };
	const size_t length = strlen(what);
	char name[NAME_COLUMNS + 4], text[64];
	bool cancelled = false;
	snprintf(name, sizeof name, "%s%s", length > NAME_COLUMNS ? "..." : "",
		 length > NAME_COLUMNS ? what + length - NAME_COLUMNS : what);
	gz_progress_text(share, spent_s, text, sizeof text);
	if (gz_panel_begin(title, &place, NULL)) {
		gz_widget_text(gz_paint_plain, name);
		gz_widget_progress(share, text);
		cancelled = gz_widget_button("Cancel (Esc)");
	}
	gz_panel_end();
	return cancelled;
}
