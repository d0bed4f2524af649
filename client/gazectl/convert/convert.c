/* gazectl convert: recordings of other programs to gaze logs, and gaze logs to other formats. */
#include "client/gazectl/gazectl.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "client/gazectl/convert/recording_format.h"
#include "client/gazectl/label/label_recording.h"

#define GZ_LOG_MODULE "gazectl"

struct convert_settings {
	struct gz_command_common common;
	char from[16];
	char to[16];
	bool force;
	bool labels;
	int display_px[2];
	double display_mm[2];
	double distance_mm;
	double rate_hz;
	char table_columns[1024];
	char table_where[256];
	int table_time_unit; /* enum gz_table_time_unit */
	int table_points;    /* enum gz_table_points */
};

/* In the order of the enums. */
static const char *const time_unit_names[] = { "s", "ms", "us", "ns", NULL };
static const char *const points_names[] = { "fraction", "px", "mm", NULL };

#define AT(field) offsetof(struct convert_settings, field)

static const struct gz_option convert_options[] = {
	GZ_COMMAND_HELP_OPTION,
	{ "from", GZ_OPTION_STRING, AT(from), 0, 16, 0, NULL, "",
	  "format of INPUT: gzl, pupil, eyelink, tobii, smi, arff or table; empty: recognised by "
	  "its "
	  "content" },
	{ "to", GZ_OPTION_STRING, AT(to), 0, 16, 0, NULL, "",
	  "format of OUTPUT: gzl, csv or bids; empty: by the ending of its name" },
	{ "force", GZ_OPTION_BOOL, AT(force), 0, 0, 0, NULL, "false", "replace existing files" },
	{ "labels", GZ_OPTION_BOOL, AT(labels), 0, 0, 0, NULL, "false",
	  "write what the eye did too, as gazectl label finds it; for .csv and BIDS" },
	{ "display.px", GZ_OPTION_SIZE, AT(display_px), 0, GZ_DISPLAY_SIDE_MAX_PX, 0, NULL, "0x0",
	  "size of the display, pixels; 0x0: from the file" },
	{ "display.mm", GZ_OPTION_DOUBLE, AT(display_mm), 0, 100000, 2, NULL, "0 0",
	  "width and height of the display, mm; 0 0: from the file" },
	{ "display.distance_mm", GZ_OPTION_DOUBLE, AT(distance_mm), 0, 100000, 0, NULL, "0",
	  "distance from the eyes to the centre of the display, mm; 0: from the file" },
	{ "rate-hz", GZ_OPTION_DOUBLE, AT(rate_hz), 0, 100000, 0, NULL, "0",
	  "nominal rate of the tracker, Hz; 0: from the file" },
	{ "table.columns", GZ_OPTION_STRING, AT(table_columns), 0, 1024, 0, NULL, "",
	  "for --from table: MEANING=COLUMN;... with time, x, y, confidence, left_x, left_y, "
	  "left_confidence, left_pupil_mm, the same with right_, and mark" },
	{ "table.where", GZ_OPTION_STRING, AT(table_where), 0, 256, 0, NULL, "",
	  "for --from table: COLUMN=VALUE; only lines with this value" },
	{ "table.time-unit", GZ_OPTION_CHOICE, AT(table_time_unit), 0, 0, 0, time_unit_names, "s",
	  "for --from table: unit of the times" },
	{ "table.points", GZ_OPTION_CHOICE, AT(table_points), 0, 0, 0, points_names, "px",
	  "for --from table: what x and y are in, from the top left corner of the display" },
};

/* One conversion. */
struct conversion {
	const struct convert_settings *settings;
	const char *input;
	const struct gz_log *log;
	struct gz_recording_sink sink;
	struct gz_convert_counts counts;
	uint64_t gaps, marks;
	bool damaged; /* a gaze log that is cut or corrupted */
};

static enum gz_result pass_header(void *user, const struct gz_gaze_log_header *header)
{
	struct conversion *conversion = user;
	return conversion->sink.header(conversion->sink.user, header);
}

static enum gz_result pass_record(void *user, const struct gz_gaze_log_record *record)
{
	struct conversion *conversion = user;
	conversion->gaps += record->kind == GZ_GAZE_LOG_GAP;
	conversion->marks += record->kind == GZ_GAZE_LOG_MARK;
	return conversion->sink.record(conversion->sink.user, record);
}

/* The header of a gaze log with the display and the rate from the command line. */
static struct gz_gaze_log_header override_header(const struct gz_gaze_log_header *read,
						 const struct convert_settings *settings)
{
	struct gz_gaze_log_header header = *read;
	if (settings->display_px[0] > 0 && settings->display_px[1] > 0)
		memcpy(header.display.px, settings->display_px, sizeof header.display.px);
	if (settings->display_mm[0] > 0 && settings->display_mm[1] > 0)
		memcpy(header.display.mm, settings->display_mm, sizeof header.display.mm);
	if (settings->distance_mm > 0)
		header.display.distance_mm = settings->distance_mm;
	if (settings->rate_hz > 0)
		header.rate_hz = settings->rate_hz;
	header.has_display = gz_display_valid(&header.display);
	return header;
}

static enum gz_result read_gzl(struct conversion *conversion)
{
	struct gz_gaze_log_reader *reader = NULL;
	struct gz_gaze_log_record record;
	enum gz_result result = gz_gaze_log_open(conversion->input, conversion->log, &reader);
	if (result != GZ_OK)
		return result;
	struct gz_gaze_log_header header =
		override_header(gz_gaze_log_header(reader), conversion->settings);
	result = pass_header(conversion, &header);
	while (result == GZ_OK) {
		result = gz_gaze_log_read(reader, &record);
		if (result == GZ_OK) {
			conversion->counts.samples += record.kind == GZ_GAZE_LOG_SAMPLE;
			result = pass_record(conversion, &record);
		} else if (result == GZ_ERR_FORMAT) {
			conversion->counts.skipped++;
			result = GZ_OK;
		}
	}
	conversion->damaged = gz_gaze_log_ending(reader) != GZ_GAZE_LOG_WHOLE;
	gz_gaze_log_close(&reader);
	return result == GZ_ERR_END ? GZ_OK : result;
}

static enum gz_result read_foreign(struct conversion *conversion, struct gz_text_lines *lines,
				   const struct gz_recording_reader *reader)
{
	const struct convert_settings *given = conversion->settings;
	const char *slash = strrchr(conversion->input, '/');
	const struct gz_convert_settings settings = {
		.display_px = { given->display_px[0], given->display_px[1] },
		.display_mm = { given->display_mm[0], given->display_mm[1] },
		.distance_mm = given->distance_mm,
		.rate_hz = given->rate_hz,
		.table = { given->table_columns, given->table_where,
			   (enum gz_table_time_unit)given->table_time_unit,
			   (enum gz_table_points)given->table_points },
		.name = slash ? slash + 1 : conversion->input,
		.log = conversion->log,
	};
	const struct gz_recording_sink sink = { conversion, pass_header, pass_record };
	enum gz_result result = reader->read(lines, &settings, &sink, &conversion->counts);
	if (result == GZ_ERR_IO && conversion->counts.samples == 0)
		gz_err(conversion->log, "%s cannot be read; is it damaged?", conversion->input);
	return result;
}

/* Choose the reader by --from, or by the first line that is not empty. @param[out] out_reader NULL:
 * the input is a gaze log @return false: no reader fits; logged */
static bool choose_reader(const struct conversion *conversion, struct gz_text_lines *lines,
			  const struct gz_recording_reader **out_reader)
{
	const char *from = conversion->settings->from;
	char *line;
	*out_reader = NULL;
	if (strcmp(from, "gzl") == 0)
		return true;
	if (from[0]) {
		*out_reader = gz_recording_reader_find(from);
		if (!*out_reader)
			gz_err(conversion->log,
			       "--from %s: unknown format; allowed: gzl, pupil, eyelink, tobii, "
			       "smi, "
			       "arff, table",
			       from);
		return *out_reader != NULL;
	}
	enum gz_result result;
	do
		result = gz_text_lines_next(lines, &line);
	while (result == GZ_OK && !line[0]);
	if (result == GZ_OK) {
		gz_text_lines_again(lines);
		if (gz_text_begins(line, "#gazecast-log"))
			return true;
		*out_reader = gz_recording_reader_recognise(line);
		if (*out_reader)
			return true;
	}
	if (result == GZ_ERR_END || result == GZ_ERR_IO) {
		gz_err(conversion->log, "%s: %s", conversion->input,
		       result == GZ_ERR_END ? "the file is empty; name a recording"
					    : "cannot be read; name a file that is not damaged");
		return false;
	}
	gz_err(conversion->log,
	       "%s: the format is not recognised; give it with --from, or name its columns with "
	       "--from table --table.columns",
	       conversion->input);
	return false;
}

static enum gz_result read_input(struct conversion *conversion)
{
	struct gz_text_lines *lines = NULL;
	const struct gz_recording_reader *reader;
	enum gz_result result = gz_text_lines_open(conversion->input, &lines);
	if (result != GZ_OK) {
		gz_err(conversion->log, "cannot open %s: %s; check the path", conversion->input,
		       gz_result_text(result));
		return result;
	}
	if (!choose_reader(conversion, lines, &reader))
		result = GZ_ERR_FORMAT;
	else if (reader)
		result = read_foreign(conversion, lines, reader);
	else
		result = read_gzl(conversion);
	gz_text_lines_close(&lines);
	return result;
}

static const struct gz_recording_writer *choose_writer(const char *to, const char *output,
						       const struct gz_log *log)
{
	const struct gz_recording_writer *writer =
		to[0] ? gz_recording_writer_find(to) : gz_recording_writer_of(output);
	if (!writer && to[0])
		gz_err(log, "--to %s: unknown format; allowed: gzl, csv, bids", to);
	else if (!writer)
		gz_err(log,
		       "%s: unknown format; end the name in .gzl, .csv or _physio.tsv.gz, or give "
		       "--to",
		       output);
	return writer;
}

static void print_result(const struct conversion *conversion, const char *output,
			 const struct gz_recording_writer *writer)
{
	if (writer->files)
		printf("%.*s%s", (int)(strlen(output) - strlen(writer->ending)), output,
		       writer->files);
	else
		printf("%s", output);
	printf(": %" PRIu64 " samples, %" PRIu64 " gaps, %" PRIu64 " marks",
	       conversion->counts.samples, conversion->gaps, conversion->marks);
	if (conversion->counts.skipped)
		printf("; %" PRIu64 " lines could not be read and were skipped",
		       conversion->counts.skipped);
	putchar('\n');
}

/* Read the input once and label it. */
static enum gz_result label_input(struct conversion *conversion, struct gz_offline_labels *out)
{
	struct gz_label_recording recording = { .name = conversion->input, .log = conversion->log };
	conversion->sink = (struct gz_recording_sink) { &recording, gz_label_take_header,
							gz_label_take_record };
	enum gz_result result = read_input(conversion);
	if (result == GZ_OK)
		result = gz_label_finish(&recording, out);
	gz_offline_destroy(&recording.offline);
	conversion->counts = (struct gz_convert_counts) { .samples = 0 };
	conversion->gaps = conversion->marks = 0;
	return result;
}

/* Read the input and write it. @param labels  NULL: without */
static enum gazectl_exit write_recording(struct conversion *conversion, const char *output,
					 const struct gz_recording_writer *writer,
					 const struct gz_offline_labels *labels)
{
	const bool force = conversion->settings->force;
	if (writer->open(output, force, conversion->log, &conversion->sink) != GZ_OK)
		return GAZECTL_USAGE;
	if (labels)
		writer->label(&conversion->sink, labels);
	enum gz_result result = read_input(conversion);
	if (result == GZ_OK && conversion->counts.samples == 0) {
		gz_err(conversion->log, "%s has no samples", conversion->input);
		result = GZ_ERR_FORMAT;
	}
	enum gz_result ended = writer->close(&conversion->sink, result == GZ_OK);
	if (result != GZ_OK || ended != GZ_OK)
		return GAZECTL_FAILED;
	print_result(conversion, output, writer);
	return conversion->damaged ? GAZECTL_DAMAGED : GAZECTL_DONE;
}

static enum gazectl_exit convert_recording(struct conversion *conversion, const char *output)
{
	const struct convert_settings *settings = conversion->settings;
	const struct gz_recording_writer *writer =
		choose_writer(settings->to, output, conversion->log);
	if (!writer)
		return GAZECTL_USAGE;
	if (!settings->labels)
		return write_recording(conversion, output, writer, NULL);
	if (!writer->label) {
		gz_err(conversion->log,
		       "--labels: the format %s has no labels; write .csv or _physio.tsv.gz",
		       writer->name);
		return GAZECTL_USAGE;
	}
	struct gz_offline_labels labels;
	if (label_input(conversion, &labels) != GZ_OK)
		return GAZECTL_FAILED;
	enum gazectl_exit status = write_recording(conversion, output, writer, &labels);
	gz_offline_labels_free(&labels);
	return status;
}

static int convert_run(int argc, char *const *argv, const struct gz_log *log)
{
	struct convert_settings settings;
	struct gz_operands operands;
	int status =
		gz_command_read_arguments(&gazectl_convert, argc, argv, log, &settings, &operands);
	if (status != GZ_COMMAND_GO_ON)
		return status;
	if (operands.count < 2) {
		gz_err(log, "two files are needed: gazectl convert INPUT OUTPUT");
		return GAZECTL_USAGE;
	}
	struct conversion conversion = { .settings = &settings,
					 .input = operands.items[0],
					 .log = log };
	return convert_recording(&conversion, operands.items[1]);
}

const struct gz_command gazectl_convert = {
	.program = "gazectl",
	.name = "convert",
	.operands = "INPUT OUTPUT",
	.operands_max = 2,
	.summary = "convert recordings from and to gaze logs",
	.details =
		"Reads gaze logs, and, plain or gzip, Pupil's gaze_positions.csv, EyeLink's .asc "
		"and Tobii's .tsv, text exports of SMI, .arff, and any table whose columns are "
		"named.\n"
		"Writes gaze logs (.gzl), tables (.csv) and BIDS "
		"(_physio.tsv.gz). If a file does not contain the\nsize of its display, give it "
		"here: it is needed to compute angles.\n",
	.options = convert_options,
	.option_count = sizeof convert_options / sizeof convert_options[0],
	.run = convert_run,
};
