#include "view/frame/stats.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define GZ_LOG_MODULE "gazeview"

/* One entry, with room to spare: a dozen numbers, four short names. */
enum { ENTRY_SIZE = 1024, NUMBER_SIZE = 40 };

static const char head[] = "{\"frames\": [";
static const char tail[] = "\n]}\n";

struct gz_stats_file {
	const struct gz_log *log;
	int fd;
	off_t end; /* where the next entry goes: over the tail */
	bool any;
	char path[]; /* for messages */
};

void gz_frame_record_print(const struct gz_frame_record *record, char *text, size_t size)
{
	char age[NUMBER_SIZE] = "-";
	if (record->age_known)
		snprintf(age, sizeof age, "%.1f ms", record->gaze_age_ms);
	snprintf(text, size,
		 "%s %dx%d rays %llu samples %llu plan %.2f cast %.2f reconstruct %.2f total %.2f "
		 "ms gaze age %s",
		 record->method, record->width, record->height, (unsigned long long)record->rays,
		 (unsigned long long)record->samples, record->plan_ms, record->cast_ms,
		 record->reconstruct_ms, record->total_ms, age);
}

/* JSON has no NaN and no infinity. */
static void print_number(double value, const char *format, char text[NUMBER_SIZE])
{
	if (isfinite(value))
		snprintf(text, NUMBER_SIZE, format, value);
	else
		snprintf(text, NUMBER_SIZE, "null");
}

static void print_point(struct gz_point point, char *text, size_t size)
{
	if (isfinite(point.x) && isfinite(point.y))
		snprintf(text, size, "[%.9g, %.9g]", (double)point.x, (double)point.y);
	else
		snprintf(text, size, "null");
}

/* What the plan was made of; a comma before it. */
static void print_attention(const struct gz_frame_record *record, char *text, size_t size)
{
	char focus[2 * NUMBER_SIZE], scale[NUMBER_SIZE], widen[NUMBER_SIZE], budget[NUMBER_SIZE];
	print_point(record->focus.point, focus, sizeof focus);
	print_number(record->focus.scale, "%.6g", scale);
	print_number(record->focus.widen, "%.6g", widen);
	print_number(record->budget_ms > 0 ? record->budget_ms : NAN, "%.6g", budget);
	snprintf(text, size,
		 ", \"attention\": \"%s\", \"focus\": %s, \"scale\": %s, \"widen\": %s, "
		 "\"budget_ms\": %s, \"budget\": \"%s\"",
		 record->attention, focus, scale, widen, budget, record->budget);
}

static int print_entry(const struct gz_frame_record *record, bool first, char *text, size_t size)
{
	char plan[NUMBER_SIZE], cast[NUMBER_SIZE], reconstruct[NUMBER_SIZE], total[NUMBER_SIZE];
	char age[NUMBER_SIZE], gaze[2 * NUMBER_SIZE], attention[10 * NUMBER_SIZE];
	print_number(record->plan_ms, "%.4f", plan);
	print_number(record->cast_ms, "%.4f", cast);
	print_number(record->reconstruct_ms, "%.4f", reconstruct);
	print_number(record->total_ms, "%.4f", total);
	print_number(record->age_known ? record->gaze_age_ms : NAN, "%.4f", age);
	const struct gz_point unknown = { NAN, NAN };
	print_point(record->gaze_known ? record->gaze : unknown, gaze, sizeof gaze);
	print_attention(record, attention, sizeof attention);
	return snprintf(text, size,
			"%s\n{\"method\": \"%s\", \"backend\": \"%s\", \"width\": %d, \"height\": "
			"%d, \"rays\": %llu, \"samples\": %llu, \"plan_ms\": %s, \"cast_ms\": %s, "
			"\"reconstruct_ms\": %s, \"total_ms\": %s, \"gaze\": %s, \"gaze_age_ms\": "
			"%s%s}%s",
			first ? "" : ",", record->method, record->backend, record->width,
			record->height, (unsigned long long)record->rays,
			(unsigned long long)record->samples, plan, cast, reconstruct, total, gaze,
			age, attention, tail);
}

/* All of it at @p at, in one write where the system allows: a reader never sees half an entry. */
static enum gz_result write_at(struct gz_stats_file *file, const char *text, size_t size, off_t at)
{
	while (size > 0) {
		ssize_t written = pwrite(file->fd, text, size, at);
		if (written < 0 && errno == EINTR)
			continue;
		if (written <= 0) {
			gz_err(file->log,
			       "cannot write %s: %s; free some room or name another file",
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
		       "cannot write %s: %s; name a file in a folder that exists and is "
		       "yours",
		       file->path, strerror(errno));
		return GZ_ERR_IO;
	}
	if (!S_ISREG(state.st_mode)) {
		gz_err(file->log, "cannot write statistics into %s: no plain file; name one",
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

/* A half written entry is cut off again, so that what is there still parses. */
static void cut_back(struct gz_stats_file *file)
{
	if (ftruncate(file->fd, file->end) == 0)
		(void)!pwrite(file->fd, tail, sizeof tail - 1, file->end);
}

enum gz_result gz_stats_add(struct gz_stats_file *file, const struct gz_frame_record *record)
{
	char text[ENTRY_SIZE];
	int length = print_entry(record, !file->any, text, sizeof text);
	if (length < 0 || (size_t)length >= sizeof text)
		return GZ_ERR_INVAL;
	enum gz_result r = write_at(file, text, (size_t)length, file->end);
	if (r != GZ_OK) {
		cut_back(file);
		return r;
	}
	file->end += length - (off_t)(sizeof tail - 1);
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
		kept->ms[part] = fmax(0, cost->ms[part]); /* 0 also of what is no number */
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

static int compare_ms(const void *a, const void *b)
{
	const double one = *(const double *)a, other = *(const double *)b;
	return (one > other) - (one < other);
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
	qsort(values, history->count, sizeof values[0], compare_ms);
	const double rank = ceil(share * (double)history->count);
	return values[rank < 1 ? 0 : (size_t)rank - 1];
}
