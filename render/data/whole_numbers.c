#include "render/data/whole_numbers.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

/* Integers up to this magnitude are floats (IEEE 754: 24 bits of significand). */
#define EXACT_MOST 0x1p24

static void convert_words(const uint8_t *source, size_t count, bool swap, uint32_t flip,
			  void *target)
{
	uint8_t *out = target;
	for (size_t i = 0; i < count; i++) {
		uint32_t word;
		memcpy(&word, source + i * sizeof word, sizeof word);
		word = (swap ? __builtin_bswap32(word) : word) ^ flip;
		memcpy(out + i * sizeof word, &word, sizeof word);
	}
}

static void convert_signed(const uint8_t *source, size_t count, bool swap, void *target)
{
	convert_words(source, count, swap, 0, target);
}

/* Flipping the highest bit subtracts half the range. */
static void convert_unsigned(const uint8_t *source, size_t count, bool swap, void *target)
{
	convert_words(source, count, swap, UINT32_C(1) << 31, target);
}

const struct gz_voxel_conversion *gz_whole_number_words(enum gz_raw_type type)
{
	static const struct gz_voxel_conversion from_signed = { 4, GZ_VOXEL_F32, 0,
								convert_signed };
	static const struct gz_voxel_conversion from_unsigned = { 4, GZ_VOXEL_F32, 0x1p31,
								  convert_unsigned };
	return type == GZ_RAW_INT32 ? &from_signed : type == GZ_RAW_UINT32 ? &from_unsigned : NULL;
}

static int32_t word_at(const void *words, size_t index)
{
	int32_t word;
	memcpy(&word, (const uint8_t *)words + index * sizeof word, sizeof word);
	return word;
}

void gz_whole_numbers_widen(const void *words, size_t count, double offset, double range[2])
{
	int32_t least = INT32_MAX, greatest = INT32_MIN;
	for (size_t i = 0; i < count; i++) {
		const int32_t word = word_at(words, i);
		least = word < least ? word : least;
		greatest = word > greatest ? word : greatest;
	}
	if (count == 0)
		return;
	range[0] = fmin(range[0], least + offset);
	range[1] = fmax(range[1], greatest + offset);
}

double gz_whole_numbers_shift(const double range[2])
{
	const double magnitude = fmax(fabs(range[0]), fabs(range[1]));
	return magnitude > EXACT_MOST && range[1] - range[0] <= EXACT_MOST ? range[0] : 0;
}

void gz_whole_numbers_store(void *words, size_t count, struct gz_whole_storing *storing)
{
	const double change = storing->offset - storing->shift;
	uint8_t *out = words;
	storing->rounded = 0;
	storing->worst = 0;
	for (size_t i = 0; i < count; i++) {
		const double exact = word_at(words, i) + change;
		const float stored = (float)exact;
		const double error = fabs((double)stored - exact);
		storing->rounded += error > 0;
		storing->worst = fmax(storing->worst, error);
		memcpy(out + i * sizeof stored, &stored, sizeof stored);
	}
}
