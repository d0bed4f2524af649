/**
 * @file
 * The header of a PLY file: which numbers follow. Within this room.
 */
#ifndef GZ_RENDER_MESH_PLY_HEAD_H
#define GZ_RENDER_MESH_PLY_HEAD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"

/** Most elements of a file, and properties of an element. Chosen: files of scanners have 3 and 20.
 */
enum { GZ_PLY_ELEMENTS_MAX = 16, GZ_PLY_PROPERTIES_MAX = 64 };

/** Types of numbers. */
enum gz_ply_type {
	GZ_PLY_INT8,
	GZ_PLY_UINT8,
	GZ_PLY_INT16,
	GZ_PLY_UINT16,
	GZ_PLY_INT32,
	GZ_PLY_UINT32,
	GZ_PLY_FLOAT32,
	GZ_PLY_FLOAT64,
	GZ_PLY_TYPE_COUNT,
};

/** Bytes of a number in a binary file. */
extern const uint8_t gz_ply_type_sizes[GZ_PLY_TYPE_COUNT];

/** What a property is used for. */
enum gz_ply_use {
	GZ_PLY_UNUSED = -1,
	GZ_PLY_X, /**< y and z follow */
	GZ_PLY_Y,
	GZ_PLY_Z,
	GZ_PLY_NX, /**< ny and nz follow */
	GZ_PLY_NY,
	GZ_PLY_NZ,
	GZ_PLY_CORNERS, /**< the list of a face's vertices */
};

/** One number, or one list of numbers, of each item of an element. */
struct gz_ply_property {
	enum gz_ply_type type;
	bool is_list;
	enum gz_ply_type count_type; /**< of the number of a list's items */
	enum gz_ply_use use;
};

/** What an element's items are. */
enum gz_ply_kind { GZ_PLY_OTHER, GZ_PLY_VERTEX, GZ_PLY_FACE };

/** Items of one kind, which follow each other in the file. */
struct gz_ply_element {
	enum gz_ply_kind kind;
	uint64_t count; /**< as claimed */
	size_t property_count;
	struct gz_ply_property properties[GZ_PLY_PROPERTIES_MAX];
};

/** How numbers are written. */
enum gz_ply_format { GZ_PLY_TEXT, GZ_PLY_LITTLE_ENDIAN, GZ_PLY_BIG_ENDIAN };

/** A header. */
struct gz_ply_head {
	enum gz_ply_format format;
	size_t element_count;
	struct gz_ply_element elements[GZ_PLY_ELEMENTS_MAX];
	size_t size; /**< bytes of the header: the numbers follow */
};

/**
 * Read a header. It has exactly one element `vertex` with x, y, z, and at most one element `face`,
 * after it, with a list of corners.
 *
 * @param name  source of the bytes in messages
 * @retval GZ_ERR_FORMAT  refused; logged with the line and what is wrong
 */
enum gz_result gz_ply_head_read(const char *name, const void *bytes, size_t size,
				const struct gz_log *log, struct gz_ply_head *out_head);

#endif
