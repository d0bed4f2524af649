#include "render/data/slice_import.h"

#include <stdlib.h>
#include <string.h>

#define GZ_LOG_MODULE "volume"

/* The slices as a stream of bytes. */
struct slice_stream {
	const struct gz_slice_source *source;
	const struct gz_volume_file *file;
	uint8_t *slice;     /* the newest; NULL until there is one */
	size_t slice_bytes; /* above 0 */
	uint64_t at, end;   /* bytes of all slices: the next to give, and their end */
	bool is_read;       /* `slice` is the one that `at` lies in */
};

static enum gz_result read_slice(struct slice_stream *stream)
{
	if (!stream->slice)
		stream->slice = malloc(stream->slice_bytes);
	if (!stream->slice) {
		gz_err(stream->file->log, "%s: no memory to read it", stream->file->path);
		return GZ_ERR_NO_MEM;
	}
	const enum gz_result result = stream->source->read(
		stream->source->user, stream->at / stream->slice_bytes, stream->slice);
	stream->is_read = result == GZ_OK;
	return result;
}

static enum gz_result read_slice_bytes(void *user, void *buffer, size_t size, size_t *out_got)
{
	struct slice_stream *stream = user;
	size_t got = 0;
	while (got < size && stream->at < stream->end) {
		const enum gz_result result = stream->is_read ? GZ_OK : read_slice(stream);
		if (result != GZ_OK)
			return result;
		const size_t from = (size_t)(stream->at % stream->slice_bytes);
		const size_t rest = stream->slice_bytes - from;
		const size_t run = size - got < rest ? size - got : rest;
		memcpy((char *)buffer + got, stream->slice + from, run);
		stream->at += run;
		got += run;
		stream->is_read = run < rest;
	}
	*out_got = got;
	return GZ_OK;
}

static enum gz_result skip_slice_bytes(void *user, uint64_t count)
{
	struct slice_stream *stream = user;
	const uint64_t slice = stream->at / stream->slice_bytes;
	if (count > stream->end - stream->at)
		return GZ_ERR_FORMAT; /* cannot happen: time points are counted by the layout */
	stream->at += count;
	stream->is_read = stream->is_read && stream->at / stream->slice_bytes == slice;
	return GZ_OK;
}

enum gz_result gz_volume_import_slices(const struct gz_slice_source *source,
				       const struct gz_import_layout *layout,
				       const struct gz_volume_file *file,
				       struct gz_volume *out_volume)
{
	const uint64_t points = layout->time_points > 1 ? (uint64_t)layout->time_points : 1;
	struct slice_stream stream = { .source = source, .file = file };
	struct gz_byte_stream *bytes = NULL;
	/* What is out of range is refused by gz_volume_import() before anything is read. */
	stream.slice_bytes =
		(size_t)layout->dims[0] * (size_t)layout->dims[1] * gz_import_voxel_size(layout);
	stream.end = stream.slice_bytes * (uint64_t)layout->dims[2] * points;
	enum gz_result result = gz_byte_stream_from(read_slice_bytes, &stream, source->bytes_bound,
						    file->path, file->log, &bytes);
	if (result == GZ_OK) {
		gz_byte_stream_skip_by(bytes, skip_slice_bytes);
		result = gz_volume_import(bytes, layout, file, out_volume);
	}
	gz_byte_stream_close(&bytes);
	free(stream.slice);
	return result;
}
