#include "bench/report/scene_edit.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "render/file_path.h"
#include "render/plan/plan.h"
#include "render/ray_params.h"
#include "render/scene.h"

#define GZ_LOG_MODULE "scene"

static const char blanks[] = " \t\r";

/* A line of an INI text, without its end, and what it is. */
struct line {
	const char *start, *end;
	const char *name, *name_end; /* NULL where it gives no value */
	const char *value;           /* behind the '=' and blanks */
	bool is_section, is_comment;
};

static const char *skip_blanks(const char *at, const char *end)
{
	while (at < end && strchr(blanks, *at))
		at++;
	return at;
}

static const char *trim_blanks(const char *start, const char *end)
{
	while (end > start && strchr(blanks, end[-1]))
		end--;
	return end;
}

static struct line read_line(const char *start, const char *text_end)
{
	const char *end = memchr(start, '\n', (size_t)(text_end - start));
	struct line line = { .start = start, .end = end ? end : text_end };
	const char *first = skip_blanks(start, line.end);
	line.is_comment = first < line.end && (*first == ';' || *first == '#');
	line.is_section = first < line.end && *first == '[';
	if (line.is_section) {
		const char *close = memchr(first, ']', (size_t)(line.end - first));
		line.name = first + 1;
		line.name_end = close ? close : line.end;
	} else if (!line.is_comment) {
		const char *sign = first;
		while (sign < line.end && *sign != '=' && *sign != ':')
			sign++;
		if (sign < line.end) {
			line.name = first;
			line.name_end = trim_blanks(first, sign);
			line.value = skip_blanks(sign + 1, line.end);
		}
	}
	return line;
}

static bool is_called(const struct line *line, const char *name)
{
	const size_t length = strlen(name);
	return line->name && (size_t)(line->name_end - line->name) == length &&
	       strncmp(line->name, name, length) == 0;
}

/* Where a value ends: before a ';' behind a blank, and before blanks. */
static const char *end_of_value(const struct line *line)
{
	const char *end = line->end;
	for (const char *at = line->value; at < line->end; at++)
		if (*at == ';' && at > line->start && strchr(blanks, at[-1])) {
			end = at;
			break;
		}
	return trim_blanks(line->value, end);
}

/* The place in a text where a key is set. */
struct place {
	size_t from, to;    /* what is replaced */
	bool found;         /* the key is there */
	bool section_found; /* else its section is, and it goes to `from` */
};

static struct place find_place(const struct gz_text *text, const char *section, const char *name)
{
	struct place place = { text->length, text->length, false, false };
	const char *end = text->bytes + text->length;
	bool inside = false;
	for (const char *at = text->bytes; at && at < end;) {
		const struct line line = read_line(at, end);
		at = line.end < end ? line.end + 1 : end;
		if (line.is_section)
			inside = is_called(&line, section);
		if (!inside)
			continue;
		if (!line.is_section && is_called(&line, name)) {
			place.from = (size_t)(line.value - text->bytes);
			place.to = (size_t)(end_of_value(&line) - text->bytes);
			place.found = true;
			return place;
		}
		if (line.is_section || line.name) {
			place.from = place.to = (size_t)(at - text->bytes);
			place.section_found = true;
		}
	}
	return place;
}

void gz_scene_text_set(struct gz_text *text, const char *section, const char *name,
		       const char *value)
{
	struct gz_text edited = { 0 };
	const struct place place = find_place(text, section, name);
	const char *bytes = text->bytes ? text->bytes : "";
	gz_text_add_bytes(&edited, bytes, place.from);
	if (place.found) {
		gz_text_add(&edited, "%s", value);
	} else {
		if (edited.length > 0 && edited.bytes[edited.length - 1] != '\n')
			gz_text_add(&edited, "\n");
		if (!place.section_found)
			gz_text_add(&edited, "[%s]\n", section);
		gz_text_add(&edited, "%s = %s\n", name, value);
	}
	gz_text_add_bytes(&edited, bytes + place.to, text->length - place.to);
	edited.failed |= text->failed;
	gz_text_free(text);
	*text = edited;
}

/* The section in which scenes have an option; NULL if none does. */
static const char *section_of(const char *name)
{
	struct gz_foveation foveation;
	struct gz_ray_params rays;
	const struct {
		const char *section;
		struct gz_option_binding binding;
	} tables[] = {
		{ "foveation",
		  { gz_foveation_options, gz_foveation_option_count, &foveation, NULL } },
		{ "render", { gz_ray_options, gz_ray_option_count, &rays, NULL } },
	};
	for (size_t i = 0; i < sizeof tables / sizeof tables[0]; i++) {
		char key[GZ_STUDY_TEXT_SIZE + 16];
		snprintf(key, sizeof key, "%s.%s", tables[i].section, name);
		if (gz_options_find(&tables[i].binding, 1, key, NULL))
			return tables[i].section;
	}
	return NULL;
}

enum gz_result gz_scene_text_set_variant(struct gz_text *text,
					 const struct gz_study_variant *variant,
					 const struct gz_log *log)
{
	char copy[GZ_STUDY_TEXT_SIZE];
	snprintf(copy, sizeof copy, "%s", variant->text);
	char *rest = copy;
	strsep(&rest, ":");
	gz_scene_text_set(text, "foveation", "method", variant->method);
	for (char *option = strsep(&rest, ":"); option; option = strsep(&rest, ":")) {
		char *value = strchr(option, '=');
		if (value)
			*value++ = '\0';
		const char *section = section_of(option);
		if (!section || !value) {
			gz_err(log, "%s: %s is no option of a scene", variant->text, option);
			return GZ_ERR_INVAL;
		}
		gz_scene_text_set(text, section, option, value);
	}
	return GZ_OK;
}

/* A file that lies beside the scene must lie beside the copy too. */
static enum gz_result check_file(const char *scene, const char *copy, const char *key,
				 const char *name, const struct gz_log *log)
{
	char before[GZ_PATH_SIZE], after[GZ_PATH_SIZE];
	if (!name[0] || gz_path_beside(scene, name, before, sizeof before) != GZ_OK ||
	    gz_path_beside(copy, name, after, sizeof after) != GZ_OK || access(before, F_OK) != 0 ||
	    access(after, F_OK) == 0)
		return GZ_OK;
	gz_err(log, "%s: %s = %s lies beside %s and would not be found: write the copy there", copy,
	       key, name, scene);
	return GZ_ERR_NOT_FOUND;
}

static enum gz_result check_copy(const struct gz_text *text, const char *scene, const char *copy,
				 const struct gz_log *log)
{
	struct gz_scene_settings settings;
	bool has_display;
	enum gz_result result =
		gz_scene_parse(copy, text->bytes, text->length, log, &settings, &has_display);
	if (result == GZ_OK)
		result = check_file(scene, copy, "volume.file", settings.volume_file, log);
	if (result == GZ_OK)
		result = check_file(scene, copy, "transfer.file", settings.transfer_file, log);
	if (result == GZ_OK)
		result = check_file(scene, copy, "foveation.table", settings.foveation.table_file,
				    log);
	return result;
}

enum gz_result gz_scene_copy_with(const char *scene, const char *copy,
				  const struct gz_study_variant *variant, const struct gz_log *log)
{
	struct gz_text text = { 0 };
	if (access(copy, F_OK) == 0) {
		gz_err(log, "%s is there already: name another file, or remove it", copy);
		return GZ_ERR_BUSY;
	}
	enum gz_result result = gz_text_add_file(&text, scene);
	if (result != GZ_OK)
		gz_err(log, "%s: cannot be read (%s): --scene takes the path of the scene, too",
		       scene, gz_result_text(result));
	if (result == GZ_OK)
		result = gz_scene_text_set_variant(&text, variant, log);
	if (result == GZ_OK && !text.failed)
		result = check_copy(&text, scene, copy, log);
	if (result == GZ_OK)
		result = gz_text_write(&text, copy, log);
	gz_text_free(&text);
	return result;
}
