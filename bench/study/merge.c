#include "bench/study/merge.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/study/study_folder.h"

#define GZ_LOG_MODULE "study"

/* Shards, as they come. */
struct joining {
	const struct gz_log *log;
	const char *const *folders;
	size_t count;
	struct gz_study *shards; /* in the order of folders */
	size_t *by_shard;        /* place in folders, and 1, of each shard; 0 = missing */
};

static enum gz_result check_shard(struct joining *joining, size_t i)
{
	const struct gz_study *shard = &joining->shards[i], *first = &joining->shards[0];
	const char *folder = joining->folders[i];
	char what[3 * GZ_STUDY_TEXT_SIZE];
	if (gz_study_differs(shard, first, what, sizeof what)) {
		gz_err(joining->log, "%s is of another study than %s: %s there", folder,
		       joining->folders[0], what);
		return GZ_ERR_INVAL;
	}
	if (shard->shard_count != first->shard_count) {
		gz_err(joining->log, "%s is one of %d shards, %s one of %d", folder,
		       shard->shard_count, joining->folders[0], first->shard_count);
		return GZ_ERR_INVAL;
	}
	if (!shard->complete) {
		gz_err(joining->log, "%s is not complete: run its shard again to resume it",
		       folder);
		return GZ_ERR_INVAL;
	}
	size_t *place = &joining->by_shard[shard->shard];
	if (*place > 0) {
		gz_err(joining->log, "%s and %s are both shard %d; leave one out",
		       joining->folders[*place - 1], folder, shard->shard + 1);
		return GZ_ERR_INVAL;
	}
	*place = i + 1;
	return GZ_OK;
}

static enum gz_result read_shards(struct joining *joining)
{
	for (size_t i = 0; i < joining->count; i++) {
		enum gz_result result =
			gz_study_read(joining->folders[i], joining->log, &joining->shards[i]);
		if (result != GZ_OK)
			return result;
		if (i == 0)
			joining->by_shard = calloc((size_t)joining->shards[0].shard_count,
						   sizeof *joining->by_shard);
		if (!joining->by_shard)
			return GZ_ERR_NO_MEM;
		result = check_shard(joining, i);
		if (result != GZ_OK)
			return result;
	}
	for (int i = 0; i < joining->shards[0].shard_count; i++)
		if (joining->by_shard[i] == 0) {
			gz_err(joining->log,
			       "shard %d of %d is missing: name its folder too, or measure it with "
			       "--shard %d/%d",
			       i + 1, joining->shards[0].shard_count, i + 1,
			       joining->shards[0].shard_count);
			return GZ_ERR_INVAL;
		}
	return GZ_OK;
}

static enum gz_result join_shard_rows(const struct joining *joining, struct gz_study *study)
{
	const size_t units = gz_study_unit_count(study), per = gz_study_unit_rows(study);
	const size_t shards = (size_t)joining->shards[0].shard_count;
	struct gz_study_row *rows = calloc(units * per, sizeof *rows);
	if (!rows)
		return GZ_ERR_NO_MEM;
	for (size_t unit = 0; unit < units; unit++) {
		const struct gz_study *shard =
			&joining->shards[joining->by_shard[unit % shards] - 1];
		memcpy(rows + unit * per, shard->rows + unit / shards * per, per * sizeof *rows);
	}
	free(study->rows);
	study->rows = rows;
	study->row_count = units * per;
	return GZ_OK;
}

/* Append a different text, if there is room. */
static void append_other(char text[GZ_STUDY_TEXT_SIZE], const char *other)
{
	const size_t length = strlen(text);
	if (!strstr(text, other) && length + strlen(other) + 3 < GZ_STUDY_TEXT_SIZE)
		snprintf(text + length, GZ_STUDY_TEXT_SIZE - length, "; %s", other);
}

static void join_machines(const struct joining *joining, struct gz_study *study)
{
	for (size_t i = 0; i < joining->count; i++) {
		const struct gz_study_machine *other = &joining->shards[i].machine;
		append_other(study->machine.host_cpu, other->host_cpu);
		append_other(study->machine.memory, other->memory);
		append_other(study->machine.system, other->system);
		append_other(study->machine.compiler, other->compiler);
		for (size_t k = 0; k < study->backend_count; k++)
			append_other(study->machine.backends[k], other->backends[k]);
	}
}

static enum gz_result join(const struct joining *joining, struct gz_study *out_study)
{
	/* The first folder's lists become the whole's. */
	struct gz_study *first = &joining->shards[0];
	struct gz_study_row *own = first->rows;
	struct gz_study *study = malloc(sizeof *study);
	if (!study)
		return GZ_ERR_NO_MEM;
	*study = *first;
	study->rows = NULL;
	const enum gz_result result = join_shard_rows(joining, study);
	if (result == GZ_OK) {
		join_machines(joining, study);
		study->shard = 0;
		study->shard_count = 1;
		*out_study = *study;
		/* The lists have moved and are not freed with the shards. */
		*first = (struct gz_study) { .rows = own };
	}
	free(study);
	return result;
}

enum gz_result gz_study_merge(const char *const *folders, size_t count, const struct gz_log *log,
			      struct gz_study *out_study)
{
	struct joining joining = {
		.log = log,
		.folders = folders,
		.count = count,
		.shards = calloc(count, sizeof *joining.shards),
	};
	enum gz_result result = joining.shards ? read_shards(&joining) : GZ_ERR_NO_MEM;
	if (result == GZ_OK)
		result = join(&joining, out_study);
	if (result == GZ_ERR_NO_MEM)
		gz_err(log, "no memory for the shards of a study");
	for (size_t i = 0; i < count && joining.shards; i++)
		gz_study_free(&joining.shards[i]);
	free(joining.shards);
	free(joining.by_shard);
	return result;
}
