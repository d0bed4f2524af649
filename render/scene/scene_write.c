#include "render/scene/scene_write.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/ini.h"
#include "render/scene/scene_files.h"

#define GZ_LOG_MODULE "scene"

#define BLANKS " \t"

enum {
	SECTIONS_MAX = 32 + GZ_SCENE_OBJECTS_MAX,
	SECTION_SIZE = GZ_SCENE_SECTION_SIZE,
	TABLES_MAX = GZ_SCENE_TABLE_COUNT + GZ_SCENE_OBJECTS_MAX,
};

/* Settings with all that is asked of them again and again. */
struct writing {
	const struct gz_scene_saved *saved;
	const struct gz_log *log;
	struct gz_scene_settings settings, presets;
	struct gz_scene_object object_presets;
	struct gz_scene_object_table object_tables[GZ_SCENE_OBJECTS_MAX];
	size_t tables;
	struct gz_option_binding bindings[TABLES_MAX], preset_bindings[TABLES_MAX];
};

/* An option and where its value and its preset are. */
struct key {
	const struct gz_option *option;
	const void *target, *preset_target;
	char section[SECTION_SIZE];
	const char *name;
};

static void begin_writing(struct writing *writing, const struct gz_scene_saved *saved,
			  const struct gz_log *log)
{
	writing->saved = saved;
	writing->log = log;
	writing->settings = *saved->settings;
	gz_scene_settings_preset(&writing->presets);
	writing->object_presets = (struct gz_scene_object) { .section = "object" };
	const struct gz_option_binding object = { gz_scene_object_options, GZ_SCENE_OBJECT_OPTIONS,
						  &writing->object_presets, NULL };
	gz_options_preset(&object);
	gz_scene_bind(&writing->settings, writing->bindings);
	gz_scene_bind(&writing->presets, writing->preset_bindings);
	writing->tables = GZ_SCENE_TABLE_COUNT;
	for (size_t i = 0; i < writing->settings.objects.count; i++) {
		writing->bindings[writing->tables] = gz_scene_object_bind(
			&writing->settings.objects.items[i], &writing->object_tables[i]);
		writing->preset_bindings[writing->tables++] = object;
	}
}

/* The settings that a text now gives to the table of a key; the presets for an object that it
 * lacks. */
static const void *said_by(const struct key *key, size_t table, struct gz_scene_settings *said)
{
	struct gz_option_binding bindings[GZ_SCENE_TABLE_COUNT];
	gz_scene_bind(said, bindings);
	if (table < GZ_SCENE_TABLE_COUNT)
		return bindings[table].target;
	const struct gz_scene_object *own = key->target;
	const int object = gz_scene_objects_find(&said->objects, own->section);
	return object < 0 ? key->preset_target : &said->objects.items[object];
}

static struct key key_of(const struct writing *writing, size_t table, size_t index)
{
	const struct gz_option *option = &writing->bindings[table].options[index];
	const char *dot = strchr(option->key, '.');
	struct key key = {
		.option = option,
		.target = writing->bindings[table].target,
		.preset_target = writing->preset_bindings[table].target,
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

static bool is_key(const struct key *key, const char *name)
{
	return strcmp(key->option->key, name) == 0;
}

/* Dims, type, endian and spacing: raw files and procedural volumes have them, and some must. */
static bool wants_layout(const struct writing *writing, const struct key *key, bool differs)
{
	const struct gz_scene_settings *settings = &writing->settings;
	const bool made = settings->volume_procedural != 0;
	const bool raw = !made && settings->dims[0] > 0;
	if (is_key(key, "volume.dims"))
		return settings->dims[0] > 0;
	if (is_key(key, "volume.type"))
		return raw || (made && settings->type != gz_scene_procedural_type(
								 settings->volume_procedural));
	return differs && (raw || (made && is_key(key, "volume.spacing")));
}

static bool is_wanted(const struct writing *writing, const struct key *key)
{
	static const char *const layout[] = { "volume.dims", "volume.type", "volume.endian",
					      "volume.spacing" };
	const bool differs = !format_same(key->option, key->target, key->preset_target);
	if (strcmp(key->section, "display") == 0)
		return writing->saved->has_display;
	for (size_t i = 0; i < sizeof layout / sizeof layout[0]; i++)
		if (is_key(key, layout[i]))
			return wants_layout(writing, key, differs);
	return differs;
}

/* A value as text; refused where its table would refuse it. */
static enum gz_result value_of(const struct writing *writing, const struct key *key,
			       char out_text[GZ_PATH_SIZE])
{
	if (gz_option_holds(key->option, key->target) &&
	    gz_option_format(key->option, key->target, out_text, GZ_PATH_SIZE) == GZ_OK)
		return GZ_OK;
	gz_err(writing->log, "%s: holds a value that no scene can have; set it anew",
	       key->option->key);
	return GZ_ERR_INVAL;
}

static enum gz_result finish(const struct gz_text *text, const struct gz_log *log)
{
	if (!text->failed)
		return GZ_OK;
	gz_err(log, "no memory for the text of the scene");
	return GZ_ERR_NO_MEM;
}

/* The sections in the order in which the tables have them. */
static size_t list_sections(const struct writing *writing,
			    char out_sections[SECTIONS_MAX][SECTION_SIZE])
{
	size_t count = 0;
	for (size_t table = 0; table < writing->tables; table++)
		for (size_t i = 0; i < writing->bindings[table].count; i++) {
			const struct key key = key_of(writing, table, i);
			size_t k = 0;
			while (k < count && strcmp(out_sections[k], key.section) != 0)
				k++;
			if (k == count && count < SECTIONS_MAX)
				memcpy(out_sections[count++], key.section, SECTION_SIZE);
		}
	return count;
}

static enum gz_result print_section(const struct writing *writing, const char *section,
				    struct gz_text *text)
{
	char value[GZ_PATH_SIZE];
	bool begun = false;
	for (size_t table = 0; table < writing->tables; table++)
		for (size_t i = 0; i < writing->bindings[table].count; i++) {
			const struct key key = key_of(writing, table, i);
			if (strcmp(key.section, section) != 0 || !is_wanted(writing, &key))
				continue;
			enum gz_result result = value_of(writing, &key, value);
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
	struct writing writing;
	char sections[SECTIONS_MAX][SECTION_SIZE];
	begin_writing(&writing, saved, log);
	const size_t count = list_sections(&writing, sections);
	enum gz_result result = GZ_OK;
	for (size_t i = 0; i < count && result == GZ_OK; i++)
		result = print_section(&writing, sections[i], text);
	return result == GZ_OK ? finish(text, log) : result;
}

/* Sections whose keys mean something by being given. */
static bool counts_when_given(const struct key *key)
{
	return strcmp(key->section, "volume") == 0 || strcmp(key->section, "transfer") == 0 ||
	       strcmp(key->section, "display") == 0;
}

/* One key of a text: @p said is what the text says now. */
static enum gz_result edit_key(const struct writing *writing, const struct key *key,
			       const void *said, struct gz_text *text)
{
	char value[GZ_PATH_SIZE];
	const bool there = gz_ini_text_has(text, key->section, key->name);
	const bool wanted = is_wanted(writing, key);
	if (!wanted && (!there || counts_when_given(key))) {
		gz_ini_text_remove(text, key->section, key->name);
		return GZ_OK;
	}
	if (there && format_same(key->option, key->target, said))
		return GZ_OK;
	enum gz_result result = value_of(writing, key, value);
	if (result == GZ_OK)
		gz_ini_text_set(text, key->section, key->name, value);
	return result;
}

enum gz_result gz_scene_edit(const struct gz_scene_saved *saved, const char *name,
			     const struct gz_log *log, struct gz_text *text)
{
	struct writing writing;
	struct gz_scene_settings said;
	bool has_display;
	begin_writing(&writing, saved, log);
	enum gz_result result =
		gz_scene_parse(name, text->bytes, text->length, log, &said, &has_display);
	for (size_t table = 0; table < writing.tables && result == GZ_OK; table++)
		for (size_t i = 0; i < writing.bindings[table].count && result == GZ_OK; i++) {
			const struct key key = key_of(&writing, table, i);
			result = edit_key(&writing, &key, said_by(&key, table, &said), text);
		}
	return result == GZ_OK ? finish(text, log) : result;
}

/* How a name becomes another: as gz_scene_rename_file(). */
struct move {
	const char *from, *to;
	const struct gz_log *log;
};

static enum gz_result move_name(const struct move *move, const char *name,
				char out_name[GZ_PATH_SIZE])
{
	char path[GZ_PATH_SIZE];
	if (move->to)
		return gz_scene_rename_file(move->from, name, move->to, out_name);
	if (!name[0] || gz_scene_find_file(move->from, name, path) != GZ_OK) {
		memmove(out_name, name, strlen(name) + 1);
		return GZ_OK;
	}
	char *real = realpath(path, NULL);
	const bool fits = real && strlen(real) < GZ_PATH_SIZE;
	if (fits)
		memcpy(out_name, real, strlen(real) + 1);
	free(real);
	return fits ? GZ_OK : GZ_ERR_FULL;
}

static enum gz_result move_field(const struct move *move, const char *key, char name[GZ_PATH_SIZE])
{
	char moved[GZ_PATH_SIZE];
	const enum gz_result result = move_name(move, name, moved);
	if (result != GZ_OK) {
		gz_err(move->log, "%s: the path of %s is too long for a scene; move the file", key,
		       name);
		return result;
	}
	memset(name, 0, GZ_PATH_SIZE); /* equal settings are equal bytes */
	memcpy(name, moved, strlen(moved) + 1);
	return GZ_OK;
}

/* One of several names, behind those that @all has already. */
static enum gz_result move_listed(const struct move *move, const char *name, struct gz_text *all)
{
	static const char key[] = "transfer.also";
	char moved[GZ_PATH_SIZE];
	const enum gz_result result = move_name(move, name, moved);
	if (result != GZ_OK) {
		gz_err(move->log, "%s: the path of %s is too long for a scene; move the file", key,
		       name);
		return result;
	}
	if (strcmp(moved, name) != 0 && strpbrk(moved, BLANKS)) {
		gz_err(move->log,
		       "%s: the path of %s has a blank, which parts names there; save the scene "
		       "beside it",
		       key, name);
		return GZ_ERR_INVAL;
	}
	gz_text_add(all, "%s%s", all->length ? " " : "", moved);
	return all->failed ? GZ_ERR_NO_MEM : GZ_OK;
}

/* Each of several names parted by blanks. */
static enum gz_result move_list(const struct move *move, char names[GZ_PATH_SIZE])
{
	char copy[GZ_PATH_SIZE];
	struct gz_text all = { 0 };
	enum gz_result result = GZ_OK;
	memcpy(copy, names, sizeof copy);
	char *rest = copy;
	for (char *name = strsep(&rest, BLANKS); name && result == GZ_OK;
	     name = strsep(&rest, BLANKS))
		if (name[0])
			result = move_listed(move, name, &all);
	if (result == GZ_OK && all.length >= GZ_PATH_SIZE) {
		gz_err(move->log,
		       "transfer.also: the paths are too long for a scene; move the files");
		result = GZ_ERR_FULL;
	}
	if (result == GZ_ERR_NO_MEM)
		gz_err(move->log, "transfer.also: no memory for the paths");
	if (result == GZ_OK) {
		memset(names, 0, GZ_PATH_SIZE);
		memcpy(names, all.bytes ? all.bytes : "", all.length);
	}
	gz_text_free(&all);
	return result;
}

/* A gaze log, which is looked up beside the scene and where the program was called. */
static enum gz_result move_log(const struct move *move, char gaze[GZ_PATH_SIZE])
{
	char path[GZ_PATH_SIZE];
	if (!gz_path_ends(gaze, ".gzl"))
		return GZ_OK;
	if (gz_scene_find_file(move->from, gaze, path) == GZ_OK)
		return move_field(move, "view.gaze", gaze);
	const struct move from_here = { .from = "", .to = move->to, .log = move->log };
	return move_field(&from_here, "view.gaze", gaze);
}

/* A file of an object, whose fields are shorter. */
static enum gz_result move_object_file(const struct move *move, const char *section,
				       char name[GZ_SCENE_FILE_SIZE])
{
	char moved[GZ_PATH_SIZE];
	snprintf(moved, sizeof moved, "%s", name);
	enum gz_result result = move_field(move, section, moved);
	if (result == GZ_OK && strlen(moved) >= GZ_SCENE_FILE_SIZE) {
		gz_err(move->log, "%s: the path of %s is too long for a scene; move the file",
		       section, name);
		result = GZ_ERR_FULL;
	}
	if (result == GZ_OK)
		memcpy(name, moved, strlen(moved) + 1);
	return result;
}

static enum gz_result move_object_files(const struct move *move, struct gz_scene_object *object)
{
	char *const files[] = { object->volume, object->transfer, object->labels, object->mesh,
				object->particles };
	enum gz_result result = GZ_OK;
	for (size_t i = 0; i < sizeof files / sizeof files[0] && result == GZ_OK; i++)
		result = move_object_file(move, object->section, files[i]);
	return result;
}

static enum gz_result move_files(struct gz_scene_settings *settings, const struct move *move)
{
	enum gz_result result = move_field(move, "volume.file", settings->volume_file);
	if (result == GZ_OK)
		result = move_field(move, "transfer.file", settings->transfer_file);
	if (result == GZ_OK)
		result = move_list(move, settings->transfer_also);
	if (result == GZ_OK)
		result = move_field(move, "foveation.table", settings->foveation.table_file);
	if (result == GZ_OK)
		result = move_log(move, settings->view.gaze);
	for (size_t i = 0; i < settings->objects.count && result == GZ_OK; i++)
		result = move_object_files(move, &settings->objects.items[i]);
	return result;
}

enum gz_result gz_scene_move_files(struct gz_scene_settings *settings, const char *from,
				   const char *to, const struct gz_log *log)
{
	const struct move move = { .from = from, .to = to, .log = log };
	return move_files(settings, &move);
}

enum gz_result gz_scene_anchor_files(struct gz_scene_settings *settings, const char *from,
				     const struct gz_log *log)
{
	const struct move move = { .from = from, .log = log };
	return move_files(settings, &move);
}

/* What was written must read back: a name may hold what a line cannot. */
static enum gz_result check_reads_back(const struct writing *writing, const char *path,
				       const struct gz_text *text)
{
	struct gz_scene_settings read;
	bool has_display;
	const enum gz_result result =
		gz_scene_parse(path, text->bytes, text->length, writing->log, &read, &has_display);
	if (result != GZ_OK)
		return GZ_ERR_INVAL;
	for (size_t table = 0; table < writing->tables; table++)
		for (size_t i = 0; i < writing->bindings[table].count; i++) {
			const struct key key = key_of(writing, table, i);
			if (!is_wanted(writing, &key) ||
			    format_same(key.option, key.target, said_by(&key, table, &read)))
				continue;
			gz_err(writing->log,
			       "%s: %s cannot be written so that it reads back; rename the file "
			       "that it names",
			       path, key.option->key);
			return GZ_ERR_INVAL;
		}
	return GZ_OK;
}

/* The text that is there, if it is a scene: whoever saves over another file has been asked. */
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
	struct writing writing;
	begin_writing(&writing, &moved, log);
	if (result == GZ_OK)
		result = check_reads_back(&writing, path, &text);
	if (result == GZ_OK)
		result = gz_text_write(&text, path, log);
	gz_text_free(&text);
	return result;
}
