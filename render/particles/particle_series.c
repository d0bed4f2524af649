#include "render/particles/particle_series.h"

#include <ctype.h>
#include <dirent.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "render/particles/particle_reader.h"

#define GZ_LOG_MODULE "particles"

/* Most digits of a number. Chosen: it fits 64 bits. */
enum { DIGITS_MAX = 18 };

/* A name in three parts: before the number, the number, and what follows. */
struct numbered_name {
	size_t start, digits; /* of the number, in the path */
	uint64_t number;
};

/* A file of a series. */
struct numbered_file {
	char *path;
	uint64_t number;
};

/* Files in the order of their numbers, once sorted. */
struct numbered_files {
	struct numbered_file *items;
	size_t count, room;
};

static size_t length_of_folder(const char *path)
{
	const char *slash = strrchr(path, '/');
	return slash ? (size_t)(slash - path) + 1 : 0;
}

/* Split a path at the last digits that a dot follows. */
static bool split_name(const char *path, struct numbered_name *out_name)
{
	size_t end = strlen(path), start;
	const size_t folder = length_of_folder(path);
	while (end > folder && !(path[end] == '.' && isdigit((unsigned char)path[end - 1])))
		end--;
	for (start = end; start > folder && isdigit((unsigned char)path[start - 1]);)
		start--;
	if (start == end || end - start > DIGITS_MAX)
		return false;
	*out_name = (struct numbered_name) { start, end - start, strtoull(path + start, NULL, 10) };
	return true;
}

/* What names a folder and, in its files, what stands before and after the number. */
struct name_frame {
	const char *folder, *before, *after;
	size_t folder_length, before_length;
};

/* The number in the name of an entry of the folder. */
static bool number_of(const struct name_frame *frame, const char *entry, uint64_t *out_number)
{
	if (strncmp(entry, frame->before, frame->before_length) != 0)
		return false;
	const char *digits = entry + frame->before_length;
	const size_t count = strspn(digits, "0123456789");
	if (count < 1 || count > DIGITS_MAX || strcmp(digits + count, frame->after) != 0)
		return false;
	*out_number = strtoull(digits, NULL, 10);
	return true;
}

static enum gz_result add_file(const struct name_frame *frame, const char *entry, uint64_t number,
			       struct numbered_files *files)
{
	if (files->count == files->room) {
		const size_t room = files->room ? 2 * files->room : 64;
		struct numbered_file *items = realloc(files->items, room * sizeof *items);
		if (!items)
			return GZ_ERR_NO_MEM;
		files->items = items;
		files->room = room;
	}
	const size_t size = frame->folder_length + strlen(entry) + 1;
	char *path = malloc(size);
	if (!path)
		return GZ_ERR_NO_MEM;
	snprintf(path, size, "%.*s%s", (int)frame->folder_length, frame->folder, entry);
	files->items[files->count].path = path;
	files->items[files->count].number = number;
	files->count++;
	return GZ_OK;
}

static int compare_files(const void *a, const void *b)
{
	const struct numbered_file *one = a, *other = b;
	const int by_number = (one->number > other->number) - (one->number < other->number);
	return by_number != 0 ? by_number : strcmp(one->path, other->path);
}

static void free_files(struct numbered_files *files)
{
	for (size_t i = 0; i < files->count; i++)
		free(files->items[i].path);
	free(files->items);
	*files = (struct numbered_files) { 0 };
}

/* List the files of a folder that have such a name, by their numbers; a folder that cannot be read
 * has none. */
static enum gz_result list_files(const struct name_frame *frame, struct numbered_files *out_files)
{
	char folder[GZ_PATH_SIZE] = ".";
	enum gz_result result = GZ_OK;
	if (frame->folder_length > 0)
		snprintf(folder, sizeof folder, "%.*s", (int)frame->folder_length, frame->folder);
	DIR *entries = opendir(folder);
	if (!entries)
		return GZ_OK;
	for (const struct dirent *entry; result == GZ_OK && (entry = readdir(entries));) {
		uint64_t number;
		if (number_of(frame, entry->d_name, &number))
			result = add_file(frame, entry->d_name, number, out_files);
	}
	closedir(entries);
	if (out_files->count > 1)
		qsort(out_files->items, out_files->count, sizeof out_files->items[0],
		      compare_files);
	return result;
}

/* Move the paths of files of one format into a series, up to the most time points. Of files with
 * one number the first name counts. */
static enum gz_result take_files(struct numbered_files *files,
				 const struct gz_particle_format *format,
				 struct gz_particle_series *out_series)
{
	struct gz_particle_series series = { calloc(files->count, sizeof *series.paths), 0 };
	if (!series.paths)
		return GZ_ERR_NO_MEM;
	for (size_t i = 0; i < files->count && series.count < GZ_TIME_POINTS_MAX; i++) {
		struct numbered_file *file = &files->items[i];
		const bool again = i > 0 && file->number == files->items[i - 1].number;
		if (again || gz_particle_format_by_content(file->path) != format)
			continue;
		series.paths[series.count++] = file->path;
		file->path = NULL;
	}
	*out_series = series;
	return GZ_OK;
}

enum gz_result gz_particle_series_find(const char *path, struct gz_particle_series *out_series)
{
	const struct gz_particle_format *format = gz_particle_format_of(path);
	struct numbered_files files = { 0 };
	struct numbered_name name;
	char before[GZ_PATH_SIZE];
	*out_series = (struct gz_particle_series) { 0 };
	if (!format || format == &gz_particle_format_particles || strlen(path) >= sizeof before ||
	    !split_name(path, &name))
		return GZ_OK;
	const size_t folder = length_of_folder(path);
	snprintf(before, sizeof before, "%.*s", (int)(name.start - folder), path + folder);
	const struct name_frame frame = { path, before, path + name.start + name.digits, folder,
					  name.start - folder };
	enum gz_result result = list_files(&frame, &files);
	if (result == GZ_OK && files.count > 1 && files.items[0].number == name.number)
		result = take_files(&files, format, out_series);
	if (out_series->count == 1)
		gz_particle_series_free(out_series);
	free_files(&files);
	return result;
}

void gz_particle_series_free(struct gz_particle_series *series)
{
	for (size_t i = 0; i < series->count; i++)
		free(series->paths[i]);
	free(series->paths);
	*series = (struct gz_particle_series) { 0 };
}

/* Where "%04d" begins, and its length; NULL: the name has none, or several. */
static const char *find_conversion(const char *name, size_t *out_length)
{
	const char *percent = strchr(name, '%');
	if (!percent || strchr(percent + 1, '%'))
		return NULL;
	const size_t digits = strspn(percent + 1, "0123456789");
	*out_length = digits + 2;
	return percent[1 + digits] == 'd' && percent[2 + digits] == '.' ? percent : NULL;
}

bool gz_particle_series_first(const char *pattern, char out_path[GZ_PATH_SIZE])
{
	struct numbered_files files = { 0 };
	char before[GZ_PATH_SIZE];
	size_t length;
	const size_t folder = length_of_folder(pattern);
	const char *name = pattern + folder, *conversion = find_conversion(name, &length);
	FILE *itself = conversion ? fopen(pattern, "rb") : NULL;
	if (itself)
		fclose(itself);
	if (!conversion || itself || strlen(pattern) >= sizeof before)
		return false;
	snprintf(before, sizeof before, "%.*s", (int)(conversion - name), name);
	const struct name_frame frame = { pattern, before, conversion + length, folder,
					  (size_t)(conversion - name) };
	const bool found = list_files(&frame, &files) == GZ_OK && files.count > 0 &&
			   strlen(files.items[0].path) < GZ_PATH_SIZE;
	if (found)
		strcpy(out_path, files.items[0].path);
	free_files(&files);
	return found;
}

/* ---- what time points share ---- */

/* Widen box and range of a frame by the particles of a file. */
static void add_to_frame(const struct gz_particles *particles, struct gz_particle_frame *frame)
{
	for (size_t i = 0; i < particles->count; i++)
		for (int axis = 0; axis < 3; axis++) {
			const double place = particles->positions[i][axis];
			frame->least[axis] = fmin(frame->least[axis], place);
			frame->greatest[axis] = fmax(frame->greatest[axis], place);
		}
	frame->value_range[0] = fmin(frame->value_range[0], particles->value_range[0]);
	frame->value_range[1] = fmax(frame->value_range[1], particles->value_range[1]);
}

static enum gz_result measure_file(const char *path, enum gz_particle_value value,
				   const struct gz_log *log, struct gz_particle_frame *frame)
{
	const struct gz_particle_request request = { .path = path, .value = value, .log = log };
	struct gz_particles particles;
	enum gz_result result = gz_particles_load(&request, &particles);
	if (result != GZ_OK)
		return result;
	if (frame->count == 0)
		result = gz_particles_find_radius(&particles, &frame->radius);
	if (result == GZ_ERR_NO_MEM)
		gz_err(log, "%s: no memory for the tree of %zu particles", path, particles.count);
	if (result == GZ_OK) {
		add_to_frame(&particles, frame);
		frame->count++;
	}
	gz_particles_free(&particles);
	return result;
}

enum gz_result gz_particle_series_measure(const struct gz_particle_series *series,
					  enum gz_particle_value value,
					  const struct gz_loading *loading,
					  const struct gz_log *log,
					  struct gz_particle_frame *out_frame)
{
	struct gz_particle_frame frame = {
		.least = { INFINITY, INFINITY, INFINITY },
		.greatest = { -INFINITY, -INFINITY, -INFINITY },
		.value_range = { INFINITY, -INFINITY },
	};
	enum gz_result result = GZ_OK;
	for (size_t i = 0; i < series->count && result == GZ_OK; i++) {
		if (!gz_loading_goes_on(loading, 0, series->paths[i]))
			return GZ_ERR_CANCELLED;
		result = measure_file(series->paths[i], value, log, &frame);
	}
	if (result != GZ_OK && (frame.count == 0 || result == GZ_ERR_NO_MEM))
		return result;
	if (result != GZ_OK)
		gz_warn(log, "%s: the series ends before this file, after %d time points",
			series->paths[frame.count], frame.count);
	else
		gz_info(log, "%s: %d files are the time points of a series", series->paths[0],
			frame.count);
	*out_frame = frame;
	return GZ_OK;
}
