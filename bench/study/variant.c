#include "bench/study/variant.h"

#include <stdio.h>
#include <string.h>

#include "bench/study/study.h"

#define GZ_LOG_MODULE "study"

bool gz_list_next(const char **list, char *item, size_t size)
{
	if (!*list)
		return false;
	const size_t length = strcspn(*list, ",");
	snprintf(item, size, "%.*s", (int)length, *list);
	*list = (*list)[length] == ',' ? *list + length + 1 : NULL;
	return true;
}

/* The option of a section and what it sets. */
static const struct gz_option *find_option(const struct gz_option_binding bindings[2],
					   const char *key, void **out_target)
{
	static const char *const sections[2] = { "foveation", "render" };
	char full[GZ_STUDY_TEXT_SIZE + 16];
	for (size_t i = 0; i < 2; i++) {
		snprintf(full, sizeof full, "%s.%s", sections[i], key);
		const struct gz_option *option = gz_options_find(&bindings[i], 1, full, NULL);
		*out_target = bindings[i].target;
		if (option)
			return option;
	}
	return NULL;
}

static enum gz_result set_option(struct gz_variant_settings *settings, const char *text,
				 const char *key, const char *value, const struct gz_log *log)
{
	const struct gz_option_binding bindings[2] = {
		{ gz_foveation_options, gz_foveation_option_count, &settings->foveation, NULL },
		{ gz_ray_options, gz_ray_option_count, &settings->rays, NULL },
	};
	char message[256];
	void *target;
	const struct gz_option *option = find_option(bindings, key, &target);
	if (!option) {
		gz_err(log, "%s: no option %s in a scene's sections [foveation] and [render]", text,
		       key);
		return GZ_ERR_INVAL;
	}
	if (gz_option_parse(option, value, target, message, sizeof message) == GZ_OK)
		return GZ_OK;
	gz_err(log, "%s: %s: %s", text, key, message);
	return GZ_ERR_INVAL;
}

enum gz_result gz_variant_parse(const char *text, const struct gz_variant_settings *scene,
				const struct gz_log *log, struct gz_variant_settings *out_settings)
{
	struct gz_variant_settings settings = *scene;
	char copy[GZ_STUDY_TEXT_SIZE];
	if (snprintf(copy, sizeof copy, "%s", text) >= (int)sizeof copy) {
		gz_err(log, "%.40s…: a method and its options have less than %zu bytes", text,
		       sizeof copy);
		return GZ_ERR_INVAL;
	}
	if (!copy[0]) {
		gz_err(log, "a method's name is missing: part methods by one comma each; gazebench "
			    "--list names them");
		return GZ_ERR_INVAL;
	}
	char *rest = copy;
	for (char *part = strsep(&rest, ":"); part; part = strsep(&rest, ":")) {
		char *value = strchr(part, '=');
		const char *key = "method";
		if (value) {
			*value++ = '\0';
			key = part;
		} else if (part != copy) {
			gz_err(log, "%s: %s: write OPTION=VALUE behind the method", text, part);
			return GZ_ERR_INVAL;
		}
		const enum gz_result result =
			set_option(&settings, text, key, value ? value : part, log);
		if (result != GZ_OK)
			return result;
	}
	*out_settings = settings;
	return GZ_OK;
}
