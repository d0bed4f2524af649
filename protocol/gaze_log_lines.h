/**
 * @file
 * Lines and fields of a gaze log; for the files of this folder that implement gaze_log.h. Numbers
 * are printed and read with a full stop as decimal point, in every locale.
 */
#ifndef GZ_PROTOCOL_GAZE_LOG_LINES_H
#define GZ_PROTOCOL_GAZE_LOG_LINES_H

#include <locale.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "protocol/gaze_log.h"

/** The characters that are escaped in a text, and the letters that stand for them after a
 * backslash, in the same order. */
#define GZ_GAZE_LOG_ESCAPED        "\\\t\n\r"
#define GZ_GAZE_LOG_ESCAPE_LETTERS "\\tnr"

/** What a scene record says: nothing moves, or something may. */
#define GZ_GAZE_LOG_STILL  "still"
#define GZ_GAZE_LOG_MOVING "moving"

/** Text that is printed into the caller's buffer. Once the buffer is full, nothing more is added.
 */
struct gz_gaze_log_text {
	char *bytes;
	size_t size, length;
	bool full;
};

/** Begin an empty text in @p size bytes at @p bytes, which are the caller's. They include the NUL.
 */
void gz_gaze_log_text_begin(struct gz_gaze_log_text *text, char *bytes, size_t size);

/** End the text. @return GZ_OK with the length without the NUL, or GZ_ERR_FULL */
enum gz_result gz_gaze_log_text_end(struct gz_gaze_log_text *text, size_t *out_length);

/** Append text, formatted as by printf(). For numbers with a decimal point see below. */
__attribute__((format(printf, 2, 3))) void gz_gaze_log_text_print(struct gz_gaze_log_text *text,
								  const char *format, ...);

/** Append @p plain; a backslash, tab, newline or carriage return becomes two characters. */
void gz_gaze_log_text_print_escaped(struct gz_gaze_log_text *text, const char *plain);

/** Append "%.9g", which keeps a float exactly; "inf" or "-inf"; nothing for NaN. */
void gz_gaze_log_text_print_float(struct gz_gaze_log_text *text, float value);

/** Append fifteen digits if they keep @p value exactly, otherwise seventeen. */
void gz_gaze_log_text_print_double(struct gz_gaze_log_text *text, double value);

/*
 * Readers of one field. They accept all of @p field or refuse it: no blanks around a number, no
 * hexadecimal, nothing that is outside the type. They return false if they refuse it.
 */

/** Read decimal digits, with a '-' if negative. */
bool gz_field_int64(const char *field, int64_t *out_value);

/** Read decimal digits without a sign. */
bool gz_field_uint64(const char *field, uint64_t *out_value);

/** Read eight hexadecimal digits, lower case. */
bool gz_field_crc(const char *field, uint32_t *out_value);

/** Read a number; an empty field is NaN; "inf" and "-inf" are accepted. @p c_locale: newlocale() of
 * "C". */
bool gz_field_float(const char *field, locale_t c_locale, float *out_value);

/** Read a finite number; an empty field is refused. */
bool gz_field_double(const char *field, locale_t c_locale, double *out_value);

/** Undo gz_gaze_log_text_print_escaped(). An unknown escape is refused, and a text longer than
 *  @p size with its NUL. */
bool gz_field_text(const char *field, char *out_plain, size_t size);

/*
 * Readers of one line. Each takes a line without its newline, ended by a NUL, and cuts it into
 * fields in place.
 */

/** Which header lines have been read. Each may come once; the display needs three of them. */
struct gz_gaze_log_header_state {
	unsigned seen;
	struct gz_display display; /**< as far as it has been read */
};

/** Whether this is the first line of a gaze log of version 1. */
bool gz_gaze_log_parse_version(char *line);

/**
 * Read one line "#key value" into @p header. Unknown keys are ignored: later versions may have
 * more.
 *
 * @return NULL, or what is wrong with the line
 */
const char *gz_gaze_log_parse_header(char *line, locale_t c_locale,
				     struct gz_gaze_log_header_state *state,
				     struct gz_gaze_log_header *header);

/**
 * Read the line of a record.
 *
 * @param[out] out_record  unspecified on failure
 * @return NULL, or what is wrong with the line
 */
const char *gz_gaze_log_parse_record(char *line, locale_t c_locale,
				     struct gz_gaze_log_record *out_record);

/** Read "#end samples crc". @return false if the line is malformed */
bool gz_gaze_log_parse_end(char *line, uint64_t *out_samples, uint32_t *out_crc);

#endif
