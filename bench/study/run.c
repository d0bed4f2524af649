#include "bench/study/run.h"

#include <math.h>
#include <stdlib.h>

#include "base/clock.h"
#include "base/command.h"
#include "bench/study/measure.h"
#include "bench/study/study_folder.h"

#define GZ_LOG_MODULE "study"

/* A run on its way. */
struct run {
	const struct gz_log *log;
	struct gz_study *study;
	struct gz_stage stage;
	struct gz_study_writer *writer;
	struct gz_measurer *measurer;
	struct gz_study_row *rows; /* of one unit */
	struct gz_study_outcome *outcome;
	void (*progress)(void *user, const struct gz_study_progress *progress);
	void *user;
	int64_t start_ns;
	double work_before; /* of units that were there already */
};

static size_t unit_of(const struct run *run, size_t i)
{
	return (size_t)run->study->shard + i * (size_t)run->study->shard_count;
}

/* How much work the first so many units of the shard are: their pixels. */
static double work_of(const struct run *run, size_t count)
{
	double work = 0;
	for (size_t i = 0; i < count; i++) {
		const struct gz_study_row row = gz_study_unit_row(run->study, unit_of(run, i), 0);
		const int *size = run->study->sizes[row.size];
		work += (double)size[0] * size[1];
	}
	return work;
}

static void tell(const struct run *run, size_t done)
{
	if (!run->progress)
		return;
	const size_t units = run->outcome->units;
	const double all = work_of(run, units), now = work_of(run, done);
	const double spent_s = gz_ns_to_s(gz_clock_now_ns() - run->start_ns);
	const struct gz_study_row row =
		gz_study_unit_row(run->study, unit_of(run, done < units ? done : 0), 0);
	const struct gz_study_progress progress = {
		.units = units,
		.done = done,
		.share = all > 0 ? now / all : 1,
		.left_s = now > run->work_before ? spent_s * (all - now) / (now - run->work_before)
						 : NAN,
		.what = run->study->scenes[row.scene].name,
	};
	run->progress(run->user, &progress);
}

static enum gz_result run_units(struct run *run)
{
	struct gz_study_outcome *outcome = run->outcome;
	enum gz_result result = GZ_OK;
	run->start_ns = gz_clock_now_ns();
	run->work_before = work_of(run, outcome->done);
	while (outcome->done < outcome->units && result == GZ_OK) {
		tell(run, outcome->done);
		result = gz_measurer_measure(run->measurer, unit_of(run, outcome->done), run->rows);
		if (result == GZ_OK)
			result = gz_study_writer_add(run->writer, run->rows);
		if (result == GZ_OK) {
			outcome->done++;
			outcome->rows += gz_study_unit_rows(run->study);
		}
	}
	if (result == GZ_OK)
		result = gz_study_writer_finish(run->writer);
	outcome->complete = result == GZ_OK;
	tell(run, outcome->done);
	return result;
}

/* The renderers of the first unit say what they are: that is written into the folder. */
static enum gz_result describe_backends(struct run *run)
{
	if (gz_study_shard_unit_count(run->study) == 0) {
		gz_err(run->log, "shard %d of %d has nothing to measure: there are only %zu units",
		       run->study->shard + 1, run->study->shard_count,
		       gz_study_unit_count(run->study));
		return GZ_ERR_INVAL;
	}
	const struct gz_study_row row = gz_study_unit_row(run->study, unit_of(run, 0), 0);
	return gz_stage_enter(&run->stage, run->study, row.scene, run->study->machine.backends);
}

static enum gz_result begin(struct run *run, const char *folder, const char *cache)
{
	struct gz_study_outcome *outcome = run->outcome;
	size_t done;
	enum gz_result result = describe_backends(run);
	run->rows = calloc(gz_study_unit_rows(run->study), sizeof *run->rows);
	if (result == GZ_OK && !run->rows)
		result = GZ_ERR_NO_MEM;
	if (result == GZ_OK)
		result = gz_measurer_create(run->study, &run->stage, cache, run->log,
					    &run->measurer);
	if (result == GZ_OK)
		result = gz_study_writer_open(folder, run->study, run->log, &run->writer, &done);
	if (result != GZ_OK)
		return result;
	*outcome = (struct gz_study_outcome) {
		.units = gz_study_shard_unit_count(run->study),
		.done = done,
		.resumed = done,
		.rows = done * gz_study_unit_rows(run->study),
	};
	return GZ_OK;
}

enum gz_result gz_study_run(const struct gz_study_request *request, const char *folder,
			    const char *cache,
			    void (*progress)(void *user, const struct gz_study_progress *progress),
			    void *user, const struct gz_log *log,
			    struct gz_study_outcome *out_outcome)
{
	struct run run = {
		.log = log,
		.study = calloc(1, sizeof *run.study),
		.stage = { .log = log },
		.outcome = out_outcome,
		.progress = progress,
		.user = user,
	};
	*out_outcome = (struct gz_study_outcome) { 0 };
	if (!run.study)
		return GZ_ERR_NO_MEM;
	enum gz_result result = gz_study_folder_check(folder, log); /* before long work */
	if (result == GZ_OK)
		result = gz_study_ask(request, &run.stage, log, run.study);
	if (result == GZ_OK)
		result = begin(&run, folder, cache);
	if (result == GZ_OK)
		result = run_units(&run);
	gz_study_writer_destroy(&run.writer);
	gz_measurer_destroy(&run.measurer);
	gz_stage_free(&run.stage);
	free(run.rows);
	gz_study_free(run.study);
	free(run.study);
	return gz_command_interrupted() && result != GZ_OK ? GZ_ERR_CANCELLED : result;
}
