/**
 * @file
 * Where the voxels of a volume are: in one file or in several, in binary or as text, after a header
 * or at the end.
 */
#ifndef GZ_RENDER_DATA_VOXEL_SOURCE_H
#define GZ_RENDER_DATA_VOXEL_SOURCE_H

#include <stdint.h>

#include "base/result.h"
#include "base/sizes.h"
#include "base/text.h"
#include "render/data/byte_stream.h"
#include "render/data/text_head.h"
#include "render/data/volume_import.h"

/** A skip that puts the voxels at the end of the file. */
#define GZ_SKIP_TO_END (-1)

/** How numbers are written. */
enum gz_spelling {
	GZ_SPELLING_BINARY,
	GZ_SPELLING_TEXT, /**< decimal numbers, separated by blanks, ends of lines or commas */
	GZ_SPELLING_HEX, /**< two hexadecimal digits a byte; blanks and ends of lines are skipped */
};

/** Several files that hold the voxels one after the other, the same number each. */
struct gz_voxel_files {
	int count;           /**< 0: a single file */
	struct gz_text list; /**< owned: the names, each with a NUL; empty: the names are made */
	/** Made names: the number replaces the characters [number_at, number_end) of the pattern.
	 */
	char pattern[GZ_PATH_SIZE];
	size_t number_at, number_end;
	int digits;            /**< least digits of the number */
	long long first, step; /**< number of the first file, and from one to the next */
};

/** Where a header says that the voxels are. Zero-initialised: nowhere. */
struct gz_voxel_source {
	char path[GZ_PATH_SIZE]; /**< the file; for several files the header */
	struct gz_voxel_files files;
	enum gz_coding coding;
	enum gz_spelling spelling;
	uint64_t numbers_per_file; /**< of several files */
	uint64_t offset;           /**< bytes of each file before the data */
	int line_skip;             /**< lines to skip after that; plain bytes */
	int64_t skip; /**< bytes to skip after that, of the decoded data; or, for plain binary data
			 only, GZ_SKIP_TO_END */
};

/**
 * Take the names of several files from a header: "LIST", after which @p head has one name a line up
 * to its end, or "name.%03d.raw 1 100 1": a pattern, the first and last number, and the step.
 * Behind either may stand the number of axes that each file holds, to which a letter D may be
 * joined.
 *
 * @param head      after the line that has @p value
 * @param value     changed
 * @param key       for messages
 * @param[out] out_axes  0 if it is not given
 * @retval GZ_ERR_FORMAT  wrong; logged
 * @retval GZ_ERR_NO_MEM  logged
 */
enum gz_result gz_voxel_files_take(struct gz_voxel_files *files, struct gz_text_head *head,
				   char *value, const char *key, int *out_axes);

/** Whether a header's value names several files. */
bool gz_voxel_files_named(const char *value);

/**
 * Share the numbers of a header's axes out to its files: sets numbers_per_file. Does nothing for a
 * single file.
 *
 * @param sizes      of the file's @p dimension axes, the fastest first
 * @param file_axes  that each file holds; 0: all but the slowest
 * @retval GZ_ERR_FORMAT  there are more or fewer files than that needs; logged
 */
enum gz_result gz_voxel_source_share(struct gz_voxel_source *source,
				     const struct gz_text_head *head, const int *sizes,
				     int dimension, int file_axes);

/** Open the source and import its voxels; messages name the source's file. Errors of
 *  gz_byte_stream_open(), gz_byte_stream_skip() and gz_volume_import(), all logged. */
enum gz_result gz_voxel_source_import(const struct gz_voxel_source *source,
				      const struct gz_import_layout *layout,
				      const struct gz_volume_file *file,
				      struct gz_volume *out_volume);

/** Free the names of the source's files. */
void gz_voxel_source_free(struct gz_voxel_source *source);

#endif
