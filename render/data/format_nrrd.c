/* NRRD, by its definition at teem.sourceforge.net/nrrd/format.html, to which the section numbers
 * refer. Teem itself is not used: it reads and converts whole arrays, which takes the volume's
 * memory twice over. */
#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/file.h"
#include "base/text.h"
#include "base/vector.h"
#include "render/data/format.h"
#include "render/data/length_unit.h"
#include "render/data/text_head.h"
#include "render/data/voxel_colour.h"
#include "render/data/voxel_source.h"

#define GZ_LOG_MODULE "volume"

#define AXES_MAX 16 /* NRRD_DIM_MAX */
#define BLANKS   " \t"

/* Of the name of a unit with its NUL, bytes. Chosen: more than "micrometres" has. */
#define UNIT_SIZE 24

struct nrrd {
	struct gz_text_head head;
	struct gz_import_layout layout;
	struct gz_voxel_source source;
	int dimension; /* 0 = not given yet */
	int sizes[AXES_MAX];
	double spacings[AXES_MAX];
	double directions[AXES_MAX][3]; /* as written; NaN: none */
	double sign[3];                 /* of the written space in RAS+ */
	bool has_type, has_sizes, has_encoding, has_endian, has_spacings, has_directions;
	bool has_assumed_spacing;        /* the program that wrote it did not know either */
	bool anatomical, values_first;   /* the first axis holds the parts of a value */
	bool has_first_kind;             /* what the first axis holds is known */
	int colour_channels;             /* of a first axis that holds colours; else 0 */
	bool colour_later;               /* another axis holds colours */
	char units[AXES_MAX][UNIT_SIZE]; /* of the axes; empty: not given */
	char space_units[3][UNIT_SIZE];  /* of x, y, z in the written space */
	bool detached;
	int file_axes; /* that each of several files holds; 0: not given */
};

static enum gz_result refuse_nrrd(struct nrrd *nrrd, const char *key, const char *what)
{
	return gz_text_head_refuse(&nrrd->head, key, what);
}

static enum gz_result refuse_nrrd_unsupported(struct nrrd *nrrd, const char *key, const char *what)
{
	(void)gz_text_head_refuse(&nrrd->head, key, what);
	return GZ_ERR_UNSUPPORTED;
}

/* Section 5.1, "type". */
static enum gz_result take_nrrd_type(struct nrrd *nrrd, char *value)
{
	static const struct {
		const char *name;
		enum gz_raw_type type;
	} types[] = {
		{ "uchar", GZ_RAW_UINT8 },
		{ "unsigned char", GZ_RAW_UINT8 },
		{ "uint8", GZ_RAW_UINT8 },
		{ "uint8_t", GZ_RAW_UINT8 },
		{ "signed char", GZ_RAW_INT8 },
		{ "int8", GZ_RAW_INT8 },
		{ "int8_t", GZ_RAW_INT8 },
		{ "ushort", GZ_RAW_UINT16 },
		{ "unsigned short", GZ_RAW_UINT16 },
		{ "unsigned short int", GZ_RAW_UINT16 },
		{ "uint16", GZ_RAW_UINT16 },
		{ "uint16_t", GZ_RAW_UINT16 },
		{ "short", GZ_RAW_INT16 },
		{ "short int", GZ_RAW_INT16 },
		{ "signed short", GZ_RAW_INT16 },
		{ "signed short int", GZ_RAW_INT16 },
		{ "int16", GZ_RAW_INT16 },
		{ "int16_t", GZ_RAW_INT16 },
		{ "uint", GZ_RAW_UINT32 },
		{ "unsigned int", GZ_RAW_UINT32 },
		{ "uint32", GZ_RAW_UINT32 },
		{ "uint32_t", GZ_RAW_UINT32 },
		{ "int", GZ_RAW_INT32 },
		{ "signed int", GZ_RAW_INT32 },
		{ "int32", GZ_RAW_INT32 },
		{ "int32_t", GZ_RAW_INT32 },
		{ "float", GZ_RAW_FLOAT32 },
		{ "double", GZ_RAW_FLOAT64 },
	};
	for (size_t i = 0; i < sizeof types / sizeof types[0]; i++) {
		if (strcasecmp(value, types[i].name) == 0) {
			nrrd->layout.type = types[i].type;
			nrrd->has_type = true;
			return GZ_OK;
		}
	}
	return refuse_nrrd_unsupported(nrrd, "type",
				       "not read; 8 to 32 bit integers, float and double are");
}

static enum gz_result take_nrrd_dimension(struct nrrd *nrrd, char *value)
{
	if (!gz_text_wholes(value, &nrrd->dimension, 1) || nrrd->dimension < 1 ||
	    nrrd->dimension > AXES_MAX) {
		nrrd->dimension = 0;
		return refuse_nrrd(nrrd, "dimension", "must be a number from 1 to 16");
	}
	if (nrrd->dimension < 3)
		return refuse_nrrd_unsupported(nrrd, "dimension",
					       "less than 3: this is not a volume");
	return GZ_OK;
}

static enum gz_result take_nrrd_sizes(struct nrrd *nrrd, char *value)
{
	if (!gz_text_wholes(value, nrrd->sizes, nrrd->dimension))
		return refuse_nrrd(nrrd, "sizes", "write one whole number an axis");
	nrrd->has_sizes = true;
	return GZ_OK;
}

static enum gz_result take_nrrd_spacings(struct nrrd *nrrd, char *value)
{
	for (int i = 0; i < nrrd->dimension; i++) {
		char *word = gz_number_next_word(&value, BLANKS);
		nrrd->spacings[i] = NAN;
		if (!word ||
		    (strcasecmp(word, "nan") != 0 && !gz_number_parse(word, &nrrd->spacings[i])))
			return refuse_nrrd(nrrd, "spacings", "write one number an axis");
	}
	if (gz_number_next_word(&value, BLANKS))
		return refuse_nrrd(nrrd, "spacings", "more numbers than axes");
	nrrd->has_spacings = true;
	return GZ_OK;
}

/* One "(x,y,z)" or "none" off the front of *text. */
static bool take_nrrd_vector(char **text, double out[3])
{
	char *at = *text + strspn(*text, BLANKS);
	if (strncasecmp(at, "none", 4) == 0) {
		out[0] = out[1] = out[2] = NAN;
		*text = at + 4;
		return true;
	}
	char *close = strchr(at, ')');
	if (*at != '(' || !close)
		return false;
	*close = '\0';
	*text = close + 1;
	for (char *c = at; *c; c++)
		*c = *c == ',' ? ' ' : *c;
	return gz_text_numbers(at + 1, out, 3);
}

static enum gz_result take_nrrd_directions(struct nrrd *nrrd, char *value)
{
	for (int i = 0; i < nrrd->dimension; i++)
		if (!take_nrrd_vector(&value, nrrd->directions[i]))
			return refuse_nrrd(nrrd, "space directions",
					   "write \"(x,y,z)\" or \"none\" for each axis");
	if (*gz_text_trim(value))
		return refuse_nrrd(nrrd, "space directions", "more vectors than axes");
	nrrd->has_directions = true;
	return GZ_OK;
}

/* Section 5.2, "space": the signs that turn its x, y, z to right, anterior, superior. */
static enum gz_result take_nrrd_space(struct nrrd *nrrd, char *value)
{
	static const struct {
		const char *names[2];
		double sign[3];
		bool anatomical;
	} spaces[] = {
		{ { "right-anterior-superior", "RAS" }, { 1, 1, 1 }, true },
		{ { "left-anterior-superior", "LAS" }, { -1, 1, 1 }, true },
		{ { "left-posterior-superior", "LPS" }, { -1, -1, 1 }, true },
		{ { "scanner-xyz", "scanner-xyz" }, { 1, 1, 1 }, false },
		{ { "3D-right-handed", "3D-right-handed" }, { 1, 1, 1 }, false },
		{ { "3D-left-handed", "3D-left-handed" }, { 1, 1, 1 }, false },
	};
	for (size_t i = 0; i < sizeof spaces / sizeof spaces[0]; i++) {
		if (strcasecmp(value, spaces[i].names[0]) == 0 ||
		    strcasecmp(value, spaces[i].names[1]) == 0) {
			memcpy(nrrd->sign, spaces[i].sign, sizeof nrrd->sign);
			nrrd->anatomical = spaces[i].anatomical;
			return GZ_OK;
		}
	}
	return refuse_nrrd_unsupported(nrrd, "space",
				       "not read; RAS, LAS and LPS in three dimensions "
				       "are");
}

static enum gz_result take_nrrd_space_dimension(struct nrrd *nrrd, char *value)
{
	int dimension = 0;
	if (!gz_text_wholes(value, &dimension, 1) || dimension != 3)
		return refuse_nrrd_unsupported(nrrd, "space dimension", "only 3 is read");
	return GZ_OK;
}

static enum gz_result take_nrrd_endian(struct nrrd *nrrd, char *value)
{
	nrrd->layout.big_endian = strcasecmp(value, "big") == 0;
	nrrd->has_endian = true;
	if (!nrrd->layout.big_endian && strcasecmp(value, "little") != 0)
		return refuse_nrrd(nrrd, "endian", "write little or big");
	return GZ_OK;
}

/* Section 5.1, "encoding". */
static enum gz_result take_nrrd_encoding(struct nrrd *nrrd, char *value)
{
	static const struct {
		const char *name;
		enum gz_coding coding;
		enum gz_spelling spelling;
	} encodings[] = {
		{ "raw", GZ_CODING_PLAIN, GZ_SPELLING_BINARY },
		{ "txt", GZ_CODING_PLAIN, GZ_SPELLING_TEXT },
		{ "text", GZ_CODING_PLAIN, GZ_SPELLING_TEXT },
		{ "ascii", GZ_CODING_PLAIN, GZ_SPELLING_TEXT },
		{ "hex", GZ_CODING_PLAIN, GZ_SPELLING_HEX },
		{ "gz", GZ_CODING_ZLIB, GZ_SPELLING_BINARY },
		{ "gzip", GZ_CODING_ZLIB, GZ_SPELLING_BINARY },
		{ "bz2", GZ_CODING_BZIP2, GZ_SPELLING_BINARY },
		{ "bzip2", GZ_CODING_BZIP2, GZ_SPELLING_BINARY },
	};
	for (size_t i = 0; i < sizeof encodings / sizeof encodings[0]; i++) {
		if (strcasecmp(value, encodings[i].name) != 0)
			continue;
		nrrd->has_encoding = true;
		nrrd->source.coding = encodings[i].coding;
		nrrd->source.spelling = encodings[i].spelling;
		return GZ_OK;
	}
	return refuse_nrrd_unsupported(nrrd, "encoding",
				       "not read; raw, txt, hex, gzip and bzip2 are");
}

/* Section 6, "data file": one, a pattern, or a list, which is the rest of the header. */
static enum gz_result take_nrrd_data_file(struct nrrd *nrrd, char *value)
{
	nrrd->detached = true;
	if (gz_voxel_files_named(value))
		return gz_voxel_files_take(&nrrd->source.files, &nrrd->head, value, "data file",
					   &nrrd->file_axes);
	if (!*value || gz_path_beside(nrrd->head.path, value, nrrd->source.path,
				      sizeof nrrd->source.path) != GZ_OK)
		return refuse_nrrd(nrrd, "data file", "no name, or one too long");
	return GZ_OK;
}

static enum gz_result take_nrrd_line_skip(struct nrrd *nrrd, char *value)
{
	if (!gz_text_wholes(value, &nrrd->source.line_skip, 1) || nrrd->source.line_skip < 0)
		return refuse_nrrd(nrrd, "line skip", "must be a whole number, 0 or more");
	return GZ_OK;
}

static enum gz_result take_nrrd_byte_skip(struct nrrd *nrrd, char *value)
{
	long long skip;
	char *word = gz_number_next_word(&value, BLANKS);
	if (!word || !gz_number_parse_whole(word, &skip) || skip < GZ_SKIP_TO_END ||
	    gz_number_next_word(&value, BLANKS))
		return refuse_nrrd(nrrd, "byte skip", "must be a whole number, -1 or more");
	nrrd->source.skip = skip;
	return GZ_OK;
}

/* Numbers of a kind of colours that is read; 0 for other kinds. */
static int colour_channels_of(const char *kind)
{
	static const struct {
		const char *kind;
		int channels;
	} colours[] = {
		{ "RGB-color", 3 },
		{ "RGBA-color", 4 },
		{ "3-color", 3 },
		{ "4-color", 4 },
	};
	for (size_t i = 0; i < sizeof colours / sizeof colours[0]; i++)
		if (strcasecmp(kind, colours[i].kind) == 0)
			return colours[i].channels;
	return 0;
}

static void take_first_kind(struct nrrd *nrrd, const char *kind)
{
	static const char *const through_space[] = { "domain", "space", "none", "???" };
	enum { KNOWN = 2 }; /* of these */
	nrrd->values_first = nrrd->has_first_kind = true;
	nrrd->colour_channels = colour_channels_of(kind);
	for (size_t i = 0; i < sizeof through_space / sizeof through_space[0]; i++)
		if (strcasecmp(kind, through_space[i]) == 0) {
			nrrd->values_first = false;
			nrrd->has_first_kind = i < KNOWN;
		}
}

/* Section 5.1, "kinds": whether the first axis runs within a value rather than through space. */
static enum gz_result take_nrrd_kinds(struct nrrd *nrrd, char *value)
{
	const char *kind = gz_number_next_word(&value, BLANKS);
	nrrd->values_first = nrrd->has_first_kind = nrrd->colour_later = false;
	nrrd->colour_channels = 0;
	if (kind)
		take_first_kind(nrrd, kind);
	while (kind && (kind = gz_number_next_word(&value, BLANKS)))
		nrrd->colour_later |= colour_channels_of(kind) > 0;
	return GZ_OK;
}

/* Section 5.1, "units", and 5.2, "space units": names in quotes; without them, words. */
static void take_quoted_names(char *value, char (*names)[UNIT_SIZE], int count)
{
	for (int i = 0; i < count; i++) {
		const char *name;
		value += strspn(value, BLANKS);
		if (*value == '"') {
			name = value + 1;
			value += 1 + strcspn(name, "\"");
			if (*value)
				*value++ = '\0';
		} else {
			name = gz_number_next_word(&value, BLANKS);
		}
		snprintf(names[i], UNIT_SIZE, "%s", name ? name : "");
	}
}

static enum gz_result take_nrrd_units(struct nrrd *nrrd, char *value)
{
	take_quoted_names(value, nrrd->units, nrrd->dimension);
	return GZ_OK;
}

static enum gz_result take_nrrd_space_units(struct nrrd *nrrd, char *value)
{
	take_quoted_names(value, nrrd->space_units, 3);
	return GZ_OK;
}

struct field {
	const char *names[2];
	bool needs_dimension;
	enum gz_result (*take)(struct nrrd *nrrd, char *value);
};

/* Fields that say nothing of layout (content, labels, …) are passed over. */
static const struct field fields[] = {
	{ { "type", "type" }, false, take_nrrd_type },
	{ { "dimension", "dimension" }, false, take_nrrd_dimension },
	{ { "sizes", "sizes" }, true, take_nrrd_sizes },
	{ { "spacings", "spacings" }, true, take_nrrd_spacings },
	{ { "space", "space" }, false, take_nrrd_space },
	{ { "space dimension", "space dimension" }, false, take_nrrd_space_dimension },
	{ { "space directions", "space directions" }, true, take_nrrd_directions },
	{ { "units", "units" }, true, take_nrrd_units },
	{ { "space units", "space units" }, false, take_nrrd_space_units },
	{ { "kinds", "kinds" }, false, take_nrrd_kinds },
	{ { "endian", "endian" }, false, take_nrrd_endian },
	{ { "encoding", "encoding" }, false, take_nrrd_encoding },
	{ { "data file", "datafile" }, false, take_nrrd_data_file },
	{ { "line skip", "lineskip" }, false, take_nrrd_line_skip },
	{ { "byte skip", "byteskip" }, false, take_nrrd_byte_skip },
};

/* Our own key: directions have some length, even if it is assumed. */
#define ASSUMED_SPACING "gazecast_spacing:=assumed"

static enum gz_result take_nrrd_line(struct nrrd *nrrd, char *line)
{
	char *colon = strchr(line, ':');
	if (line[0] == '#')
		return GZ_OK;
	if (colon && colon[1] == '=') {
		nrrd->has_assumed_spacing |= strcmp(line, ASSUMED_SPACING) == 0;
		return GZ_OK;
	}
	if (!colon)
		return refuse_nrrd(nrrd, line,
				   "neither a field nor a comment; write \"field: value\"");
	*colon = '\0';
	const char *name = gz_text_trim(line);
	for (size_t i = 0; i < sizeof fields / sizeof fields[0]; i++) {
		if (strcasecmp(name, fields[i].names[0]) != 0 &&
		    strcasecmp(name, fields[i].names[1]) != 0)
			continue;
		if (fields[i].needs_dimension && nrrd->dimension == 0)
			return refuse_nrrd(nrrd, name, "comes before dimension; put it below");
		return fields[i].take(nrrd, gz_text_trim(colon + 1));
	}
	return GZ_OK;
}

/* Up to the blank line, or, in a header of its own, the end of the file. */
static enum gz_result read_nrrd_fields(struct nrrd *nrrd)
{
	char *line = gz_text_head_line(&nrrd->head);
	if (!line || strncmp(line, "NRRD000", 7) != 0)
		return refuse_nrrd(nrrd, "NRRD", "no magic word; is it really an NRRD file?");
	if (line[7] < '1' || line[7] > '5' || line[8])
		return refuse_nrrd_unsupported(nrrd, "NRRD", "versions 1 to 5 are read");
	while ((line = gz_text_head_line(&nrrd->head)) && *line) {
		enum gz_result result = take_nrrd_line(nrrd, line);
		if (result != GZ_OK)
			return result;
	}
	if (!line && !nrrd->detached)
		return refuse_nrrd(nrrd, "header",
				   "no blank line ends it within 256 KiB; is the file cut off?");
	return GZ_OK;
}

static enum gz_result check_nrrd_complete(struct nrrd *nrrd)
{
	if (!nrrd->dimension || !nrrd->has_type || !nrrd->has_sizes || !nrrd->has_encoding)
		return refuse_nrrd(nrrd, "header",
				   "type, dimension, sizes and encoding must be given");
	if (gz_raw_type_size(nrrd->layout.type) > 1 && !nrrd->has_endian &&
	    nrrd->source.spelling != GZ_SPELLING_TEXT)
		return refuse_nrrd(nrrd, "header", "endian must be given for this type");
	return GZ_OK;
}

/* The first of the three axes that run through space. */
static int first_space_axis(const struct nrrd *nrrd)
{
	const bool placeless = nrrd->has_spacings && isnan(nrrd->spacings[0]);
	int first = nrrd->values_first || (placeless && nrrd->dimension > 3) ? 1 : 0;
	if (nrrd->has_directions)
		for (first = 0; first < nrrd->dimension && isnan(nrrd->directions[first][0]);)
			first++;
	return first;
}

/* Numbers of a colour, if the first axis holds colours: it says so, or three or four bytes are not
 * said to be anything else. Else 0. */
static int nrrd_colour_axis(const struct nrrd *nrrd)
{
	const int size = nrrd->sizes[0];
	if (nrrd->colour_channels > 0)
		return size == nrrd->colour_channels ? size : 0;
	const bool maybe = !nrrd->has_first_kind && nrrd->layout.type == GZ_RAW_UINT8;
	if (!maybe || (size != 3 && size != 4))
		return 0;
	gz_info(nrrd->head.log,
		"%s: its first axis has %d numbers and no place in space; taken as colours",
		nrrd->head.path, size);
	return size;
}

/* What comes before the axes through space: nothing, axes of one number, or a colour. */
static enum gz_result take_nrrd_values(struct nrrd *nrrd, int first)
{
	if (nrrd->colour_later || (nrrd->colour_channels > 0 && first == 0))
		return refuse_nrrd_unsupported(
			nrrd, "kinds",
			"colours must be the first axis, which has no direction in space; unu "
			"permute moves axes");
	if (first > 0 && nrrd->dimension > 3)
		nrrd->layout.channels = nrrd_colour_axis(nrrd);
	for (int i = nrrd->layout.channels > 0 ? 1 : 0; i < first && i < nrrd->dimension; i++)
		if (nrrd->sizes[i] != 1)
			return refuse_nrrd_unsupported(
				nrrd, "sizes",
				"several numbers a voxel; read are one, and three or four as a "
				"colour");
	return GZ_OK;
}

/* What turns lengths in three units into mm. A unit is told once. */
static void take_lengths(const struct nrrd *nrrd, const char (*units)[UNIT_SIZE], double mm[3])
{
	mm[0] = gz_length_unit_take(units[0], nrrd->head.path, nrrd->head.log);
	for (int i = 1; i < 3; i++) {
		const bool told = strcmp(units[i], units[i - 1]) == 0;
		mm[i] = told ? mm[i - 1]
			     : gz_length_unit_take(units[i], nrrd->head.path, nrrd->head.log);
	}
}

/* Spacing and directions of the three axes from `first` on. */
static void place_nrrd_axes(struct nrrd *nrrd, int first)
{
	struct gz_import_layout *layout = &nrrd->layout;
	double mm[3];
	if (!nrrd->has_directions) {
		layout->spacing_assumed = !nrrd->has_spacings;
		take_lengths(nrrd, (const char(*)[UNIT_SIZE])nrrd->units + first, mm);
		for (int axis = 0; axis < 3; axis++)
			layout->spacing[axis] =
				(nrrd->has_spacings ? nrrd->spacings[first + axis] : 1) * mm[axis];
		return;
	}
	take_lengths(nrrd, (const char(*)[UNIT_SIZE])nrrd->space_units, mm);
	for (int axis = 0; axis < 3; axis++) {
		double d[3];
		for (int i = 0; i < 3; i++)
			d[i] = mm[i] * nrrd->directions[first + axis][i];
		layout->spacing[axis] = gz_length3(d);
		for (int i = 0; i < 3; i++)
			layout->direction[axis][i] = nrrd->sign[i] * d[i];
	}
	layout->oriented = nrrd->anatomical;
	layout->spacing_assumed = nrrd->has_assumed_spacing;
}

static enum gz_result choose_nrrd_axes(struct nrrd *nrrd)
{
	const int first = first_space_axis(nrrd);
	const enum gz_result values = take_nrrd_values(nrrd, first);
	if (values != GZ_OK)
		return values;
	if (first + 3 > nrrd->dimension)
		return refuse_nrrd_unsupported(nrrd, "sizes",
					       "fewer than three axes through space");
	nrrd->layout.time_points = first + 3 < nrrd->dimension ? nrrd->sizes[first + 3] : 1;
	for (int i = first + 4; i < nrrd->dimension; i++)
		nrrd->layout.more_follows |= nrrd->sizes[i] != 1;
	if (nrrd->layout.more_follows)
		gz_warn(nrrd->head.log, "%s: has a fifth dimension; only its first part is shown",
			nrrd->head.path);
	memcpy(nrrd->layout.dims, nrrd->sizes + first, sizeof nrrd->layout.dims);
	place_nrrd_axes(nrrd, first);
	return GZ_OK;
}

/* Where the voxels are: behind the header, in a file, or in several files beside the header. */
static enum gz_result place_nrrd_data(struct nrrd *nrrd)
{
	struct gz_voxel_source *source = &nrrd->source;
	if (!nrrd->detached)
		source->offset = nrrd->head.at;
	if (!nrrd->detached || source->files.count > 0) {
		const enum gz_result result =
			gz_path_beside("", nrrd->head.path, source->path, sizeof source->path);
		if (result != GZ_OK)
			return result;
	}
	return gz_voxel_source_share(source, &nrrd->head, nrrd->sizes, nrrd->dimension,
				     nrrd->file_axes);
}

static enum gz_result load_nrrd(const struct gz_volume_file *file, struct gz_volume *out_volume)
{
	struct nrrd nrrd = { .layout = gz_import_layout_default(), .sign = { 1, 1, 1 } };
	enum gz_result result = gz_text_head_open(&nrrd.head, file->path, file->log);
	if (result == GZ_OK)
		result = read_nrrd_fields(&nrrd);
	if (result == GZ_OK)
		result = check_nrrd_complete(&nrrd);
	if (result == GZ_OK)
		result = choose_nrrd_axes(&nrrd);
	if (result == GZ_OK)
		result = place_nrrd_data(&nrrd);
	if (result == GZ_OK)
		result = gz_voxel_source_import(&nrrd.source, &nrrd.layout, file, out_volume);
	gz_voxel_source_free(&nrrd.source);
	gz_text_head_free(&nrrd.head);
	return result;
}

/* Chosen: large beside the cost of a call, a moment on any disk. */
#define CHUNK_VOXELS ((size_t)1 << 21)

enum { HEADER_SIZE = 512 };

/* What the voxels are written as. */
struct nrrd_form {
	const char *name; /* of NRRD's type */
	size_t size;
	double least, greatest;
};

static const struct nrrd_form integers[] = {
	{ "int8", 1, INT8_MIN, INT8_MAX },    { "uint8", 1, 0, UINT8_MAX },
	{ "int16", 2, INT16_MIN, INT16_MAX }, { "uint16", 2, 0, UINT16_MAX },
	{ "int32", 4, INT32_MIN, INT32_MAX }, { "uint32", 4, 0, UINT32_MAX },
};

/* Integers up to this magnitude are floats. */
#define FLOAT_EXACT_MOST 0x1p24

static const struct nrrd_form floats = { "float", sizeof(float), -DBL_MAX, DBL_MAX };

/* Whether every stored number is whole. */
static bool are_stored_whole(const struct gz_volume *volume)
{
	const float *voxels = volume->voxels;
	const size_t count = volume->type == GZ_VOXEL_F32 ? gz_volume_voxel_count(volume) : 0;
	size_t broken = 0;
	for (size_t i = 0; i < count; i++)
		broken += voxels[i] != rintf(voxels[i]);
	return broken == 0;
}

/* NRRD cannot say that values are scaled, so that they are written as they are: as integers of the
 * width they are stored in, or a greater one, where all of them are such, else as floats. Integers
 * of 32 bits are written only where floats would round them. */
static const struct nrrd_form *nrrd_form_of(const struct gz_volume *volume)
{
	const double low = volume->stored_min + volume->intercept;
	const double high = volume->stored_max + volume->intercept;
	const bool needs_32 = fmax(fabs(low), fabs(high)) > FLOAT_EXACT_MOST;
	if ((volume->type == GZ_VOXEL_F32 && (!needs_32 || volume->intercept == 0)) ||
	    volume->slope != 1 || volume->intercept != rint(volume->intercept))
		return &floats;
	for (size_t i = 0; i < sizeof integers / sizeof integers[0]; i++) {
		const struct nrrd_form *form = &integers[i];
		const bool is_signed = form->least<0, wide = form->size> 2;
		if (form->size >= gz_voxel_size(volume->type) && low >= form->least &&
		    high <= form->greatest && is_signed == (volume->intercept < 0) &&
		    wide == needs_32)
			return are_stored_whole(volume) ? form : &floats;
	}
	return &floats;
}

/* Numbers of a voxel. Alpha is written only if values are alpha; it is not kept otherwise. */
static size_t written_channels(const struct gz_volume *volume)
{
	return volume->colour == GZ_COLOUR_NONE ? 1 : volume->colour == GZ_COLOUR_ALPHA ? 4 : 3;
}

static int print_nrrd_header(const struct gz_volume *volume, const struct nrrd_form *form,
			     char *out, size_t size)
{
	static const struct {
		const char *dimension, *kinds, *size, *direction;
	} axes[] = {
		[1] = { "3", "", "", "" },
		[3] = { "4", "kinds: RGB-color domain domain domain\n", "3 ", "none " },
		[4] = { "4", "kinds: RGBA-color domain domain domain\n", "4 ", "none " },
	};
	const size_t channels = written_channels(volume);
	const int *dims = volume->dims;
	const double *s = volume->spacing;
	char space[64], directions[128];
	snprintf(space, sizeof space, "%s",
		 volume->oriented ? "space: right-anterior-superior\n" : "space dimension: 3\n");
	snprintf(directions, sizeof directions,
		 "space directions: %s(%.17g,0,0) (0,%.17g,0) (0,0,%.17g)\n",
		 axes[channels].direction, s[0], s[1], s[2]);
	/* What is not known is not stated, except that directions have some length. */
	const bool placed = volume->oriented || !volume->spacing_assumed;
	const bool assumed = volume->oriented && volume->spacing_assumed;
	return snprintf(out, size,
			"NRRD0005\ntype: %s\ndimension: %s\n%ssizes: %s%d %d %d\n%s%s"
			"endian: %s\nencoding: raw\n%s\n",
			form->name, axes[channels].dimension, placed ? space : "",
			axes[channels].size, dims[0], dims[1], dims[2], placed ? directions : "",
			axes[channels].kinds, gz_host_big_endian() ? "big" : "little",
			assumed ? ASSUMED_SPACING "\n" : "");
}

static void convert_to_colours(const struct gz_volume *volume, size_t first, size_t count,
			       uint8_t *out)
{
	const uint8_t *alpha = volume->voxels;
	for (size_t i = first; i < first + count; i++) {
		for (int channel = 0; channel < 3; channel++)
			*out++ = gz_colour_byte(volume->colours[i], channel);
		if (volume->colour == GZ_COLOUR_ALPHA)
			*out++ = alpha[i];
	}
}

/* Values as `form` has them. Negative ones keep their two's complement. */
static void convert_to_form(const struct gz_volume *volume, const struct nrrd_form *form,
			    size_t first, size_t count, uint8_t *out)
{
	for (size_t i = 0; i < count; i++) {
		const double value =
			volume->slope * gz_voxel_stored(volume->type, volume->voxels, first + i) +
			volume->intercept;
		const float real = (float)value;
		const uint32_t word = form == &floats ? 0 : (uint32_t)(int64_t)value;
		const uint16_t half = (uint16_t)word;
		if (form == &floats)
			memcpy(out + i * sizeof real, &real, sizeof real);
		else if (form->size == sizeof word)
			memcpy(out + i * sizeof word, &word, sizeof word);
		else if (form->size == sizeof half)
			memcpy(out + i * sizeof half, &half, sizeof half);
		else
			out[i] = (uint8_t)word;
	}
}

static enum gz_result write_nrrd_voxels(const struct gz_part_file *file,
					const struct gz_volume *volume,
					const struct nrrd_form *form, uint64_t offset,
					const struct gz_loading *loading)
{
	const size_t count = gz_volume_voxel_count(volume);
	const size_t size = form->size * written_channels(volume);
	uint8_t *chunk = malloc(CHUNK_VOXELS * size);
	enum gz_result result = chunk ? GZ_OK : GZ_ERR_NO_MEM;
	for (size_t at = 0; at < count && result == GZ_OK; at += CHUNK_VOXELS) {
		const size_t part = count - at < CHUNK_VOXELS ? count - at : CHUNK_VOXELS;
		if (!gz_loading_goes_on(loading, (double)at / (double)count, file->path)) {
			result = GZ_ERR_CANCELLED;
			break;
		}
		if (volume->colour == GZ_COLOUR_NONE)
			convert_to_form(volume, form, at, part, chunk);
		else
			convert_to_colours(volume, at, part, chunk);
		result = gz_part_file_write(file, chunk, part * size, offset + at * size);
	}
	free(chunk);
	return result;
}

enum gz_result gz_nrrd_write(const struct gz_volume *volume, const char *path,
			     const struct gz_loading *loading, const struct gz_log *log)
{
	char header[HEADER_SIZE];
	struct gz_part_file file;
	if (!volume->voxels)
		return GZ_ERR_INVAL;
	const struct nrrd_form *form = nrrd_form_of(volume);
	const int length = print_nrrd_header(volume, form, header, sizeof header);
	if (length < 0 || (size_t)length >= sizeof header)
		return GZ_ERR_INVAL;
	enum gz_result result = gz_part_file_open(&file, path, log);
	if (result == GZ_OK)
		result = gz_part_file_write(&file, header, (size_t)length, 0);
	if (result == GZ_OK)
		result = write_nrrd_voxels(&file, volume, form, (uint64_t)length, loading);
	return gz_part_file_close(&file, result);
}

static bool nrrd_knows_start(const struct gz_file_start *start)
{
	return start->coding == GZ_CODING_PLAIN && gz_file_start_has(start, 0, "NRRD000", 7);
}

const struct gz_volume_format gz_format_nrrd = {
	.name = "NRRD",
	.endings = { ".nrrd", ".nhdr" },
	.layout = GZ_LAYOUT_IN_FILE,
	.knows_start = nrrd_knows_start,
	.load = load_nrrd,
	.write = gz_nrrd_write,
	.limits = "one number a voxel, integers of up to 32 bits, or colours of 8 or 16 bits along "
		  "the first axis; of a fifth dimension only the first",
};
