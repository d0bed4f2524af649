#include "client/gazectl/validate/validation.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

#include "client/gazectl/output.h"

/* When the eye came to rest after the first saccade that can be a reaction to the target; the time
 * at which the target appeared if there was none. */
static int64_t landing_ns(const struct gz_gaze_trace *trace,
			  const struct gz_validation_target *target)
{
	size_t end = gz_gaze_trace_find(trace, target->hidden_ns);
	bool moved = false;
	for (size_t i = gz_gaze_trace_find(trace, target->shown_ns + GZ_VALIDATION_REACTION_NS);
	     i < end; i++) {
		enum gz_event event = trace->items[i].event;
		if (event == GZ_EVENT_SACCADE)
			moved = true;
		else if (moved && event == GZ_EVENT_FIXATION)
			return trace->items[i].sample.host_ns;
	}
	return target->shown_ns;
}

static void find_target_samples(const struct gz_gaze_trace *trace,
				struct gz_validation_target *target)
{
	int64_t landed_ns = landing_ns(trace, target);
	target->begin_ns = target->shown_ns + GZ_VALIDATION_SETTLE_NS;
	if (landed_ns > target->begin_ns)
		target->begin_ns = landed_ns;
	if (target->begin_ns > target->hidden_ns)
		target->begin_ns = target->hidden_ns;
	target->first = gz_gaze_trace_find(trace, target->begin_ns);
	target->count = gz_gaze_trace_find(trace, target->hidden_ns) - target->first;
}

static void measure_target(const struct gz_validation *validation,
			   const struct gz_quality_sample *samples, int64_t period_ns,
			   struct gz_validation_target *target)
{
	const struct gz_quality_input input = {
		.display = &validation->status.display,
		.target = target->point,
		.samples = samples + target->first,
		.count = target->count,
		.begin_ns = target->begin_ns,
		.end_ns = target->hidden_ns,
		.period_ns = period_ns,
	};
	for (int i = 0; i < GZ_TRACE_COUNT; i++)
		gz_quality_measure(&input, (enum gz_trace)i, &target->quality[i]);
}

static void summarise_targets(struct gz_validation *validation)
{
	static const size_t max = GZ_FIT_TARGETS_MAX;
	size_t count = validation->target_count < max ? validation->target_count : max;
	struct gz_quality quality[GZ_FIT_TARGETS_MAX];
	struct gz_fit_pair pairs[GZ_FIT_TARGETS_MAX];
	for (int trace = 0; trace < GZ_TRACE_COUNT; trace++) {
		for (size_t i = 0; i < count; i++)
			quality[i] = validation->target[i].quality[trace];
		gz_quality_summarise(quality, count, &validation->summary[trace]);
	}
	for (size_t i = 0; i < count; i++)
		pairs[i] = (struct gz_fit_pair) {
			validation->target[i].point,
			validation->target[i].quality[GZ_TRACE_BOTH].mean,
		};
	gz_fit_correction(&validation->status.display, pairs, count, &validation->fit);
}

enum gz_result gz_validation_evaluate(struct gz_validation *validation)
{
	const struct gz_gaze_trace *trace = &validation->trace;
	if (!gz_display_valid(&validation->status.display))
		return GZ_ERR_INVAL;
	struct gz_quality_sample *samples = calloc(trace->count + 1, sizeof *samples);
	if (!samples)
		return GZ_ERR_NO_MEM;
	for (size_t i = 0; i < trace->count; i++)
		samples[i] = trace->items[i].sample;
	int64_t period_ns = gz_quality_period_ns(samples, trace->count);
	for (size_t i = 0; period_ns >= 0 && i < validation->target_count; i++) {
		find_target_samples(trace, &validation->target[i]);
		measure_target(validation, samples, period_ns, &validation->target[i]);
	}
	free(samples);
	if (period_ns < 0)
		return GZ_ERR_NO_MEM;
	summarise_targets(validation);
	return GZ_OK;
}

static const char *const trace_titles[GZ_TRACE_COUNT] = { "right eye", "left eye", "both eyes" };

/* Print a cell of the table: a number, or a dash for NaN. */
static void print_cell(FILE *out, const char *format, double value)
{
	char text[32] = "-";
	if (isfinite(value))
		snprintf(text, sizeof text, format, value);
	fprintf(out, " %8s", text);
}

static void print_quality_row(FILE *out, const char *title, const double value[6], uint64_t used)
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

static void print_target_row(const struct gz_validation *validation, size_t i, FILE *out)
{
	const struct gz_validation_target *target = &validation->target[i];
	const struct gz_quality *quality = &target->quality[GZ_TRACE_BOTH];
	const double values[6] = {
		quality->accuracy_deg, quality->offset_deg[0], quality->offset_deg[1],
		quality->rms_s2s_deg,  quality->sd_deg,        quality->loss,
	};
	char title[32];
	snprintf(title, sizeof title, "  %.2f %.2f", target->point.x, target->point.y);
	print_quality_row(out, title, values, quality->used);
}

static void print_summary_row(const struct gz_validation *validation, enum gz_trace trace,
			      FILE *out)
{
	const struct gz_quality_summary *summary = &validation->summary[trace];
	const double values[6] = {
		summary->accuracy_deg, summary->offset_deg[0], summary->offset_deg[1],
		summary->rms_s2s_deg,  summary->sd_deg,        summary->loss,
	};
	print_quality_row(out, trace_titles[trace], values, summary->used);
}

static void print_tracker_and_display(const struct gz_validation *validation, FILE *out)
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
			"correction   cannot be computed: %zu targets have samples, %d are "
			"needed\n",
			fit->used_count, GZ_FIT_SHIFT_TARGETS);
		return;
	}
	fprintf(out,
		"correction   %s from %zu of %zu targets: error %.2f deg before, %.2f deg after "
		"(cross-validated): it %s\n",
		fit->model == GZ_FIT_SHIFT ? "a shift" : "an affine map", fit->used_count, targets,
		fit->before_deg, fit->cross_deg, fit->helps ? "helps" : "does not help");
}

void gz_validation_print(const struct gz_validation *validation, FILE *out)
{
	const struct gz_quality_summary *both = &validation->summary[GZ_TRACE_BOTH];
	print_tracker_and_display(validation, out);
	fprintf(out, "%-12s %8s %8s %8s %8s %8s %8s %8s\n", "target", "accuracy", "right", "down",
		"RMS-S2S", "SD", "loss", "samples");
	for (size_t i = 0; i < validation->target_count; i++)
		print_target_row(validation, i, out);
	print_summary_row(validation, GZ_TRACE_BOTH, out);
	for (int trace = 0; trace < GZ_TRACE_BOTH; trace++)
		if (validation->summary[trace].targets > 0)
			print_summary_row(validation, (enum gz_trace)trace, out);
	fputs("             degrees; the last lines are means over the targets\n\n", out);
	if (both->targets > 0)
		fprintf(out, "accuracy     %.2f deg, SD between targets %.2f, worst %.2f\n",
			both->accuracy_deg, both->accuracy_sd_deg, both->worst_deg);
	print_fit(&validation->fit, validation->target_count, out);
}

static json_t *json_point(struct gz_point point)
{
	return json_pack("[oo]", gz_output_json_number(point.x), gz_output_json_number(point.y));
}

static json_t *json_quality(const struct gz_quality *quality)
{
	return json_pack("{so so so so so so so so so so so}", "accuracy_deg",
			 gz_output_json_number(quality->accuracy_deg), "offset_deg",
			 gz_output_json_numbers(quality->offset_deg, 2), "rms_s2s_deg",
			 gz_output_json_number(quality->rms_s2s_deg), "sd_deg",
			 gz_output_json_number(quality->sd_deg), "sd_axis_deg",
			 gz_output_json_numbers(quality->sd_axis_deg, 2), "bcea_deg2",
			 gz_output_json_number(quality->bcea_deg2), "loss",
			 gz_output_json_number(quality->loss), "expected",
			 gz_output_json_count(quality->expected), "measured",
			 gz_output_json_count(quality->measured), "used",
			 gz_output_json_count(quality->used), "mean", json_point(quality->mean));
}

static json_t *json_quality_summary(const struct gz_quality_summary *summary)
{
	return json_pack("{so so so so so so so so so so so so}", "targets",
			 gz_output_json_count(summary->targets), "accuracy_deg",
			 gz_output_json_number(summary->accuracy_deg), "accuracy_sd_deg",
			 gz_output_json_number(summary->accuracy_sd_deg), "worst_deg",
			 gz_output_json_number(summary->worst_deg), "offset_deg",
			 gz_output_json_numbers(summary->offset_deg, 2), "rms_s2s_deg",
			 gz_output_json_number(summary->rms_s2s_deg), "sd_deg",
			 gz_output_json_number(summary->sd_deg), "bcea_deg2",
			 gz_output_json_number(summary->bcea_deg2), "loss",
			 gz_output_json_number(summary->loss), "expected",
			 gz_output_json_count(summary->expected), "measured",
			 gz_output_json_count(summary->measured), "used",
			 gz_output_json_count(summary->used));
}

static json_t *json_map(const double x[3], const double y[3])
{
	return json_pack("{so so}", "x", gz_output_json_numbers(x, 3), "y",
			 gz_output_json_numbers(y, 3));
}

static json_t *json_targets(const struct gz_validation *validation)
{
	json_t *list = json_array();
	for (size_t i = 0; i < validation->target_count; i++) {
		const struct gz_validation_target *target = &validation->target[i];
		json_t *json =
			json_pack("{so sI sI sI sb}", "point", json_point(target->point),
				  "shown_ns", (json_int_t)target->shown_ns, "begin_ns",
				  (json_int_t)target->begin_ns, "hidden_ns",
				  (json_int_t)target->hidden_ns, "fitted", validation->fit.used[i]);
		for (int trace = 0; trace < GZ_TRACE_COUNT; trace++)
			json_object_set_new(json, gz_trace_name((enum gz_trace)trace),
					    json_quality(&target->quality[trace]));
		json_array_append_new(list, json);
	}
	return list;
}

static json_t *json_fit(const struct gz_fit *fit)
{
	return json_pack("{ss so so so so so so sb}", "model", gz_fit_model_name(fit->model), "x",
			 gz_output_json_numbers(fit->map.x, 3), "y",
			 gz_output_json_numbers(fit->map.y, 3), "targets",
			 gz_output_json_count(fit->used_count), "before_deg",
			 gz_output_json_number(fit->before_deg), "after_deg",
			 gz_output_json_number(fit->after_deg), "cross_validated_deg",
			 gz_output_json_number(fit->cross_deg), "helps", fit->helps);
}

enum gz_result gz_validation_write_json(const struct gz_validation *validation, FILE *out,
					const struct gz_log *log)
{
	const struct gz_status *status = &validation->status;
	json_t *summary = json_object();
	for (int trace = 0; trace < GZ_TRACE_COUNT; trace++)
		json_object_set_new(summary, gz_trace_name((enum gz_trace)trace),
				    json_quality_summary(&validation->summary[trace]));
	json_t *json = json_pack(
		"{ss so so so so so so so}", "started", validation->started, "tracker",
		gz_output_json_tracker(status->tracker.name, status->tracker.serial), "rate_hz",
		gz_output_json_rate(status->rate_hz_nominal, status->rate_hz_measured), "display",
		gz_output_json_display(&status->display), "correction_in_force",
		json_map(status->correction.x, status->correction.y), "targets",
		json_targets(validation), "summary", summary, "correction",
		json_fit(&validation->fit));
	return gz_output_json_print(json, out, log);
}

/* Width of the picture without its margins, and a margin, px; chosen. */
#define WIDTH_PX  1200.0
#define MARGIN_PX 60.0

/* Distance from a target's circle to its label, px; chosen. */
#define LABEL_PX 16.0

/* Most samples drawn for one target. Chosen: more would merge into a blot. */
enum { SAMPLES_MAX = 400 };

/* The display on the picture. */
struct frame {
	double width, height, px_per_deg;
	FILE *out;
};

static struct frame make_picture_frame(const struct gz_display *display, FILE *out)
{
	struct gz_display drawn = *display;
	drawn.px[0] = (int)WIDTH_PX;
	return (struct frame) {
		.width = WIDTH_PX,
		.height = WIDTH_PX * display->mm[1] / display->mm[0],
		.px_per_deg = gz_display_px_per_deg(&drawn),
		.out = out,
	};
}

static double picture_x(const struct frame *frame, struct gz_point point)
{
	return MARGIN_PX + point.x * frame->width;
}

static double picture_y(const struct frame *frame, struct gz_point point)
{
	return MARGIN_PX + point.y * frame->height;
}

static void draw_validation_target(const struct frame *frame, struct gz_point point)
{
	double x = picture_x(frame, point), y = picture_y(frame, point), arm = 9;
	fprintf(frame->out,
		"<circle cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\" class=\"degree\"/>\n"
		"<path d=\"M%.1f %.1fH%.1fM%.1f %.1fV%.1f\" class=\"target\"/>\n",
		x, y, frame->px_per_deg, x - arm, y, x + arm, x, y - arm, y + arm);
}

static void draw_target_samples(const struct frame *frame, const struct gz_validation *validation,
				const struct gz_validation_target *target)
{
	size_t step = target->count / SAMPLES_MAX + 1;
	for (size_t i = 0; i < target->count; i += step) {
		const struct gz_quality_sample *sample =
			&validation->trace.items[target->first + i].sample;
		struct gz_point point = sample->point[GZ_TRACE_BOTH];
		if (sample->fixating && isfinite(point.x) && isfinite(point.y))
			fprintf(frame->out,
				"<circle cx=\"%.1f\" cy=\"%.1f\" r=\"1.5\" class=\"sample\"/>\n",
				picture_x(frame, point), picture_y(frame, point));
	}
}

static void draw_target_mean(const struct frame *frame, const struct gz_validation_target *target)
{
	const struct gz_quality *quality = &target->quality[GZ_TRACE_BOTH];
	if (!isfinite(quality->mean.x) || !isfinite(quality->mean.y))
		return;
	double x = picture_x(frame, quality->mean), y = picture_y(frame, quality->mean);
	fprintf(frame->out,
		"<path d=\"M%.1f %.1fL%.1f %.1f\" class=\"offset\"/>\n"
		"<circle cx=\"%.1f\" cy=\"%.1f\" r=\"3\" class=\"mean\"/>\n"
		"<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\">%.2f°</text>\n",
		picture_x(frame, target->point), picture_y(frame, target->point), x, y, x, y,
		picture_x(frame, target->point),
		picture_y(frame, target->point) + frame->px_per_deg + LABEL_PX,
		quality->accuracy_deg);
}

static void begin_picture(const struct frame *frame)
{
	fprintf(frame->out,
		"<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
		"<svg xmlns=\"http://www.w3.org/2000/svg\" version=\"1.1\" width=\"%.0f\" "
		"height=\"%.0f\">\n<style>\n"
		"text { font: 13px sans-serif; fill: #222 }\n"
		".page { fill: #fff }\n"
		".screen { fill: #eee; stroke: #888 }\n"
		".degree { fill: none; stroke: #aaa; stroke-dasharray: 3 3 }\n"
		".target { fill: none; stroke: #000; stroke-width: 1.5 }\n"
		".sample { fill: #1f6fb4; fill-opacity: 0.35 }\n"
		".offset { fill: none; stroke: #c03020; stroke-width: 1.5 }\n"
		".mean { fill: #c03020 }\n"
		"</style>\n"
		"<rect width=\"100%%\" height=\"100%%\" class=\"page\"/>\n"
		"<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" class=\"screen\"/>\n",
		frame->width + 2 * MARGIN_PX, frame->height + 2 * MARGIN_PX, MARGIN_PX, MARGIN_PX,
		frame->width, frame->height);
}

void gz_validation_draw(const struct gz_validation *validation, FILE *out)
{
	struct frame frame = make_picture_frame(&validation->status.display, out);
	const struct gz_quality_summary *both = &validation->summary[GZ_TRACE_BOTH];
	begin_picture(&frame);
	for (size_t i = 0; i < validation->target_count; i++) {
		draw_validation_target(&frame, validation->target[i].point);
		draw_target_samples(&frame, validation, &validation->target[i]);
	}
	/* Above every sample. */
	for (size_t i = 0; i < validation->target_count; i++)
		draw_target_mean(&frame, &validation->target[i]);
	if (both->targets == 0) {
		fprintf(out, "<text x=\"%.1f\" y=\"%.1f\">%s: no samples</text>\n</svg>\n",
			MARGIN_PX, MARGIN_PX / 2, validation->started);
		return;
	}
	fprintf(out,
		"<text x=\"%.1f\" y=\"%.1f\">%s: accuracy %.2f°, RMS-S2S %.3f°, SD %.3f°, loss "
		"%.1f %%; the dashed circles have a radius of 1° at the centre of the "
		"display</text>\n"
		"</svg>\n",
		MARGIN_PX, MARGIN_PX / 2, validation->started, both->accuracy_deg,
		both->rms_s2s_deg, both->sd_deg, 100 * both->loss);
}
