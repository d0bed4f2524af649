#include "render/decode/dicom/dicom_load.h"

#include <string.h>

#include "render/data/slice_import.h"
#include "render/decode/dicom/dicom_list.h"
#include "render/decode/dicom/dicom_series.h"

static enum gz_result read_dicom_slice(void *user, uint64_t index, void *numbers)
{
	return gz_dicom_series_read(user, index, numbers);
}

static enum gz_result import_dicom_slices(struct gz_dicom_series *series,
					  const struct gz_volume_file *file,
					  struct gz_volume *out_volume)
{
	const struct gz_dicom_geometry *geometry = gz_dicom_series_geometry(series);
	const struct gz_slice_source source = { read_dicom_slice, series, geometry->bytes_bound };
	struct gz_import_layout layout = {
		.spacing_assumed = geometry->spacing_assumed,
		.oriented = geometry->oriented,
		.labels = geometry->labels,
		.modality = geometry->modality,
		.type = geometry->type,
		.channels = geometry->channels,
		.big_endian = gz_host_big_endian(),
		.slope = geometry->slope,
		.intercept = geometry->intercept,
		.time_points = geometry->time_points,
	};
	memcpy(layout.dims, geometry->dims, sizeof layout.dims);
	memcpy(layout.spacing, geometry->spacing, sizeof layout.spacing);
	memcpy(layout.direction, geometry->direction, sizeof layout.direction);
	return gz_volume_import_slices(&source, &layout, file, out_volume);
}

/* Closes the series. */
static enum gz_result load_series(struct gz_dicom_series *series, const struct gz_volume_file *file,
				  struct gz_volume *out_volume)
{
	const enum gz_result result = import_dicom_slices(series, file, out_volume);
	gz_dicom_series_close(&series);
	return result;
}

enum gz_result gz_dicom_load(const struct gz_volume_file *file, const char *choice,
			     struct gz_volume *out_volume)
{
	struct gz_dicom_series *series = NULL;
	const enum gz_result result = gz_dicom_series_open(file, choice, &series);
	return result == GZ_OK ? load_series(series, file, out_volume) : result;
}

enum gz_result gz_dicom_load_or_list(const struct gz_volume_file *file,
				     const struct gz_decode_listener *listener,
				     struct gz_volume *out_volume)
{
	struct gz_dicom_series *series = NULL;
	const enum gz_result result = gz_dicom_list(file, listener, &series);
	return result == GZ_OK ? load_series(series, file, out_volume) : result;
}
