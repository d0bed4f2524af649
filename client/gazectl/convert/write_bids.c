/* Writes eye-tracking data in the manner of BIDS (bids.neuroimaging.io, "Physiological recordings",
 * eye tracking; the example data set eyetracking_binocular): for each eye
 * STEM_recording-eyeN_physio.tsv.gz without a header line and a .json beside it that names its
 * columns, and the marks in _physioevents. eye1 is the left eye, eye2 the right one, eye3 both
 * together. Positions are in pixels of the display, from its top left. */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/number.h"
#include "client/gazectl/convert/recording_format.h"
#include "client/gazectl/json.h"
#include "client/gazectl/output_file.h"

#define GZ_LOG_MODULE "bids"

static const char ending[] = "_physio.tsv.gz";

/* Numbers of recordings: left, right, both together. */
enum { EYE_LEFT, EYE_RIGHT, BOTH, RECORDING_COUNT };

static const char *const eye_texts[RECORDING_COUNT] = { "left", "right", "cyclopean" };

struct recording {
	struct gz_output_file physio;
	struct gz_output_file events;
	uint64_t samples;
	int64_t first_ns, last_ns;
	bool any; /* whether it ever measured anything */
	bool pupil;
};

struct gz_recording_output {
	const struct gz_log *log;
	bool overwrite;
	size_t stem; /* bytes of path before the ending */
	char path[GZ_PATH_SIZE];
	struct gz_gaze_log_header header;
	struct recording recording[RECORDING_COUNT];
};

static enum gz_result begin_file(struct gz_recording_output *output, int number, const char *tail,
				 enum gz_output_kind kind, struct gz_output_file *file)
{
	char path[GZ_PATH_SIZE + 64];
	snprintf(path, sizeof path, "%.*s_recording-eye%d%s", (int)output->stem, output->path,
		 number + 1, tail);
	return gz_output_begin(file, path, output->overwrite, kind, output->log);
}

static enum gz_result begin(void *user, const struct gz_gaze_log_header *header)
{
	struct gz_recording_output *output = user;
	output->header = *header;
	if (!header->has_display)
		gz_warn(output->log,
			"%s: the display is not known; positions are in parts of it, not in pixels",
			output->path);
	for (int i = 0; i < RECORDING_COUNT; i++) {
		enum gz_result result =
			begin_file(output, i, ending, GZ_OUTPUT_GZIP, &output->recording[i].physio);
		if (result != GZ_OK)
			return result;
	}
	return GZ_OK;
}

static void print_number(char text[32], double value, int digits)
{
	if (!isfinite(value)) {
		snprintf(text, 32, "n/a");
		return;
	}
	snprintf(text, 32, "%.*g", digits, value);
	gz_number_normalise_point(text);
}

static enum gz_result put_sample(struct gz_recording_output *output, struct recording *recording,
				 const struct gz_sample *sample, struct gz_point point,
				 double pupil_mm)
{
	char x[32], y[32], pupil[32];
	const struct gz_display *display = &output->header.display;
	bool known = output->header.has_display;
	print_number(x, (double)point.x * (known ? display->px[0] : 1), 9);
	print_number(y, (double)point.y * (known ? display->px[1] : 1), 9);
	print_number(pupil, pupil_mm, 6);
	if (recording->samples++ == 0)
		recording->first_ns = sample->host_ns;
	recording->last_ns = sample->host_ns;
	if (gzprintf(recording->physio.gzip, "%" PRId64 "\t%s\t%s\t%s\n", sample->host_ns, x, y,
		     pupil) > 0)
		return GZ_OK;
	gz_err(output->log, "cannot write %s: is its disk full?", recording->physio.path);
	return GZ_ERR_IO;
}

static enum gz_result add_eye(struct gz_recording_output *output, int number,
			      const struct gz_sample *sample, const struct gz_eye_sample *eye)
{
	static const struct gz_point nowhere = { NAN, NAN };
	struct recording *recording = &output->recording[number];
	recording->any |= eye->valid || isfinite(eye->point.x) || isfinite(eye->pupil_mm);
	recording->pupil |= isfinite(eye->pupil_mm);
	return put_sample(output, recording, sample, eye->valid ? eye->point : nowhere,
			  (double)eye->pupil_mm);
}

static enum gz_result add_sample(struct gz_recording_output *output, const struct gz_sample *sample)
{
	struct gz_eye_sample both = { .point = sample->point,
				      .valid = sample->valid,
				      .pupil_mm = NAN };
	enum gz_result result = add_eye(output, EYE_LEFT, sample, &sample->eye[GZ_EYE_LEFT]);
	if (result == GZ_OK)
		result = add_eye(output, EYE_RIGHT, sample, &sample->eye[GZ_EYE_RIGHT]);
	if (result == GZ_OK)
		result = add_eye(output, BOTH, sample, &both);
	return result;
}

/* onset, duration, what it is, text; blanks for what would end the field or the line. */
static enum gz_result add_event(struct gz_recording_output *output, int number,
				const struct gz_gaze_log_record *record, const char *kind)
{
	struct gz_output_file *file = &output->recording[number].events;
	char text[GZ_GAZE_LOG_TEXT_SIZE];
	if (!file->open) {
		enum gz_result result =
			begin_file(output, number, "_physioevents.tsv.gz", GZ_OUTPUT_GZIP, file);
		if (result != GZ_OK)
			return result;
	}
	snprintf(text, sizeof text, "%s", record->text[0] ? record->text : "n/a");
	for (char *c = text; *c; c++)
		if (*c == '\t' || *c == '\n' || *c == '\r')
			*c = ' ';
	if (gzprintf(file->gzip, "%" PRId64 "\tn/a\t%s\t%s\n", record->host_ns, kind, text) > 0)
		return GZ_OK;
	gz_err(output->log, "cannot write %s: is its disk full?", file->path);
	return GZ_ERR_IO;
}

static enum gz_result add(void *user, const struct gz_gaze_log_record *record)
{
	struct gz_recording_output *output = user;
	if (record->kind == GZ_GAZE_LOG_SAMPLE)
		return add_sample(output, &record->sample);
	if (record->kind == GZ_GAZE_LOG_WINDOW)
		return GZ_OK;
	const char *kind = record->kind == GZ_GAZE_LOG_GAP ? "gap" : "mark";
	for (int i = 0; i < RECORDING_COUNT; i++) {
		enum gz_result result = add_event(output, i, record, kind);
		if (result != GZ_OK)
			return result;
	}
	return GZ_OK;
}

static void describe_column(struct gz_json *json, const char *name, const char *description,
			    const char *units)
{
	gz_json_begin(json, name);
	gz_json_text(json, "Description", description);
	if (units)
		gz_json_text(json, "Units", units);
	gz_json_end(json);
}

static void list(struct gz_json *json, const char *key, const char *const *words, int count)
{
	gz_json_begin_list(json, key);
	for (int i = 0; i < count; i++)
		gz_json_text(json, NULL, words[i]);
	gz_json_end_list(json);
}

/* Belongs into _events.json of a data set; here, so that it is not lost. */
static void describe_display(struct gz_json *json, const struct gz_display *display)
{
	static const char *const origin[] = { "top", "left" };
	gz_json_begin(json, "StimulusPresentation");
	gz_json_double(json, "ScreenDistance", display->distance_mm / 1000);
	list(json, "ScreenOrigin", origin, 2);
	gz_json_begin_list(json, "ScreenResolution");
	gz_json_int(json, NULL, display->px[0]);
	gz_json_int(json, NULL, display->px[1]);
	gz_json_end_list(json);
	gz_json_begin_list(json, "ScreenSize");
	gz_json_double(json, NULL, display->mm[0] / 1000);
	gz_json_double(json, NULL, display->mm[1] / 1000);
	gz_json_end_list(json);
	gz_json_end(json);
}

static void describe_samples(const struct gz_recording_output *output, int number, FILE *out)
{
	static const char *const columns[] = { "timestamp", "x_coordinate", "y_coordinate",
					       "pupil_size" };
	const struct recording *recording = &output->recording[number];
	const struct gz_gaze_log_header *header = &output->header;
	const char *units = header->has_display ? "pixel" : "arbitrary";
	double seconds = gz_ns_to_s(recording->last_ns - recording->first_ns);
	double rate_hz = header->rate_hz > 0 || !(seconds > 0)
				 ? header->rate_hz
				 : (double)(recording->samples - 1) / seconds;
	struct gz_json json = { .out = out };
	gz_json_begin(&json, NULL);
	gz_json_text(&json, "PhysioType", "eyetrack");
	gz_json_text(&json, "RecordedEye", eye_texts[number]);
	gz_json_text(&json, "SampleCoordinateSystem", "gaze-on-screen");
	gz_json_double(&json, "SamplingFrequency", rate_hz);
	gz_json_double(&json, "StartTime", 0);
	gz_json_text(&json, "ManufacturersModelName", header->tracker);
	if (header->serial[0])
		gz_json_text(&json, "DeviceSerialNumber", header->serial);
	gz_json_text(&json, "SoftwareVersions", header->software);
	list(&json, "Columns", columns, 4);
	describe_column(&json, "timestamp", "Time of the sample by the recording host's clock.",
			"ns");
	describe_column(&json, "x_coordinate", "Gaze position from the screen's left edge.", units);
	describe_column(&json, "y_coordinate", "Gaze position from the screen's top edge.", units);
	describe_column(&json, "pupil_size", "Diameter of the pupil.", "mm");
	if (header->has_display)
		describe_display(&json, &header->display);
	gz_json_end(&json);
}

static void describe_events(const struct gz_recording_output *output, int number, FILE *out)
{
	static const char *const columns[] = { "onset", "duration", "trial_type", "message" };
	(void)output;
	(void)number;
	struct gz_json json = { .out = out };
	gz_json_begin(&json, NULL);
	gz_json_text(&json, "Description", "Marks and gaps of the recording.");
	gz_json_text(&json, "OnsetSource", "timestamp");
	list(&json, "Columns", columns, 4);
	describe_column(&json, "trial_type", "mark: set by a program; gap: samples are missing.",
			NULL);
	describe_column(&json, "message", "The mark's text, or the reason of the gap.", NULL);
	gz_json_end(&json);
}

static enum gz_result write_json(struct gz_recording_output *output, int number, const char *tail,
				 void (*describe)(const struct gz_recording_output *, int, FILE *))
{
	struct gz_output_file file;
	enum gz_result result = begin_file(output, number, tail, GZ_OUTPUT_TEXT, &file);
	if (result != GZ_OK)
		return result;
	describe(output, number, file.text);
	return gz_output_end(&file, true, output->log);
}

static enum gz_result open_bids(const char *path, bool overwrite, const struct gz_log *log,
				struct gz_recording_sink *out_sink)
{
	if (gz_recording_writer_of(path) != &gz_recording_writer_bids) {
		gz_err(log, "%s: name it as sub-01_task-look%s; the eyes' names are put in", path,
		       ending);
		return GZ_ERR_INVAL;
	}
	struct gz_recording_output *output = calloc(1, sizeof *output);
	if (!output)
		return GZ_ERR_NO_MEM;
	output->log = log;
	output->overwrite = overwrite;
	snprintf(output->path, sizeof output->path, "%s", path);
	output->stem = strlen(output->path) - strlen(ending);
	out_sink->user = output;
	out_sink->header = begin;
	out_sink->record = add;
	return GZ_OK;
}

/* What was never measured leaves no file. */
static enum gz_result close_recording(struct gz_recording_output *output, int number, bool complete)
{
	struct recording *recording = &output->recording[number];
	bool keep = complete && recording->any;
	bool events = keep && recording->events.open;
	enum gz_result result = gz_output_end(&recording->physio, keep, output->log);
	enum gz_result second = gz_output_end(&recording->events, keep, output->log);
	if (result == GZ_OK)
		result = second;
	if (result == GZ_OK && keep)
		result = write_json(output, number, "_physio.json", describe_samples);
	if (result == GZ_OK && events)
		result = write_json(output, number, "_physioevents.json", describe_events);
	return result;
}

static enum gz_result close_bids(struct gz_recording_sink *sink, bool complete)
{
	struct gz_recording_output *output = sink->user;
	enum gz_result result = GZ_OK;
	for (int i = 0; i < RECORDING_COUNT; i++) {
		enum gz_result one = close_recording(output, i, complete && result == GZ_OK);
		if (result == GZ_OK)
			result = one;
	}
	free(output);
	sink->user = NULL;
	return result;
}

const struct gz_recording_writer gz_recording_writer_bids = {
	.name = "bids",
	.ending = "_physio.tsv.gz",
	.help = "BIDS: _recording-eyeN_physio.tsv.gz and .json, _physioevents for marks",
	.open = open_bids,
	.close = close_bids,
};
