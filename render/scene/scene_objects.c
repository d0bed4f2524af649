#include "render/scene/scene_objects.h"

#include <fnmatch.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "base/ini.h"
#include "render/illustration/illustration_look.h"
#include "render/scene/techniques.h"

#define GZ_LOG_MODULE "scene"

static const char object_word[] = "object";

#define AT(field) offsetof(struct gz_scene_object, field)

const struct gz_option gz_scene_object_options[GZ_SCENE_OBJECT_OPTIONS] = {
	{ "object.technique", GZ_OPTION_CHOICE, AT(technique), .choices = gz_technique_names,
	  .preset = "raycast", .help = "how the object is drawn" },
	{ "object.volume", GZ_OPTION_STRING, AT(volume), .max = GZ_SCENE_FILE_SIZE, .preset = "",
	  .help = "volume file, searched as volume.file is" },
	{ "object.transfer", GZ_OPTION_STRING, AT(transfer), .max = GZ_SCENE_FILE_SIZE,
	  .preset = "",
	  .help = "transfer function of the volume or the particles; transfer.file replaces it; "
		  "without both one is "
		  "made" },
	{ "object.labels", GZ_OPTION_STRING, AT(labels), .max = GZ_SCENE_FILE_SIZE, .preset = "",
	  .help = "label volume: a whole number for each region" },
	{ "object.mesh", GZ_OPTION_STRING, AT(mesh), .max = GZ_SCENE_FILE_SIZE, .preset = "",
	  .help = "triangle mesh" },
	{ "object.particles", GZ_OPTION_STRING, AT(particles), .max = GZ_SCENE_FILE_SIZE,
	  .preset = "",
	  .help = "file of particles; section [particles] says how they become a volume" },
	{ "object.regions", GZ_OPTION_STRING, AT(regions), .max = GZ_SCENE_FILE_SIZE, .preset = "",
	  .help = "of labels: names or numbers of those to show, such as Hippocampus_* 37; -37 "
		  "leaves one out" },
	{ "object.visible", GZ_OPTION_BOOL, AT(visible), .preset = "yes",
	  .help = "whether the object is shown" },
	{ "object.importance", GZ_OPTION_DOUBLE, AT(style.importance), 0, 1, .preset = "0.5",
	  .help = "importance of the object in illustrations, 0 to 1" },
	{ "object.transparency", GZ_OPTION_DOUBLE, AT(style.transparency), 0, 1, .preset = "0",
	  .help = "how much of what is behind the object shows in illustrations, 0 to 1" },
	{ "object.drawing", GZ_OPTION_CHOICE, AT(style.drawing),
	  .choices = gz_illustration_said_drawings, .preset = "scene",
	  .help = "how illustrations draw the object; scene: as illustration.drawing says" },
	{ "object.hatch_direction", GZ_OPTION_CHOICE, AT(style.hatch_direction),
	  .choices = gz_illustration_said_directions, .preset = "scene",
	  .help = "hatches: strokes run along the object's tubes and ridges, or around them; "
		  "scene: as illustration.hatch_direction says" },
	{ "object.template", GZ_OPTION_STRING, AT(template_name), .max = GZ_SCENE_FILE_SIZE,
	  .preset = "",
	  .help = "template of illustrative settings: a name, or a file, searched as volume.file "
		  "is" },
};

struct gz_option_binding gz_scene_object_bind(struct gz_scene_object *object,
					      struct gz_scene_object_table *table)
{
	for (size_t i = 0; i < GZ_SCENE_OBJECT_OPTIONS; i++) {
		table->options[i] = gz_scene_object_options[i];
		snprintf(table->keys[i], sizeof table->keys[i], "%s%s", object->section,
			 strchr(gz_scene_object_options[i].key, '.'));
		table->options[i].key = table->keys[i];
	}
	return (struct gz_option_binding) { table->options, GZ_SCENE_OBJECT_OPTIONS, object, NULL };
}

struct gz_option_binding gz_scene_object_bind_shown(struct gz_scene_object *object,
						    struct gz_scene_object_table *table)
{
	struct gz_option_binding binding = gz_scene_object_bind(object, table);
	binding.options += GZ_SCENE_OBJECT_OPTIONS - GZ_SCENE_OBJECT_SHOWN_OPTIONS;
	binding.count = GZ_SCENE_OBJECT_SHOWN_OPTIONS;
	return binding;
}

const char *gz_scene_object_name(const struct gz_scene_object *object)
{
	return object->section + sizeof object_word;
}

int gz_scene_objects_find(const struct gz_scene_objects *objects, const char *section)
{
	for (size_t i = 0; i < objects->count; i++)
		if (strcmp(objects->items[i].section, section) == 0)
			return (int)i;
	return -1;
}

/* A scan of a text for objects. */
struct object_scan {
	const char *name;
	const struct gz_log *log;
	struct gz_scene_objects *objects;
};

static enum gz_result refuse_object_section(const struct object_scan *scan, int line,
					    const char *what)
{
	gz_err(scan->log, "%s:%d: %s", scan->name, line, what);
	return GZ_ERR_FORMAT;
}

static enum gz_result add_object_section(void *user, const struct gz_ini_item *item)
{
	const struct object_scan *scan = user;
	struct gz_scene_objects *objects = scan->objects;
	const size_t length = sizeof object_word - 1;
	const char *section = item->section;
	if (strncmp(section, object_word, length) != 0 ||
	    (section[length] != ' ' && section[length] != '\0') ||
	    gz_scene_objects_find(objects, section) >= 0)
		return GZ_OK;
	if (section[length] == '\0' || strchr(section, '.') || section[length + 1] == ' ')
		return refuse_object_section(
			scan, item->line,
			"an object has a name without a dot, as in [object liver]");
	if (objects->count == GZ_SCENE_OBJECTS_MAX)
		return refuse_object_section(scan, item->line, "a scene has at most 32 objects");
	struct gz_scene_object *object = &objects->items[objects->count++];
	snprintf(object->section, sizeof object->section, "%s", section);
	const struct gz_option_binding binding = { gz_scene_object_options, GZ_SCENE_OBJECT_OPTIONS,
						   object, NULL };
	return gz_options_preset(&binding);
}

enum gz_result gz_scene_objects_scan(const char *name, const char *text, size_t size,
				     const struct gz_log *log, struct gz_scene_objects *out_objects)
{
	struct object_scan scan = { name, log, out_objects };
	*out_objects = (struct gz_scene_objects) { 0 };
	return text ? gz_ini_read_text(name, text, size, add_object_section, &scan, log)
		    : gz_ini_read_file(name, add_object_section, &scan, log);
}

/* The keys that name an object's data, and the kinds of data. */
static const struct {
	const char *key;
	enum gz_object_data kind;
	size_t offset; /* of the file in struct gz_scene_object */
} data_keys[] = {
	{ "volume", GZ_OBJECT_VOLUME, AT(volume) },
	{ "labels", GZ_OBJECT_LABELS, AT(labels) },
	{ "mesh", GZ_OBJECT_MESH, AT(mesh) },
	{ "particles", GZ_OBJECT_PARTICLES, AT(particles) },
};

enum { DATA_KEYS = sizeof data_keys / sizeof data_keys[0] };

/* The kinds of data that an object is given, as bits, and the key of the last one. */
static unsigned kinds_of(const struct gz_scene_object *object, const char **out_key)
{
	unsigned kinds = 0;
	for (size_t i = 0; i < DATA_KEYS; i++)
		if (((const char *)object + data_keys[i].offset)[0] != '\0') {
			kinds |= data_keys[i].kind;
			*out_key = data_keys[i].key;
		}
	return kinds;
}

unsigned gz_scene_object_kinds(const struct gz_scene_object *object)
{
	const char *key;
	return kinds_of(object, &key);
}

/* The first technique that shows a kind of data; NULL if none does. */
static const struct gz_technique *technique_for(unsigned kind)
{
	for (size_t i = 0; gz_techniques[i]; i++)
		if (gz_techniques[i]->shows & kind)
			return gz_techniques[i];
	return NULL;
}

/* Refuse a kind of data that the object's technique does not show: name a technique that does, or
 * the kinds that some technique shows. */
static enum gz_result refuse_kind(const struct gz_scene_object *object, const char *key,
				  const struct gz_technique *other, const char *name,
				  const struct gz_log *log)
{
	char shown[64] = "";
	size_t used = 0;
	if (other) {
		gz_err(log, "%s: %s: the technique %s does not show %s; set technique = %s", name,
		       object->section, gz_techniques[object->technique]->name, key, other->name);
		return GZ_ERR_FORMAT;
	}
	for (size_t i = 0; i < DATA_KEYS; i++)
		if (technique_for(data_keys[i].kind))
			used += (size_t)snprintf(shown + used, sizeof shown - used, "%s%s",
						 used ? ", " : "", data_keys[i].key);
	gz_err(log, "%s: %s: no technique of this version shows %s; an object may have: %s", name,
	       object->section, key, shown);
	return GZ_ERR_FORMAT;
}

static enum gz_result check_object(const struct gz_scene_object *object, const char *name,
				   const struct gz_log *log)
{
	const struct gz_technique *technique = gz_techniques[object->technique];
	const char *key = "";
	const unsigned kinds = kinds_of(object, &key);
	if (kinds == 0 || (kinds & (kinds - 1)) != 0) {
		gz_err(log, "%s: %s: give one of volume, labels, mesh and particles", name,
		       object->section);
		return GZ_ERR_FORMAT;
	}
	if (object->transfer[0] && kinds != GZ_OBJECT_VOLUME && kinds != GZ_OBJECT_PARTICLES) {
		gz_err(log,
		       "%s: %s: only a volume and particles have a transfer function; remove "
		       "transfer",
		       name, object->section);
		return GZ_ERR_FORMAT;
	}
	if (object->regions[0] && kinds != GZ_OBJECT_LABELS) {
		gz_err(log, "%s: %s: only labels have regions; remove regions", name,
		       object->section);
		return GZ_ERR_FORMAT;
	}
	if (technique->shows & kinds)
		return GZ_OK;
	return refuse_kind(object, key, technique_for(kinds), name, log);
}

enum gz_result gz_scene_objects_check(const struct gz_scene_objects *objects, const char *name,
				      const struct gz_log *log)
{
	enum gz_result result = GZ_OK;
	for (size_t i = 0; i < objects->count && result == GZ_OK; i++)
		result = check_object(&objects->items[i], name, log);
	return result;
}

/* Take the next word of a text. Returns false at its end. */
static bool next_region(const char **text, char word[GZ_SCENE_FILE_SIZE])
{
	*text += strspn(*text, " \t");
	const size_t length = strcspn(*text, " \t");
	memcpy(word, *text, length);
	word[length] = '\0';
	*text += length;
	return length > 0;
}

bool gz_scene_object_has_region(const struct gz_scene_object *object, int32_t number,
				const char *name)
{
	const char *rest = object->regions;
	char word[GZ_SCENE_FILE_SIZE], digits[16];
	bool shown = rest[strspn(rest, " \t")] == '\0' || rest[strspn(rest, " \t")] == '-';
	snprintf(digits, sizeof digits, "%" PRId32, number);
	while (next_region(&rest, word)) {
		const bool leaves_out = word[0] == '-';
		const char *pattern = word + leaves_out;
		if (fnmatch(pattern, name, 0) == 0 || fnmatch(pattern, digits, 0) == 0)
			shown = !leaves_out;
	}
	return shown;
}

enum gz_result gz_scene_objects_of_mesh(const char *file, struct gz_scene_objects *out_objects)
{
	const struct gz_technique *technique = technique_for(GZ_OBJECT_MESH);
	*out_objects = (struct gz_scene_objects) { .count = 1 };
	struct gz_scene_object *object = &out_objects->items[0];
	const struct gz_option_binding binding = { gz_scene_object_options, GZ_SCENE_OBJECT_OPTIONS,
						   object, NULL };
	const enum gz_result result = gz_options_preset(&binding);
	if (result != GZ_OK || strlen(file) >= sizeof object->mesh)
		return result == GZ_OK ? GZ_ERR_FULL : result;
	snprintf(object->section, sizeof object->section, "%s mesh", object_word);
	memcpy(object->mesh, file, strlen(file) + 1);
	for (int i = 0; gz_techniques[i]; i++)
		if (gz_techniques[i] == technique)
			object->technique = i;
	return GZ_OK;
}

bool gz_scene_objects_same(const struct gz_scene_objects *a, const struct gz_scene_objects *b)
{
	if (a->count != b->count)
		return false;
	for (size_t i = 0; i < a->count; i++)
		if (strcmp(a->items[i].section, b->items[i].section) != 0 ||
		    !gz_options_same(gz_scene_object_options, GZ_SCENE_OBJECT_OPTIONS, &a->items[i],
				     &b->items[i]))
			return false;
	return true;
}
