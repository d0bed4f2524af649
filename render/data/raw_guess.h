/**
 * @file
 * What a file without a header may hold, by its name and its size. People write both into names:
 * "bonsai_256x256x256_uint8.raw", "head-64x64x93-uint16le.raw.zst", "ct_0.5x0.5x1_512_512_361.raw".
 */
#ifndef GZ_RENDER_DATA_RAW_GUESS_H
#define GZ_RENDER_DATA_RAW_GUESS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "render/data/volume.h"

/** Most guesses that are worth a look. Chosen. */
#define GZ_RAW_GUESSES_MAX 12

/** Bytes of a reason with its NUL. */
#define GZ_RAW_REASON_SIZE 128

/** A layout that a file may have. */
struct gz_raw_guess {
	struct gz_raw_layout layout;
	bool certain; /**< the name says how many voxels along each axis, the size fits, and the
			 type is in the name, or a byte, so that no byte order matters */
	char reason[GZ_RAW_REASON_SIZE]; /**< one line: what speaks for it */
};

/**
 * Guess the layout of a file.
 *
 * Of the name counts: three numbers joined by x, _, - or a dot are voxels along x, y, z; two, and
 * the size tells the third; one, a cube or square slices; numbers with decimals, or a second three,
 * are spacing in mm; uint8, u16, short, float, 16bit, … are types; le, be, msb, … byte orders. A
 * layout whose bytes are not the size is never offered.
 *
 * @param name   path or name; only what is behind the last slash counts
 * @param bytes  of the voxels; 0: not known, so that only a name that says all is understood
 * @param[out] out_guesses  best first
 * @param room              of @p out_guesses
 * @return how many there are, at most GZ_RAW_GUESSES_MAX
 */
size_t gz_raw_guess(const char *name, uint64_t bytes, struct gz_raw_guess *out_guesses,
		    size_t room);

/** Bytes of the voxels of a layout; 0 where an edge is out of range. */
uint64_t gz_raw_layout_bytes(const struct gz_raw_layout *layout);

/**
 * The bytes that a raw file holds once decompressed: its size; for .zst what its frame says, for
 * .gz what its end says, where these can be true.
 *
 * @return 0 where it is not told, or the file cannot be read
 */
uint64_t gz_raw_file_bytes(const char *path);

#endif
