#include "render/transfer/histogram.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/workers.h"
#include "render/data/brick_pool.h"

#define GZ_LOG_MODULE "histogram"

/* Number of stored values of 16-bit integers. */
enum { VALUES = 65536 };

/* Voxels between two checks of the cancel flag (chosen: about a millisecond). */
enum { PART = 1 << 20 };

/* Each thread counts into several tables in turn: neighbouring voxels are often equal, and
 * incrementing one counter twice would stall. Fewer tables for 16 bits, so that they fit the cache.
 */
enum { WAYS = 4, WAYS_U16 = 2 };

/* The job that the workers share. */
struct counting {
	const struct gz_volume *volume;
	const atomic_bool *cancelled;
	const struct gz_brick_file *file; /* NULL: voxels are in memory */
	const struct gz_brick_level *level;
	double float_low, float_scale; /* bin = (value - low) * scale */
	int bins;                      /* of floats; integers have one counter a value */
	int ways;
	size_t counters;  /* of one table: one a stored value for integers, one a bin for floats */
	uint64_t *counts; /* by worker, table and value or bin */
	void *bricks;     /* a buffer of one brick for each worker */
	atomic_size_t unreadable;
	_Atomic(enum gz_result) why;
};

static bool counting_stopped(const struct counting *counting)
{
	return counting->cancelled &&
	       atomic_load_explicit(counting->cancelled, memory_order_relaxed);
}

static void count_u8(const uint8_t *v, size_t count, uint64_t *counts)
{
	uint64_t *a = counts, *b = a + 256, *c = b + 256, *d = c + 256;
	size_t i = 0;
	for (; i + WAYS <= count; i += WAYS) {
		a[v[i]]++;
		b[v[i + 1]]++;
		c[v[i + 2]]++;
		d[v[i + 3]]++;
	}
	for (; i < count; i++)
		a[v[i]]++;
}

static void count_u16(const uint16_t *v, size_t count, uint64_t *counts)
{
	uint64_t *a = counts, *b = a + VALUES;
	size_t i = 0;
	for (; i + WAYS_U16 <= count; i += WAYS_U16) {
		a[v[i]]++;
		b[v[i + 1]]++;
	}
	for (; i < count; i++)
		a[v[i]]++;
}

static inline size_t float_bin(const struct counting *counting, float value)
{
	const double bin = ((double)value - counting->float_low) * counting->float_scale;
	const double last = counting->bins - 1;
	return (size_t)(bin < 0 ? 0 : bin > last ? last : bin);
}

static void count_f32(const struct counting *counting, const float *v, size_t count,
		      uint64_t *counts, size_t way)
{
	size_t i = 0;
	for (; i + WAYS <= count; i += WAYS)
		for (size_t k = 0; k < WAYS; k++)
			counts[k * way + float_bin(counting, v[i + k])]++;
	for (; i < count; i++)
		counts[float_bin(counting, v[i])]++;
}

static void count_row(const struct counting *counting, const void *voxels, size_t count, int worker)
{
	uint64_t *counts =
		counting->counts + (size_t)(worker * counting->ways) * counting->counters;
	if (counting->volume->type == GZ_VOXEL_U8)
		count_u8(voxels, count, counts);
	else if (counting->volume->type == GZ_VOXEL_U16)
		count_u16(voxels, count, counts);
	else
		count_f32(counting, voxels, count, counts, counting->counters);
}

static void count_part(void *user, size_t part, int worker)
{
	const struct counting *counting = user;
	if (counting_stopped(counting))
		return;
	const size_t all = gz_volume_voxel_count(counting->volume), from = part * PART;
	const size_t count = all - from < PART ? all - from : PART;
	const size_t size = gz_voxel_size(counting->volume->type);
	count_row(counting, (const char *)counting->volume->voxels + from * size, count, worker);
}

/* Count a brick's own voxels (not those of its neighbours) that are within the volume. */
static void count_brick(const struct counting *counting, const int brick[3], const char *voxels,
			int worker)
{
	const size_t size = gz_voxel_size(counting->volume->type);
	int own[3];
	for (int axis = 0; axis < 3; axis++) {
		const int left = counting->level->dims[axis] - brick[axis] * GZ_BRICK_EDGE;
		own[axis] = left < GZ_BRICK_EDGE ? left : GZ_BRICK_EDGE;
	}
	for (int z = 1; z <= own[2]; z++)
		for (int y = 1; y <= own[1]; y++) {
			const size_t row = (size_t)z * GZ_BRICK_STORED_EDGE + (size_t)y;
			count_row(counting, voxels + (row * GZ_BRICK_STORED_EDGE + 1) * size,
				  (size_t)own[0], worker);
		}
}

static void count_brick_part(void *user, size_t part, int worker)
{
	struct counting *counting = user;
	if (counting_stopped(counting))
		return;
	const size_t number = counting->level->first + part;
	char *voxels = (char *)counting->bricks +
		       (size_t)worker * GZ_BRICK_VOXELS * gz_voxel_size(counting->volume->type);
	const enum gz_result result = gz_brick_file_read(counting->file, number, voxels);
	if (result != GZ_OK) {
		atomic_fetch_add(&counting->unreadable, 1);
		atomic_store(&counting->why, result);
		return;
	}
	int level, brick[3];
	gz_brick_place(&counting->file->layout, number, &level, brick);
	count_brick(counting, brick, voxels, worker);
}

/* At most `bins` bins of equally many values each; their ends lie midway between values. */
static void lay_out_integers(const struct gz_volume *volume, int bins, struct gz_histogram *out,
			     int *out_values)
{
	const int values = (int)(volume->stored_max - volume->stored_min) + 1;
	*out_values = (values + bins - 1) / bins;
	out->bins = (values + *out_values - 1) / *out_values;
	out->low = volume->stored_min - 0.5;
	out->width = *out_values;
}

static void lay_out_floats(const struct gz_volume *volume, int bins, struct gz_histogram *out)
{
	const double range = volume->stored_max - volume->stored_min;
	out->bins = range > 0 ? bins : 1;
	out->low = volume->stored_min;
	out->width = range / out->bins;
}

/* Sum the tables of all workers into bins of stored values. */
static void gather_integers(const struct counting *counting, int tables, int values,
			    struct gz_histogram *out)
{
	const int least = (int)counting->volume->stored_min;
	for (size_t value = 0; value < counting->counters; value++) {
		const int bin = ((int)value - least) / values;
		const int at = (int)value < least ? 0 : bin < out->bins ? bin : out->bins - 1;
		for (int table = 0; table < tables; table++)
			out->counts[at] +=
				counting->counts[(size_t)table * counting->counters + value];
	}
}

static void gather_floats(const struct counting *counting, int tables, struct gz_histogram *out)
{
	for (int table = 0; table < tables; table++)
		for (int bin = 0; bin < out->bins; bin++)
			out->counts[bin] +=
				counting->counts[(size_t)table * counting->counters + (size_t)bin];
}

/* From stored to data values; a negative slope reverses the order of the bins. */
static void turn_into_data(const struct gz_volume *volume, struct gz_histogram *out)
{
	const double high = out->low + out->bins * out->width;
	const double a = volume->slope * volume->stored_min + volume->intercept;
	const double b = volume->slope * volume->stored_max + volume->intercept;
	out->data_min = a < b ? a : b;
	out->data_max = a < b ? b : a;
	out->low = volume->slope * (volume->slope > 0 ? out->low : high) + volume->intercept;
	out->width *= fabs(volume->slope);
	for (int i = 0; volume->slope < 0 && i < out->bins / 2; i++) {
		const uint64_t swap = out->counts[i];
		out->counts[i] = out->counts[out->bins - 1 - i];
		out->counts[out->bins - 1 - i] = swap;
	}
	for (int i = 0; i < out->bins; i++) {
		out->total += out->counts[i];
		out->most = out->counts[i] > out->most ? out->counts[i] : out->most;
	}
}

static size_t level_bricks(const struct gz_brick_level *level)
{
	return (size_t)level->bricks[0] * (size_t)level->bricks[1] * (size_t)level->bricks[2];
}

/* Choose the level whose bricks are counted. */
static void choose_level(struct counting *counting, struct gz_histogram *out)
{
	const struct gz_brick_layout *layout = &counting->file->layout;
	int level = 0;
	while (level < layout->level_count - 1 &&
	       level_bricks(&layout->levels[level]) > GZ_HISTOGRAM_BRICKS_MAX)
		level++;
	counting->level = &layout->levels[level];
	out->approximate = level > 0;
}

static enum gz_result count_bricks(struct counting *counting, struct gz_workers *workers,
				   const struct gz_log *log, struct gz_histogram *out)
{
	const size_t bytes = GZ_BRICK_VOXELS * gz_voxel_size(counting->volume->type);
	counting->bricks = malloc((size_t)gz_workers_count(workers) * bytes);
	if (!counting->bricks)
		return GZ_ERR_NO_MEM;
	choose_level(counting, out);
	const size_t bricks = level_bricks(counting->level);
	gz_workers_run(workers, count_brick_part, counting, bricks);
	free(counting->bricks);
	const size_t unreadable = atomic_load(&counting->unreadable);
	if (unreadable == bricks) {
		gz_err(log, "%s: no histogram: no brick can be read", counting->file->path);
		return atomic_load(&counting->why);
	}
	out->approximate |= unreadable > 0;
	return GZ_OK;
}

static enum gz_result count_all_voxels(struct counting *counting, struct gz_workers *workers,
				       const struct gz_log *log, struct gz_histogram *out)
{
	if (counting->file)
		return count_bricks(counting, workers, log, out);
	const size_t all = gz_volume_voxel_count(counting->volume);
	gz_workers_run(workers, count_part, counting, (all + PART - 1) / PART);
	return GZ_OK;
}

static enum gz_result count_into_bins(struct counting *counting, struct gz_workers *workers,
				      int bins, const struct gz_log *log, struct gz_histogram *out)
{
	const bool floats = counting->volume->type == GZ_VOXEL_F32;
	counting->ways = counting->volume->type == GZ_VOXEL_U16 ? WAYS_U16 : WAYS;
	const int tables = counting->ways * gz_workers_count(workers);
	int values = 1;
	if (floats)
		lay_out_floats(counting->volume, bins, out);
	else
		lay_out_integers(counting->volume, bins, out, &values);
	counting->bins = out->bins;
	counting->float_low = out->low;
	counting->float_scale = out->width > 0 ? 1 / out->width : 0;
	counting->counters = floats                                  ? (size_t)out->bins
			     : counting->volume->type == GZ_VOXEL_U8 ? 256
								     : VALUES;
	counting->counts = calloc((size_t)tables * counting->counters, sizeof *counting->counts);
	if (!counting->counts)
		return GZ_ERR_NO_MEM;
	enum gz_result result = count_all_voxels(counting, workers, log, out);
	if (counting_stopped(counting))
		result = GZ_ERR_CANCELLED;
	if (result == GZ_OK && floats)
		gather_floats(counting, tables, out);
	else if (result == GZ_OK)
		gather_integers(counting, tables, values, out);
	free(counting->counts);
	return result;
}

enum gz_result gz_histogram_count(const struct gz_volume *volume, int bins, int threads,
				  const atomic_bool *cancelled, const struct gz_log *log,
				  struct gz_histogram *out_histogram)
{
	if (bins < GZ_HISTOGRAM_BINS_LEAST || bins > GZ_HISTOGRAM_BINS_MAX)
		return GZ_ERR_INVAL;
	struct gz_workers *workers;
	enum gz_result result = gz_workers_create(threads, &workers);
	if (result != GZ_OK)
		return result;
	struct counting counting = { .volume = volume, .cancelled = cancelled };
	if (volume->bricks)
		counting.file = gz_brick_pool_file(volume->bricks);
	struct gz_histogram histogram = { 0 };
	result = count_into_bins(&counting, workers, bins, log, &histogram);
	gz_workers_destroy(&workers);
	if (result == GZ_ERR_NO_MEM)
		gz_err(log, "no memory for the histogram; close other programs");
	if (result != GZ_OK)
		return result;
	turn_into_data(volume, &histogram);
	*out_histogram = histogram;
	return GZ_OK;
}

double gz_histogram_bin_value(const struct gz_histogram *histogram, int bin)
{
	return histogram->low + (bin + 0.5) * histogram->width;
}

int gz_histogram_bin_of(const struct gz_histogram *histogram, double value)
{
	if (!(histogram->width > 0))
		return 0;
	const double bin = (value - histogram->low) / histogram->width;
	return bin < 1 ? 0 : bin < histogram->bins ? (int)bin : histogram->bins - 1;
}

static double within_data(const struct gz_histogram *histogram, double value)
{
	return fmin(fmax(value, histogram->data_min), histogram->data_max);
}

double gz_histogram_percentile(const struct gz_histogram *histogram, double share)
{
	const double wanted = fmin(fmax(share, 0), 1) * (double)histogram->total;
	double below = 0;
	for (int i = 0; i < histogram->bins; i++) {
		const double count = (double)histogram->counts[i];
		if (count > 0 && below + count >= wanted) {
			const double at = i + (wanted - below) / count;
			return within_data(histogram, histogram->low + at * histogram->width);
		}
		below += count;
	}
	return histogram->data_max;
}

/* For each bin: the voxels in the bins before it, and the sum of their bin numbers. */
struct sums {
	double count[GZ_HISTOGRAM_BINS_MAX + 1];
	double moment[GZ_HISTOGRAM_BINS_MAX + 1];
};

static void sum_bins(const struct gz_histogram *histogram, struct sums *out)
{
	out->count[0] = out->moment[0] = 0;
	for (int i = 0; i < histogram->bins; i++) {
		const double count = (double)histogram->counts[i];
		out->count[i + 1] = out->count[i] + count;
		out->moment[i + 1] = out->moment[i] + count * i;
	}
}

/* The term of the class of bins [from, to) in the between-class variance: weight times squared mean
 * (Otsu 1979, eq. 14). Terms that are equal for all thresholds are left out. */
static double class_term(const struct sums *sums, int from, int to)
{
	const double count = sums->count[to] - sums->count[from];
	const double moment = sums->moment[to] - sums->moment[from];
	return count > 0 ? moment * moment / count : 0;
}

static double value_at_bin(const struct gz_histogram *histogram, double bin)
{
	return within_data(histogram, histogram->low + bin * histogram->width);
}

/* All thresholds within a run of empty bins are equally good: take the middle one. */
static double best_split(const struct gz_histogram *histogram, const struct sums *sums, int from,
			 int to)
{
	double best = -1;
	int first = from, last = from;
	for (int at = from + 1; at < to; at++) {
		const double term = class_term(sums, from, at) + class_term(sums, at, to);
		if (term > best) {
			best = term;
			first = at;
		}
		if (term >= best)
			last = at;
	}
	return value_at_bin(histogram, (first + last) / 2.0);
}

/* A volume of one value has no classes. */
static bool one_value(const struct gz_histogram *histogram)
{
	return histogram->total == histogram->most;
}

double gz_histogram_threshold(const struct gz_histogram *histogram)
{
	if (one_value(histogram))
		return histogram->data_min;
	struct sums sums;
	sum_bins(histogram, &sums);
	return best_split(histogram, &sums, 0, histogram->bins);
}

void gz_histogram_two_thresholds(const struct gz_histogram *histogram, double out_thresholds[2])
{
	out_thresholds[0] = out_thresholds[1] = histogram->data_min;
	if (one_value(histogram))
		return;
	struct sums sums;
	sum_bins(histogram, &sums);
	const int bins = histogram->bins;
	double best = -1;
	int best_low = 0, best_high = 0;
	for (int low = 1; low < bins; low++) {
		const double below = class_term(&sums, 0, low);
		for (int high = low; high < bins; high++) {
			const double term = below + class_term(&sums, low, high) +
					    class_term(&sums, high, bins);
			if (term > best) {
				best = term;
				best_low = low;
				best_high = high;
			}
		}
	}
	out_thresholds[0] = best_split(histogram, &sums, 0, best_high);
	out_thresholds[1] = best_split(histogram, &sums, best_low, bins);
}
