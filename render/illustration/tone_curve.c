#include "render/illustration/tone_curve.h"

#include "render/illustration/plane_kernels.h"
#include "render/illustration/tone_loops.h"

void gz_tone_count(const void *map, const uint32_t *ids, size_t count, size_t step,
		   struct gz_tone_histogram *histogram)
{
	gz_plane_kernels_find()->count_tones(map, ids, count, step, histogram);
}

void gz_tone_curve_make(const struct gz_tone_histogram *histograms, size_t count,
			struct gz_tone_curve *out_curve)
{
	uint64_t total = 0, below = 0;
	for (size_t k = 0; k < count; k++)
		for (size_t bin = 0; bin < GZ_TONE_BINS; bin++)
			total += histograms[k].counts[bin];
	for (size_t bin = 0; bin < GZ_TONE_BINS; bin++) {
		for (size_t k = 0; k < count; k++)
			below += histograms[k].counts[bin];
		out_curve->values[bin] = total > 0 ? (float)((double)below / (double)total)
						   : (float)bin / (GZ_TONE_BINS - 1);
	}
}

/* Tones to either side for which a tone counts. */
enum { AROUND = GZ_TONE_BINS / 128 };

/* The share of pixels in the tones around one, of a curve that is 0 before its first tone. */
static float share_around(const struct gz_tone_curve *curve, int bin)
{
	const int first = bin - AROUND - 1, last = bin + AROUND;
	const float below = first < 0 ? 0 : curve->values[first];
	return curve->values[last < GZ_TONE_BINS ? last : GZ_TONE_BINS - 1] - below;
}

void gz_tone_curve_steady(struct gz_tone_curve *curve)
{
	const float most = (GZ_TONE_RISE_MOST - 1.0F) / GZ_TONE_BINS;
	float shares[GZ_TONE_BINS];
	double sum = 0, rising = 0;
	for (int bin = 0; bin < GZ_TONE_BINS; bin++) {
		const float share = share_around(curve, bin) / (2 * AROUND + 1);
		shares[bin] = share < most ? share : most;
		sum += shares[bin];
	}
	for (int bin = 0; bin < GZ_TONE_BINS; bin++) {
		rising += shares[bin] + (1 - sum) / GZ_TONE_BINS;
		curve->values[bin] = (float)(rising < 1 ? rising : 1);
	}
}

void gz_tone_curve_soften(float share, struct gz_tone_curve *curve)
{
	for (size_t bin = 0; bin < GZ_TONE_BINS; bin++) {
		const float same = (float)bin / (GZ_TONE_BINS - 1);
		curve->values[bin] = same + share * (curve->values[bin] - same);
	}
}

void gz_tone_apply(const struct gz_tone_curve *curve, const uint32_t *ids, size_t count, float *map)
{
	tone_apply_loop(curve, ids, count, map);
}
