/* Volumes without a header: plain, .zst or .gz. */
#include <string.h>

#include "render/data/volume_import.h"
#include "render/data/volume_loaders.h"

#define GZ_LOG_MODULE "volume"

enum gz_result gz_volume_load_raw(const char *path, enum gz_coding coding,
				  const struct gz_raw_layout *raw, const struct gz_loading *loading,
				  const struct gz_log *log, struct gz_volume *out_volume)
{
	struct gz_import_layout layout = gz_import_layout_default();
	if ((unsigned)raw->type >= GZ_RAW_TYPE_COUNT) {
		gz_err(log, "%s: unknown type of voxels; uint8 to float64 are read", path);
		return GZ_ERR_INVAL;
	}
	memcpy(layout.dims, raw->dims, sizeof layout.dims);
	memcpy(layout.spacing, raw->spacing, sizeof layout.spacing);
	layout.type = raw->type;
	layout.big_endian = raw->big_endian;

	struct gz_byte_stream *stream = NULL;
	enum gz_result result = gz_byte_stream_open(path, coding, 0, log, &stream);
	if (result == GZ_OK)
		result = gz_volume_import(stream, &layout, path, loading, log, out_volume);
	gz_byte_stream_close(&stream);
	return result;
}
