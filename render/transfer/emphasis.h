/**
 * @file
 * A range of values that stands out in a transfer function: it becomes more opaque while all others
 * fade. What was visible stays visible, if only a little.
 */
#ifndef GZ_RENDER_TRANSFER_EMPHASIS_H
#define GZ_RENDER_TRANSFER_EMPHASIS_H

#include <stdbool.h>

struct gz_transfer;

/** What stands out. Values are a function's own, 0 to 1. Zero-initialised: nothing. */
struct gz_transfer_emphasis {
	double share; /**< how much it stands out, [0, 1]; 0: not at all */
	double least, greatest;
};

/** Whether two have equal values. */
bool gz_transfer_emphasis_same(const struct gz_transfer_emphasis *a,
			       const struct gz_transfer_emphasis *b);

/**
 * The opacity of a value, by voxel length, with the emphasis. Within the range, by a share of 1,
 * it becomes that of twice the length; elsewhere an eighth remains. In between, beside the range,
 * over a fiftieth of the function's values or a quarter of a narrower range, it changes smoothly.
 *
 * @param opacity  without the emphasis, [0, 1]
 * @return [0, 1]; 0 if and only if @p opacity is 0
 */
double gz_transfer_emphasised(const struct gz_transfer_emphasis *emphasis, double value,
			      double opacity);

/**
 * Find the values around @p value that a function shows as one thing: those up to where opacity
 * becomes 0, or falls to half of a peak and rises to twice that again, or the colour becomes
 * another one. The function's own emphasis does not count.
 *
 * @param value  is clamped to [0, 1]
 * @param[out] out_emphasis  its range is written; the share is 0
 */
void gz_transfer_find_alike(const struct gz_transfer *transfer, double value,
			    struct gz_transfer_emphasis *out_emphasis);

#endif
