#include "view/frame/stats.h"

#include <errno.h>
#include <fcntl.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/order.h"

#define GZ_LOG_MODULE "gazeview"

/* Sizes of texts, bytes: an entry has a dozen numbers and four short names. NUMBER_DIGITS: decimal
 * digits that a double keeps. */
enum { ENTRY_SIZE = 1024, NUMBER_DIGITS = 15, NUMBER_SIZE = 40 };

static const char head[] = "{\"frames\": [";
static const char tail[] = "\n]}\n";

struct gz_stats_file {
	const struct gz_log *log;
	int fd;
	off_t end; /* where the next entry goes: it replaces the tail */
	bool any;
	char path[]; /* for messages */
};

void gz_frame_record_print(const struct gz_frame_record *record, char *text, size_t size)
{
	char age[NUMBER_SIZE] = "-";
	if (record->age_known)
		snprintf(age, sizeof age, "%.1f ms", record->gaze_age_ms);
	snprintf(text, size,
		 "%s %dx%d rays %llu kept %llu samples %llu plan %.2f cast %.2f reconstruct %.2f "
		 "total %.2f ms gaze age %s",
		 record->method, record->width, record->height, (unsigned long long)record->rays,
		 (unsigned long long)record->kept_rays, (unsigned long long)record->samples,
		 record->plan_ms, record->cast_ms, record->reconstruct_ms, record->total_ms, age);
}

/* JSON has neither NaN nor infinity. */
static json_t *number_json(double value)
{
	return isfinite(value) ? json_real(value) : json_null();
}

/* Rounded to 0.1 us; further digits are noise. */
static json_t *milliseconds_json(double ms)
{
	return number_json(round(ms * 1e4) / 1e4);
}

static json_t *point_json(bool known, struct gz_point point)
{
	if (!known || !isfinite(point.x) || !isfinite(point.y))
		return json_null();
	return json_pack("[f, f]", (double)point.x, (double)point.y);
}

static json_t *record_json(const struct gz_frame_record *record)
{
	return json_pack(
		"{s:s, s:s, s:i, s:i, s:I, s:I, s:I, s:o, s:o, s:o, s:o, s:o, s:o, s:s, s:o, s:o, "
		"s:o, s:o, s:s}",
		"method", record->method, "backend", record->backend, "width", record->width,
		"height", record->height, "rays", (json_int_t)record->rays, "kept_rays",
		(json_int_t)record->kept_rays, "samples", (json_int_t)record->samples, "plan_ms",
		milliseconds_json(record->plan_ms), "cast_ms", milliseconds_json(record->cast_ms),
		"reconstruct_ms", milliseconds_json(record->reconstruct_ms), "total_ms",
		milliseconds_json(record->total_ms), "gaze",
		point_json(record->gaze_known, record->gaze), "gaze_age_ms",
		milliseconds_json(record->age_known ? record->gaze_age_ms : NAN), "attention",
		record->attention, "focus", point_json(true, record->focus.point), "scale",
		number_json(record->focus.scale), "widen", number_json(record->focus.widen),
		"budget_ms", number_json(record->budget_ms > 0 ? record->budget_ms : NAN), "budget",
		record->budget);
}

/* Print the separator, the entry and the tail of the file. @return the length; 0: it does not fit,
 * or out of memory */
static size_t print_entry(const struct gz_frame_record *record, bool first, char text[ENTRY_SIZE])
{
	json_t *entry = record_json(record);
	char object[ENTRY_SIZE];
	const size_t length =
		entry ? json_dumpb(entry, object, sizeof object, JSON_REAL_PRECISION(NUMBER_DIGITS))
		      : 0;
	json_decref(entry);
	if (length == 0 || length >= sizeof object)
		return 0;
	const int printed = snprintf(text, ENTRY_SIZE, "%s\n%.*s%s", first ? "" : ",", (int)length,
				     object, tail);
	return printed > 0 && printed < ENTRY_SIZE ? (size_t)printed : 0;
}

/* Write everything at @p at, usually in one call: a reader does not see half an entry. */
static enum gz_result write_at(struct gz_stats_file *file, const char *text, size_t size, off_t at)
{
	while (size > 0) {
		ssize_t written = pwrite(file->fd, text, size, at);
		if (written < 0 && errno == EINTR)
			continue;
		if (written <= 0) {
			gz_err(file->log,
			       "cannot write %s: %s; free some space or name another file",
			       file->path, strerror(errno));
			return GZ_ERR_IO;
		}
		text += written;
		size -= (size_t)written;
		at += written;
	}
	return GZ_OK;
}

static enum gz_result open_plain(struct gz_stats_file *file)
{
	struct stat state;
	file->fd = open(file->path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
	if (file->fd < 0 || fstat(file->fd, &state) != 0) {
		gz_err(file->log,
		       "cannot write %s: %s; name a file in a folder that you may write to",
		       file->path, strerror(errno));
		return GZ_ERR_IO;
	}
	if (!S_ISREG(state.st_mode)) {
		gz_err(file->log, "cannot write statistics to %s: not a regular file; name one",
		       file->path);
		return GZ_ERR_IO;
	}
	return GZ_OK;
}

enum gz_result gz_stats_open(const char *path, const struct gz_log *log,
			     struct gz_stats_file **out_file)
{
	size_t length = strlen(path);
	struct gz_stats_file *file = calloc(1, sizeof *file + length + 1);
	if (!file)
		return GZ_ERR_NO_MEM;
	file->log = log;
	memcpy(file->path, path, length + 1);
	enum gz_result r = open_plain(file);
	if (r == GZ_OK)
		r = write_at(file, head, sizeof head - 1, 0);
	file->end = sizeof head - 1;
	if (r == GZ_OK)
		r = write_at(file, tail, sizeof tail - 1, file->end);
	if (r != GZ_OK) {
		gz_stats_close(&file);
		return r;
	}
	*out_file = file;
	return GZ_OK;
}

/* Cut off a half-written entry, so that the file still parses. */
static void cut_back(struct gz_stats_file *file)
{
	if (ftruncate(file->fd, file->end) == 0)
		(void)!pwrite(file->fd, tail, sizeof tail - 1, file->end);
}

enum gz_result gz_stats_add(struct gz_stats_file *file, const struct gz_frame_record *record)
{
	char text[ENTRY_SIZE];
	const size_t length = print_entry(record, !file->any, text);
	if (length == 0)
		return GZ_ERR_INVAL;
	enum gz_result r = write_at(file, text, length, file->end);
	if (r != GZ_OK) {
		cut_back(file);
		return r;
	}
	file->end += (off_t)length - (off_t)(sizeof tail - 1);
	file->any = true;
	return GZ_OK;
}

void gz_stats_close(struct gz_stats_file **file)
{
	if (!file || !*file)
		return;
	if ((*file)->fd >= 0)
		close((*file)->fd);
	free(*file);
	*file = NULL;
}

void gz_frame_history_add(struct gz_frame_history *history, const struct gz_frame_cost *cost)
{
	struct gz_frame_cost *kept = &history->costs[history->next];
	*kept = *cost;
	for (int part = 0; part < GZ_FRAME_PARTS; part++)
		kept->ms[part] = fmax(0, cost->ms[part]); /* NaN becomes 0 */
	history->next = (history->next + 1) % GZ_FRAME_HISTORY_SIZE;
	if (history->count < GZ_FRAME_HISTORY_SIZE)
		history->count++;
}

const struct gz_frame_cost *gz_frame_history_at(const struct gz_frame_history *history, size_t back)
{
	if (back >= history->count)
		return NULL;
	return &history->costs[(history->next + GZ_FRAME_HISTORY_SIZE - 1 - back) %
			       GZ_FRAME_HISTORY_SIZE];
}

double gz_frame_cost_total_ms(const struct gz_frame_cost *cost)
{
	double total = 0;
	for (int part = 0; part < GZ_FRAME_PARTS; part++)
		total += cost->ms[part];
	return total;
}

double gz_frame_history_quantile_ms(const struct gz_frame_history *history, enum gz_frame_part part,
				    double share)
{
	double values[GZ_FRAME_HISTORY_SIZE];
	if (history->count == 0)
		return 0;
	for (size_t i = 0; i < history->count; i++) {
		const struct gz_frame_cost *cost = gz_frame_history_at(history, i);
		values[i] = part == GZ_FRAME_PARTS ? gz_frame_cost_total_ms(cost) : cost->ms[part];
	}
	qsort(values, history->count, sizeof values[0], gz_compare_doubles);
	const double rank = ceil(share * (double)history->count);
	return values[rank < 1 ? 0 : (size_t)rank - 1];
}
