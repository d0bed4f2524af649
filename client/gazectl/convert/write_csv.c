/* The writer of tables for spreadsheets and statistics: a line for each sample; gaps, marks and
 * window positions, if there are any, in a second file beside it. An empty field was not measured.
 */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/text.h"
#include "client/gazectl/convert/recording_format.h"
#include "client/gazectl/output.h"

#define GZ_LOG_MODULE "csv"

struct gz_recording_output {
	const struct gz_log *log;
	bool overwrite;
	char path[GZ_PATH_SIZE];
	struct gz_output_file samples;
	struct gz_output_file events;
	const struct gz_offline_labels *labels; /* NULL: none */
	size_t count;                           /* samples written */
};

static void write_float(FILE *out, float value)
{
	char text[32];
	fputc(',', out);
	if (!isfinite(value))
		return;
	snprintf(text, sizeof text, "%.9g", (double)value);
	gz_number_normalise_point(text);
	fputs(text, out);
}

/* Print nanoseconds as seconds with all digits. */
static void write_seconds(FILE *out, int64_t ns)
{
	uint64_t size = ns < 0 ? -(uint64_t)ns : (uint64_t)ns;
	fprintf(out, "%s%" PRIu64 ".%09" PRIu64, ns < 0 ? "-" : "", size / GZ_NS_PER_S,
		size % GZ_NS_PER_S);
}

static void write_csv_eye(FILE *out, const struct gz_eye_sample *eye)
{
	write_float(out, eye->point.x);
	write_float(out, eye->point.y);
	fprintf(out, ",%d", eye->valid);
	write_float(out, eye->confidence);
	write_float(out, eye->pupil_mm);
	for (int i = 0; i < 3; i++)
		write_float(out, eye->origin_mm[i]);
	for (int i = 0; i < 3; i++)
		write_float(out, eye->direction[i]);
}

static void write_csv_sample(struct gz_recording_output *output, const struct gz_sample *sample)
{
	FILE *out = output->samples.text;
	fprintf(out, "%" PRIu64 ",", sample->seq);
	write_seconds(out, sample->host_ns);
	fputc(',', out);
	if (sample->device_ns != GZ_NO_DEVICE_TIME)
		write_seconds(out, sample->device_ns);
	write_float(out, sample->point.x);
	write_float(out, sample->point.y);
	fprintf(out, ",%d", sample->valid);
	for (int eye = 0; eye < GZ_EYE_COUNT; eye++)
		write_csv_eye(out, &sample->eye[eye]);
	if (output->labels && output->count < output->labels->count)
		fprintf(out, ",%s",
			gz_offline_label_name(
				(enum gz_offline_label)output->labels->label[output->count]));
	output->count++;
	fputc('\n', out);
}

/* Print a field in quotes, quotes inside it doubled (RFC 4180). */
static void write_quoted(FILE *out, const char *text)
{
	fputc('"', out);
	for (; *text; text++) {
		if (*text == '"')
			fputc('"', out);
		fputc(*text, out);
	}
	fputc('"', out);
}

static enum gz_result check_csv_file(const struct gz_recording_output *output,
				     const struct gz_output_file *file)
{
	if (!ferror(file->text))
		return GZ_OK;
	gz_err(output->log, "cannot write %s; is the disk full?", file->path);
	return GZ_ERR_IO;
}

static enum gz_result csv_begin(void *user, const struct gz_gaze_log_header *header)
{
	struct gz_recording_output *output = user;
	const char *pupil = header->pupil_unit[0] ? "size" : "mm";
	enum gz_result result = gz_output_begin(&output->samples, output->path, output->overwrite,
						GZ_OUTPUT_TEXT, output->log);
	if (result != GZ_OK)
		return result;
	FILE *out = output->samples.text;
	fputs("seq,host_s,device_s,gaze_x,gaze_y,gaze_valid", out);
	for (int eye = 0; eye < GZ_EYE_COUNT; eye++)
		fprintf(out,
			",eye%d_x,eye%d_y,eye%d_valid,eye%d_confidence,eye%d_pupil_%s"
			",eye%d_origin_x_mm,eye%d_origin_y_mm,eye%d_origin_z_mm"
			",eye%d_dir_x,eye%d_dir_y,eye%d_dir_z",
			eye, eye, eye, eye, eye, pupil, eye, eye, eye, eye, eye, eye);
	if (output->labels)
		fputs(",label", out);
	fputc('\n', out);
	return check_csv_file(output, &output->samples);
}

/* The events of "NAME.csv" go into "NAME_events.csv". */
static enum gz_result begin_csv_events(struct gz_recording_output *output)
{
	char path[GZ_PATH_SIZE + 16];
	size_t stem = strlen(output->path) - strlen(".csv");
	snprintf(path, sizeof path, "%.*s_events.csv", (int)stem, output->path);
	enum gz_result result = gz_output_begin(&output->events, path, output->overwrite,
						GZ_OUTPUT_TEXT, output->log);
	if (result == GZ_OK)
		fputs("host_s,kind,text,duration_s,keys\n", output->events.text);
	return result;
}

static enum gz_result add_csv_event(struct gz_recording_output *output,
				    const struct gz_gaze_log_record *record)
{
	enum gz_result result = output->events.open ? GZ_OK : begin_csv_events(output);
	if (result != GZ_OK)
		return result;
	FILE *out = output->events.text;
	char text[GZ_GAZE_LOG_TEXT_SIZE + 64];
	write_seconds(out, record->host_ns);
	if (record->kind == GZ_GAZE_LOG_GAP) {
		fputs(",gap,", out);
		snprintf(text, sizeof text, "%" PRIu64 " samples missing: %s", record->missing,
			 record->text);
	} else if (record->kind == GZ_GAZE_LOG_WINDOW) {
		fputs(",window,", out);
		snprintf(text, sizeof text, "%d %d %d %d", record->window_px[0],
			 record->window_px[1], record->window_px[2], record->window_px[3]);
	} else if (record->kind == GZ_GAZE_LOG_SCENE) {
		fputs(",scene,", out);
		snprintf(text, sizeof text, "%s", record->still_scene ? "still" : "moving");
	} else {
		fputs(",mark,", out);
		snprintf(text, sizeof text, "%s", record->text);
	}
	write_quoted(out, text);
	fputc(',', out);
	if (record->kind == GZ_GAZE_LOG_MARK && record->duration_ns > 0)
		write_seconds(out, record->duration_ns);
	fputc(',', out);
	if (record->kind == GZ_GAZE_LOG_MARK && record->keys[0])
		write_quoted(out, record->keys);
	fputc('\n', out);
	return check_csv_file(output, &output->events);
}

static enum gz_result csv_add(void *user, const struct gz_gaze_log_record *record)
{
	struct gz_recording_output *output = user;
	if (record->kind != GZ_GAZE_LOG_SAMPLE)
		return add_csv_event(output, record);
	write_csv_sample(output, &record->sample);
	return check_csv_file(output, &output->samples);
}

static enum gz_result csv_open(const char *path, bool overwrite, const struct gz_log *log,
			       struct gz_recording_sink *out_sink)
{
	if (gz_recording_writer_of(path) != &gz_recording_writer_csv) {
		gz_err(log, "%s: the name of a table must end in .csv", path);
		return GZ_ERR_INVAL;
	}
	struct gz_recording_output *output = calloc(1, sizeof *output);
	if (!output)
		return GZ_ERR_NO_MEM;
	output->log = log;
	output->overwrite = overwrite;
	snprintf(output->path, sizeof output->path, "%s", path);
	out_sink->user = output;
	out_sink->header = csv_begin;
	out_sink->record = csv_add;
	return GZ_OK;
}

static void csv_label(struct gz_recording_sink *sink, const struct gz_offline_labels *labels)
{
	struct gz_recording_output *output = sink->user;
	output->labels = labels;
}

static enum gz_result csv_close(struct gz_recording_sink *sink, bool complete)
{
	struct gz_recording_output *output = sink->user;
	enum gz_result result = gz_output_end(&output->samples, complete, output->log);
	enum gz_result events =
		gz_output_end(&output->events, complete && result == GZ_OK, output->log);
	free(output);
	sink->user = NULL;
	return result != GZ_OK ? result : events;
}

const struct gz_recording_writer gz_recording_writer_csv = {
	.name = "csv",
	.ending = ".csv",
	.help = "table of samples; marks and gaps are in a second table, _events.csv",
	.open = csv_open,
	.label = csv_label,
	.close = csv_close,
};
