/**
 * @file
 * Times of frames that others have printed: published_times.json, with its sources.
 */
#ifndef GZ_BENCH_REPORT_PUBLISHED_TIMES_H
#define GZ_BENCH_REPORT_PUBLISHED_TIMES_H

#include <jansson.h>
#include <stddef.h>

/** The list of sources; each has "name", "title", "where", "measured", "machines" and "rows". A row
 *  has "technique", "effect", "slices" (0: none, or not stated) and "frame_ms", and may have
 *  "weighted_ms" and "prepare_ms", each a number for every machine. The caller's: json_decref().
 *  NULL without memory. */
json_t *gz_published_times(void);

/**
 * The printed time of a frame.
 *
 * @param source   one of the list
 * @param machine  index into its machines
 * @return ms; NaN if it was not printed
 */
double gz_published_ms(const json_t *source, size_t machine, const char *technique,
		       const char *effect, int slices);

#endif
