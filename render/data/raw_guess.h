/**
 * @file
 * Guesses of the layout of a file without a header, by its name and size. Names often tell it:
 * "bonsai_256x256x256_uint8.raw", "head-64x64x93-uint16le.raw.zst", "ct_0.5x0.5x1_512_512_361.raw".
 */
#ifndef GZ_RENDER_DATA_RAW_GUESS_H
#define GZ_RENDER_DATA_RAW_GUESS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "render/data/volume.h"

/** Most guesses that are offered. Chosen. */
#define GZ_RAW_GUESSES_MAX 12

/** Size of a reason with its NUL, bytes. */
#define GZ_RAW_REASON_SIZE 128

/** A layout that a file may have. */
struct gz_raw_guess {
	struct gz_raw_layout layout;
	bool certain; /**< the name tells the dims, the size fits, and the name tells the type or
			 it is a byte, which has no byte order */
	char reason[GZ_RAW_REASON_SIZE]; /**< one line: why this layout is likely */
};

/**
 * Guess the layout of a file.
 *
 * The file name is searched for numbers and words. Three numbers joined by x, _, - or a dot are
 * voxels along x, y, z; with two numbers the size tells the third; one number is the edge of a cube
 * or of square slices. Numbers with decimals, or a second three, are spacing in mm. uint8, u16,
 * short, float, 16bit, … are types; le, be, msb, … byte orders. A layout that does not fit the size
 * is never offered.
 *
 * @param name   path or name; only the part after the last slash counts
 * @param bytes  of the voxels; 0 if not known: then only a name that tells everything is understood
 * @param[out] out_guesses  best first
 * @param room              size of @p out_guesses
 * @return number of guesses, at most GZ_RAW_GUESSES_MAX and @p room
 */
size_t gz_raw_guess(const char *name, uint64_t bytes, struct gz_raw_guess *out_guesses,
		    size_t room);

/** Bytes of the voxels of a layout; 0 if an edge, the type or the channels are out of range. */
uint64_t gz_raw_layout_bytes(const struct gz_raw_layout *layout);

/**
 * Whether the name tells a layout of another size than the file has: then a part of the file is
 * missing, or the name is wrong, and guesses by its size are not to be trusted.
 *
 * @param name   as of gz_raw_guess()
 * @param bytes  of the voxels; 0 if not known: then false
 * @param[out] out_layout  what the name tells, if true
 */
bool gz_raw_name_contradicts(const char *name, uint64_t bytes, struct gz_raw_layout *out_layout);

/**
 * The size of a raw file once decompressed, bytes: the file's size; for .zst the size in its first
 * frame, for .gz the size at its end, if it is plausible.
 *
 * @return 0 if it is not known or the file cannot be read
 */
uint64_t gz_raw_file_bytes(const char *path);

#endif
