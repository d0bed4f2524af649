/**
 * @file
 * A check of a calibration for people, for programs and as a picture.
 */
#ifndef GZ_CLIENT_GAZECTL_VALIDATE_VALIDATION_REPORT_H
#define GZ_CLIENT_GAZECTL_VALIDATE_VALIDATION_REPORT_H

#include <stdio.h>

#include "client/gazectl/json.h"
#include "client/gazectl/validate/validation.h"

/** Print a table: a line for each target, for both eyes together and for each eye, and what a
 * correction would do. The caller looks at ferror(). */
void gz_validation_print(const struct gz_validation *validation, FILE *out);

/** Write everything as one JSON object. Angles in degrees, times in ns of the host's monotonic
 * clock, places on the display from 0 to 1; null where there was too little to tell. */
void gz_validation_write_json(const struct gz_validation *validation, FILE *out);

/** Draw the display as SVG 1.1: targets, the samples that count, and the way from each target to
 * the mean of its samples. */
void gz_validation_draw(const struct gz_validation *validation, FILE *out);

#endif
