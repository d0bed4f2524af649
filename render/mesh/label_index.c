#include "render/mesh/label_index.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define GZ_LOG_MODULE "labels"

/* Stored integers that there can be: each has an entry of a table. */
enum { STORED_MAX = 1 << 16 };

/* Places of the set of numbers of a float volume: a power of two, twice the labels and more. */
enum { SET_PLACES = 4096 };

void gz_label_run(struct gz_workers *workers, gz_workers_part *part, void *user, size_t parts)
{
	if (workers) {
		gz_workers_run(workers, part, user, parts);
		return;
	}
	for (size_t i = 0; i < parts; i++)
		part(user, i, 0);
}

static bool is_label_number(double value)
{
	return value == rint(value) && fabs(value) <= INT32_MAX;
}

static enum gz_result refuse_value(const char *name, double value, const struct gz_log *log)
{
	gz_err(log,
	       "%s is not a volume of labels: it has the value %g; labels are whole numbers, 0 for "
	       "no label",
	       name, value);
	return GZ_ERR_FORMAT;
}

static enum gz_result refuse_count(const char *name, const struct gz_log *log)
{
	gz_err(log, "%s has more than %d labels; if it is not a segmentation, show it as a volume",
	       name, GZ_LABELS_MAX);
	return GZ_ERR_FULL;
}

/* ---- which numbers there are ---- */

/* Counts of stored integers, of one thread each. */
struct counting {
	const struct gz_volume *volume;
	uint64_t *counts; /* STORED_MAX for each worker */
	size_t slice;
};

static void count_slice(void *user, size_t part, int worker)
{
	const struct counting *counting = user;
	uint64_t *counts = counting->counts + (size_t)worker * STORED_MAX;
	const size_t first = part * counting->slice, end = first + counting->slice;
	if (counting->volume->type == GZ_VOXEL_U8)
		for (size_t i = first; i < end; i++)
			counts[((const uint8_t *)counting->volume->voxels)[i]]++;
	else
		for (size_t i = first; i < end; i++)
			counts[((const uint16_t *)counting->volume->voxels)[i]]++;
}

static int compare_numbers(const void *a, const void *b)
{
	const int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
	return (x > y) - (x < y);
}

static enum gz_result add_number(struct gz_label_index *index, const char *name, double value,
				 const struct gz_log *log)
{
	if (!is_label_number(value))
		return refuse_value(name, value, log);
	if (value == 0)
		return GZ_OK;
	if (index->count == GZ_LABELS_MAX)
		return refuse_count(name, log);
	index->numbers[index->count++] = (int32_t)value;
	return GZ_OK;
}

static double label_value(const struct gz_volume *volume, double stored)
{
	return volume->slope * stored + volume->intercept;
}

static enum gz_result find_integers(const struct gz_volume *volume, const char *name,
				    struct gz_workers *workers, const struct gz_log *log,
				    struct gz_label_index *index)
{
	const size_t threads = workers ? (size_t)gz_workers_count(workers) : 1;
	struct counting counting = {
		.volume = volume,
		.counts = calloc(threads * STORED_MAX, sizeof *counting.counts),
		.slice = (size_t)volume->dims[0] * (size_t)volume->dims[1],
	};
	enum gz_result result = GZ_OK;
	if (!counting.counts)
		return GZ_ERR_NO_MEM;
	gz_label_run(workers, count_slice, &counting, (size_t)volume->dims[2]);
	for (size_t stored = 0; stored < STORED_MAX && result == GZ_OK; stored++) {
		uint64_t count = 0;
		for (size_t i = 0; i < threads; i++)
			count += counting.counts[i * STORED_MAX + stored];
		if (count > 0)
			result = add_number(index, name, label_value(volume, (double)stored), log);
	}
	free(counting.counts);
	return result;
}

/* A set of floats; NaN marks free places. */
static bool put_into_set(float *set, float value)
{
	uint32_t bits;
	memcpy(&bits, &value, sizeof bits);
	for (size_t at = bits * 2654435761U % SET_PLACES;; at = (at + 1) % SET_PLACES) {
		if (set[at] == value)
			return false;
		if (isnan(set[at])) {
			set[at] = value;
			return true;
		}
	}
}

static enum gz_result find_floats(const struct gz_volume *volume, const char *name,
				  const struct gz_log *log, struct gz_label_index *index)
{
	const float *voxels = volume->voxels;
	const size_t count = gz_volume_voxel_count(volume);
	float set[SET_PLACES];
	for (size_t i = 0; i < SET_PLACES; i++)
		set[i] = NAN;
	for (size_t i = 0; i < count; i++) {
		if (i > 0 && voxels[i] == voxels[i - 1])
			continue;
		if (isnan(voxels[i]))
			return refuse_value(name, NAN, log);
		if (!put_into_set(set, voxels[i]))
			continue;
		const enum gz_result result =
			add_number(index, name, label_value(volume, (double)voxels[i]), log);
		if (result != GZ_OK)
			return result;
	}
	return GZ_OK;
}

/* ---- each voxel's place ---- */

/* What the threads share. */
struct placing {
	const struct gz_volume *volume;
	struct gz_label_index *index;
	const uint16_t *places;                /* of stored integers */
	uint64_t (*voxels)[GZ_LABELS_MAX + 1]; /* of each worker */
};

static uint16_t place_of(const struct gz_label_index *index, double value)
{
	const int32_t number = (int32_t)value;
	const int32_t *found =
		bsearch(&number, index->numbers, index->count, sizeof number, compare_numbers);
	return found ? (uint16_t)(found - index->numbers + 1) : 0;
}

static void place_floats(const struct placing *placing, const float *from, size_t count,
			 uint16_t *to)
{
	for (size_t i = 0; i < count; i++)
		to[i] = i > 0 && from[i] == from[i - 1]
				? to[i - 1]
				: place_of(placing->index,
					   label_value(placing->volume, (double)from[i]));
}

static void place_row(const struct placing *placing, size_t offset, uint16_t *to)
{
	const size_t count = (size_t)placing->volume->dims[0];
	const uint8_t *bytes = (const uint8_t *)placing->volume->voxels + offset;
	const uint16_t *words = (const uint16_t *)placing->volume->voxels + offset;
	if (placing->volume->type == GZ_VOXEL_F32) {
		place_floats(placing, (const float *)placing->volume->voxels + offset, count, to);
		return;
	}
	for (size_t i = 0; i < count; i++)
		to[i] = placing->places[placing->volume->type == GZ_VOXEL_U8 ? bytes[i] : words[i]];
}

/* One slice, with the empty layer round it. The first and the last slice are empty. */
static void place_slice(void *user, size_t part, int worker)
{
	const struct placing *placing = user;
	const int *dims = placing->volume->dims;
	const size_t width = (size_t)dims[0] + 2, height = (size_t)dims[1] + 2;
	uint16_t *slice = placing->index->labels + part * width * height;
	memset(slice, 0, width * height * sizeof *slice);
	if (part == 0 || part == (size_t)dims[2] + 1)
		return;
	for (size_t y = 0; y < (size_t)dims[1]; y++) {
		uint16_t *row = slice + (y + 1) * width + 1;
		place_row(placing, ((part - 1) * (size_t)dims[1] + y) * (size_t)dims[0], row);
		for (size_t x = 0; x < (size_t)dims[0]; x++)
			placing->voxels[worker][row[x]]++;
	}
}

static enum gz_result place_all(const struct gz_volume *volume, struct gz_workers *workers,
				struct gz_label_index *index)
{
	const size_t threads = workers ? (size_t)gz_workers_count(workers) : 1;
	uint16_t *places = calloc(STORED_MAX, sizeof *places);
	struct placing placing = { volume, index, places, calloc(threads, sizeof *placing.voxels) };
	index->voxels = calloc(index->count + 1, sizeof *index->voxels);
	if (places && placing.voxels && index->voxels) {
		for (size_t i = 0; volume->type != GZ_VOXEL_F32 && i < STORED_MAX; i++)
			places[i] = is_label_number(label_value(volume, (double)i))
					    ? place_of(index, label_value(volume, (double)i))
					    : 0;
		gz_label_run(workers, place_slice, &placing, (size_t)volume->dims[2] + 2);
		for (size_t i = 0; i < index->count; i++)
			for (size_t k = 0; k < threads; k++)
				index->voxels[i] += placing.voxels[k][i + 1];
	}
	const bool complete = places && placing.voxels && index->voxels;
	free(places);
	free(placing.voxels);
	return complete ? GZ_OK : GZ_ERR_NO_MEM;
}

static enum gz_result check_label_volume(const struct gz_volume *volume, const char *name,
					 const struct gz_log *log)
{
	if (!volume->voxels) {
		gz_err(log,
		       "%s: labels need all voxels in memory, and the volume is stored in bricks; "
		       "use the "
		       "file that it was made from",
		       name);
		return GZ_ERR_UNSUPPORTED;
	}
	if (volume->colours) {
		gz_err(log, "%s is not a volume of labels: its voxels have colours", name);
		return GZ_ERR_FORMAT;
	}
	return GZ_OK;
}

static enum gz_result make_index(const struct gz_volume *volume, const char *name,
				 struct gz_workers *workers, const struct gz_log *log,
				 struct gz_label_index *index)
{
	size_t places = 1;
	for (int axis = 0; axis < 3; axis++) {
		index->dims[axis] = volume->dims[axis];
		places *= (size_t)volume->dims[axis] + 2;
	}
	if (!gz_memory_fits_machine(places * sizeof *index->labels))
		return GZ_ERR_NO_MEM;
	index->labels = malloc(places * sizeof *index->labels);
	index->numbers = malloc(GZ_LABELS_MAX * sizeof *index->numbers);
	if (!index->labels || !index->numbers)
		return GZ_ERR_NO_MEM;
	enum gz_result result = volume->type == GZ_VOXEL_F32
					? find_floats(volume, name, log, index)
					: find_integers(volume, name, workers, log, index);
	if (result != GZ_OK)
		return result;
	qsort(index->numbers, index->count, sizeof *index->numbers, compare_numbers);
	return place_all(volume, workers, index);
}

enum gz_result gz_label_index_make(const struct gz_volume *volume, const char *name,
				   struct gz_workers *workers, const struct gz_log *log,
				   struct gz_label_index *out_index)
{
	struct gz_label_index index = { .count = 0 };
	enum gz_result result = check_label_volume(volume, name, log);
	if (result == GZ_OK)
		result = make_index(volume, name, workers, log, &index);
	if (result == GZ_ERR_NO_MEM)
		gz_err(log, "%s: not enough memory for its labels: it has %d x %d x %d voxels",
		       name, volume->dims[0], volume->dims[1], volume->dims[2]);
	if (result == GZ_OK)
		*out_index = index;
	else
		gz_label_index_free(&index);
	return result;
}

void gz_label_index_free(struct gz_label_index *index)
{
	free(index->numbers);
	free(index->voxels);
	free(index->labels);
	*index = (struct gz_label_index) { .count = 0 };
}
