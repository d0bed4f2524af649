#include "render/decode/minc/minc_image.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "render/data/length_unit.h"
#include "render/decode/minc/minc_hdf.h"

#define GZ_LOG_MODULE "minc"

/* Three through space, time, and the numbers of a voxel. */
#define AXES_MAX GZ_HDF_AXES_MAX

/* Scales of slices that are read (chosen: a thousand time points of the longest axis). */
#define SCALES_MAX (GZ_VOLUME_DIM_MAX * 1024)

/* Best ratio of deflate, the filter that MINC uses (zlib.net/zlib_tech.html). */
#define DEFLATE_RATIO 1032

/* Most memory for chunks that a slice crosses, bytes. Chosen: far below the limit of the process.
 */
#define CHUNK_CACHE_MAX ((size_t)1 << 30)

/* Chunks that are kept (chosen: their table takes 10 MiB). */
#define CACHED_CHUNKS_MAX ((size_t)1 << 17)

#define NO_AXIS (-1)

/* One axis of the image, in the order of the file. */
struct minc_axis {
	char name[32];
	size_t size;
	double step;
	char unit[GZ_HDF_TEXT_SIZE]; /* of the step; empty: not given */
	double cosines[3];
};

struct gz_minc_image {
	const struct gz_volume_file *file;
	hid_t hdf, access, voxels, memory_type; /* GZ_HDF_NONE: none; access: of links and voxels */
	struct minc_axis axes[AXES_MAX];
	int rank;
	int space[3]; /* axes through space, the slowest first */
	int time;     /* NO_AXIS: none */
	struct gz_import_layout layout;
	enum gz_raw_type stored; /* as the file has the voxels */
	uint64_t bytes_bound;
	double valid[2];          /* the numbers that image-min and image-max are, of integers */
	double within[2];         /* least and greatest number that the type and `valid` allow */
	bool clamp;               /* numbers of the type may be outside of that */
	double *least, *greatest; /* what the ends of the valid range mean, for each scale */
	size_t scales;            /* 0: numbers are values */
	int scaled_axes;          /* the scales run along so many axes, the slowest */
	double *numbers;          /* of a slice that is scaled; NULL until it is needed */
};

static enum gz_result refuse_minc(const struct gz_minc_image *image, enum gz_result result,
				  const char *what)
{
	gz_err(image->file->log, "%s: %s", image->file->path, what);
	return result;
}

static enum gz_result refuse_damaged_minc(const struct gz_minc_image *image)
{
	return refuse_minc(image, GZ_ERR_FORMAT, "its HDF5 is damaged; fetch it again");
}

static enum gz_result refuse_no_memory(const struct gz_minc_image *image)
{
	return refuse_minc(image, GZ_ERR_NO_MEM, "no memory to read it");
}

/* ---- the file and its image ---- */

static enum gz_result open_minc_file(struct gz_minc_image *image)
{
	struct stat status;
	const char *path = image->file->path;
	if (stat(path, &status) != 0) {
		gz_err(image->file->log, "%s: cannot open it: %s; check its name and permissions",
		       path, strerror(errno));
		return GZ_ERR_NOT_FOUND;
	}
	image->bytes_bound = (uint64_t)status.st_size;
	image->hdf = gz_hdf_open(path);
	if (image->hdf < 0)
		return refuse_minc(image, GZ_ERR_FORMAT,
				   "not a complete HDF5 file; fetch it again");
	image->access = gz_hdf_access();
	if (image->access < 0)
		return refuse_no_memory(image);
	return GZ_OK;
}

/* Open a part of the image; below 0 if there is none. */
static hid_t open_part(const struct gz_minc_image *image, const char *name)
{
	char path[64];
	snprintf(path, sizeof path, "/minc-2.0/image/0/%s", name);
	return H5Dopen2(image->hdf, path, image->access);
}

/* The names of a part's axes: dimorder, of which there may be more than the part has axes. */
static bool take_axis_names(hid_t part, int rank, char names[AXES_MAX][32])
{
	char order[GZ_HDF_TEXT_SIZE];
	char *at = order;
	(void)gz_hdf_text(part, "dimorder", order);
	for (int axis = 0; axis < rank; axis++) {
		const size_t length = strcspn(at, ", ");
		if (length == 0 || length >= sizeof names[0])
			return false;
		memcpy(names[axis], at, length);
		names[axis][length] = 0;
		at += length;
		at += strspn(at, ", ");
	}
	return true;
}

/* ---- axes ---- */

/* Which axis through space has this name: 0 to 2 for x to z; NO_AXIS. */
static int space_axis_named(const char *name)
{
	static const char *const names[3] = { "xspace", "yspace", "zspace" };
	for (int i = 0; i < 3; i++)
		if (strcmp(name, names[i]) == 0)
			return i;
	return NO_AXIS;
}

/* Step and directions; what the file does not say is as libminc has it: 1 along the axis' own
 * direction. */
static enum gz_result take_minc_axis(struct gz_minc_image *image, struct minc_axis *axis)
{
	char path[96], text[GZ_HDF_TEXT_SIZE];
	const int world = space_axis_named(axis->name);
	axis->step = 1;
	axis->unit[0] = '\0';
	for (int i = 0; i < 3; i++)
		axis->cosines[i] = i == world;
	snprintf(path, sizeof path, "/minc-2.0/dimensions/%s", axis->name);
	const hid_t object = H5Oopen(image->hdf, path, image->access);
	if (object < 0)
		return GZ_OK;
	(void)gz_hdf_numbers(object, "step", &axis->step, 1);
	(void)gz_hdf_numbers(object, "direction_cosines", axis->cosines, 3);
	(void)gz_hdf_text(object, "units", axis->unit);
	(void)gz_hdf_text(object, "spacing", text);
	H5Oclose(object);
	if (world == NO_AXIS || strncmp(text, "irregular", 9) != 0)
		return GZ_OK;
	gz_err(image->file->log,
	       "%s: its %s is sampled at irregular places; resample it with mincresample",
	       image->file->path, axis->name);
	return GZ_ERR_UNSUPPORTED;
}

/* Which axis is which. */
static enum gz_result sort_minc_axes(struct gz_minc_image *image)
{
	int found = 0, seen = 0;
	image->time = NO_AXIS;
	for (int i = 0; i < image->rank; i++) {
		const struct minc_axis *axis = &image->axes[i];
		const int world = space_axis_named(axis->name);
		if (world != NO_AXIS && found < 3 && !(seen & 1 << world)) {
			seen |= 1 << world;
			image->space[found++] = i;
		} else if (world == NO_AXIS && strcmp(axis->name, "time") == 0 &&
			   image->time == NO_AXIS) {
			image->time = i;
		} else if (axis->size != 1) {
			gz_err(image->file->log,
			       "%s: %zu numbers along %s; axes through space and time are read",
			       image->file->path, axis->size, axis->name);
			return GZ_ERR_UNSUPPORTED;
		}
	}
	if (found == 3)
		return GZ_OK;
	return refuse_minc(image, GZ_ERR_FORMAT,
			   "its image has not the axes xspace, yspace and zspace");
}

static enum gz_result take_minc_axes(struct gz_minc_image *image)
{
	char names[AXES_MAX][32];
	hsize_t sizes[AXES_MAX];
	image->rank = gz_hdf_sizes(image->voxels, sizes);
	if (image->rank < 3 || !take_axis_names(image->voxels, image->rank, names))
		return refuse_minc(image, GZ_ERR_FORMAT,
				   "its image has not three to five axes with names");
	for (int i = 0; i < image->rank; i++) {
		struct minc_axis *axis = &image->axes[i];
		memcpy(axis->name, names[i], sizeof axis->name);
		/* What is out of range is refused by gz_volume_import(). */
		axis->size = sizes[i] < INT32_MAX ? (size_t)sizes[i] : INT32_MAX;
		const enum gz_result result = take_minc_axis(image, axis);
		if (result != GZ_OK)
			return result;
	}
	return sort_minc_axes(image);
}

/* MINC's coordinates are RAS+; a step below 0 runs against the direction. */
static void lay_out_axes(struct gz_minc_image *image)
{
	struct gz_import_layout *layout = &image->layout;
	const char *unit = image->axes[image->space[2]].unit;
	double mm = gz_length_unit_take(unit, image->file->path, image->file->log);
	for (int i = 0; i < 3; i++) {
		const struct minc_axis *axis = &image->axes[image->space[2 - i]];
		layout->dims[i] = (int)axis->size;
		const bool told = strcmp(axis->unit, unit) == 0;
		unit = axis->unit;
		mm = told ? mm : gz_length_unit_take(unit, image->file->path, image->file->log);
		layout->spacing[i] = fabs(axis->step) * mm;
		for (int k = 0; k < 3; k++)
			layout->direction[i][k] =
				axis->step < 0 ? -axis->cosines[k] : axis->cosines[k];
	}
	layout->oriented = true;
	layout->big_endian = gz_host_big_endian();
	if (image->time != NO_AXIS)
		layout->time_points = (int)image->axes[image->time].size;
}

/* ---- numbers and what they mean ---- */

static bool raw_type_of(hid_t type, enum gz_raw_type *out)
{
	const size_t size = H5Tget_size(type);
	const bool is_signed = H5Tget_sign(type) == H5T_SGN_2;
	const H5T_class_t kind = H5Tget_class(type);
	if (kind == H5T_FLOAT && (size == 4 || size == 8))
		*out = size == 4 ? GZ_RAW_FLOAT32 : GZ_RAW_FLOAT64;
	else if (kind == H5T_INTEGER && size == 1)
		*out = is_signed ? GZ_RAW_INT8 : GZ_RAW_UINT8;
	else if (kind == H5T_INTEGER && size == 2)
		*out = is_signed ? GZ_RAW_INT16 : GZ_RAW_UINT16;
	else if (kind == H5T_INTEGER && size == 4)
		*out = is_signed ? GZ_RAW_INT32 : GZ_RAW_UINT32;
	else
		return false;
	return true;
}

/* How numbers are read into memory. */
static hid_t memory_type_of(enum gz_raw_type type)
{
	switch (type) {
	case GZ_RAW_UINT8:
		return H5T_NATIVE_UINT8;
	case GZ_RAW_INT8:
		return H5T_NATIVE_INT8;
	case GZ_RAW_UINT16:
		return H5T_NATIVE_UINT16;
	case GZ_RAW_INT16:
		return H5T_NATIVE_INT16;
	case GZ_RAW_UINT32:
		return H5T_NATIVE_UINT32;
	case GZ_RAW_INT32:
		return H5T_NATIVE_INT32;
	case GZ_RAW_FLOAT32:
		return H5T_NATIVE_FLOAT;
	default:
		return H5T_NATIVE_DOUBLE;
	}
}

static bool is_float_type(enum gz_raw_type type)
{
	return type == GZ_RAW_FLOAT32 || type == GZ_RAW_FLOAT64;
}

/* Least and greatest integer of a type. */
static void integer_range(enum gz_raw_type type, double out[2])
{
	const int bits = 8 * (int)gz_raw_type_size(type);
	const bool is_signed = type == GZ_RAW_INT8 || type == GZ_RAW_INT16 || type == GZ_RAW_INT32;
	out[0] = is_signed ? -ldexp(1, bits - 1) : 0;
	out[1] = ldexp(1, is_signed ? bits - 1 : bits) - 1;
}

/* The type of the voxels. Labels have an enumeration. */
static enum gz_result take_minc_type(struct gz_minc_image *image, bool *out_labels)
{
	char kind[GZ_HDF_TEXT_SIZE] = "";
	const hid_t type = H5Dget_type(image->voxels);
	if (type < 0)
		return refuse_damaged_minc(image);
	const bool labels = H5Tget_class(type) == H5T_ENUM;
	const hid_t base = labels ? H5Tget_super(type) : H5Tcopy(type);
	const bool known = base >= 0 && raw_type_of(base, &image->stored);
	if (base >= 0)
		H5Tclose(base);
	H5Tclose(type);
	if (!known)
		return refuse_minc(image, GZ_ERR_UNSUPPORTED,
				   "voxels of this type are not read; convert them with: "
				   "mincreshape -float FILE out.mnc");
	const hid_t root = H5Oopen(image->hdf, "/minc-2.0", image->access);
	if (root >= 0) {
		(void)gz_hdf_text(root, "class", kind);
		H5Oclose(root);
	}
	*out_labels = labels || strcmp(kind, "label__") == 0;
	image->memory_type = memory_type_of(image->stored);
	return GZ_OK;
}

/* The numbers that stand for image-min to image-max; without them all of the type's. */
static enum gz_result take_valid_range(struct gz_minc_image *image)
{
	double range[2], whole[2];
	integer_range(image->stored, whole);
	memcpy(range, whole, sizeof range);
	if (!gz_hdf_numbers(image->voxels, "valid_range", range, 2)) {
		(void)gz_hdf_numbers(image->voxels, "valid_min", &range[0], 1);
		(void)gz_hdf_numbers(image->voxels, "valid_max", &range[1], 1);
	}
	image->valid[0] = fmin(range[0], range[1]);
	image->valid[1] = fmax(range[0], range[1]);
	image->within[0] = fmax(image->valid[0], whole[0]);
	image->within[1] = fmin(image->valid[1], whole[1]);
	image->clamp = image->within[0] > whole[0] || image->within[1] < whole[1];
	if (isfinite(range[0]) && isfinite(range[1]) && image->valid[0] < image->valid[1] &&
	    image->within[0] <= image->within[1])
		return GZ_OK;
	gz_err(image->file->log, "%s: its valid range, %g to %g, is not a range; correct it",
	       image->file->path, range[0], range[1]);
	return GZ_ERR_FORMAT;
}

/* How many numbers a part must have that has one for each place along the first `rank` axes; 0: too
 * many, or it is not laid out so. */
static size_t scales_along(const struct gz_minc_image *image, hid_t part, int rank,
			   const hsize_t sizes[AXES_MAX])
{
	char names[AXES_MAX][32];
	size_t count = 1;
	if (rank < 0 || rank > image->rank || !gz_hdf_is_in_file(part))
		return 0;
	/* Without names the axes are taken to be the image's first. */
	const bool named = take_axis_names(part, rank, names);
	for (int i = 0; i < rank; i++) {
		if ((named && strcmp(names[i], image->axes[i].name) != 0) ||
		    sizes[i] != image->axes[i].size || i == image->space[2])
			return 0;
		count *= image->axes[i].size;
		if (count > SCALES_MAX)
			return 0;
	}
	return count;
}

/* image-min or image-max: as many numbers as the other one. */
static enum gz_result read_scales(struct gz_minc_image *image, hid_t part, double **out)
{
	hsize_t sizes[AXES_MAX];
	const int rank = gz_hdf_sizes(part, sizes);
	const size_t count = scales_along(image, part, rank, sizes);
	if (count == 0 || (image->scales != 0 && rank != image->scaled_axes))
		return refuse_minc(image, GZ_ERR_FORMAT,
				   "image-min and image-max do not run along the first axes of its "
				   "image");
	image->scales = count;
	image->scaled_axes = rank;
	*out = malloc(count * sizeof **out);
	if (!*out)
		return refuse_no_memory(image);
	if (H5Dread(part, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, *out) < 0)
		return refuse_damaged_minc(image);
	return GZ_OK;
}

static enum gz_result take_scales(struct gz_minc_image *image)
{
	const hid_t least = open_part(image, "image-min"), greatest = open_part(image, "image-max");
	enum gz_result result = GZ_OK;
	if (least >= 0 && greatest >= 0) {
		result = read_scales(image, least, &image->least);
		if (result == GZ_OK)
			result = read_scales(image, greatest, &image->greatest);
	} else {
		gz_info(image->file->log,
			"%s: has no image-min and image-max; its numbers are taken as values",
			image->file->path);
	}
	if (least >= 0)
		H5Dclose(least);
	if (greatest >= 0)
		H5Dclose(greatest);
	return result;
}

/* From a number to a value, for one scale. */
static void find_minc_scale(const struct gz_minc_image *image, size_t scale, double *out_slope,
			    double *out_intercept)
{
	*out_slope = (image->greatest[scale] - image->least[scale]) /
		     (image->valid[1] - image->valid[0]);
	*out_intercept = image->least[scale] - image->valid[0] * *out_slope;
}

/* Numbers stay as they are if one scale is that of all. */
static void choose_minc_type(struct gz_minc_image *image)
{
	struct gz_import_layout *layout = &image->layout;
	bool alike = true;
	layout->type = image->stored;
	if (image->scales == 0)
		return;
	for (size_t i = 1; i < image->scales; i++)
		alike = alike && image->least[i] == image->least[0] &&
			image->greatest[i] == image->greatest[0];
	find_minc_scale(image, 0, &layout->slope, &layout->intercept);
	if (alike && isfinite(layout->slope) && layout->slope != 0 && isfinite(layout->intercept))
		return;
	layout->type = GZ_RAW_FLOAT32;
	layout->slope = 1;
	layout->intercept = 0;
	image->memory_type = H5T_NATIVE_DOUBLE;
}

/* Floats are values already, and so are labels. */
static enum gz_result take_minc_values(struct gz_minc_image *image)
{
	bool labels = false;
	enum gz_result result = take_minc_type(image, &labels);
	image->layout.labels = labels;
	if (result != GZ_OK || is_float_type(image->stored) || labels) {
		image->layout.type = image->stored;
		return result;
	}
	result = take_valid_range(image);
	if (result == GZ_OK)
		result = take_scales(image);
	if (result == GZ_OK)
		choose_minc_type(image);
	return result;
}

/* ---- chunks ---- */

/* Chunks that one slice crosses are kept, so that each is decompressed once. */
static void keep_chunks(struct gz_minc_image *image, hid_t properties)
{
	hsize_t edges[AXES_MAX];
	size_t bytes = gz_raw_type_size(image->stored), count = 1;
	if (H5Pget_chunk(properties, AXES_MAX, edges) != image->rank)
		return;
	for (int i = 0; i < image->rank; i++) {
		const hsize_t edge = edges[i] > 0 ? edges[i] : 1;
		const bool across = i == image->space[1] || i == image->space[2];
		const size_t chunks = across ? (image->axes[i].size + edge - 1) / edge : 1;
		if (edge > CHUNK_CACHE_MAX / bytes || chunks > CHUNK_CACHE_MAX / bytes / edge)
			return;
		bytes *= (size_t)edge * chunks;
		count *= chunks;
	}
	/* Slots of the cache's table: HDF5 asks for ten times the chunks or more. */
	if (count > CACHED_CHUNKS_MAX)
		return;
	(void)H5Pset_chunk_cache(image->access, 10 * count + 521, bytes + 1, 1);
}

static enum gz_result check_storage(struct gz_minc_image *image, hid_t properties)
{
	const int filters = H5Pget_nfilters(properties);
	const uint64_t stored = H5Dget_storage_size(image->voxels);
	if (filters < 0)
		return refuse_damaged_minc(image);
	if (!gz_hdf_has_filters(properties, filters))
		return refuse_minc(image, GZ_ERR_UNSUPPORTED,
				   "its voxels are compressed in a way that HDF5 does not know "
				   "here; repack it with: h5repack -f GZIP=4 FILE out.mnc");
	if (stored < image->bytes_bound)
		image->bytes_bound = stored;
	image->bytes_bound *= filters > 0 ? DEFLATE_RATIO : 1;
	/* Numbers may be wider in memory than in the file. */
	if (image->layout.type != image->stored)
		image->bytes_bound *= sizeof(float);
	if (H5Pget_layout(properties) == H5D_CHUNKED)
		keep_chunks(image, properties);
	return GZ_OK;
}

/* Look at how the voxels are stored, and open them again in a way that suits it. */
static enum gz_result take_storage(struct gz_minc_image *image)
{
	const hid_t properties = H5Dget_create_plist(image->voxels);
	const enum gz_result result =
		properties >= 0 ? check_storage(image, properties) : refuse_damaged_minc(image);
	if (properties >= 0)
		H5Pclose(properties);
	if (result != GZ_OK)
		return result;
	H5Dclose(image->voxels);
	image->voxels = open_part(image, "image");
	return image->voxels >= 0 ? GZ_OK : refuse_damaged_minc(image);
}

/* ---- opening and reading ---- */

static enum gz_result open_minc_image(struct gz_minc_image *image)
{
	enum gz_result result = open_minc_file(image);
	if (result != GZ_OK)
		return result;
	image->voxels = open_part(image, "image");
	if (image->voxels < 0)
		return refuse_minc(image, GZ_ERR_FORMAT,
				   "HDF5, but no MINC 2: it has no image in /minc-2.0/image/0");
	if (!gz_hdf_is_in_file(image->voxels))
		return refuse_minc(image, GZ_ERR_UNSUPPORTED,
				   "its voxels are in other files, which are not opened; repack it "
				   "with: h5repack FILE out.mnc");
	result = take_minc_axes(image);
	if (result == GZ_OK)
		result = take_minc_values(image);
	if (result == GZ_OK)
		result = take_storage(image);
	if (result == GZ_OK)
		lay_out_axes(image);
	return result;
}

enum gz_result gz_minc_image_open(const struct gz_volume_file *file,
				  struct gz_minc_image **out_image)
{
	struct gz_minc_image *image = calloc(1, sizeof *image);
	if (!image) {
		gz_err(file->log, "%s: no memory to read it", file->path);
		return GZ_ERR_NO_MEM;
	}
	image->file = file;
	image->hdf = image->access = image->voxels = GZ_HDF_NONE;
	image->layout = gz_import_layout_default();
	const enum gz_result result = open_minc_image(image);
	if (result != GZ_OK)
		gz_minc_image_close(&image);
	else
		*out_image = image;
	return result;
}

const struct gz_import_layout *gz_minc_image_layout(const struct gz_minc_image *image)
{
	return &image->layout;
}

uint64_t gz_minc_image_bytes_bound(const struct gz_minc_image *image)
{
	return image->bytes_bound;
}

/* Where a slice is in the file. */
struct minc_place {
	hsize_t time, slice;
};

/* Read a slice as the memory type. */
static bool read_numbers(const struct gz_minc_image *image, const struct minc_place *place,
			 void *out)
{
	hsize_t start[AXES_MAX] = { 0 }, count[AXES_MAX];
	for (int i = 0; i < image->rank; i++)
		count[i] = 1;
	if (image->time != NO_AXIS)
		start[image->time] = place->time;
	start[image->space[0]] = place->slice;
	for (int i = 1; i < 3; i++)
		count[image->space[i]] = image->axes[image->space[i]].size;
	const hid_t in_file = H5Dget_space(image->voxels);
	const hid_t in_memory = H5Screate_simple(image->rank, count, NULL);
	const bool read =
		in_file >= 0 && in_memory >= 0 &&
		H5Sselect_hyperslab(in_file, H5S_SELECT_SET, start, NULL, count, NULL) >= 0 &&
		H5Dread(image->voxels, image->memory_type, in_memory, in_file, H5P_DEFAULT, out) >=
			0;
	if (in_file >= 0)
		H5Sclose(in_file);
	if (in_memory >= 0)
		H5Sclose(in_memory);
	return read;
}

#define DEFINE_CLAMP(name, type)                                                     \
	static void name(type *numbers, size_t count, double least, double greatest) \
	{                                                                            \
		for (size_t i = 0; i < count; i++) {                                 \
			const double number = (double)numbers[i];                    \
			numbers[i] = number < least      ? (type)ceil(least)         \
				     : number > greatest ? (type)floor(greatest)     \
							 : numbers[i];               \
		}                                                                    \
	}

DEFINE_CLAMP(clamp_u8, uint8_t)
DEFINE_CLAMP(clamp_i8, int8_t)
DEFINE_CLAMP(clamp_u16, uint16_t)
DEFINE_CLAMP(clamp_i16, int16_t)
DEFINE_CLAMP(clamp_u32, uint32_t)
DEFINE_CLAMP(clamp_i32, int32_t)

/* Put numbers outside the valid range at its ends. */
static void clamp_numbers(const struct gz_minc_image *image, void *numbers, size_t count)
{
	const double least = image->within[0], greatest = image->within[1];
	switch (image->layout.type) {
	case GZ_RAW_UINT8:
		clamp_u8(numbers, count, least, greatest);
		break;
	case GZ_RAW_INT8:
		clamp_i8(numbers, count, least, greatest);
		break;
	case GZ_RAW_UINT16:
		clamp_u16(numbers, count, least, greatest);
		break;
	case GZ_RAW_INT16:
		clamp_i16(numbers, count, least, greatest);
		break;
	case GZ_RAW_UINT32:
		clamp_u32(numbers, count, least, greatest);
		break;
	case GZ_RAW_INT32:
		clamp_i32(numbers, count, least, greatest);
		break;
	default:
		break;
	}
}

/* Which scale a row has: they run along the first axes of the file. */
static size_t scale_of_row(const struct gz_minc_image *image, const struct minc_place *place,
			   size_t row)
{
	size_t scale = 0;
	for (int i = 0; i < image->scaled_axes; i++) {
		const size_t at = i == image->time       ? (size_t)place->time
				  : i == image->space[0] ? (size_t)place->slice
				  : i == image->space[1] ? row
							 : 0;
		scale = scale * image->axes[i].size + at;
	}
	return scale;
}

/* Slices whose scales differ are read as numbers and become values. */
static enum gz_result read_values(struct gz_minc_image *image, const struct minc_place *place,
				  float *out)
{
	const size_t width = (size_t)image->layout.dims[0], rows = (size_t)image->layout.dims[1];
	if (!image->numbers)
		image->numbers = malloc(rows * width * sizeof *image->numbers);
	if (!image->numbers)
		return refuse_no_memory(image);
	if (!read_numbers(image, place, image->numbers))
		return refuse_damaged_minc(image);
	for (size_t y = 0; y < rows; y++) {
		double slope, intercept;
		find_minc_scale(image, scale_of_row(image, place, y), &slope, &intercept);
		for (size_t i = y * width; i < (y + 1) * width; i++) {
			const double number =
				fmax(image->within[0], fmin(image->within[1], image->numbers[i]));
			out[i] = (float)(number * slope + intercept);
		}
	}
	return GZ_OK;
}

enum gz_result gz_minc_image_read(struct gz_minc_image *image, uint64_t index, void *numbers)
{
	const struct gz_import_layout *layout = &image->layout;
	const uint64_t slices = (uint64_t)layout->dims[2];
	const struct minc_place place = { .time = index / slices, .slice = index % slices };
	if (layout->type != image->stored)
		return read_values(image, &place, numbers);
	if (!read_numbers(image, &place, numbers))
		return refuse_damaged_minc(image);
	if (image->clamp)
		clamp_numbers(image, numbers, (size_t)layout->dims[0] * (size_t)layout->dims[1]);
	return GZ_OK;
}

void gz_minc_image_close(struct gz_minc_image **image_pointer)
{
	struct gz_minc_image *image = *image_pointer;
	if (!image)
		return;
	if (image->voxels >= 0)
		H5Dclose(image->voxels);
	if (image->access >= 0)
		H5Pclose(image->access);
	if (image->hdf >= 0)
		H5Fclose(image->hdf);
	free(image->least);
	free(image->greatest);
	free(image->numbers);
	free(image);
	*image_pointer = NULL;
}
