#include "render/data/decoded_volume.h"

#include <float.h>
#include <math.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "render/data/float_scaling.h"
#include "render/data/scratch.h"
#include "render/data/series_list.h"
#include "render/decode/decode.h"

#define GZ_LOG_MODULE "volume"

/* One decoding. */
struct decoding {
	const struct gz_volume_file *file;
	int scratch_fd;                /* -1: none */
	enum gz_result scratch_result; /* why there is none */
};

static struct gz_volume volume_of_header(const struct gz_decode_header *header)
{
	struct gz_volume volume = {
		.type = header->type < GZ_VOXEL_TYPE_COUNT ? (enum gz_voxel_type)header->type
							   : GZ_VOXEL_TYPE_COUNT,
		.colour = header->colour == GZ_COLOUR_NONE ? GZ_COLOUR_NONE : GZ_COLOUR_LUMINANCE,
		.slope = header->slope,
		.intercept = header->intercept,
		.spacing_assumed = header->spacing_assumed == 1,
		.oriented = header->oriented == 1,
		.labels = header->labels == 1,
		.modality = header->modality < GZ_MODALITY_COUNT
				    ? (enum gz_modality)header->modality
				    : GZ_MODALITY_UNKNOWN,
	};
	for (int axis = 0; axis < 3; axis++) {
		volume.dims[axis] = header->dims[axis];
		volume.spacing[axis] = header->spacing[axis];
	}
	return volume;
}

static enum gz_result refuse_room(const struct decoding *decoding, size_t bytes,
				  enum gz_result result)
{
	const struct gz_volume_file *file = decoding->file;
	if (result == GZ_ERR_NO_MEM)
		gz_err(file->log,
		       "%s: no memory for %zu MiB of voxels; write it as bricks (gazeview "
		       "--write-volume) or use a smaller volume",
		       file->path, bytes >> 20);
	else
		gz_err(file->log, "%s: no %zu MiB for voxels in %s: %s; make room there",
		       file->path, bytes >> 20, file->loading->scratch, gz_result_text(result));
	return result;
}

static enum gz_result accept_header(void *user, const struct gz_decode_header *header,
				    struct gz_decode_place *out_place)
{
	const struct decoding *decoding = user;
	const struct gz_loading *loading = decoding->file->loading;
	const struct gz_volume volume = volume_of_header(header);
	if (!gz_volume_layout_valid(&volume) || header->oriented > 1 || header->labels > 1 ||
	    header->spacing_assumed > 1 || header->modality >= GZ_MODALITY_COUNT ||
	    header->colour > GZ_COLOUR_LUMINANCE || !isfinite(volume.slope) || volume.slope == 0 ||
	    !isfinite(volume.intercept)) {
		gz_err(decoding->file->log,
		       "%s: its decoder made a volume of %d x %d x %d voxels of kind %u that "
		       "cannot be; the file was not read",
		       decoding->file->path, volume.dims[0], volume.dims[1], volume.dims[2],
		       header->type);
		return GZ_ERR_FORMAT;
	}
	const size_t used = gz_volume_bytes(&volume);
	out_place->bytes = used + GZ_VOLUME_PADDING;
	out_place->in_scratch = loading && loading->scratch && used >= loading->scratch_from;
	if (!out_place->in_scratch)
		return gz_memory_fits_machine(out_place->bytes)
			       ? GZ_OK
			       : refuse_room(decoding, out_place->bytes, GZ_ERR_NO_MEM);
	const enum gz_result result =
		decoding->scratch_fd < 0
			? decoding->scratch_result
			: gz_scratch_reserve(decoding->scratch_fd, out_place->bytes);
	return result == GZ_OK ? GZ_OK : refuse_room(decoding, out_place->bytes, result);
}

static bool decoding_goes_on(void *user, double share)
{
	const struct decoding *decoding = user;
	return gz_loading_goes_on(decoding->file->loading, share, decoding->file->path);
}

static bool voxels_finite(const struct gz_volume *volume)
{
	const float *voxels = volume->voxels;
	const size_t count = gz_volume_voxel_count(volume);
	size_t bad = 0;
	for (size_t i = 0; i < count; i++)
		bad += !isfinite(voxels[i]);
	return bad == 0;
}

/* Whether colours are such as they are loaded from files: of weight 255. */
static bool colours_valid(const struct gz_volume *volume)
{
	const size_t count = gz_volume_voxel_count(volume);
	size_t bad = 0;
	for (size_t i = 0; i < count; i++)
		bad += volume->colours[i] >> 24 != 255;
	return bad == 0 && volume->slope == 1 && volume->intercept == 0;
}

/* Whether voxels of a type can have these values. */
static bool are_stored_values(enum gz_voxel_type type, double least, double greatest)
{
	const double most = type == GZ_VOXEL_U8    ? UINT8_MAX
			    : type == GZ_VOXEL_U16 ? UINT16_MAX
						   : (double)FLT_MAX;
	return least >= (type == GZ_VOXEL_F32 ? -most : 0) && greatest <= most;
}

/* The range of a series, which the voxels alone do not tell: it must hold that of the voxels. */
static bool take_time_points(const struct gz_volume_file *file,
			     const struct gz_decode_header *header, struct gz_volume *volume)
{
	const int time_point = file->loading ? file->loading->time_point : 0;
	struct gz_float_scaling scaling;
	double least = header->number_range[0], greatest = header->number_range[1];
	if (header->time_points <= 1)
		return time_point == 0;
	if (header->time_points > GZ_TIME_POINTS_MAX || time_point < 0 ||
	    time_point >= header->time_points || !are_stored_values(volume->type, least, greatest))
		return false;
	volume->time_points = header->time_points;
	volume->time_point = time_point;
	memcpy(volume->number_range, header->number_range, sizeof volume->number_range);
	/* Whole numbers are rounded as the voxels are, then all are scaled as
	 * gz_volume_scale_floats() has scaled the voxels. */
	if (volume->type == GZ_VOXEL_F32) {
		least = (double)(float)least;
		greatest = (double)(float)greatest;
	}
	if (volume->type == GZ_VOXEL_F32 && gz_float_scaling_find(least, greatest, &scaling)) {
		least = (double)gz_float_scaled(&scaling, (float)least);
		greatest = (double)gz_float_scaled(&scaling, (float)greatest);
	}
	if (!(least <= volume->stored_min && greatest >= volume->stored_max))
		return false;
	volume->stored_min = least;
	volume->stored_max = greatest;
	return true;
}

/* What the decoder promises of the voxels is found out again. */
static enum gz_result check_voxels(const struct gz_volume_file *file,
				   const struct gz_decode_header *header, struct gz_volume *volume)
{
	if (volume->colours && !colours_valid(volume)) {
		gz_err(file->log, "%s: its decoder made impossible colours; it was not read",
		       file->path);
		return GZ_ERR_FORMAT;
	}
	if (volume->type != GZ_VOXEL_F32 || voxels_finite(volume)) {
		gz_volume_find_range(volume);
		if (!take_time_points(file, header, volume)) {
			gz_err(file->log,
			       "%s: its decoder made an impossible series of %d time points; "
			       "it was not read",
			       file->path, header->time_points);
			return GZ_ERR_FORMAT;
		}
		if (isfinite(volume->slope * volume->stored_min + volume->intercept) &&
		    isfinite(volume->slope * volume->stored_max + volume->intercept))
			return GZ_OK;
	}
	gz_err(file->log, "%s: its decoder made values that are not finite; it was not read",
	       file->path);
	return GZ_ERR_FORMAT;
}

enum gz_result gz_volume_decode(const struct gz_volume_file *file, const char *format,
				const char *choice, struct gz_volume *out_volume)
{
	struct decoding decoding = { .file = file, .scratch_fd = -1 };
	if (file->loading && file->loading->scratch)
		decoding.scratch_result =
			gz_scratch_open(file->loading->scratch, &decoding.scratch_fd);
	struct gz_series_list *list = file->loading ? file->loading->series_list : NULL;
	const struct gz_decode_listener listener = gz_series_list_listener(list);
	const struct gz_decode_job job = {
		.format = format,
		.path = file->path,
		.choice = choice,
		.time_point = file->loading ? file->loading->time_point : 0,
		.number_range = file->loading ? file->loading->number_range : NULL,
		.resampling = gz_resampling_names[file->loading ? file->loading->resampling
								: GZ_RESAMPLING_OFF],
		.scratch_fd = decoding.scratch_fd,
		.user = &decoding,
		.goes_on = decoding_goes_on,
		.accept = accept_header,
		.listener = list ? &listener : NULL,
		.log = file->log,
	};
	struct gz_decoded decoded;
	enum gz_result result = gz_decode_run(&job, &decoded);
	if (decoding.scratch_fd >= 0)
		close(decoding.scratch_fd);
	if (result != GZ_OK)
		return result;
	struct gz_volume volume = volume_of_header(&decoded.header);
	volume.voxels = decoded.voxels;
	volume.mapped = decoded.mapped;
	gz_volume_place_colours(&volume);
	result = check_voxels(file, &decoded.header, &volume);
	if (result != GZ_OK) {
		gz_volume_free(&volume);
		return result;
	}
	*out_volume = volume;
	return GZ_OK;
}
