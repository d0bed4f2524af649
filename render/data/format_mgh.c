/* MGH and MGZ (gzip) of FreeSurfer, by its definition at
 * surfer.nmr.mgh.harvard.edu/fswiki/FsTutorial/MghFormat. All numbers are big-endian. Behind the
 * voxels may be scan parameters and tags, which are passed over. */
#include <math.h>

#include "base/file.h"
#include "base/text.h"
#include "render/data/format.h"

#define GZ_LOG_MODULE "volume"

#define HEADER_BYTES 284 /* where the voxels begin */
#define MGH_VERSION  1

/* Where the header has its numbers, bytes. */
enum {
	AT_VERSION = 0,
	AT_DIMS = 4, /* width, height, depth, frames */
	AT_FRAMES = 16,
	AT_TYPE = 20,
	AT_GOOD_RAS = 28,
	AT_SPACING = 30,
	AT_DIRECTIONS = 42, /* x_r x_a x_s, y_r …, z_r …: where each axis points in RAS+ */
};

/* mri.h of FreeSurfer, MRI_UCHAR to MRI_USHRT. The others are never written. */
static const struct {
	int code;
	enum gz_raw_type type;
} mgh_types[] = {
	{ 0, GZ_RAW_UINT8 }, { 1, GZ_RAW_INT32 },   { 3, GZ_RAW_FLOAT32 },
	{ 4, GZ_RAW_INT16 }, { 10, GZ_RAW_UINT16 },
};

struct mgh_file {
	const char *path;
	const struct gz_log *log;
	uint8_t bytes[HEADER_BYTES];
	struct gz_import_layout layout;
};

static int mgh_int(const uint8_t *bytes, size_t at)
{
	return (int)gz_file_number_at(bytes + at, GZ_FILE_I32, true);
}

static double mgh_real(const uint8_t *bytes, size_t at)
{
	return gz_file_number_at(bytes + at, GZ_FILE_F32, true);
}

static bool take_mgh_type(int code, enum gz_raw_type *out_type)
{
	for (size_t i = 0; i < sizeof mgh_types / sizeof mgh_types[0]; i++) {
		if (mgh_types[i].code == code) {
			*out_type = mgh_types[i].type;
			return true;
		}
	}
	return false;
}

/* There is no magic word but the version; the other numbers must make sense. */
static bool mgh_knows_start(const struct gz_file_start *start)
{
	enum gz_raw_type type;
	const uint8_t *bytes = start->bytes;
	if (start->size < HEADER_BYTES || mgh_int(bytes, AT_VERSION) != MGH_VERSION ||
	    !take_mgh_type(mgh_int(bytes, AT_TYPE), &type))
		return false;
	for (size_t i = 0; i < 4; i++) {
		const int size = mgh_int(bytes, AT_DIMS + 4 * i);
		if (size < 1 || (i < 3 && size > GZ_VOLUME_DIM_MAX))
			return false;
	}
	return (bytes[AT_GOOD_RAS] == 0 && bytes[AT_GOOD_RAS + 1] <= 1);
}

static enum gz_result take_mgh_size(struct mgh_file *file)
{
	const int frames = mgh_int(file->bytes, AT_FRAMES), code = mgh_int(file->bytes, AT_TYPE);
	for (size_t axis = 0; axis < 3; axis++)
		file->layout.dims[axis] = mgh_int(file->bytes, AT_DIMS + 4 * axis);
	if (frames < 1) {
		gz_err(file->log, "%s: %d frames; allowed: 1 or more", file->path, frames);
		return GZ_ERR_FORMAT;
	}
	if (!take_mgh_type(code, &file->layout.type)) {
		gz_err(file->log,
		       "%s: voxels of type %d are not read; convert them to uchar, short, int or "
		       "float with: mri_convert -odt float",
		       file->path, code);
		return GZ_ERR_UNSUPPORTED;
	}
	file->layout.time_points = frames;
	return GZ_OK;
}

/* Without a good RAS flag FreeSurfer takes coronal slices (mghRead() of mriio.cpp) and the format's
 * definition 1 mm: x to the left, y down, z to the front. */
static void take_mgh_orientation(struct mgh_file *file)
{
	static const double coronal[3][3] = { { -1, 0, 0 }, { 0, 0, -1 }, { 0, 1, 0 } };
	const bool good = gz_file_number_at(file->bytes + AT_GOOD_RAS, GZ_FILE_I16, true) > 0;
	for (size_t axis = 0; axis < 3; axis++) {
		for (size_t i = 0; i < 3; i++)
			file->layout.direction[axis][i] =
				good ? mgh_real(file->bytes, AT_DIRECTIONS + 4 * (3 * axis + i))
				     : coronal[axis][i];
		if (good)
			file->layout.spacing[axis] = mgh_real(file->bytes, AT_SPACING + 4 * axis);
	}
	file->layout.oriented = true;
	file->layout.spacing_assumed = !good;
	if (!good)
		gz_info(file->log,
			"%s: says nothing of its orientation; taken as coronal slices of 1 mm, as "
			"in "
			"FreeSurfer",
			file->path);
}

static enum gz_result read_mgh_header(struct mgh_file *file, struct gz_byte_stream *stream)
{
	size_t got = 0;
	enum gz_result result = gz_byte_stream_read(stream, file->bytes, sizeof file->bytes, &got);
	if (result != GZ_OK)
		return result;
	if (got < sizeof file->bytes) {
		gz_err(file->log, "%s: truncated: shorter than an MGH header; fetch it again",
		       file->path);
		return GZ_ERR_FORMAT;
	}
	if (mgh_int(file->bytes, AT_VERSION) != MGH_VERSION) {
		gz_err(file->log, "%s: no MGH header of version 1; is it really an MGH file?",
		       file->path);
		return GZ_ERR_FORMAT;
	}
	result = take_mgh_size(file);
	if (result == GZ_OK)
		take_mgh_orientation(file);
	return result;
}

static enum gz_result load_mgh(const struct gz_volume_file *file, struct gz_volume *out_volume)
{
	struct mgh_file mgh = { .path = file->path,
				.log = file->log,
				.layout = gz_import_layout_default() };
	struct gz_byte_stream *stream = NULL;
	mgh.layout.big_endian = true;
	mgh.layout.more_follows = true;
	enum gz_result result = gz_byte_stream_open(file->path, gz_coding_of_file(file->path), 0,
						    file->log, &stream);
	if (result == GZ_OK)
		result = read_mgh_header(&mgh, stream);
	if (result == GZ_OK)
		result = gz_volume_import(stream, &mgh.layout, file, out_volume);
	gz_byte_stream_close(&stream);
	return result;
}

const struct gz_volume_format gz_format_mgh = {
	.name = "MGH, MGZ",
	.endings = { ".mgh", ".mgz", ".mgh.gz" },
	.layout = GZ_LAYOUT_IN_FILE,
	.knows_start = mgh_knows_start,
	.load = load_mgh,
	.limits = "integers of 8, 16 and 32 bits and floats",
};
