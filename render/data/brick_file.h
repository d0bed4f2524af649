/**
 * @file
 * How a volume is divided into bricks, level by level, and the file of bricks, opened and checked:
 * its index is in memory, voxels are read a brick at a time. docs/big-volumes.md describes its
 * bytes.
 *
 * A brick is a cube of GZ_BRICK_EDGE voxels of one level, stored with one more voxel on every side,
 * so that interpolation within the brick needs no other brick. Outside the volume the nearest voxel
 * is repeated. Brick (i, j, k) of a level spans its voxel coordinates [32i, 32i + 32) and so on.
 * The brick of the next coarser level over the same place has the numbers of the halved axes
 * divided by two.
 */
#ifndef GZ_RENDER_DATA_BRICK_FILE_H
#define GZ_RENDER_DATA_BRICK_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "base/sizes.h"
#include "render/data/float_scaling.h"
#include "render/data/volume.h"

#define GZ_BRICK_EDGE        32 /**< voxels; a power of two */
#define GZ_BRICK_STORED_EDGE 34 /**< including the voxels of its neighbours */
#define GZ_BRICK_VOXELS      (GZ_BRICK_STORED_EDGE * GZ_BRICK_STORED_EDGE * GZ_BRICK_STORED_EDGE)
#define GZ_BRICK_LEVELS_MAX  16 /**< 15 halvings of GZ_VOLUME_DIM_MAX leave one voxel */

#define GZ_BRICK_CELL_EDGE 8  /**< voxels; the file holds the value range of each cell */
#define GZ_BRICK_CELLS     64 /**< in a brick: four along each axis, x fastest */

/** One level. */
struct gz_brick_level {
	int dims[3];     /**< voxels */
	int bricks[3];   /**< along each axis */
	int halvings[3]; /**< number of halvings of each axis since level 0 */
	size_t first;    /**< the number of its first brick; x varies fastest, then y, then z */
};

/** All levels, finest first; the last is one brick. */
struct gz_brick_layout {
	int level_count;
	struct gz_brick_level levels[GZ_BRICK_LEVELS_MAX];
	size_t brick_count; /**< of all levels */
};

/** Divide a volume into levels and bricks: level 0 is the volume, each further level halves the
 * axes that gz_halve_axes() chooses. Dims and spacing must be those of a valid volume. */
void gz_brick_layout_make(const int dims[3], const double spacing[3],
			  struct gz_brick_layout *out_layout);

/** The number of a brick. */
size_t gz_brick_number(const struct gz_brick_layout *layout, int level, const int brick[3]);

/** Level and place of the brick with number @p number. */
void gz_brick_place(const struct gz_brick_layout *layout, size_t number, int *out_level,
		    int out_brick[3]);

/** The brick of the next coarser level over @p brick of @p level, which is not the last. */
void gz_brick_parent(const struct gz_brick_layout *layout, int level, const int brick[3],
		     int out_parent[3]);

/** The bricks of the next finer level under @p brick of @p level, which is not 0: [@p out_first,
 *  @p out_end) along each axis. */
void gz_brick_children(const struct gz_brick_layout *layout, int level, const int brick[3],
		       int out_first[3], int out_end[3]);

/** How to find the brick at a place in the voxel coordinates of a level, and the coarser bricks
 * over it. The brick's number is first + the sum of stride times the brick's place along each axis.
 */
struct gz_brick_lookup {
	size_t first;
	int32_t stride[3];
	float last[3]; /**< greatest place of a brick along each axis */
	/** Voxels of another level along an edge of one of this level, 1 or less for coarser ones;
	 *  0 for levels that do not exist. */
	float scale[3][GZ_BRICK_LEVELS_MAX];
};

/** The lookup of @p level. */
void gz_brick_lookup_make(const struct gz_brick_layout *layout, int level,
			  struct gz_brick_lookup *out_lookup);

/** The entry of one brick in the index of a file. */
struct gz_brick_entry {
	uint64_t offset;       /**< of its voxels in the file, bytes; 0: every voxel equals least */
	uint32_t crc;          /**< of its voxels' bytes, CRC-32 as in zlib */
	float least, greatest; /**< stored values of its voxels and of all finer bricks under it */
};

#define GZ_BRICK_MAGIC        "GZBRICK\n"
#define GZ_BRICK_VERSION      1
#define GZ_BRICK_HEADER_BYTES 128
#define GZ_BRICK_ENTRY_BYTES  24
#define GZ_BRICK_ALIGN        4096 /**< bricks begin at multiples of this: a page */

/** The header of a file of bricks. */
struct gz_brick_header {
	int dims[3];
	double spacing[3];
	enum gz_voxel_type type;
	bool oriented, spacing_assumed; /**< see struct gz_volume */
	enum gz_modality modality;
	double slope, intercept, stored_min, stored_max;
	uint64_t brick_count; /**< entries of the index */
	uint64_t file_size;
	uint32_t index_crc, cells_crc;
};

/** Encode a header. */
void gz_brick_header_encode(const struct gz_brick_header *header,
			    uint8_t out_bytes[GZ_BRICK_HEADER_BYTES]);

/**
 * Decode a header and check every field that can be checked without the rest of the file.
 *
 * @param[out] out_header  written only on success
 * @return NULL, or a static text that tells what is wrong
 */
const char *gz_brick_header_decode(const uint8_t bytes[GZ_BRICK_HEADER_BYTES],
				   struct gz_brick_header *out_header);

/** Encode an entry. */
void gz_brick_entry_encode(const struct gz_brick_entry *entry,
			   uint8_t out_bytes[GZ_BRICK_ENTRY_BYTES]);

/** Decode an entry; nothing is checked. */
struct gz_brick_entry gz_brick_entry_decode(const uint8_t bytes[GZ_BRICK_ENTRY_BYTES]);

/** Where the ranges of the cells begin in the file, bytes: after the index. */
uint64_t gz_brick_cells_offset(uint64_t brick_count);

/** Where the first brick may begin in the file, bytes: after the cells, aligned. @p finest is the
 *  number of bricks of level 0. */
uint64_t gz_brick_data_offset(uint64_t brick_count, uint64_t finest, enum gz_voxel_type type);

/** Swap the bytes of @p count voxels if this machine's byte order is not little-endian. */
void gz_brick_host_order(enum gz_voxel_type type, size_t count, void *voxels);

/** An open file of bricks. Read-only: several threads may read bricks at once. */
struct gz_brick_file {
	char path[GZ_PATH_SIZE];
	const struct gz_log *log;
	int fd;
	/** Header, entries, cells and bricks have values scaled by `scaling`, if `scaled`. */
	struct gz_brick_header header;
	struct gz_brick_layout layout;
	bool scaled;
	struct gz_float_scaling scaling;
	struct gz_brick_entry *entries; /**< by a brick's number */
	void *cells; /**< least and greatest voxel of each cell of each brick of level 0 */
};

/**
 * Open a file and check its header, index and cells: every offset is within the file, every range
 * is valid. Floats that need it are scaled (render/data/float_scaling.h).
 *
 * @param log            borrowed until it is closed
 * @param[out] out_file  owned by the caller: gz_brick_file_close()
 * @retval GZ_ERR_NOT_FOUND  no such file; logged
 * @retval GZ_ERR_IO         it cannot be read; logged
 * @retval GZ_ERR_FORMAT     not a file of bricks, truncated or damaged; logged
 * @retval GZ_ERR_NO_MEM     no memory for the index; logged
 */
enum gz_result gz_brick_file_open(const char *path, const struct gz_log *log,
				  struct gz_brick_file **out_file);

/**
 * Read the GZ_BRICK_VOXELS voxels of a brick, in this machine's byte order.
 *
 * @retval GZ_ERR_IO      it cannot be read, or the file has become shorter
 * @retval GZ_ERR_FORMAT  its checksum is wrong, or a voxel is not finite
 *
 * Nothing is logged; gz_brick_file_complain() logs. Threads: any number at once.
 */
enum gz_result gz_brick_file_read(const struct gz_brick_file *file, size_t brick, void *out_voxels);

/** The range of cell number @p cell (x fastest) of a brick of level 0, stored values. */
void gz_brick_file_cell(const struct gz_brick_file *file, size_t brick, int cell, float *out_least,
			float *out_greatest);

/** Log why a brick could not be read, and that a coarser level is shown instead. */
void gz_brick_file_complain(const struct gz_brick_file *file, size_t brick, enum gz_result why);

/** Close the file, free everything and set to NULL. Accepts a pointer to NULL. */
void gz_brick_file_close(struct gz_brick_file **file);

/**
 * Copy the voxels of a brick, with one voxel of its neighbours on every side, out of a volume in
 * memory. Outside the volume the nearest voxel is repeated.
 *
 * @param volume  the level, in memory
 * @param brick   its place in the level; must be within it
 * @param[out] out_voxels  GZ_BRICK_VOXELS voxels, x fastest
 */
void gz_brick_cut(const struct gz_volume *volume, const int brick[3], void *out_voxels);

#endif
