/**
 * @file
 * Sizes of transfer tables. C and shaders share them: this text also
 * stands in front of every shader that needs it, so it holds nothing but comments and #defines that
 * mean the same in C and in GLSL 4.30: whole numbers (with U where unsigned), and single-precision
 * numbers with F.
 */
#ifndef GZ_RENDER_TRANSFER_TRANSFER_CONSTANTS_H
#define GZ_RENDER_TRANSFER_TRANSFER_CONSTANTS_H

/** Entries of a transfer table. Chosen: 16 between two grey levels of 8-bit data, so that the
 * nearest entry is near enough; 32 KiB, of which a scene uses a part, stay close to the processor.
 */
#define GZ_TRANSFER_TABLE_SIZE 4096

/** Values at either end of a segment that a pre-integrated table tells apart. Chosen: finer than
 * the grey levels of 8-bit data; 2 MiB a step length, of which segments, whose ends are seldom far
 * apart, use what lies near the diagonal. */
#define GZ_PREINTEGRATED_SIZE 512

#endif
