#include "render/decode/dicom/dicom_load.h"

#include <stdlib.h>
#include <string.h>

#include "render/decode/dicom/dicom_series.h"

#define GZ_LOG_MODULE "volume"

/* The slices as a stream of bytes, one slice in memory. */
struct stack {
	struct gz_dicom_series *series;
	uint8_t *slice;
	size_t slice_size, at; /* bytes of it that are taken */
	int left;              /* slices not decoded yet */
};

static enum gz_result read_slices(void *user, void *buffer, size_t size, size_t *out_got)
{
	struct stack *stack = user;
	size_t got = 0;
	while (got < size) {
		if (stack->at == stack->slice_size) {
			if (stack->left == 0)
				break;
			const enum gz_result result =
				gz_dicom_series_read(stack->series, stack->slice);
			if (result != GZ_OK)
				return result;
			stack->left--;
			stack->at = 0;
		}
		const size_t rest = stack->slice_size - stack->at;
		const size_t run = size - got < rest ? size - got : rest;
		memcpy((char *)buffer + got, stack->slice + stack->at, run);
		stack->at += run;
		got += run;
	}
	*out_got = got;
	return GZ_OK;
}

static enum gz_result import_slices(struct stack *stack, const struct gz_volume_file *file,
				    struct gz_volume *out_volume)
{
	const struct gz_dicom_geometry *geometry = gz_dicom_series_geometry(stack->series);
	struct gz_import_layout layout = {
		.oriented = geometry->oriented,
		.type = geometry->type,
		.channels = geometry->channels,
		.big_endian = gz_host_big_endian(),
		.slope = geometry->slope,
		.intercept = geometry->intercept,
	};
	memcpy(layout.dims, geometry->dims, sizeof layout.dims);
	memcpy(layout.spacing, geometry->spacing, sizeof layout.spacing);
	memcpy(layout.direction, geometry->direction, sizeof layout.direction);
	stack->slice_size =
		(size_t)layout.dims[0] * (size_t)layout.dims[1] * gz_import_voxel_size(&layout);
	stack->at = stack->slice_size;
	stack->left = layout.dims[2];
	stack->slice = malloc(stack->slice_size);
	if (!stack->slice) {
		gz_err(file->log, "%s: no memory to read it", file->path);
		return GZ_ERR_NO_MEM;
	}
	struct gz_byte_stream *stream = NULL;
	enum gz_result result = gz_byte_stream_from(read_slices, stack, geometry->bytes_bound,
						    file->path, file->log, &stream);
	if (result == GZ_OK)
		result = gz_volume_import(stream, &layout, file, out_volume);
	gz_byte_stream_close(&stream);
	return result;
}

enum gz_result gz_dicom_load(const struct gz_volume_file *file, const char *choice,
			     struct gz_volume *out_volume)
{
	struct stack stack = { 0 };
	enum gz_result result = gz_dicom_series_open(file, choice, &stack.series);
	if (result == GZ_OK)
		result = import_slices(&stack, file, out_volume);
	free(stack.slice);
	gz_dicom_series_close(&stack.series);
	return result;
}
