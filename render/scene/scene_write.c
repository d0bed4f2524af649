#include "render/scene/scene_write.h"

#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "base/ini.h"
#include "render/scene/scene_files.h"

#define GZ_LOG_MODULE "scene"

enum {
	SECTIONS_MAX = 32 + GZ_SCENE_OBJECTS_MAX + GZ_SCENE_REGIONS_MAX,
	SECTION_SIZE = GZ_SCENE_SECTION_SIZE,
	TABLES_MAX = GZ_SCENE_TABLE_COUNT + GZ_SCENE_REGIONS_MAX + GZ_SCENE_OBJECTS_MAX,
	REGION_TABLES_END = GZ_SCENE_TABLE_COUNT + GZ_SCENE_REGIONS_MAX,
};

/* Settings to write, with their tables and presets. */
struct scene_writer {
	const struct gz_scene_saved *saved;
	const struct gz_log *log;
	struct gz_scene_settings settings, presets;
	struct gz_scene_object object_presets;
	struct gz_scene_object_table object_tables[GZ_SCENE_OBJECTS_MAX];
	struct gz_scene_region_table region_tables[GZ_SCENE_REGIONS_MAX];
	size_t tables;
	struct gz_option_binding bindings[TABLES_MAX], preset_bindings[TABLES_MAX];
};

/* An option with the places of its value and its preset. */
struct scene_key {
	const struct gz_option *option;
	const void *target, *preset_target;
	char section[SECTION_SIZE];
	const char *name;
};

static void begin_scene_writer(struct scene_writer *writer, const struct gz_scene_saved *saved,
			       const struct gz_log *log)
{
	writer->saved = saved;
	writer->log = log;
	writer->settings = *saved->settings;
	gz_scene_settings_preset(&writer->presets);
	writer->object_presets = (struct gz_scene_object) { .section = "object" };
	const struct gz_option_binding object = { gz_scene_object_options, GZ_SCENE_OBJECT_OPTIONS,
						  &writer->object_presets, NULL };
	gz_options_preset(&object);
	gz_scene_bind(&writer->settings, writer->bindings);
	gz_scene_bind(&writer->presets, writer->preset_bindings);
	writer->tables = GZ_SCENE_TABLE_COUNT;
	for (size_t i = 0; i < GZ_SCENE_REGIONS_MAX; i++) {
		writer->preset_bindings[writer->tables] = gz_scene_region_bind(
			&writer->presets.regions.items[i], i, &writer->region_tables[i]);
		writer->bindings[writer->tables++] = gz_scene_region_bind(
			&writer->settings.regions.items[i], i, &writer->region_tables[i]);
	}
	for (size_t i = 0; i < writer->settings.objects.count; i++) {
		writer->bindings[writer->tables] = gz_scene_object_bind(
			&writer->settings.objects.items[i], &writer->object_tables[i]);
		writer->preset_bindings[writer->tables++] = object;
	}
}

/* The settings that a text now gives to the table of a key; the presets for an object that it
 * lacks. */
static const void *said_target(const struct scene_key *key, size_t table,
			       struct gz_scene_settings *said)
{
	struct gz_option_binding bindings[GZ_SCENE_TABLE_COUNT];
	gz_scene_bind(said, bindings);
	if (table < GZ_SCENE_TABLE_COUNT)
		return bindings[table].target;
	if (table < REGION_TABLES_END)
		return &said->regions.items[table - GZ_SCENE_TABLE_COUNT];
	const struct gz_scene_object *own = key->target;
	const int object = gz_scene_objects_find(&said->objects, own->section);
	return object < 0 ? key->preset_target : &said->objects.items[object];
}

static struct scene_key key_of(const struct scene_writer *writer, size_t table, size_t index)
{
	const struct gz_option *option = &writer->bindings[table].options[index];
	const char *dot = strchr(option->key, '.');
	struct scene_key key = {
		.option = option,
		.target = writer->bindings[table].target,
		.preset_target = writer->preset_bindings[table].target,
		.name = dot + 1,
	};
	snprintf(key.section, sizeof key.section, "%.*s", (int)(dot - option->key), option->key);
	return key;
}

static bool format_same(const struct gz_option *option, const void *a, const void *b)
{
	char one[GZ_PATH_SIZE], other[GZ_PATH_SIZE];
	return gz_option_format(option, a, one, sizeof one) == GZ_OK &&
	       gz_option_format(option, b, other, sizeof other) == GZ_OK && strcmp(one, other) == 0;
}

static bool is_key(const struct scene_key *key, const char *name)
{
	return strcmp(key->option->key, name) == 0;
}

/* Dims, type, endian, spacing and channels: only raw files and procedural volumes have them, and
 * raw files must have the first two. */
static bool wants_layout(const struct scene_writer *writer, const struct scene_key *key,
			 bool differs)
{
	const struct gz_scene_settings *settings = &writer->settings;
	const bool made = settings->volume_procedural != 0;
	const bool raw = !made && settings->dims[0] > 0;
	if (is_key(key, "volume.dims"))
		return settings->dims[0] > 0;
	if (is_key(key, "volume.type"))
		return raw || (made && settings->type != gz_scene_procedural_type(
								 settings->volume_procedural));
	return differs && (raw || (made && is_key(key, "volume.spacing")));
}

static bool key_is_written(const struct scene_writer *writer, const struct scene_key *key)
{
	static const char *const layout[] = { "volume.dims", "volume.type", "volume.endian",
					      "volume.spacing", "volume.channels" };
	const bool differs = !format_same(key->option, key->target, key->preset_target);
	if (strcmp(key->section, "display") == 0)
		return writer->saved->has_display;
	for (size_t i = 0; i < sizeof layout / sizeof layout[0]; i++)
		if (is_key(key, layout[i]))
			return wants_layout(writer, key, differs);
	return differs;
}

/* A value as text. Refused if its option does not allow it. */
static enum gz_result format_value(const struct scene_writer *writer, const struct scene_key *key,
				   char out_text[GZ_PATH_SIZE])
{
	if (gz_option_holds(key->option, key->target) &&
	    gz_option_format(key->option, key->target, out_text, GZ_PATH_SIZE) == GZ_OK)
		return GZ_OK;
	gz_err(writer->log, "%s: has a value that a scene cannot hold; set it again",
	       key->option->key);
	return GZ_ERR_INVAL;
}

static enum gz_result check_memory(const struct gz_text *text, const struct gz_log *log)
{
	if (!text->failed)
		return GZ_OK;
	gz_err(log, "no memory for the text of the scene");
	return GZ_ERR_NO_MEM;
}

/* The sections in the order in which the tables have them. */
static size_t list_sections(const struct scene_writer *writer,
			    char out_sections[SECTIONS_MAX][SECTION_SIZE])
{
	size_t count = 0;
	for (size_t table = 0; table < writer->tables; table++)
		for (size_t i = 0; i < writer->bindings[table].count; i++) {
			const struct scene_key key = key_of(writer, table, i);
			size_t k = 0;
			while (k < count && strcmp(out_sections[k], key.section) != 0)
				k++;
			if (k == count && count < SECTIONS_MAX)
				memcpy(out_sections[count++], key.section, SECTION_SIZE);
		}
	return count;
}

static enum gz_result print_section(const struct scene_writer *writer, const char *section,
				    struct gz_text *text)
{
	char value[GZ_PATH_SIZE];
	bool begun = false;
	for (size_t table = 0; table < writer->tables; table++)
		for (size_t i = 0; i < writer->bindings[table].count; i++) {
			const struct scene_key key = key_of(writer, table, i);
			if (strcmp(key.section, section) != 0 || !key_is_written(writer, &key))
				continue;
			enum gz_result result = format_value(writer, &key, value);
			if (result != GZ_OK)
				return result;
			if (!begun)
				gz_text_add(text, "%s[%s]\n", text->length ? "\n" : "", section);
			begun = true;
			gz_text_add(text, "%s = %s\n", key.name, value);
		}
	return GZ_OK;
}

enum gz_result gz_scene_print(const struct gz_scene_saved *saved, const struct gz_log *log,
			      struct gz_text *text)
{
	struct scene_writer writer;
	char sections[SECTIONS_MAX][SECTION_SIZE];
	begin_scene_writer(&writer, saved, log);
	const size_t count = list_sections(&writer, sections);
	enum gz_result result = GZ_OK;
	for (size_t i = 0; i < count && result == GZ_OK; i++)
		result = print_section(&writer, sections[i], text);
	return result == GZ_OK ? check_memory(text, log) : result;
}

/* Sections in which giving a key has a meaning of its own. */
static bool counts_when_given(const struct scene_key *key)
{
	return strcmp(key->section, "volume") == 0 || strcmp(key->section, "transfer") == 0 ||
	       strcmp(key->section, "display") == 0;
}

/* Edit one key of a text; @p said holds the value that the text gives. */
static enum gz_result edit_key(const struct scene_writer *writer, const struct scene_key *key,
			       const void *said, struct gz_text *text)
{
	char value[GZ_PATH_SIZE];
	const bool there = gz_ini_text_has(text, key->section, key->name);
	const bool wanted = key_is_written(writer, key);
	if (!wanted && (!there || counts_when_given(key))) {
		gz_ini_text_remove(text, key->section, key->name);
		return GZ_OK;
	}
	if (there && format_same(key->option, key->target, said))
		return GZ_OK;
	enum gz_result result = format_value(writer, key, value);
	if (result == GZ_OK)
		gz_ini_text_set(text, key->section, key->name, value);
	return result;
}

/* Whether a text has objects that the settings do not have. Their sections would stay. */
static bool has_other_objects(const struct gz_scene_objects *said,
			      const struct gz_scene_objects *wanted)
{
	for (size_t i = 0; i < said->count; i++)
		if (gz_scene_objects_find(wanted, said->items[i].section) < 0)
			return true;
	return false;
}

enum gz_result gz_scene_edit(const struct gz_scene_saved *saved, const char *name,
			     const struct gz_log *log, struct gz_text *text)
{
	struct scene_writer writer;
	struct gz_scene_settings said;
	bool has_display;
	begin_scene_writer(&writer, saved, log);
	enum gz_result result =
		gz_scene_parse(name, text->bytes, text->length, log, &said, &has_display);
	if (result == GZ_OK && has_other_objects(&said.objects, &saved->settings->objects)) {
		gz_text_free(text);
		return gz_scene_print(saved, log, text);
	}
	for (size_t table = 0; table < writer.tables && result == GZ_OK; table++)
		for (size_t i = 0; i < writer.bindings[table].count && result == GZ_OK; i++) {
			const struct scene_key key = key_of(&writer, table, i);
			result = edit_key(&writer, &key, said_target(&key, table, &said), text);
		}
	return result == GZ_OK ? check_memory(text, log) : result;
}

/* Check that the text reads back: a file name may hold characters that a line cannot. */
static enum gz_result check_reads_back(const struct scene_writer *writer, const char *path,
				       const struct gz_text *text)
{
	struct gz_scene_settings read;
	bool has_display;
	const enum gz_result result =
		gz_scene_parse(path, text->bytes, text->length, writer->log, &read, &has_display);
	if (result != GZ_OK)
		return GZ_ERR_INVAL;
	for (size_t table = 0; table < writer->tables; table++)
		for (size_t i = 0; i < writer->bindings[table].count; i++) {
			const struct scene_key key = key_of(writer, table, i);
			if (!key_is_written(writer, &key) ||
			    format_same(key.option, key.target, said_target(&key, table, &read)))
				continue;
			gz_err(writer->log,
			       "%s: %s cannot be written so that it reads back; rename the file "
			       "that it names",
			       path, key.option->key);
			return GZ_ERR_INVAL;
		}
	return GZ_OK;
}

/* The present text of the file if it is a scene. Any other file is replaced; the user has agreed.
 */
static void take_present_scene(const char *path, struct gz_text *text)
{
	struct gz_scene_settings settings;
	bool has_display;
	if (gz_text_add_file(text, path) == GZ_OK && text->length > 0 &&
	    gz_scene_parse(path, text->bytes, text->length, NULL, &settings, &has_display) == GZ_OK)
		return;
	gz_text_free(text);
}

enum gz_result gz_scene_write(const struct gz_scene_saved *saved, const char *path,
			      const struct gz_log *log)
{
	struct gz_scene_settings settings = *saved->settings;
	const struct gz_scene_saved moved = { &settings, saved->has_display, path };
	struct gz_text text = { 0 };
	enum gz_result result = gz_scene_move_files(&settings, saved->path, path, log);
	if (result != GZ_OK)
		return result;
	take_present_scene(path, &text);
	result = text.length > 0 ? gz_scene_edit(&moved, path, log, &text)
				 : gz_scene_print(&moved, log, &text);
	struct scene_writer writer;
	begin_scene_writer(&writer, &moved, log);
	if (result == GZ_OK)
		result = check_reads_back(&writer, path, &text);
	if (result == GZ_OK)
		result = gz_text_write(&text, path, log);
	gz_text_free(&text);
	return result;
}
