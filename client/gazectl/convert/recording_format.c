#include "client/gazectl/convert/recording_format.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "client/gazectl/output.h"
#include "protocol/gaze_log.h"

#define GZ_LOG_MODULE "gzl"

const struct gz_recording_reader *const gz_recording_readers[] = {
	&gz_recording_reader_pupil,
	&gz_recording_reader_eyelink,
	&gz_recording_reader_tobii,
	&gz_recording_reader_smi,
	&gz_recording_reader_arff,
	&gz_recording_reader_table,
	NULL,
};

const struct gz_recording_writer *const gz_recording_writers[] = {
	&gz_recording_writer_gzl,
	&gz_recording_writer_bids,
	&gz_recording_writer_csv,
	NULL,
};

const struct gz_recording_reader *gz_recording_reader_find(const char *name)
{
	for (size_t i = 0; gz_recording_readers[i]; i++)
		if (strcmp(gz_recording_readers[i]->name, name) == 0)
			return gz_recording_readers[i];
	return NULL;
}

const struct gz_recording_reader *gz_recording_reader_recognise(const char *line)
{
	for (size_t i = 0; gz_recording_readers[i]; i++)
		if (gz_recording_readers[i]->recognises(line))
			return gz_recording_readers[i];
	return NULL;
}

const struct gz_recording_writer *gz_recording_writer_find(const char *name)
{
	for (size_t i = 0; gz_recording_writers[i]; i++)
		if (strcmp(gz_recording_writers[i]->name, name) == 0)
			return gz_recording_writers[i];
	return NULL;
}

const struct gz_recording_writer *gz_recording_writer_of(const char *path)
{
	size_t length = strlen(path);
	for (size_t i = 0; gz_recording_writers[i]; i++) {
		size_t ending = strlen(gz_recording_writers[i]->ending);
		if (length > ending &&
		    strcmp(path + length - ending, gz_recording_writers[i]->ending) == 0)
			return gz_recording_writers[i];
	}
	return NULL;
}

struct gz_gaze_log_header gz_recording_header(const struct gz_convert_settings *settings,
					      const char *tracker)
{
	struct gz_gaze_log_header header = { .rate_hz = settings->rate_hz };
	gz_text_copy(header.tracker, sizeof header.tracker, tracker);
	snprintf(header.software, sizeof header.software, "gazectl %s", GAZECAST_VERSION);
	memcpy(header.display.px, settings->display_px, sizeof header.display.px);
	memcpy(header.display.mm, settings->display_mm, sizeof header.display.mm);
	header.display.distance_mm = settings->distance_mm;
	header.has_display = gz_display_valid(&header.display);
	if (!header.has_display)
		header.display = (struct gz_display) { 0 };
	return header;
}

struct gz_point gz_recording_point(double x, double y)
{
	if (!(fabs(x) <= 1000) || !(fabs(y) <= 1000))
		return (struct gz_point) { NAN, NAN };
	return (struct gz_point) { (float)x, (float)y };
}

/* The writer of gaze logs. */

struct gz_recording_output {
	const struct gz_log *log;
	bool overwrite;
	bool begun;
	char path[GZ_PATH_SIZE];
	struct gz_output_file file;
	struct gz_gaze_log_writer writer;
};

static enum gz_result report_write_failure(const struct gz_recording_output *output,
					   enum gz_result result)
{
	if (result == GZ_OK)
		return GZ_OK;
	gz_err(output->log, "cannot write %s: %s", output->path, strerror(errno));
	return GZ_ERR_IO;
}

static enum gz_result gzl_begin(void *user, const struct gz_gaze_log_header *header)
{
	struct gz_recording_output *output = user;
	enum gz_result result = gz_output_begin(&output->file, output->path, output->overwrite,
						GZ_OUTPUT_RAW, output->log);
	if (result != GZ_OK)
		return result;
	output->begun = true;
	return report_write_failure(
		output, gz_gaze_log_writer_begin(&output->writer, output->file.fd, header));
}

static enum gz_result gzl_add(void *user, const struct gz_gaze_log_record *record)
{
	struct gz_recording_output *output = user;
	return report_write_failure(output, gz_gaze_log_writer_add(&output->writer, record));
}

static enum gz_result gzl_open(const char *path, bool overwrite, const struct gz_log *log,
			       struct gz_recording_sink *out_sink)
{
	struct gz_recording_output *output = calloc(1, sizeof *output);
	if (!output)
		return GZ_ERR_NO_MEM;
	output->log = log;
	output->overwrite = overwrite;
	strncpy(output->path, path, sizeof output->path - 1);
	out_sink->user = output;
	out_sink->header = gzl_begin;
	out_sink->record = gzl_add;
	return GZ_OK;
}

static enum gz_result gzl_close(struct gz_recording_sink *sink, bool complete)
{
	struct gz_recording_output *output = sink->user;
	enum gz_result result = GZ_OK;
	if (complete && output->begun)
		result = report_write_failure(output, gz_gaze_log_writer_end(&output->writer));
	enum gz_result ended =
		gz_output_end(&output->file, complete && result == GZ_OK, output->log);
	free(output);
	sink->user = NULL;
	return result != GZ_OK ? result : ended;
}

const struct gz_recording_writer gz_recording_writer_gzl = {
	.name = "gzl",
	.ending = ".gzl",
	.help = "gaze log, as gazed records it and replays it",
	.open = gzl_open,
	.close = gzl_close,
};
