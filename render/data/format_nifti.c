/* NIfTI-1 in one file. nifticlib swaps the header and turns quaternions into matrices; the voxels
 * are streamed here, because its own reader allocates and trusts what the header claims. The format
 * is that of nifti1.h, which the section names below refer to. */
#include <math.h>
#include <nifti1_io.h>
#include <string.h>

#include "base/file.h"
#include "render/data/format.h"

#define GZ_LOG_MODULE "volume"

#define HEADER_SIZE  348
#define HEADER2_SIZE 540 /* NIfTI-2 */
/* Largest vox_offset read, bytes. Chosen: header extensions are never that long. */
#define OFFSET_MAX (1 << 30)

_Static_assert(sizeof(nifti_1_header) == HEADER_SIZE, "nifti1.h describes the header's bytes");

struct nifti_file {
	const char *path;
	const struct gz_log *log;
	nifti_1_header header;
	struct gz_import_layout layout;
};

static enum gz_result refuse_nifti(const struct nifti_file *file, enum gz_result result,
				   const char *what)
{
	gz_err(file->log, "%s: %s", file->path, what);
	return result;
}

static int32_t nifti_header_size(const nifti_1_header *header, bool swapped)
{
	uint32_t size = (uint32_t)header->sizeof_hdr;
	return (int32_t)(swapped ? __builtin_bswap32(size) : size);
}

/* Byte order by sizeof_hdr, then the magic word ("MAGIC"). */
static enum gz_result check_nifti_kind(struct nifti_file *file)
{
	nifti_1_header *header = &file->header;
	bool swapped = nifti_header_size(header, false) != HEADER_SIZE;
	if (nifti_header_size(header, false) == HEADER2_SIZE ||
	    nifti_header_size(header, true) == HEADER2_SIZE)
		return refuse_nifti(file, GZ_ERR_UNSUPPORTED,
				    "NIfTI-2 is not read; convert it to NIfTI-1");
	if (nifti_header_size(header, swapped) != HEADER_SIZE)
		return refuse_nifti(file, GZ_ERR_FORMAT,
				    "no NIfTI header; is it really a .nii file?");
	if (memcmp(header->magic, "ni1", 4) == 0)
		return refuse_nifti(
			file, GZ_ERR_UNSUPPORTED,
			"header and data in two files are not read; convert it to one .nii");
	if (memcmp(header->magic, "n+1", 4) != 0)
		return refuse_nifti(file, GZ_ERR_FORMAT,
				    "no NIfTI magic word; is it an Analyze file?");
	if (swapped)
		swap_nifti_header(header, 1);
	file->layout.big_endian = gz_host_big_endian() != swapped;
	return GZ_OK;
}

static enum gz_result take_nifti_dims(struct nifti_file *file)
{
	const short *dim = file->header.dim;
	if (dim[0] < 3 || dim[0] > 7) {
		gz_err(file->log, "%s: %d dimensions; a volume has 3 (NIfTI allows 7)", file->path,
		       dim[0]);
		return GZ_ERR_FORMAT;
	}
	for (int axis = 0; axis < 3; axis++)
		file->layout.dims[axis] = dim[axis + 1];
	long others = 1;
	for (int i = 4; i <= dim[0]; i++) {
		if (dim[i] < 1) {
			gz_err(file->log, "%s: %d voxels along axis %d; allowed: 1 to 32767",
			       file->path, dim[i], i);
			return GZ_ERR_FORMAT;
		}
		others = dim[i] > 1 ? 2 : others;
	}
	if (others > 1) {
		file->layout.more_follows = true;
		gz_warn(file->log, "%s: a series of volumes; the first is shown", file->path);
	}
	return GZ_OK;
}

static enum gz_result take_nifti_type(struct nifti_file *file)
{
	static const struct {
		short code;
		enum gz_raw_type type;
	} types[] = {
		{ DT_UINT8, GZ_RAW_UINT8 },     { DT_INT8, GZ_RAW_INT8 },
		{ DT_UINT16, GZ_RAW_UINT16 },   { DT_INT16, GZ_RAW_INT16 },
		{ DT_UINT32, GZ_RAW_UINT32 },   { DT_INT32, GZ_RAW_INT32 },
		{ DT_FLOAT32, GZ_RAW_FLOAT32 }, { DT_FLOAT64, GZ_RAW_FLOAT64 },
	};
	for (size_t i = 0; i < sizeof types / sizeof types[0]; i++) {
		if (types[i].code == file->header.datatype) {
			file->layout.type = types[i].type;
			return GZ_OK;
		}
	}
	gz_err(file->log,
	       "%s: voxels of type %s are not read; convert them to integers of 32 bits or float",
	       file->path, nifti_datatype_string(file->header.datatype));
	return GZ_ERR_UNSUPPORTED;
}

/* "DATA SCALING": a slope of 0 means none. Some writers mean the same by NaN. */
static void take_nifti_scaling(struct nifti_file *file)
{
	float slope = file->header.scl_slope, intercept = file->header.scl_inter;
	if (slope == 0 || !isfinite(slope) || !isfinite(intercept))
		return;
	file->layout.slope = (double)slope;
	file->layout.intercept = (double)intercept;
}

/* Columns of the matrix are where the axes point, in RAS+; their lengths are the spacing. */
static void take_nifti_sform(struct nifti_file *file)
{
	const float *rows[3] = { file->header.srow_x, file->header.srow_y, file->header.srow_z };
	for (int axis = 0; axis < 3; axis++) {
		double length = 0;
		for (int i = 0; i < 3; i++) {
			double component = (double)rows[i][axis];
			file->layout.direction[axis][i] = component;
			length += component * component;
		}
		file->layout.spacing[axis] = sqrt(length);
	}
}

static void take_nifti_qform(struct nifti_file *file)
{
	const nifti_1_header *h = &file->header;
	float qfac = h->pixdim[0] < 0 ? -1.0f : 1.0f;
	mat44 m = nifti_quatern_to_mat44(h->quatern_b, h->quatern_c, h->quatern_d, 0, 0, 0, 1, 1, 1,
					 qfac);
	for (int axis = 0; axis < 3; axis++)
		for (int i = 0; i < 3; i++)
			file->layout.direction[axis][i] = (double)m.m[i][axis];
}

/* "3D IMAGE (VOLUME) ORIENTATION AND LOCATION IN SPACE": method 3 before 2; method 1 tells no
 * orientation. */
static void take_nifti_orientation(struct nifti_file *file)
{
	for (int axis = 0; axis < 3; axis++)
		file->layout.spacing[axis] = (double)file->header.pixdim[axis + 1];
	file->layout.oriented = true;
	if (file->header.sform_code > 0)
		take_nifti_sform(file);
	else if (file->header.qform_code > 0)
		take_nifti_qform(file);
	else
		file->layout.oriented = false;
}

static enum gz_result take_nifti_offset(struct nifti_file *file, uint64_t *out_offset)
{
	float offset = file->header.vox_offset;
	if (!(offset >= HEADER_SIZE && offset <= OFFSET_MAX) || offset != floorf(offset)) {
		gz_err(file->log, "%s: voxels at byte %g; allowed: %d to %d", file->path,
		       (double)offset, HEADER_SIZE, OFFSET_MAX);
		return GZ_ERR_FORMAT;
	}
	*out_offset = (uint64_t)offset;
	return GZ_OK;
}

static enum gz_result read_nifti_header(struct nifti_file *file, struct gz_byte_stream *stream,
					uint64_t *out_offset)
{
	size_t got = 0;
	enum gz_result result =
		gz_byte_stream_read(stream, &file->header, sizeof file->header, &got);
	if (result == GZ_OK && got < sizeof file->header)
		result = refuse_nifti(file, GZ_ERR_FORMAT,
				      "truncated: shorter than a NIfTI header; fetch it again");
	if (result == GZ_OK)
		result = check_nifti_kind(file);
	if (result == GZ_OK)
		result = take_nifti_dims(file);
	if (result == GZ_OK)
		result = take_nifti_type(file);
	if (result == GZ_OK)
		result = take_nifti_offset(file, out_offset);
	if (result == GZ_OK) {
		take_nifti_scaling(file);
		take_nifti_orientation(file);
	}
	return result;
}

static enum gz_result load_nifti(const struct gz_volume_file *file, struct gz_volume *out_volume)
{
	struct nifti_file nifti = { .path = file->path,
				    .log = file->log,
				    .layout = gz_import_layout_default() };
	enum gz_coding coding = gz_path_ends(file->path, ".gz") ? GZ_CODING_ZLIB : GZ_CODING_PLAIN;
	struct gz_byte_stream *stream = NULL;
	uint64_t offset = 0;
	enum gz_result result = gz_byte_stream_open(file->path, coding, 0, file->log, &stream);
	if (result == GZ_OK)
		result = read_nifti_header(&nifti, stream, &offset);
	if (result == GZ_OK)
		result = gz_byte_stream_skip(stream, offset - HEADER_SIZE);
	if (result == GZ_OK)
		result = gz_volume_import(stream, &nifti.layout, file, out_volume);
	gz_byte_stream_close(&stream);
	return result;
}

const struct gz_volume_format gz_format_nifti = {
	.name = "NIfTI-1",
	.endings = { ".nii", ".nii.gz" },
	.layout = GZ_LAYOUT_IN_FILE,
	.load = load_nifti,
	.limits =
		"no NIfTI-2, no header and data in two files, one number a voxel, integers of up to"
		" 32 bits; of a series the first volume",
};
