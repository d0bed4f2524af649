#include "view/panels/progress_panel.h"

#include <stdio.h>
#include <string.h>

#include "view/panels/widgets.h"

/* Unscaled (chosen: a file's name and a bar that moves). */
#define WIDTH 360.0f

/* Shares and times from which the time left is told (chosen: before, it is a guess). */
#define SHARE_LEAST 0.05
#define SPENT_LEAST 0.5

/* A longer name loses its beginning. */
enum { NAME_COLUMNS = 48 };

void gz_progress_text(double share, double spent_s, char *text, unsigned long size)
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
	const struct gz_panel_place place = { .at = GZ_PANEL_MIDDLE, .width = WIDTH };
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
