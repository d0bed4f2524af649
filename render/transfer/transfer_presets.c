#include "render/transfer/transfer_presets.h"

#include <math.h>
#include <stdbool.h>

#include "render/transfer/colour_map.h"

/* All looks are chosen by eye on the scenes of etc/scenes/. Those for CT begin and end between the
 * Hounsfield units of tissues, about: air -1000, lung -900 to -500, fat -120 to -50, muscle and
 * organs 20 to 70, blood with contrast medium 100 to 500, spongy bone 200 to 400, compact bone
 * above 700 (Prokop and Galanski, Spiral and Multislice Computed Tomography of the Body, 2003; the
 * tables of others differ by some tens). */

/* A colour, 0 to 1. */
struct colour {
	double r, g, b;
};

/* A transfer function that is being made; values are data values. */
struct making {
	const struct gz_histogram *histogram;
	double edge; /* of the volume, voxel lengths */
	double low, high;
	struct gz_transfer *transfer;
};

/* Opacity of one voxel length such that `share` of the volume's longest edge hides `hidden` of what
 * is behind it: the inverse of gz_transfer_opacity_over(). */
static double per_voxel(const struct making *making, double hidden, double share)
{
	return 1 - pow(1 - hidden, 1 / fmax(share * making->edge, 1));
}

static double at_share(const struct making *making, double share)
{
	return making->low + share * (making->high - making->low);
}

/* The mean of the values on one side of @p threshold. */
static double mean_beyond(const struct making *making, double threshold, bool below)
{
	const struct gz_histogram *histogram = making->histogram;
	double sum = 0, count = 0;
	for (int bin = 0; bin < histogram->bins; bin++) {
		const double value = gz_histogram_bin_value(histogram, bin);
		if ((value < threshold) == below) {
			sum += value * (double)histogram->counts[bin];
			count += (double)histogram->counts[bin];
		}
	}
	return count > 0 ? sum / count : threshold;
}

/* Halfway from the mean of the background to the threshold between background and object: above the
 * background's noise, below the faint parts of the object. */
static double background_end(const struct making *making, bool dark)
{
	const double threshold = gz_histogram_threshold(making->histogram);
	return (mean_beyond(making, threshold, dark) + threshold) / 2;
}

/* Add the next point. A value below the last point's or outside the range is moved to it. */
static void add_point(struct making *making, double value, struct colour colour, double opacity)
{
	struct gz_transfer *transfer = making->transfer;
	const double width = making->high - making->low;
	double at = width > 0 ? fmin(fmax((value - making->low) / width, 0), 1) : 0;
	const size_t count = transfer->count;
	if (count > 0)
		at = fmax(at, transfer->points[count - 1].value);
	if (count > 1 && at <= transfer->points[count - 2].value)
		return; /* two points of one value make a step; a third is never used */
	transfer->points[transfer->count++] = (struct gz_transfer_point) {
		.value = at,
		.rgb = { colour.r, colour.g, colour.b },
		.opacity = opacity,
	};
}

static void make_tissue(struct making *making)
{
	double threshold[2];
	gz_histogram_two_thresholds(making->histogram, threshold);
	const struct colour dark = { 0.35, 0.12, 0.08 }, flesh = { 0.85, 0.52, 0.40 };
	const struct colour ivory = { 0.97, 0.93, 0.83 };
	const double veil = per_voxel(making, 0.75, 0.1), solid = per_voxel(making, 0.97, 0.02);
	const double ramp = at_share(making, 0.04) - making->low;
	add_point(making, making->low, dark, 0);
	add_point(making, threshold[0] - ramp, dark, 0);
	add_point(making, threshold[0] + ramp, flesh, veil);
	add_point(making, fmax(threshold[1] - ramp, threshold[0] + ramp), flesh, veil);
	add_point(making, threshold[1] + 2 * ramp, ivory, solid);
	add_point(making, making->high, (struct colour) { 1, 1, 1 }, solid);
}

static void make_surface(struct making *making)
{
	const double threshold = gz_histogram_threshold(making->histogram);
	const double ramp = at_share(making, 0.03) - making->low;
	const double solid = per_voxel(making, 0.98, 0.015);
	const struct colour stone = { 0.88, 0.84, 0.76 };
	add_point(making, making->low, stone, 0);
	add_point(making, threshold - ramp, stone, 0);
	add_point(making, threshold + ramp, stone, solid);
	add_point(making, making->high, (struct colour) { 1, 0.98, 0.94 }, solid);
}

/* Show only values near one value. */
static void add_shell(struct making *making, double value, double ramp, struct colour colour,
		      double opacity)
{
	add_point(making, value - ramp, colour, 0);
	add_point(making, value, colour, opacity);
	add_point(making, value + ramp, colour, 0);
}

static void make_glass(struct making *making)
{
	double threshold[2];
	gz_histogram_two_thresholds(making->histogram, threshold);
	const double ramp = fmin(at_share(making, 0.05) - making->low,
				 fmax((threshold[1] - threshold[0]) / 2, 0));
	const struct colour blue = { 0.45, 0.72, 0.95 }, amber = { 1.0, 0.72, 0.30 };
	add_point(making, making->low, blue, 0);
	add_shell(making, threshold[0], ramp, blue, per_voxel(making, 0.3, 0.02));
	add_shell(making, threshold[1], ramp, amber, per_voxel(making, 0.8, 0.02));
	add_point(making, making->high, amber, 0);
}

/* Opacity rises from 0 at the background to dense at the end of the range. */
static void make_grey(struct making *making)
{
	const struct colour black = { 0, 0, 0 }, white = { 1, 1, 1 };
	const double begin = background_end(making, true);
	const double grey = (begin - making->low) / fmax(making->high - making->low, 1e-300);
	add_point(making, making->low, black, 0);
	add_point(making, begin, (struct colour) { grey, grey, grey }, 0);
	add_point(making, making->high, white, per_voxel(making, 0.98, 0.06));
}

static void make_heat(struct making *making)
{
	const double begin = background_end(making, true), rest = making->high - begin;
	const double dense = per_voxel(making, 0.98, 0.05);
	add_point(making, making->low, (struct colour) { 0, 0, 0 }, 0);
	add_point(making, begin, (struct colour) { 0.20, 0, 0.02 }, 0);
	add_point(making, begin + 0.3 * rest, (struct colour) { 0.80, 0.10, 0.02 }, 0.1 * dense);
	add_point(making, begin + 0.6 * rest, (struct colour) { 1, 0.60, 0.05 }, 0.35 * dense);
	add_point(making, begin + 0.85 * rest, (struct colour) { 1, 0.92, 0.45 }, 0.75 * dense);
	add_point(making, making->high, (struct colour) { 1, 1, 1 }, dense);
}

static void make_inverse(struct making *making)
{
	const struct colour black = { 0, 0, 0 }, white = { 1, 1, 1 };
	const double end = background_end(making, false);
	const double grey = (making->high - end) / fmax(making->high - making->low, 1e-300);
	add_point(making, making->low, white, per_voxel(making, 0.98, 0.06));
	add_point(making, end, (struct colour) { grey, grey, grey }, 0);
	add_point(making, making->high, black, 0);
}

static void make_xray(struct making *making)
{
	const struct colour white = { 1, 1, 1 };
	add_point(making, making->low, white, 0);
	add_point(making, background_end(making, true), white, 0);
	add_point(making, making->high, white, per_voxel(making, 0.97, 0.8));
}

/* The most frequent value; an end of the range if it lies in the outermost bin. */
static double most_frequent(const struct making *making)
{
	const struct gz_histogram *histogram = making->histogram;
	int mode = 0;
	for (int bin = 1; bin < histogram->bins; bin++)
		mode = histogram->counts[bin] > histogram->counts[mode] ? bin : mode;
	if (mode == 0)
		return making->low;
	return fmin(gz_histogram_bin_value(histogram, mode), making->high);
}

/* A field's most frequent value is its background, which may lie anywhere: how dense a value is
 * grows with the square of the distance from it. */
static void make_field(struct making *making)
{
	const double dense = per_voxel(making, 0.9, 0.1), background = most_frequent(making);
	const double below = background - making->low, above = making->high - background;
	const double most = fmax(fmax(below, above), 1e-300), near = 0.25 * most;
	const struct colour black = { 0, 0, 0 };
	add_point(making, making->low, black, dense * pow(below / most, 2));
	if (below > near)
		add_point(making, background - near, black, dense * pow(near / most, 2));
	add_point(making, background, black, 0);
	if (above > near)
		add_point(making, background + near, black, dense * pow(near / most, 2));
	add_point(making, making->high, black, dense * pow(above / most, 2));
	gz_transfer_colour(making->transfer, GZ_COLOUR_MAP_VIRIDIS);
}

/* Signals of a scanner have no unit: the two thresholds separate air, and bone without signal, from
 * tissue, and tissue from what is brightest. What is dim is a veil, so that a bright scalp does not
 * hide all that is within. */
static void make_mri(struct making *making)
{
	double threshold[2];
	gz_histogram_two_thresholds(making->histogram, threshold);
	const struct colour dark = { 0.30, 0.10, 0.10 }, flesh = { 0.78, 0.46, 0.38 };
	const struct colour pale = { 0.92, 0.80, 0.68 }, white = { 1, 0.97, 0.92 };
	const double begin = background_end(making, true);
	const double middle = (threshold[0] + threshold[1]) / 2;
	add_point(making, making->low, dark, 0);
	add_point(making, begin, dark, 0);
	add_point(making, threshold[0], flesh, per_voxel(making, 0.3, 0.1));
	add_point(making, middle, flesh, per_voxel(making, 0.8, 0.06));
	add_point(making, threshold[1], pale, per_voxel(making, 0.9, 0.04));
	add_point(making, making->high, white, per_voxel(making, 0.97, 0.02));
}

static const struct colour ct_flesh = { 0.82, 0.47, 0.37 }, ct_bone = { 0.93, 0.86, 0.73 },
			   ct_white = { 1, 0.98, 0.94 };

/* Bone from where only little else is as dense. */
static void add_bone(struct making *making, double begin, double end)
{
	const double solid = per_voxel(making, 0.97, 0.02);
	add_point(making, begin, ct_bone, 0);
	add_point(making, end, ct_bone, solid);
	add_point(making, 1200, ct_white, solid);
}

static void make_ct_tissue(struct making *making)
{
	const double veil = per_voxel(making, 0.5, 0.1), solid = per_voxel(making, 0.97, 0.02);
	add_point(making, making->low, ct_flesh, 0);
	add_point(making, -200, ct_flesh, 0);
	add_point(making, -20, ct_flesh, veil);
	add_point(making, 120, ct_flesh, veil);
	add_point(making, 300, ct_bone, solid);
	add_point(making, 1200, ct_white, solid);
}

static void make_ct_bone(struct making *making)
{
	add_point(making, making->low, ct_bone, 0);
	add_bone(making, 180, 350);
}

static void make_ct_vessels(struct making *making)
{
	const struct colour red = { 0.78, 0.16, 0.12 };
	const double solid = per_voxel(making, 0.97, 0.02);
	add_point(making, making->low, red, 0);
	add_point(making, 120, red, 0);
	add_point(making, 220, red, solid);
	add_point(making, 400, red, solid);
	add_point(making, 600, ct_bone, solid);
	add_point(making, 1200, ct_white, solid);
}

static void make_ct_skin(struct making *making)
{
	const struct colour skin = { 0.90, 0.70, 0.58 };
	const double solid = per_voxel(making, 0.99, 0.015);
	add_point(making, making->low, skin, 0);
	add_point(making, -500, skin, 0);
	add_point(making, -250, skin, solid);
	add_point(making, 150, skin, solid);
	add_point(making, 350, ct_bone, solid);
}

static void make_ct_lung(struct making *making)
{
	const struct colour air = { 0.35, 0.55, 0.80 }, wall = { 0.92, 0.60, 0.55 };
	const double veil = per_voxel(making, 0.85, 0.1);
	add_point(making, making->low, air, 0);
	add_point(making, -940, air, 0);
	add_point(making, -800, air, 0.3 * veil);
	add_point(making, -550, wall, veil);
	add_point(making, -350, wall, 0);
	add_point(making, making->high, wall, 0);
}

/* What the values of a volume must be for a look. */
enum values {
	ANY_VALUES,
	HOUNSFIELD, /* units */
	SIGNALS,    /* of magnetic resonance */
};

/* One look. */
static const struct preset {
	struct gz_transfer_preset_text text;
	void (*make)(struct making *making);
	enum values values;
} presets[GZ_PRESET_COUNT] = {
	[GZ_PRESET_TISSUE] = { { "Soft tissue and bone",
				 "soft tissue as a veil, dense tissue solid", true },
			       make_tissue,
			       ANY_VALUES },
	[GZ_PRESET_SURFACE] = { { "Surface", "one surface, where object and background separate",
				  true },
				make_surface,
				ANY_VALUES },
	[GZ_PRESET_GLASS] = { { "Glass", "two translucent surfaces, the inner one amber", true },
			      make_glass,
			      ANY_VALUES },
	[GZ_PRESET_GREY] = { { "Grey ramp", "denser is brighter", false }, make_grey, ANY_VALUES },
	[GZ_PRESET_HEAT] = { { "Heat", "dark red to white, for fields and densities", false },
			     make_heat,
			     ANY_VALUES },
	[GZ_PRESET_INVERSE] = { { "Inverse", "denser is darker, for a bright background", false },
				make_inverse,
				ANY_VALUES },
	[GZ_PRESET_XRAY] = { { "X-ray", "faint: depth adds up, nothing is hidden", false },
			     make_xray,
			     ANY_VALUES },
	[GZ_PRESET_FIELD] = { { "Field", "the most frequent value is clear, viridis", false },
			      make_field,
			      ANY_VALUES },
	[GZ_PRESET_CT_TISSUE] = { { "CT: bone in soft tissue",
				    "bone within a veil of muscle and organs", true },
				  make_ct_tissue,
				  HOUNSFIELD },
	[GZ_PRESET_CT_BONE] = { { "CT: bone", "bone alone, from 180 HU", true },
				make_ct_bone,
				HOUNSFIELD },
	[GZ_PRESET_CT_VESSELS] = { { "CT: vessels", "red: with contrast medium, from 120 HU; bone",
				     true },
				   make_ct_vessels,
				   HOUNSFIELD },
	[GZ_PRESET_CT_SKIN] = { { "CT: skin", "the body's surface, from -500 HU", true },
				make_ct_skin,
				HOUNSFIELD },
	[GZ_PRESET_CT_LUNG] = { { "CT: lung", "lung and airways; soft tissue and bone are clear",
				  false },
				make_ct_lung,
				HOUNSFIELD },
	[GZ_PRESET_MRI] = { { "MRI", "dim tissue as a veil, bright tissue solid", true },
			    make_mri,
			    SIGNALS },
};

const char *const gz_transfer_preset_choices[] = { "auto",    "tissue",    "surface", "glass",
						   "grey",    "heat",      "inverse", "xray",
						   "field",   "ct_tissue", "ct_bone", "ct_vessels",
						   "ct_skin", "ct_lung",   "mri",     NULL };

const struct gz_transfer_preset_text *gz_transfer_preset_text(enum gz_transfer_preset which)
{
	return &presets[which].text;
}

/* Share of the voxels from @p least to @p most, for each unit of the values between. */
static double density_between(const struct gz_histogram *histogram, double least, double most)
{
	double count = 0;
	for (int bin = 0; bin < histogram->bins; bin++) {
		const double value = gz_histogram_bin_value(histogram, bin);
		count += value >= least && value <= most ? (double)histogram->counts[bin] : 0;
	}
	return count / (double)histogram->total / (most - least);
}

bool gz_histogram_is_hounsfield(const struct gz_histogram *histogram)
{
	/* Scanners pad with -2000 or -3024, and metal reaches 3071 or, extended, 32767. Chosen: the
	 * shares; lungs are between air and water, but never as much as the air around a body. */
	static const double padding = -3100, metal = 33000, several = 3, tissue_least = 0.02;
	if (histogram->total == 0 || histogram->data_min < padding || histogram->data_min > -900 ||
	    histogram->data_max < 200 || histogram->data_max > metal)
		return false;
	const double air = density_between(histogram, -1100, -850);
	const double between = density_between(histogram, -850, -250);
	const double tissue = density_between(histogram, -150, 150);
	return air > several * between && tissue > several * between && tissue * 300 > tissue_least;
}

/* Files of CT have Hounsfield units (PS3.3, C.8.2.1.1.1), if they were rescaled to them: then the
 * fat of any body is below -50, and air far below. */
static bool is_rescaled(const struct gz_histogram *histogram)
{
	return histogram->total > 0 && histogram->data_min <= -50 && histogram->data_min > -33000 &&
	       histogram->data_max < 33000;
}

/* Whether values are Hounsfield units, by what made them and what they are. */
static bool are_hounsfield(const struct gz_histogram *histogram, enum gz_modality modality)
{
	return modality == GZ_MODALITY_CT
		       ? is_rescaled(histogram)
		       : modality == GZ_MODALITY_UNKNOWN && gz_histogram_is_hounsfield(histogram);
}

bool gz_transfer_preset_fits(enum gz_transfer_preset which, const struct gz_histogram *histogram,
			     enum gz_modality modality)
{
	switch (presets[which].values) {
	case HOUNSFIELD:
		return are_hounsfield(histogram, modality);
	case SIGNALS:
		return modality == GZ_MODALITY_MR ||
		       (modality == GZ_MODALITY_UNKNOWN && !gz_histogram_is_hounsfield(histogram));
	case ANY_VALUES:
		break;
	}
	return true;
}

/* The most frequent values, as a share of the range without the outermost thousandths, and the
 * share of the voxels around it. Around it is a sixteenth of that range (chosen: the noise of a
 * scan). */
static double find_ground(const struct gz_histogram *histogram, double *out_share)
{
	const double low = gz_histogram_percentile(histogram, 0.001);
	const double high = gz_histogram_percentile(histogram, 0.999);
	const double width = (high - low) / 16;
	double best = 0, at = 0;
	*out_share = 0;
	if (histogram->total == 0 || !(width > 0))
		return 0;
	for (int step = 0; step <= 60; step++) {
		const double from = low + step * width / 4;
		const double share = density_between(histogram, from, from + width) * width;
		if (share > best) {
			best = share;
			at = (step + 2) / 64.0;
		}
	}
	*out_share = best;
	return at;
}

enum gz_transfer_preset gz_transfer_preset_for(const struct gz_histogram *histogram,
					       enum gz_modality modality)
{
	/* Chosen: a ground fills a quarter of a scan's box and more, and is darker than all else,
	 * or brighter. What oscillates around a value in the middle is a field. */
	static const double ground_share = 0.25, field_share = 0.1;
	double share;
	if (are_hounsfield(histogram, modality))
		return GZ_PRESET_CT_TISSUE;
	const double at = find_ground(histogram, &share);
	if (at > 0.9 && share > ground_share)
		return GZ_PRESET_INVERSE;
	if (at > 0.3 && at < 0.7 && share > field_share)
		return GZ_PRESET_FIELD;
	return modality == GZ_MODALITY_MR ? GZ_PRESET_MRI : GZ_PRESET_TISSUE;
}

void gz_transfer_preset_make(enum gz_transfer_preset which, const struct gz_histogram *histogram,
			     const struct gz_volume *volume, struct gz_transfer *out_transfer)
{
	*out_transfer = (struct gz_transfer) { .interpolation = GZ_TRANSFER_LINEAR };
	struct making making = {
		.histogram = histogram,
		.edge = gz_volume_edge_lengths(volume->dims, volume->spacing),
		.low = histogram->data_min,
		.high = histogram->data_max,
		.transfer = out_transfer,
	};
	const double top = gz_histogram_percentile(histogram, 0.9999);
	if (top - making.low < (making.high - making.low) / 2 && top > making.low)
		making.high = top;
	if (presets[which].values == HOUNSFIELD)
		making.low = fmax(making.low, -1024);
	presets[which].make(&making);
	out_transfer->has_range = making.high > making.low;
	out_transfer->range[0] = making.low;
	out_transfer->range[1] = making.high;
}
