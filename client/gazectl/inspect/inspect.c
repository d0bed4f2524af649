/* gazectl inspect: what a gaze log holds, as a table or as JSON. */
#include "client/gazectl/gazectl.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "client/gazectl/inspect/log_picture.h"
#include "client/gazectl/inspect/log_summary.h"
#include "client/gazectl/output_file.h"

#define GZ_LOG_MODULE "gazectl"

struct inspect_settings {
	struct gz_command_common common;
	bool json;
	bool force;
	char picture[GZ_PATH_SIZE];
};

static const struct gz_option inspect_options[] = {
	GZ_COMMAND_HELP_OPTION,
	{ .key = "json",
	  .type = GZ_OPTION_BOOL,
	  .offset = offsetof(struct inspect_settings, json),
	  .preset = "false",
	  .help = "print JSON" },
	{ .key = "picture",
	  .type = GZ_OPTION_STRING,
	  .offset = offsetof(struct inspect_settings, picture),
	  .max = GZ_PATH_SIZE,
	  .preset = "",
	  .help = "draw the path and the fixations into this file (.svg)" },
	{ .key = "force",
	  .type = GZ_OPTION_BOOL,
	  .offset = offsetof(struct inspect_settings, force),
	  .preset = "false",
	  .help = "replace a picture that is there" },
};

static const char *ending_name(enum gz_gaze_log_ending ending)
{
	switch (ending) {
	case GZ_GAZE_LOG_WHOLE:
		return "whole";
	case GZ_GAZE_LOG_CUT:
		return "cut";
	case GZ_GAZE_LOG_CORRUPTED:
		return "corrupted";
	case GZ_GAZE_LOG_UNREAD:
		break;
	}
	return "unread";
}

static double percent(uint64_t part, uint64_t whole)
{
	return whole ? 100 * (double)part / (double)whole : NAN;
}

static void print_header(const struct gz_gaze_log_header *header)
{
	printf("tracker      %s%s%s\n", header->tracker, header->serial[0] ? " " : "",
	       header->serial);
	printf("recorded     %s%sby %s\n", header->started, header->started[0] ? " " : "",
	       header->software);
	if (header->has_display)
		printf("display      %dx%d px, %gx%g mm, %g mm away\n", header->display.px[0],
		       header->display.px[1], header->display.mm[0], header->display.mm[1],
		       header->display.distance_mm);
	else
		printf("display      unknown: angles assume one 50.4 deg wide\n");
}

static const char *ending_text(enum gz_gaze_log_ending ending)
{
	switch (ending) {
	case GZ_GAZE_LOG_WHOLE:
		return "whole: count and checksum are right";
	case GZ_GAZE_LOG_CUT:
		return "cut: its end is missing, what stands before it is good";
	case GZ_GAZE_LOG_CORRUPTED:
		return "corrupted: count or checksum is wrong, something was changed";
	case GZ_GAZE_LOG_UNREAD:
		break;
	}
	return "unread";
}

static void print_extent(const struct gz_log_summary *summary, double nominal_hz)
{
	printf("file         %s\n", ending_text(summary->ending));
	if (summary->malformed)
		printf("malformed    %" PRIu64 " lines, left out\n", summary->malformed);
	printf("duration     %.3f s\n", summary->duration_s);
	printf("samples      %" PRIu64 "\n", summary->samples);
	printf("rate         %.2f Hz", summary->rate_hz);
	if (nominal_hz > 0)
		printf(" (%g Hz nominal)", nominal_hz);
	printf("\ngaps         %" PRIu64 ", with %" PRIu64 " samples missing (%.3f %%)\n",
	       summary->gaps, summary->missing,
	       percent(summary->missing, summary->samples + summary->missing));
}

static void print_eye(const char *name, const struct gz_log_summary *summary, enum gz_eye eye)
{
	if (summary->eye_measured[eye])
		printf(", %s %.2f %%", name, percent(summary->eye_valid[eye], summary->samples));
	else
		printf(", %s not measured", name);
}

static void print_quality(const struct gz_log_summary *summary)
{
	if (summary->samples > 0) {
		printf("valid        %.2f %%", percent(summary->valid, summary->samples));
		print_eye("right eye", summary, GZ_EYE_RIGHT);
		print_eye("left eye", summary, GZ_EYE_LEFT);
		putchar('\n');
	}
	if (isfinite(summary->noise_deg))
		printf("noise        %.4f deg RMS from sample to sample within fixations\n",
		       summary->noise_deg);
	else
		printf("noise        unknown: no fixation\n");
	printf("events       %" PRIu64 " fixations, %" PRIu64 " saccades, %" PRIu64 " blinks\n",
	       summary->fixations, summary->saccades, summary->blinks);
	uint64_t rejected = 0;
	for (int i = GZ_REJECT_NONE + 1; i < GZ_REJECT_COUNT; i++)
		rejected += summary->rejected[i];
	printf("rejected     %" PRIu64, rejected);
	const char *separator = " (";
	for (int i = GZ_REJECT_NONE + 1; i < GZ_REJECT_COUNT; i++) {
		if (summary->rejected[i] == 0)
			continue;
		printf("%s%s %" PRIu64, separator, gz_rejection_name((enum gz_rejection)i),
		       summary->rejected[i]);
		separator = ", ";
	}
	puts(rejected ? ")" : "");
}

/* One line a bin, with a bar whose length is its share of the fullest. */
static void print_histogram(const struct gz_log_intervals *intervals)
{
	static const char bar[] = "########################################";
	uint64_t fullest = 1;
	for (int i = 0; i < GZ_LOG_SUMMARY_BINS; i++)
		if (intervals->bins[i] > fullest)
			fullest = intervals->bins[i];
	double median_ms = gz_ns_to_ms(intervals->median_ns);
	for (int i = 0; i < GZ_LOG_SUMMARY_BINS; i++) {
		double low_ms = i > 0 ? gz_log_summary_bin_ends[i - 1] * median_ms : 0;
		double width = (double)(sizeof bar - 1) * (double)intervals->bins[i];
		int length = (int)ceil(width / (double)fullest);
		if (i < GZ_LOG_SUMMARY_BINS - 1)
			printf("  %8.3f to %8.3f ms", low_ms,
			       gz_log_summary_bin_ends[i] * median_ms);
		else
			printf("  %8.3f ms and more ", low_ms);
		printf(" %9" PRIu64 " %.*s\n", intervals->bins[i], length, bar);
	}
}

static void print_intervals(const struct gz_log_intervals *intervals)
{
	if (intervals->backward)
		printf("backward     %" PRIu64 " samples are not later than the one before\n",
		       intervals->backward);
	if (intervals->count == 0)
		return;
	printf("intervals    %.3f ms median, %.3f to %.3f ms, 99 %% up to %.3f ms\n",
	       gz_ns_to_ms(intervals->median_ns), gz_ns_to_ms(intervals->min_ns),
	       gz_ns_to_ms(intervals->max_ns), gz_ns_to_ms(intervals->p99_ns));
	print_histogram(intervals);
}

/* Where the viewer's window was; nothing where no viewer told. */
static void print_window(const struct gz_log_summary *summary)
{
	const int *px = summary->window_px;
	if (summary->windows > 0)
		printf("window       %dx%d px at %d, %d at last, of %" PRIu64 " places\n", px[2],
		       px[3], px[0], px[1], summary->windows);
}

static void print_marks(struct gz_log_summary *summary)
{
	printf("marks        %" PRIu64 "\n", summary->mark_count);
	for (size_t i = 0; i < summary->mark_count && i < GZ_LOG_SUMMARY_MARKS; i++) {
		struct gz_log_summary_mark *mark = &summary->marks[i];
		gazectl_make_printable(mark->text);
		printf("  %12.3f s %s\n", gz_ns_to_s(mark->host_ns) - gz_ns_to_s(summary->first_ns),
		       mark->text);
	}
	if (summary->mark_count > GZ_LOG_SUMMARY_MARKS)
		printf("  … and %" PRIu64 " more\n", summary->mark_count - GZ_LOG_SUMMARY_MARKS);
}

static void print_json_header(struct gz_json *json, const struct gz_gaze_log_header *header)
{
	gz_json_begin(json, "tracker");
	gz_json_text(json, "name", header->tracker);
	gz_json_text(json, "serial", header->serial);
	gz_json_end(json);
	gz_json_text(json, "started", header->started);
	gz_json_text(json, "software", header->software);
	if (header->has_display)
		gz_json_display(json, "display", &header->display);
	gz_json_begin(json, "pipeline");
	for (size_t i = 0; i < header->setting_count; i++)
		gz_json_text(json, header->settings[i].key, header->settings[i].value);
	gz_json_end(json);
}

static void print_json_extent(struct gz_json *json, const struct gz_log_summary *summary,
			      double nominal_hz)
{
	gz_json_text(json, "ending", ending_name(summary->ending));
	gz_json_uint(json, "malformed", summary->malformed);
	gz_json_double(json, "duration_s", summary->duration_s);
	gz_json_uint(json, "samples", summary->samples);
	gz_json_begin(json, "rate_hz");
	gz_json_double(json, "nominal", nominal_hz);
	gz_json_double(json, "measured", summary->rate_hz);
	gz_json_end(json);
	gz_json_uint(json, "gaps", summary->gaps);
	gz_json_uint(json, "missing", summary->missing);
}

static void print_json_eye(struct gz_json *json, const char *name,
			   const struct gz_log_summary *summary, enum gz_eye eye)
{
	double fraction = percent(summary->eye_valid[eye], summary->samples) / 100;
	gz_json_double(json, name, summary->eye_measured[eye] ? fraction : NAN);
}

static void print_json_quality(struct gz_json *json, const struct gz_log_summary *summary)
{
	gz_json_begin(json, "valid_fraction");
	gz_json_double(json, "gaze", percent(summary->valid, summary->samples) / 100);
	print_json_eye(json, "eye0", summary, GZ_EYE_RIGHT);
	print_json_eye(json, "eye1", summary, GZ_EYE_LEFT);
	gz_json_end(json);
	gz_json_double(json, "noise_deg", summary->noise_deg);
	gz_json_uint(json, "fixations", summary->fixations);
	gz_json_uint(json, "saccades", summary->saccades);
	gz_json_uint(json, "blinks", summary->blinks);
	gz_json_begin(json, "rejected");
	for (int i = GZ_REJECT_NONE + 1; i < GZ_REJECT_COUNT; i++)
		gz_json_uint(json, gz_rejection_name((enum gz_rejection)i), summary->rejected[i]);
	gz_json_end(json);
}

static void print_json_intervals(struct gz_json *json, const struct gz_log_intervals *intervals)
{
	gz_json_begin(json, "intervals");
	gz_json_uint(json, "count", intervals->count);
	gz_json_uint(json, "backward", intervals->backward);
	gz_json_int(json, "min_ns", intervals->min_ns);
	gz_json_int(json, "median_ns", intervals->median_ns);
	gz_json_int(json, "p99_ns", intervals->p99_ns);
	gz_json_int(json, "max_ns", intervals->max_ns);
	gz_json_begin_list(json, "histogram");
	for (int i = 0; i < GZ_LOG_SUMMARY_BINS; i++) {
		bool open = i == GZ_LOG_SUMMARY_BINS - 1;
		gz_json_begin(json, NULL);
		gz_json_double(json, "below_medians", open ? NAN : gz_log_summary_bin_ends[i]);
		gz_json_uint(json, "count", intervals->bins[i]);
		gz_json_end(json);
	}
	gz_json_end_list(json);
	gz_json_end(json);
}

static void print_json_window(struct gz_json *json, const struct gz_log_summary *summary)
{
	gz_json_uint(json, "window_count", summary->windows);
	if (summary->windows == 0)
		return;
	gz_json_begin_list(json, "window_px");
	for (int i = 0; i < 4; i++)
		gz_json_int(json, NULL, summary->window_px[i]);
	gz_json_end_list(json);
}

static void print_json_marks(struct gz_json *json, const struct gz_log_summary *summary)
{
	gz_json_uint(json, "mark_count", summary->mark_count);
	gz_json_begin_list(json, "marks");
	for (size_t i = 0; i < summary->mark_count && i < GZ_LOG_SUMMARY_MARKS; i++) {
		gz_json_begin(json, NULL);
		gz_json_int(json, "host_ns", summary->marks[i].host_ns);
		gz_json_text(json, "text", summary->marks[i].text);
		gz_json_end(json);
	}
	gz_json_end_list(json);
}

static void print_json(const struct gz_gaze_log_header *header,
		       const struct gz_log_summary *summary)
{
	struct gz_json json = { .out = stdout };
	gz_json_begin(&json, NULL);
	print_json_header(&json, header);
	print_json_extent(&json, summary, header->rate_hz);
	print_json_quality(&json, summary);
	print_json_intervals(&json, &summary->intervals);
	print_json_window(&json, summary);
	print_json_marks(&json, summary);
	gz_json_end(&json);
}

static void print_table(const struct gz_gaze_log_header *header, struct gz_log_summary *summary)
{
	struct gz_gaze_log_header printable = *header;
	gazectl_make_printable(printable.tracker);
	gazectl_make_printable(printable.serial);
	gazectl_make_printable(printable.started);
	gazectl_make_printable(printable.software);
	print_header(&printable);
	print_extent(summary, header->rate_hz);
	print_quality(summary);
	print_intervals(&summary->intervals);
	print_window(summary);
	print_marks(summary);
}

static enum gz_result draw(const char *path, const struct gz_log_summary *summary, FILE *out)
{
	struct gz_gaze_log_reader *reader = NULL;
	const char *slash = strrchr(path, '/');
	/* The first reading has said all there is to say of it. */
	enum gz_result result = gz_gaze_log_open(path, NULL, &reader);
	if (result == GZ_OK)
		result = gz_log_picture(reader, slash ? slash + 1 : path, summary->first_ns,
					summary->last_ns, NULL, out);
	gz_gaze_log_close(&reader);
	return result;
}

static enum gz_result write_picture(const struct inspect_settings *settings, const char *path,
				    const struct gz_log_summary *summary, const struct gz_log *log)
{
	struct gz_output_file file;
	enum gz_result result =
		gz_output_begin(&file, settings->picture, settings->force, GZ_OUTPUT_TEXT, log);
	if (result != GZ_OK)
		return result;
	result = draw(path, summary, file.text);
	if (result != GZ_OK)
		gz_err(log, "no picture of %s: %s", path, gz_result_text(result));
	enum gz_result ended = gz_output_end(&file, result == GZ_OK, log);
	return result == GZ_OK ? ended : result;
}

static enum gazectl_exit inspect(struct gz_gaze_log_reader *reader, const char *path,
				 const struct inspect_settings *settings, const struct gz_log *log)
{
	struct gz_log_summary *summary = malloc(sizeof *summary);
	enum gz_result result = summary ? gz_log_summarize(reader, log, summary) : GZ_ERR_NO_MEM;
	enum gazectl_exit status = GAZECTL_FAILED;
	if (result != GZ_OK) {
		gz_err(log, "the log cannot be read to its end: %s", gz_result_text(result));
	} else {
		if (settings->json)
			print_json(gz_gaze_log_header(reader), summary);
		else
			print_table(gz_gaze_log_header(reader), summary);
		status = summary->ending == GZ_GAZE_LOG_WHOLE ? GAZECTL_DONE : GAZECTL_DAMAGED;
		if (settings->picture[0] && write_picture(settings, path, summary, log) != GZ_OK)
			status = GAZECTL_FAILED;
	}
	free(summary);
	return status;
}

static int run(int argc, char *const *argv, const struct gz_log *log)
{
	struct inspect_settings settings;
	struct gz_operands operands;
	int status;
	if (!gz_command_read_arguments(&gazectl_inspect, argc, argv, log, &settings, &operands,
				       &status))
		return status;
	if (operands.count == 0) {
		gz_err(log, "which file? Name a .gzl: gazectl inspect FILE");
		return GAZECTL_USAGE;
	}
	if (gz_output_check_svg(settings.picture, log) != GZ_OK)
		return GAZECTL_USAGE;
	struct gz_gaze_log_reader *reader = NULL;
	if (gz_gaze_log_open(operands.items[0], log, &reader) != GZ_OK)
		return GAZECTL_FAILED;
	status = inspect(reader, operands.items[0], &settings, log);
	gz_gaze_log_close(&reader);
	return status;
}

const struct gz_command gazectl_inspect = {
	.program = "gazectl",
	.name = "inspect",
	.operands = "FILE",
	.operands_max = 1,
	.summary = "print what a gaze log holds",
	.details = "Length, rate, gaps, validity of each eye, noise, events, intervals and marks; "
		   "also of a\nlog that was cut or changed, which it says, with exit status 4.\n",
	.options = inspect_options,
	.option_count = sizeof inspect_options / sizeof inspect_options[0],
	.run = run,
};
