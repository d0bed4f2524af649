/**
 * @file
 * Histograms of data values, and the thresholds that separate a volume's parts by value.
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

/** Most bricks that are counted of a file of bricks: the finest level with no more bricks is used.
 *  Chosen: 16 million voxels are counted in a moment, and more would not change the result. */
#define GZ_HISTOGRAM_BRICKS_MAX 512

/** Counts of voxels by data value. Bin i holds the values in [low + i * width, low + (i + 1) *
 * width); the last bin also holds its upper end. */
struct gz_histogram {
	int bins;     /**< 1 to GZ_HISTOGRAM_BINS_MAX */
	double low;   /**< data value at the lower end of bin 0 */
	double width; /**< of a bin, data values; above 0, or 0 if all voxels are one float */
	double data_min, data_max; /**< the volume's least and greatest data value */
	bool approximate; /**< counted on a coarser level of a file of bricks, whose voxels are
			     means of the volume's, or some bricks cannot be read */
	uint64_t total;   /**< voxels counted */
	uint64_t most;    /**< the greatest count */
	uint64_t counts[GZ_HISTOGRAM_BINS_MAX];
};

/**
 * Count the voxels of a volume. For integers every bin spans the same number of stored values, so
 * that no bin stands out: there may be fewer bins than asked for. Bins end midway between stored
 * values.
 *
 * @param bins       GZ_HISTOGRAM_BINS_LEAST to GZ_HISTOGRAM_BINS_MAX: the most bins
 * @param threads    as for gz_workers_create(); the counts are the same for any number
 * @param cancelled  checked every few milliseconds; counting stops when it is true; may be NULL
 * @param log        may be NULL
 * @param[out] out_histogram  written on GZ_OK
 * @retval GZ_ERR_INVAL      @p bins or @p threads out of range
 * @retval GZ_ERR_NO_MEM     logged
 * @retval GZ_ERR_IO, GZ_ERR_FORMAT  no brick of a file of bricks can be read; logged
 * @retval GZ_ERR_CANCELLED  not logged
 *
 * Threads: any, also while the volume is shown: bricks are read from their file, not from the pool.
 */
enum gz_result gz_histogram_count(const struct gz_volume *volume, int bins, int threads,
				  const atomic_bool *cancelled, const struct gz_log *log,
				  struct gz_histogram *out_histogram);

/** The data value below which the share @p share of the voxels lies, 0 to 1. Within a bin, voxels
 *  count as evenly distributed. The result is within data_min to data_max. */
double gz_histogram_percentile(const struct gz_histogram *histogram, double share);

/** The data value at the centre of a bin. */
double gz_histogram_bin_value(const struct gz_histogram *histogram, int bin);

/** The bin of a data value; the first or last bin for values outside. */
int gz_histogram_bin_of(const struct gz_histogram *histogram, double value);

/**
 * The data value that separates the voxels best into two classes: the one of greatest between-class
 * variance (Otsu, A threshold selection method from gray-level histograms, 1979, eq. 18), or the
 * middle of several. data_min for a volume of one value.
 */
double gz_histogram_threshold(const struct gz_histogram *histogram);

/** The two data values, in rising order, that separate the voxels best into three classes (Otsu
 *  1979, section IV.A). Both are data_min for a volume of one value. */
void gz_histogram_two_thresholds(const struct gz_histogram *histogram, double out_thresholds[2]);

#endif
