#include "render/transfer/emphasis.h"

#include <math.h>

#include "render/transfer/transfer.h"

/* Chosen by looking at pictures: what remains can be told from nothing, and hides little. */
#define REST 0.125

/* Widest stretch beside a range in which the emphasis ends, in values of the function. Chosen. */
#define EDGE 0.02

/* Steps by which a function is looked through. Chosen: a peak of a hundredth has ten. */
#define STEPS 1024

/* How far colours may lie apart that are one thing: the distance of red, green and blue, of which
 * black and white have 1.7. Chosen: shades of bone are one, bone and flesh are two. */
#define COLOUR_ALIKE 0.3

bool gz_transfer_emphasis_same(const struct gz_transfer_emphasis *a,
			       const struct gz_transfer_emphasis *b)
{
	return a->share == b->share && a->least == b->least && a->greatest == b->greatest;
}

/* How much of the emphasis a value has, [0, 1]. */
static double weight_of(const struct gz_transfer_emphasis *emphasis, double value)
{
	const double edge = fmin(EDGE, (emphasis->greatest - emphasis->least) / 4);
	const double beyond = fmax(emphasis->least - value, value - emphasis->greatest);
	if (!(beyond > 0))
		return 1;
	if (beyond >= edge)
		return 0;
	const double t = 1 - beyond / edge;
	return t * t * (3 - 2 * t);
}

double gz_transfer_emphasised(const struct gz_transfer_emphasis *emphasis, double value,
			      double opacity)
{
	const double clamped = fmin(1, fmax(0, value));
	const double faded = opacity * (1 - emphasis->share * (1 - REST));
	const double raised = 1 - pow(1 - opacity, 1 + emphasis->share);
	return faded + (raised - faded) * weight_of(emphasis, clamped);
}

/* A search from a value to one side. */
struct search {
	const struct gz_transfer *transfer; /* without emphasis */
	double rgba[4];                     /* at the value */
	double peak;                        /* greatest opacity so far */
	double low, low_at;                 /* least one since, and where */
};

static bool another_colour(const struct search *search, const double rgba[4])
{
	double sum = 0;
	for (int i = 0; i < 3; i++)
		sum += (rgba[i] - search->rgba[i]) * (rgba[i] - search->rgba[i]);
	return sum > COLOUR_ALIKE * COLOUR_ALIKE;
}

/* Look at the next value. Returns whether the range ends; then low_at is where. */
static bool ends_at(struct search *search, double at)
{
	double rgba[4];
	gz_transfer_evaluate(search->transfer, at, rgba);
	if (rgba[3] >= 2 * search->low && search->low <= search->peak / 2)
		return true;
	if (rgba[3] > search->peak || rgba[3] <= search->low) {
		search->low = rgba[3];
		search->low_at = at;
	}
	search->peak = fmax(search->peak, rgba[3]);
	if (rgba[3] > 0 && !another_colour(search, rgba))
		return false;
	search->low_at = at;
	return true;
}

/* Where the range ends on one side: direction is -1 or 1. */
static double end_of(struct search search, double value, int direction)
{
	search.peak = search.low = search.rgba[3];
	search.low_at = value;
	const double end = direction < 0 ? 0 : 1;
	for (int step = 1;; step++) {
		const double at = value + direction * (double)step / STEPS;
		if (direction < 0 ? at <= end : at >= end)
			return end;
		if (ends_at(&search, at))
			return search.low_at;
	}
}

void gz_transfer_find_alike(const struct gz_transfer *transfer, double value,
			    struct gz_transfer_emphasis *out_emphasis)
{
	struct gz_transfer plain = *transfer;
	plain.emphasis = (struct gz_transfer_emphasis) { 0 };
	struct search search = { .transfer = &plain };
	const double at = fmin(1, fmax(0, value));
	gz_transfer_evaluate(&plain, at, search.rgba);
	*out_emphasis = (struct gz_transfer_emphasis) {
		.least = end_of(search, at, -1),
		.greatest = end_of(search, at, 1),
	};
}
