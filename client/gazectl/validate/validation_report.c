#include "client/gazectl/validate/validation_report.h"

#include <inttypes.h>
#include <math.h>

static const char *const trace_titles[GZ_TRACE_COUNT] = { "right eye", "left eye", "both eyes" };

/* A number of the table, or a dash where there is none. */
static void print_cell(FILE *out, const char *format, double value)
{
	char text[32] = "-";
	if (isfinite(value))
		snprintf(text, sizeof text, format, value);
	fprintf(out, " %8s", text);
}

static void print_row(FILE *out, const char *title, const double value[6], uint64_t used)
{
	fprintf(out, "%-12s", title);
	print_cell(out, "%.2f", value[0]);
	print_cell(out, "%+.2f", value[1]);
	print_cell(out, "%+.2f", value[2]);
	print_cell(out, "%.3f", value[3]);
	print_cell(out, "%.3f", value[4]);
	print_cell(out, "%.1f %%", 100 * value[5]);
	fprintf(out, " %8" PRIu64 "\n", used);
}

static void print_target(const struct gz_validation *validation, size_t i, FILE *out)
{
	const struct gz_validation_target *target = &validation->target[i];
	const struct gz_quality *quality = &target->quality[GZ_TRACE_BOTH];
	const double values[6] = {
		quality->accuracy_deg, quality->offset_deg[0], quality->offset_deg[1],
		quality->rms_s2s_deg,  quality->sd_deg,        quality->loss,
	};
	char title[32];
	snprintf(title, sizeof title, "  %.2f %.2f", target->point.x, target->point.y);
	print_row(out, title, values, quality->used);
}

static void print_summary(const struct gz_validation *validation, enum gz_trace trace, FILE *out)
{
	const struct gz_quality_summary *summary = &validation->summary[trace];
	const double values[6] = {
		summary->accuracy_deg, summary->offset_deg[0], summary->offset_deg[1],
		summary->rms_s2s_deg,  summary->sd_deg,        summary->loss,
	};
	print_row(out, trace_titles[trace], values, summary->used);
}

static void print_setting(const struct gz_validation *validation, FILE *out)
{
	const struct gz_status *status = &validation->status;
	const struct gz_display *display = &status->display;
	const struct gz_point left = { 0, 0.5f }, right = { 1, 0.5f };
	fprintf(out, "tracker      %s%s%s, %.1f Hz\n", status->tracker.name,
		status->tracker.serial[0] ? " " : "", status->tracker.serial,
		status->rate_hz_measured);
	fprintf(out, "display      %dx%d px, %gx%g mm, %g mm away: %.1f deg wide\n\n",
		display->px[0], display->px[1], display->mm[0], display->mm[1],
		display->distance_mm, gz_display_angle_deg(display, left, right));
}

static void print_fit(const struct gz_fit *fit, size_t targets, FILE *out)
{
	if (fit->model == GZ_FIT_NONE) {
		fprintf(out,
			"correction   none can be told: %zu targets have samples, %d are needed\n",
			fit->used_count, GZ_FIT_SHIFT_TARGETS);
		return;
	}
	fprintf(out,
		"correction   %s over %zu of %zu targets: %.2f deg before, %.2f deg after on "
		"targets it was not made from: it %s\n",
		fit->model == GZ_FIT_SHIFT ? "a shift" : "an affine map", fit->used_count, targets,
		fit->before_deg, fit->cross_deg, fit->helps ? "helps" : "does not help");
}

void gz_validation_print(const struct gz_validation *validation, FILE *out)
{
	const struct gz_quality_summary *both = &validation->summary[GZ_TRACE_BOTH];
	print_setting(validation, out);
	fprintf(out, "%-12s %8s %8s %8s %8s %8s %8s %8s\n", "target", "accuracy", "right", "down",
		"RMS-S2S", "SD", "loss", "samples");
	for (size_t i = 0; i < validation->target_count; i++)
		print_target(validation, i, out);
	print_summary(validation, GZ_TRACE_BOTH, out);
	for (int trace = 0; trace < GZ_TRACE_BOTH; trace++)
		if (validation->summary[trace].targets > 0)
			print_summary(validation, (enum gz_trace)trace, out);
	fputs("             degrees; means of the targets'\n\n", out);
	if (both->targets > 0)
		fprintf(out, "accuracy     %.2f deg, between targets %.2f (SD), worst %.2f\n",
			both->accuracy_deg, both->accuracy_sd_deg, both->worst_deg);
	print_fit(&validation->fit, validation->target_count, out);
}

static void write_point(struct gz_json *json, const char *key, struct gz_point point)
{
	gz_json_begin_list(json, key);
	gz_json_double(json, NULL, point.x);
	gz_json_double(json, NULL, point.y);
	gz_json_end_list(json);
}

static void write_doubles(struct gz_json *json, const char *key, const double *values, int count)
{
	gz_json_begin_list(json, key);
	for (int i = 0; i < count; i++)
		gz_json_double(json, NULL, values[i]);
	gz_json_end_list(json);
}

static void write_quality(struct gz_json *json, const char *key, const struct gz_quality *quality)
{
	gz_json_begin(json, key);
	gz_json_double(json, "accuracy_deg", quality->accuracy_deg);
	write_doubles(json, "offset_deg", quality->offset_deg, 2);
	gz_json_double(json, "rms_s2s_deg", quality->rms_s2s_deg);
	gz_json_double(json, "sd_deg", quality->sd_deg);
	write_doubles(json, "sd_axis_deg", quality->sd_axis_deg, 2);
	gz_json_double(json, "bcea_deg2", quality->bcea_deg2);
	gz_json_double(json, "loss", quality->loss);
	gz_json_uint(json, "expected", quality->expected);
	gz_json_uint(json, "measured", quality->measured);
	gz_json_uint(json, "used", quality->used);
	write_point(json, "mean", quality->mean);
	gz_json_end(json);
}

static void write_summary(struct gz_json *json, const char *key,
			  const struct gz_quality_summary *summary)
{
	gz_json_begin(json, key);
	gz_json_uint(json, "targets", summary->targets);
	gz_json_double(json, "accuracy_deg", summary->accuracy_deg);
	gz_json_double(json, "accuracy_sd_deg", summary->accuracy_sd_deg);
	gz_json_double(json, "worst_deg", summary->worst_deg);
	write_doubles(json, "offset_deg", summary->offset_deg, 2);
	gz_json_double(json, "rms_s2s_deg", summary->rms_s2s_deg);
	gz_json_double(json, "sd_deg", summary->sd_deg);
	gz_json_double(json, "bcea_deg2", summary->bcea_deg2);
	gz_json_double(json, "loss", summary->loss);
	gz_json_uint(json, "expected", summary->expected);
	gz_json_uint(json, "measured", summary->measured);
	gz_json_uint(json, "used", summary->used);
	gz_json_end(json);
}

static void write_setting(struct gz_json *json, const struct gz_validation *validation)
{
	const struct gz_status *status = &validation->status;
	gz_json_text(json, "started", validation->started);
	gz_json_begin(json, "tracker");
	gz_json_text(json, "name", status->tracker.name);
	gz_json_text(json, "serial", status->tracker.serial);
	gz_json_end(json);
	gz_json_begin(json, "rate_hz");
	gz_json_double(json, "nominal", status->rate_hz_nominal);
	gz_json_double(json, "measured", status->rate_hz_measured);
	gz_json_end(json);
	gz_json_display(json, "display", &status->display);
	gz_json_begin(json, "correction_in_force");
	write_doubles(json, "x", status->correction.x, 3);
	write_doubles(json, "y", status->correction.y, 3);
	gz_json_end(json);
}

static void write_target(struct gz_json *json, const struct gz_validation_target *target,
			 bool fitted)
{
	gz_json_begin(json, NULL);
	write_point(json, "point", target->point);
	gz_json_int(json, "shown_ns", target->shown_ns);
	gz_json_int(json, "begin_ns", target->begin_ns);
	gz_json_int(json, "hidden_ns", target->hidden_ns);
	gz_json_bool(json, "fitted", fitted);
	for (int trace = 0; trace < GZ_TRACE_COUNT; trace++)
		write_quality(json, gz_trace_name((enum gz_trace)trace), &target->quality[trace]);
	gz_json_end(json);
}

static void write_fit(struct gz_json *json, const struct gz_fit *fit)
{
	gz_json_begin(json, "correction");
	gz_json_text(json, "model", gz_fit_model_name(fit->model));
	write_doubles(json, "x", fit->map.x, 3);
	write_doubles(json, "y", fit->map.y, 3);
	gz_json_uint(json, "targets", fit->used_count);
	gz_json_double(json, "before_deg", fit->before_deg);
	gz_json_double(json, "after_deg", fit->after_deg);
	gz_json_double(json, "cross_validated_deg", fit->cross_deg);
	gz_json_bool(json, "helps", fit->helps);
	gz_json_end(json);
}

void gz_validation_write_json(const struct gz_validation *validation, FILE *out)
{
	struct gz_json json = { .out = out };
	gz_json_begin(&json, NULL);
	write_setting(&json, validation);
	gz_json_begin_list(&json, "targets");
	for (size_t i = 0; i < validation->target_count; i++)
		write_target(&json, &validation->target[i], validation->fit.used[i]);
	gz_json_end_list(&json);
	gz_json_begin(&json, "summary");
	for (int trace = 0; trace < GZ_TRACE_COUNT; trace++)
		write_summary(&json, gz_trace_name((enum gz_trace)trace),
			      &validation->summary[trace]);
	gz_json_end(&json);
	write_fit(&json, &validation->fit);
	gz_json_end(&json);
}
