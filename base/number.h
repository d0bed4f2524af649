/**
 * @file
 * Numbers in text, read and printed the same in every locale.
 */
#ifndef GZ_BASE_NUMBER_H
#define GZ_BASE_NUMBER_H

#include <stdbool.h>

/**
 * Read one decimal number that is the whole of @p word: no blanks, no "nan", "inf" or hexadecimal.
 *
 * @param[out] out_value  finite; written only on true
 */
bool gz_number_parse(const char *word, double *out_value);

/** As gz_number_parse() for a whole number that an int64_t holds; decimal digits and a sign. */
bool gz_number_parse_whole(const char *word, long long *out_value);

/**
 * Make the decimal point of a number that printf() printed by "%g" a full stop, whatever the locale
 * has.
 *
 * @param[in,out] number  NUL-terminated; digits, sign, exponent and at most one point
 */
void gz_number_normalise_point(char *number);

/** Room for a number that gz_number_print() prints, with its NUL. */
#define GZ_NUMBER_SIZE 32

/** Print a finite number with the fewest digits that read back as the same double. */
void gz_number_print(double value, char text[GZ_NUMBER_SIZE]);

/** The number with the fewest digits that, as a float, is @p value: 0.1 for 0.1F, whose own
 *  nearest double is 0.100000001490116. For text that is read back as a float. */
double gz_number_of_float(float value);

/**
 * Cut the first word off @p *text, which is moved behind it.
 *
 * @param[in,out] text     NUL-terminated; changed: the blank behind the word becomes its NUL
 * @param         blanks   what separates words
 * @return the word, or NULL where only blanks are left
 */
char *gz_number_next_word(char **text, const char *blanks);

#endif
