/* NIfTI-1 and NIfTI-2, each in one file or in a pair of header and voxels, and ANALYZE 7.5, which
 * is such a pair. The formats are those of nifti1.h and nifti2.h, which the section names below
 * refer to. nifticlib turns quaternions into matrices; the voxels are streamed here, because its
 * own reader allocates and trusts what the header claims. */
#include <ctype.h>
#include <math.h>
#include <nifti1_io.h>
#include <nifti2.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/text.h"
#include "render/data/format.h"
#include "render/data/length_unit.h"
#include "render/data/voxel_source.h"

#define GZ_LOG_MODULE "volume"

/* Largest vox_offset read, bytes. Chosen: header extensions are never that long. */
#define OFFSET_MAX (1 << 30)

#define HEADER1_SIZE 348
#define HEADER2_SIZE 540
#define HEADER_MOST  HEADER2_SIZE

_Static_assert(sizeof(nifti_1_header) == HEADER1_SIZE, "nifti1.h describes the header's bytes");
_Static_assert(sizeof(nifti_2_header) == HEADER2_SIZE, "nifti2.h describes the header's bytes");

/* Numbers in a row in a header. */
struct nifti_field {
	size_t at; /* bytes from the header's beginning */
	enum gz_file_number type;
};

/* Where a version of the format has what is read of a header. */
struct nifti_version {
	size_t size;
	size_t magic_at;
	struct nifti_field dim, intent_code, datatype, bitpix, pixdim, vox_offset, slope, intercept,
		xyzt_units, qform_code, sform_code, quatern, srow;
};

#define FIELD1(member, type)                                     \
	{                                                        \
		offsetof(nifti_1_header, member), GZ_FILE_##type \
	}
#define FIELD2(member, type)                                     \
	{                                                        \
		offsetof(nifti_2_header, member), GZ_FILE_##type \
	}

static const struct nifti_version nifti1 = {
	.size = HEADER1_SIZE,
	.magic_at = offsetof(nifti_1_header, magic),
	.dim = FIELD1(dim, I16),
	.intent_code = FIELD1(intent_code, I16),
	.datatype = FIELD1(datatype, I16),
	.bitpix = FIELD1(bitpix, I16),
	.pixdim = FIELD1(pixdim, F32),
	.vox_offset = FIELD1(vox_offset, F32),
	.slope = FIELD1(scl_slope, F32),
	.intercept = FIELD1(scl_inter, F32),
	.xyzt_units = FIELD1(xyzt_units, U8),
	.qform_code = FIELD1(qform_code, I16),
	.sform_code = FIELD1(sform_code, I16),
	.quatern = FIELD1(quatern_b, F32),
	.srow = FIELD1(srow_x, F32),
};

static const struct nifti_version nifti2 = {
	.size = HEADER2_SIZE,
	.magic_at = offsetof(nifti_2_header, magic),
	.dim = FIELD2(dim, I64),
	.intent_code = FIELD2(intent_code, I32),
	.datatype = FIELD2(datatype, I16),
	.bitpix = FIELD2(bitpix, I16),
	.pixdim = FIELD2(pixdim, F64),
	.vox_offset = FIELD2(vox_offset, I64),
	.slope = FIELD2(scl_slope, F64),
	.intercept = FIELD2(scl_inter, F64),
	.xyzt_units = FIELD2(xyzt_units, I32),
	.qform_code = FIELD2(qform_code, I32),
	.sform_code = FIELD2(sform_code, I32),
	.quatern = FIELD2(quatern_b, F64),
	.srow = FIELD2(srow_x, F64),
};

/* A kind of file, by the magic word of its header. */
struct nifti_kind {
	const char *name;
	const struct nifti_version *version;
	const char *magic; /* NULL: none, the last kind */
	size_t magic_size;
	bool pair; /* the voxels are in a file of their own */
};

/* "MAGIC" in nifti1.h; nifti2.h has four bytes more, in which a wrong transfer would show. */
static const struct nifti_kind nifti_kinds[] = {
	{ "NIfTI-1", &nifti1, "n+1", 4, false },
	{ "NIfTI-1 pair", &nifti1, "ni1", 4, true },
	{ "NIfTI-2", &nifti2, "n+2\0\r\n\032\n", 8, false },
	{ "NIfTI-2 pair", &nifti2, "ni2\0\r\n\032\n", 8, true },
	{ "ANALYZE 7.5", &nifti1, NULL, 0, true },
};
enum { NIFTI_KINDS = sizeof nifti_kinds / sizeof nifti_kinds[0] };

/* The numbers of a header. */
struct nifti_head {
	double dim[8], pixdim[8];
	double intent_code, datatype, bitpix, vox_offset, slope, intercept, xyzt_units, qform_code,
		sform_code;
	double quatern[3];
	double srow[3][4];
};

struct nifti_file {
	const char *path; /* of the header, for messages */
	const struct gz_log *log;
	const struct nifti_kind *kind;
	struct nifti_head head;
	struct gz_import_layout layout;
	struct gz_voxel_source source;
};

/* ---- kinds of headers ---- */

static bool header_size_is(const uint8_t *bytes, size_t size, bool big_endian)
{
	return gz_file_number_at(bytes, GZ_FILE_I32, big_endian) == (double)size;
}

static void take_field(const uint8_t *bytes, const struct nifti_field *field, bool big_endian,
		       size_t count, double *out)
{
	const size_t size = gz_file_number_size(field->type);
	for (size_t i = 0; i < count; i++)
		out[i] = gz_file_number_at(bytes + field->at + i * size, field->type, big_endian);
}

static void take_nifti_head(const uint8_t *bytes, const struct nifti_version *version,
			    bool big_endian, struct nifti_head *out)
{
	take_field(bytes, &version->dim, big_endian, 8, out->dim);
	take_field(bytes, &version->intent_code, big_endian, 1, &out->intent_code);
	take_field(bytes, &version->datatype, big_endian, 1, &out->datatype);
	take_field(bytes, &version->bitpix, big_endian, 1, &out->bitpix);
	take_field(bytes, &version->pixdim, big_endian, 8, out->pixdim);
	take_field(bytes, &version->vox_offset, big_endian, 1, &out->vox_offset);
	take_field(bytes, &version->slope, big_endian, 1, &out->slope);
	take_field(bytes, &version->intercept, big_endian, 1, &out->intercept);
	take_field(bytes, &version->xyzt_units, big_endian, 1, &out->xyzt_units);
	take_field(bytes, &version->qform_code, big_endian, 1, &out->qform_code);
	take_field(bytes, &version->sform_code, big_endian, 1, &out->sform_code);
	take_field(bytes, &version->quatern, big_endian, 3, out->quatern);
	take_field(bytes, &version->srow, big_endian, 12, out->srow[0]);
}

/* Without a magic word the numbers must make sense. */
static bool is_analyze_head(const uint8_t *bytes, bool big_endian)
{
	struct nifti_head head;
	int bytes_per_voxel, swap_size;
	take_nifti_head(bytes, &nifti1, big_endian, &head);
	nifti_datatype_sizes((int)head.datatype, &bytes_per_voxel, &swap_size);
	return head.dim[0] >= 1 && head.dim[0] <= 7 && head.dim[1] >= 1 && bytes_per_voxel > 0 &&
	       head.bitpix == 8 * bytes_per_voxel;
}

/* NULL if the bytes begin no header. */
static const struct nifti_kind *nifti_kind_of(const uint8_t *bytes, size_t size,
					      bool *out_big_endian)
{
	for (int i = 0; i < 2 * NIFTI_KINDS; i++) {
		const struct nifti_kind *kind = &nifti_kinds[i / 2];
		const bool big_endian = i % 2 == 1;
		const struct nifti_version *version = kind->version;
		if (size < version->size || !header_size_is(bytes, version->size, big_endian))
			continue;
		const bool fits = kind->magic ? memcmp(bytes + version->magic_at, kind->magic,
						       kind->magic_size) == 0
					      : is_analyze_head(bytes, big_endian);
		if (!fits)
			continue;
		*out_big_endian = big_endian;
		return kind;
	}
	return NULL;
}

static bool nifti_knows_start(const struct gz_file_start *start)
{
	bool big_endian;
	return nifti_kind_of(start->bytes, start->size, &big_endian) != NULL;
}

static const char *nifti_name_start(const struct gz_file_start *start)
{
	bool big_endian;
	return nifti_kind_of(start->bytes, start->size, &big_endian)->name;
}

/* ---- pairs ---- */

/* Endings of compressed files, in the order of enum gz_coding. */
static const char *const pair_codings[] = { "", ".gz", ".zst", ".bz2" };
enum { PAIR_CODINGS = sizeof pair_codings / sizeof pair_codings[0] };

/* Where the ending `ending`, with a dot, begins in a name that may have a coding's ending behind
 * it. Returns the coding, or -1 if the name has another ending. */
static int find_pair_ending(const char *path, const char *ending, size_t *out_at)
{
	for (int i = 0; i < PAIR_CODINGS; i++) {
		char whole[16];
		(void)gz_text_print(whole, sizeof whole, "%s%s", ending, pair_codings[i]);
		if (!gz_path_ends(path, whole))
			continue;
		*out_at = strlen(path) - strlen(whole);
		return i;
	}
	return -1;
}

/* The other file of a pair: of a name that ends in `from` the one that ends in `to`, in capitals if
 * that is, compressed or not, whichever there is. GZ_ERR_INVAL: the name ends in something else. */
static enum gz_result find_pair_file(const char *path, const char *from, const char *to,
				     char out_path[GZ_PATH_SIZE])
{
	size_t at;
	char ending[8];
	const int coding = find_pair_ending(path, from, &at);
	if (coding < 0 || strlen(path) >= GZ_PATH_SIZE)
		return GZ_ERR_INVAL;
	const bool capitals = isupper((unsigned char)path[at + 1]) != 0;
	for (size_t i = 0; i <= strlen(to); i++)
		ending[i] = (char)(capitals ? toupper((unsigned char)to[i]) : to[i]);
	for (int i = 0; i < PAIR_CODINGS; i++) {
		const char *compressed = pair_codings[(coding + i) % PAIR_CODINGS];
		if (gz_text_print(out_path, GZ_PATH_SIZE, "%.*s%s%s", (int)at, path, ending,
				  compressed) == GZ_OK &&
		    access(out_path, F_OK) == 0)
			return GZ_OK;
	}
	/* Not there: the message about it names the likeliest. */
	return gz_text_print(out_path, GZ_PATH_SIZE, "%.*s%s%s", (int)at, path, ending,
			     pair_codings[coding]);
}

/* The voxels of a pair, by the header beside them. */
static bool is_nifti_image(const char *path)
{
	char header[GZ_PATH_SIZE];
	struct gz_file_start start;
	return find_pair_file(path, ".img", ".hdr", header) == GZ_OK && access(path, F_OK) == 0 &&
	       gz_file_start_read(header, &start) && nifti_knows_start(&start);
}

/* ---- numbers of the header ---- */

static enum gz_result take_nifti_dims(struct nifti_file *file)
{
	const double *dim = file->head.dim;
	const double least = file->kind->magic ? 1 : 0; /* ANALYZE: 0 is none */
	if (!(dim[0] >= 3 && dim[0] <= 7)) {
		gz_err(file->log, "%s: %g dimensions; a volume has 3 (NIfTI allows 7)", file->path,
		       dim[0]);
		return GZ_ERR_FORMAT;
	}
	for (int i = 1; i <= (int)dim[0]; i++) {
		if (dim[i] < (i > 3 ? least : 1) || (i <= 3 && dim[i] > GZ_VOLUME_DIM_MAX)) {
			gz_err(file->log, "%s: %g voxels along axis %d; allowed: 1 to %d",
			       file->path, dim[i], i, GZ_VOLUME_DIM_MAX);
			return GZ_ERR_FORMAT;
		}
		if (i <= 3)
			file->layout.dims[i - 1] = (int)dim[i];
		else if (i == 4)
			file->layout.time_points =
				(int)fmin(dim[i], (double)GZ_TIME_POINTS_MAX + 1);
		else if (dim[i] > 1)
			file->layout.more_follows = true;
	}
	if (file->layout.more_follows)
		gz_warn(file->log, "%s: has a fifth dimension; only its first part is shown",
			file->path);
	return GZ_OK;
}

static enum gz_result take_nifti_type(struct nifti_file *file)
{
	static const struct {
		int code;
		enum gz_raw_type type;
		int channels;
	} types[] = {
		{ DT_UINT8, GZ_RAW_UINT8, 1 },     { DT_INT8, GZ_RAW_INT8, 1 },
		{ DT_UINT16, GZ_RAW_UINT16, 1 },   { DT_INT16, GZ_RAW_INT16, 1 },
		{ DT_UINT32, GZ_RAW_UINT32, 1 },   { DT_INT32, GZ_RAW_INT32, 1 },
		{ DT_FLOAT32, GZ_RAW_FLOAT32, 1 }, { DT_FLOAT64, GZ_RAW_FLOAT64, 1 },
		{ DT_RGB24, GZ_RAW_UINT8, 3 },     { DT_RGBA32, GZ_RAW_UINT8, 4 },
	};
	const int code = (int)file->head.datatype;
	for (size_t i = 0; i < sizeof types / sizeof types[0]; i++) {
		if (types[i].code == code) {
			file->layout.type = types[i].type;
			file->layout.channels = types[i].channels;
			return GZ_OK;
		}
	}
	gz_err(file->log,
	       "%s: voxels of type %s are not read; convert them to integers of 32 bits or float",
	       file->path, nifti_datatype_string(code));
	return GZ_ERR_UNSUPPORTED;
}

/* "DATA SCALING": a slope of 0 means none. Some writers mean the same by NaN. ANALYZE has the slope
 * in the same place if SPM wrote it, and no intercept. */
static void take_nifti_scaling(struct nifti_file *file)
{
	const double slope = file->head.slope;
	const double intercept = file->kind->magic ? file->head.intercept : 0;
	if (slope == 0 || !isfinite(slope) || !isfinite(intercept))
		return;
	file->layout.slope = slope;
	file->layout.intercept = intercept;
}

/* Columns of the matrix are where the axes point, in RAS+; their lengths are the spacing. */
static void take_nifti_sform(struct nifti_file *file)
{
	for (int axis = 0; axis < 3; axis++) {
		double length = 0;
		for (int i = 0; i < 3; i++) {
			const double component = file->head.srow[i][axis];
			file->layout.direction[axis][i] = component;
			length += component * component;
		}
		file->layout.spacing[axis] = sqrt(length);
	}
}

static void take_nifti_qform(struct nifti_file *file)
{
	const double *q = file->head.quatern;
	const float qfac = file->head.pixdim[0] < 0 ? -1.0f : 1.0f;
	const mat44 m = nifti_quatern_to_mat44((float)q[0], (float)q[1], (float)q[2], 0, 0, 0, 1, 1,
					       1, qfac);
	for (int axis = 0; axis < 3; axis++)
		for (int i = 0; i < 3; i++)
			file->layout.direction[axis][i] = (double)m.m[i][axis];
}

/* ANALYZE has no agreed orientation. SPM, FSL and nibabel store the left side last: x to the left,
 * y to the front, z up. */
static void guess_analyze_orientation(struct nifti_file *file)
{
	file->layout.direction[0][0] = -1;
	for (int axis = 0; axis < 3; axis++) {
		const double spacing = fabs(file->layout.spacing[axis]);
		file->layout.spacing[axis] = spacing > 0 ? spacing : 1;
		file->layout.spacing_assumed = file->layout.spacing_assumed || !(spacing > 0);
	}
	gz_warn(file->log,
		"%s: an ANALYZE header does not say where left is; x is taken to run to the left, "
		"as SPM stores it",
		file->path);
}

/* "3D IMAGE (VOLUME) ORIENTATION AND LOCATION IN SPACE": method 3 before 2; method 1 tells no
 * orientation. */
static void take_nifti_orientation(struct nifti_file *file)
{
	for (int axis = 0; axis < 3; axis++)
		file->layout.spacing[axis] = file->head.pixdim[axis + 1];
	if (!file->kind->magic) {
		guess_analyze_orientation(file);
		return;
	}
	file->layout.oriented = true;
	if (file->head.sform_code > 0)
		take_nifti_sform(file);
	else if (file->head.qform_code > 0)
		take_nifti_qform(file);
	else
		file->layout.oriented = false;
}

/* "UNITS OF SPATIAL AND TEMPORAL DIMENSIONS". ANALYZE has the beginning of a text there. */
static void take_nifti_units(struct nifti_file *file)
{
	static const char *const names[] = { [NIFTI_UNITS_UNKNOWN] = "",
					     [NIFTI_UNITS_METER] = "m",
					     [NIFTI_UNITS_MM] = "mm",
					     [NIFTI_UNITS_MICRON] = "um" };
	enum { KNOWN = sizeof names / sizeof names[0] };
	const int code = XYZT_TO_SPACE((int)file->head.xyzt_units);
	char number[16];
	if (!file->kind->magic)
		return;
	(void)gz_text_print(number, sizeof number, "code %d", code);
	const double mm =
		gz_length_unit_take(code < KNOWN ? names[code] : number, file->path, file->log);
	for (int axis = 0; axis < 3; axis++)
		file->layout.spacing[axis] *= mm;
}

static enum gz_result take_nifti_offset(struct nifti_file *file)
{
	const double offset = file->head.vox_offset;
	const size_t least = file->kind->pair ? 0 : file->kind->version->size;
	if (!(offset >= (double)least && offset <= OFFSET_MAX) || offset != floor(offset)) {
		gz_err(file->log, "%s: voxels at byte %g; allowed: %zu to %d", file->path, offset,
		       least, OFFSET_MAX);
		return GZ_ERR_FORMAT;
	}
	file->source.skip = (int64_t)offset;
	return GZ_OK;
}

/* ---- loading ---- */

static enum gz_result refuse_nifti(const struct nifti_file *file, const char *what)
{
	gz_err(file->log, "%s: %s", file->path, what);
	return GZ_ERR_FORMAT;
}

static enum gz_result take_nifti_numbers(struct nifti_file *file, const uint8_t *bytes)
{
	take_nifti_head(bytes, file->kind->version, file->layout.big_endian, &file->head);
	enum gz_result result = take_nifti_dims(file);
	if (result == GZ_OK)
		result = take_nifti_type(file);
	if (result == GZ_OK)
		result = take_nifti_offset(file);
	if (result == GZ_OK) {
		take_nifti_scaling(file);
		take_nifti_orientation(file);
		take_nifti_units(file);
		/* ANALYZE has other fields there. */
		file->layout.labels =
			file->kind->magic && (int)file->head.intent_code == NIFTI_INTENT_LABEL;
	}
	return result;
}

static enum gz_result find_nifti_kind(struct nifti_file *file, const uint8_t *bytes, size_t size)
{
	bool big_endian = false;
	file->kind = nifti_kind_of(bytes, size, &big_endian);
	file->layout.big_endian = big_endian;
	if (file->kind)
		return GZ_OK;
	if (size < HEADER1_SIZE ||
	    (size < HEADER2_SIZE && (header_size_is(bytes, HEADER2_SIZE, false) ||
				     header_size_is(bytes, HEADER2_SIZE, true))))
		return refuse_nifti(file, "truncated: shorter than a NIfTI header; fetch it again");
	if (header_size_is(bytes, HEADER1_SIZE, false) || header_size_is(bytes, HEADER1_SIZE, true))
		return refuse_nifti(file, "no NIfTI magic word, and no ANALYZE header either");
	return refuse_nifti(file, "no NIfTI header; is it really a NIfTI file?");
}

/* Voxels of a pair may begin with anything: their coding is by the name. */
static enum gz_result find_nifti_voxels(struct nifti_file *file)
{
	char *path = file->source.path;
	size_t at;
	if (!file->kind->pair) {
		file->source.coding = gz_coding_of_file(file->path);
		return gz_text_print(path, GZ_PATH_SIZE, "%s", file->path);
	}
	if (find_pair_file(file->path, ".hdr", ".img", path) != GZ_OK)
		return refuse_nifti(file, "the header of a pair; name it .hdr, beside its .img");
	const int coding = find_pair_ending(path, ".img", &at);
	file->source.coding = coding > 0 ? (enum gz_coding)coding : GZ_CODING_PLAIN;
	return GZ_OK;
}

static enum gz_result read_nifti_header(struct nifti_file *file)
{
	struct gz_byte_stream *stream = NULL;
	uint8_t bytes[HEADER_MOST];
	size_t size = 0;
	enum gz_result result = gz_byte_stream_open(file->path, gz_coding_of_file(file->path), 0,
						    file->log, &stream);
	if (result == GZ_OK)
		result = gz_byte_stream_read(stream, bytes, sizeof bytes, &size);
	gz_byte_stream_close(&stream);
	if (result == GZ_OK)
		result = find_nifti_kind(file, bytes, size);
	if (result == GZ_OK)
		result = take_nifti_numbers(file, bytes);
	return result == GZ_OK ? find_nifti_voxels(file) : result;
}

static enum gz_result load_nifti(const struct gz_volume_file *file, struct gz_volume *out_volume)
{
	char header[GZ_PATH_SIZE];
	struct nifti_file nifti = { .path = file->path,
				    .log = file->log,
				    .layout = gz_import_layout_default() };
	if (is_nifti_image(file->path) &&
	    find_pair_file(file->path, ".img", ".hdr", header) == GZ_OK)
		nifti.path = header;
	enum gz_result result = read_nifti_header(&nifti);
	if (result != GZ_OK)
		return result;
	return gz_voxel_source_import(&nifti.source, &nifti.layout, file, out_volume);
}

const struct gz_volume_format gz_format_nifti = {
	.name = "NIfTI, ANALYZE",
	.endings = { ".nii", ".nii.gz", ".nii.zst", ".nii.bz2", ".hdr", ".hdr.gz", ".hdr.zst",
		     ".hdr.bz2" },
	.layout = GZ_LAYOUT_IN_FILE,
	.knows_start = nifti_knows_start,
	.name_start = nifti_name_start,
	.recognise = is_nifti_image,
	.load = load_nifti,
	.limits = "one number a voxel, integers of up to 32 bits, or RGB24 and RGBA32; of a fifth "
		  "dimension only the first; .img by its .hdr",
};
