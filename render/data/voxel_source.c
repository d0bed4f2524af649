#include "render/data/voxel_source.h"

#define GZ_LOG_MODULE "volume"

/* Bytes to pass over; those that the layout asks for are checked against the file by the import. */
static uint64_t skip_of(const struct gz_voxel_source *source, const struct gz_import_layout *layout,
			const struct gz_byte_stream *stream)
{
	if (source->skip != GZ_SKIP_TO_END)
		return (uint64_t)source->skip;
	uint64_t needed = gz_raw_type_size(layout->type), there = gz_byte_stream_bound(stream);
	for (int axis = 0; axis < 3; axis++) {
		uint64_t dim = layout->dims[axis] > 0 ? (uint64_t)layout->dims[axis] : 0;
		if (dim > GZ_VOLUME_DIM_MAX)
			return 0;
		needed *= dim;
	}
	return needed < there ? there - needed : 0;
}

enum gz_result gz_voxel_source_import(const struct gz_voxel_source *source,
				      const struct gz_import_layout *layout,
				      const struct gz_loading *loading, const struct gz_log *log,
				      struct gz_volume *out_volume)
{
	struct gz_byte_stream *stream = NULL;
	if (source->skip == GZ_SKIP_TO_END && source->coding != GZ_CODING_PLAIN) {
		gz_err(log, "%s: compressed data cannot be found from the end; give what to skip",
		       source->path);
		return GZ_ERR_FORMAT;
	}
	enum gz_result result =
		gz_byte_stream_open(source->path, source->coding, source->offset, log, &stream);
	if (result == GZ_OK)
		result = gz_byte_stream_skip(stream, skip_of(source, layout, stream));
	if (result == GZ_OK)
		result = gz_volume_import(stream, layout, source->path, loading, log, out_volume);
	gz_byte_stream_close(&stream);
	return result;
}
