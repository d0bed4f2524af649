#include "view/panel_settings.h"

#include <cfloat>
#include <cmath>
#include <cstdio>
#include <cstring>

#include <imgui.h>

namespace
{

/* Pixels of the unscaled interface (chosen: three numbers fit beside their name). */
constexpr float WIDTH = 380;
constexpr float MARGIN = 8;
constexpr float WIDGET_SHARE = 0.55F;

/* Ranges up to this are sliders, wider ones are dragged (chosen: a slider of 200 px reaches every
 * hundredth). */
constexpr double SLIDER_RANGE_MAX = 128;
/* A range whose ends differ by more than this factor is logarithmic. */
constexpr double LINEAR_FACTOR_MAX = 100;

/* Room for the longest text of a scene's tables, a path. */
constexpr size_t TEXT_SIZE = 4096;

constexpr char METHOD_KEY[] = "foveation.method";
constexpr char METHOD_PREFIX[] = "foveation.";

void *field_of(const gz_option_binding &binding, const gz_option &option)
{
	return static_cast<char *>(binding.target) + option.offset;
}

int count_of(const gz_option &option)
{
	return option.count > 0 ? option.count : 1;
}

/* "light.ambient": its section ends here. */
size_t section_length(const gz_option &option)
{
	return strcspn(option.key, ".");
}

/* "ray_sampling_rate" as "ray sampling rate", behind the dots. */
void print_label(const gz_option &option, char *text, size_t size)
{
	const char *dot = strrchr(option.key, '.');
	snprintf(text, size, "%s", dot ? dot + 1 : option.key);
	for (char *at = text; *at; at++)
		if (*at == '_')
			*at = ' ';
}

const gz_option *find(const gz_option_binding *bindings, size_t count, const char *key,
		      const gz_option_binding **out_binding)
{
	size_t at = 0;
	const gz_option *option = gz_options_find(bindings, count, key, &at);
	if (option)
		*out_binding = &bindings[at];
	return option;
}

bool begins_with(const char *text, const char *start, size_t length)
{
	return strncmp(text, start, length) == 0;
}

/* A row named after a method that is not the chosen one: "foveation.mdc_spacing" while that is
 * "ddc". The longest name counts, so that "mdc3" has its own; those of "mdc" are its too. */
bool is_of_another_method(const gz_option &option, const gz_option &method, int chosen)
{
	size_t prefix = strlen(METHOD_PREFIX), longest = 0;
	int owner = -1;
	if (!begins_with(option.key, METHOD_PREFIX, prefix))
		return false;
	for (int i = 0; method.choices[i]; i++) {
		size_t length = strlen(method.choices[i]);
		if (length > longest &&
		    begins_with(option.key + prefix, method.choices[i], length) &&
		    option.key[prefix + length] == '_') {
			longest = length;
			owner = i;
		}
	}
	return owner >= 0 && !begins_with(method.choices[chosen], method.choices[owner], longest);
}

bool draw_numbers(const gz_option &option, void *field, ImGuiDataType type, const void *least,
		  const void *greatest, const char *format)
{
	ImGuiSliderFlags flags = ImGuiSliderFlags_AlwaysClamp;
	bool logarithmic = option.min > 0 && option.max > LINEAR_FACTOR_MAX * option.min;
	if (logarithmic)
		flags |= ImGuiSliderFlags_Logarithmic;
	if (option.max - option.min <= SLIDER_RANGE_MAX)
		return ImGui::SliderScalarN("##value", type, field, count_of(option), least,
					    greatest, format, flags);
	/* By a hundredth of the number a pixel: whatever its size, it can be set. */
	double size = type == ImGuiDataType_Double ? fabs(*static_cast<double *>(field))
						   : abs(*static_cast<int *>(field));
	float speed = static_cast<float>(size / 100);
	float least_speed = type == ImGuiDataType_Double ? 0.005F : 0.1F;
	return ImGui::DragScalarN("##value", type, field, count_of(option),
				  speed > least_speed ? speed : least_speed, least, greatest,
				  format, ImGuiSliderFlags_AlwaysClamp);
}

bool draw_colour(double *colour)
{
	float shown[3];
	for (int i = 0; i < 3; i++)
		shown[i] = static_cast<float>(colour[i]);
	if (!ImGui::ColorEdit3("##value", shown, ImGuiColorEditFlags_Float))
		return false;
	for (int i = 0; i < 3; i++)
		colour[i] = shown[i] < 0 ? 0 : shown[i] > 1 ? 1 : static_cast<double>(shown[i]);
	return true;
}

bool is_colour(const gz_option &option)
{
	return strcmp(option.key, "render.background") == 0;
}

/* Taken as a whole: half a file's name would be looked for. Dear ImGui keeps what is typed
 * meanwhile. */
bool draw_text(const gz_option &option, char *field)
{
	char text[TEXT_SIZE] = ""; // its end too: settings are compared byte by byte
	const size_t size = static_cast<size_t>(option.max);
	if (size > sizeof text)
		return false;
	snprintf(text, size, "%s", field);
	if (!ImGui::InputText("##value", text, size, ImGuiInputTextFlags_EnterReturnsTrue))
		return false;
	memcpy(field, text, size);
	return true;
}

bool draw_widget(const gz_option &option, void *field)
{
	switch (option.type) {
	case GZ_OPTION_BOOL:
		return ImGui::Checkbox("##value", static_cast<bool *>(field));
	case GZ_OPTION_CHOICE: {
		int names = 0;
		while (option.choices[names])
			names++;
		return ImGui::Combo("##value", static_cast<int *>(field), option.choices, names);
	}
	case GZ_OPTION_INT: {
		int least = static_cast<int>(option.min), greatest = static_cast<int>(option.max);
		return draw_numbers(option, field, ImGuiDataType_S32, &least, &greatest, "%d");
	}
	case GZ_OPTION_DOUBLE:
		if (is_colour(option))
			return draw_colour(static_cast<double *>(field));
		return draw_numbers(option, field, ImGuiDataType_Double, &option.min, &option.max,
				    option.max <= 1 ? "%.3f" : "%.4g");
	case GZ_OPTION_STRING:
		return draw_text(option, static_cast<char *>(field));
	case GZ_OPTION_SIZE:
		break;
	}
	return false;
}

void explain(const gz_option &option)
{
	if (ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled))
		ImGui::SetTooltip("%s", option.help);
}

bool draw_row(const gz_option_binding &binding, const gz_option &option, bool applies)
{
	char label[64];
	print_label(option, label, sizeof label);
	ImGui::PushID(option.key);
	ImGui::AlignTextToFramePadding();
	ImGui::BeginDisabled(!applies);
	ImGui::TextUnformatted(label);
	explain(option);
	ImGui::SameLine(ImGui::GetWindowContentRegionMax().x * (1 - WIDGET_SHARE));
	ImGui::SetNextItemWidth(-FLT_MIN);
	bool changed = draw_widget(option, field_of(binding, option));
	explain(option);
	ImGui::EndDisabled();
	ImGui::PopID();
	return changed;
}

bool draw_heading(const gz_option &option)
{
	char heading[64];
	snprintf(heading, sizeof heading, "%.*s", static_cast<int>(section_length(option)),
		 option.key);
	if (heading[0] >= 'a' && heading[0] <= 'z')
		heading[0] = static_cast<char>(heading[0] - 'a' + 'A');
	return ImGui::CollapsingHeader(heading);
}

bool has_widget(const gz_option &option)
{
	return option.type != GZ_OPTION_SIZE;
}

bool same_section(const gz_option &a, const gz_option &b)
{
	size_t length = section_length(a);
	return length == section_length(b) && begins_with(a.key, b.key, length);
}

/* All tables as one list. */
struct rows {
	const gz_option_binding *bindings;
	size_t count;
	const gz_panel_content &content;

	bool applies(const gz_option &option) const
	{
		return !content.applies || content.applies(content.applies_user, option.key);
	}

	template <typename Visit> void each(Visit visit) const
	{
		for (size_t i = 0; i < count; i++)
			for (size_t k = 0; k < bindings[i].count; k++)
				if (has_widget(bindings[i].options[k]) &&
				    !visit(bindings[i], bindings[i].options[k]))
					return;
	}
};

bool is_first_of_section(const rows &all, const gz_option &option)
{
	const gz_option *first = nullptr;
	all.each([&](const gz_option_binding &, const gz_option &other) {
		if (same_section(other, option))
			first = &other;
		return !first;
	});
	return first == &option;
}

bool draw_section(const rows &all, const gz_option &section, const gz_option *method, int chosen)
{
	bool changed = false;
	if (!draw_heading(section))
		return false;
	all.each([&](const gz_option_binding &binding, const gz_option &option) {
		if (same_section(option, section) &&
		    !(method && is_of_another_method(option, *method, chosen)))
			changed |= draw_row(binding, option, all.applies(option));
		return true;
	});
	return changed;
}

} // namespace

bool gz_panel_draw_settings(float top, const struct gz_panel_content &content)
{
	const gz_option_binding *bindings = content.settings;
	const size_t count = content.settings_count;
	ImVec2 room = ImGui::GetIO().DisplaySize;
	float scale = ImGui::GetIO().FontGlobalScale;
	float width = fminf(WIDTH * scale, room.x * 0.8F);
	ImGui::SetNextWindowPos(ImVec2(room.x - MARGIN, top), ImGuiCond_Always, ImVec2(1, 0));
	ImGui::SetNextWindowSizeConstraints(ImVec2(width, 0), ImVec2(width, room.y - top - MARGIN));
	ImGui::SetNextWindowBgAlpha(0.85F);
	bool changed = false;
	if (ImGui::Begin("Settings", nullptr,
			 ImGuiWindowFlags_NoMove | ImGuiWindowFlags_AlwaysAutoResize |
				 ImGuiWindowFlags_NoSavedSettings)) {
		const gz_option_binding *of_method = nullptr;
		const gz_option *method = find(bindings, count, METHOD_KEY, &of_method);
		int chosen = method ? *static_cast<int *>(field_of(*of_method, *method)) : -1;
		const rows all = { bindings, count, content };
		all.each([&](const gz_option_binding &, const gz_option &option) {
			if (is_first_of_section(all, option))
				changed |= draw_section(all, option, method, chosen);
			return true;
		});
	}
	ImGui::End();
	return changed;
}
