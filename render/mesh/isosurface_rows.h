/**
 * @file
 * Parts of the extraction of isosurfaces; internal to it.
 *
 * Each row of voxels is a row of bits, 1 for a voxel at or above the isovalue, in words of 32.
 */
#ifndef GZ_RENDER_MESH_ISOSURFACE_ROWS_H
#define GZ_RENDER_MESH_ISOSURFACE_ROWS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "render/mesh/isosurface.h"

/** Voxels of a word. */
#define GZ_ISO_WORD 32

struct gz_iso_kernels;

/** What a row of voxels owns: the crossed edges that start at its voxels, along x, then along y to
 *  the next row, then along z to the next slice; and the triangles of the cubes whose lowest
 * corners are its voxels. */
struct gz_iso_row {
	uint32_t vertex;           /**< its first; while rows are counted, how many */
	uint32_t triangle;         /**< likewise */
	uint16_t x_edges, y_edges; /**< how many; an edge of a volume has at most 16384 voxels */
};

/** One extraction, shared by all threads. */
struct gz_iso_job {
	const struct gz_iso_kernels *kernels;
	const struct gz_volume *volume;
	const struct gz_value_blocks *blocks; /**< may be NULL */
	float isovalue;                       /**< stored value */
	bool falling;                         /**< data values fall as stored values rise */
	uint64_t elements_max; /**< of the request, as gz_mesh_count_limit() has it */
	size_t words;          /**< of a row, with one of zeros at its end */
	size_t row_count;      /**< of voxels */
	uint32_t *bits;        /**< row_count rows */
	uint8_t *known; /**< with blocks: enum gz_iso_known of each word of each row of blocks */
	struct gz_iso_row *rows; /**< one more than there are, for the sums */
	float *places[3];        /**< mm, of each voxel along x, y, z */
	float per_mm[3];         /**< voxels along x, y, z */
	struct gz_mesh *mesh;
};

/** What the blocks say about the voxels of a word. */
enum gz_iso_known { GZ_ISO_MIXED, GZ_ISO_BELOW, GZ_ISO_ABOVE };

/** Fill job->known for one row of blocks, numbered y first. */
void gz_iso_find_known(const struct gz_iso_job *job, size_t block_row);

/** Fill the bits of a row of voxels. Threads: any, for different rows. */
void gz_iso_classify_row(const struct gz_iso_job *job, size_t row);

/** The bits of four neighbouring rows: those of (y, z), (y + 1, z), (y, z + 1) and (y + 1, z + 1).
 *  At the end of the volume a row stands for the missing one behind it: no edge is crossed there.
 */
struct gz_iso_beam {
	const uint32_t *bits[4];
	size_t row[4];
	bool cubes; /**< none is missing: there are cubes between them */
};

/** Bits of 64 voxels from word @p at on. */
static inline uint64_t gz_iso_window(const uint32_t *bits, size_t at)
{
	return bits[at] | (uint64_t)bits[at + 1] << 32;
}

/** The windows of the four rows of a beam. */
struct gz_iso_windows {
	uint64_t row[4];
};

/** Read them. @return false if all voxels of the words are alike, as well as those after them, so
 *  that nothing is crossed. */
static inline bool gz_iso_windows_read(const struct gz_iso_beam *beam, size_t at,
				       struct gz_iso_windows *out_windows)
{
	uint64_t any = 0, all = ~UINT64_C(0);
	for (int r = 0; r < 4; r++) {
		const uint64_t window = gz_iso_window(beam->bits[r], at);
		out_windows->row[r] = window;
		any |= window;
		all &= window;
	}
	return any != 0 && all != ~UINT64_C(0);
}

/** Of the edges along x that start in word @p at, those that exist. */
static inline uint32_t gz_iso_inner(const struct gz_iso_job *job, size_t at)
{
	const size_t edges = (size_t)job->volume->dims[0] - 1, first = at * GZ_ISO_WORD;
	if (first + GZ_ISO_WORD <= edges)
		return UINT32_MAX;
	return first < edges ? (UINT32_C(1) << (edges - first)) - 1 : 0;
}

/** The edges along an axis that start in a word and are crossed. */
static inline uint32_t gz_iso_crossed(const struct gz_iso_windows *windows, int axis,
				      uint32_t inner)
{
	const uint64_t here = windows->row[0];
	return axis == 0 ? (uint32_t)(here ^ here >> 1) & inner
			 : (uint32_t)(here ^ windows->row[axis]);
}

#endif
