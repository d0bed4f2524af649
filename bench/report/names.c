#include "bench/report/names.h"

#include <ctype.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

/* Text that is cut where it is full, never within a character. */
struct line {
	char *bytes;
	size_t length;
};

static void append_to_line(struct line *line, const char *text, size_t length)
{
	if (line->length + length >= GZ_NAMES_SIZE)
		length = GZ_NAMES_SIZE - 1 - line->length;
	memcpy(line->bytes + line->length, text, length);
	line->length += length;
	line->bytes[line->length] = '\0';
	while (line->length == GZ_NAMES_SIZE - 1 &&
	       ((unsigned char)line->bytes[line->length - 1] & 0x80) != 0)
		line->bytes[--line->length] = '\0';
}

static void append_words(struct line *line, const char *text)
{
	append_to_line(line, text, strlen(text));
}

/* "px" of "blend_px": a unit stands behind its value. */
static const char *unit_of_key(const char *key, size_t length)
{
	static const char *const units[] = { "px", "deg" };
	for (size_t i = 0; i < sizeof units / sizeof units[0]; i++) {
		const size_t unit = strlen(units[i]);
		if (length > unit + 1 && key[length - unit - 1] == '_' &&
		    strncmp(key + length - unit, units[i], unit) == 0)
			return units[i];
	}
	return NULL;
}

/* "acuity_slope" of the method acuity is "slope": its own name says nothing new. */
static void append_key(struct line *line, const char *method, const char *key, size_t length)
{
	const size_t prefix = strlen(method);
	if (length > prefix + 1 && strncmp(key, method, prefix) == 0 && key[prefix] == '_') {
		key += prefix + 1;
		length -= prefix + 1;
	}
	const char *unit = unit_of_key(key, length);
	length -= unit ? strlen(unit) + 1 : 0;
	for (size_t i = 0; i < length; i++)
		append_to_line(line, key[i] == '_' ? " " : key + i, 1);
}

/* Options behind the method, each as "key value", commas between. */
static void append_options(struct line *line, const struct gz_study_variant *variant)
{
	const char *at = strchr(variant->text, ':');
	bool first = true;
	while (at) {
		const char *option = at + 1;
		const size_t length = strcspn(option, ":"), key = strcspn(option, "=:");
		const char *unit = unit_of_key(option, key);
		append_words(line, first ? "" : ", ");
		append_key(line, variant->method, option, key);
		if (key < length) {
			append_words(line, " ");
			append_to_line(line, option + key + 1, length - key - 1);
		}
		if (unit) {
			append_words(line, " ");
			append_words(line, unit);
		}
		first = false;
		at = strchr(option, ':');
	}
}

void gz_variant_words(const struct gz_study_variant *variant, char out_words[GZ_NAMES_SIZE])
{
	struct line line = { out_words, 0 };
	out_words[0] = '\0';
	append_words(&line, variant->method);
	if (strchr(variant->text, ':')) {
		append_words(&line, ", ");
		append_options(&line, variant);
	}
}

static const struct gz_study_variant *variant_of(const struct gz_study *study,
						 const struct gz_group *group, size_t series)
{
	return &study->variants[group->series[series].variant];
}

/* The one key in which all variants of the curve differ: false if there is no such key. */
static bool one_key(const struct gz_study *study, const struct gz_group *group,
		    const struct gz_curve *curve, const char **out_key, size_t *out_length)
{
	const char *key = NULL;
	size_t length = 0;
	for (size_t i = 0; i < curve->count; i++) {
		const char *option = strchr(variant_of(study, group, curve->series[i])->text, ':');
		if (!option)
			continue;
		option++;
		const size_t here = strcspn(option, "=:");
		if (option[here] != '=' || strchr(option, ':') ||
		    (key && (here != length || strncmp(key, option, length) != 0)))
			return false;
		key = option;
		length = here;
	}
	*out_key = key;
	*out_length = length;
	return key != NULL && curve->count > 1;
}

void gz_variant_label(const struct gz_study *study, const struct gz_group *group,
		      const struct gz_curve *curve, size_t series, char out_label[GZ_NAMES_SIZE])
{
	const struct gz_study_variant *variant = variant_of(study, group, series);
	const char *key;
	size_t length;
	struct line line = { out_label, 0 };
	out_label[0] = '\0';
	if (!strchr(variant->text, ':'))
		append_words(&line, curve->count > 1 ? "preset" : "");
	else if (one_key(study, group, curve, &key, &length))
		append_words(&line, strchr(variant->text, '=') + 1);
	else
		append_options(&line, variant);
}

void gz_curve_name(const struct gz_study *study, const struct gz_group *group,
		   const struct gz_curve *curve, char out_name[GZ_NAMES_SIZE])
{
	const char *key;
	size_t length;
	struct line line = { out_name, 0 };
	out_name[0] = '\0';
	append_words(&line, curve->method);
	if (one_key(study, group, curve, &key, &length)) {
		append_words(&line, ", ");
		append_key(&line, curve->method, key, length);
	}
}

void gz_scene_words(const struct gz_study_scene *scene, char out_words[GZ_NAMES_SIZE])
{
	if (scene->transfer[0] == '\0' || strcmp(scene->transfer, scene->name) == 0)
		snprintf(out_words, GZ_NAMES_SIZE, "%.200s", scene->name);
	else
		snprintf(out_words, GZ_NAMES_SIZE, "%.120s (%.120s)", scene->name, scene->transfer);
}

void gz_growth_words(const struct gz_study *study, const struct gz_scaling *scaling,
		     char out_words[GZ_NAMES_SIZE])
{
	char scene[GZ_NAMES_SIZE] = "all scenes", size[32] = "", backend[GZ_NAME_SIZE + 8] = "";
	if (scaling->kind != GZ_SCALING_VOXELS)
		gz_scene_words(&study->scenes[scaling->scene], scene);
	if (scaling->kind != GZ_SCALING_PIXELS)
		snprintf(size, sizeof size, " at %d×%d", study->sizes[scaling->size][0],
			 study->sizes[scaling->size][1]);
	if (scaling->kind != GZ_SCALING_THREADS)
		snprintf(backend, sizeof backend, " on %s", study->backends[scaling->backend]);
	snprintf(out_words, GZ_NAMES_SIZE, "%.170s%s%.50s", scene, size, backend);
}

void gz_group_words(const struct gz_study *study, const struct gz_group *group,
		    char out_words[GZ_NAMES_SIZE])
{
	char scene[GZ_NAMES_SIZE];
	gz_scene_words(&study->scenes[group->scene], scene);
	snprintf(out_words, GZ_NAMES_SIZE, "%.180s at %d×%d on %.40s", scene,
		 study->sizes[group->size][0], study->sizes[group->size][1],
		 study->backends[group->backend]);
}

void gz_chart_name(const struct gz_summary *summary, const char *kind, const struct gz_group *group,
		   char out_name[GZ_NAMES_SIZE])
{
	const struct gz_study *study = summary->study;
	struct line line = { out_name, 0 };
	out_name[0] = '\0';
	append_words(&line, kind);
	if (group && summary->group_count > 1) {
		char rest[GZ_NAMES_SIZE];
		const struct gz_study_scene *scene = &study->scenes[group->scene];
		const bool same = strcmp(scene->transfer, scene->name) == 0;
		snprintf(rest, sizeof rest, "-%.80s%s%.80s-%dx%d-%.40s", scene->name,
			 same ? "" : "-", same ? "" : scene->transfer, study->sizes[group->size][0],
			 study->sizes[group->size][1], study->backends[group->backend]);
		append_words(&line, rest);
	}
	for (char *byte = out_name; *byte; byte++)
		if (!isalnum((unsigned char)*byte) && !strchr("._-", *byte))
			*byte = '-';
}
