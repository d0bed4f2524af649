#include "view/panels/raw_panel.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "view/panels/widgets.h"

#define WIDTH       620.0f
#define LABEL_SHARE 0.25f

enum { LINE_SIZE = 320, LINES = 6 };

void gz_raw_panel_show(struct gz_raw_panel *panel, const char *path)
{
	*panel = (struct gz_raw_panel) {
		.open = true,
		.bytes = gz_raw_file_bytes(path),
		.layout = { .dims = { 1, 1, 1 }, .spacing = { 1, 1, 1 } },
	};
	snprintf(panel->path, sizeof panel->path, "%s", path);
	panel->count = gz_raw_guess(path, panel->bytes, panel->guesses, GZ_RAW_GUESSES_MAX);
	if (panel->count > 0)
		panel->layout = panel->guesses[0].layout;
}

static bool is_same(const struct gz_raw_layout *a, const struct gz_raw_layout *b)
{
	return memcmp(a->dims, b->dims, sizeof a->dims) == 0 && a->type == b->type;
}

/* @return whether one has been opened: by two clicks, or by Enter. */
static bool draw_guesses(struct gz_raw_panel *panel)
{
	const char *reason = "None of these.";
	bool opened = false;
	if (panel->count == 0) {
		gz_widget_text(gz_paint_amber, "Neither its name nor its size tells the layout: "
					       "fill in the fields.");
		return false;
	}
	const struct gz_raw_layout now = panel->layout;
	if (gz_widget_list_begin("##guesses", LINES))
		for (size_t i = 0; i < panel->count; i++) {
			const struct gz_raw_layout *layout = &panel->guesses[i].layout;
			char label[LINE_SIZE];
			bool twice = false;
			snprintf(label, sizeof label, "%d x %d x %d  %s##%zu", layout->dims[0],
				 layout->dims[1], layout->dims[2], gz_raw_type_names[layout->type],
				 i);
			if (gz_widget_row(label, is_same(layout, &now), &twice)) {
				panel->layout = *layout;
				opened |= twice || gz_widgets_enter_pressed();
			}
			gz_widgets_same_line(0.3f);
			gz_widget_label(panel->guesses[i].reason);
			if (is_same(layout, &now))
				reason = panel->guesses[i].reason;
		}
	gz_widget_list_end();
	gz_widget_text(gz_paint_plain, reason);
	return opened;
}

static void draw_label(const char *text, const char *tip)
{
	gz_widget_label(text);
	gz_widget_tooltip(tip);
	gz_widgets_same_line(LABEL_SHARE);
	gz_widgets_next_width(0);
}

static void draw_fields(struct gz_raw_panel *panel)
{
	static const char *const orders[] = { "little endian", "big endian", NULL };
	const struct gz_number_range voxels = {
		.least = 1, .greatest = GZ_VOLUME_DIM_MAX, .speed = 0.25, .format = "%d"
	};
	const struct gz_number_range spacing = {
		.least = 1e-9, .greatest = 1e9, .speed = 0.005, .format = "%.6g"
	};
	int type = (int)panel->layout.type, order = panel->layout.big_endian;
	draw_label("voxels x y z",
		   "along each axis, x fastest in the file; Ctrl and a click to type");
	gz_widget_ints("##dims", panel->layout.dims, 3, &voxels);
	draw_label("type", "of a voxel");
	gz_widget_choice("##type", &type, gz_raw_type_names);
	draw_label("byte order", "of voxels of more than one byte");
	gz_widget_choice("##order", &order, orders);
	draw_label("spacing x y z", "between voxels, mm");
	gz_widget_doubles("##spacing", panel->layout.spacing, 3, &spacing);
	panel->layout.type = (enum gz_raw_type)type;
	panel->layout.big_endian = order == 1;
}

/* Whether the layout is the file's size; says so. */
static bool draw_bytes(const struct gz_raw_panel *panel)
{
	const uint64_t expected = gz_raw_layout_bytes(&panel->layout);
	const bool fits = panel->bytes == 0 || expected == panel->bytes;
	char line[LINE_SIZE];
	if (panel->bytes == 0)
		snprintf(line, sizeof line,
			 "%" PRIu64 " bytes expected; how many there are is told when it is read",
			 expected);
	else
		snprintf(line, sizeof line, "%" PRIu64 " bytes expected, %" PRIu64 " there%s",
			 expected, panel->bytes, fits ? "" : ": this is not its layout");
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
		const bool opened = draw_guesses(panel);
		draw_fields(panel);
		const bool fits = draw_bytes(panel);
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
