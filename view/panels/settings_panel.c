#include "view/panels/settings_panel.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "view/panels/widgets.h"
#include "view/settings/setting_label.h"

/* Unscaled (chosen: three numbers fit beside their name). */
#define WIDTH       380.0f
#define LABEL_SHARE 0.45f
/* The rest of the row: the widget, and the arrow that resets it. */
#define VALUE_SHARE 0.47f
#define RESET_SHARE 0.93f

/* Ranges up to this are sliders, wider ones are dragged (chosen: a slider of 200 px reaches every
 * hundredth). */
#define SLIDER_RANGE_MAX 128.0
/* A range whose ends differ by more than this factor is logarithmic. */
#define LINEAR_FACTOR_MAX 100.0

#define METHOD_KEY    "foveation.method"
#define METHOD_PREFIX "foveation."

static void *setting_field(const struct gz_option_binding *binding, const struct gz_option *option)
{
	return (char *)binding->target + option->offset;
}

static int count_of_values(const struct gz_option *option)
{
	return option->count > 0 ? (int)option->count : 1;
}

/* Length of the section's name in a key: 5 in "light.ambient". */
static size_t section_length(const struct gz_option *option)
{
	return strcspn(option->key, ".");
}

/* Whether a row is named after a method that is not the chosen one: "foveation.mdc_spacing" while
 * "ddc" is chosen. The longest name counts, so that "mdc3" has rows of its own; it has those of
 * "mdc" too. */
static bool is_of_another_method(const struct gz_option *option, const struct gz_option *method,
				 int chosen)
{
	const size_t prefix = strlen(METHOD_PREFIX);
	size_t longest = 0;
	int owner = -1;
	if (strncmp(option->key, METHOD_PREFIX, prefix) != 0)
		return false;
	for (int i = 0; method->choices[i]; i++) {
		const size_t length = strlen(method->choices[i]);
		if (length > longest &&
		    strncmp(option->key + prefix, method->choices[i], length) == 0 &&
		    option->key[prefix + length] == '_') {
			longest = length;
			owner = i;
		}
	}
	return owner >= 0 && strncmp(method->choices[chosen], method->choices[owner], longest) != 0;
}

/* A drag changes a number by a hundredth of itself per pixel, so that any magnitude can be set. */
static struct gz_number_range range_of(const struct gz_option *option, double value)
{
	const bool whole = option->type == GZ_OPTION_INT;
	return (struct gz_number_range) {
		.least = option->min,
		.greatest = option->max,
		.slider = option->max - option->min <= SLIDER_RANGE_MAX,
		.logarithmic = option->min > 0 && option->max > LINEAR_FACTOR_MAX * option->min,
		.speed = fmax(fabs(value) / 100, whole ? 0.1 : 0.005),
		.axes = gz_setting_axes(option),
		.format = whole              ? "%d"
			  : option->max <= 1 ? "%.3f"
					     : "%.4g",
	};
}

static bool draw_setting_widget(const struct gz_option *option, void *field)
{
	struct gz_number_range range;
	switch (option->type) {
	case GZ_OPTION_BOOL:
		return gz_widget_checkbox("##value", field);
	case GZ_OPTION_CHOICE:
		return gz_widget_choice("##value", field, option->choices);
	case GZ_OPTION_INT:
		range = range_of(option, *(int *)field);
		return gz_widget_ints("##value", field, count_of_values(option), &range);
	case GZ_OPTION_DOUBLE:
		if (strcmp(option->key, "render.background") == 0 ||
		    strcmp(option->key, "isosurface.colour") == 0)
			return gz_widget_colour("##value", field);
		range = range_of(option, *(double *)field);
		return gz_widget_doubles("##value", field, count_of_values(option), &range);
	case GZ_OPTION_STRING:
		/* Enter ends it: an unfinished file name would be looked up. */
		return gz_widget_text_field("##value", field, (size_t)option->max, true);
	case GZ_OPTION_SIZE:
		break;
	}
	return false;
}

static bool is_marked(const struct gz_settings_panel *panel, const struct gz_option *option)
{
	return panel->marked && strcmp(panel->marked, option->key) == 0;
}

/* An arrow beside a value that is not the scene's. */
static bool draw_setting_reset(const struct gz_settings_panel *panel,
			       const struct gz_option_binding *binding,
			       const struct gz_option *option)
{
	const size_t table = (size_t)(binding - panel->bindings);
	char value[GZ_OPTION_TEXT_SIZE], tip[GZ_OPTION_TEXT_SIZE + 64];
	if (!panel->given || gz_option_same(option, binding->target, panel->given[table].target) ||
	    gz_option_format(option, panel->given[table].target, value, sizeof value) != GZ_OK)
		return false;
	gz_widgets_same_line(RESET_SHARE);
	const bool reset = gz_widget_back_button("##reset");
	snprintf(tip, sizeof tip, "back to %s, as the scene has it", value[0] ? value : "nothing");
	gz_widget_tooltip(tip);
	return reset && gz_option_parse(option, value, binding->target, NULL, 0) == GZ_OK;
}

static bool draw_setting(const struct gz_settings_panel *panel,
			 const struct gz_option_binding *binding, const struct gz_option *option)
{
	char label[GZ_SETTING_LABEL_SIZE];
	const bool marked = is_marked(panel, option);
	gz_setting_label(option, label);
	gz_widgets_push_id(option->key);
	if (marked && panel->reveal)
		gz_widgets_scroll_here();
	gz_widgets_disable(panel->applies && !panel->applies(panel->user, option->key));
	gz_widget_label(marked ? gz_paint_amber : gz_paint_plain, label);
	gz_widget_tooltip(option->help);
	gz_widgets_same_line(LABEL_SHARE);
	gz_widgets_next_width(panel->given ? VALUE_SHARE : 0);
	bool changed = draw_setting_widget(option, setting_field(binding, option));
	gz_widget_tooltip(option->help);
	changed |= draw_setting_reset(panel, binding, option);
	gz_widgets_enable();
	gz_widgets_pop_id();
	return changed;
}

static bool has_widget(const struct gz_option *option)
{
	return option->type != GZ_OPTION_SIZE;
}

static bool same_section(const struct gz_option *a, const struct gz_option *b)
{
	const size_t length = section_length(a);
	return length == section_length(b) && strncmp(a->key, b->key, length) == 0;
}

/* The section with the row that is searched for unfolds. */
static bool draw_section_heading(const struct gz_settings_panel *panel,
				 const struct gz_option *option)
{
	char heading[GZ_SETTING_LABEL_SIZE];
	const size_t length = section_length(option);
	gz_setting_section(option, heading);
	if (panel->marked && panel->reveal && strncmp(panel->marked, option->key, length + 1) == 0)
		gz_widgets_unfold_next();
	return gz_widget_heading(heading, false);
}

/* A position in the concatenation of all tables; binding is count behind the last row. */
struct row {
	size_t binding, option;
};

static const struct gz_option *row_option(const struct gz_settings_panel *panel, struct row row)
{
	return &panel->bindings[row.binding].options[row.option];
}

/* Advance to the next row with a widget, which may be this one. @return false: there is none */
static bool find_setting_row(const struct gz_settings_panel *panel, struct row *row)
{
	for (; row->binding < panel->count; row->binding++, row->option = 0)
		for (; row->option < panel->bindings[row->binding].count; row->option++)
			if (has_widget(row_option(panel, *row)))
				return true;
	return false;
}

static bool is_first_of_section(const struct gz_settings_panel *panel,
				const struct gz_option *option)
{
	for (struct row row = { 0, 0 }; find_setting_row(panel, &row); row.option++)
		if (same_section(row_option(panel, row), option))
			return row_option(panel, row) == option;
	return false;
}

/* The chosen method; rows of other methods are left out. option NULL: no table has a method. */
struct method {
	const struct gz_option *option;
	int chosen;
};

static struct method find_chosen_method(const struct gz_settings_panel *panel)
{
	size_t at = 0;
	const struct gz_option *option =
		gz_options_find(panel->bindings, panel->count, METHOD_KEY, &at);
	return (struct method) { option,
				 option ? *(int *)setting_field(&panel->bindings[at], option)
					: -1 };
}

static bool draw_setting_of_method(const struct gz_settings_panel *panel, struct row row,
				   const struct method *method)
{
	const struct gz_option *option = row_option(panel, row);
	if (method->option && is_of_another_method(option, method->option, method->chosen))
		return false;
	return draw_setting(panel, &panel->bindings[row.binding], option);
}

static bool draw_section(const struct gz_settings_panel *panel, const struct gz_option *section,
			 const struct method *method)
{
	bool changed = false;
	if (!draw_section_heading(panel, section))
		return false;
	for (struct row row = { 0, 0 }; find_setting_row(panel, &row); row.option++)
		if (same_section(row_option(panel, row), section))
			changed |= draw_setting_of_method(panel, row, method);
	return changed;
}

/* Sections that are changed most come first; the others follow in the order of the tables. */
static const char *const first_sections[] = { "foveation.", "render.", "view.", "clip.", "light." };
enum { FIRST_SECTIONS = sizeof first_sections / sizeof first_sections[0] };

/* Index in first_sections of the option's section; FIRST_SECTIONS: not among them. */
static int section_rank(const struct gz_option *option)
{
	int rank = 0;
	while (rank < FIRST_SECTIONS &&
	       strncmp(option->key, first_sections[rank], strlen(first_sections[rank])) != 0)
		rank++;
	return rank;
}

static bool draw_sections(const struct gz_settings_panel *panel)
{
	const struct method method = find_chosen_method(panel);
	bool changed = false;
	for (int rank = 0; rank <= FIRST_SECTIONS; rank++)
		for (struct row row = { 0, 0 }; find_setting_row(panel, &row); row.option++) {
			const struct gz_option *option = row_option(panel, row);
			if (section_rank(option) == rank && is_first_of_section(panel, option))
				changed |= draw_section(panel, option, &method);
		}
	return changed;
}

static bool begins_with_any(const char *key, const char *const prefixes[])
{
	for (size_t i = 0; prefixes[i]; i++)
		if (strncmp(key, prefixes[i], strlen(prefixes[i])) == 0)
			return true;
	return false;
}

bool gz_settings_rows_draw(const struct gz_settings_panel *panel, const char *const prefixes[])
{
	const struct method method = find_chosen_method(panel);
	bool changed = false;
	for (struct row row = { 0, 0 }; find_setting_row(panel, &row); row.option++)
		if (begins_with_any(row_option(panel, row)->key, prefixes))
			changed |= draw_setting_of_method(panel, row, &method);
	return changed;
}

bool gz_settings_panel_draw(struct gz_settings_panel *panel)
{
	const struct gz_panel_place place = {
		.at = GZ_PANEL_TOP_RIGHT,
		.width = WIDTH,
		.margin_top = panel->margin_top,
	};
	bool changed = false;
	if (gz_panel_begin("Settings", &place, &panel->open))
		changed = draw_sections(panel);
	gz_panel_end();
	return changed;
}
