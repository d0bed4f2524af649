/**
 * @file
 * Files that the tests of volume loaders write: a folder of their own, bytes, headers.
 */
#ifndef GZ_TESTS_RENDER_VOLUME_FILES_H
#define GZ_TESTS_RENDER_VOLUME_FILES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** A folder for this process, made on first use and removed with its files at exit. */
const char *files_folder(void);

/** The path of @p name in files_folder(); valid until the eighth next call. */
const char *files_path(const char *name);

/** Write @p size bytes at @p bytes to @p name in the folder; returns its path. */
const char *files_write(const char *name, const void *bytes, size_t size);

/** Write a text and, behind it, @p size bytes. */
const char *files_write_text(const char *name, const char *text, const void *bytes, size_t size);

/** Compress @p size bytes as gzip (31), zlib (15): @p window_bits as in deflateInit2(). Returns the
 *  compressed size; @p out must hold size + 1024. */
size_t files_deflate(const void *bytes, size_t size, int window_bits, void *out, size_t room);

/** What a test's NIfTI-1 header says; zeros mean the usual. */
struct nifti_sample {
	int16_t dim[8];
	int16_t datatype, bitpix;
	float pixdim[8];
	float vox_offset;
	float slope, intercept;
	int16_t qform_code, sform_code;
	float quatern[3];
	float srow[3][4];
	const char *magic;
	bool swapped;
};

/** A 3D header of unsigned bytes, spacing 1, voxels at 352, no orientation. */
struct nifti_sample nifti_sample_make(int x, int y, int z);

/** The 352 bytes before the voxels. */
void nifti_sample_bytes(const struct nifti_sample *sample, uint8_t out[352]);

/** The same numbers as the 544 bytes before the voxels of a NIfTI-2, whose vox_offset is 544, or 0
 *  for a pair. */
void nifti2_sample_bytes(const struct nifti_sample *sample, bool pair, uint8_t out[544]);

#endif
