/**
 * @file
 * Distances that were measured in a volume: straight lines between two places, and their text in a
 * scene. Places are fractions of the volume's box along x, y, z, 0 to 1.
 */
#ifndef GZ_RENDER_SECTION_DISTANCES_H
#define GZ_RENDER_SECTION_DISTANCES_H

#include <stdbool.h>

#include "render/data/volume.h"

/** Most distances at a time (chosen: more cannot be told apart). */
#define GZ_DISTANCES_MAX 8

/** Size of their text with its NUL, bytes. */
#define GZ_DISTANCES_SIZE 640

/** A line from one place to another. */
struct gz_distance {
	double ends[2][3];
};

/** Some lines. */
struct gz_distances {
	int count; /**< 0 to GZ_DISTANCES_MAX */
	struct gz_distance lines[GZ_DISTANCES_MAX];
};

/** The length of a line, mm or whatever the volume's spacing has. */
double gz_distance_length(const struct gz_volume *volume, const struct gz_distance *line);

/** Read lines: six numbers from 0 to 1 each, x y z of either end, parted by blanks. @return false:
 *  the text has another form; @p out is unchanged */
bool gz_distances_parse(const char *text, struct gz_distances *out);

/** Print lines in that form, to six digits. */
void gz_distances_print(const struct gz_distances *distances, char out_text[GZ_DISTANCES_SIZE]);

#endif
