/**
 * @file
 * Units of length that files name for their spacing.
 */
#ifndef GZ_RENDER_DATA_LENGTH_UNIT_H
#define GZ_RENDER_DATA_LENGTH_UNIT_H

#include <stdbool.h>

#include "base/log.h"

/**
 * The length of a unit.
 *
 * @param name  "um", "micrometers", "metre", …; m, cm, mm, um (with µ too) and nm by their usual
 *              names, in any case
 * @param[out] out_mm  in mm; written if the unit is known
 */
bool gz_length_unit_mm(const char *name, double *out_mm);

/**
 * The factor that turns lengths of a file into mm, with a line on the log unless that is 1: a
 * message that lengths are converted, or a warning that the unit is unknown and taken as mm.
 *
 * @param name  blanks around it do not count; empty, "none" and "???" say nothing: mm
 * @param path  of the file, for the line
 * @return above 0; 1 for an unknown unit
 */
double gz_length_unit_take(const char *name, const char *path, const struct gz_log *log);

#endif
