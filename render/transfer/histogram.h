/**
 * @file
 * How often each data value occurs in a volume, and where its parts are told apart by that.
 */
#ifndef GZ_RENDER_TRANSFER_HISTOGRAM_H
#define GZ_RENDER_TRANSFER_HISTOGRAM_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "render/data/volume.h"

#define GZ_HISTOGRAM_BINS_LEAST 256
#define GZ_HISTOGRAM_BINS_MAX   1024

/** Bricks of a volume in a file of bricks that are counted at most: the finest level that has no
 *  more. Chosen: 16 million voxels are counted in a moment, and tell as much as more would. */
#define GZ_HISTOGRAM_BRICKS_MAX 512

/** Counts of voxels by data value. Bin i holds the values from low + i * width up to, but without,
 *  low + (i + 1) * width; the last also the greatest. */
struct gz_histogram {
	int bins;     /**< 1 to GZ_HISTOGRAM_BINS_MAX */
	double low;   /**< data value at the lower end of bin 0 */
	double width; /**< of a bin, data values; above 0 but for floats that are all the same */
	double data_min, data_max; /**< the volume's least and greatest data value */
	bool approximate; /**< counted over a coarser level of a file of bricks, whose voxels are
			     means of the volume's, or without some that cannot be read */
	uint64_t total;   /**< voxels counted */
	uint64_t most;    /**< the greatest count */
	uint64_t counts[GZ_HISTOGRAM_BINS_MAX];
};

/**
 * Count the voxels of a volume. Integers get bins of as many stored values each, so that no bin
 * stands out for holding one more: there are fewer bins than asked for where values do not divide
 * evenly or are few. Their ends lie midway between stored values.
 *
 * @param bins       GZ_HISTOGRAM_BINS_LEAST to GZ_HISTOGRAM_BINS_MAX: the most bins
 * @param threads    as for gz_workers_create(); the same counts for any number
 * @param cancelled  looked at every few milliseconds, to stop when it becomes true; NULL for never
 * @param log        may be NULL
 * @param[out] out_histogram  what was counted
 * @retval GZ_ERR_INVAL      @p bins or @p threads out of range
 * @retval GZ_ERR_NO_MEM     no room; logged
 * @retval GZ_ERR_IO, GZ_ERR_FORMAT  no brick of a file of bricks can be read; logged
 * @retval GZ_ERR_CANCELLED  not logged
 *
 * Threads: any, also while the volume is shown: bricks are read from their file, past the pool.
 */
enum gz_result gz_histogram_count(const struct gz_volume *volume, int bins, int threads,
				  const atomic_bool *cancelled, const struct gz_log *log,
				  struct gz_histogram *out_histogram);

/** The data value below which @p share of the voxels lie, 0 to 1; within a bin as if its voxels
 *  were spread evenly. Never outside data_min to data_max. */
double gz_histogram_percentile(const struct gz_histogram *histogram, double share);

/** The middle of a bin, data value. */
double gz_histogram_bin_value(const struct gz_histogram *histogram, int bin);

/** The bin that a data value falls into; the first or last for those outside. */
int gz_histogram_bin_of(const struct gz_histogram *histogram, double value);

/**
 * The data value that parts the voxels best into two classes: between-class variance is greatest
 * (Otsu, A threshold selection method from gray-level histograms, 1979, eq. 18). Where several do,
 * their middle. data_min for a volume of one value.
 */
double gz_histogram_threshold(const struct gz_histogram *histogram);

/** The two data values, rising, that part them best into three (Otsu 1979, section IV.A). Both
 *  data_min for a volume of one value. */
void gz_histogram_two_thresholds(const struct gz_histogram *histogram, double out_thresholds[2]);

#endif
