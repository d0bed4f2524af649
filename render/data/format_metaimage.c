/* MetaImage (.mha, .mhd): the tags of itk.org/Wiki/MetaIO/Documentation. Its coordinates are LPS,
 * as ITK takes them. MetaIO itself is C++, comes with ITK or VTK only and reads whole arrays. */
#include <ctype.h>
#include <math.h>
#include <string.h>
#include <strings.h>

#include "base/file.h"
#include "render/data/format.h"
#include "render/data/text_head.h"
#include "render/data/voxel_source.h"

#define GZ_LOG_MODULE "volume"

#define AXES_MAX 10 /* of MetaIO */

struct metaimage {
	struct gz_text_head head;
	struct gz_import_layout layout;
	struct gz_voxel_source source;
	int dimension; /* 0 = not given yet */
	int sizes[AXES_MAX];
	bool has_sizes, has_type, has_spacing, has_size, has_matrix, has_data;
	char anatomical[4]; /* "RAI", or empty */
	int header_size;
	int file_axes; /* that each of several files holds; 0: not given */
};

static enum gz_result refuse_meta(struct metaimage *meta, const char *tag, const char *what)
{
	return gz_text_head_refuse(&meta->head, tag, what);
}

static enum gz_result refuse_meta_unsupported(struct metaimage *meta, const char *tag,
					      const char *what)
{
	(void)gz_text_head_refuse(&meta->head, tag, what);
	return GZ_ERR_UNSUPPORTED;
}

static enum gz_result take_meta_dimension(struct metaimage *meta, char *value)
{
	if (!gz_text_wholes(value, &meta->dimension, 1) || meta->dimension < 1 ||
	    meta->dimension > AXES_MAX) {
		meta->dimension = 0;
		return refuse_meta(meta, "NDims", "must be a number from 1 to 10");
	}
	if (meta->dimension < 3)
		return refuse_meta_unsupported(meta, "NDims", "less than 3: this is not a volume");
	return GZ_OK;
}

static enum gz_result take_meta_sizes(struct metaimage *meta, char *value)
{
	if (!gz_text_wholes(value, meta->sizes, meta->dimension))
		return refuse_meta(meta, "DimSize", "write one whole number an axis");
	meta->has_sizes = true;
	return GZ_OK;
}

static enum gz_result take_meta_spacing(struct metaimage *meta, char *value)
{
	double spacing[AXES_MAX];
	if (!gz_text_numbers(value, spacing, meta->dimension))
		return refuse_meta(meta, "ElementSpacing", "write one number an axis");
	memcpy(meta->layout.spacing, spacing, sizeof meta->layout.spacing);
	meta->has_spacing = true;
	return GZ_OK;
}

/* The size of an element stands in for a spacing that is not given. */
static enum gz_result take_meta_size(struct metaimage *meta, char *value)
{
	double spacing[AXES_MAX];
	if (!gz_text_numbers(value, spacing, meta->dimension))
		return refuse_meta(meta, "ElementSize", "write one number an axis");
	if (!meta->has_spacing)
		memcpy(meta->layout.spacing, spacing, sizeof meta->layout.spacing);
	meta->has_size = true;
	return GZ_OK;
}

/* Each row is where one axis points. */
static enum gz_result take_meta_matrix(struct metaimage *meta, char *value)
{
	static const double to_ras[3] = { -1, -1, 1 };
	double matrix[AXES_MAX * AXES_MAX];
	if (!gz_text_numbers(value, matrix, meta->dimension * meta->dimension))
		return refuse_meta(meta, "TransformMatrix",
				   "write one number an axis and direction");
	for (int axis = 0; axis < 3; axis++)
		for (int i = 0; i < 3; i++)
			meta->layout.direction[axis][i] =
				to_ras[i] * matrix[axis * meta->dimension + i];
	meta->has_matrix = true;
	return GZ_OK;
}

static enum gz_result take_meta_anatomical(struct metaimage *meta, char *value)
{
	meta->anatomical[0] = '\0';
	if (strlen(value) >= 3 && !strchr(value, '?')) {
		memcpy(meta->anatomical, value, 3);
		meta->anatomical[3] = '\0';
	}
	return GZ_OK;
}

static enum gz_result take_meta_type(struct metaimage *meta, char *value)
{
	static const struct {
		const char *name;
		enum gz_raw_type type;
	} types[] = {
		{ "MET_UCHAR", GZ_RAW_UINT8 },   { "MET_CHAR", GZ_RAW_INT8 },
		{ "MET_USHORT", GZ_RAW_UINT16 }, { "MET_SHORT", GZ_RAW_INT16 },
		{ "MET_UINT", GZ_RAW_UINT32 },   { "MET_INT", GZ_RAW_INT32 },
		{ "MET_ULONG", GZ_RAW_UINT32 },  { "MET_LONG", GZ_RAW_INT32 },
		{ "MET_FLOAT", GZ_RAW_FLOAT32 }, { "MET_DOUBLE", GZ_RAW_FLOAT64 },
	};
	for (size_t i = 0; i < sizeof types / sizeof types[0]; i++) {
		if (strcasecmp(value, types[i].name) == 0) {
			meta->layout.type = types[i].type;
			meta->has_type = true;
			return GZ_OK;
		}
	}
	return refuse_meta_unsupported(
		meta, "ElementType",
		"not read; MET_UCHAR to MET_INT, MET_FLOAT and MET_DOUBLE are");
}

static bool parse_meta_bool(const char *value, bool *out)
{
	*out = strcasecmp(value, "true") == 0 || strcmp(value, "1") == 0;
	return *out || strcasecmp(value, "false") == 0 || strcmp(value, "0") == 0;
}

static enum gz_result take_meta_big_endian(struct metaimage *meta, char *value)
{
	if (!parse_meta_bool(value, &meta->layout.big_endian))
		return refuse_meta(meta, "ElementByteOrderMSB", "write True or False");
	return GZ_OK;
}

static enum gz_result take_meta_binary(struct metaimage *meta, char *value)
{
	bool binary = true;
	if (!parse_meta_bool(value, &binary))
		return refuse_meta(meta, "BinaryData", "write True or False");
	meta->source.spelling = binary ? GZ_SPELLING_BINARY : GZ_SPELLING_TEXT;
	return GZ_OK;
}

static enum gz_result take_meta_compressed(struct metaimage *meta, char *value)
{
	bool compressed = false;
	if (!parse_meta_bool(value, &compressed))
		return refuse_meta(meta, "CompressedData", "write True or False");
	meta->source.coding = compressed ? GZ_CODING_ZLIB : GZ_CODING_PLAIN;
	return GZ_OK;
}

static enum gz_result take_meta_channels(struct metaimage *meta, char *value)
{
	int channels = 0;
	if (!gz_text_wholes(value, &channels, 1) ||
	    (channels != 1 && channels != 3 && channels != 4))
		return refuse_meta_unsupported(meta, "ElementNumberOfChannels",
					       "one number a voxel is read, and 3 or 4 as a "
					       "colour");
	meta->layout.channels = channels;
	return GZ_OK;
}

static enum gz_result take_meta_header_size(struct metaimage *meta, char *value)
{
	if (!gz_text_wholes(value, &meta->header_size, 1) || meta->header_size < GZ_SKIP_TO_END)
		return refuse_meta(meta, "HeaderSize", "must be a whole number, -1 or more");
	return GZ_OK;
}

/* The last tag. LOCAL data, or the names of several files, begin on the next line. */
static enum gz_result take_meta_data_file(struct metaimage *meta, char *value)
{
	const bool local = strcasecmp(value, "LOCAL") == 0;
	const bool several = !local && gz_voxel_files_named(value);
	const char *name = local || several ? meta->head.path : value;
	meta->has_data = true;
	if (!*value || gz_path_beside(local || several ? "" : meta->head.path, name,
				      meta->source.path, sizeof meta->source.path) != GZ_OK)
		return refuse_meta(meta, "ElementDataFile", "no name, or one too long");
	meta->source.offset = local ? meta->head.at : 0;
	return several ? gz_voxel_files_take(&meta->source.files, &meta->head, value,
					     "ElementDataFile", &meta->file_axes)
		       : GZ_OK;
}

struct tag {
	const char *name;
	bool needs_dimension;
	enum gz_result (*take)(struct metaimage *meta, char *value);
};

/* Tags that say nothing of layout (Offset, Modality, Comment, …) are passed over. */
static const struct tag tags[] = {
	{ "NDims", false, take_meta_dimension },
	{ "DimSize", true, take_meta_sizes },
	{ "ElementSpacing", true, take_meta_spacing },
	{ "ElementSize", true, take_meta_size },
	{ "TransformMatrix", true, take_meta_matrix },
	{ "Rotation", true, take_meta_matrix },
	{ "Orientation", true, take_meta_matrix },
	{ "AnatomicalOrientation", false, take_meta_anatomical },
	{ "ElementType", false, take_meta_type },
	{ "ElementByteOrderMSB", false, take_meta_big_endian },
	{ "BinaryDataByteOrderMSB", false, take_meta_big_endian },
	{ "BinaryData", false, take_meta_binary },
	{ "CompressedData", false, take_meta_compressed },
	{ "ElementNumberOfChannels", false, take_meta_channels },
	{ "HeaderSize", false, take_meta_header_size },
	{ "ElementDataFile", false, take_meta_data_file },
};

static enum gz_result take_meta_line(struct metaimage *meta, char *line)
{
	char *equals = strchr(line, '=');
	if (!equals)
		return *gz_text_trim(line)
			       ? refuse_meta(meta, line, "no tag; write \"Tag = value\"")
			       : GZ_OK;
	*equals = '\0';
	const char *name = gz_text_trim(line);
	for (size_t i = 0; i < sizeof tags / sizeof tags[0]; i++) {
		if (strcasecmp(name, tags[i].name) != 0)
			continue;
		if (tags[i].needs_dimension && meta->dimension == 0)
			return refuse_meta(meta, name, "comes before NDims; put it below");
		return tags[i].take(meta, gz_text_trim(equals + 1));
	}
	return GZ_OK;
}

static enum gz_result read_meta_tags(struct metaimage *meta)
{
	char *line;
	while (!meta->has_data && (line = gz_text_head_line(&meta->head))) {
		enum gz_result result = take_meta_line(meta, line);
		if (result != GZ_OK)
			return result;
	}
	if (!meta->dimension || !meta->has_sizes || !meta->has_type || !meta->has_data)
		return refuse_meta(
			meta, "header",
			"NDims, DimSize, ElementType and ElementDataFile must be given; is "
			"it a MetaImage?");
	return GZ_OK;
}

/* Each letter is where an axis comes from: "RAI" runs from right, anterior and inferior, which is
 * LPS. So MetaIO reads them ('R' is its MET_ORIENTATION_RL), and ITK writes RAI for the identity.
 */
static enum gz_result use_letters(struct metaimage *meta)
{
	static const char from[3][2] = { { 'R', 'L' }, { 'A', 'P' }, { 'I', 'S' } };
	static const double sign[3][2] = { { -1, 1 }, { -1, 1 }, { 1, -1 } };
	for (int axis = 0; axis < 3; axis++) {
		double *d = meta->layout.direction[axis];
		d[0] = d[1] = d[2] = 0;
		for (int i = 0; i < 3; i++)
			for (int k = 0; k < 2; k++)
				if (meta->anatomical[axis] == from[i][k])
					d[i] = sign[i][k];
		if (d[0] == 0 && d[1] == 0 && d[2] == 0)
			return refuse_meta(meta, "AnatomicalOrientation",
					   "write three of R or L, A or P, I or S");
	}
	return GZ_OK;
}

/* The matrix first, then the letters, which ITK passes over. Without both the matrix is the
 * identity, as in MetaIO (MetaObject::Clear): the axes run to left, posterior, superior. */
static enum gz_result orient_meta(struct metaimage *meta)
{
	static const double identity_in_ras[3][3] = { { -1, 0, 0 }, { 0, -1, 0 }, { 0, 0, 1 } };
	meta->layout.oriented = true;
	if (meta->has_matrix)
		return GZ_OK;
	if (meta->anatomical[0]) {
		if (strcmp(meta->anatomical, "RAI") != 0)
			gz_info(meta->head.log,
				"%s: no TransformMatrix; its axes are those of "
				"AnatomicalOrientation = %s, which ITK passes over",
				meta->head.path, meta->anatomical);
		return use_letters(meta);
	}
	memcpy(meta->layout.direction, identity_in_ras, sizeof identity_in_ras);
	gz_info(meta->head.log,
		"%s: says nothing of its orientation; its axes are taken to run to left, "
		"posterior, superior, as in ITK",
		meta->head.path);
	return GZ_OK;
}

static enum gz_result finish_meta_layout(struct metaimage *meta)
{
	memcpy(meta->layout.dims, meta->sizes, sizeof meta->layout.dims);
	if (meta->dimension > 3 && meta->sizes[3] < 1)
		return refuse_meta(meta, "DimSize", "write whole numbers of 1 or more");
	meta->layout.time_points = meta->dimension > 3 ? meta->sizes[3] : 1;
	for (int i = 4; i < meta->dimension; i++)
		meta->layout.more_follows |= meta->sizes[i] != 1;
	if (meta->layout.more_follows)
		gz_warn(meta->head.log, "%s: has a fifth dimension; only its first part is shown",
			meta->head.path);
	meta->layout.spacing_assumed = !meta->has_spacing && !meta->has_size;
	meta->source.skip = meta->header_size;
	const enum gz_result result = gz_voxel_source_share(&meta->source, &meta->head, meta->sizes,
							    meta->dimension, meta->file_axes);
	meta->source.numbers_per_file *=
		meta->layout.channels > 1 ? (uint64_t)meta->layout.channels : 1;
	return result == GZ_OK ? orient_meta(meta) : result;
}

static enum gz_result load_metaimage(const struct gz_volume_file *file,
				     struct gz_volume *out_volume)
{
	struct metaimage meta = { .layout = gz_import_layout_default() };
	enum gz_result result = gz_text_head_open(&meta.head, file->path, file->log);
	if (result == GZ_OK)
		result = read_meta_tags(&meta);
	if (result == GZ_OK)
		result = finish_meta_layout(&meta);
	if (result == GZ_OK)
		result = gz_voxel_source_import(&meta.source, &meta.layout, file, out_volume);
	gz_voxel_source_free(&meta.source);
	gz_text_head_free(&meta.head);
	return result;
}

static bool is_meta_tag(const char *name)
{
	const char *at = name;
	while (isalpha((unsigned char)*at))
		at++;
	return at > name && !*at;
}

/* Lines "Tag = value" up to NDims, which every MetaImage has before its sizes. */
static bool metaimage_knows_start(const struct gz_file_start *start)
{
	char text[GZ_FILE_START_SIZE + 1];
	memcpy(text, start->bytes, start->size);
	text[start->size] = '\0';
	char *line = start->coding == GZ_CODING_PLAIN ? text : NULL;
	while (line) {
		char *end = strchr(line, '\n');
		char *equals = strchr(line, '=');
		if (!equals || (end && equals > end))
			return false;
		*equals = '\0';
		const char *name = gz_text_trim(line);
		if (!is_meta_tag(name))
			return false;
		if (strcasecmp(name, "NDims") == 0)
			return true;
		line = end ? end + 1 : NULL;
	}
	return false;
}

const struct gz_volume_format gz_format_metaimage = {
	.name = "MetaImage",
	.endings = { ".mhd", ".mha" },
	.layout = GZ_LAYOUT_IN_FILE,
	.knows_start = metaimage_knows_start,
	.load = load_metaimage,
	.limits = "one number a voxel, integers of up to 32 bits, or colours of 8 or 16 bits; of a "
		  "fifth dimension only the first",
};
