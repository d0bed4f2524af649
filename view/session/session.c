#include "view/session/session.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "render/picture/image.h"
#include "render/plan/plan.h"

/* Names of a frame's fields, in their order. */
static const char *const columns[] = {
	"time_ns",
	"width_px",
	"height_px",
	"display_width_px",
	"display_height_px",
	"display_width_mm",
	"display_height_mm",
	"distance_mm",
	"gaze_x",
	"gaze_y",
	"gaze_age_ns",
	"gaze_event",
	"gaze_noise_deg",
	"focus_x",
	"focus_y",
	"scale",
	"widen",
	"kept",
	"took_ms",
};
enum { COLUMNS = sizeof columns / sizeof columns[0] };

static const char *const type_names[GZ_VOXEL_TYPE_COUNT] = { "uint8", "uint16", "float32" };

/* A number that is not finite gives an empty field. */
static void print_double(double value, struct gz_text *text)
{
	if (isfinite(value))
		gz_text_add(text, "%.17g", value);
}

static void print_point_fields(bool known, struct gz_point point, struct gz_text *text)
{
	if (known && isfinite(point.x) && isfinite(point.y))
		gz_text_add(text, "%.9g\t%.9g\t", (double)point.x, (double)point.y);
	else
		gz_text_add(text, "\t\t");
}

void gz_session_print_header(const struct gz_session_header *header, struct gz_text *text)
{
	const struct gz_volume_identity *volume = &header->volume;
	gz_text_add(text, GZ_SESSION_FIRST_LINE "\n");
	gz_text_add(text, "#started %s\n#software %s\n#backend %s\n", header->started,
		    header->software, header->backend);
	gz_text_add(text, "#host_ns %" PRId64 "\n", header->host_ns);
	gz_text_add(text, "#volume_dims %d\t%d\t%d\n", volume->dims[0], volume->dims[1],
		    volume->dims[2]);
	gz_text_add(text, "#volume_type %s\n", type_names[volume->type]);
	gz_text_add(text, "#volume_spacing %.17g\t%.17g\t%.17g\n", volume->spacing[0],
		    volume->spacing[1], volume->spacing[2]);
	gz_text_add(text, "#volume_range %.17g\t%.17g\n", volume->least, volume->greatest);
	if (volume->has_crc)
		gz_text_add(text, "#volume_crc %08" PRIx32 "\n", volume->crc);
	gz_text_add(text, "#columns ");
	for (int i = 0; i < COLUMNS; i++)
		gz_text_add(text, "%s%c", columns[i], i + 1 < COLUMNS ? '\t' : '\n');
}

void gz_session_print_frame(const struct gz_session_frame *frame, struct gz_text *text)
{
	const struct gz_display *display = &frame->display;
	const struct gz_gaze_reading *reading = &frame->reading;
	const struct gz_focus *focus = &frame->focus;
	gz_text_add(text, "%" PRId64 "\t%d\t%d\t%d\t%d\t", frame->time_ns, frame->width,
		    frame->height, display->px[0], display->px[1]);
	gz_text_add(text, "%.17g\t%.17g\t%.17g\t", display->mm[0], display->mm[1],
		    display->distance_mm);
	print_point_fields(reading->known, reading->point, text);
	if (reading->has_age)
		gz_text_add(text, "%" PRId64, reading->age_ns);
	gz_text_add(text, "\t%s\t", reading->has_event ? gz_event_name(reading->event) : "");
	print_double(reading->noise_deg, text);
	gz_text_add(text, "\t");
	print_point_fields(true, focus->point, text);
	gz_text_add(text, "%.17g\t%.17g\t%d\t%.3f\n", focus->scale, focus->widen, frame->kept,
		    frame->took_ms);
}

void gz_session_print_end(uint64_t frames, uint32_t crc, struct gz_text *text)
{
	gz_text_add(text, "#end %" PRIu64 "\t%08" PRIx32 "\n", frames, crc);
}

/* Split a line at its tabs. @return the number of fields; room + 1 if there are more than room */
static int split_fields(char *line, char **fields, int room)
{
	int count = 0;
	while (line && count < room) {
		fields[count++] = line;
		line = strchr(line, '\t');
		if (line)
			*line++ = '\0';
	}
	return line ? room + 1 : count;
}

static bool read_int(const char *field, long long least, long long most, long long *out_value)
{
	long long value;
	if (!gz_number_parse_whole(field, &value) || value < least || value > most)
		return false;
	*out_value = value;
	return true;
}

static bool read_side(const char *field, int most, int *out_value)
{
	long long value;
	if (!read_int(field, 1, most, &value))
		return false;
	*out_value = (int)value;
	return true;
}

static bool read_float(const char *field, float *out_value)
{
	double value;
	/* A number outside the range of float becomes infinite. */
	if (!gz_number_parse(field, &value) || !isfinite((float)value))
		return false;
	*out_value = (float)value;
	return true;
}

/* Fields are parsed in order; wrong is the first invalid one. */
struct fields {
	char *texts[COLUMNS];
	int next;
	int wrong; /* COLUMNS: none */
};

static const char *next_frame_field(struct fields *fields)
{
	return fields->texts[fields->next++];
}

static void expect(struct fields *fields, bool good)
{
	if (!good && fields->wrong == COLUMNS)
		fields->wrong = fields->next - 1;
}

static double take_double(struct fields *fields, double least, double most)
{
	double value = 0;
	expect(fields, gz_number_parse(next_frame_field(fields), &value) && value >= least &&
			       value <= most);
	return value;
}

/* @return false if both fields are empty; the point is then NaN */
static bool take_gaze_point(struct fields *fields, struct gz_point *out_point)
{
	struct gz_point point = { NAN, NAN };
	const char *x = next_frame_field(fields);
	const bool known = x[0] != '\0';
	expect(fields, !known || read_float(x, &point.x));
	const char *y = next_frame_field(fields);
	expect(fields, known ? read_float(y, &point.y) : y[0] == '\0');
	*out_point = point;
	return known;
}

static bool read_event(const char *field, enum gz_event *out_event)
{
	for (int event = 0; event < GZ_EVENT_COUNT; event++) {
		if (strcmp(field, gz_event_name((enum gz_event)event)) == 0) {
			*out_event = (enum gz_event)event;
			return true;
		}
	}
	return false;
}

static void take_reading(struct fields *fields, struct gz_gaze_reading *out_reading)
{
	struct gz_gaze_reading reading = { .connected = true, .noise_deg = NAN };
	long long age = 0;
	reading.known = take_gaze_point(fields, &reading.point);
	const char *field = next_frame_field(fields);
	reading.has_age = field[0] != '\0';
	expect(fields, !reading.has_age || read_int(field, INT64_MIN, INT64_MAX, &age));
	reading.age_ns = age;
	field = next_frame_field(fields);
	reading.has_event = field[0] != '\0';
	expect(fields, !reading.has_event || read_event(field, &reading.event));
	field = next_frame_field(fields);
	expect(fields, field[0] == '\0' || (gz_number_parse(field, &reading.noise_deg) &&
					    reading.noise_deg >= 0));
	*out_reading = reading;
}

static void take_display(struct fields *fields, struct gz_display *display)
{
	for (int i = 0; i < 2; i++)
		expect(fields, read_side(next_frame_field(fields), GZ_DISPLAY_SIDE_MAX_PX,
					 &display->px[i]));
	display->mm[0] = take_double(fields, 0, HUGE_VAL);
	display->mm[1] = take_double(fields, 0, HUGE_VAL);
	display->distance_mm = take_double(fields, 0, HUGE_VAL);
	expect(fields, gz_display_valid(display));
}

void gz_session_print_raised(const struct gz_raised *raised, struct gz_text *text)
{
	gz_text_add(text, GZ_SESSION_RAISE_WORD "\t%" PRIu32 "\t%.17g", raised->id, raised->share);
	if (raised->least != raised->greatest)
		gz_text_add(text, "\t%.17g\t%.17g", raised->least, raised->greatest);
	gz_text_add(text, "\n");
}

enum gz_result gz_session_parse_raised(char *line, struct gz_raised *out_raised)
{
	char *fields[5];
	long long id;
	struct gz_raised raised = { 0 };
	const size_t count = split_fields(line, fields, 5);
	if ((count != 3 && count != 5) || !read_int(fields[1], 0, UINT32_MAX, &id) ||
	    !gz_number_parse(fields[2], &raised.share) || !(raised.share >= 0 && raised.share <= 1))
		return GZ_ERR_FORMAT;
	raised.id = (uint32_t)id;
	if (count == 5 &&
	    (!gz_number_parse(fields[3], &raised.least) ||
	     !gz_number_parse(fields[4], &raised.greatest) || !(raised.least < raised.greatest)))
		return GZ_ERR_FORMAT;
	*out_raised = raised;
	return GZ_OK;
}

void gz_session_print_finer(double finer, struct gz_text *text)
{
	gz_text_add(text, GZ_SESSION_FINER_WORD "\t%.17g\n", finer);
}

enum gz_result gz_session_parse_finer(char *line, double *out_finer)
{
	char *fields[2];
	double finer;
	if (split_fields(line, fields, 2) != 2 || !gz_number_parse(fields[1], &finer) ||
	    !(finer >= 1 && finer <= GZ_PLAN_FINER_MAX))
		return GZ_ERR_FORMAT;
	*out_finer = finer;
	return GZ_OK;
}

void gz_session_print_change(const struct gz_illustration_change *change, struct gz_text *text)
{
	gz_text_add(text, GZ_SESSION_ADAPT_WORD "\t%.17g\t%.17g\t%.17g\t%.17g\t%.17g\n",
		    change->edge_emphasis, change->detail_amplitude, change->detail_frequency,
		    change->spatial_effect, change->foreground);
}

enum gz_result gz_session_parse_change(char *line, struct gz_illustration_change *out_change)
{
	char *fields[6];
	struct gz_illustration_change change;
	if (split_fields(line, fields, 6) != 6 ||
	    !gz_number_parse(fields[1], &change.edge_emphasis) ||
	    !gz_number_parse(fields[2], &change.detail_amplitude) ||
	    !gz_number_parse(fields[3], &change.detail_frequency) ||
	    !gz_number_parse(fields[4], &change.spatial_effect) ||
	    !gz_number_parse(fields[5], &change.foreground) ||
	    !gz_illustration_change_valid(&change))
		return GZ_ERR_FORMAT;
	*out_change = change;
	return GZ_OK;
}

enum gz_result gz_session_parse_frame(char *line, struct gz_session_frame *out_frame,
				      const char **out_what)
{
	struct fields fields = { .wrong = COLUMNS };
	struct gz_session_frame frame = { 0 };
	long long number = 0;
	if (split_fields(line, fields.texts, COLUMNS) != COLUMNS) {
		*out_what = "the number of fields";
		return GZ_ERR_FORMAT;
	}
	expect(&fields, read_int(next_frame_field(&fields), 0, INT64_MAX, &number));
	frame.time_ns = number;
	expect(&fields, read_side(next_frame_field(&fields), GZ_IMAGE_SIDE_MAX, &frame.width));
	expect(&fields, read_side(next_frame_field(&fields), GZ_IMAGE_SIDE_MAX, &frame.height));
	take_display(&fields, &frame.display);
	take_reading(&fields, &frame.reading);
	(void)take_gaze_point(&fields, &frame.focus.point);
	frame.focus.scale = take_double(&fields, 1, 1e6);
	frame.focus.widen = take_double(&fields, 0, 1);
	expect(&fields, read_int(next_frame_field(&fields), 0, 1, &number));
	frame.kept = number == 1;
	frame.took_ms = take_double(&fields, 0, HUGE_VAL);
	if (fields.wrong != COLUMNS) {
		*out_what = columns[fields.wrong];
		return GZ_ERR_FORMAT;
	}
	*out_frame = frame;
	return GZ_OK;
}

static bool copy_name(const char *value, char name[GZ_NAME_SIZE])
{
	if (strlen(value) >= GZ_NAME_SIZE)
		return false;
	memcpy(name, value, strlen(value) + 1);
	return true;
}

static bool read_crc(const char *field, uint32_t *out_crc)
{
	if (strlen(field) != 8 || field[strspn(field, "0123456789abcdef")] != '\0')
		return false;
	*out_crc = (uint32_t)strtoul(field, NULL, 16);
	return true;
}

static bool read_doubles(char *value, double *out, int count)
{
	char *fields[3];
	if (split_fields(value, fields, count) != count)
		return false;
	for (int i = 0; i < count; i++)
		if (!gz_number_parse(fields[i], &out[i]))
			return false;
	return true;
}

static bool read_dims(char *value, int dims[3])
{
	char *fields[3];
	if (split_fields(value, fields, 3) != 3)
		return false;
	for (int i = 0; i < 3; i++)
		if (!read_side(fields[i], GZ_VOLUME_DIM_MAX, &dims[i]))
			return false;
	return true;
}

static bool read_type(const char *value, enum gz_voxel_type *out_type)
{
	for (int type = 0; type < GZ_VOXEL_TYPE_COUNT; type++) {
		if (strcmp(value, type_names[type]) == 0) {
			*out_type = (enum gz_voxel_type)type;
			return true;
		}
	}
	return false;
}

static bool read_volume(const char *word, char *value, struct gz_volume_identity *volume)
{
	double range[2];
	if (strcmp(word, "#volume_dims") == 0)
		return read_dims(value, volume->dims);
	if (strcmp(word, "#volume_type") == 0)
		return read_type(value, &volume->type);
	if (strcmp(word, "#volume_spacing") == 0)
		return read_doubles(value, volume->spacing, 3);
	if (strcmp(word, "#volume_range") == 0) {
		if (!read_doubles(value, range, 2))
			return false;
		volume->least = range[0];
		volume->greatest = range[1];
	}
	if (strcmp(word, "#volume_crc") == 0)
		return volume->has_crc = read_crc(value, &volume->crc);
	return true;
}

enum gz_result gz_session_parse_header_line(char *line, struct gz_session_header *header)
{
	char *value = strchr(line, ' ');
	long long number;
	bool good = true;
	if (!value)
		return GZ_OK;
	*value++ = '\0';
	if (strcmp(line, "#started") == 0)
		good = copy_name(value, header->started);
	else if (strcmp(line, "#software") == 0)
		good = copy_name(value, header->software);
	else if (strcmp(line, "#backend") == 0)
		good = copy_name(value, header->backend);
	else if (strcmp(line, "#host_ns") == 0) {
		good = read_int(value, INT64_MIN, INT64_MAX, &number);
		header->host_ns = good ? number : 0;
	} else {
		good = read_volume(line, value, &header->volume);
	}
	return good ? GZ_OK : GZ_ERR_FORMAT;
}

bool gz_session_parse_end(char *line, uint64_t *out_frames, uint32_t *out_crc)
{
	char *fields[2];
	long long frames;
	static const char word[] = "#end ";
	if (strncmp(line, word, sizeof word - 1) != 0 ||
	    split_fields(line + sizeof word - 1, fields, 2) != 2)
		return false;
	if (!read_int(fields[0], 0, INT64_MAX, &frames) || !read_crc(fields[1], out_crc))
		return false;
	*out_frames = (uint64_t)frames;
	return true;
}
