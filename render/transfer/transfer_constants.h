/**
 * @file
 * Sizes of transfer tables, shared by C and shaders: this file is put in front of every shader that
 * needs it. It may hold only comments and #defines that mean the same in C and in GLSL 4.30: whole
 * numbers (unsigned ones with U) and single-precision numbers with F.
 */
#ifndef GZ_RENDER_TRANSFER_TRANSFER_CONSTANTS_H
#define GZ_RENDER_TRANSFER_TRANSFER_CONSTANTS_H

/** Entries of the usual transfer table. Chosen: 16 between two grey levels of 8-bit data, so that
 * no interpolation is needed; 32 KiB, of which a scene uses a part, fit a first-level cache. A
 * power of two. */
#define GZ_TRANSFER_TABLE_SIZE 4096

/** Most entries of a transfer table, for functions with narrower peaks. Chosen: 1 MiB for each step
 * length fits a second-level cache; beyond, interpolated values are not exact to an entry. The
 * usual size times a power of two. */
#define GZ_TRANSFER_TABLE_MOST 131072

/** Number of values that a pre-integrated table distinguishes at either end of a segment. Chosen:
 * finer than the grey levels of 8-bit data; 2 MiB for a step length, of which segments mostly use
 * the part near the diagonal, because their ends are seldom far apart. */
#define GZ_PREINTEGRATED_SIZE 512

#endif
