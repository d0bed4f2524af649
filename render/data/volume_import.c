#include "render/data/volume_import.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"
#include "render/data/float_scaling.h"
#include "render/data/voxel_colour.h"
#include "render/data/voxel_place.h"
#include "render/data/whole_numbers.h"

#define GZ_LOG_MODULE "volume"

/* Numbers read at once. Chosen: they and their conversion fit a second-level cache. */
#define CHUNK_NUMBERS 16384

/* Unit vectors with a determinant below this do not span space (chosen). */
#define SINGULAR 1e-3

/* From this angle on the log says that a volume is oblique or sheared (chosen: less is not
 * visible).
 */
#define OBLIQUE_DEG 1.0

#define DEG_PER_RAD (180.0 / 3.14159265358979323846)

struct gz_import_layout gz_import_layout_default(void)
{
	return (struct gz_import_layout) {
		.dims = { 1, 1, 1 },
		.spacing = { 1, 1, 1 },
		.direction = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } },
		.type = GZ_RAW_UINT8,
		.slope = 1,
	};
}

size_t gz_raw_type_size(enum gz_raw_type type)
{
	return (unsigned)type < GZ_RAW_TYPE_COUNT ? gz_voxel_conversions[type].size : 0;
}

static int channels_of(const struct gz_import_layout *layout)
{
	return layout->channels > 1 ? layout->channels : 1;
}

size_t gz_import_voxel_size(const struct gz_import_layout *layout)
{
	return (size_t)channels_of(layout) * gz_raw_type_size(layout->type);
}

/* Which axes of the volume the file's axes become. */
struct axis_map {
	int world[3]; /* the world axis nearest to each file axis */
	bool flip[3];
};

/* One import. */
struct import {
	const struct gz_import_layout *layout;
	const struct gz_voxel_conversion *conversion;
	const struct gz_volume_file *file;
	struct gz_volume *volume;
	size_t voxel_size; /* in the file, bytes */
	bool swap;
	struct gz_voxel_place place;
	bool whole; /* integers of 32 bits, which are words until all are read */
	double whole_range[2], whole_shift; /* of their numbers, once they are stored */
	int time_points, time_point;
	uint64_t begun, all; /* voxels read of time points before, and to be read in all */
};

static enum gz_result check_layout(const struct gz_import_layout *layout,
				   const struct gz_volume_file *file)
{
	for (int axis = 0; axis < 3; axis++) {
		if (layout->dims[axis] < 1 || layout->dims[axis] > GZ_VOLUME_DIM_MAX) {
			gz_err(file->log, "%s: %d voxels along axis %d; allowed: 1 to %d",
			       file->path, layout->dims[axis], axis + 1, GZ_VOLUME_DIM_MAX);
			return GZ_ERR_FORMAT;
		}
		double spacing = layout->spacing[axis];
		if (!isfinite(layout->dims[axis] * spacing) || spacing <= 0) {
			gz_err(file->log,
			       "%s: spacing %g along axis %d; it must be above 0, and the edge "
			       "finite",
			       file->path, spacing, axis + 1);
			return GZ_ERR_FORMAT;
		}
	}
	const double lengths = gz_volume_edge_lengths(layout->dims, layout->spacing);
	if (!(lengths <= GZ_VOLUME_EDGE_LENGTHS_MAX)) {
		gz_err(file->log,
		       "%s: spacing %g %g %g makes the longest edge %g times the finest spacing; "
		       "allowed: %d; correct the spacing or resample the volume",
		       file->path, layout->spacing[0], layout->spacing[1], layout->spacing[2],
		       lengths, GZ_VOLUME_EDGE_LENGTHS_MAX);
		return GZ_ERR_FORMAT;
	}
	if (!isfinite(layout->slope) || layout->slope == 0 || !isfinite(layout->intercept)) {
		gz_err(file->log,
		       "%s: values scaled by %g and %g; they must be finite, the first not 0",
		       file->path, layout->slope, layout->intercept);
		return GZ_ERR_FORMAT;
	}
	return GZ_OK;
}

/* Choose what the values of colours are. */
static enum gz_result choose_colour(const struct import *import)
{
	const struct gz_import_layout *layout = import->layout;
	const struct gz_loading *loading = import->file->loading;
	const enum gz_opacity_source source = loading ? loading->opacity : GZ_OPACITY_AUTO;
	const int channels = channels_of(layout);
	if (channels == 1)
		return GZ_OK;
	if (channels != 3 && channels != 4) {
		gz_err(import->file->log,
		       "%s: %d numbers a voxel; read are 1, and 3 or 4 as a colour",
		       import->file->path, channels);
		return GZ_ERR_UNSUPPORTED;
	}
	if (layout->type != GZ_RAW_UINT8 && layout->type != GZ_RAW_UINT16) {
		gz_err(import->file->log,
		       "%s: colours of type %s are not read; convert them to uint8 or uint16",
		       import->file->path, gz_raw_type_names[layout->type]);
		return GZ_ERR_UNSUPPORTED;
	}
	if (channels == 3 && source == GZ_OPACITY_ALPHA) {
		gz_err(import->file->log,
		       "%s: its colours have no alpha; set volume.opacity to luminance",
		       import->file->path);
		return GZ_ERR_INVAL;
	}
	if (layout->type == GZ_RAW_UINT16)
		gz_info(import->file->log, "%s: of its colours of 16 bits the higher 8 are shown",
			import->file->path);
	import->volume->colour = channels == 4 && source != GZ_OPACITY_LUMINANCE
					 ? GZ_COLOUR_ALPHA
					 : GZ_COLOUR_LUMINANCE;
	return GZ_OK;
}

static bool unit_directions(const struct gz_import_layout *layout, double out[3][3])
{
	for (int axis = 0; axis < 3; axis++) {
		const double *d = layout->direction[axis];
		const double length = gz_length3(d);
		if (!isfinite(length) || !(length > 0))
			return false;
		for (int i = 0; i < 3; i++)
			out[axis][i] = d[i] / length;
	}
	double normal[3];
	gz_cross3(out[1], out[2], normal);
	const double determinant = gz_dot3(out[0], normal);
	return fabs(determinant) > SINGULAR;
}

/* The permutation of axes that agrees best with the directions: the greatest sum of cosines. */
static void nearest_axes(const double unit[3][3], struct axis_map *out_map)
{
	static const int permutations[6][3] = { { 0, 1, 2 }, { 0, 2, 1 }, { 1, 0, 2 },
						{ 1, 2, 0 }, { 2, 0, 1 }, { 2, 1, 0 } };
	double best = -1;
	for (int p = 0; p < 6; p++) {
		const int *world = permutations[p];
		double sum = 0;
		for (int axis = 0; axis < 3; axis++)
			sum += fabs(unit[axis][world[axis]]);
		if (sum > best) {
			best = sum;
			memcpy(out_map->world, world, sizeof out_map->world);
		}
	}
	for (int axis = 0; axis < 3; axis++)
		out_map->flip[axis] = unit[axis][out_map->world[axis]] < 0;
}

/* How far the axes are from right angles, degrees: the worst pair. */
static double shear_of(const double unit[3][3])
{
	double worst = 0;
	for (int axis = 0; axis < 3; axis++)
		worst = fmax(worst, fabs(gz_dot3(unit[axis], unit[(axis + 1) % 3])));
	return asin(fmin(1, worst)) * DEG_PER_RAD;
}

static enum gz_result map_axes(const struct gz_import_layout *layout,
			       const struct gz_volume_file *file, struct axis_map *out_map)
{
	double unit[3][3], worst_deg = 0;
	if (!unit_directions(layout, unit)) {
		gz_err(file->log,
		       "%s: the directions of its axes do not span space; correct its header",
		       file->path);
		return GZ_ERR_FORMAT;
	}
	nearest_axes((const double(*)[3])unit, out_map);
	for (int axis = 0; axis < 3; axis++) {
		double cosine = fmin(1, fabs(unit[axis][out_map->world[axis]]));
		worst_deg = fmax(worst_deg, acos(cosine) * DEG_PER_RAD);
	}
	const double shear_deg = shear_of((const double(*)[3])unit);
	if (shear_deg > OBLIQUE_DEG)
		gz_warn(file->log,
			"%s: its axes are sheared by %.1f degrees and up to %.1f degrees off the "
			"anatomical ones; drawn without the shear, along the nearest axes",
			file->path, shear_deg, worst_deg);
	else if (worst_deg > OBLIQUE_DEG)
		gz_info(file->log, "%s: oblique by %.1f degrees; shown along the nearest axes",
			file->path, worst_deg);
	return GZ_OK;
}

/* What to do about a file that is too short. Only files without a header have a layout to correct.
 */
static const char *short_data_remedy(const struct import *import)
{
	return import->file->raw
		       ? "correct dims and type, or fetch it again"
		       : "the header claims more than the file holds; fetch the file again";
}

/* Refuse a size that the file cannot hold, before memory is allocated for it. */
static enum gz_result check_claimed_size(const struct gz_byte_stream *stream,
					 const struct import *import, uint64_t bytes)
{
	uint64_t bound = gz_byte_stream_bound(stream);
	if (bytes <= bound)
		return GZ_OK;
	const int *dims = import->layout->dims;
	char each[32] = "", points[48] = "";
	if (channels_of(import->layout) > 1)
		snprintf(each, sizeof each, "%d x ", channels_of(import->layout));
	if (import->time_point > 0)
		snprintf(points, sizeof points, "%d time points of ", import->time_point + 1);
	gz_err(import->file->log,
	       "%s: truncated: %s%d x %d x %d voxels of %s%s are %llu bytes, the file can hold "
	       "%llu; %s",
	       import->file->path, points, dims[0], dims[1], dims[2], each,
	       gz_raw_type_names[import->layout->type], (unsigned long long)bytes,
	       (unsigned long long)bound, short_data_remedy(import));
	return GZ_ERR_FORMAT;
}

static enum gz_result allocate_voxels(struct import *import, const struct axis_map *map)
{
	struct gz_volume *volume = import->volume;
	const struct gz_import_layout *layout = import->layout;
	for (int axis = 0; axis < 3; axis++) {
		volume->dims[map->world[axis]] = layout->dims[axis];
		volume->spacing[map->world[axis]] = layout->spacing[axis];
	}
	const bool coloured = volume->colour != GZ_COLOUR_NONE;
	volume->type = coloured ? GZ_VOXEL_U8 : import->conversion->type;
	volume->spacing_assumed = layout->spacing_assumed;
	volume->modality = layout->modality;
	volume->oriented = layout->oriented;
	volume->labels = layout->labels;
	const double slope = coloured ? 1 : layout->slope;
	/* The offset of words goes when they are stored. */
	const double offset = import->whole ? 0 : import->conversion->offset;
	const double intercept = coloured ? 0 : layout->intercept + layout->slope * offset;
	volume->slope = slope;
	volume->intercept = intercept;
	const char *scratch = import->file->loading ? import->file->loading->scratch : NULL;
	const enum gz_result result = gz_volume_allocate_in(volume, import->file->loading);
	if (result != GZ_OK) {
		const double mib = (double)gz_volume_bytes(volume) / (1 << 20);
		if (scratch)
			gz_err(import->file->log,
			       "%s: no %.0f MiB for voxels in %s: %s; make room there",
			       import->file->path, mib, scratch, gz_result_text(result));
		else
			gz_err(import->file->log,
			       "%s: no memory for %.0f MiB of voxels; write it as bricks (gazeview "
			       "--write-volume) or use a smaller volume",
			       import->file->path, mib);
		return result;
	}
	volume->slope = slope;
	volume->intercept = intercept;

	const ptrdiff_t step[3] = { 1, volume->dims[0],
				    (ptrdiff_t)volume->dims[0] * volume->dims[1] };
	for (int axis = 0; axis < 3; axis++) {
		ptrdiff_t stride = step[map->world[axis]];
		import->place.dims[axis] = layout->dims[axis];
		if (map->flip[axis])
			import->place.first += stride * (layout->dims[axis] - 1);
		import->place.stride[axis] = map->flip[axis] ? -stride : stride;
	}
	return GZ_OK;
}

static enum gz_result refuse_short_data(const struct import *import, uint64_t got, uint64_t wanted)
{
	gz_err(import->file->log, "%s: truncated: %llu of %llu bytes of voxels; %s",
	       import->file->path, (unsigned long long)got, (unsigned long long)wanted,
	       short_data_remedy(import));
	return GZ_ERR_FORMAT;
}

/* Report what share is read. @p at counts voxels of the present time point. */
static bool import_goes_on(const struct import *import, uint64_t at)
{
	return gz_loading_goes_on(import->file->loading,
				  (double)(import->begun + at) / (double)import->all,
				  import->file->path);
}

/* Voxels that are read and not placed yet. */
struct slab {
	uint8_t *numbers;  /* room for CHUNK_NUMBERS voxels of the file */
	uint8_t *voxels;   /* converted numbers */
	uint32_t *colours; /* of each voxel; NULL if there are none */
	size_t filled;
};

static void free_slab(struct slab *slab)
{
	free(slab->numbers);
	free(slab->voxels);
	free(slab->colours);
}

/* Make room for so many voxels. */
static enum gz_result make_slab(const struct import *import, size_t voxels, struct slab *out_slab)
{
	const bool coloured = import->volume->colour != GZ_COLOUR_NONE;
	struct slab slab = {
		.numbers = malloc(CHUNK_NUMBERS * import->voxel_size),
		.voxels = malloc(voxels * gz_voxel_size(import->volume->type)),
		.colours = coloured ? malloc(voxels * sizeof *slab.colours) : NULL,
	};
	*out_slab = slab;
	if (slab.numbers && slab.voxels && (slab.colours || !coloured))
		return GZ_OK;
	gz_err(import->file->log, "%s: no memory to read it", import->file->path);
	return GZ_ERR_NO_MEM;
}

/* Convert `count` voxels behind those that the slab has. */
static void convert_numbers(const struct import *import, size_t count, struct slab *slab)
{
	const struct gz_volume *volume = import->volume;
	uint8_t *voxels = slab->voxels + slab->filled * gz_voxel_size(volume->type);
	if (volume->colour == GZ_COLOUR_NONE) {
		import->conversion->convert(slab->numbers, count, import->swap, voxels);
		return;
	}
	const struct gz_colour_conversion conversion = {
		.channels = import->layout->channels,
		.bytes = (int)import->conversion->size,
		.swap = import->swap,
		.colour = volume->colour,
	};
	gz_colours_convert(&conversion, slab->numbers, count, voxels, slab->colours + slab->filled);
}

/* Read `count` voxels into the slab, beginning with number `index` of the file. */
static enum gz_result fill_slab(struct gz_byte_stream *stream, const struct import *import,
				uint64_t index, size_t count, struct slab *slab)
{
	const size_t size = import->voxel_size;
	const uint64_t all = gz_volume_voxel_count(import->volume);
	for (slab->filled = 0; slab->filled < count;) {
		const uint64_t at = index + slab->filled;
		const size_t left = count - slab->filled;
		const size_t wanted = left < CHUNK_NUMBERS ? left : CHUNK_NUMBERS;
		size_t got = 0;
		if (!import_goes_on(import, at))
			return GZ_ERR_CANCELLED;
		const enum gz_result result =
			gz_byte_stream_read(stream, slab->numbers, wanted * size, &got);
		if (result != GZ_OK)
			return result;
		if (got < wanted * size)
			return refuse_short_data(import, at * size + got, all * size);
		convert_numbers(import, wanted, slab);
		slab->filled += wanted;
	}
	return GZ_OK;
}

static void place_slab(const struct import *import, const struct slab *slab, uint64_t index,
		       size_t count)
{
	const struct gz_volume *volume = import->volume;
	gz_voxel_place(&import->place, volume, slab->voxels, index, count);
	if (volume->colour == GZ_COLOUR_NONE)
		return;
	/* Colours are words of 32 bits, which are moved as floats are. */
	struct gz_volume words = *volume;
	words.type = GZ_VOXEL_F32;
	words.voxels = volume->colours;
	gz_voxel_place(&import->place, &words, slab->colours, index, count);
}

static enum gz_result read_voxels(struct gz_byte_stream *stream, const struct import *import,
				  uint64_t count)
{
	const enum gz_voxel_type type =
		import->volume->colour != GZ_COLOUR_NONE ? GZ_VOXEL_F32 : import->volume->type;
	struct slab slab;
	enum gz_result result = make_slab(import, gz_voxel_place_most(&import->place, type), &slab);
	for (uint64_t index = 0; index < count && result == GZ_OK;) {
		const size_t next = gz_voxel_place_next(&import->place, type, index);
		result = fill_slab(stream, import, index, next, &slab);
		if (result == GZ_OK)
			place_slab(import, &slab, index, next);
		index += next;
	}
	free_slab(&slab);
	return result;
}

/* Widen a range by the finite ones among voxels. */
static void widen_range(const struct import *import, const void *voxels, size_t count,
			double range[2])
{
	const enum gz_voxel_type type = import->volume->type;
	if (import->whole) {
		gz_whole_numbers_widen(voxels, count, import->conversion->offset, range);
		return;
	}
	for (size_t i = 0; i < count; i++) {
		const double stored = gz_voxel_stored(type, voxels, i);
		if (!isfinite(stored))
			continue;
		range[0] = fmin(range[0], stored);
		range[1] = fmax(range[1], stored);
	}
}

/* Read a time point for its range alone. */
static enum gz_result scan_voxels(struct gz_byte_stream *stream, const struct import *import,
				  uint64_t count, double range[2])
{
	struct slab slab;
	enum gz_result result = make_slab(import, CHUNK_NUMBERS, &slab);
	for (uint64_t index = 0; index < count && result == GZ_OK;) {
		const uint64_t left = count - index;
		const size_t next = left < CHUNK_NUMBERS ? (size_t)left : CHUNK_NUMBERS;
		result = fill_slab(stream, import, index, next, &slab);
		if (result == GZ_OK)
			widen_range(import, slab.voxels, next, range);
		index += next;
	}
	free_slab(&slab);
	return result;
}

static bool is_data_missing(enum gz_result result)
{
	return result == GZ_ERR_FORMAT || result == GZ_ERR_IO || result == GZ_ERR_NOT_FOUND;
}

/* Read all time points, of which one is kept. The volume's number_range becomes that of the others.
 */
static enum gz_result read_whole_series(struct gz_byte_stream *stream, struct import *import,
					uint64_t count)
{
	double *range = import->volume->number_range;
	enum gz_result result = GZ_OK;
	range[0] = INFINITY;
	range[1] = -INFINITY;
	import->all = count * (uint64_t)import->time_points;
	gz_byte_stream_read_ahead(stream, import->all * import->voxel_size);
	for (int point = 0; point < import->time_points && result == GZ_OK; point++) {
		result = point == import->time_point ? read_voxels(stream, import, count)
						     : scan_voxels(stream, import, count, range);
		if (point > import->time_point && is_data_missing(result)) {
			gz_warn(import->file->log,
				"%s: of its %d time points only the first %d can be read",
				import->file->path, import->time_points, point);
			import->time_points = point;
			return GZ_OK;
		}
		import->begun += count;
	}
	return result;
}

/* Read the time point that is asked for. */
static enum gz_result read_time_point(struct gz_byte_stream *stream, struct import *import,
				      uint64_t count)
{
	const struct gz_loading *loading = import->file->loading;
	const double *known = loading ? loading->number_range : NULL;
	if (import->time_points > 1 && !known)
		return read_whole_series(stream, import, count);
	const uint64_t bytes = count * import->voxel_size;
	enum gz_result result = GZ_OK;
	if (import->time_point > 0)
		result = gz_byte_stream_skip(stream, (uint64_t)import->time_point * bytes);
	import->all = count;
	if (known)
		memcpy(import->volume->number_range, known, sizeof import->volume->number_range);
	gz_byte_stream_read_ahead(stream, bytes);
	return result == GZ_OK ? read_voxels(stream, import, count) : result;
}

/* Join the range of the volume and that of the other time points. */
static void take_stored_range(const struct import *import)
{
	struct gz_volume *volume = import->volume;
	if (import->time_points <= 1)
		return;
	volume->time_points = import->time_points;
	volume->time_point = import->time_point;
	if (import->whole) {
		const double *range = import->whole_range;
		memcpy(volume->number_range, range, sizeof volume->number_range);
		/* rounded as the voxels are */
		volume->stored_min = (double)(float)(range[0] - import->whole_shift);
		volume->stored_max = (double)(float)(range[1] - import->whole_shift);
		return;
	}
	volume->stored_min = volume->number_range[0] =
		fmin(volume->number_range[0], volume->stored_min);
	volume->stored_max = volume->number_range[1] =
		fmax(volume->number_range[1], volume->stored_max);
}

static enum gz_result choose_time_point(struct import *import)
{
	const struct gz_loading *loading = import->file->loading;
	const int points = import->layout->time_points;
	import->time_points = points > 1 ? points : 1;
	import->time_point = loading ? loading->time_point : 0;
	if (points > GZ_TIME_POINTS_MAX) {
		gz_err(import->file->log, "%s: %d time points; allowed: 1 to %d",
		       import->file->path, points, GZ_TIME_POINTS_MAX);
		return GZ_ERR_FORMAT;
	}
	if (import->time_point >= 0 && import->time_point < import->time_points)
		return GZ_OK;
	gz_err(import->file->log, "%s: no time point %d: it has %d; correct volume.time_point",
	       import->file->path, import->time_point + 1, import->time_points);
	return GZ_ERR_INVAL;
}

/* Read on after the voxels: the decoder then checks its checksum, and extra bytes are often the
 * first sign of damage. At most as many bytes again as the voxels are read. */
static enum gz_result check_data_end(struct gz_byte_stream *stream, const struct import *import,
				     uint64_t bytes)
{
	uint8_t scrap[4096];
	uint64_t more = 0;
	size_t got = 0;
	/* Of a series whose range is known, the rest is not read. */
	const bool to_end = import->begun == import->all;
	if (import->layout->more_follows || (import->layout->time_points > 1 && !to_end))
		return GZ_OK;
	do {
		enum gz_result result = gz_byte_stream_read(stream, scrap, sizeof scrap, &got);
		if (result != GZ_OK)
			return result;
		more += got;
	} while (got == sizeof scrap && more < bytes);
	if (more > 0)
		gz_warn(import->file->log,
			"%s: there are more data after the last voxel; they are left out; are dims "
			"and type "
			"right?",
			import->file->path);
	return GZ_OK;
}

/* Store words as floats, now that their range is known. Of a series all time points are shifted
 * alike. */
static void store_whole_numbers(struct import *import)
{
	struct gz_volume *volume = import->volume;
	const struct gz_loading *loading = import->file->loading;
	const size_t count = gz_volume_voxel_count(volume);
	struct gz_whole_storing storing = { .offset = import->conversion->offset };
	double *range = import->whole_range;
	if (!import->whole)
		return;
	range[0] = import->time_points > 1 ? volume->number_range[0] : INFINITY;
	range[1] = import->time_points > 1 ? volume->number_range[1] : -INFINITY;
	gz_whole_numbers_widen(volume->voxels, count, storing.offset, range);
	/* A program that has a series decoded knows its range, but not the shift. */
	if (import->time_points <= 1 || !loading || !loading->give_memory)
		import->whole_shift = storing.shift = gz_whole_numbers_shift(range);
	volume->intercept += volume->slope * storing.shift;
	gz_whole_numbers_store(volume->voxels, count, &storing);
	/* Scaled values are seldom whole numbers; of a series it is said once. */
	if (storing.rounded > 0 && volume->slope == 1 && !(loading && loading->number_range))
		gz_warn(import->file->log,
			"%s: %zu of its numbers need more than the 24 bits of single precision; "
			"they are rounded, by up to %g",
			import->file->path, storing.rounded, storing.worst);
}

/* Whether the data value of a voxel is finite as float, in which it is drawn and written. */
static bool is_value_finite(const struct gz_volume *volume, double stored)
{
	return fabs(volume->slope * stored + volume->intercept) <= (double)FLT_MAX;
}

/* Sets the volume's range too. */
static bool are_values_finite(struct gz_volume *volume)
{
	const float *v = volume->voxels;
	const size_t count = volume->type == GZ_VOXEL_F32 ? gz_volume_voxel_count(volume) : 0;
	size_t bad = 0;
	for (size_t i = 0; i < count; i++)
		bad += !isfinite(v[i]);
	if (bad > 0)
		return false;
	gz_volume_find_range(volume);
	return is_value_finite(volume, volume->stored_min) &&
	       is_value_finite(volume, volume->stored_max);
}

static void store_voxel(struct gz_volume *volume, size_t index, double stored)
{
	if (volume->type == GZ_VOXEL_U8)
		((uint8_t *)volume->voxels)[index] = (uint8_t)stored;
	else if (volume->type == GZ_VOXEL_U16)
		((uint16_t *)volume->voxels)[index] = (uint16_t)stored;
	else
		((float *)volume->voxels)[index] = (float)stored;
}

/* Replace values that are not finite by the least finite value, and find the range. */
static enum gz_result make_finite(const struct import *import)
{
	struct gz_volume *volume = import->volume;
	const size_t count = gz_volume_voxel_count(volume);
	size_t bad = 0;
	double least = 0, least_value = INFINITY;
	if (are_values_finite(volume))
		return GZ_OK;
	for (size_t i = 0; i < count; i++) {
		const double stored = gz_voxel_stored(volume->type, volume->voxels, i);
		const double value = volume->slope * stored + volume->intercept;
		if (!is_value_finite(volume, stored)) {
			bad++;
		} else if (value < least_value) {
			least_value = value;
			least = stored;
		}
	}
	if (bad == count) {
		gz_err(import->file->log,
		       "%s: no finite value in it; are type, endian and scaling right?",
		       import->file->path);
		return GZ_ERR_FORMAT;
	}
	for (size_t i = 0; i < count; i++)
		if (!is_value_finite(volume, gz_voxel_stored(volume->type, volume->voxels, i)))
			store_voxel(volume, i, least);
	gz_warn(import->file->log, "%s: %zu %s NaN or infinite as float; shown as the least, %g",
		import->file->path, bad, bad == 1 ? "value is" : "values are", least_value);
	gz_volume_find_range(volume);
	return GZ_OK;
}

/* Alpha that is the same everywhere says nothing; many programs write such. Time points share one
 * choice, so that of a series it is only told. */
static void check_alpha(const struct import *import)
{
	struct gz_volume *volume = import->volume;
	const struct gz_loading *loading = import->file->loading;
	if (volume->colour != GZ_COLOUR_ALPHA || (loading && loading->opacity != GZ_OPACITY_AUTO) ||
	    volume->stored_min < volume->stored_max)
		return;
	if (import->time_points > 1) {
		gz_warn(import->file->log,
			"%s: alpha is %g in all of this time point; volume.opacity = luminance "
			"would show its colours",
			import->file->path, volume->stored_min);
		return;
	}
	gz_info(import->file->log, "%s: alpha is %g everywhere, so it is passed over",
		import->file->path, volume->stored_min);
	gz_volume_take_luminance(volume);
}

/* Say what the values of colours are; of a series once. */
static void tell_colour(const struct import *import)
{
	const struct gz_loading *loading = import->file->loading;
	if (import->volume->colour != GZ_COLOUR_NONE && !(loading && loading->number_range))
		gz_info(import->file->log,
			"%s: voxels have colours; the transfer function gives opacity by %s",
			import->file->path, gz_volume_colour_text(import->volume->colour));
}

/* Warn if the file may tell values apart that single precision does not. */
static void warn_rounded_flat(const struct import *import)
{
	const struct gz_volume *volume = import->volume;
	const enum gz_raw_type type = import->layout->type;
	if (volume->type != GZ_VOXEL_F32 || type == GZ_RAW_FLOAT32 || import->whole ||
	    volume->stored_min < volume->stored_max || gz_volume_voxel_count(volume) == 1)
		return;
	gz_warn(import->file->log,
		"%s: all values are %g in single precision; if the file's %s values differ, scale "
		"and shift them before",
		import->file->path, volume->stored_min, gz_raw_type_names[type]);
}

enum gz_result gz_volume_import(struct gz_byte_stream *stream,
				const struct gz_import_layout *layout,
				const struct gz_volume_file *file, struct gz_volume *out_volume)
{
	struct gz_volume volume = { 0 };
	struct axis_map map;
	const struct gz_voxel_conversion *words = gz_whole_number_words(layout->type);
	struct import import = { .layout = layout,
				 .conversion = words ? words : &gz_voxel_conversions[layout->type],
				 .whole = words != NULL,
				 .file = file,
				 .volume = &volume,
				 .voxel_size = (size_t)channels_of(layout) *
					       gz_voxel_conversions[layout->type].size,
				 .swap = layout->big_endian != gz_host_big_endian() };

	enum gz_result result = check_layout(layout, file);
	if (result == GZ_OK)
		result = choose_time_point(&import);
	if (result == GZ_OK)
		result = choose_colour(&import);
	/* At most 2^42 voxels of 8 bytes and 2^16 time points: no overflow. */
	uint64_t count =
		(uint64_t)layout->dims[0] * (uint64_t)layout->dims[1] * (uint64_t)layout->dims[2];
	if (result == GZ_OK)
		result = check_claimed_size(stream, &import,
					    count * import.voxel_size *
						    (uint64_t)(import.time_point + 1));
	if (result == GZ_OK)
		result = map_axes(layout, file, &map);
	if (result == GZ_OK)
		result = allocate_voxels(&import, &map);
	if (result == GZ_OK)
		result = read_time_point(stream, &import, count);
	if (result == GZ_OK)
		result = check_data_end(stream, &import, count * import.voxel_size);
	if (result == GZ_OK) {
		store_whole_numbers(&import);
		result = make_finite(&import);
	}
	if (result == GZ_OK) {
		warn_rounded_flat(&import);
		check_alpha(&import);
		tell_colour(&import);
		take_stored_range(&import);
		gz_volume_scale_floats(&volume);
	}
	if (result != GZ_OK) {
		gz_volume_free(&volume);
		return result;
	}
	*out_volume = volume;
	return GZ_OK;
}
