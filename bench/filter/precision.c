#include "bench/filter/precision.h"

#include <math.h>
#include <stdlib.h>

#include "base/order.h"
#include "bench/filter/stillness.h"

static const double DEG_PER_RAD = 57.295779513082320877;

/* Fewest samples of a window: a line leaves two fewer to measure. */
enum { WINDOW_LEAST = 5 };

/* Share of a saccade's way at which its onset is measured. */
static const double ONSET_SHARE = 0.2;

/* Shortest pursuit whose lag is measured, and over how long its speed is taken, ms. Chosen: long
 * enough that noise has little effect, short enough to turn with the target. */
static const double PURSUIT_LEAST_MS = 120, PURSUIT_SPEED_MS = 80;

/* Numbers whose median is needed. */
struct numbers {
	double *value;
	size_t count, room;
};

static bool add_number(struct numbers *numbers, double value)
{
	if (numbers->count == numbers->room) {
		const size_t room = numbers->room ? 2 * numbers->room : 1024;
		double *grown = realloc(numbers->value, room * sizeof *grown);
		if (!grown)
			return false;
		numbers->value = grown;
		numbers->room = room;
	}
	numbers->value[numbers->count++] = value;
	return true;
}

static double number_at_share(struct numbers *numbers, double share)
{
	if (numbers->count == 0)
		return NAN;
	qsort(numbers->value, numbers->count, sizeof numbers->value[0], gz_compare_doubles);
	return numbers->value[(size_t)(share * (double)(numbers->count - 1))];
}

static bool measured_at(const struct gz_gaze_track *track, size_t i)
{
	return isfinite(track->raw[i].x) && isfinite(track->raw[i].y);
}

static const struct gz_point *signal_of(const struct gz_gaze_track *track, bool raw)
{
	return raw ? track->raw : track->point;
}

/* ---- precision ---- */

/* Sums over windows. */
struct window_sums {
	double step2, steps, spread2, places;
	struct numbers step_deg, spread_deg;
};

/* Sum of the squared distances from the best line over time, both axes, square degrees. Sample
 * @p begin is measured. */
static double about_line_deg2(const struct gz_gaze_track *track, const struct gz_point *path,
			      size_t begin, size_t end)
{
	const double *mm = track->display.mm;
	const double scale = DEG_PER_RAD / track->display.distance_mm;
	double count = 0, t1 = 0, t2 = 0, place1[2] = { 0, 0 }, place2[2] = { 0, 0 };
	double both[2] = { 0, 0 };
	for (size_t i = begin; i < end; i++) {
		if (!measured_at(track, i))
			continue;
		const double t = gz_gaze_track_elapsed_ms(track, begin, i);
		const double deg[2] = { ((double)path[i].x - path[begin].x) * mm[0] * scale,
					((double)path[i].y - path[begin].y) * mm[1] * scale };
		count++;
		t1 += t;
		t2 += t * t;
		for (int axis = 0; axis < 2; axis++) {
			place1[axis] += deg[axis];
			place2[axis] += deg[axis] * deg[axis];
			both[axis] += t * deg[axis];
		}
	}
	double sum = 0;
	for (int axis = 0; axis < 2; axis++) {
		const double slope_sum = both[axis] - t1 * place1[axis] / count;
		sum += place2[axis] - place1[axis] * place1[axis] / count -
		       slope_sum * slope_sum / (t2 - t1 * t1 / count);
	}
	return fmax(0, sum);
}

static bool add_window(const struct gz_gaze_track *track, const struct gz_point *path, size_t begin,
		       size_t end, struct window_sums *sums)
{
	double step2 = 0, steps = 0, places = 0;
	while (begin < end && !measured_at(track, begin))
		begin++;
	for (size_t i = begin; i < end; i++) {
		if (!measured_at(track, i))
			continue;
		places++;
		if (i == begin || !measured_at(track, i - 1))
			continue;
		const double deg = gz_display_angle_deg(&track->display, path[i], path[i - 1]);
		step2 += deg * deg;
		steps++;
	}
	if (places < WINDOW_LEAST || steps == 0)
		return true;
	const double spread2 = about_line_deg2(track, path, begin, end);
	sums->step2 += step2;
	sums->steps += steps;
	sums->spread2 += spread2;
	sums->places += places - 2; /* which the line takes up */
	return add_number(&sums->step_deg, sqrt(step2 / steps)) &&
	       add_number(&sums->spread_deg, sqrt(spread2 / (places - 2)));
}

/* Cut samples @p begin to @p end into windows. Neighbours share a sample, so that each step counts.
 */
static bool add_windows(const struct gz_gaze_track *track, const struct gz_point *path,
			size_t begin, size_t end, struct window_sums *sums)
{
	const double length_ms = gz_gaze_track_elapsed_ms(track, begin, end - 1);
	const size_t windows = (size_t)fmax(1, round(length_ms / GZ_PRECISION_WINDOW_MS));
	const size_t steps = end - 1 - begin;
	for (size_t k = 0; k < windows; k++)
		if (!add_window(track, path, begin + k * steps / windows,
				begin + (k + 1) * steps / windows + 1, sums))
			return false;
	return true;
}

static bool add_precision(const struct gz_gaze_track *track, bool raw, enum gz_precision_part part,
			  struct window_sums *sums)
{
	const bool inner = part == GZ_PRECISION_INNER;
	for (size_t begin = 0, end; begin < track->count; begin = end) {
		end = gz_gaze_stretch_end(track, begin);
		if (track->label[begin] != GZ_EVENT_FIXATION)
			continue;
		size_t from = begin, to = end;
		while (inner && from < end &&
		       gz_gaze_track_elapsed_ms(track, begin, from) < GZ_PRECISION_LANDING_MS)
			from++;
		while (inner && to > from &&
		       gz_gaze_track_elapsed_ms(track, to - 1, end - 1) < GZ_PRECISION_LEAVING_MS)
			to--;
		while (from < to && !measured_at(track, from))
			from++;
		if (from < to && !add_windows(track, signal_of(track, raw), from, to, sums))
			return false;
	}
	return true;
}

bool gz_precision_of(const struct gz_gaze_track *tracks, size_t count, bool raw,
		     enum gz_precision_part part, struct gz_precision *out)
{
	struct window_sums sums = { .steps = 0 };
	bool added = true;
	for (size_t i = 0; i < count && added; i++)
		added = add_precision(&tracks[i], raw, part, &sums);
	if (added)
		*out = (struct gz_precision) {
			.windows = sums.step_deg.count,
			.step_deg = sqrt(sums.step2 / sums.steps),
			.spread_deg = sqrt(sums.spread2 / sums.places),
			.step_median_deg = number_at_share(&sums.step_deg, 0.5),
			.spread_median_deg = number_at_share(&sums.spread_deg, 0.5),
		};
	free(sums.step_deg.value);
	free(sums.spread_deg.value);
	return added;
}

/* ---- lags ---- */

/* Sums over pursuits: of the products of speed and distance from the raw signal, and of squared
 * speeds. */
struct pursuit_sums {
	double product, speed2;
};

static void add_pursuit_sample(const struct gz_gaze_track *track, size_t before, size_t i,
			       size_t after, struct pursuit_sums *sums)
{
	const double *mm = track->display.mm;
	const double step_ms = gz_gaze_track_elapsed_ms(track, before, after);
	const struct gz_point *raw = track->raw, *point = track->point;
	const double speed[2] = { ((double)raw[after].x - raw[before].x) * mm[0] / step_ms,
				  ((double)raw[after].y - raw[before].y) * mm[1] / step_ms };
	const double behind[2] = { ((double)raw[i].x - point[i].x) * mm[0],
				   ((double)raw[i].y - point[i].y) * mm[1] };
	sums->product += behind[0] * speed[0] + behind[1] * speed[1];
	sums->speed2 += speed[0] * speed[0] + speed[1] * speed[1];
}

static void add_pursuit(const struct gz_gaze_track *track, size_t begin, size_t end,
			struct pursuit_sums *sums)
{
	if (gz_gaze_track_elapsed_ms(track, begin, end - 1) < PURSUIT_LEAST_MS)
		return;
	size_t before = begin, after = begin;
	for (size_t i = begin; i < end; i++) {
		while (gz_gaze_track_elapsed_ms(track, before, i) > PURSUIT_SPEED_MS / 2)
			before++;
		while (after < end &&
		       gz_gaze_track_elapsed_ms(track, i, after) < PURSUIT_SPEED_MS / 2)
			after++;
		const bool inside = after < end && gz_gaze_track_elapsed_ms(track, begin, i) >=
							   PURSUIT_SPEED_MS / 2;
		if (inside && measured_at(track, before) && measured_at(track, i) &&
		    measured_at(track, after))
			add_pursuit_sample(track, before, i, after, sums);
	}
}

/* How far the point goes beyond the raw signal's farthest place along a saccade, degrees. Where it
 * has done less than half of the way it is still at the place of the last fixation. */
static double overshoot_of(const struct gz_gaze_track *track, const struct gz_saccade_way *way)
{
	double farthest_deg = 0, most_deg = 0;
	bool goes = false;
	for (size_t i = way->begin; i < way->late && measured_at(track, i); i++) {
		const double deg = gz_saccade_along_deg(track, way, track->point[i]);
		goes = goes || deg > way->deg / 2;
		farthest_deg = fmax(farthest_deg, gz_saccade_along_deg(track, way, track->raw[i]));
		most_deg = fmax(most_deg, goes ? deg - farthest_deg : 0);
	}
	return most_deg;
}

static bool add_lags(const struct gz_gaze_track *track, struct numbers *onsets,
		     struct pursuit_sums *pursuits, double *overshoot_deg)
{
	const double interval_ms = gz_gaze_track_interval_ms(track);
	for (size_t begin = 0, end; begin < track->count; begin = end) {
		end = gz_gaze_stretch_end(track, begin);
		struct gz_saccade_way way;
		if (track->label[begin] == GZ_EVENT_PURSUIT)
			add_pursuit(track, begin, end, pursuits);
		if (!gz_saccade_way_of(track, begin, end, &way))
			continue;
		const double late_ms =
			gz_saccade_crossing_ms(track, track->point, &way, ONSET_SHARE) -
			gz_saccade_crossing_ms(track, track->raw, &way, ONSET_SHARE);
		*overshoot_deg = fmax(*overshoot_deg, overshoot_of(track, &way));
		if (!add_number(onsets, late_ms / interval_ms))
			return false;
	}
	return true;
}

bool gz_lags_of(const struct gz_gaze_track *tracks, size_t count, struct gz_lags *out)
{
	struct numbers onsets = { .count = 0 };
	struct pursuit_sums pursuits = { .speed2 = 0 };
	double overshoot_deg = 0, sum = 0;
	bool added = true;
	for (size_t i = 0; i < count && added; i++)
		added = add_lags(&tracks[i], &onsets, &pursuits, &overshoot_deg);
	for (size_t i = 0; i < onsets.count; i++)
		sum += onsets.value[i];
	if (added)
		*out = (struct gz_lags) {
			.saccades = onsets.count,
			.onset_median = number_at_share(&onsets, 0.5),
			.onset_mean = onsets.count > 0 ? sum / (double)onsets.count : NAN,
			.onset_90 = number_at_share(&onsets, 0.9),
			.overshoot_deg = overshoot_deg,
			.pursuit_ms =
				pursuits.speed2 > 0 ? pursuits.product / pursuits.speed2 : NAN,
		};
	free(onsets.value);
	return added;
}
