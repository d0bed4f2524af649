#include "client/gazectl/validate/validation_report.h"

#include <math.h>

/* Width of the picture without its margin, and the margin, px (chosen). */
#define WIDTH_PX  1200.0
#define MARGIN_PX 60.0

/* From a target's circle to its label, px (chosen). */
#define LABEL_PX 16.0

/* Samples drawn of one target at most: chosen, more make one blot. */
enum { SAMPLES_MAX = 400 };

/* The display on the picture. */
struct frame {
	double width, height, px_per_deg;
	FILE *out;
};

static struct frame make_frame(const struct gz_display *display, FILE *out)
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

static double x_of(const struct frame *frame, struct gz_point point)
{
	return MARGIN_PX + point.x * frame->width;
}

static double y_of(const struct frame *frame, struct gz_point point)
{
	return MARGIN_PX + point.y * frame->height;
}

static void draw_target(const struct frame *frame, struct gz_point point)
{
	double x = x_of(frame, point), y = y_of(frame, point), arm = 9;
	fprintf(frame->out,
		"<circle cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\" class=\"degree\"/>\n"
		"<path d=\"M%.1f %.1fH%.1fM%.1f %.1fV%.1f\" class=\"target\"/>\n",
		x, y, frame->px_per_deg, x - arm, y, x + arm, x, y - arm, y + arm);
}

static void draw_samples(const struct frame *frame, const struct gz_validation *validation,
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
				x_of(frame, point), y_of(frame, point));
	}
}

static void draw_mean(const struct frame *frame, const struct gz_validation_target *target)
{
	const struct gz_quality *quality = &target->quality[GZ_TRACE_BOTH];
	if (!isfinite(quality->mean.x) || !isfinite(quality->mean.y))
		return;
	double x = x_of(frame, quality->mean), y = y_of(frame, quality->mean);
	fprintf(frame->out,
		"<path d=\"M%.1f %.1fL%.1f %.1f\" class=\"offset\"/>\n"
		"<circle cx=\"%.1f\" cy=\"%.1f\" r=\"3\" class=\"mean\"/>\n"
		"<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\">%.2f°</text>\n",
		x_of(frame, target->point), y_of(frame, target->point), x, y, x, y,
		x_of(frame, target->point),
		y_of(frame, target->point) + frame->px_per_deg + LABEL_PX, quality->accuracy_deg);
}

static void begin(const struct frame *frame)
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
	struct frame frame = make_frame(&validation->status.display, out);
	const struct gz_quality_summary *both = &validation->summary[GZ_TRACE_BOTH];
	begin(&frame);
	for (size_t i = 0; i < validation->target_count; i++) {
		draw_target(&frame, validation->target[i].point);
		draw_samples(&frame, validation, &validation->target[i]);
	}
	/* Above every sample. */
	for (size_t i = 0; i < validation->target_count; i++)
		draw_mean(&frame, &validation->target[i]);
	if (both->targets == 0) {
		fprintf(out, "<text x=\"%.1f\" y=\"%.1f\">%s: no samples</text>\n</svg>\n",
			MARGIN_PX, MARGIN_PX / 2, validation->started);
		return;
	}
	fprintf(out,
		"<text x=\"%.1f\" y=\"%.1f\">%s: accuracy %.2f°, RMS-S2S %.3f°, SD %.3f°, loss "
		"%.1f %%; the dashed circles are 1° in radius at the middle of the display</text>\n"
		"</svg>\n",
		MARGIN_PX, MARGIN_PX / 2, validation->started, both->accuracy_deg,
		both->rms_s2s_deg, both->sd_deg, 100 * both->loss);
}
