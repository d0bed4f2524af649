#include "drivers/hid/hid_tracker.h"

#include <math.h>
#include <string.h>

#include "drivers/hid/hid_usages.h"

/* Where a quantity stands: its usage, within a collection of one or two usages. */
struct place {
	enum gz_hid_report_type type;
	uint32_t outer, inner; /* inner 0: any */
	uint32_t usage;
	enum gz_hid_dimension dimension;
};

#define TRACKING(inner, usage)                                                      \
	{                                                                           \
		GZ_HID_INPUT, GZ_HID_TRACKING_DATA, (inner), (usage), GZ_HID_LENGTH \
	}

static const struct place places[GZ_HID_QUANTITIES] = {
	[GZ_HID_GAZE_X] = TRACKING(GZ_HID_GAZE_POINT, GZ_HID_POSITION_X),
	[GZ_HID_GAZE_Y] = TRACKING(GZ_HID_GAZE_POINT, GZ_HID_POSITION_Y),
	[GZ_HID_TICKS] = { GZ_HID_INPUT, GZ_HID_TRACKING_DATA, 0, GZ_HID_TIMESTAMP, GZ_HID_TIME },
	[GZ_HID_RIGHT_X] = TRACKING(GZ_HID_RIGHT_EYE_POSITION, GZ_HID_POSITION_X),
	[GZ_HID_RIGHT_Y] = TRACKING(GZ_HID_RIGHT_EYE_POSITION, GZ_HID_POSITION_Y),
	[GZ_HID_RIGHT_Z] = TRACKING(GZ_HID_RIGHT_EYE_POSITION, GZ_HID_POSITION_Z),
	[GZ_HID_LEFT_X] = TRACKING(GZ_HID_LEFT_EYE_POSITION, GZ_HID_POSITION_X),
	[GZ_HID_LEFT_Y] = TRACKING(GZ_HID_LEFT_EYE_POSITION, GZ_HID_POSITION_Y),
	[GZ_HID_LEFT_Z] = TRACKING(GZ_HID_LEFT_EYE_POSITION, GZ_HID_POSITION_Z),
	[GZ_HID_STATE_INPUT] = { GZ_HID_INPUT, GZ_HID_STATUS, 0, GZ_HID_CONFIGURATION_STATUS,
				 GZ_HID_NUMBER },
	[GZ_HID_RATE_INPUT] = { GZ_HID_INPUT, GZ_HID_STATUS, 0, GZ_HID_SAMPLING_FREQUENCY,
				GZ_HID_FREQUENCY },
	[GZ_HID_STATE] = { GZ_HID_FEATURE, GZ_HID_STATUS, 0, GZ_HID_CONFIGURATION_STATUS,
			   GZ_HID_NUMBER },
	[GZ_HID_RATE] = { GZ_HID_FEATURE, GZ_HID_STATUS, 0, GZ_HID_SAMPLING_FREQUENCY,
			  GZ_HID_FREQUENCY },
	[GZ_HID_MODE] = { GZ_HID_FEATURE, GZ_HID_CONTROL, 0, GZ_HID_DEVICE_MODE, GZ_HID_NUMBER },
	[GZ_HID_WIDTH] = { GZ_HID_FEATURE, GZ_HID_CONFIGURATION, 0, GZ_HID_SCREEN_WIDTH,
			   GZ_HID_LENGTH },
	[GZ_HID_HEIGHT] = { GZ_HID_FEATURE, GZ_HID_CONFIGURATION, 0, GZ_HID_SCREEN_HEIGHT,
			    GZ_HID_LENGTH },
	[GZ_HID_NEAREST] = { GZ_HID_FEATURE, GZ_HID_CAPABILITIES, 0, GZ_HID_DISTANCE_MINIMUM,
			     GZ_HID_LENGTH },
	[GZ_HID_OPTIMUM] = { GZ_HID_FEATURE, GZ_HID_CAPABILITIES, 0, GZ_HID_DISTANCE_OPTIMUM,
			     GZ_HID_LENGTH },
	[GZ_HID_FARTHEST] = { GZ_HID_FEATURE, GZ_HID_CAPABILITIES, 0, GZ_HID_DISTANCE_MAXIMUM,
			      GZ_HID_LENGTH },
};

/* Nearest and farthest that an eye, or side of a screen, is believed to be, mm. Chosen: from a
 * phone in the hand to a wall. */
static const double LENGTH_MIN_MM = 50, LENGTH_MAX_MM = 5000;
static const double SCREEN_RATIO_MAX = 6;
static const double DISTANCE_MIN_MM = 100, DISTANCE_MAX_MM = 5000;
static const double RATE_MIN_HZ = 1, RATE_MAX_HZ = 10000;

static bool is_eye_tracker(const struct gz_hid_collection *collection)
{
	return collection->usage == GZ_HID_EYE_TRACKER &&
	       collection->type == GZ_HID_COLLECTION_APPLICATION;
}

size_t gz_hid_tracker_count(const struct gz_hid_descriptor *descriptor)
{
	size_t count = 0;
	for (size_t i = 0; i < descriptor->collection_count; i++)
		count += is_eye_tracker(&descriptor->collections[i]);
	return count;
}

static int application_at(const struct gz_hid_descriptor *descriptor, size_t index)
{
	for (size_t i = 0; i < descriptor->collection_count; i++) {
		if (is_eye_tracker(&descriptor->collections[i]) && index-- == 0)
			return (int)i;
	}
	return GZ_HID_NO_COLLECTION;
}

static bool lies_in(const struct gz_hid_descriptor *descriptor, int collection, int outer)
{
	while (collection != GZ_HID_NO_COLLECTION && collection != outer)
		collection = descriptor->collections[collection].parent;
	return collection == outer;
}

static bool is_at(const struct gz_hid_descriptor *descriptor, int application,
		  const struct gz_hid_field *field, const struct place *place)
{
	return field->type == place->type && field->flags & GZ_HID_FLAG_VARIABLE &&
	       place->usage >= field->usage && place->usage <= field->usage_last &&
	       place->usage - field->usage < field->count &&
	       lies_in(descriptor, field->collection, application) &&
	       gz_hid_within(descriptor, field->collection, place->outer) &&
	       (!place->inner || gz_hid_within(descriptor, field->collection, place->inner));
}

/* The first usable one, in report @p id if that is not negative. */
static struct gz_hid_value find(const struct gz_hid_descriptor *descriptor, int application,
				enum gz_hid_quantity quantity, int id)
{
	const struct place *place = &places[quantity];
	struct gz_hid_value value = { 0 };
	for (size_t i = 0; i < descriptor->field_count; i++) {
		const struct gz_hid_field *field = &descriptor->fields[i];
		if (is_at(descriptor, application, field, place) &&
		    (id < 0 || field->report_id == id) &&
		    gz_hid_value_from_field(field, place->usage - field->usage, place->dimension,
					    &value) == GZ_OK)
			return value;
	}
	return value;
}

/* A time stamp may be one number, several elements, or several fields side by side; its range says
 * nothing, because no descriptor can tell one of 64 bits. */
static struct gz_hid_value find_ticks(const struct gz_hid_descriptor *descriptor, int application,
				      int id, bool *out_refused)
{
	struct gz_hid_value ticks = { 0 };
	const struct place *place = &places[GZ_HID_TICKS];
	*out_refused = false;
	for (size_t i = 0; i < descriptor->field_count; i++) {
		const struct gz_hid_field *field = &descriptor->fields[i];
		if (field->report_id != id || !is_at(descriptor, application, field, place))
			continue;
		uint64_t bits = (uint64_t)field->bit_size * field->count;
		if (ticks.present && ticks.at + ticks.bits != field->bit_offset)
			break;
		if (bits > 64 - ticks.bits ||
		    (!ticks.present &&
		     gz_hid_value_from_field(field, 0, place->dimension, &ticks) != GZ_OK)) {
			*out_refused = true;
			return (struct gz_hid_value) { 0 };
		}
		ticks.bits = (ticks.at == field->bit_offset ? 0 : ticks.bits) + (uint32_t)bits;
	}
	ticks.is_signed = ticks.nullable = ticks.has_range = false;
	return ticks;
}

static void find_tracking(const struct gz_hid_descriptor *descriptor, int application, int id,
			  struct gz_hid_tracker *tracker)
{
	for (int quantity = GZ_HID_GAZE_X; quantity <= GZ_HID_LEFT_Z; quantity++)
		tracker->values[quantity] = find(descriptor, application, quantity, id);
	tracker->values[GZ_HID_TICKS] =
		find_ticks(descriptor, application, id, &tracker->time_refused);
	tracker->has_eyes = true;
	for (int quantity = GZ_HID_RIGHT_X; quantity <= GZ_HID_LEFT_Z; quantity++)
		tracker->has_eyes = tracker->has_eyes && tracker->values[quantity].present;
}

static void note_reports(const struct gz_hid_descriptor *descriptor, struct gz_hid_tracker *tracker)
{
	tracker->report_count = descriptor->report_count;
	memcpy(tracker->reports, descriptor->reports,
	       sizeof *descriptor->reports * descriptor->report_count);
	for (int type = 0; type < GZ_HID_REPORT_TYPES; type++)
		tracker->longest[type] = gz_hid_longest_report(descriptor, type);
}

static enum gz_result refuse(const char **out_reason, enum gz_result result, const char *reason)
{
	if (out_reason)
		*out_reason = reason;
	return result;
}

enum gz_result gz_hid_tracker_find(const struct gz_hid_descriptor *descriptor, size_t index,
				   struct gz_hid_tracker *out_tracker, const char **out_reason)
{
	int application = application_at(descriptor, index);
	struct gz_hid_tracker tracker = { .numbered = descriptor->numbered };
	if (application == GZ_HID_NO_COLLECTION)
		return refuse(out_reason, GZ_ERR_NOT_FOUND, "it has no eye tracker");
	/* The report that holds both coordinates of the gaze point is the one to read. */
	for (size_t i = 0; i < descriptor->report_count; i++) {
		const struct gz_hid_report *report = &descriptor->reports[i];
		if (report->type != GZ_HID_INPUT)
			continue;
		find_tracking(descriptor, application, report->id, &tracker);
		if (tracker.values[GZ_HID_GAZE_X].present && tracker.values[GZ_HID_GAZE_Y].present)
			break;
	}
	if (!tracker.values[GZ_HID_GAZE_X].present || !tracker.values[GZ_HID_GAZE_Y].present)
		return refuse(out_reason, GZ_ERR_FORMAT,
			      "its tracking data hold no gaze point in a unit of length");
	for (int quantity = GZ_HID_STATE_INPUT; quantity < GZ_HID_QUANTITIES; quantity++)
		tracker.values[quantity] = find(descriptor, application, quantity, -1);
	note_reports(descriptor, &tracker);
	*out_tracker = tracker;
	return GZ_OK;
}

/* Bytes of a report, 0 if there is none. */
static size_t bytes_of(const struct gz_hid_tracker *tracker, enum gz_hid_report_type type,
		       uint8_t id)
{
	for (size_t i = 0; i < tracker->report_count; i++) {
		const struct gz_hid_report *report = &tracker->reports[i];
		if (report->type == type && report->id == id)
			return (report->bits + 7) / 8 + tracker->numbered;
	}
	return 0;
}

size_t gz_hid_tracker_bytes(const struct gz_hid_tracker *tracker, enum gz_hid_quantity quantity)
{
	const struct gz_hid_value *value = &tracker->values[quantity];
	return value->present ? bytes_of(tracker, value->type, value->report_id) : 0;
}

static void read_eye(const struct gz_hid_tracker *tracker, enum gz_hid_quantity first,
		     const unsigned char *bytes, size_t size, bool *out_has, double out_mm[3])
{
	*out_has = tracker->has_eyes;
	for (int axis = 0; axis < 3 && *out_has; axis++)
		*out_has = gz_hid_value_read(&tracker->values[(int)first + axis], bytes, size,
					     &out_mm[axis]) == GZ_HID_READ &&
			   fabs(out_mm[axis]) <= LENGTH_MAX_MM;
	*out_has = *out_has && fabs(out_mm[2]) >= LENGTH_MIN_MM;
}

static void read_tracking(const struct gz_hid_tracker *tracker, const unsigned char *bytes,
			  size_t size, struct gz_hid_input_report *report)
{
	report->kind = GZ_HID_INPUT_TRACKING;
	report->has_gaze = true;
	for (int axis = 0; axis < 2; axis++) {
		enum gz_hid_reading reading =
			gz_hid_value_read(&tracker->values[GZ_HID_GAZE_X + axis], bytes, size,
					  &report->gaze_mm[axis]);
		report->has_gaze = report->has_gaze && reading == GZ_HID_READ;
		if (reading == GZ_HID_READ_WRONG) {
			report->kind = GZ_HID_INPUT_MALFORMED;
			report->malformed = GZ_MALFORMED_VALUE;
		}
	}
	const struct gz_hid_value *ticks = &tracker->values[GZ_HID_TICKS];
	report->has_ticks = ticks->present;
	report->ticks = gz_hid_bits(bytes, size, ticks->at, ticks->bits);
	read_eye(tracker, GZ_HID_RIGHT_X, bytes, size, &report->has_eye[GZ_EYE_RIGHT],
		 report->eye_mm[GZ_EYE_RIGHT]);
	read_eye(tracker, GZ_HID_LEFT_X, bytes, size, &report->has_eye[GZ_EYE_LEFT],
		 report->eye_mm[GZ_EYE_LEFT]);
}

static bool is_in(const struct gz_hid_value *value, uint8_t id)
{
	return value->present && value->report_id == id;
}

static void read_status(const struct gz_hid_tracker *tracker, uint8_t id,
			const unsigned char *bytes, size_t size, struct gz_hid_input_report *report)
{
	const struct gz_hid_value *state = &tracker->values[GZ_HID_STATE_INPUT];
	const struct gz_hid_value *rate = &tracker->values[GZ_HID_RATE_INPUT];
	int64_t raw = 0;
	report->kind = GZ_HID_INPUT_STATUS;
	if (is_in(state, id)) {
		enum gz_hid_reading reading = gz_hid_value_raw(state, bytes, size, &raw);
		report->has_state = reading == GZ_HID_READ && raw >= 0 && raw <= INT32_MAX;
		report->state = report->has_state ? (int)raw : 0;
		if (reading == GZ_HID_READ_WRONG) {
			report->kind = GZ_HID_INPUT_MALFORMED;
			report->malformed = GZ_MALFORMED_VALUE;
		}
	}
	if (is_in(rate, id))
		report->has_rate =
			gz_hid_value_read(rate, bytes, size, &report->rate_hz) == GZ_HID_READ;
}

static void set_malformed(struct gz_hid_input_report *report, enum gz_malformed malformed)
{
	report->kind = GZ_HID_INPUT_MALFORMED;
	report->malformed = malformed;
}

void gz_hid_tracker_read(const struct gz_hid_tracker *tracker, const unsigned char *bytes,
			 size_t size, struct gz_hid_input_report *out_report)
{
	*out_report = (struct gz_hid_input_report) { .kind = GZ_HID_INPUT_OTHER };
	uint8_t id = tracker->numbered && size > 0 ? bytes[0] : 0;
	size_t expected = bytes_of(tracker, GZ_HID_INPUT, id);
	if (size == 0 || size < expected)
		set_malformed(out_report, GZ_MALFORMED_SHORT);
	else if (expected == 0)
		set_malformed(out_report, GZ_MALFORMED_SYNTAX);
	else if (size > tracker->longest[GZ_HID_INPUT])
		set_malformed(out_report, GZ_MALFORMED_LONG);
	else if (id == tracker->values[GZ_HID_GAZE_X].report_id)
		read_tracking(tracker, bytes + tracker->numbered, size - tracker->numbered,
			      out_report);
	else if (is_in(&tracker->values[GZ_HID_STATE_INPUT], id) ||
		 is_in(&tracker->values[GZ_HID_RATE_INPUT], id))
		read_status(tracker, id, bytes + tracker->numbered, size - tracker->numbered,
			    out_report);
}

static bool read_number(const struct gz_hid_tracker *tracker, enum gz_hid_quantity quantity,
			const unsigned char *bytes, size_t size, double *out_number)
{
	return gz_hid_value_read(&tracker->values[quantity], bytes, size, out_number) ==
	       GZ_HID_READ;
}

struct gz_hid_screen gz_hid_tracker_screen(const struct gz_hid_tracker *tracker,
					   const unsigned char *bytes, size_t size)
{
	struct gz_hid_screen screen = { 0 };
	screen.stated = read_number(tracker, GZ_HID_WIDTH, bytes, size, &screen.mm[0]) &&
			read_number(tracker, GZ_HID_HEIGHT, bytes, size, &screen.mm[1]);
	if (!screen.stated)
		return screen;
	double larger = fmax(screen.mm[0], screen.mm[1]);
	double smaller = fmin(screen.mm[0], screen.mm[1]);
	screen.believed = smaller >= LENGTH_MIN_MM && larger <= LENGTH_MAX_MM &&
			  larger <= SCREEN_RATIO_MAX * smaller;
	return screen;
}

static bool can_be(const struct gz_hid_distances *d)
{
	return d->nearest_mm >= DISTANCE_MIN_MM && d->nearest_mm <= d->optimum_mm &&
	       d->optimum_mm <= d->farthest_mm && d->farthest_mm <= DISTANCE_MAX_MM;
}

struct gz_hid_distances gz_hid_tracker_distances(const struct gz_hid_tracker *tracker,
						 const unsigned char *bytes, size_t size)
{
	struct gz_hid_distances d = { 0 };
	d.stated = read_number(tracker, GZ_HID_NEAREST, bytes, size, &d.nearest_mm) &&
		   read_number(tracker, GZ_HID_OPTIMUM, bytes, size, &d.optimum_mm) &&
		   read_number(tracker, GZ_HID_FARTHEST, bytes, size, &d.farthest_mm);
	d.believed = d.stated && can_be(&d);
	if (d.believed || !d.stated)
		return d;
	struct gz_hid_distances tenfold = d;
	tenfold.nearest_mm *= 10;
	tenfold.optimum_mm *= 10;
	tenfold.farthest_mm *= 10;
	tenfold.believed = tenfold.corrected = true;
	/* Nothing is tracked at less than a hand's width. */
	return d.optimum_mm < DISTANCE_MIN_MM && can_be(&tenfold) ? tenfold : d;
}

double gz_hid_believed_rate(double rate_hz)
{
	return rate_hz >= RATE_MIN_HZ && rate_hz <= RATE_MAX_HZ ? rate_hz : 0;
}

enum gz_result gz_hid_tracker_set_mode(const struct gz_hid_tracker *tracker, unsigned char *bytes,
				       size_t size, unsigned mode)
{
	const struct gz_hid_value *value = &tracker->values[GZ_HID_MODE];
	if (!value->present || value->at > size * 8 || value->bits > size * 8 - value->at)
		return GZ_ERR_NOT_FOUND;
	for (uint32_t i = 0; i < value->bits; i++) {
		unsigned char bit = (unsigned char)(1u << (value->at + i) % 8);
		unsigned char *byte = &bytes[(value->at + i) / 8];
		bool on = i < 32 && mode >> i & 1;
		*byte = (unsigned char)(on ? *byte | bit : *byte & ~bit);
	}
	return GZ_OK;
}
