/**
 * @file
 * The header of a PLY file: which numbers follow (Turk, "The PLY polygon file format", 1994).
 */
#ifndef GZ_RENDER_DATA_PLY_HEAD_H
#define GZ_RENDER_DATA_PLY_HEAD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "render/data/file_start.h"

/** Most elements and properties of a file. Chosen: more than scanners and simulations write. */
enum { GZ_PLY_ELEMENTS_MAX = 32, GZ_PLY_PROPERTIES_MAX = 256 };

/** Size of a name with its NUL, bytes. Longer names are cut off; those that mean something are
 *  shorter. */
enum { GZ_PLY_NAME_SIZE = 32 };

/** One number, or one list of numbers, of each item of an element. */
struct gz_ply_property {
	char name[GZ_PLY_NAME_SIZE];
	bool is_list;
	enum gz_file_number count_type; /**< an integer: how many numbers a list has */
	enum gz_file_number type;
};

/** Items of one kind, which follow each other in the file. */
struct gz_ply_element {
	char name[GZ_PLY_NAME_SIZE];
	uint64_t count; /**< as claimed */
	size_t first_property, property_count;
};

/** How numbers are written. */
enum gz_ply_format { GZ_PLY_TEXT, GZ_PLY_LITTLE_ENDIAN, GZ_PLY_BIG_ENDIAN };

/** A header. Zero-initialised, no line of it was read. */
struct gz_ply_head {
	size_t lines; /**< read so far */
	bool has_format;
	enum gz_ply_format format;
	size_t element_count, property_count;
	struct gz_ply_element elements[GZ_PLY_ELEMENTS_MAX];
	struct gz_ply_property properties[GZ_PLY_PROPERTIES_MAX];
};

/**
 * Take the next line of a header, the line "ply" first.
 *
 * @param line          without its end; blanks in it become NUL
 * @param[out] out_end  whether this was the last line, with the format known
 * @return NULL, or what is wrong, in words that can stand after a file's name
 */
const char *gz_ply_head_take_line(struct gz_ply_head *head, char *line, bool *out_end);

/** The fewest bytes of an item: a digit and a blank, or the numbers alone with empty lists. The
 *  last number of a text needs no blank. */
uint64_t gz_ply_item_bytes(const struct gz_ply_head *head, const struct gz_ply_element *element);

#endif
