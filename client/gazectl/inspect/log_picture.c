#include "client/gazectl/inspect/log_picture.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/text.h"
#include "client/gazectl/inspect/log_summary.h"
#include "filter/angle.h"

#define GZ_LOG_MODULE "picture"

/* Sizes in units of the picture, which is 1000 wide; chosen. */
enum {
	WIDTH = 1000,
	MARGIN = 24,
	TITLE = 36,
	STRIP = 110,                  /* height of a strip: one coordinate over time */
	COLUMNS = WIDTH - 2 * MARGIN, /* columns of a strip */
	LABELLED = 150,               /* most fixations that are numbered */
};

/* Radius of a fixation of 250 ms, the mean duration (Bauer 2018, section 2.2); the area of a circle
 * is proportional to the duration. */
static const double RADIUS = 9;

/* Shorter steps of the path are left out, degrees. Chosen: less than the width of a line. */
static const double STEP_DEG = 0.08;

/* The range of a coordinate within one column of a strip. */
struct column {
	float low[2], high[2];
	bool any, missing;
};

struct path_point {
	float x, y;
	bool first; /* the first after a blink, a loss or a gap: no line leads to it */
};

struct picture {
	struct gz_pipeline pipeline;
	int64_t first_ns, span_ns;
	size_t point_count;
	bool cut;    /* further points were left out */
	bool broken; /* the next point is the first of a line */
	struct path_point point[GZ_LOG_PICTURE_POINTS];
	size_t fixation_count;
	struct gz_fixation fixation[GZ_LOG_PICTURE_FIXATIONS];
	struct column column[COLUMNS];
	uint64_t samples, fixations, saccades, blinks;
	size_t mark_count;
	int64_t mark_ns[256];
};

static int column_at(const struct picture *picture, int64_t host_ns)
{
	double part = (double)(host_ns - picture->first_ns) / (double)picture->span_ns;
	int column = (int)(part * COLUMNS);
	return column < 0 ? 0 : column >= COLUMNS ? COLUMNS - 1 : column;
}

static void add_to_column(struct picture *picture, const struct gz_gaze *gaze)
{
	struct column *column = &picture->column[column_at(picture, gaze->host_ns)];
	const float value[2] = { gaze->point.x, gaze->point.y };
	if (gaze->event == GZ_EVENT_BLINK || gaze->event == GZ_EVENT_LOST) {
		column->missing = true;
		return;
	}
	for (int i = 0; i < 2; i++) {
		if (!column->any || value[i] < column->low[i])
			column->low[i] = value[i];
		if (!column->any || value[i] > column->high[i])
			column->high[i] = value[i];
	}
	column->any = true;
}

static void add_to_path(struct picture *picture, const struct gz_gaze *gaze)
{
	if (gaze->event == GZ_EVENT_BLINK || gaze->event == GZ_EVENT_LOST) {
		picture->broken = true;
		return;
	}
	if (picture->point_count == GZ_LOG_PICTURE_POINTS) {
		picture->cut = true;
		return;
	}
	if (!picture->broken) {
		const struct path_point *last = &picture->point[picture->point_count - 1];
		struct gz_point from = { last->x, last->y };
		if (gz_chord_deg(&picture->pipeline.display, from, gaze->point) < STEP_DEG)
			return;
	}
	picture->point[picture->point_count++] =
		(struct path_point) { gaze->point.x, gaze->point.y, picture->broken };
	picture->broken = false;
}

static void add_events(struct picture *picture, const struct gz_pipeline_output *output)
{
	for (size_t i = 0; i < output->fixation_count; i++) {
		if (!output->fixations[i].final)
			continue;
		picture->fixations++;
		if (picture->fixation_count < GZ_LOG_PICTURE_FIXATIONS)
			picture->fixation[picture->fixation_count++] = output->fixations[i];
	}
	picture->saccades += output->saccade_count;
	for (size_t i = 0; i < output->blink_count; i++)
		picture->blinks += output->blinks[i].onset;
}

static void trace_record(struct picture *picture, const struct gz_gaze_log_record *record)
{
	struct gz_pipeline_output output;
	if (record->kind == GZ_GAZE_LOG_MARK && picture->mark_count < 256)
		picture->mark_ns[picture->mark_count++] = record->host_ns;
	if (record->kind == GZ_GAZE_LOG_GAP)
		picture->broken = true;
	if (record->kind != GZ_GAZE_LOG_SAMPLE)
		return;
	gz_pipeline_step(&picture->pipeline, &record->sample, &output);
	picture->samples++;
	add_to_column(picture, &output.gaze);
	add_to_path(picture, &output.gaze);
	add_events(picture, &output);
}

static enum gz_result trace_records(struct picture *picture, struct gz_gaze_log_reader *reader)
{
	struct gz_gaze_log_record record;
	for (;;) {
		enum gz_result result = gz_gaze_log_read(reader, &record);
		if (result == GZ_ERR_END)
			return GZ_OK;
		if (result == GZ_OK)
			trace_record(picture, &record);
		else if (result != GZ_ERR_FORMAT)
			return result;
	}
}

/* Print @p before and a number with two decimals. */
static void print_scaled(FILE *out, const char *before, double value)
{
	char text[64];
	snprintf(text, sizeof text, "%.2f", value);
	gz_number_normalise_point(text);
	fprintf(out, "%s%s", before, text);
}

static void print_escaped(FILE *out, const char *text)
{
	for (; *text; text++) {
		if (*text == '<')
			fputs("&lt;", out);
		else if (*text == '&')
			fputs("&amp;", out);
		else if ((unsigned char)*text >= 0x20)
			fputc(*text, out);
	}
}

/* Print a colour from dark blue (early) through green to yellow (late), which people with colour
 * vision deficiencies can tell apart: five points of viridis (van der Walt and Smith 2015). */
static void print_colour(FILE *out, double part)
{
	static const int stops[5][3] = {
		{ 68, 1, 84 }, { 59, 82, 139 }, { 33, 145, 140 }, { 94, 201, 98 }, { 253, 231, 37 }
	};
	double at = 4 * (part < 0 ? 0 : part > 1 ? 1 : part);
	int stop = at >= 4 ? 3 : (int)at;
	double rest = at - stop;
	fprintf(out, "rgb(%d,%d,%d)",
		(int)lround(stops[stop][0] + rest * (stops[stop + 1][0] - stops[stop][0])),
		(int)lround(stops[stop][1] + rest * (stops[stop + 1][1] - stops[stop][1])),
		(int)lround(stops[stop][2] + rest * (stops[stop + 1][2] - stops[stop][2])));
}

/* The area of the display in the picture. */
struct frame {
	double x, y, width, height;
};

static struct frame display_frame(const struct gz_display *display)
{
	double width = COLUMNS, height = width * display->mm[1] / display->mm[0];
	if (height > 2 * WIDTH) { /* an upright display */
		width *= 2 * WIDTH / height;
		height = 2 * WIDTH;
	}
	return (struct frame) { (WIDTH - width) / 2, TITLE + MARGIN, width, height };
}

static double frame_x(const struct frame *frame, float x)
{
	return frame->x + frame->width * (double)x;
}

static double frame_y(const struct frame *frame, float y)
{
	return frame->y + frame->height * (double)y;
}

static void draw_path(const struct picture *picture, const struct frame *frame, FILE *out)
{
	fputs("<path fill=\"none\" stroke=\"#8aa0b4\" stroke-width=\"0.8\" "
	      "stroke-linejoin=\"round\" d=\"",
	      out);
	for (size_t i = 0; i < picture->point_count; i++) {
		const struct path_point *point = &picture->point[i];
		print_scaled(out, point->first ? "M" : "L", frame_x(frame, point->x));
		print_scaled(out, " ", frame_y(frame, point->y));
	}
	fputs("\"/>\n", out);
}

static void draw_fixation(const struct picture *picture, const struct frame *frame, size_t number,
			  FILE *out)
{
	const struct gz_fixation *fixation = &picture->fixation[number];
	double ms = gz_ns_to_ms(fixation->duration_ns);
	double x = frame_x(frame, fixation->point.x), y = frame_y(frame, fixation->point.y);
	print_scaled(out, "<circle cx=\"", x);
	print_scaled(out, "\" cy=\"", y);
	print_scaled(out, "\" r=\"", RADIUS * sqrt(ms / 250));
	fputs("\" fill-opacity=\"0.45\" stroke=\"#333\" stroke-width=\"0.5\" fill=\"", out);
	print_colour(out,
		     (double)(fixation->onset_ns - picture->first_ns) / (double)picture->span_ns);
	fprintf(out, "\"><title>%zu: ", number + 1);
	print_scaled(out, "", gz_ns_to_s(fixation->onset_ns - picture->first_ns));
	print_scaled(out, " s, ", ms);
	fputs(" ms</title></circle>\n", out);
	if (picture->fixation_count > LABELLED)
		return;
	print_scaled(out, "<text class=\"n\" x=\"", x);
	print_scaled(out, "\" y=\"", y + 3);
	fprintf(out, "\">%zu</text>\n", number + 1);
}

static void draw_strip(const struct picture *picture, int coordinate, double top, FILE *out)
{
	double height = STRIP - 10;
	fprintf(out, "<text x=\"%d\" y=\"", MARGIN - 14);
	print_scaled(out, "", top + height / 2);
	fprintf(out, "\">%s</text>\n<rect class=\"f\" x=\"%d\" width=\"%d\" y=\"",
		coordinate ? "y" : "x", MARGIN, COLUMNS);
	print_scaled(out, "", top);
	print_scaled(out, "\" height=\"", height);
	fputs("\"/>\n<path stroke=\"#e3b7b0\" stroke-width=\"1\" d=\"", out);
	for (int i = 0; i < COLUMNS; i++) {
		if (!picture->column[i].missing)
			continue;
		print_scaled(out, "M", MARGIN + i + 0.5);
		print_scaled(out, " ", top);
		print_scaled(out, "v", height);
	}
	fputs("\"/>\n<path fill=\"none\" stroke=\"#1f5f8b\" stroke-width=\"1.2\" d=\"", out);
	for (int i = 0; i < COLUMNS; i++) {
		const struct column *column = &picture->column[i];
		double low = fmin(fmax((double)column->low[coordinate], 0), 1);
		double high = fmin(fmax((double)column->high[coordinate], 0), 1);
		if (coordinate == 0) { /* right is drawn upwards */
			double right = 1 - low;
			low = 1 - high;
			high = right;
		}
		if (!column->any)
			continue;
		print_scaled(out, i > 0 && picture->column[i - 1].any ? "L" : "M",
			     MARGIN + i + 0.5);
		print_scaled(out, " ", top + height * low);
		print_scaled(out, "V", top + height * high + 0.01);
	}
	fputs("\"/>\n", out);
}

static void draw_marks(const struct picture *picture, double top, FILE *out)
{
	fputs("<path stroke=\"#c2571a\" stroke-width=\"1\" d=\"", out);
	for (size_t i = 0; i < picture->mark_count; i++) {
		print_scaled(out, "M", MARGIN + column_at(picture, picture->mark_ns[i]) + 0.5);
		print_scaled(out, " ", top);
		fputs("v8", out);
	}
	fputs("\"/>\n", out);
}

static void draw_title(const struct picture *picture, const char *name, FILE *out)
{
	fprintf(out, "<text class=\"t\" x=\"%d\" y=\"24\">", MARGIN);
	print_escaped(out, name);
	fprintf(out, "</text>\n<text x=\"%d\" y=\"44\">", MARGIN);
	print_scaled(out, "", (double)picture->span_ns * 1e-9);
	fprintf(out,
		" s, %" PRIu64 " samples, %" PRIu64 " fixations, %" PRIu64 " saccades, %" PRIu64
		" blinks; circles: fixations, their area is the duration, "
		"early dark, late bright%s</text>\n",
		picture->samples, picture->fixations, picture->saccades, picture->blinks,
		picture->cut ? "; the end of the path is left out" : "");
}

static void draw_recording(const struct picture *picture, const char *name, FILE *out)
{
	struct frame frame = display_frame(&picture->pipeline.display);
	double strips = frame.y + frame.height + 20, end_s = (double)picture->span_ns * 1e-9;
	int height = (int)ceil(strips + 2 * STRIP + 30);
	fprintf(out,
		"<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\" width=\"%d\" "
		"height=\"%d\">\n"
		"<style>text{font:12px sans-serif;fill:#333}.t{font-size:16px;font-weight:bold}"
		".n{font-size:8px;text-anchor:middle}.e{text-anchor:end}"
		".f{fill:#fff;stroke:#999}</style>\n"
		"<rect width=\"%d\" height=\"%d\" fill=\"#f4f5f6\"/>\n",
		WIDTH, height, WIDTH, height, WIDTH, height);
	draw_title(picture, name, out);
	print_scaled(out, "<rect class=\"f\" x=\"", frame.x);
	print_scaled(out, "\" y=\"", frame.y);
	print_scaled(out, "\" width=\"", frame.width);
	print_scaled(out, "\" height=\"", frame.height);
	fputs("\"/>\n", out);
	draw_path(picture, &frame, out);
	for (size_t i = 0; i < picture->fixation_count; i++)
		draw_fixation(picture, &frame, i, out);
	draw_strip(picture, 0, strips, out);
	draw_strip(picture, 1, strips + STRIP, out);
	draw_marks(picture, strips + 2 * STRIP - 6, out);
	fprintf(out, "<text x=\"%d\" y=\"%d\">0 s</text>\n<text class=\"e\" x=\"%d\" y=\"%d\">",
		MARGIN, height - 12, WIDTH - MARGIN, height - 12);
	print_scaled(out, "", end_s);
	fputs(" s</text>\n</svg>\n", out);
}

enum gz_result gz_log_picture(struct gz_gaze_log_reader *reader, const char *name, int64_t first_ns,
			      int64_t last_ns, const struct gz_log *log, FILE *out)
{
	struct picture *picture = calloc(1, sizeof *picture);
	if (!picture)
		return GZ_ERR_NO_MEM;
	uint64_t span_ns = (uint64_t)last_ns - (uint64_t)first_ns;
	picture->first_ns = first_ns;
	picture->span_ns = span_ns == 0 || span_ns > INT64_MAX ? 1 : (int64_t)span_ns;
	picture->broken = true;
	gz_log_pipeline_init(&picture->pipeline, gz_gaze_log_header(reader), log);
	enum gz_result result = trace_records(picture, reader);
	if (result == GZ_OK)
		draw_recording(picture, name, out);
	free(picture);
	return result;
}
