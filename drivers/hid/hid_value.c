#include "drivers/hid/hid_value.h"

#include <math.h>

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

static int nibble(uint32_t unit, int at)
{
	int value = (int)(unit >> (4 * at) & 0xf);
	return value < 8 ? value : value - 16;
}

/* Whether the unit is one dimension to a power, and nothing else. */
static bool is_power(uint32_t unit, int at, int power)
{
	for (int i = 1; i < NIBBLES; i++) {
		if (nibble(unit, i) != (i == at ? power : 0))
			return false;
	}
	return true;
}

static double length_factor(uint32_t unit)
{
	unsigned system = unit & 0xf;
	if (!is_power(unit, AT_LENGTH, 1))
		return 0;
	return system == SYSTEM_SI_LINEAR        ? MM_PER_CM
	       : system == SYSTEM_ENGLISH_LINEAR ? MM_PER_INCH
						 : 0;
}

enum gz_result gz_hid_unit_factor(uint32_t unit, int exponent, enum gz_hid_dimension dimension,
				  double *out_factor)
{
	double factor = 0;
	/* A time is in seconds in every system. */
	bool known = (unit & 0xf) >= SYSTEM_SI_LINEAR && (unit & 0xf) <= SYSTEM_ENGLISH_ROTATION;
	if (dimension == GZ_HID_NUMBER) {
		*out_factor = 1;
		return GZ_OK;
	}
	if (unit >> 4 == 0)
		return GZ_ERR_NOT_FOUND;
	if (dimension == GZ_HID_LENGTH)
		factor = length_factor(unit);
	else if (dimension == GZ_HID_TIME && known && is_power(unit, AT_TIME, 1))
		factor = NS_PER_S;
	else if (dimension == GZ_HID_FREQUENCY && known && is_power(unit, AT_TIME, -1))
		factor = 1;
	if (factor == 0)
		return GZ_ERR_FORMAT;
	*out_factor = factor * pow(10, exponent);
	return GZ_OK;
}

/* What a number without a unit most likely means. */
static double guessed_factor(enum gz_hid_dimension dimension)
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

/* From the logical range to the physical one. */
static enum gz_result set_scale(const struct gz_hid_field *field, double factor,
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
		factor = guessed_factor(dimension);
	}
	result = set_scale(field, factor, &value);
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
