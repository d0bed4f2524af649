#include "client/gazectl/validate/correction_fit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const struct gz_correct_params IDENTITY = { { 0, 1, 0 }, { 0, 0, 1 } };

const char *gz_fit_model_name(enum gz_fit_model model)
{
	static const char *const names[] = { "none", "shift", "affine" };
	return model >= GZ_FIT_NONE && model <= GZ_FIT_AFFINE ? names[model] : "unknown";
}

/* What a fit is made from. */
struct work {
	const struct gz_display *display;
	const struct gz_fit_pair *pairs;
	size_t count;
	const bool *used;
};

/* Sums over the pairs used, but for one: means, and second moments about them. */
struct moments {
	double n, seen[2], target[2];
	double xx, xy, yy;       /* of the seen places */
	double across[2], up[2]; /* of seen x, seen y with each axis of the target */
};

static bool takes_part(const struct work *work, size_t i, size_t without)
{
	return work->used[i] && i != without;
}

static void find_means(const struct work *work, size_t without, struct moments *m)
{
	*m = (struct moments) { 0 };
	for (size_t i = 0; i < work->count; i++) {
		if (!takes_part(work, i, without))
			continue;
		m->n++;
		m->seen[0] += work->pairs[i].seen.x;
		m->seen[1] += work->pairs[i].seen.y;
		m->target[0] += work->pairs[i].target.x;
		m->target[1] += work->pairs[i].target.y;
	}
	for (int axis = 0; axis < 2 && m->n > 0; axis++) {
		m->seen[axis] /= m->n;
		m->target[axis] /= m->n;
	}
}

static void find_moments(const struct work *work, size_t without, struct moments *m)
{
	find_means(work, without, m);
	for (size_t i = 0; i < work->count; i++) {
		if (!takes_part(work, i, without))
			continue;
		const struct gz_fit_pair *pair = &work->pairs[i];
		double x = pair->seen.x - m->seen[0], y = pair->seen.y - m->seen[1];
		double t[2] = { pair->target.x - m->target[0], pair->target.y - m->target[1] };
		m->xx += x * x;
		m->xy += x * y;
		m->yy += y * y;
		for (int axis = 0; axis < 2; axis++) {
			m->across[axis] += x * t[axis];
			m->up[axis] += y * t[axis];
		}
	}
}

/* Whether the seen places spread far enough in every direction: the smaller eigenvalue of their
 * covariance is their variance in the direction where it is least. */
static bool spreads(const struct moments *m)
{
	double half_trace = (m->xx + m->yy) / 2, half_difference = (m->xx - m->yy) / 2;
	double least = half_trace - sqrt(half_difference * half_difference + m->xy * m->xy);
	return least / m->n >= GZ_FIT_SPREAD_MIN * GZ_FIT_SPREAD_MIN;
}

/* Fit @p model over all that is used but pair @p without. */
static bool fit_model(const struct work *work, enum gz_fit_model model, size_t without,
		      struct gz_correct_params *out_map)
{
	struct moments m;
	double *const lines[2] = { out_map->x, out_map->y };
	find_moments(work, without, &m);
	if (m.n < 1 || (model == GZ_FIT_AFFINE && (m.n < 3 || !spreads(&m))))
		return false;
	*out_map = IDENTITY;
	double area = m.xx * m.yy - m.xy * m.xy;
	for (int axis = 0; axis < 2; axis++) {
		double *line = lines[axis];
		if (model == GZ_FIT_AFFINE) {
			line[1] = (m.across[axis] * m.yy - m.up[axis] * m.xy) / area;
			line[2] = (m.up[axis] * m.xx - m.across[axis] * m.xy) / area;
		}
		line[0] = m.target[axis] - line[1] * m.seen[0] - line[2] * m.seen[1];
	}
	return true;
}

static double error_deg(const struct work *work, size_t i, const struct gz_correct_params *map)
{
	return gz_display_angle_deg(work->display, work->pairs[i].target,
				    gz_correct_point(map, work->pairs[i].seen));
}

/* Mean error of the pairs used, under one map. */
static double mean_error_deg(const struct work *work, const struct gz_correct_params *map)
{
	double sum = 0, n = 0;
	for (size_t i = 0; i < work->count; i++) {
		if (!work->used[i])
			continue;
		sum += error_deg(work, i, map);
		n++;
	}
	return n > 0 ? sum / n : NAN;
}

/* Each used pair's error under a fit over the others; NaN for pairs that are not used.
 * @return their mean, NaN where the model cannot be fitted without one of them */
static double cross_errors(const struct work *work, enum gz_fit_model model, double *out_deg)
{
	double sum = 0, n = 0;
	for (size_t i = 0; i < work->count; i++)
		out_deg[i] = NAN;
	for (size_t i = 0; i < work->count; i++) {
		struct gz_correct_params map;
		if (!work->used[i])
			continue;
		if (!fit_model(work, model, i, &map))
			return NAN;
		out_deg[i] = error_deg(work, i, &map);
		sum += out_deg[i];
		n++;
	}
	return n > 0 ? sum / n : NAN;
}

static size_t used_count(const struct work *work)
{
	size_t n = 0;
	for (size_t i = 0; i < work->count; i++)
		n += work->used[i];
	return n;
}

/* The affine map if there is enough for it. */
static enum gz_fit_model richest_model(const struct work *work)
{
	double deg[GZ_FIT_TARGETS_MAX];
	size_t n = used_count(work);
	if (n >= GZ_FIT_AFFINE_TARGETS && isfinite(cross_errors(work, GZ_FIT_AFFINE, deg)))
		return GZ_FIT_AFFINE;
	return n >= GZ_FIT_SHIFT_TARGETS ? GZ_FIT_SHIFT : GZ_FIT_NONE;
}

static int compare_doubles(const void *a, const void *b)
{
	double x, y;
	memcpy(&x, a, sizeof x);
	memcpy(&y, b, sizeof y);
	return (x > y) - (x < y);
}

static double median_of(const double *deg, size_t count)
{
	double sorted[GZ_FIT_TARGETS_MAX] = { 0 };
	size_t n = 0;
	for (size_t i = 0; i < count; i++)
		if (isfinite(deg[i]))
			sorted[n++] = deg[i];
	qsort(sorted, n, sizeof *sorted, compare_doubles);
	return n > 0 ? sorted[n / 2] : NAN;
}

/* Leave out the worst pair if it is none of the others' kind. */
static bool leave_worst_out(const struct work *work, enum gz_fit_model model, bool *used)
{
	double deg[GZ_FIT_TARGETS_MAX] = { 0 };
	if (!isfinite(cross_errors(work, model, deg)))
		return false;
	size_t worst = work->count;
	for (size_t i = 0; i < work->count; i++)
		if (used[i] && (worst == work->count || deg[i] > deg[worst]))
			worst = i;
	if (worst == work->count || deg[worst] <= GZ_FIT_OUTLIER_DEG ||
	    deg[worst] <= GZ_FIT_OUTLIER_FACTOR * median_of(deg, work->count))
		return false;
	used[worst] = false;
	return true;
}

static void choose_model(const struct work *work, struct gz_fit *fit)
{
	double deg[GZ_FIT_TARGETS_MAX];
	fit->model = richest_model(work);
	if (fit->model == GZ_FIT_NONE)
		return;
	fit->cross_deg = cross_errors(work, fit->model, deg);
	if (fit->model == GZ_FIT_AFFINE) {
		double shift_deg = cross_errors(work, GZ_FIT_SHIFT, deg);
		if (shift_deg <= fit->cross_deg) {
			fit->model = GZ_FIT_SHIFT;
			fit->cross_deg = shift_deg;
		}
	}
	(void)fit_model(work, fit->model, work->count, &fit->map); /* it could without one, too */
}

static bool is_pair(const struct gz_fit_pair *pair)
{
	return isfinite(pair->target.x) && isfinite(pair->target.y) && isfinite(pair->seen.x) &&
	       isfinite(pair->seen.y);
}

void gz_fit_correction(const struct gz_display *display, const struct gz_fit_pair *pairs,
		       size_t count, struct gz_fit *out_fit)
{
	struct gz_fit fit = { .map = IDENTITY, .cross_deg = NAN };
	struct work work = { display, pairs,
			     count < GZ_FIT_TARGETS_MAX ? count : GZ_FIT_TARGETS_MAX, fit.used };
	for (size_t i = 0; i < work.count; i++)
		fit.used[i] = is_pair(&pairs[i]);
	size_t may_leave = used_count(&work) / 4;
	while (may_leave-- > 0 && leave_worst_out(&work, richest_model(&work), fit.used))
		;
	choose_model(&work, &fit);
	fit.used_count = used_count(&work);
	fit.before_deg = mean_error_deg(&work, &IDENTITY);
	fit.after_deg = mean_error_deg(&work, &fit.map);
	fit.helps = fit.model != GZ_FIT_NONE && gz_correct_usable(&fit.map) &&
		    fit.before_deg - fit.cross_deg >=
			    fmax(GZ_FIT_GAIN_DEG, GZ_FIT_GAIN_SHARE * fit.before_deg);
	*out_fit = fit;
}

struct gz_correct_params gz_fit_compose(const struct gz_correct_params *first,
					const struct gz_correct_params *second)
{
	struct gz_correct_params both = IDENTITY;
	const double *const lines[2] = { second->x, second->y };
	double *const out[2] = { both.x, both.y };
	for (int axis = 0; axis < 2; axis++) {
		const double *line = lines[axis];
		for (int i = 0; i < 3; i++)
			out[axis][i] = line[1] * first->x[i] + line[2] * first->y[i];
		out[axis][0] += line[0];
	}
	return both;
}
