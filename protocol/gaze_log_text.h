/**
 * @file
 * Numbers and escaped text of a gaze log; for this folder. Whatever locale the application has set,
 * numbers are written and read with a decimal point.
 */
#ifndef GZ_PROTOCOL_GAZE_LOG_TEXT_H
#define GZ_PROTOCOL_GAZE_LOG_TEXT_H

#include <locale.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/result.h"

/** Text being printed into the caller's buffer. Once it is full everything further is ignored. */
struct gz_text {
	char *bytes;
	size_t size, length;
	bool full;
};

/** Begin an empty text in @p size bytes at @p bytes, the caller's, NUL included. */
void gz_text_begin(struct gz_text *text, char *bytes, size_t size);
/** GZ_OK with the length written, or GZ_ERR_FULL. */
enum gz_result gz_text_end(struct gz_text *text, size_t *out_length);

/** Append as printf() does. Numbers with a decimal point have functions of their own. */
__attribute__((format(printf, 2, 3))) void gz_text_print(struct gz_text *text, const char *format,
							 ...);
/** Backslash, tab, newline and carriage return become two characters each. */
void gz_text_print_escaped(struct gz_text *text, const char *plain);
/** "%.9g", which keeps a float exactly; "inf" or "-inf"; nothing for NaN. */
void gz_text_print_float(struct gz_text *text, float value);
/** Fifteen digits where they keep @p value exactly, else seventeen. */
void gz_text_print_double(struct gz_text *text, double value);

/*
 * Readers of one field. They take all of @p field or refuse it: no blanks around a number, no
 * hexadecimal, nothing that does not fit the type.
 */

/** Decimal, with a '-' where negative. */
bool gz_field_int64(const char *field, int64_t *out_value);
/** Digits only, no sign. */
bool gz_field_uint64(const char *field, uint64_t *out_value);
/** Eight lower-case hexadecimal digits. */
bool gz_field_crc(const char *field, uint32_t *out_value);
/** Empty is NaN; "inf" and "-inf" are read. @p c_locale: newlocale() of "C". */
bool gz_field_float(const char *field, locale_t c_locale, float *out_value);
/** Finite; empty is refused. */
bool gz_field_double(const char *field, locale_t c_locale, double *out_value);
/** Undo gz_text_print_escaped(). @return false for an unknown escape, or text too long for @p size.
 */
bool gz_field_text(const char *field, char *out_plain, size_t size);

#endif
