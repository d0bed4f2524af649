/**
 * @file
 * Reading single lines of a gaze log; for the reader in this folder. Each takes a line without its
 * newline, ended by a NUL, and cuts it into fields in place.
 */
#ifndef GZ_PROTOCOL_GAZE_LOG_PARSE_H
#define GZ_PROTOCOL_GAZE_LOG_PARSE_H

#include <locale.h>

#include "protocol/gaze_log.h"

/** Which header lines have been seen: each may come once, the three of the display together. */
struct gz_gaze_log_header_state {
	unsigned seen;
	struct gz_display display;
};

/** Whether this is the first line of a gaze log of version 1. */
bool gz_gaze_log_parse_version(char *line);

/**
 * Read one line "#key value" into @p header; unknown keys are left to later versions.
 *
 * @return NULL, or what is wrong with it
 */
const char *gz_gaze_log_parse_header(char *line, locale_t c_locale,
				     struct gz_gaze_log_header_state *state,
				     struct gz_gaze_log_header *header);

/** Read the line of a record. @return NULL, or what is wrong with it; then *out_record is
 *  unspecified. */
const char *gz_gaze_log_parse_record(char *line, locale_t c_locale,
				     struct gz_gaze_log_record *out_record);

/** Read "#end samples crc". */
bool gz_gaze_log_parse_end(char *line, uint64_t *out_samples, uint32_t *out_crc);

#endif
