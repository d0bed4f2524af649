/* Volumes without a header: plain, .zst or .gz. */
#include <string.h>

#include "base/file.h"
#include "render/data/format.h"

#define GZ_LOG_MODULE "volume"

static enum gz_coding raw_coding(const char *path)
{
	if (gz_path_ends(path, ".zst"))
		return GZ_CODING_ZSTD;
	return gz_path_ends(path, ".gz") ? GZ_CODING_ZLIB : GZ_CODING_PLAIN;
}

static enum gz_result load_raw(const struct gz_volume_file *file, struct gz_volume *out_volume)
{
	const struct gz_raw_layout *raw = file->raw;
	struct gz_import_layout layout = gz_import_layout_default();
	if ((unsigned)raw->type >= GZ_RAW_TYPE_COUNT) {
		gz_err(file->log, "%s: unknown type of voxels; uint8 to float64 are read",
		       file->path);
		return GZ_ERR_INVAL;
	}
	memcpy(layout.dims, raw->dims, sizeof layout.dims);
	for (int axis = 0; axis < 3; axis++) {
		const bool known = raw->spacing[axis] != 0;
		layout.spacing[axis] = known ? raw->spacing[axis] : 1;
		layout.spacing_assumed = layout.spacing_assumed || !known;
	}
	layout.type = raw->type;
	layout.channels = raw->channels;
	layout.big_endian = raw->big_endian;

	struct gz_byte_stream *stream = NULL;
	enum gz_result result =
		gz_byte_stream_open(file->path, raw_coding(file->path), 0, file->log, &stream);
	if (result == GZ_OK)
		result = gz_volume_import(stream, &layout, file, out_volume);
	gz_byte_stream_close(&stream);
	return result;
}

const struct gz_volume_format gz_format_raw = {
	.name = "raw",
	.endings = { ".raw", ".zst", ".gz" },
	.layout = GZ_LAYOUT_GIVEN,
	.load = load_raw,
	.limits = "the layout must be given; axes are not turned, data begin at byte 0",
};

const struct gz_volume_format gz_format_raw_by_layout = {
	.name = "raw",
	.endings = { ".bin", ".dat", ".vol", ".img" },
	.layout = GZ_LAYOUT_IF_GIVEN,
	.load = load_raw,
	.limits = "as raw; without a layout such a file may be of another format",
};
