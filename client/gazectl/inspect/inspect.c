/* gazectl inspect: the content of a gaze log, as a table, as JSON and as a picture. */
#include "client/gazectl/gazectl.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/utf8.h"
#include "client/gazectl/inspect/log_picture.h"
#include "client/gazectl/inspect/log_summary.h"
#include "client/gazectl/output.h"

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
	  .help = "draw the path of the gaze and the fixations into this file (.svg)" },
	{ .key = "force",
	  .type = GZ_OPTION_BOOL,
	  .offset = offsetof(struct inspect_settings, force),
	  .preset = "false",
	  .help = "replace an existing picture" },
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

static void print_log_header(const struct gz_gaze_log_header *header)
{
	printf("tracker      %s%s%s\n", header->tracker[0] ? header->tracker : "unknown",
	       header->serial[0] ? " " : "", header->serial);
	if (header->started[0] || header->software[0])
		printf("recorded     %s%sby %s\n", header->started, header->started[0] ? " " : "",
		       header->software[0] ? header->software : "unknown software");
	if (header->has_display)
		printf("display      %dx%d px, %gx%g mm, %g mm away\n", header->display.px[0],
		       header->display.px[1], header->display.mm[0], header->display.mm[1],
		       header->display.distance_mm);
	else
		printf("display      unknown: angles assume a width of 50.4 deg\n");
}

static const char *ending_text(enum gz_gaze_log_ending ending)
{
	switch (ending) {
	case GZ_GAZE_LOG_WHOLE:
		return "whole: sample count and checksum are correct";
	case GZ_GAZE_LOG_CUT:
		return "cut: the end is missing, the part before it is valid";
	case GZ_GAZE_LOG_CORRUPTED:
		return "corrupted: sample count or checksum is wrong, the file was changed";
	case GZ_GAZE_LOG_UNREAD:
		break;
	}
	return "unread";
}

static void print_extent(const struct gz_log_summary *summary, double nominal_hz)
{
	printf("file         %s\n", ending_text(summary->ending));
	if (summary->malformed)
		printf("malformed    %" PRIu64 " lines, skipped\n", summary->malformed);
	printf("duration     %.3f s\n", summary->duration_s);
	printf("samples      %" PRIu64 "\n", summary->samples);
	if (summary->samples == 0)
		return;
	printf("rate         %.2f Hz", summary->rate_hz);
	if (nominal_hz > 0)
		printf(" (%g Hz nominal)", nominal_hz);
	printf("\ngaps         %" PRIu64 ", with %" PRIu64 " samples missing (%.3f %%)\n",
	       summary->gaps, summary->missing,
	       percent(summary->missing, summary->samples + summary->missing));
}

static void print_eye_validity(const char *name, const struct gz_log_summary *summary,
			       enum gz_eye eye)
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
		print_eye_validity("right eye", summary, GZ_EYE_RIGHT);
		print_eye_validity("left eye", summary, GZ_EYE_LEFT);
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

/* Print a line for each bin, with a bar whose length is its share of the largest. */
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

/* Print the position of the viewer's window, if the log has one. */
static void print_viewer_window(const struct gz_log_summary *summary)
{
	const int *px = summary->window_px;
	if (summary->windows > 0)
		printf("window       %dx%d px at %d, %d, the last of %" PRIu64 " positions\n",
		       px[2], px[3], px[0], px[1], summary->windows);
}

static void print_marks(struct gz_log_summary *summary)
{
	printf("marks        %" PRIu64 "\n", summary->mark_count);
	for (size_t i = 0; i < summary->mark_count && i < GZ_LOG_SUMMARY_MARKS; i++) {
		struct gz_log_summary_mark *mark = &summary->marks[i];
		gz_utf8_clean(mark->text);
		printf("  %12.3f s %s\n", gz_ns_to_s(mark->host_ns) - gz_ns_to_s(summary->first_ns),
		       mark->text);
	}
	if (summary->mark_count > GZ_LOG_SUMMARY_MARKS)
		printf("  … and %" PRIu64 " more\n", summary->mark_count - GZ_LOG_SUMMARY_MARKS);
}

/* The settings of the pipeline, as texts. */
static json_t *json_settings(const struct gz_gaze_log_header *header)
{
	json_t *settings = json_object();
	for (size_t i = 0; i < header->setting_count; i++) {
		json_t *key = gz_output_json_text(header->settings[i].key);
		json_object_set_new(settings, json_string_value(key),
				    gz_output_json_text(header->settings[i].value));
		json_decref(key);
	}
	return settings;
}

static json_t *json_header(const struct gz_gaze_log_header *header)
{
	json_t *json = json_pack("{so so so}", "tracker",
				 gz_output_json_tracker(header->tracker, header->serial), "started",
				 gz_output_json_text(header->started), "software",
				 gz_output_json_text(header->software));
	if (header->has_display)
		json_object_set_new(json, "display", gz_output_json_display(&header->display));
	json_object_set_new(json, "pipeline", json_settings(header));
	return json;
}

static json_t *json_extent(const struct gz_log_summary *summary, double nominal_hz)
{
	return json_pack("{ss so so so so so so}", "ending", ending_name(summary->ending),
			 "malformed", gz_output_json_count(summary->malformed), "duration_s",
			 gz_output_json_number(summary->duration_s), "samples",
			 gz_output_json_count(summary->samples), "rate_hz",
			 gz_output_json_rate(nominal_hz, summary->rate_hz), "gaps",
			 gz_output_json_count(summary->gaps), "missing",
			 gz_output_json_count(summary->missing));
}

static json_t *json_eye(const struct gz_log_summary *summary, enum gz_eye eye)
{
	double fraction = percent(summary->eye_valid[eye], summary->samples) / 100;
	return gz_output_json_number(summary->eye_measured[eye] ? fraction : NAN);
}

static json_t *json_log_quality(const struct gz_log_summary *summary)
{
	json_t *rejected = json_object();
	for (int i = GZ_REJECT_NONE + 1; i < GZ_REJECT_COUNT; i++)
		json_object_set_new(rejected, gz_rejection_name((enum gz_rejection)i),
				    gz_output_json_count(summary->rejected[i]));
	return json_pack("{s{so so so} so so so so so}", "valid_fraction", "gaze",
			 gz_output_json_number(percent(summary->valid, summary->samples) / 100),
			 "eye0", json_eye(summary, GZ_EYE_RIGHT), "eye1",
			 json_eye(summary, GZ_EYE_LEFT), "noise_deg",
			 gz_output_json_number(summary->noise_deg), "fixations",
			 gz_output_json_count(summary->fixations), "saccades",
			 gz_output_json_count(summary->saccades), "blinks",
			 gz_output_json_count(summary->blinks), "rejected", rejected);
}

static json_t *json_intervals(const struct gz_log_intervals *intervals)
{
	json_t *histogram = json_array();
	for (int i = 0; i < GZ_LOG_SUMMARY_BINS; i++) {
		bool open = i == GZ_LOG_SUMMARY_BINS - 1;
		json_array_append_new(
			histogram,
			json_pack("{so so}", "below_medians",
				  gz_output_json_number(open ? NAN : gz_log_summary_bin_ends[i]),
				  "count", gz_output_json_count(intervals->bins[i])));
	}
	return json_pack("{so so sI sI sI sI so}", "count", gz_output_json_count(intervals->count),
			 "backward", gz_output_json_count(intervals->backward), "min_ns",
			 (json_int_t)intervals->min_ns, "median_ns",
			 (json_int_t)intervals->median_ns, "p99_ns", (json_int_t)intervals->p99_ns,
			 "max_ns", (json_int_t)intervals->max_ns, "histogram", histogram);
}

static json_t *json_events(const struct gz_log_summary *summary)
{
	const int *px = summary->window_px;
	json_t *json = json_pack("{so so}", "intervals", json_intervals(&summary->intervals),
				 "window_count", gz_output_json_count(summary->windows));
	if (summary->windows > 0)
		json_object_set_new(json, "window_px",
				    json_pack("[iiii]", px[0], px[1], px[2], px[3]));
	json_object_set_new(json, "mark_count", gz_output_json_count(summary->mark_count));
	json_t *marks = json_array();
	for (size_t i = 0; i < summary->mark_count && i < GZ_LOG_SUMMARY_MARKS; i++)
		json_array_append_new(marks,
				      json_pack("{sI so}", "host_ns",
						(json_int_t)summary->marks[i].host_ns, "text",
						gz_output_json_text(summary->marks[i].text)));
	json_object_set_new(json, "marks", marks);
	return json;
}

/* One object with the members of all parts. */
static json_t *json_log(const struct gz_gaze_log_header *header,
			const struct gz_log_summary *summary)
{
	json_t *json = json_header(header);
	enum { PARTS = 3 };
	json_t *const parts[PARTS] = { json_extent(summary, header->rate_hz),
				       json_log_quality(summary), json_events(summary) };
	bool complete = json != NULL;
	for (size_t i = 0; i < PARTS; i++) {
		complete = json_object_update(json, parts[i]) == 0 && complete;
		json_decref(parts[i]);
	}
	if (complete)
		return json;
	json_decref(json);
	return NULL;
}

static void print_log_table(const struct gz_gaze_log_header *header, struct gz_log_summary *summary)
{
	struct gz_gaze_log_header printable = *header;
	gz_utf8_clean(printable.tracker);
	gz_utf8_clean(printable.serial);
	gz_utf8_clean(printable.started);
	gz_utf8_clean(printable.software);
	print_log_header(&printable);
	print_extent(summary, header->rate_hz);
	print_quality(summary);
	print_intervals(&summary->intervals);
	print_viewer_window(summary);
	print_marks(summary);
}

static enum gz_result draw_picture_of(const char *path, const struct gz_log_summary *summary,
				      FILE *out)
{
	struct gz_gaze_log_reader *reader = NULL;
	const char *slash = strrchr(path, '/');
	/* Without a log: the first reading has already reported what is wrong with the file. */
	enum gz_result result = gz_gaze_log_open(path, NULL, &reader);
	if (result == GZ_OK)
		result = gz_log_picture(reader, slash ? slash + 1 : path, summary->first_ns,
					summary->last_ns, NULL, out);
	gz_gaze_log_close(&reader);
	return result;
}

static enum gz_result write_log_picture(const struct inspect_settings *settings, const char *path,
					const struct gz_log_summary *summary,
					const struct gz_log *log)
{
	struct gz_output_file file;
	enum gz_result result =
		gz_output_begin(&file, settings->picture, settings->force, GZ_OUTPUT_TEXT, log);
	if (result != GZ_OK)
		return result;
	result = draw_picture_of(path, summary, file.text);
	if (result != GZ_OK)
		gz_err(log, "cannot draw %s: %s", path, gz_result_text(result));
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
		gz_err(log, "%s cannot be read to its end: %s", path, gz_result_text(result));
	} else {
		if (settings->json)
			result = gz_output_json_print(json_log(gz_gaze_log_header(reader), summary),
						      stdout, log);
		else
			print_log_table(gz_gaze_log_header(reader), summary);
		if (result == GZ_OK)
			status = summary->ending == GZ_GAZE_LOG_WHOLE ? GAZECTL_DONE
								      : GAZECTL_DAMAGED;
		if (settings->picture[0] &&
		    write_log_picture(settings, path, summary, log) != GZ_OK)
			status = GAZECTL_FAILED;
	}
	free(summary);
	return status;
}

static int inspect_run(int argc, char *const *argv, const struct gz_log *log)
{
	struct inspect_settings settings;
	struct gz_operands operands;
	int status =
		gz_command_read_arguments(&gazectl_inspect, argc, argv, log, &settings, &operands);
	if (status != GZ_COMMAND_GO_ON)
		return status;
	if (operands.count == 0) {
		gz_err(log, "no file given: gazectl inspect FILE.gzl");
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
	.summary = "print the content of a gaze log",
	.details = "Prints length, rate, gaps, validity of each eye, noise, events, intervals and "
		   "marks. A log that\nwas cut or changed is printed too, with a remark and exit "
		   "status 4.\n",
	.options = inspect_options,
	.option_count = sizeof inspect_options / sizeof inspect_options[0],
	.run = inspect_run,
};
