/* The JSON file beside a file of answers. */
#include <jansson.h>
#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>

#include "view/experiment/answer_columns.h"

static void set_text(json_t *object, const char *key, const char *text)
{
	if (text && text[0])
		json_object_set_new(object, key, json_string(text));
}

/* "a: one | b: two" as an object. */
static json_t *levels_of(const char *text)
{
	json_t *levels = json_object();
	while (levels && text && *text) {
		size_t length = strcspn(text, "|"), key = strcspn(text, ":");
		bool more = text[length] == '|';
		char *name = strndup(text, key);
		const char *value = text + key + 2; /* behind ": " */
		size_t value_length = length - key - 2 - (more ? 1 : 0);
		if (name)
			json_object_set_new(levels, name, json_stringn(value, value_length));
		free(name);
		text += length + (more ? 2 : 0); /* behind "| " */
	}
	return levels;
}

static json_t *column_of(const struct gz_answer_column *column)
{
	json_t *object = json_object();
	set_text(object, "Description", column->help);
	set_text(object, "Units", column->units);
	if (column->levels)
		json_object_set_new(object, "Levels", levels_of(column->levels));
	return object;
}

static json_t *software_of(const char *version)
{
	struct utsname system;
	json_t *object = json_object();
	if (uname(&system) == 0)
		set_text(object, "OperatingSystem", system.sysname);
	set_text(object, "SoftwareName", "gazeview");
	set_text(object, "SoftwareVersion", version);
	return object;
}

enum gz_result gz_answer_columns_write(const char *path, const struct gz_experiment *experiment,
				       const char *version)
{
	json_t *root = json_object();
	set_text(root, "TaskName", experiment->params.name);
	set_text(root, "Instructions", experiment->instructions);
	json_object_set_new(root, "StimulusPresentation", software_of(version));
	for (size_t i = 0; i < gz_answer_column_count; i++)
		json_object_set_new(root, gz_answer_columns[i].name,
				    column_of(&gz_answer_columns[i]));
	if (!root)
		return GZ_ERR_NO_MEM;
	int failed = json_dump_file(root, path, JSON_INDENT(2));
	json_decref(root);
	return failed ? GZ_ERR_IO : GZ_OK;
}
