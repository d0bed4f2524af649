/**
 * @file
 * What the name of a raw file says: numbers and how they are joined, a type, a byte order. Internal
 * to raw_guess.c.
 */
#ifndef GZ_RENDER_DATA_RAW_NAME_H
#define GZ_RENDER_DATA_RAW_NAME_H

#include <stdbool.h>
#include <stddef.h>

#define GZ_RAW_NAME_SIZE   256
#define GZ_RAW_NUMBERS_MAX 24
#define GZ_RAW_NAMED_TYPES 3

/** A number in a name. */
struct gz_raw_number {
	double value;
	bool is_whole; /**< no decimals */
	bool is_glued; /**< part of a word, as the 16 of "uint16" */
	char joint;    /**< the one character between it and the next number; 0: there is more */
};

/** A name, understood. */
struct gz_raw_name {
	char text[GZ_RAW_NAME_SIZE]; /**< lower case, without folder and endings */
	struct gz_raw_number numbers[GZ_RAW_NUMBERS_MAX];
	size_t number_count;
	int types[GZ_RAW_NAMED_TYPES]; /**< enum gz_raw_type, the likeliest first */
	size_t type_count;             /**< 0: none is named */
	const char *type_word;         /**< how it is named; static */
	bool big_endian;
	double spacing[3]; /**< 1 where none is named */
	bool has_spacing;
};

/** Read a name. */
void gz_raw_name_read(const char *path, struct gz_raw_name *out_name);

/** Types that voxels of so many bits may have, the likeliest first. @return how many; 0: none */
size_t gz_raw_types_of_bits(int bits, int out_types[GZ_RAW_NAMED_TYPES]);

#endif
