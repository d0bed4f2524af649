/* Projects of InVesalius 3, by what it writes (project.py and imagedata_utils.py of 3.1): a tar
 * file, compressed or not, of one folder with main.plist, a property list, and matrix.dat, the
 * voxels. Masks and surfaces are passed over. */
#include <expat.h>
#include <limits.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "render/data/format.h"
#include "render/data/tar_member.h"

#define GZ_LOG_MODULE "volume"

#define LIST_NAME      "main.plist"
#define LIST_BYTES_MAX (1 << 20) /* chosen: some hundred times what projects have */
#define DEPTH_MAX      8         /* of elements whose content is taken */
#define TEXT_SIZE      128
#define NUMBERS_MAX    4 /* that are taken of an array; a shape has fewer */

/* The numbers of an array, or one. */
struct numbers {
	double at[NUMBERS_MAX];
	int count;
};

/* What the property list says. */
struct project {
	char matrix[TEXT_SIZE], type[TEXT_SIZE], modality[TEXT_SIZE];
	struct numbers shape, spacing, orientation, affine;
};

/* Where a value goes. */
struct project_field {
	const char *keys; /* of the dictionaries around it, the outermost first */
	bool is_number;   /* one or an array of them; else a text */
	size_t at;
};

#define AT(member) offsetof(struct project, member)

static const struct project_field project_fields[] = {
	{ "matrix/filename", false, AT(matrix) }, { "matrix/dtype", false, AT(type) },
	{ "modality", false, AT(modality) },      { "matrix/shape", true, AT(shape) },
	{ "spacing", true, AT(spacing) },         { "orientation", true, AT(orientation) },
	{ "affine", true, AT(affine) },
};

#undef AT

/* A property list that is being read. */
struct list_reader {
	struct project *project;
	char keys[DEPTH_MAX][TEXT_SIZE]; /* the last key among the children of each element */
	char text[TEXT_SIZE];            /* of the element that was opened last */
	size_t text_size;
	int depth; /* of open elements; 1 is <plist> */
};

static void begin_element(void *user, const XML_Char *name, const XML_Char **attributes)
{
	struct list_reader *reader = user;
	(void)name;
	(void)attributes;
	reader->depth++;
	reader->text_size = 0;
	if (reader->depth < DEPTH_MAX)
		reader->keys[reader->depth][0] = 0;
}

static void take_characters(void *user, const XML_Char *text, int size)
{
	struct list_reader *reader = user;
	const size_t room = sizeof reader->text - 1 - reader->text_size;
	const size_t taken = (size_t)size < room ? (size_t)size : room;
	memcpy(reader->text + reader->text_size, text, taken);
	reader->text_size += taken;
}

/* Whether the keys that lead to a value are these. Arrays have none. */
static bool is_at(const struct list_reader *reader, const char *keys)
{
	for (int depth = 2; depth < reader->depth; depth++) {
		const char *key = depth < DEPTH_MAX ? reader->keys[depth] : "";
		const size_t size = strlen(key);
		if (size == 0)
			continue;
		if (strncmp(keys, key, size) != 0)
			return false;
		keys += size;
		if (*keys == '/')
			keys++;
		else if (*keys)
			return false;
	}
	return *keys == 0;
}

/* A number that is none becomes 0, which is refused wherever it matters. */
static void add_number(struct numbers *numbers, const char *text)
{
	double number = 0;
	(void)gz_number_parse(text, &number);
	if (numbers->count < NUMBERS_MAX)
		numbers->at[numbers->count++] = number;
}

static void take_value(struct list_reader *reader, bool is_number)
{
	for (size_t i = 0; i < sizeof project_fields / sizeof project_fields[0]; i++) {
		const struct project_field *field = &project_fields[i];
		char *place = (char *)reader->project + field->at;
		if (field->is_number != is_number || !is_at(reader, field->keys))
			continue;
		if (is_number)
			add_number((struct numbers *)(void *)place, reader->text);
		else
			memcpy(place, reader->text, TEXT_SIZE);
	}
}

static void end_element(void *user, const XML_Char *name)
{
	struct list_reader *reader = user;
	reader->text[reader->text_size] = 0;
	if (strcmp(name, "key") == 0) {
		if (reader->depth <= DEPTH_MAX)
			memcpy(reader->keys[reader->depth - 1], reader->text, TEXT_SIZE);
	} else if (strcmp(name, "string") == 0) {
		take_value(reader, false);
	} else if (strcmp(name, "integer") == 0 || strcmp(name, "real") == 0) {
		take_value(reader, true);
	}
	reader->text_size = 0;
	reader->depth--;
}

static enum gz_result parse_list(const char *text, size_t size, const struct gz_volume_file *file,
				 struct project *out_project)
{
	struct list_reader reader = { .project = out_project };
	const XML_Parser parser = XML_ParserCreate(NULL);
	if (!parser) {
		gz_err(file->log, "%s: out of memory", file->path);
		return GZ_ERR_NO_MEM;
	}
	XML_SetUserData(parser, &reader);
	XML_SetElementHandler(parser, begin_element, end_element);
	XML_SetCharacterDataHandler(parser, take_characters);
	const bool parsed = XML_Parse(parser, text, (int)size, 1) == XML_STATUS_OK;
	if (!parsed)
		gz_err(file->log, "%s: " LIST_NAME " is damaged: line %lu: %s", file->path,
		       (unsigned long)XML_GetCurrentLineNumber(parser),
		       XML_ErrorString(XML_GetErrorCode(parser)));
	XML_ParserFree(parser);
	return parsed ? GZ_OK : GZ_ERR_FORMAT;
}

/* Open the file and go to one of its members. The stream is to be closed, whatever is returned. */
static enum gz_result open_member(const struct gz_volume_file *file, const char *name,
				  struct gz_byte_stream **out_stream, uint64_t *out_size)
{
	enum gz_result result = gz_byte_stream_open(file->path, gz_coding_of_file(file->path), 0,
						    file->log, out_stream);
	if (result == GZ_OK)
		result = gz_tar_find(*out_stream, name, file->path, file->log, out_size);
	if (result != GZ_ERR_NOT_FOUND || !*out_stream)
		return result;
	gz_err(file->log, "%s: has no %s; is it really a project of InVesalius 3?", file->path,
	       name);
	return GZ_ERR_FORMAT;
}

static enum gz_result read_list(const struct gz_volume_file *file, struct project *out_project)
{
	struct gz_byte_stream *stream = NULL;
	uint64_t size = 0;
	size_t got = 0;
	char *text = NULL;
	enum gz_result result = open_member(file, LIST_NAME, &stream, &size);
	if (result == GZ_OK && size > LIST_BYTES_MAX) {
		gz_err(file->log, "%s: " LIST_NAME " has %llu bytes; allowed: %d", file->path,
		       (unsigned long long)size, LIST_BYTES_MAX);
		result = GZ_ERR_FORMAT;
	}
	if (result == GZ_OK) {
		text = malloc((size_t)size + 1);
		if (!text)
			gz_err(file->log, "%s: out of memory", file->path);
		result = text ? gz_byte_stream_read(stream, text, (size_t)size, &got)
			      : GZ_ERR_NO_MEM;
	}
	if (result == GZ_OK)
		result = parse_list(text, got, file, out_project);
	free(text);
	gz_byte_stream_close(&stream);
	return result;
}

/* numpy's names of types are those of raw files. It stores them as the machine does, and InVesalius
 * runs on machines that store the least significant byte first. */
static enum gz_result take_type(const struct project *project, const struct gz_volume_file *file,
				struct gz_import_layout *layout)
{
	for (int type = 0; type < GZ_RAW_TYPE_COUNT; type++) {
		if (strcmp(project->type, gz_raw_type_names[type]) == 0) {
			layout->type = (enum gz_raw_type)type;
			return GZ_OK;
		}
	}
	gz_err(file->log,
	       "%s: voxels of type \"%s\" are not read; export it from InVesalius as NIfTI",
	       file->path, project->type);
	return GZ_ERR_UNSUPPORTED;
}

/* Rows are stored from the bottom to the top of a slice (dcm2memmap()). In axial and coronal series
 * that leaves x to the left, as in DICOM, and y to the front. In sagittal ones, and in what comes
 * from NIfTI with an affine matrix (img2memmap()), x runs to the right and y to the back. */
static void take_directions(const struct project *project, struct gz_import_layout *layout)
{
	enum { SAGITTAL = 3 }; /* in constants.py */
	const bool turned = project->affine.count > 0 || project->orientation.at[0] == SAGITTAL;
	layout->oriented = true;
	layout->direction[0][0] = turned ? 1 : -1;
	layout->direction[1][1] = turned ? -1 : 1;
}

static enum gz_result take_project(const struct project *project, const struct gz_volume_file *file,
				   struct gz_import_layout *layout)
{
	if (project->shape.count != 3 || project->spacing.count != 3 || !project->matrix[0]) {
		gz_err(file->log,
		       "%s: " LIST_NAME " lacks the file, the shape or the spacing of the matrix",
		       file->path);
		return GZ_ERR_FORMAT;
	}
	for (int axis = 0; axis < 3; axis++) {
		const double voxels = project->shape.at[2 - axis];
		layout->dims[axis] = voxels >= 1 && voxels <= INT_MAX ? (int)voxels : 0;
		layout->spacing[axis] = project->spacing.at[axis];
	}
	layout->modality = gz_modality_of_term(project->modality);
	layout->more_follows = true;
	take_directions(project, layout);
	return take_type(project, file, layout);
}

static enum gz_result check_matrix_size(const struct gz_import_layout *layout, uint64_t size,
					const struct gz_volume_file *file)
{
	double wanted = (double)gz_raw_type_size(layout->type);
	for (int axis = 0; axis < 3; axis++)
		wanted *= layout->dims[axis];
	if ((double)size == wanted)
		return GZ_OK;
	gz_err(file->log, "%s: %d x %d x %d voxels are %.0f bytes, but the matrix has %llu",
	       file->path, layout->dims[0], layout->dims[1], layout->dims[2], wanted,
	       (unsigned long long)size);
	return GZ_ERR_FORMAT;
}

static enum gz_result load_inv3(const struct gz_volume_file *file, struct gz_volume *out_volume)
{
	struct gz_import_layout layout = gz_import_layout_default();
	struct project project = { 0 };
	struct gz_byte_stream *stream = NULL;
	uint64_t size = 0;
	enum gz_result result = read_list(file, &project);
	if (result == GZ_OK)
		result = take_project(&project, file, &layout);
	if (result == GZ_OK)
		result = open_member(file, project.matrix, &stream, &size);
	if (result == GZ_OK)
		result = check_matrix_size(&layout, size, file);
	if (result == GZ_OK)
		result = gz_volume_import(stream, &layout, file, out_volume);
	gz_byte_stream_close(&stream);
	return result;
}

/* The first member that is a file is the matrix or the list, depending on the version. */
static bool inv3_knows_start(const struct gz_file_start *start)
{
	struct gz_tar_member member;
	size_t at = 0;
	while (at + GZ_TAR_BLOCK <= start->size &&
	       gz_tar_header_decode(start->bytes + at, &member)) {
		if (member.is_file)
			return strcmp(member.name, LIST_NAME) == 0 ||
			       strcmp(member.name, "matrix.dat") == 0;
		if (member.size > GZ_FILE_START_SIZE)
			return false;
		at += GZ_TAR_BLOCK + gz_tar_padded_size(member.size);
	}
	return false;
}

const struct gz_volume_format gz_format_inv3 = {
	.name = "InVesalius project",
	.endings = { ".inv3" },
	.layout = GZ_LAYOUT_IN_FILE,
	.knows_start = inv3_knows_start,
	.load = load_inv3,
	.limits = "the volume only: no masks, no surfaces",
};
