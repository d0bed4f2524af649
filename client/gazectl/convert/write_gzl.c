/* Writes a gaze log. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "client/gazectl/convert/recording_format.h"
#include "client/gazectl/output_file.h"
#include "protocol/gaze_log_writer.h"

#define GZ_LOG_MODULE "gzl"

struct gz_recording_output {
	const struct gz_log *log;
	bool overwrite;
	bool begun;
	char path[GZ_PATH_SIZE];
	struct gz_output_file file;
	struct gz_gaze_log_writer writer;
};

static enum gz_result report(const struct gz_recording_output *output, enum gz_result result)
{
	if (result == GZ_OK)
		return GZ_OK;
	gz_err(output->log, "cannot write %s: %s", output->path, strerror(errno));
	return GZ_ERR_IO;
}

static enum gz_result begin(void *user, const struct gz_gaze_log_header *header)
{
	struct gz_recording_output *output = user;
	enum gz_result result = gz_output_begin(&output->file, output->path, output->overwrite,
						GZ_OUTPUT_RAW, output->log);
	if (result != GZ_OK)
		return result;
	output->begun = true;
	return report(output, gz_gaze_log_writer_begin(&output->writer, output->file.fd, header));
}

static enum gz_result add(void *user, const struct gz_gaze_log_record *record)
{
	struct gz_recording_output *output = user;
	return report(output, gz_gaze_log_writer_add(&output->writer, record));
}

static enum gz_result open_gzl(const char *path, bool overwrite, const struct gz_log *log,
			       struct gz_recording_sink *out_sink)
{
	struct gz_recording_output *output = calloc(1, sizeof *output);
	if (!output)
		return GZ_ERR_NO_MEM;
	output->log = log;
	output->overwrite = overwrite;
	strncpy(output->path, path, sizeof output->path - 1);
	out_sink->user = output;
	out_sink->header = begin;
	out_sink->record = add;
	return GZ_OK;
}

static enum gz_result close_gzl(struct gz_recording_sink *sink, bool complete)
{
	struct gz_recording_output *output = sink->user;
	enum gz_result result = GZ_OK;
	if (complete && output->begun)
		result = report(output, gz_gaze_log_writer_end(&output->writer));
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
	.open = open_gzl,
	.close = close_gzl,
};
