#include "render/volume/nrrd_write.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "render/volume/part_file.h"

#define GZ_LOG_MODULE "volume"

/* Chosen: large beside the cost of a call, a moment on any disk. */
#define CHUNK_BYTES ((size_t)8 << 20)

enum { HEADER_SIZE = 512 };

/* The offset that signed integers of a type have as unsigned ones. */
static double signed_offset(enum gz_voxel_type type)
{
	return type == GZ_VOXEL_U8 ? -128 : type == GZ_VOXEL_U16 ? -32768 : 0;
}

static bool is_signed(const struct gz_volume *volume)
{
	return volume->intercept != 0 && volume->intercept == signed_offset(volume->type);
}

static enum gz_result check(const struct gz_volume *volume, const char *path,
			    const struct gz_log *log)
{
	if (!volume->voxels)
		return GZ_ERR_INVAL;
	if (volume->slope == 1 && (volume->intercept == 0 || is_signed(volume)))
		return GZ_OK;
	gz_err(log,
	       "%s: NRRD cannot say that values are scaled by %g and %g; write bricks (.gzb), or "
	       "float32",
	       path, volume->slope, volume->intercept);
	return GZ_ERR_UNSUPPORTED;
}

static const char *type_name(const struct gz_volume *volume)
{
	static const char *const names[GZ_VOXEL_TYPE_COUNT] = { "uint8", "uint16", "float" };
	static const char *const signed_names[GZ_VOXEL_TYPE_COUNT] = { "int8", "int16", "float" };
	return (is_signed(volume) ? signed_names : names)[volume->type];
}

static int print_header(const struct gz_volume *volume, char *out, size_t size)
{
	const uint16_t one = 1;
	const int *dims = volume->dims;
	const double *s = volume->spacing;
	return snprintf(out, size,
			"NRRD0005\ntype: %s\ndimension: 3\n%s: %s\nsizes: %d %d %d\n"
			"space directions: (%.17g,0,0) (0,%.17g,0) (0,0,%.17g)\n"
			"endian: %s\nencoding: raw\n\n",
			type_name(volume), volume->oriented ? "space" : "space dimension",
			volume->oriented ? "right-anterior-superior" : "3", dims[0], dims[1],
			dims[2], s[0], s[1], s[2], *(const uint8_t *)&one ? "little" : "big");
}

/* Signed integers have their sign bit turned back. */
static void copy_voxels(const struct gz_volume *volume, size_t from, size_t size, uint8_t *out)
{
	const uint8_t *bytes = (const uint8_t *)volume->voxels + from;
	if (!is_signed(volume)) {
		memcpy(out, bytes, size);
	} else if (volume->type == GZ_VOXEL_U8) {
		for (size_t i = 0; i < size; i++)
			out[i] = bytes[i] ^ 0x80;
	} else {
		for (size_t i = 0; i < size; i += sizeof(uint16_t)) {
			uint16_t voxel;
			memcpy(&voxel, bytes + i, sizeof voxel);
			voxel ^= 0x8000;
			memcpy(out + i, &voxel, sizeof voxel);
		}
	}
}

static enum gz_result write_voxels(const struct gz_part_file *file, const struct gz_volume *volume,
				   uint64_t offset, const struct gz_loading *loading)
{
	const size_t size = gz_volume_voxel_count(volume) * gz_voxel_size(volume->type);
	uint8_t *chunk = malloc(CHUNK_BYTES);
	enum gz_result result = chunk ? GZ_OK : GZ_ERR_NO_MEM;
	for (size_t at = 0; at < size && result == GZ_OK; at += CHUNK_BYTES) {
		const size_t part = size - at < CHUNK_BYTES ? size - at : CHUNK_BYTES;
		if (!gz_loading_goes_on(loading, (double)at / (double)size, file->path)) {
			result = GZ_ERR_CANCELLED;
			break;
		}
		copy_voxels(volume, at, part, chunk);
		result = gz_part_file_write(file, chunk, part, offset + at);
	}
	free(chunk);
	return result;
}

enum gz_result gz_nrrd_write(const struct gz_volume *volume, const char *path,
			     const struct gz_loading *loading, const struct gz_log *log)
{
	char header[HEADER_SIZE];
	struct gz_part_file file;
	enum gz_result result = check(volume, path, log);
	if (result != GZ_OK)
		return result;
	const int length = print_header(volume, header, sizeof header);
	if (length < 0 || (size_t)length >= sizeof header)
		return GZ_ERR_INVAL;
	result = gz_part_file_open(&file, path, log);
	if (result == GZ_OK)
		result = gz_part_file_write(&file, header, (size_t)length, 0);
	if (result == GZ_OK)
		result = write_voxels(&file, volume, (uint64_t)length, loading);
	return gz_part_file_close(&file, result);
}
