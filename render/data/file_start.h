/**
 * @file
 * The first bytes of a file, decompressed, by which formats recognise their files.
 */
#ifndef GZ_RENDER_DATA_FILE_START_H
#define GZ_RENDER_DATA_FILE_START_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "render/data/byte_stream.h"

/** Most bytes of a start. Chosen: the headers of all binary formats fit, and so do the first lines
 *  of a text header. */
#define GZ_FILE_START_SIZE 4096

/** The beginning of a file. */
struct gz_file_start {
	enum gz_coding coding; /**< of the whole file, by its first bytes */
	size_t size;           /**< decoded bytes; less than GZ_FILE_START_SIZE only if there are no
				    more */
	uint8_t bytes[GZ_FILE_START_SIZE];
};

/**
 * The coding of a file that begins with @p bytes: gzip, zstd or bzip2 by their magic numbers,
 * otherwise plain. A plain file may begin with these numbers by chance.
 */
enum gz_coding gz_coding_of_bytes(const uint8_t *bytes, size_t size);

/** The coding of a file by its first bytes; plain if it cannot be read. Logs nothing. */
enum gz_coding gz_coding_of_file(const char *path);

/**
 * Read the beginning of a file. Logs nothing.
 *
 * @param[out] out_start  written only on true
 * @return false if it is not a regular file, cannot be read, or its compressed data are damaged
 */
bool gz_file_start_read(const char *path, struct gz_file_start *out_start);

/** Whether the start has @p size bytes @p magic at byte @p at. */
bool gz_file_start_has(const struct gz_file_start *start, size_t at, const void *magic,
		       size_t size);

/** Types of binary numbers in files. */
enum gz_file_number {
	GZ_FILE_I8,
	GZ_FILE_U8,
	GZ_FILE_I16,
	GZ_FILE_U16,
	GZ_FILE_I32,
	GZ_FILE_U32,
	GZ_FILE_I64,
	GZ_FILE_U64,
	GZ_FILE_F32,
	GZ_FILE_F64,
	GZ_FILE_NUMBER_COUNT,
};

/** Size of a binary number, bytes. */
size_t gz_file_number_size(enum gz_file_number type);

/** A binary number at @p bytes, which has as many bytes as @p type. Exact, except for 64-bit
 *  integers beyond 2^53. */
double gz_file_number_at(const uint8_t *bytes, enum gz_file_number type, bool big_endian);

#endif
