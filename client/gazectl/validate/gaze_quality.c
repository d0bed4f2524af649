#include "client/gazectl/validate/gaze_quality.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/order.h"
#include "filter/angle.h"

/* Share of the samples inside the ellipse of the BCEA. */
static const double BCEA_SHARE = 0.68;

/* Two samples farther apart than this have at least one missing between them. */
static const double GAP_PERIODS = 1.5;

static const double PI = 3.14159265358979323846;

const char *gz_trace_name(enum gz_trace trace)
{
	static const char *const names[GZ_TRACE_COUNT] = { "right", "left", "both" };
	return trace >= 0 && trace < GZ_TRACE_COUNT ? names[trace] : "unknown";
}

static bool is_finite_point(struct gz_point point)
{
	return isfinite(point.x) && isfinite(point.y);
}

static double dot3(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

void gz_quality_offset_deg(const struct gz_display *display, struct gz_point target,
			   struct gz_point point, double out_deg[2])
{
	double t[3], p[3];
	gz_display_to_mm(display, target, t);
	gz_display_to_mm(display, point, p);
	/* Axes across the line of sight: right is horizontal, down is perpendicular to both. */
	double length = gz_length3(t), level = sqrt(t[0] * t[0] + t[2] * t[2]);
	const double right[3] = { t[2] / level, 0, -t[0] / level };
	const double down[3] = { -t[1] * t[0] / (level * length), level / length,
				 -t[1] * t[2] / (level * length) };
	double x = dot3(p, right), y = dot3(p, down), across = sqrt(x * x + y * y);
	double angle_deg = gz_display_angle_deg(display, target, point);
	out_deg[0] = across > 0 ? angle_deg * x / across : 0;
	out_deg[1] = across > 0 ? angle_deg * y / across : 0;
}

/* Number of samples missing between @p from_ns and @p to_ns. */
static uint64_t missing_between(int64_t from_ns, int64_t to_ns, int64_t period_ns)
{
	double periods = (double)(to_ns - from_ns) / (double)period_ns;
	return periods > GAP_PERIODS ? (uint64_t)floor(periods - 0.5) : 0;
}

/* Number of samples missing before the first and after the last one: those that would lie a whole
 * number of periods away and still within the time. */
static uint64_t missing_at_ends(const struct gz_quality_input *input)
{
	double period_ns = (double)input->period_ns;
	double whole_ns = (double)(input->end_ns - input->begin_ns);
	if (input->count == 0)
		return (uint64_t)floor(whole_ns / period_ns + 0.5);
	double before_ns = (double)(input->samples[0].host_ns - input->begin_ns);
	double after_ns = (double)(input->end_ns - input->samples[input->count - 1].host_ns);
	return (uint64_t)fmax(0, floor(before_ns / period_ns)) +
	       (uint64_t)fmax(0, ceil(after_ns / period_ns) - 1);
}

static uint64_t count_missing(const struct gz_quality_input *input)
{
	if (input->period_ns <= 0 || input->end_ns <= input->begin_ns)
		return 0;
	uint64_t missing = missing_at_ends(input);
	for (size_t i = 1; i < input->count; i++)
		missing += missing_between(input->samples[i - 1].host_ns, input->samples[i].host_ns,
					   input->period_ns);
	return missing;
}

/* Sums over the samples used: points, offsets from the target, squares and products of offsets,
 * angles; and squares of the steps between successive samples. */
struct sums {
	double n, point[2], offset[2], square[2], product, angle;
	double steps, step_square;
};

static void add_target_point(const struct gz_quality_input *input, struct gz_point point,
			     struct sums *sums)
{
	double offset[2];
	gz_quality_offset_deg(input->display, input->target, point, offset);
	sums->n++;
	sums->point[0] += point.x;
	sums->point[1] += point.y;
	for (int i = 0; i < 2; i++) {
		sums->offset[i] += offset[i];
		sums->square[i] += offset[i] * offset[i];
	}
	sums->product += offset[0] * offset[1];
	sums->angle += sqrt(offset[0] * offset[0] + offset[1] * offset[1]);
}

static void add_step(const struct gz_quality_input *input, struct gz_point from, struct gz_point to,
		     struct sums *sums)
{
	double deg = gz_display_angle_deg(input->display, from, to);
	sums->steps++;
	sums->step_square += deg * deg;
}

static bool are_successive(const struct gz_quality_input *input, const struct gz_quality_sample *a,
			   const struct gz_quality_sample *b)
{
	return input->period_ns <= 0 ||
	       (double)(b->host_ns - a->host_ns) <= GAP_PERIODS * (double)input->period_ns;
}

static void add_samples(const struct gz_quality_input *input, enum gz_trace trace,
			struct sums *sums, struct gz_quality *quality)
{
	const struct gz_quality_sample *last = NULL;
	for (size_t i = 0; i < input->count; i++) {
		const struct gz_quality_sample *sample = &input->samples[i];
		bool there = is_finite_point(sample->point[trace]);
		quality->measured += there;
		if (!there || !sample->fixating) {
			last = NULL;
			continue;
		}
		add_target_point(input, sample->point[trace], sums);
		if (last && are_successive(input, last, sample))
			add_step(input, last->point[trace], sample->point[trace], sums);
		last = sample;
	}
}

static void measure_spread(const struct sums *sums, struct gz_quality *quality)
{
	double variance[2];
	for (int i = 0; i < 2; i++) {
		double mean = sums->offset[i] / sums->n;
		/* Rounding may leave a value slightly below 0. */
		variance[i] = fmax(0, (sums->square[i] - sums->n * mean * mean) / (sums->n - 1));
		quality->sd_axis_deg[i] = sqrt(variance[i]);
	}
	double covariance =
		(sums->product - sums->offset[0] * sums->offset[1] / sums->n) / (sums->n - 1);
	quality->sd_deg = sqrt(variance[0] + variance[1]);
	/* sd_x sd_y sqrt(1 - rho^2), without dividing by a spread that may be 0. */
	double area = sqrt(fmax(0, variance[0] * variance[1] - covariance * covariance));
	quality->bcea_deg2 = -2 * log(1 - BCEA_SHARE) * PI * area;
}

void gz_quality_measure(const struct gz_quality_input *input, enum gz_trace trace,
			struct gz_quality *out_quality)
{
	struct sums sums = { 0 };
	struct gz_quality quality = {
		.mean = { NAN, NAN },
		.loss = NAN,
		.accuracy_deg = NAN,
		.offset_deg = { NAN, NAN },
		.rms_s2s_deg = NAN,
		.sd_deg = NAN,
		.sd_axis_deg = { NAN, NAN },
		.bcea_deg2 = NAN,
	};
	add_samples(input, trace, &sums, &quality);
	quality.expected = input->count + count_missing(input);
	quality.used = (uint64_t)sums.n;
	if (quality.expected > 0)
		quality.loss = 1 - (double)quality.measured / (double)quality.expected;
	if (sums.n > 0) {
		quality.mean = (struct gz_point) { (float)(sums.point[0] / sums.n),
						   (float)(sums.point[1] / sums.n) };
		quality.accuracy_deg = sums.angle / sums.n;
		for (int i = 0; i < 2; i++)
			quality.offset_deg[i] = sums.offset[i] / sums.n;
	}
	if (sums.steps > 0)
		quality.rms_s2s_deg = sqrt(sums.step_square / sums.steps);
	if (sums.n > 1)
		measure_spread(&sums, &quality);
	*out_quality = quality;
}

/* Sums for the mean and the deviation of finite values. */
struct mean {
	double sum, square, count;
};

static void add_to_mean(struct mean *mean, double value)
{
	if (!isfinite(value))
		return;
	mean->sum += value;
	mean->square += value * value;
	mean->count++;
}

static double mean_value(const struct mean *mean)
{
	return mean->count > 0 ? mean->sum / mean->count : NAN;
}

static double mean_deviation(const struct mean *mean)
{
	if (mean->count < 2)
		return NAN;
	double square = mean->square - mean->sum * mean->sum / mean->count;
	return sqrt(fmax(0, square) / (mean->count - 1));
}

void gz_quality_summarise(const struct gz_quality *targets, size_t count,
			  struct gz_quality_summary *out_summary)
{
	struct gz_quality_summary summary = { .loss = NAN, .worst_deg = NAN };
	struct mean accuracy = { 0 }, right = { 0 }, down = { 0 };
	struct mean rms = { 0 }, sd = { 0 }, bcea = { 0 };
	for (size_t i = 0; i < count; i++) {
		const struct gz_quality *target = &targets[i];
		summary.expected += target->expected;
		summary.measured += target->measured;
		summary.used += target->used;
		summary.targets += target->used > 0;
		summary.worst_deg = fmax(summary.worst_deg, target->accuracy_deg);
		add_to_mean(&accuracy, target->accuracy_deg);
		add_to_mean(&right, target->offset_deg[0]);
		add_to_mean(&down, target->offset_deg[1]);
		add_to_mean(&rms, target->rms_s2s_deg);
		add_to_mean(&sd, target->sd_deg);
		add_to_mean(&bcea, target->bcea_deg2);
	}
	if (summary.expected > 0)
		summary.loss = 1 - (double)summary.measured / (double)summary.expected;
	summary.accuracy_deg = mean_value(&accuracy);
	summary.accuracy_sd_deg = mean_deviation(&accuracy);
	summary.offset_deg[0] = mean_value(&right);
	summary.offset_deg[1] = mean_value(&down);
	summary.rms_s2s_deg = mean_value(&rms);
	summary.sd_deg = mean_value(&sd);
	summary.bcea_deg2 = mean_value(&bcea);
	*out_summary = summary;
}

int64_t gz_quality_period_ns(const struct gz_quality_sample *samples, size_t count)
{
	if (count < 2)
		return 0;
	int64_t *steps_ns = calloc(count - 1, sizeof *steps_ns);
	if (!steps_ns)
		return -1;
	for (size_t i = 0; i + 1 < count; i++)
		steps_ns[i] = samples[i + 1].host_ns - samples[i].host_ns;
	qsort(steps_ns, count - 1, sizeof *steps_ns, gz_compare_int64s);
	int64_t period_ns = steps_ns[(count - 1) / 2];
	free(steps_ns);
	return period_ns;
}

/* How many samples back a final label may reach. It comes at most 10 ms late, which is 20 samples
 * at 2000 Hz; chosen well above that. */
enum { LABEL_REACH = 200 };

/* Samples that fit at first. Chosen: 16 s at 500 Hz. */
enum { ROOM_FIRST = 8192 };

static enum gz_result grow_trace(struct gz_gaze_trace *trace)
{
	if (trace->count < trace->room)
		return GZ_OK;
	if (trace->count >= GZ_GAZE_TRACE_MAX)
		return GZ_ERR_FULL;
	size_t room = trace->room ? 2 * trace->room : ROOM_FIRST;
	struct gz_gaze_trace_sample *items = realloc(trace->items, room * sizeof *items);
	if (!items)
		return GZ_ERR_NO_MEM;
	trace->items = items;
	trace->room = room;
	return GZ_OK;
}

static void apply_label(struct gz_gaze_trace *trace, uint64_t first, uint64_t last,
			enum gz_event event)
{
	size_t reach = trace->count < LABEL_REACH ? trace->count : LABEL_REACH;
	for (size_t i = 1; i <= reach; i++) {
		struct gz_gaze_trace_sample *item = &trace->items[trace->count - i];
		if (item->sample.seq < first)
			return;
		if (item->sample.seq > last)
			continue;
		item->event = event;
		item->sample.fixating = event == GZ_EVENT_FIXATION;
	}
}

enum gz_result gz_gaze_trace_add(struct gz_gaze_trace *trace, const struct gz_gaze *gaze)
{
	enum gz_result result = grow_trace(trace);
	if (result != GZ_OK)
		return result;
	if (trace->count == 0 || gaze->host_ns > trace->items[trace->count - 1].sample.host_ns) {
		struct gz_gaze_trace_sample *item = &trace->items[trace->count++];
		*item = (struct gz_gaze_trace_sample) { .event = gaze->event };
		item->sample.host_ns = gaze->host_ns;
		item->sample.seq = gaze->seq;
		item->sample.fixating = gaze->event == GZ_EVENT_FIXATION;
		item->sample.point[GZ_TRACE_BOTH] = gaze->raw;
		for (int i = 0; i < GZ_EYE_COUNT; i++)
			item->sample.point[i] = gaze->eye[i].valid ? gaze->eye[i].point
								   : (struct gz_point) { NAN, NAN };
	}
	if (gaze->final_known)
		apply_label(trace, gaze->final_seq - gaze->final_span, gaze->final_seq,
			    gaze->final_event);
	return GZ_OK;
}

size_t gz_gaze_trace_find(const struct gz_gaze_trace *trace, int64_t host_ns)
{
	size_t low = 0, high = trace->count;
	while (low < high) {
		size_t middle = low + (high - low) / 2;
		if (trace->items[middle].sample.host_ns < host_ns)
			low = middle + 1;
		else
			high = middle;
	}
	return low;
}

void gz_gaze_trace_clear(struct gz_gaze_trace *trace)
{
	free(trace->items);
	*trace = (struct gz_gaze_trace) { 0 };
}
