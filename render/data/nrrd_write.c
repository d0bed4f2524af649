#include "render/data/nrrd_write.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"

#define GZ_LOG_MODULE "volume"

/* Chosen: large beside the cost of a call, a moment on any disk. */
#define CHUNK_VOXELS ((size_t)1 << 21)

enum { HEADER_SIZE = 512 };

/* What the voxels are written as. */
struct form {
	const char *name; /* of NRRD's type */
	size_t size;
	double least, greatest;
};

static const struct form integers[] = {
	{ "int8", 1, INT8_MIN, INT8_MAX },
	{ "uint8", 1, 0, UINT8_MAX },
	{ "int16", 2, INT16_MIN, INT16_MAX },
	{ "uint16", 2, 0, UINT16_MAX },
};
static const struct form floats = { "float", sizeof(float), -DBL_MAX, DBL_MAX };

/* NRRD cannot say that values are scaled, so that they are written as they are: as integers of the
 * width they are stored in, or a greater one, where all of them are such, else as floats. */
static const struct form *form_of(const struct gz_volume *volume)
{
	const double low = volume->stored_min + volume->intercept;
	const double high = volume->stored_max + volume->intercept;
	if (volume->type == GZ_VOXEL_F32 || volume->slope != 1 ||
	    volume->intercept != rint(volume->intercept))
		return &floats;
	for (size_t i = 0; i < sizeof integers / sizeof integers[0]; i++) {
		const struct form *form = &integers[i];
		const bool is_signed = form->least < 0;
		if (form->size >= gz_voxel_size(volume->type) && low >= form->least &&
		    high <= form->greatest && is_signed == (volume->intercept < 0))
			return form;
	}
	return &floats;
}

static int print_header(const struct gz_volume *volume, const struct form *form, char *out,
			size_t size)
{
	const uint16_t one = 1;
	const int *dims = volume->dims;
	const double *s = volume->spacing;
	return snprintf(out, size,
			"NRRD0005\ntype: %s\ndimension: 3\n%s: %s\nsizes: %d %d %d\n"
			"space directions: (%.17g,0,0) (0,%.17g,0) (0,0,%.17g)\n"
			"endian: %s\nencoding: raw\n\n",
			form->name, volume->oriented ? "space" : "space dimension",
			volume->oriented ? "right-anterior-superior" : "3", dims[0], dims[1],
			dims[2], s[0], s[1], s[2], *(const uint8_t *)&one ? "little" : "big");
}

static double stored_at(const struct gz_volume *volume, size_t i)
{
	switch (volume->type) {
	case GZ_VOXEL_U8:
		return ((const uint8_t *)volume->voxels)[i];
	case GZ_VOXEL_U16:
		return ((const uint16_t *)volume->voxels)[i];
	case GZ_VOXEL_F32:
	case GZ_VOXEL_TYPE_COUNT:
		break;
	}
	return (double)((const float *)volume->voxels)[i];
}

/* Values as `form` has them. Negative ones keep their two's complement. */
static void convert(const struct gz_volume *volume, const struct form *form, size_t first,
		    size_t count, uint8_t *out)
{
	for (size_t i = 0; i < count; i++) {
		const double value =
			volume->slope * stored_at(volume, first + i) + volume->intercept;
		const float real = (float)value;
		const uint16_t word = form == &floats ? 0 : (uint16_t)(int32_t)value;
		if (form == &floats)
			memcpy(out + i * sizeof real, &real, sizeof real);
		else if (form->size == sizeof word)
			memcpy(out + i * sizeof word, &word, sizeof word);
		else
			out[i] = (uint8_t)word;
	}
}

static enum gz_result write_voxels(const struct gz_part_file *file, const struct gz_volume *volume,
				   const struct form *form, uint64_t offset,
				   const struct gz_loading *loading)
{
	const size_t count = gz_volume_voxel_count(volume);
	uint8_t *chunk = malloc(CHUNK_VOXELS * form->size);
	enum gz_result result = chunk ? GZ_OK : GZ_ERR_NO_MEM;
	for (size_t at = 0; at < count && result == GZ_OK; at += CHUNK_VOXELS) {
		const size_t part = count - at < CHUNK_VOXELS ? count - at : CHUNK_VOXELS;
		if (!gz_loading_goes_on(loading, (double)at / (double)count, file->path)) {
			result = GZ_ERR_CANCELLED;
			break;
		}
		convert(volume, form, at, part, chunk);
		result = gz_part_file_write(file, chunk, part * form->size,
					    offset + at * form->size);
	}
	free(chunk);
	return result;
}

enum gz_result gz_nrrd_write(const struct gz_volume *volume, const char *path,
			     const struct gz_loading *loading, const struct gz_log *log)
{
	char header[HEADER_SIZE];
	struct gz_part_file file;
	if (!volume->voxels)
		return GZ_ERR_INVAL;
	const struct form *form = form_of(volume);
	const int length = print_header(volume, form, header, sizeof header);
	if (length < 0 || (size_t)length >= sizeof header)
		return GZ_ERR_INVAL;
	enum gz_result result = gz_part_file_open(&file, path, log);
	if (result == GZ_OK)
		result = gz_part_file_write(&file, header, (size_t)length, 0);
	if (result == GZ_OK)
		result = write_voxels(&file, volume, form, (uint64_t)length, loading);
	return gz_part_file_close(&file, result);
}
