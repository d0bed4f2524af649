/* What a histogram tells: shares, and the classes that its values fall into. */
#include <math.h>

#include "render/transfer/histogram.h"

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

/* Voxels before each bin, and the sum of their bins' numbers. */
struct sums {
	double count[GZ_HISTOGRAM_BINS_MAX + 1];
	double moment[GZ_HISTOGRAM_BINS_MAX + 1];
};

static void sum_up(const struct gz_histogram *histogram, struct sums *out)
{
	out->count[0] = out->moment[0] = 0;
	for (int i = 0; i < histogram->bins; i++) {
		const double count = (double)histogram->counts[i];
		out->count[i + 1] = out->count[i] + count;
		out->moment[i + 1] = out->moment[i] + count * i;
	}
}

/* What the class of the bins [from, to) adds to the between-class variance, but for what is the
 * same however they are parted: weight times the square of its mean (Otsu 1979, eq. 14). */
static double class_term(const struct sums *sums, int from, int to)
{
	const double count = sums->count[to] - sums->count[from];
	const double moment = sums->moment[to] - sums->moment[from];
	return count > 0 ? moment * moment / count : 0;
}

static double end_of(const struct gz_histogram *histogram, double bin)
{
	return within_data(histogram, histogram->low + bin * histogram->width);
}

/* Between empty bins it makes no difference where the threshold lies: the middle of those equal. */
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
	return end_of(histogram, (first + last) / 2.0);
}

/* Counts of one value alone have nothing to part. */
static bool one_value(const struct gz_histogram *histogram)
{
	return histogram->total == histogram->most;
}

double gz_histogram_threshold(const struct gz_histogram *histogram)
{
	if (one_value(histogram))
		return histogram->data_min;
	struct sums sums;
	sum_up(histogram, &sums);
	return best_split(histogram, &sums, 0, histogram->bins);
}

void gz_histogram_two_thresholds(const struct gz_histogram *histogram, double out_thresholds[2])
{
	out_thresholds[0] = out_thresholds[1] = histogram->data_min;
	if (one_value(histogram))
		return;
	struct sums sums;
	sum_up(histogram, &sums);
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
