/**
 * @file
 * The tables of marching cubes, which make_cube_tables.c computes while the project is built.
 *
 * Corner c of a cube lies at x = c & 1, y = c >> 1 & 1, z = c >> 2. A case is a byte with a bit for
 * each corner at or above the isovalue. Edge 4 * axis + u + 2 * v runs along an axis; u and v are
 * its place on the other two axes, the lower one first. Face 2 * axis + side is across an axis.
 *
 * A face whose opposite corners are alike and whose neighbouring corners differ is ambiguous: its
 * lowest and highest corner may be joined through its middle, or the other two. A case has a
 * variant for each choice; bit n of the variant's number decides on the n-th ambiguous face, 1 for
 * joining the lowest and highest corner.
 */
#ifndef GZ_RENDER_MESH_CUBE_TABLES_H
#define GZ_RENDER_MESH_CUBE_TABLES_H

#include <stdint.h>

/** For each case the number of its variant 0; the others follow. */
extern const uint16_t gz_cube_first[256];

/** For each case its ambiguous faces, as bits. */
extern const uint8_t gz_cube_ambiguous[256];

/** For each variant the number of its first triangle; its last is before that of the next variant.
 */
extern const uint16_t gz_cube_offset[];

/** Three edges for each triangle, counter-clockwise seen from where values are below the isovalue.
 */
extern const uint8_t gz_cube_corners[];

/** How many variants there are. gz_cube_offset has one entry more. */
extern const int gz_cube_variants;

#endif
