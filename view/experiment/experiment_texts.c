/* The texts that an experiment shows: in the file itself, or in files that it names. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "view/experiment/experiment_internal.h"

#define GZ_LOG_MODULE "experiment"

/* Where a text is named, for messages. */
struct place {
	const struct gz_experiment *experiment;
	const struct gz_log *log;
	const struct gz_experiment_section *section;
};

static enum gz_result refuse(const struct place *place, const char *what, enum gz_result result)
{
	const struct gz_experiment_setting *setting =
		gz_experiment_find_setting(place->section, "instructions_file", -1);
	gz_err(place->log, "%s:%d: instructions_file: %s", place->experiment->path,
	       setting ? setting->line : place->section->line, what);
	return result;
}

static enum gz_result read_text(const struct place *place, const char *name, char **out_text)
{
	char path[GZ_PATH_SIZE], what[GZ_PATH_SIZE + 128];
	if (gz_path_beside(place->experiment->path, name, path, sizeof path) != GZ_OK)
		return refuse(place, "the path is too long; move the file", GZ_ERR_FORMAT);
	FILE *file = fopen(path, "rb");
	if (!file) {
		enum gz_result result = errno == ENOENT ? GZ_ERR_NOT_FOUND : GZ_ERR_IO;
		snprintf(what, sizeof what, "%s cannot be opened: %s", path, strerror(errno));
		return refuse(place, what, result);
	}
	char *text = calloc(1, GZ_EXPERIMENT_TEXT_SIZE + 1);
	size_t size = text ? fread(text, 1, GZ_EXPERIMENT_TEXT_SIZE, file) : 0;
	bool failed = ferror(file) != 0;
	fclose(file);
	if (!text)
		return GZ_ERR_NO_MEM;
	if (!failed && size < GZ_EXPERIMENT_TEXT_SIZE && !memchr(text, '\0', size)) {
		*out_text = text;
		return GZ_OK;
	}
	free(text);
	snprintf(what, sizeof what, "%s is no text of at most %d bytes", path,
		 GZ_EXPERIMENT_TEXT_SIZE - 1);
	return refuse(place, failed ? "cannot be read" : what, failed ? GZ_ERR_IO : GZ_ERR_FORMAT);
}

static enum gz_result take_text(struct gz_experiment *experiment, const struct place *place,
				const char *text, const char *name, char **out_text)
{
	if (name[0]) {
		enum gz_result result = read_text(place, name, out_text);
		if (result == GZ_OK)
			experiment->fingerprint = gz_experiment_hash(
				experiment->fingerprint, *out_text, strlen(*out_text) + 1);
		return result;
	}
	if (!text[0])
		return GZ_OK;
	*out_text = strdup(text);
	return *out_text ? GZ_OK : GZ_ERR_NO_MEM;
}

enum gz_result gz_experiment_read_texts(struct gz_experiment *experiment, const struct gz_log *log)
{
	const struct place common = { experiment, log, &experiment->common };
	enum gz_result result =
		take_text(experiment, &common, experiment->params.instructions,
			  experiment->params.instructions_file, &experiment->instructions);
	for (size_t i = 0; i < experiment->section_count && result == GZ_OK; i++) {
		struct gz_block *block = &experiment->blocks[i];
		const struct place place = { experiment, log, &experiment->sections[i] };
		result = take_text(experiment, &place, block->params.instructions,
				   block->params.instructions_file, &block->instructions);
	}
	return result;
}
