#include "view/panels/save_panel.h"

#include <stdio.h>
#include <string.h>

#include "view/panels/widgets.h"

#define WIDTH 620.0f

void gz_save_panel_show(struct gz_save_panel *panel, const char *path)
{
	*panel = (struct gz_save_panel) { .open = true, .focus_wanted = true };
	snprintf(panel->path, sizeof panel->path, "%s", path);
}

void gz_save_panel_ask(struct gz_save_panel *panel, const char *question)
{
	snprintf(panel->question, sizeof panel->question, "%s", question);
	memcpy(panel->asked, panel->path, sizeof panel->asked);
	panel->focus_wanted = true;
}

static bool is_asked(const struct gz_save_panel *panel)
{
	return panel->question[0] && strcmp(panel->path, panel->asked) == 0;
}

static bool draw_field(struct gz_save_panel *panel)
{
	gz_widget_text(gz_paint_plain, "The scene as it is now, with all that panels have set:");
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
	if (gz_panel_begin("Save the scene", &place, &panel->open)) {
		saved = draw_field(panel);
		const bool asked = is_asked(panel);
		*out_sure = asked;
		if (asked)
			gz_widget_text(gz_paint_amber, panel->question);
		if (panel->message[0])
			gz_widget_text(gz_paint_amber, panel->message);
		saved |= gz_widget_button(asked ? "Replace" : "Save");
		gz_widgets_same_line(0);
		if (gz_widget_button("Cancel") || gz_dialog_escaped())
			panel->open = false;
	}
	gz_panel_end();
	return saved && panel->open && panel->path[0];
}
