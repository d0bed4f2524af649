#include "render/illustration/shading_measures.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

/* Places that are measured along the picture's height, and the two distances over which tones are
 * compared, as parts of it. Chosen: a place every four pixels of 1080, and on a still picture the
 * numbers change by less than 0.01 with twice as many. */
enum { PLACES_A_HEIGHT = 270, FINE_A_HEIGHT = 400, WIDE_A_HEIGHT = 40 };

/* Values that are told apart. */
enum { BINS = 512 };

/* A step of depth, as a share of the scene's depth: the other side is another part of a surface.
 * Chosen: 1/50, over the fine distance. */
#define STEP_OF_DEPTH 0.02

/* What is counted. */
struct counts {
	const struct gz_shading_frame *frame;
	int fine, wide; /* distances, px */
	uint64_t places, on_objects, edges;
	uint64_t fine_pairs, wide_pairs;
	double fine_squares, wide_squares;
	uint64_t tones[BINS], depths[BINS];
};

static double value_of(const void *plane, size_t at)
{
	float value;
	memcpy(&value, (const char *)plane + at * sizeof value, sizeof value);
	return value > 0 ? fmin(1, (double)value) : 0; /* NaN: 0 */
}

static double depth_of(const struct gz_shading_frame *frame, size_t at)
{
	float depth;
	memcpy(&depth, (const char *)frame->depth + at * sizeof depth, sizeof depth);
	const double share = (double)((depth - frame->near) / (frame->far - frame->near));
	return share > 0 ? fmin(1, share) : 0;
}

static size_t bin_of(double value)
{
	const size_t bin = (size_t)(value * BINS);
	return bin < BINS ? bin : BINS - 1;
}

/* Compare a place with one to its right or below. */
static void compare(struct counts *counts, size_t at, size_t other, int distance)
{
	const struct gz_shading_frame *frame = counts->frame;
	const bool apart = frame->ids[at] != frame->ids[other] ||
			   fabs(depth_of(frame, at) - depth_of(frame, other)) >
				   STEP_OF_DEPTH * distance / counts->fine;
	const double change = value_of(frame->tone, at) - value_of(frame->tone, other);
	if (distance == counts->fine)
		counts->edges += apart;
	if (apart)
		return;
	if (distance == counts->fine) {
		counts->fine_squares += change * change;
		counts->fine_pairs++;
	} else {
		counts->wide_squares += change * change;
		counts->wide_pairs++;
	}
}

static void measure_place(struct counts *counts, int x, int y)
{
	const struct gz_shading_frame *frame = counts->frame;
	const size_t width = (size_t)frame->width;
	const size_t at = (size_t)y * width + (size_t)x;
	const int distances[2] = { counts->fine, counts->wide };
	counts->places++;
	if (frame->ids[at] == 0)
		return;
	counts->on_objects++;
	counts->tones[bin_of(value_of(frame->tone, at))]++;
	counts->depths[bin_of(depth_of(frame, at))]++;
	for (int i = 0; i < 2; i++) {
		if (x + distances[i] < frame->width)
			compare(counts, at, at + (size_t)distances[i], distances[i]);
		if (y + distances[i] < frame->height)
			compare(counts, at, at + (size_t)distances[i] * width, distances[i]);
	}
}

/* The value below which a share of what was counted lies. */
static double quantile(const uint64_t counted[BINS], uint64_t total, double share)
{
	const double wanted = share * (double)total;
	double below = 0;
	for (int bin = 0; bin < BINS; bin++) {
		const double in_bin = (double)counted[bin];
		if (in_bin > 0 && below + in_bin >= wanted)
			return (bin + fmax(0, wanted - below) / in_bin) / BINS;
		below += in_bin;
	}
	return 1;
}

static int part_of_height(const struct gz_shading_frame *frame, int parts)
{
	const int pixels = (frame->height + parts / 2) / parts;
	return pixels > 1 ? pixels : 1;
}

/* An edge of any direction is crossed by looks to the right and down: together 4 / pi times as
 * often as by looks across it. */
#define CROSSINGS 1.2732395447351628

static void finish_measures(const struct counts *counts, struct gz_shading_measures *out_measures)
{
	const double on_objects = (double)counts->on_objects;
	const uint64_t total = counts->on_objects;
	*out_measures = (struct gz_shading_measures) { 0 };
	if (total == 0)
		return;
	*out_measures = (struct gz_shading_measures) {
		.covered = on_objects / (double)counts->places,
		.tone_spread =
			quantile(counts->tones, total, 0.9) - quantile(counts->tones, total, 0.1),
		.tone_fine = sqrt(counts->fine_squares / fmax(1, (double)counts->fine_pairs)),
		.tone_wide = sqrt(counts->wide_squares / fmax(1, (double)counts->wide_pairs)),
		.depth_middle = quantile(counts->depths, total, 0.5),
		.depth_spread =
			quantile(counts->depths, total, 0.9) - quantile(counts->depths, total, 0.1),
		.edges = (double)counts->edges / on_objects * counts->frame->height /
			 (CROSSINGS * counts->fine),
	};
}

void gz_shading_measure(const struct gz_shading_frame *frame,
			struct gz_shading_measures *out_measures)
{
	struct counts counts = { .frame = frame };
	const int step = part_of_height(frame, PLACES_A_HEIGHT);
	counts.fine = part_of_height(frame, FINE_A_HEIGHT);
	counts.wide = part_of_height(frame, WIDE_A_HEIGHT);
	if (counts.wide == counts.fine)
		counts.wide++;
	for (int y = step / 2; y < frame->height; y += step)
		for (int x = step / 2; x < frame->width; x += step)
			measure_place(&counts, x, y);
	finish_measures(&counts, out_measures);
}
