/* Legacy VTK files of points: the data sets UNSTRUCTURED_GRID and POLYDATA, as text or binary
 * (big-endian). "VTK File Formats", vtk.org, simple legacy formats; the offsets of cells in files
 * of version 5 by vtkDataReader.cxx. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/text.h"
#include "render/particles/particle_reader.h"

#define GZ_LOG_MODULE "particles"

#define BLANKS " \t"

static const char vtk_magic[] = "# vtk DataFile Version ";

struct vtk_file {
	struct gz_particle_reader *reader;
	bool offsets;    /* cells are written as offsets and connectivity: version 5 */
	bool of_points;  /* the present data belong to points */
	uint64_t tuples; /* of the present data */
	uint64_t points;
	double (*positions)[3]; /* kept until the values are read; NULL if none are wanted */
	float *values;          /* of the points */
	unsigned there;         /* bits of the values that the file has */
};

/* The next line that is not blank. */
static enum gz_result take_full_line(struct gz_particle_reader *reader,
				     char line[GZ_PARTICLE_LINE_MAX])
{
	enum gz_result result;
	do {
		result = gz_particle_take_line(reader, line);
	} while (result == GZ_OK && line[strspn(line, BLANKS)] == '\0');
	return result;
}

static bool is_point_set(const char *line)
{
	char copy[64];
	snprintf(copy, sizeof copy, "%.63s", line);
	char *rest = copy;
	const char *word = gz_number_next_word(&rest, BLANKS);
	if (!word || strcasecmp(word, "DATASET") != 0)
		return false;
	word = gz_number_next_word(&rest, BLANKS);
	return word &&
	       (strcasecmp(word, "UNSTRUCTURED_GRID") == 0 || strcasecmp(word, "POLYDATA") == 0);
}

/* The fourth line, or one after blank ones, names a data set of points. */
static bool recognise_vtk(const char *path, const struct gz_file_start *start)
{
	char line[64];
	int lines = 0;
	(void)path;
	if (!gz_file_start_has(start, 0, vtk_magic, sizeof vtk_magic - 1))
		return false;
	for (size_t at = 0; at < start->size && lines < 8; lines++) {
		const uint8_t *end = memchr(start->bytes + at, '\n', start->size - at);
		const size_t length = end ? (size_t)(end - (start->bytes + at)) : start->size - at;
		const size_t kept = length < sizeof line ? length : sizeof line - 1;
		memcpy(line, start->bytes + at, kept);
		line[kept] = '\0';
		line[strcspn(line, "\r")] = '\0';
		if (lines >= 3 && is_point_set(line))
			return true;
		at += length + 1;
	}
	return false;
}

static bool vtk_type(const char *word, enum gz_file_number *out_type)
{
	static const struct {
		const char *name;
		enum gz_file_number type;
	} types[] = {
		{ "char", GZ_FILE_I8 },          { "unsigned_char", GZ_FILE_U8 },
		{ "short", GZ_FILE_I16 },        { "unsigned_short", GZ_FILE_U16 },
		{ "int", GZ_FILE_I32 },          { "unsigned_int", GZ_FILE_U32 },
		{ "long", GZ_FILE_I64 },         { "unsigned_long", GZ_FILE_U64 },
		{ "vtktypeint64", GZ_FILE_I64 }, { "vtktypeuint64", GZ_FILE_U64 },
		{ "vtkidtype", GZ_FILE_I32 },    { "float", GZ_FILE_F32 },
		{ "double", GZ_FILE_F64 },
	};
	for (size_t i = 0; i < sizeof types / sizeof types[0]; i++)
		if (strcasecmp(word, types[i].name) == 0) {
			*out_type = types[i].type;
			return true;
		}
	return false;
}

static enum gz_result refuse_section(const struct vtk_file *file, const char *section)
{
	return gz_particle_refuse(file->reader, "section %.40s: its numbers or its type are wrong",
				  section);
}

/* A whole number at least 0 that is the next word. */
static bool next_count(char **rest, uint64_t *out_count)
{
	const char *word = gz_number_next_word(rest, BLANKS);
	long long number = -1;
	if (!word || !gz_number_parse_whole(word, &number) || number < 0 || number > INT32_MAX)
		return false;
	*out_count = (uint64_t)number;
	return true;
}

static bool next_type(char **rest, enum gz_file_number *out_type)
{
	const char *word = gz_number_next_word(rest, BLANKS);
	return word && vtk_type(word, out_type);
}

/* Pass over numbers, after a look whether the file can hold them. */
static enum gz_result pass_numbers(struct vtk_file *file, enum gz_file_number type, uint64_t count)
{
	const bool text = file->reader->coding == GZ_PARTICLE_TEXT;
	const enum gz_result result = gz_particle_check_claim(
		file->reader, count, text ? 1 : gz_file_number_size(type), "numbers");
	return result == GZ_OK ? gz_particle_read_numbers(file->reader, type, NULL, count) : result;
}

/* Keep the points until their values are read. */
static enum gz_result keep_points(struct vtk_file *file, enum gz_file_number type)
{
	const uint64_t count = file->points;
	enum gz_result result = GZ_OK;
	if (gz_memory_fits_machine(count * (sizeof *file->positions + sizeof *file->values))) {
		file->positions = malloc((count + 1) * sizeof *file->positions);
		file->values = malloc((count + 1) * sizeof *file->values);
	}
	if (!file->positions || !file->values) {
		gz_err(file->reader->request->log, "%s: no memory for %" PRIu64 " points",
		       file->reader->request->path, count);
		return GZ_ERR_NO_MEM;
	}
	for (uint64_t i = 0; i < count && result == GZ_OK; i++) {
		file->values[i] = NAN;
		result = gz_particle_read_numbers(file->reader, type, file->positions[i], 3);
	}
	return result;
}

static enum gz_result read_points(struct vtk_file *file, char *rest)
{
	struct gz_particle_reader *reader = file->reader;
	enum gz_file_number type;
	double position[3];
	if (!next_count(&rest, &file->points) || !next_type(&rest, &type) || file->positions)
		return refuse_section(file, "POINTS");
	const bool text = reader->coding == GZ_PARTICLE_TEXT;
	enum gz_result result = gz_particle_check_claim(
		reader, file->points, text ? 5 : 3 * gz_file_number_size(type), "points");
	if (result == GZ_OK && reader->request->value != GZ_PARTICLE_FILL)
		return keep_points(file, type);
	for (uint64_t i = 0; i < file->points && result == GZ_OK; i++) {
		result = gz_particle_read_numbers(reader, type, position, 3);
		if (result == GZ_OK)
			result = gz_particle_add(reader, position, 1);
	}
	return result;
}

/* "OFFSETS type" or "CONNECTIVITY type", and its numbers. */
static enum gz_result pass_cell_array(struct vtk_file *file, uint64_t count)
{
	char line[GZ_PARTICLE_LINE_MAX], *rest = line;
	enum gz_file_number type;
	const enum gz_result result = take_full_line(file->reader, line);
	if (result != GZ_OK)
		return result;
	if (!gz_number_next_word(&rest, BLANKS) || !next_type(&rest, &type))
		return refuse_section(file, line);
	return pass_numbers(file, type, count);
}

static enum gz_result pass_cells(struct vtk_file *file, const char *section, char *rest)
{
	uint64_t count = 0, size = 0;
	if (!next_count(&rest, &count) || !next_count(&rest, &size))
		return refuse_section(file, section);
	if (!file->offsets)
		return pass_numbers(file, GZ_FILE_I32, size);
	const enum gz_result result = pass_cell_array(file, count);
	return result == GZ_OK ? pass_cell_array(file, size) : result;
}

static enum gz_result pass_cell_types(struct vtk_file *file, const char *section, char *rest)
{
	uint64_t count = 0;
	return next_count(&rest, &count) ? pass_numbers(file, GZ_FILE_I32, count)
					 : refuse_section(file, section);
}

/* An array of data: kept if it is the value that is asked for. */
struct vtk_array {
	char name[64];
	uint64_t components, tuples;
	enum gz_file_number type;
};

static enum gz_result take_vtk_values(struct vtk_file *file, const struct vtk_array *array)
{
	double numbers[3] = { 0 };
	enum gz_result result =
		gz_particle_check_claim(file->reader, array->tuples, array->components, "values");
	for (uint64_t i = 0; i < array->tuples && result == GZ_OK; i++) {
		result = gz_particle_read_numbers(file->reader, array->type, numbers,
						  array->components);
		file->values[i] = (float)(array->components == 3 ? sqrt(numbers[0] * numbers[0] +
									numbers[1] * numbers[1] +
									numbers[2] * numbers[2])
								 : numbers[0]);
	}
	return result;
}

static enum gz_result read_array(struct vtk_file *file, const struct vtk_array *array)
{
	const enum gz_particle_value value = gz_particle_value_named(array->name);
	const uint64_t needs = value == GZ_PARTICLE_SPEED ? 3 : 1;
	const bool usable = file->of_points && file->positions && value != GZ_PARTICLE_FILL &&
			    array->components == needs && array->tuples == file->points;
	if (usable)
		file->there |= 1U << value;
	if (usable && value == file->reader->request->value)
		return take_vtk_values(file, array);
	/* Products of two 31-bit numbers. */
	return pass_numbers(file, array->type, array->components * array->tuples);
}

static enum gz_result read_scalars(struct vtk_file *file, const char *section, char *rest)
{
	struct vtk_array array = { .components = 1, .tuples = file->tuples };
	char line[GZ_PARTICLE_LINE_MAX];
	const char *name = gz_number_next_word(&rest, BLANKS);
	if (!name || !next_type(&rest, &array.type))
		return refuse_section(file, section);
	(void)next_count(&rest, &array.components);
	snprintf(array.name, sizeof array.name, "%s", name);
	/* The line LOOKUP_TABLE, which no file leaves out. */
	const enum gz_result result = take_full_line(file->reader, line);
	return result == GZ_OK ? read_array(file, &array) : result;
}

static enum gz_result read_vectors(struct vtk_file *file, const char *section, char *rest)
{
	struct vtk_array array = { .components = 3, .tuples = file->tuples };
	const char *name = gz_number_next_word(&rest, BLANKS);
	if (!name)
		return refuse_section(file, section);
	snprintf(array.name, sizeof array.name, "%s", name);
	if (strcasecmp(section, "TENSORS") == 0)
		array.components = 9;
	if (strcasecmp(section, "GLOBAL_IDS") == 0 || strcasecmp(section, "PEDIGREE_IDS") == 0)
		array.components = 1;
	if (strcasecmp(section, "TEXTURE_COORDINATES") == 0 &&
	    !next_count(&rest, &array.components))
		return refuse_section(file, section);
	return next_type(&rest, &array.type) ? read_array(file, &array)
					     : refuse_section(file, section);
}

static enum gz_result pass_colours(struct vtk_file *file, const char *section, char *rest)
{
	uint64_t components = 0;
	if (!gz_number_next_word(&rest, BLANKS) || !next_count(&rest, &components))
		return refuse_section(file, section);
	return pass_numbers(file, GZ_FILE_U8, components * file->tuples);
}

static enum gz_result pass_lookup_table(struct vtk_file *file, const char *section, char *rest)
{
	uint64_t size = 0;
	if (!gz_number_next_word(&rest, BLANKS) || !next_count(&rest, &size))
		return refuse_section(file, section);
	return pass_numbers(file, GZ_FILE_U8, 4 * size);
}

/* Lines up to a blank one. */
static enum gz_result pass_metadata(struct vtk_file *file, const char *section, char *rest)
{
	char line[GZ_PARTICLE_LINE_MAX];
	enum gz_result result;
	(void)section;
	(void)rest;
	do {
		result = gz_particle_take_line(file->reader, line);
	} while (result == GZ_OK && line[strspn(line, BLANKS)] != '\0');
	return result;
}

static enum gz_result read_field(struct vtk_file *file, const char *section, char *rest)
{
	uint64_t arrays = 0;
	char line[GZ_PARTICLE_LINE_MAX];
	if (!gz_number_next_word(&rest, BLANKS) || !next_count(&rest, &arrays))
		return refuse_section(file, section);
	enum gz_result result = GZ_OK;
	while (arrays > 0 && result == GZ_OK) {
		struct vtk_array array = { 0 };
		result = take_full_line(file->reader, line);
		if (result != GZ_OK)
			return result;
		char *of_line = line;
		const char *name = gz_number_next_word(&of_line, BLANKS);
		if (name && strcasecmp(name, "METADATA") == 0) {
			result = pass_metadata(file, name, of_line);
			continue;
		}
		if (!name || !next_count(&of_line, &array.components) ||
		    !next_count(&of_line, &array.tuples) || !next_type(&of_line, &array.type))
			return refuse_section(file, section);
		snprintf(array.name, sizeof array.name, "%s", name);
		result = read_array(file, &array);
		arrays--;
	}
	return result;
}

static enum gz_result begin_data(struct vtk_file *file, const char *section, char *rest)
{
	file->of_points = strcasecmp(section, "POINT_DATA") == 0;
	return next_count(&rest, &file->tuples) ? GZ_OK : refuse_section(file, section);
}

typedef enum gz_result section_function(struct vtk_file *file, const char *section, char *rest);

static enum gz_result read_vtk_section(struct vtk_file *file, char *line)
{
	static const struct {
		const char *name;
		section_function *read;
	} sections[] = {
		{ "CELLS", pass_cells },           { "VERTICES", pass_cells },
		{ "LINES", pass_cells },           { "POLYGONS", pass_cells },
		{ "TRIANGLE_STRIPS", pass_cells }, { "CELL_TYPES", pass_cell_types },
		{ "POINT_DATA", begin_data },      { "CELL_DATA", begin_data },
		{ "SCALARS", read_scalars },       { "VECTORS", read_vectors },
		{ "NORMALS", read_vectors },       { "TENSORS", read_vectors },
		{ "GLOBAL_IDS", read_vectors },    { "PEDIGREE_IDS", read_vectors },
		{ "FIELD", read_field },           { "TEXTURE_COORDINATES", read_vectors },
		{ "COLOR_SCALARS", pass_colours }, { "LOOKUP_TABLE", pass_lookup_table },
		{ "METADATA", pass_metadata },
	};
	char *rest = line;
	const char *word = gz_number_next_word(&rest, BLANKS);
	if (word && strcasecmp(word, "POINTS") == 0)
		return read_points(file, rest);
	for (size_t i = 0; word && i < sizeof sections / sizeof sections[0]; i++)
		if (strcasecmp(word, sections[i].name) == 0)
			return sections[i].read(file, sections[i].name, rest);
	return gz_particle_refuse(file->reader, "section %.40s is not read", word ? word : "");
}

static enum gz_result read_vtk_head(struct vtk_file *file)
{
	struct gz_particle_reader *reader = file->reader;
	char line[GZ_PARTICLE_LINE_MAX];
	enum gz_result result = gz_particle_take_line(reader, line);
	if (result == GZ_OK && strncmp(line, vtk_magic, sizeof vtk_magic - 1) != 0)
		return gz_particle_refuse(reader, "does not begin as a legacy VTK file does");
	file->offsets = result == GZ_OK && atoi(line + sizeof vtk_magic - 1) >= 5;
	if (result == GZ_OK)
		result = gz_particle_take_line(reader, line); /* its title */
	if (result == GZ_OK)
		result = take_full_line(reader, line);
	if (result == GZ_OK)
		reader->coding = strncasecmp(line, "BINARY", 6) == 0 ? GZ_PARTICLE_BIG_ENDIAN
								     : GZ_PARTICLE_TEXT;
	if (result == GZ_OK)
		result = take_full_line(reader, line);
	if (result == GZ_OK && !is_point_set(line)) {
		gz_err(reader->request->log,
		       "%s: %.40s; of VTK's data sets UNSTRUCTURED_GRID and POLYDATA are read",
		       reader->request->path, line);
		return GZ_ERR_UNSUPPORTED;
	}
	return result;
}

/* Whether all that is wanted of the file is known. */
static bool vtk_is_complete(const struct vtk_file *file)
{
	const enum gz_particle_value wanted = file->reader->request->value;
	return wanted == GZ_PARTICLE_FILL ? file->points > 0 : (file->there & 1U << wanted) != 0;
}

static enum gz_result add_kept_points(struct vtk_file *file)
{
	enum gz_result result = GZ_OK;
	for (uint64_t i = 0; i < file->points && result == GZ_OK; i++)
		result = gz_particle_add(file->reader, file->positions[i], (double)file->values[i]);
	return result;
}

static enum gz_result read_vtk(struct vtk_file *file)
{
	char line[GZ_PARTICLE_LINE_MAX];
	enum gz_result result = read_vtk_head(file);
	while (result == GZ_OK && !vtk_is_complete(file)) {
		result = take_full_line(file->reader, line);
		if (result == GZ_OK)
			result = read_vtk_section(file, line);
	}
	if (result != GZ_OK && result != GZ_ERR_NOT_FOUND)
		return result;
	if (file->reader->request->value == GZ_PARTICLE_FILL)
		return GZ_OK;
	if (file->positions && !vtk_is_complete(file))
		return gz_particle_refuse_value(file->reader, file->there);
	return add_kept_points(file);
}

static enum gz_result load_vtk(const struct gz_particle_request *request,
			       struct gz_particles *out_particles)
{
	struct vtk_file file = { 0 };
	enum gz_result result = gz_particle_reader_open(request, &file.reader);
	if (result == GZ_OK)
		result = gz_particle_one_step(file.reader);
	if (result == GZ_OK)
		result = read_vtk(&file);
	free(file.positions);
	free(file.values);
	return gz_particle_reader_close(&file.reader, result, out_particles);
}

const struct gz_particle_format gz_particle_format_vtk = {
	.name = "VTK legacy points",
	.endings = { ".vtk", ".vtk.gz" },
	.recognise = recognise_vtk,
	.load = load_vtk,
	.limits =
		"UNSTRUCTURED_GRID and POLYDATA: points, density, pressure and velocity; cells are "
		"not used",
};
