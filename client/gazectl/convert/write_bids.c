/* The writer of eye-tracking data as BIDS has it (bids.neuroimaging.io, "Physiological recordings",
 * eye tracking; the example data set eyetracking_binocular): for each eye a table
 * STEM_recording-eyeN_physio.tsv.gz without a header line, a .json beside it that names its
 * columns, and the marks in _physioevents. eye1 is the left eye, eye2 the right eye, eye3 both
 * together. Positions are in pixels of the display, from its top left corner. */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/text.h"
#include "client/gazectl/convert/recording_format.h"
#include "client/gazectl/output.h"

#define GZ_LOG_MODULE "bids"

static const char ending[] = "_physio.tsv.gz";

/* Index of a recording: left eye, right eye, both together. */
enum { EYE_LEFT, EYE_RIGHT, BOTH, RECORDING_COUNT };

static const char *const eye_texts[RECORDING_COUNT] = { "left", "right", "cyclopean" };

struct eye_recording {
	struct gz_output_file physio;
	struct gz_output_file events;
	uint64_t samples;
	int64_t first_ns, last_ns;
	bool any; /* something was measured */
};

struct gz_recording_output {
	const struct gz_log *log;
	bool overwrite;
	size_t stem; /* length of path without its ending */
	char path[GZ_PATH_SIZE];
	struct gz_gaze_log_header header;
	struct eye_recording recording[RECORDING_COUNT];
	const struct gz_offline_labels *labels; /* NULL: none */
	size_t labelled;                        /* intervals written */
};

static enum gz_result begin_eye_file(struct gz_recording_output *output, int number,
				     const char *tail, enum gz_output_kind kind,
				     struct gz_output_file *file)
{
	char path[GZ_PATH_SIZE + 64];
	snprintf(path, sizeof path, "%.*s_recording-eye%d%s", (int)output->stem, output->path,
		 number + 1, tail);
	return gz_output_begin(file, path, output->overwrite, kind, output->log);
}

static enum gz_result bids_begin(void *user, const struct gz_gaze_log_header *header)
{
	struct gz_recording_output *output = user;
	output->header = *header;
	if (header->scene_camera)
		gz_warn(output->log,
			"%s: the gaze is in the picture of a scene camera, not on a screen; "
			"positions "
			"are fractions of that picture",
			output->path);
	else if (!header->has_display)
		gz_warn(output->log,
			"%s: the display is not known; positions are fractions of it, not pixels",
			output->path);
	for (int i = 0; i < RECORDING_COUNT; i++) {
		enum gz_result result = begin_eye_file(output, i, ending, GZ_OUTPUT_GZIP,
						       &output->recording[i].physio);
		if (result != GZ_OK)
			return result;
	}
	return GZ_OK;
}

/* Whether positions are written in pixels of the display, not as fractions. */
static bool in_pixels(const struct gz_gaze_log_header *header)
{
	return header->has_display && !header->scene_camera;
}

static void format_number(char text[32], double value, int digits)
{
	if (!isfinite(value)) {
		snprintf(text, 32, "n/a");
		return;
	}
	snprintf(text, 32, "%.*g", digits, value);
	gz_number_normalise_point(text);
}

static enum gz_result write_bids_sample(struct gz_recording_output *output,
					struct eye_recording *recording,
					const struct gz_sample *sample, struct gz_point point,
					double pupil_mm)
{
	char x[32], y[32], pupil[32];
	const struct gz_display *display = &output->header.display;
	bool known = in_pixels(&output->header);
	format_number(x, (double)point.x * (known ? display->px[0] : 1), 9);
	format_number(y, (double)point.y * (known ? display->px[1] : 1), 9);
	format_number(pupil, pupil_mm, 6);
	if (recording->samples++ == 0)
		recording->first_ns = sample->host_ns;
	recording->last_ns = sample->host_ns;
	if (gzprintf(recording->physio.gzip, "%" PRId64 "\t%s\t%s\t%s\n", sample->host_ns, x, y,
		     pupil) > 0)
		return GZ_OK;
	gz_err(output->log, "cannot write %s; is the disk full?", recording->physio.path);
	return GZ_ERR_IO;
}

static enum gz_result add_bids_eye(struct gz_recording_output *output, int number,
				   const struct gz_sample *sample, const struct gz_eye_sample *eye)
{
	static const struct gz_point nowhere = { NAN, NAN };
	struct eye_recording *recording = &output->recording[number];
	recording->any |= eye->valid || isfinite(eye->point.x) || isfinite(eye->pupil_mm);

	return write_bids_sample(output, recording, sample, eye->valid ? eye->point : nowhere,
				 (double)eye->pupil_mm);
}

static enum gz_result add_bids_sample(struct gz_recording_output *output,
				      const struct gz_sample *sample)
{
	struct gz_eye_sample both = { .point = sample->point,
				      .valid = sample->valid,
				      .pupil_mm = NAN };
	enum gz_result result = add_bids_eye(output, EYE_LEFT, sample, &sample->eye[GZ_EYE_LEFT]);
	if (result == GZ_OK)
		result = add_bids_eye(output, EYE_RIGHT, sample, &sample->eye[GZ_EYE_RIGHT]);
	if (result == GZ_OK)
		result = add_bids_eye(output, BOTH, sample, &both);
	return result;
}

/* Write onset, duration, kind, text and keys. JSON has no tabs and line ends. Tabs and line ends in
 * the text become blanks. */
static enum gz_result add_bids_event(struct gz_recording_output *output, int number,
				     const struct gz_gaze_log_record *record, const char *kind)
{
	struct gz_output_file *file = &output->recording[number].events;
	char text[GZ_GAZE_LOG_TEXT_SIZE], duration[32];
	if (!file->open) {
		enum gz_result result = begin_eye_file(output, number, "_physioevents.tsv.gz",
						       GZ_OUTPUT_GZIP, file);
		if (result != GZ_OK)
			return result;
	}
	bool mark = record->kind == GZ_GAZE_LOG_MARK;
	snprintf(text, sizeof text, "%s", record->text[0] ? record->text : "n/a");
	for (char *c = text; *c; c++)
		if (*c == '\t' || *c == '\n' || *c == '\r')
			*c = ' ';
	format_number(duration,
		      mark && record->duration_ns > 0 ? gz_ns_to_s(record->duration_ns) : NAN, 9);
	if (gzprintf(file->gzip, "%" PRId64 "\t%s\t%s\t%s\t%s\n", record->host_ns, duration, kind,
		     text, mark && record->keys[0] ? record->keys : "n/a") > 0)
		return GZ_OK;
	gz_err(output->log, "cannot write %s; is the disk full?", file->path);
	return GZ_ERR_IO;
}

/* Write an event to all recordings. */
static enum gz_result add_bids_events(struct gz_recording_output *output,
				      const struct gz_gaze_log_record *record, const char *kind)
{
	for (int i = 0; i < RECORDING_COUNT; i++) {
		enum gz_result result = add_bids_event(output, i, record, kind);
		if (result != GZ_OK)
			return result;
	}
	return GZ_OK;
}

/* Write what the eye did from this time on. */
static enum gz_result add_bids_labels(struct gz_recording_output *output, int64_t time_ns)
{
	const struct gz_offline_labels *labels = output->labels;
	while (labels && output->labelled < labels->interval_count &&
	       labels->interval[output->labelled].start_ns <= time_ns) {
		const struct gz_offline_interval *interval = &labels->interval[output->labelled++];
		const struct gz_gaze_log_record record = {
			.kind = GZ_GAZE_LOG_MARK,
			.host_ns = interval->start_ns,
			.duration_ns = interval->end_ns - interval->start_ns,
		};
		enum gz_result result =
			add_bids_events(output, &record, gz_offline_label_name(interval->label));
		if (result != GZ_OK)
			return result;
	}
	return GZ_OK;
}

static enum gz_result bids_add(void *user, const struct gz_gaze_log_record *record)
{
	struct gz_recording_output *output = user;
	if (record->kind == GZ_GAZE_LOG_SAMPLE) {
		enum gz_result result = add_bids_labels(output, record->sample.host_ns);
		return result == GZ_OK ? add_bids_sample(output, &record->sample) : result;
	}
	if (record->kind == GZ_GAZE_LOG_WINDOW || record->kind == GZ_GAZE_LOG_SCENE)
		return GZ_OK;
	return add_bids_events(output, record, record->kind == GZ_GAZE_LOG_GAP ? "gap" : "mark");
}

static json_t *json_column(const char *description, const char *units)
{
	return json_pack("{ss ss*}", "Description", description, "Units", units);
}

/* Belongs into _events.json of a data set; it is put here so that it is not lost. */
static json_t *json_stimulus(const struct gz_display *display)
{
	return json_pack("{so s[ss] s[ii] s[oo]}", "ScreenDistance",
			 gz_output_json_number(display->distance_mm / 1000), "ScreenOrigin", "top",
			 "left", "ScreenResolution", display->px[0], display->px[1], "ScreenSize",
			 gz_output_json_number(display->mm[0] / 1000),
			 gz_output_json_number(display->mm[1] / 1000));
}

static double sampling_rate_hz(const struct gz_recording_output *output,
			       const struct eye_recording *recording)
{
	double seconds = gz_ns_to_s(recording->last_ns - recording->first_ns);
	if (output->header.rate_hz > 0 || !(seconds > 0))
		return output->header.rate_hz;
	return (double)(recording->samples - 1) / seconds;
}

static json_t *json_pupil(const struct gz_gaze_log_header *header)
{
	char text[GZ_NAME_SIZE + 64];
	if (!header->pupil_unit[0])
		return json_column("Diameter of the pupil.", "mm");
	snprintf(text, sizeof text, "Size of the pupil; unit: %s.", header->pupil_unit);
	return json_column(text, "arbitrary");
}

static json_t *json_sample_table(const struct gz_recording_output *output, int number)
{
	const struct gz_gaze_log_header *header = &output->header;
	const bool scene = header->scene_camera;
	const char *units = in_pixels(header) ? "pixel" : "arbitrary";
	json_t *json = json_pack(
		"{ss ss ss so si so}", "PhysioType", "eyetrack", "RecordedEye", eye_texts[number],
		"SampleCoordinateSystem", scene ? "gaze-in-world" : "gaze-on-screen",
		"SamplingFrequency",
		gz_output_json_number(sampling_rate_hz(output, &output->recording[number])),
		"StartTime", 0, "ManufacturersModelName", gz_output_json_text(header->tracker));
	if (header->serial[0])
		json_object_set_new(json, "DeviceSerialNumber",
				    gz_output_json_text(header->serial));
	json_object_set_new(json, "SoftwareVersions", gz_output_json_text(header->software));
	json_object_set_new(
		json, "Columns",
		json_pack("[ssss]", "timestamp", "x_coordinate", "y_coordinate", "pupil_size"));
	json_object_set_new(json, "timestamp",
			    json_column("Time of the sample by the recording host's clock.", "ns"));
	json_object_set_new(json, "x_coordinate",
			    json_column(scene ? "Gaze position from the left edge of the scene "
						"camera's picture, as a fraction of its width."
					      : "Gaze position from the screen's left edge.",
					units));
	json_object_set_new(json, "y_coordinate",
			    json_column(scene ? "Gaze position from the top edge of the scene "
						"camera's picture, as a fraction of its height."
					      : "Gaze position from the screen's top edge.",
					units));
	json_object_set_new(json, "pupil_size", json_pupil(header));
	if (header->has_display && !scene)
		json_object_set_new(json, "StimulusPresentation", json_stimulus(&header->display));
	return json;
}

static json_t *json_event_table(const struct gz_recording_output *output, int number)
{
	(void)number;
	return json_pack(
		"{ss ss s[sssss] so so so so}", "Description",
		output->labels ? "Marks and gaps of the recording, and what the eye did."
			       : "Marks and gaps of the recording.",
		"OnsetSource", "timestamp", "Columns", "onset", "duration", "trial_type", "message",
		"keys", "duration", json_column("How long it lasts; n/a: a moment.", "s"),
		"trial_type",
		json_column(output->labels
				    ? "mark: set by a program or by the tracker's parser; gap: "
				      "samples are missing; fixation, saccade, oscillation after a "
				      "saccade, pursuit, blink, lost: found by gazectl."
				    : "mark: set by a program or by the tracker's parser; gap: "
				      "samples are missing.",
			    NULL),
		"message", json_column("The mark's text, or the reason of the gap.", NULL), "keys",
		json_column("Everything else that is known of the mark, a JSON object.", NULL));
}

/* Write the description of a table beside it. */
static enum gz_result write_description(
	struct gz_recording_output *output, int number, const char *tail,
	json_t *(*describe)(const struct gz_recording_output *output, int number))
{
	struct gz_output_file file;
	enum gz_result result = begin_eye_file(output, number, tail, GZ_OUTPUT_TEXT, &file);
	if (result != GZ_OK)
		return result;
	result = gz_output_json_print(describe(output, number), file.text, output->log);
	enum gz_result ended = gz_output_end(&file, result == GZ_OK, output->log);
	return result == GZ_OK ? ended : result;
}

static enum gz_result bids_open(const char *path, bool overwrite, const struct gz_log *log,
				struct gz_recording_sink *out_sink)
{
	if (gz_recording_writer_of(path) != &gz_recording_writer_bids) {
		gz_err(log,
		       "%s: give a name like sub-01_task-look%s; the names of the eyes are "
		       "inserted",
		       path, ending);
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
	out_sink->header = bids_begin;
	out_sink->record = bids_add;
	return GZ_OK;
}

static void bids_label(struct gz_recording_sink *sink, const struct gz_offline_labels *labels)
{
	struct gz_recording_output *output = sink->user;
	output->labels = labels;
}

/* Close the files of an eye. If nothing was ever measured, they are removed. */
static enum gz_result close_recording(struct gz_recording_output *output, int number, bool complete)
{
	struct eye_recording *recording = &output->recording[number];
	bool keep = complete && recording->any;
	bool events = keep && recording->events.open;
	enum gz_result result = gz_output_end(&recording->physio, keep, output->log);
	enum gz_result second = gz_output_end(&recording->events, keep, output->log);
	if (result == GZ_OK)
		result = second;
	if (result == GZ_OK && keep)
		result = write_description(output, number, "_physio.json", json_sample_table);
	if (result == GZ_OK && events)
		result = write_description(output, number, "_physioevents.json", json_event_table);
	return result;
}

static enum gz_result bids_close(struct gz_recording_sink *sink, bool complete)
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
	.files = "_recording-eye*_physio.tsv.gz",
	.help = "BIDS: _recording-eyeN_physio.tsv.gz and .json; marks in _physioevents",
	.open = bids_open,
	.label = bids_label,
	.close = bids_close,
};
