#include "drivers/hid/hid_tracker.h"

#include <math.h>
#include <string.h>

/* Nibbles of a unit (6.2.2.7). */
enum {
	SYSTEM_SI_LINEAR = 1,
	SYSTEM_ENGLISH_LINEAR = 3,
	SYSTEM_ENGLISH_ROTATION = 4,
	AT_LENGTH = 1,
	AT_TIME = 3,
	NIBBLES = 7,
};

static const double MM_PER_CM = 10, MM_PER_INCH = 25.4, NS_PER_S = 1e9, MM_PER_UM = 1e-3;

static int unit_nibble(uint32_t unit, int at)
{
	int value = (int)(unit >> (4 * at) & 0xf);
	return value < 8 ? value : value - 16;
}

/* Whether the unit is a power of one dimension and nothing else. */
static bool is_unit_power(uint32_t unit, int at, int power)
{
	for (int i = 1; i < NIBBLES; i++) {
		if (unit_nibble(unit, i) != (i == at ? power : 0))
			return false;
	}
	return true;
}

static double length_unit_factor(uint32_t unit)
{
	unsigned system = unit & 0xf;
	if (!is_unit_power(unit, AT_LENGTH, 1))
		return 0;
	return system == SYSTEM_SI_LINEAR        ? MM_PER_CM
	       : system == SYSTEM_ENGLISH_LINEAR ? MM_PER_INCH
						 : 0;
}

enum gz_result gz_hid_unit_factor(uint32_t unit, int exponent, enum gz_hid_dimension dimension,
				  double *out_factor)
{
	double factor = 0;
	/* Time is in seconds in every system of units. */
	bool known = (unit & 0xf) >= SYSTEM_SI_LINEAR && (unit & 0xf) <= SYSTEM_ENGLISH_ROTATION;
	if (dimension == GZ_HID_NUMBER) {
		*out_factor = 1;
		return GZ_OK;
	}
	if (unit >> 4 == 0)
		return GZ_ERR_NOT_FOUND;
	if (dimension == GZ_HID_LENGTH)
		factor = length_unit_factor(unit);
	else if (dimension == GZ_HID_TIME && known && is_unit_power(unit, AT_TIME, 1))
		factor = NS_PER_S;
	else if (dimension == GZ_HID_FREQUENCY && known && is_unit_power(unit, AT_TIME, -1))
		factor = 1;
	if (factor == 0)
		return GZ_ERR_FORMAT;
	*out_factor = factor * pow(10, exponent);
	return GZ_OK;
}

/* The most likely unit of a number without one. */
static double guessed_unit_factor(enum gz_hid_dimension dimension)
{
	switch (dimension) {
	case GZ_HID_LENGTH:
		return MM_PER_UM;
	case GZ_HID_TIME:
		return 0;
	default:
		return 1;
	}
}

/* Set the scale from the logical to the physical range. */
static enum gz_result set_value_scale(const struct gz_hid_field *field, double factor,
				      struct gz_hid_value *value)
{
	double logical = (double)field->logical_max - (double)field->logical_min;
	double physical = (double)field->physical_max - (double)field->physical_min;
	double slope = logical > 0 ? physical / logical : 1;
	if (slope == 0)
		return GZ_ERR_FORMAT;
	value->scale = slope * factor;
	value->offset = ((double)field->physical_min - (double)field->logical_min * slope) * factor;
	return GZ_OK;
}

enum gz_result gz_hid_value_from_field(const struct gz_hid_field *field, uint32_t index,
				       enum gz_hid_dimension dimension,
				       struct gz_hid_value *out_value)
{
	double factor;
	if (field->bit_size > 64 || index >= field->count)
		return GZ_ERR_UNSUPPORTED;
	struct gz_hid_value value = {
		.present = true,
		.has_unit = true,
		.is_signed = field->logical_min < 0,
		.nullable = field->flags & GZ_HID_FLAG_NULL,
		.has_range = field->logical_min < field->logical_max,
		.at = field->bit_offset + index * field->bit_size,
		.bits = field->bit_size,
		.report_id = field->report_id,
		.type = field->type,
		.raw_min = field->logical_min,
		.raw_max = field->logical_max,
	};
	enum gz_result result =
		gz_hid_unit_factor(field->unit, field->unit_exponent, dimension, &factor);
	if (result == GZ_ERR_FORMAT)
		return result;
	if (result == GZ_ERR_NOT_FOUND) {
		value.has_unit = false;
		factor = guessed_unit_factor(dimension);
	}
	result = set_value_scale(field, factor, &value);
	if (result == GZ_OK)
		*out_value = value;
	return result;
}

uint64_t gz_hid_bits(const unsigned char *bytes, size_t size, size_t at, unsigned count)
{
	uint64_t value = 0;
	if (count > 64 || at > size * 8 || count > size * 8 - at)
		return 0;
	for (unsigned got = 0; got < count;) {
		unsigned within = (at + got) % 8;
		unsigned take = 8 - within < count - got ? 8 - within : count - got;
		uint64_t part = (uint64_t)bytes[(at + got) / 8] >> within & ((1u << take) - 1);
		value |= part << got;
		got += take;
	}
	return value;
}

enum gz_hid_reading gz_hid_value_raw(const struct gz_hid_value *value, const unsigned char *bytes,
				     size_t size, int64_t *out_raw)
{
	if (!value->present || value->at > size * 8 || value->bits > size * 8 - value->at)
		return GZ_HID_READ_WRONG;
	uint64_t bits = gz_hid_bits(bytes, size, value->at, value->bits);
	uint64_t sign = value->bits > 0 ? UINT64_C(1) << (value->bits - 1) : 0;
	if (value->is_signed && bits & sign)
		bits |= ~(sign - 1);
	int64_t raw = (int64_t)bits;
	if (value->has_range && (raw < value->raw_min || raw > value->raw_max))
		return value->nullable ? GZ_HID_READ_NULL : GZ_HID_READ_WRONG;
	*out_raw = raw;
	return GZ_HID_READ;
}

enum gz_hid_reading gz_hid_value_read(const struct gz_hid_value *value, const unsigned char *bytes,
				      size_t size, double *out_number)
{
	int64_t raw;
	enum gz_hid_reading reading = gz_hid_value_raw(value, bytes, size, &raw);
	if (reading == GZ_HID_READ)
		*out_number = (double)raw * value->scale + value->offset;
	return reading;
}

/* Where a quantity is: its usage, within collections of one or two usages. */
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

/* Smallest and largest distance of an eye, or side of a screen, that is believed, mm. Chosen: from
 * a phone in the hand to a wall. */
static const double LENGTH_MIN_MM = 50, LENGTH_MAX_MM = 5000;
static const double SCREEN_RATIO_MAX = 6;
static const double DISTANCE_MIN_MM = 100, DISTANCE_MAX_MM = 5000;
static const double RATE_MIN_HZ = 1, RATE_MAX_HZ = 10000;

static bool is_eye_tracker_collection(const struct gz_hid_collection *collection)
{
	return collection->usage == GZ_HID_EYE_TRACKER &&
	       collection->type == GZ_HID_COLLECTION_APPLICATION;
}

size_t gz_hid_tracker_count(const struct gz_hid_descriptor *descriptor)
{
	size_t count = 0;
	for (size_t i = 0; i < descriptor->collection_count; i++)
		count += is_eye_tracker_collection(&descriptor->collections[i]);
	return count;
}

static int find_application(const struct gz_hid_descriptor *descriptor, size_t index)
{
	for (size_t i = 0; i < descriptor->collection_count; i++) {
		if (is_eye_tracker_collection(&descriptor->collections[i]) && index-- == 0)
			return (int)i;
	}
	return GZ_HID_NO_COLLECTION;
}

static bool is_within_collection(const struct gz_hid_descriptor *descriptor, int collection,
				 int outer)
{
	while (collection != GZ_HID_NO_COLLECTION && collection != outer)
		collection = descriptor->collections[collection].parent;
	return collection == outer;
}

static bool is_field_at(const struct gz_hid_descriptor *descriptor, int application,
			const struct gz_hid_field *field, const struct place *place)
{
	return field->type == place->type && field->flags & GZ_HID_FLAG_VARIABLE &&
	       place->usage >= field->usage && place->usage <= field->usage_last &&
	       place->usage - field->usage < field->count &&
	       is_within_collection(descriptor, field->collection, application) &&
	       gz_hid_within(descriptor, field->collection, place->outer) &&
	       (!place->inner || gz_hid_within(descriptor, field->collection, place->inner));
}

/* The first usable field of a quantity, in report @p id if that is not negative. */
static struct gz_hid_value find_quantity(const struct gz_hid_descriptor *descriptor,
					 int application, enum gz_hid_quantity quantity, int id)
{
	const struct place *place = &places[quantity];
	struct gz_hid_value value = { 0 };
	for (size_t i = 0; i < descriptor->field_count; i++) {
		const struct gz_hid_field *field = &descriptor->fields[i];
		if (is_field_at(descriptor, application, field, place) &&
		    (id < 0 || field->report_id == id) &&
		    gz_hid_value_from_field(field, place->usage - field->usage, place->dimension,
					    &value) == GZ_OK)
			return value;
	}
	return value;
}

/* Find the time stamp: one number, several elements, or several adjacent fields. Its range is
 * ignored, because no descriptor can state the range of a 64-bit number. */
static struct gz_hid_value find_time_stamp(const struct gz_hid_descriptor *descriptor,
					   int application, int id, bool *out_refused)
{
	struct gz_hid_value ticks = { 0 };
	const struct place *place = &places[GZ_HID_TICKS];
	*out_refused = false;
	for (size_t i = 0; i < descriptor->field_count; i++) {
		const struct gz_hid_field *field = &descriptor->fields[i];
		if (field->report_id != id || !is_field_at(descriptor, application, field, place))
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

static void find_tracking_report(const struct gz_hid_descriptor *descriptor, int application,
				 int id, struct gz_hid_tracker *tracker)
{
	for (int quantity = GZ_HID_GAZE_X; quantity <= GZ_HID_LEFT_Z; quantity++)
		tracker->values[quantity] = find_quantity(descriptor, application, quantity, id);
	tracker->values[GZ_HID_TICKS] =
		find_time_stamp(descriptor, application, id, &tracker->time_refused);
	tracker->has_eyes = true;
	for (int quantity = GZ_HID_RIGHT_X; quantity <= GZ_HID_LEFT_Z; quantity++)
		tracker->has_eyes = tracker->has_eyes && tracker->values[quantity].present;
}

static void copy_report_table(const struct gz_hid_descriptor *descriptor,
			      struct gz_hid_tracker *tracker)
{
	tracker->report_count = descriptor->report_count;
	memcpy(tracker->reports, descriptor->reports,
	       sizeof *descriptor->reports * descriptor->report_count);
	for (int type = 0; type < GZ_HID_REPORT_TYPES; type++)
		tracker->longest[type] = gz_hid_longest_report(descriptor, type);
}

static enum gz_result refuse_tracker(const char **out_reason, enum gz_result result,
				     const char *reason)
{
	if (out_reason)
		*out_reason = reason;
	return result;
}

enum gz_result gz_hid_tracker_find(const struct gz_hid_descriptor *descriptor, size_t index,
				   struct gz_hid_tracker *out_tracker, const char **out_reason)
{
	int application = find_application(descriptor, index);
	struct gz_hid_tracker tracker = { .numbered = descriptor->numbered };
	if (application == GZ_HID_NO_COLLECTION)
		return refuse_tracker(out_reason, GZ_ERR_NOT_FOUND, "it has no eye tracker");
	/* Read the report that holds both coordinates of the gaze point. */
	for (size_t i = 0; i < descriptor->report_count; i++) {
		const struct gz_hid_report *report = &descriptor->reports[i];
		if (report->type != GZ_HID_INPUT)
			continue;
		find_tracking_report(descriptor, application, report->id, &tracker);
		if (tracker.values[GZ_HID_GAZE_X].present && tracker.values[GZ_HID_GAZE_Y].present)
			break;
	}
	if (!tracker.values[GZ_HID_GAZE_X].present || !tracker.values[GZ_HID_GAZE_Y].present)
		return refuse_tracker(out_reason, GZ_ERR_FORMAT,
				      "its tracking data have no gaze point in a unit of length");
	for (int quantity = GZ_HID_STATE_INPUT; quantity < GZ_HID_QUANTITIES; quantity++)
		tracker.values[quantity] = find_quantity(descriptor, application, quantity, -1);
	copy_report_table(descriptor, &tracker);
	*out_tracker = tracker;
	return GZ_OK;
}

/* Bytes of a report; 0 if there is none. */
static size_t report_size(const struct gz_hid_tracker *tracker, enum gz_hid_report_type type,
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
	return value->present ? report_size(tracker, value->type, value->report_id) : 0;
}

static void read_eye_position(const struct gz_hid_tracker *tracker, int eye,
			      const unsigned char *bytes, size_t size,
			      struct gz_hid_input_report *report)
{
	int first = eye == GZ_EYE_RIGHT ? GZ_HID_RIGHT_X : GZ_HID_LEFT_X;
	double *mm = report->eye_mm[eye];
	bool has = tracker->has_eyes;
	for (int axis = 0; axis < 3 && has; axis++)
		has = gz_hid_value_read(&tracker->values[first + axis], bytes, size, &mm[axis]) ==
			      GZ_HID_READ &&
		      fabs(mm[axis]) <= LENGTH_MAX_MM;
	report->has_eye[eye] = has && fabs(mm[2]) >= LENGTH_MIN_MM;
}

static void read_tracking_report(const struct gz_hid_tracker *tracker, const unsigned char *bytes,
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
	for (int eye = 0; eye < GZ_EYE_COUNT; eye++)
		read_eye_position(tracker, eye, bytes, size, report);
}

static bool is_in_report(const struct gz_hid_value *value, uint8_t id)
{
	return value->present && value->report_id == id;
}

static void read_status_report(const struct gz_hid_tracker *tracker, uint8_t id,
			       const unsigned char *bytes, size_t size,
			       struct gz_hid_input_report *report)
{
	const struct gz_hid_value *state = &tracker->values[GZ_HID_STATE_INPUT];
	const struct gz_hid_value *rate = &tracker->values[GZ_HID_RATE_INPUT];
	int64_t raw = 0;
	report->kind = GZ_HID_INPUT_STATUS;
	if (is_in_report(state, id)) {
		enum gz_hid_reading reading = gz_hid_value_raw(state, bytes, size, &raw);
		report->has_state = reading == GZ_HID_READ && raw >= 0 && raw <= INT32_MAX;
		report->state = report->has_state ? (int)raw : 0;
		if (reading == GZ_HID_READ_WRONG) {
			report->kind = GZ_HID_INPUT_MALFORMED;
			report->malformed = GZ_MALFORMED_VALUE;
		}
	}
	if (is_in_report(rate, id))
		report->has_rate =
			gz_hid_value_read(rate, bytes, size, &report->rate_hz) == GZ_HID_READ;
}

static void set_report_malformed(struct gz_hid_input_report *report, enum gz_malformed malformed)
{
	report->kind = GZ_HID_INPUT_MALFORMED;
	report->malformed = malformed;
}

void gz_hid_tracker_read(const struct gz_hid_tracker *tracker, const unsigned char *bytes,
			 size_t size, struct gz_hid_input_report *out_report)
{
	*out_report = (struct gz_hid_input_report) { .kind = GZ_HID_INPUT_OTHER };
	uint8_t id = tracker->numbered && size > 0 ? bytes[0] : 0;
	size_t expected = report_size(tracker, GZ_HID_INPUT, id);
	if (size == 0 || size < expected)
		set_report_malformed(out_report, GZ_MALFORMED_SHORT);
	else if (expected == 0)
		set_report_malformed(out_report, GZ_MALFORMED_SYNTAX);
	else if (size > tracker->longest[GZ_HID_INPUT])
		set_report_malformed(out_report, GZ_MALFORMED_LONG);
	else if (id == tracker->values[GZ_HID_GAZE_X].report_id)
		read_tracking_report(tracker, bytes + tracker->numbered, size - tracker->numbered,
				     out_report);
	else if (is_in_report(&tracker->values[GZ_HID_STATE_INPUT], id) ||
		 is_in_report(&tracker->values[GZ_HID_RATE_INPUT], id))
		read_status_report(tracker, id, bytes + tracker->numbered, size - tracker->numbered,
				   out_report);
}

static bool read_quantity(const struct gz_hid_tracker *tracker, enum gz_hid_quantity quantity,
			  const unsigned char *bytes, size_t size, double *out_number)
{
	return gz_hid_value_read(&tracker->values[quantity], bytes, size, out_number) ==
	       GZ_HID_READ;
}

struct gz_hid_screen gz_hid_tracker_screen(const struct gz_hid_tracker *tracker,
					   const unsigned char *bytes, size_t size)
{
	struct gz_hid_screen screen = { 0 };
	screen.stated = read_quantity(tracker, GZ_HID_WIDTH, bytes, size, &screen.mm[0]) &&
			read_quantity(tracker, GZ_HID_HEIGHT, bytes, size, &screen.mm[1]);
	if (!screen.stated)
		return screen;
	double larger = fmax(screen.mm[0], screen.mm[1]);
	double smaller = fmin(screen.mm[0], screen.mm[1]);
	screen.believed = smaller >= LENGTH_MIN_MM && larger <= LENGTH_MAX_MM &&
			  larger <= SCREEN_RATIO_MAX * smaller;
	return screen;
}

static bool are_distances_possible(const struct gz_hid_distances *d)
{
	return d->nearest_mm >= DISTANCE_MIN_MM && d->nearest_mm <= d->optimum_mm &&
	       d->optimum_mm <= d->farthest_mm && d->farthest_mm <= DISTANCE_MAX_MM;
}

struct gz_hid_distances gz_hid_tracker_distances(const struct gz_hid_tracker *tracker,
						 const unsigned char *bytes, size_t size)
{
	struct gz_hid_distances d = { 0 };
	d.stated = read_quantity(tracker, GZ_HID_NEAREST, bytes, size, &d.nearest_mm) &&
		   read_quantity(tracker, GZ_HID_OPTIMUM, bytes, size, &d.optimum_mm) &&
		   read_quantity(tracker, GZ_HID_FARTHEST, bytes, size, &d.farthest_mm);
	d.believed = d.stated && are_distances_possible(&d);
	if (d.believed || !d.stated)
		return d;
	struct gz_hid_distances tenfold = d;
	tenfold.nearest_mm *= 10;
	tenfold.optimum_mm *= 10;
	tenfold.farthest_mm *= 10;
	tenfold.believed = tenfold.corrected = true;
	/* Nothing is tracked closer than a hand's width. */
	return d.optimum_mm < DISTANCE_MIN_MM && are_distances_possible(&tenfold) ? tenfold : d;
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
