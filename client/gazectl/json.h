/**
 * @file
 * Writes JSON (RFC 8259), indented by two blanks a level, to a stdio stream. A key of NULL is for
 * the elements of a list and for the outermost value. The caller looks at ferror() at the end.
 */
#ifndef GZ_CLIENT_GAZECTL_JSON_H
#define GZ_CLIENT_GAZECTL_JSON_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "protocol/display.h"

/** A value being written. Zero-initialised but for out is ready. */
struct gz_json {
	FILE *out;
	int depth;
	bool continued; /**< something stands before on this level */
};

/** Begin an object: "{". */
void gz_json_begin(struct gz_json *json, const char *key);
/** End the object begun last; the outermost ends its line. */
void gz_json_end(struct gz_json *json);
/** Begin a list: "[". */
void gz_json_begin_list(struct gz_json *json, const char *key);
/** End the list begun last. */
void gz_json_end_list(struct gz_json *json);

/** Text in UTF-8; bytes that are none become U+FFFD. */
void gz_json_text(struct gz_json *json, const char *key, const char *text);
/** A number with up to 12 digits; null where it is not finite, for which JSON has no word. */
void gz_json_double(struct gz_json *json, const char *key, double value);
/** A whole number. */
void gz_json_int(struct gz_json *json, const char *key, int64_t value);
/** A whole number from 0. */
void gz_json_uint(struct gz_json *json, const char *key, uint64_t value);
/** true or false. */
void gz_json_bool(struct gz_json *json, const char *key, bool value);

/** A display's geometry: an object of px, mm and distance_mm. */
void gz_json_display(struct gz_json *json, const char *key, const struct gz_display *display);

#endif
