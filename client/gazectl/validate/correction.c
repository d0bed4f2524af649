#include "client/gazectl/validate/correction.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/order.h"
#include "client/gazectl/validate/validation.h"
#include "protocol/correction_file.h"
#include "protocol/validated_file.h"

#define GZ_LOG_MODULE "gazectl"

static const struct gz_correct_params IDENTITY = { { 0, 1, 0 }, { 0, 0, 1 } };

const char *gz_fit_model_name(enum gz_fit_model model)
{
	static const char *const names[] = { "none", "shift", "affine" };
	return model >= GZ_FIT_NONE && model <= GZ_FIT_AFFINE ? names[model] : "unknown";
}

/* The pairs of a fit, and which of them are used. */
struct work {
	const struct gz_display *display;
	const struct gz_fit_pair *pairs;
	size_t count;
	const bool *used;
};

/* Means of the used pairs, except one that may be left out, and second moments about the means. */
struct moments {
	double n, seen[2], target[2];
	double xx, xy, yy; /* moments of the measured points */
	double across[2],
		up[2]; /* moments of measured x, measured y with each axis of the target */
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

/* Whether the measured points spread far enough in every direction: the smaller eigenvalue of their
 * covariance is their variance in the direction of least spread. */
static bool spread_is_sufficient(const struct moments *m)
{
	double half_trace = (m->xx + m->yy) / 2, half_difference = (m->xx - m->yy) / 2;
	double least = half_trace - sqrt(half_difference * half_difference + m->xy * m->xy);
	return least / m->n >= GZ_FIT_SPREAD_MIN * GZ_FIT_SPREAD_MIN;
}

/* Fit @p model over the used pairs except pair @p without. @return false if they are too few or do
 * not spread enough */
static bool fit_model(const struct work *work, enum gz_fit_model model, size_t without,
		      struct gz_correct_params *out_map)
{
	struct moments m;
	double *const lines[2] = { out_map->x, out_map->y };
	find_moments(work, without, &m);
	if (m.n < 1 || (model == GZ_FIT_AFFINE && (m.n < 3 || !spread_is_sufficient(&m))))
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

/* Mean error of the used pairs with one map. */
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

/* Compute each used pair's error with a fit over the others; NaN for pairs that are not used.
 * @return the mean of the errors; NaN if the model cannot be fitted without one of the pairs */
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

/* The affine map if the pairs are sufficient for it; otherwise a shift or none. */
static enum gz_fit_model richest_model(const struct work *work)
{
	double deg[GZ_FIT_TARGETS_MAX];
	size_t n = used_count(work);
	if (n >= GZ_FIT_AFFINE_TARGETS && isfinite(cross_errors(work, GZ_FIT_AFFINE, deg)))
		return GZ_FIT_AFFINE;
	return n >= GZ_FIT_SHIFT_TARGETS ? GZ_FIT_SHIFT : GZ_FIT_NONE;
}

static double median_deg(const double *deg, size_t count)
{
	double sorted[GZ_FIT_TARGETS_MAX] = { 0 };
	size_t n = 0;
	for (size_t i = 0; i < count; i++)
		if (isfinite(deg[i]))
			sorted[n++] = deg[i];
	qsort(sorted, n, sizeof *sorted, gz_compare_doubles);
	return n > 0 ? sorted[n / 2] : NAN;
}

/* Leave out the worst pair if it is an outlier. @return whether it was */
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
	    deg[worst] <= GZ_FIT_OUTLIER_FACTOR * median_deg(deg, work->count))
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
	/* Cannot fail: it succeeded with one pair less. */
	(void)fit_model(work, fit->model, work->count, &fit->map);
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

/* Longest wait for a status. Chosen: one comes at once if a correction has changed, and at least
 * once a second. */
#define STATUS_PATIENCE_NS (3 * GZ_NS_PER_S)

static enum gz_result report_directory(const struct gazectl_correction *correction,
				       enum gz_result result)
{
	if (result != GZ_OK)
		gz_err(correction->log,
		       "there is no directory for corrections: %s; give one with "
		       "--corrections DIR",
		       gz_result_text(result));
	return result;
}

static enum gz_result find_directory(const struct gazectl_correction *correction,
				     char directory[GZ_PATH_SIZE])
{
	if (!correction->directory[0])
		return gz_correction_directory(directory, GZ_PATH_SIZE);
	snprintf(directory, GZ_PATH_SIZE, "%s", correction->directory);
	return GZ_OK;
}

static enum gz_result find_correction_path(const struct gazectl_correction *correction,
					   const struct gz_status *status, char *path, size_t size)
{
	char directory[GZ_PATH_SIZE];
	enum gz_result result = find_directory(correction, directory);
	if (result == GZ_OK)
		result = gz_correction_path(directory, status->tracker.name, status->tracker.serial,
					    &status->display, path, size);
	return report_directory(correction, result);
}

static enum gz_result find_validated_path(const struct gazectl_correction *correction,
					  const struct gz_status *status, char *path, size_t size)
{
	char directory[GZ_PATH_SIZE];
	enum gz_result result = find_directory(correction, directory);
	if (result == GZ_OK)
		result = gz_validated_path(directory, status->tracker.name, status->tracker.serial,
					   path, size);
	return report_directory(correction, result);
}

static bool is_in_force(const struct gz_status *status, const struct gz_correct_params *map)
{
	return memcmp(status->correction.x, map->x, sizeof map->x) == 0 &&
	       memcmp(status->correction.y, map->y, sizeof map->y) == 0;
}

/* Ask the daemon to read its corrections again, and wait until its status shows @p map. */
static enum gazectl_exit await_correction(const struct gazectl_correction *correction,
					  const struct gz_correct_params *map, const char *path)
{
	char reply[GZ_CONTROL_REPLY_SIZE];
	struct gz_status status;
	enum gazectl_exit exit_status =
		gazectl_request(correction->control, "CORRECTION", correction->log, reply);
	if (exit_status != GAZECTL_DONE)
		return exit_status;
	int64_t deadline_ns = gz_clock_now_ns() + STATUS_PATIENCE_NS;
	while (gazectl_next_status(correction->stream, deadline_ns, &status))
		if (is_in_force(&status, map))
			return GAZECTL_DONE;
	gz_err(correction->log,
	       "the daemon does not apply %s: it reads its corrections from another directory "
	       "(tracker.corrections in gazed.conf; here --corrections), or a correction was given "
	       "on its command line",
	       path);
	return GAZECTL_FAILED;
}

static struct gz_correction_file correction_file_of(const struct gz_validation *validation,
						    const struct gz_correct_params *map)
{
	const struct gz_status *status = &validation->status;
	struct gz_correction_file file = {
		.display_px = { status->display.px[0], status->display.px[1] },
		.display_mm = { status->display.mm[0], status->display.mm[1] },
		.distance_mm = status->display.distance_mm,
		.before_deg = validation->fit.before_deg,
		.after_deg = validation->fit.cross_deg,
	};
	gz_correction_name(status->tracker.name, file.tracker);
	gz_correction_name(status->tracker.serial, file.serial);
	memcpy(file.x, map->x, sizeof file.x);
	memcpy(file.y, map->y, sizeof file.y);
	memcpy(file.measured, validation->started, sizeof validation->started);
	return file;
}

enum gazectl_exit gazectl_correction_store(const struct gazectl_correction *correction,
					   const struct gz_validation *validation)
{
	char path[2 * GZ_PATH_SIZE];
	struct gz_correct_params before;
	if (!validation->fit.helps) {
		gz_warn(correction->log, "a correction would not help, so none is stored");
		return GAZECTL_DONE;
	}
	memcpy(before.x, validation->status.correction.x, sizeof before.x);
	memcpy(before.y, validation->status.correction.y, sizeof before.y);
	struct gz_correct_params map = gz_fit_compose(&before, &validation->fit.map);
	if (!gz_correct_usable(&map)) {
		gz_err(correction->log, "combined with the correction in force, this one maps the "
					"display to a line or a point: remove the former with "
					"--forget, and check again");
		return GAZECTL_FAILED;
	}
	struct gz_correction_file file = correction_file_of(validation, &map);
	if (find_correction_path(correction, &validation->status, path, sizeof path) != GZ_OK ||
	    gz_correction_write(path, &file, correction->log) != GZ_OK)
		return GAZECTL_FAILED;
	enum gazectl_exit status = await_correction(correction, &map, path);
	if (status == GAZECTL_DONE)
		gz_info(correction->log, "the correction is stored in %s and in force", path);
	return status;
}

static struct gz_validated validated_of(const struct gz_validation *validation)
{
	const struct gz_status *status = &validation->status;
	struct gz_validated validated = {
		.display = status->display,
		.monitor = validation->monitor,
		.accuracy_deg = validation->summary[GZ_TRACE_BOTH].accuracy_deg,
	};
	gz_correction_name(status->tracker.name, validated.tracker);
	gz_correction_name(status->tracker.serial, validated.serial);
	memcpy(validated.measured, validation->started, sizeof validation->started);
	return validated;
}

void gazectl_validated_store(const struct gazectl_correction *correction,
			     const struct gz_validation *validation)
{
	char path[2 * GZ_PATH_SIZE], reply[GZ_CONTROL_REPLY_SIZE];
	const struct gz_validated validated = validated_of(validation);
	if (!isfinite(validated.accuracy_deg) ||
	    find_validated_path(correction, &validation->status, path, sizeof path) != GZ_OK ||
	    gz_validated_write(path, &validated, correction->log) != GZ_OK)
		return;
	/* In a recording, another correction that is found meanwhile would end it. */
	if (validation->status.recording.state != GZ_RECORDING_ON)
		(void)gazectl_request(correction->control, "CORRECTION", correction->log, reply);
}

enum gazectl_exit gazectl_correction_forget(const struct gazectl_correction *correction,
					    const struct gz_status *status)
{
	char path[2 * GZ_PATH_SIZE];
	if (find_correction_path(correction, status, path, sizeof path) != GZ_OK)
		return GAZECTL_FAILED;
	if (unlink(path) != 0) {
		gz_err(correction->log, "cannot remove %s: %s", path,
		       errno == ENOENT ? "no correction is stored for this tracker and display"
				       : strerror(errno));
		return GAZECTL_FAILED;
	}
	enum gazectl_exit exit_status = await_correction(correction, &IDENTITY, path);
	if (exit_status == GAZECTL_DONE)
		gz_info(correction->log, "%s was removed; gaze is no longer corrected", path);
	return exit_status;
}
