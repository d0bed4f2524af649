#include "bench/study/gaze_path.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/portable.h"
#include "base/text.h"
#include "bench/study/gaze_path_table.h"
#include "filter/pipeline.h"
#include "protocol/gaze_log.h"
#include "sim/random.h"

#define GZ_LOG_MODULE "path"

/* Random stream of gaze points; gz_study_camera() uses others. */
#define GAZE_STREAM 1

/* Cells along an edge of the picture: Bauer 2018, 3.2.8. */
enum { CELLS = 10 };

struct gz_point gz_gaze_path_s(double t)
{
	return (struct gz_point) { (float)(0.5 + 0.4 * gz_portable_sin(2 * M_PI * t)),
				   (float)(0.05 + 0.9 * t) };
}

static enum gz_result append_path_point(struct gz_gaze_path *path, struct gz_point gaze)
{
	if (path->count == GZ_STUDY_POINTS_MAX)
		return GZ_ERR_FULL;
	if (path->count == path->capacity) {
		const size_t capacity = path->capacity ? 2 * path->capacity : 64;
		struct gz_study_point *points =
			reallocarray(path->points, capacity, sizeof *points);
		if (!points)
			return GZ_ERR_NO_MEM;
		path->points = points;
		path->capacity = capacity;
	}
	path->points[path->count++] = (struct gz_study_point) { .gaze = gaze };
	return GZ_OK;
}

void gz_gaze_path_free(struct gz_gaze_path *path)
{
	free(path->points);
	*path = (struct gz_gaze_path) { 0 };
}

/* ---- recordings ---- */

struct player {
	const char *file;
	const struct gz_log *log;
	struct gz_gaze_log_reader *reader;
	struct gz_pipeline pipeline;
	bool samples; /* one point each; else one a fixation */
	bool open;    /* the newest fixation has not ended yet: it is at */
	struct gz_point at;
	struct gz_gaze_path *path;
};

static enum gz_result add_output(struct player *player, const struct gz_pipeline_output *output)
{
	enum gz_result result = GZ_OK;
	if (player->samples) {
		const enum gz_event event = output->gaze.event;
		/* In a blink or while the gaze is lost, the point stays at its last place. */
		const bool there = event != GZ_EVENT_BLINK && event != GZ_EVENT_LOST &&
				   output->rejection == GZ_REJECT_NONE;
		return there ? append_path_point(player->path, output->gaze.point) : GZ_OK;
	}
	for (size_t i = 0; i < output->fixation_count && result == GZ_OK; i++) {
		const struct gz_fixation *fixation = &output->fixations[i];
		player->open = !fixation->final;
		player->at = fixation->point;
		if (fixation->final)
			result = append_path_point(player->path, fixation->point);
	}
	return result;
}

static enum gz_result play(struct player *player)
{
	struct gz_gaze_log_record *record = malloc(sizeof *record);
	struct gz_pipeline_output output;
	enum gz_result result = record ? GZ_OK : GZ_ERR_NO_MEM;
	while (result == GZ_OK) {
		result = gz_gaze_log_read(player->reader, record);
		if (result ==
		    GZ_ERR_FORMAT) { /* logged; reading continues after the damaged record */
			result = GZ_OK;
			continue;
		}
		if (result != GZ_OK || record->kind != GZ_GAZE_LOG_SAMPLE)
			continue;
		gz_pipeline_step(&player->pipeline, &record->sample, &output);
		result = add_output(player, &output);
	}
	free(record);
	if (result != GZ_ERR_END)
		return result;
	/* A recording may end within a fixation. */
	return player->open ? append_path_point(player->path, player->at) : GZ_OK;
}

static enum gz_result prepare_pipeline(struct player *player)
{
	const struct gz_gaze_log_header *header = gz_gaze_log_header(player->reader);
	struct gz_gaze_path *path = player->path;
	struct gz_pipeline_params params;
	const enum gz_result result =
		gz_pipeline_recorded_params(header, player->file, player->log, &params);
	if (result != GZ_OK)
		return result;
	path->has_display = header->has_display && gz_display_valid(&header->display);
	/* Only its angles matter here, and those of the default are the same at any size. */
	const struct gz_display assumed = gz_display_default(1920, 1080);
	path->display = path->has_display ? header->display : assumed;
	gz_pipeline_init(&player->pipeline, &params, &path->display);
	return GZ_OK;
}

static enum gz_result add_recording(const char *file, bool samples, const struct gz_log *log,
				    struct gz_gaze_path *path)
{
	struct player player = { .file = file, .log = log, .samples = samples, .path = path };
	enum gz_result result = gz_gaze_log_open(file, log, &player.reader);
	if (result == GZ_OK)
		result = prepare_pipeline(&player);
	if (result == GZ_OK)
		result = play(&player);
	gz_gaze_log_close(&player.reader);
	if (result == GZ_OK && path->count == 0) {
		gz_err(log, "%s: holds no %s; record someone who looks at the display", file,
		       samples ? "valid gaze" : "fixation with valid gaze");
		result = GZ_ERR_FORMAT;
	}
	return result;
}

/* ---- tables ---- */

static enum gz_result take_place(void *user, struct gz_point gaze)
{
	return append_path_point(user, gaze);
}

static enum gz_result add_table(const char *file, const int size[2], const struct gz_log *log,
				struct gz_gaze_path *path)
{
	const enum gz_result result = gz_gaze_path_table_read(file, size, log, take_place, path);
	if (result != GZ_OK || path->count > 0)
		return result;
	gz_err(log, "%s: holds no place; give two numbers a line, x and y", file);
	return GZ_ERR_FORMAT;
}

/* ---- paths ---- */

bool gz_gaze_path_same_display(const struct gz_display *a, const struct gz_display *b)
{
	for (int axis = 0; axis < 2; axis++) {
		const double ratio =
			(a->mm[axis] / a->distance_mm) / (b->mm[axis] / b->distance_mm);
		if (!(fabs(ratio - 1) <= 0.01))
			return false;
	}
	return true;
}

static enum gz_result refuse_path(const char *text, const struct gz_log *log)
{
	gz_err(log,
	       "%s: no such path: sweep:s, sweep:s:N, grid:NxM, random:N, centre, X,Y, FILE.csv, "
	       "FILE.csv:WxH, FILE.gzl or FILE.gzl:samples, of at most %d points",
	       text, GZ_STUDY_POINTS_MAX);
	return GZ_ERR_INVAL;
}

/* A count of points. */
static bool parse_count(const char *text, long long *out_count)
{
	return gz_number_parse_whole(text, out_count) && *out_count >= 1 &&
	       *out_count <= GZ_STUDY_POINTS_MAX;
}

static enum gz_result add_s(long long count, struct gz_gaze_path *path)
{
	enum gz_result result = GZ_OK;
	for (long long i = 0; i < count && result == GZ_OK; i++)
		result = append_path_point(path, gz_gaze_path_s(((double)i + 0.5) / (double)count));
	return result;
}

static enum gz_result add_grid(long long columns, long long rows, struct gz_gaze_path *path)
{
	enum gz_result result = GZ_OK;
	for (long long i = 0; i < columns * rows && result == GZ_OK; i++) {
		const struct gz_point gaze = {
			(float)(((double)(i % columns) + 0.5) / (double)columns),
			(float)(((double)(i / columns) + 0.5) / (double)rows),
		};
		result = append_path_point(path, gaze);
	}
	return result;
}

static enum gz_result add_random(long long count, uint64_t seed, struct gz_gaze_path *path)
{
	struct gz_random random = gz_random_seeded(seed, GAZE_STREAM);
	enum gz_result result = GZ_OK;
	for (long long i = 0; i < count && result == GZ_OK; i++) {
		struct gz_point gaze;
		gaze.x = (float)gz_random_uniform(&random);
		gaze.y = (float)gz_random_uniform(&random);
		result = append_path_point(path, gaze);
	}
	return result;
}

/* Two numbers parted by @p between. */
static bool split(const char *text, char between, char first[GZ_NAME_SIZE], const char **out_second)
{
	const char *at = strchr(text, between);
	if (!at || at - text >= GZ_NAME_SIZE)
		return false;
	snprintf(first, GZ_NAME_SIZE, "%.*s", (int)(at - text), text);
	*out_second = at + 1;
	return true;
}

static bool parse_grid(const char *text, long long *out_columns, long long *out_rows)
{
	char columns[GZ_NAME_SIZE];
	const char *rows;
	return split(text, 'x', columns, &rows) && parse_count(columns, out_columns) &&
	       parse_count(rows, out_rows) && *out_columns * *out_rows <= GZ_STUDY_POINTS_MAX;
}

static bool parse_place(const char *text, struct gz_point *out_gaze)
{
	char first[GZ_NAME_SIZE];
	const char *second;
	double x, y;
	if (!split(text, ',', first, &second) || !gz_number_parse(first, &x) ||
	    !gz_number_parse(second, &y) || fabs(x) > 100 || fabs(y) > 100)
		return false;
	*out_gaze = (struct gz_point) { (float)x, (float)y };
	return true;
}

static bool ends_with(const char *text, const char *end)
{
	const size_t length = strlen(text), end_length = strlen(end);
	return length > end_length && strcmp(text + length - end_length, end) == 0;
}

/* What follows FILE.csv in a path: nothing, or the size that its pixels refer to. */
static bool parse_table(const char *text, char file[GZ_PATH_SIZE], int size[2], bool *out_sized)
{
	static const char ending[] = ".csv";
	const size_t length = strlen(text);
	const char *colon = strrchr(text, ':'), *height;
	char width[GZ_NAME_SIZE];
	long long pixels[2];
	*out_sized = colon && !ends_with(text, ending);
	snprintf(file, GZ_PATH_SIZE, "%.*s", (int)(*out_sized ? colon - text : (long)length), text);
	if (length >= GZ_PATH_SIZE || !ends_with(file, ending))
		return false;
	if (!*out_sized)
		return true;
	if (!split(colon + 1, 'x', width, &height) || !parse_count(width, &pixels[0]) ||
	    !parse_count(height, &pixels[1]))
		return false;
	size[0] = (int)pixels[0];
	size[1] = (int)pixels[1];
	return true;
}

static enum gz_result add_points(const struct gz_gaze_path_settings *settings,
				 const struct gz_log *log, struct gz_gaze_path *path)
{
	static const char samples[] = ":samples";
	int size[2];
	bool sized;
	const char *text = settings->text;
	long long count, rows;
	struct gz_point gaze;
	char file[GZ_PATH_SIZE];
	if (strcmp(text, "sweep:s") == 0)
		return add_s(GZ_GAZE_PATH_SWEEP_POINTS, path);
	if (strncmp(text, "sweep:s:", 8) == 0 && parse_count(text + 8, &count))
		return add_s(count, path);
	if (strncmp(text, "grid:", 5) == 0 && parse_grid(text + 5, &count, &rows))
		return add_grid(count, rows, path);
	if (strncmp(text, "random:", 7) == 0 && parse_count(text + 7, &count))
		return add_random(count, settings->seed, path);
	if (strcmp(text, "centre") == 0)
		return append_path_point(path, (struct gz_point) { 0.5F, 0.5F });
	if (parse_place(text, &gaze))
		return append_path_point(path, gaze);
	if (parse_table(text, file, size, &sized))
		return add_table(file, sized ? size : NULL, log, path);
	if (ends_with(text, ".gzl"))
		return add_recording(text, false, log, path);
	if (ends_with(text, ".gzl:samples") && strlen(text) < sizeof file) {
		snprintf(file, sizeof file, "%.*s", (int)(strlen(text) - (sizeof samples - 1)),
			 text);
		return add_recording(file, true, log, path);
	}
	return refuse_path(text, log);
}

/* Whether the path is in a file. */
static bool is_file(const char *text)
{
	char file[GZ_PATH_SIZE];
	int size[2];
	bool sized;
	return ends_with(text, ".gzl") || ends_with(text, ".gzl:samples") ||
	       parse_table(text, file, size, &sized);
}

enum gz_result gz_gaze_path_check(const char *text, const struct gz_log *log)
{
	const struct gz_gaze_path_settings settings = { .text = text };
	struct gz_gaze_path path = { 0 };
	const enum gz_result result = is_file(text) ? GZ_OK : add_points(&settings, log, &path);
	gz_gaze_path_free(&path);
	return result;
}

/* Whether the point is the first in its cell; false outside the picture. */
static bool first_in_cell(struct gz_point gaze, bool seen[CELLS * CELLS])
{
	if (!(gaze.x >= 0 && gaze.x < 1 && gaze.y >= 0 && gaze.y < 1))
		return false;
	bool *cell = &seen[(int)(gaze.y * CELLS) * CELLS + (int)(gaze.x * CELLS)];
	const bool first = !*cell;
	*cell = true;
	return first;
}

static bool moved(const struct gz_gaze_path_settings *settings, struct gz_point from,
		  struct gz_point to)
{
	return hypot(((double)to.x - (double)from.x) * settings->size[0],
		     ((double)to.y - (double)from.y) * settings->size[1]) >= settings->min_move_px;
}

static void thin_out(const struct gz_gaze_path_settings *settings, struct gz_gaze_path *path)
{
	bool seen[CELLS * CELLS] = { false };
	size_t kept = 0;
	for (size_t i = 0; i < path->count; i++) {
		const struct gz_point gaze = path->points[i].gaze;
		if (kept > 0 && !moved(settings, path->points[kept - 1].gaze, gaze))
			continue;
		if (!settings->per_cell || first_in_cell(gaze, seen))
			path->points[kept++] = path->points[i];
	}
	path->count = kept;
}

enum gz_result gz_gaze_path_make(const struct gz_gaze_path_settings *settings,
				 const struct gz_log *log, struct gz_gaze_path *out_path)
{
	struct gz_gaze_path path = { 0 };
	enum gz_result result = add_points(settings, log, &path);
	if (result == GZ_ERR_FULL) {
		gz_err(log, "%s: more than %d points; take fixations, or record less",
		       settings->text, GZ_STUDY_POINTS_MAX);
		result = GZ_ERR_INVAL;
	} else if (result == GZ_ERR_NO_MEM) {
		gz_err(log, "%s: no memory for its points", settings->text);
	} else if (result == GZ_OK) {
		thin_out(settings, &path);
		if (path.count == 0) {
			gz_err(log, "%s: no point lies within the picture; omit --per-cell",
			       settings->text);
			result = GZ_ERR_INVAL;
		}
	}
	if (result != GZ_OK) {
		gz_gaze_path_free(&path);
		return result;
	}
	for (size_t i = 0; i < path.count && settings->cameras > 0; i++)
		path.points[i].camera = 1 + (uint32_t)(i % settings->cameras);
	*out_path = path;
	return GZ_OK;
}
