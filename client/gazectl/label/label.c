/* gazectl label: what the eye did in a gaze log, with the whole recording in view. */
#include "client/gazectl/gazectl.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "base/text.h"
#include "client/gazectl/label/label_recording.h"
#include "client/gazectl/output.h"

#define GZ_LOG_MODULE "gazectl"

struct label_settings {
	struct gz_command_common common;
	bool force;
	char out[GZ_PATH_SIZE];
};

static const struct gz_option label_options[] = {
	GZ_COMMAND_HELP_OPTION,
	{ .key = "out",
	  .type = GZ_OPTION_STRING,
	  .offset = offsetof(struct label_settings, out),
	  .max = GZ_PATH_SIZE,
	  .preset = "",
	  .help = "write the table into this file; empty: to the standard output" },
	{ .key = "force",
	  .type = GZ_OPTION_BOOL,
	  .offset = offsetof(struct label_settings, force),
	  .preset = "false",
	  .help = "replace an existing file" },
};

/* Print a comma and a number; nothing behind the comma if it is not finite. */
static void write_label_number(FILE *out, double value)
{
	char text[32];
	fputc(',', out);
	if (!isfinite(value))
		return;
	snprintf(text, sizeof text, "%.6g", value);
	gz_number_normalise_point(text);
	fputs(text, out);
}

static void write_label_seconds(FILE *out, int64_t ns)
{
	fprintf(out, "%" PRId64 ".%09" PRId64, ns / GZ_NS_PER_S, ns % GZ_NS_PER_S);
}

static void write_intervals(FILE *out, const struct gz_offline_labels *labels)
{
	fputs("host_s,duration_s,label,samples,x,y,start_x,start_y,end_x,end_y,amplitude_deg,peak_"
	      "deg_s\n",
	      out);
	for (size_t i = 0; i < labels->interval_count; i++) {
		const struct gz_offline_interval *interval = &labels->interval[i];
		const struct gz_point points[] = { interval->mean, interval->start, interval->end };
		write_label_seconds(out, interval->start_ns);
		fputc(',', out);
		write_label_seconds(out, interval->end_ns - interval->start_ns);
		fprintf(out, ",%s,%" PRIu64, gz_offline_label_name(interval->label),
			interval->samples);
		for (size_t k = 0; k < sizeof points / sizeof points[0]; k++) {
			write_label_number(out, points[k].x);
			write_label_number(out, points[k].y);
		}
		write_label_number(out, interval->amplitude_deg);
		write_label_number(out, interval->peak_deg_s);
		fputc('\n', out);
	}
}

static enum gz_result read_records(struct gz_gaze_log_reader *reader,
				   struct gz_label_recording *recording)
{
	enum gz_result result = gz_label_take_header(recording, gz_gaze_log_header(reader));
	while (result == GZ_OK) {
		struct gz_gaze_log_record record;
		result = gz_gaze_log_read(reader, &record);
		if (result == GZ_ERR_FORMAT) /* logged; what follows is read */
			result = GZ_OK;
		else if (result == GZ_OK)
			result = gz_label_take_record(recording, &record);
	}
	return result == GZ_ERR_END ? GZ_OK : result;
}

static enum gz_result write_labels_of(const struct label_settings *settings,
				      const struct gz_offline_labels *labels,
				      const struct gz_log *log)
{
	struct gz_output_file file = { .open = false };
	if (!settings->out[0]) {
		write_intervals(stdout, labels);
		return GZ_OK;
	}
	enum gz_result result =
		gz_output_begin(&file, settings->out, settings->force, GZ_OUTPUT_TEXT, log);
	if (result != GZ_OK)
		return result;
	write_intervals(file.text, labels);
	return gz_output_end(&file, true, log);
}

static int label_run(int argc, char *const *argv, const struct gz_log *log)
{
	struct label_settings settings;
	struct gz_operands operands;
	int status =
		gz_command_read_arguments(&gazectl_label, argc, argv, log, &settings, &operands);
	if (status != GZ_COMMAND_GO_ON)
		return status;
	if (operands.count == 0) {
		gz_err(log, "no file given: gazectl label FILE.gzl");
		return GAZECTL_USAGE;
	}
	const char *path = operands.items[0];
	struct gz_gaze_log_reader *reader = NULL;
	if (gz_gaze_log_open(path, log, &reader) != GZ_OK)
		return GAZECTL_FAILED;
	struct gz_label_recording recording = { .name = path, .log = log };
	struct gz_offline_labels labels = { .count = 0 };
	enum gz_result result = read_records(reader, &recording);
	if (result == GZ_OK)
		result = gz_label_finish(&recording, &labels);
	if (result == GZ_OK)
		result = write_labels_of(&settings, &labels, log);
	const bool whole = gz_gaze_log_ending(reader) == GZ_GAZE_LOG_WHOLE;
	gz_offline_labels_free(&labels);
	gz_offline_destroy(&recording.offline);
	gz_gaze_log_close(&reader);
	if (result != GZ_OK)
		return GAZECTL_FAILED;
	return whole ? GAZECTL_DONE : GAZECTL_DAMAGED;
}

const struct gz_command gazectl_label = {
	.program = "gazectl",
	.name = "label",
	.operands = "FILE",
	.operands_max = 1,
	.summary = "tell what the eye did in a gaze log",
	.details =
		"Prints a table (.csv) of fixations, saccades, oscillations after saccades, "
		"pursuits, blinks and\nlosses. The whole recording is in view, so these labels "
		"are better than those of the stream.\nTimes are host times as in the log, points "
		"are fractions of the display: mean, start and end.\n",
	.options = label_options,
	.option_count = sizeof label_options / sizeof label_options[0],
	.run = label_run,
};
