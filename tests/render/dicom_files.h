/**
 * @file
 * DICOM files that the tests write themselves, Explicit VR Little Endian, so that the reader is not
 * held against its own library.
 */
#ifndef GZ_TESTS_RENDER_DICOM_FILES_H
#define GZ_TESTS_RENDER_DICOM_FILES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** One image. Zeroed text pointers leave an element out. */
struct dicom_sample {
	const char *series; /**< UID; its instance UID is made of it and number */
	const char *description;
	int number;
	int columns, rows, frames; /**< frames 0: no element */
	int bits_allocated, bits_stored, high_bit, is_signed;
	int samples_per_pixel;
	const char *position, *orientation, *spacing; /**< "x\\y\\z" as DICOM has it */
	const char *thickness;
	const char *slope, *intercept;
	const void *pixels; /**< little-endian */
	size_t pixel_bytes;
	size_t claimed_bytes;        /**< length of the pixel element, if not pixel_bytes */
	const char *transfer_syntax; /**< UID; NULL: Explicit VR Little Endian */
	bool encapsulated;           /**< the pixels are one fragment of such an element */
	bool bare;                   /**< without preamble and meta header */
	const char *image_type;
	const char *photometric; /**< NULL: MONOCHROME2, or RGB of several samples */
	bool planar;             /**< the samples are in planes */
	const uint16_t *palette; /**< red, green and blue of palette_count entries each */
	int palette_count, palette_first, palette_bits;
	const void *csa; /**< Siemens' private header of the image (0029,1010) */
	size_t csa_bytes;
	const void *more; /**< elements right before the pixels */
	size_t more_bytes;
};

/** A 3 x 2 image of 16 signed bits at the origin, axial, 1 mm, no scale. */
struct dicom_sample dicom_sample_make(const char *series, int number, const int16_t pixels[6]);

/** Write it to @p name of the test's folder (volume_files.h); its path. */
const char *dicom_sample_write(const struct dicom_sample *sample, const char *name);

#endif
