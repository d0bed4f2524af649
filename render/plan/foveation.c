#include "render/plan/foveation.h"

#include <string.h>

#include "base/text.h"
#include "render/picture/image.h"
#include "render/plan/method.h"

#define GZ_LOG_MODULE "plan"

const char *const gz_step_rule_names[] = { "method", "none", "distance", "acuity", NULL };

const char *const gz_step_phase_names[] = { "lit", "aligned", "interleaved", NULL };

const char *const gz_filter_names[] = { "catmull_rom", "bilinear", NULL };

#define AT(field) offsetof(struct gz_foveation, field)

const struct gz_option gz_foveation_options[] = {
	{ "foveation.method", GZ_OPTION_CHOICE, AT(method), .choices = gz_method_names,
	  .preset = "acuity", .help = "foveation method" },
	{ "foveation.step_rule", GZ_OPTION_CHOICE, AT(step_rule), .choices = gz_step_rule_names,
	  .preset = "method", .help = "how steps along a ray grow away from the gaze" },
	{ "foveation.step_phase", GZ_OPTION_CHOICE, AT(step_phase), .choices = gz_step_phase_names,
	  .preset = "interleaved",
	  .help = "samples of neighbouring rays with longer steps: aligned, interleaved, or "
		  "interleaved where surfaces are lit" },
	{ "foveation.reconstruction", GZ_OPTION_CHOICE, AT(filter), .choices = gz_filter_names,
	  .preset = "catmull_rom",
	  .help = "acuity, table, contrast: filter that fills the pixels between rays" },
	{ "foveation.acuity_slope", GZ_OPTION_DOUBLE, AT(acuity_slope), 0.001, 1, .preset = "0.022",
	  .help = "loss of acuity: degrees per cycle for each degree of eccentricity" },
	/* The preset is 1/48. */
	{ "foveation.acuity_foveal_deg", GZ_OPTION_DOUBLE, AT(acuity_foveal_deg), 0.001, 1,
	  .preset = "0.020833333333333332",
	  .help = "smallest cycle that the eye resolves at the gaze, degrees" },
	{ "foveation.acuity_full_deg", GZ_OPTION_DOUBLE, AT(acuity_full_deg), 0, 180,
	  .preset = "2.5", /* the fovea, docs/units.md */
	  .help = "acuity, contrast: how far from the gaze every pixel has a ray, even where "
		  "pixels "
		  "are finer than the eye resolves, degrees" },
	/* Both presets are chosen by docs/results.md: objects beside the gaze are calmer. */
	{ "foveation.acuity_far_deg", GZ_OPTION_DOUBLE, AT(acuity_far_deg), 0.1, 179, .preset = "5",
	  .help = "acuity, contrast: from how many degrees on the distance of rays grows less" },
	{ "foveation.acuity_far_share", GZ_OPTION_DOUBLE, AT(acuity_far_share), 0, 1,
	  .preset = "0.5",
	  .help = "acuity, contrast: how much the distance of rays grows there, as a share of "
		  "acuity_slope" },
	{ "foveation.acuity_step_growth", GZ_OPTION_DOUBLE, AT(acuity_step_growth), 0, 1,
	  .preset = "1",
	  .help = "how fast steps may grow away from the gaze by acuity: 0 = not at all, 1 = up to "
		  "eightfold" },
	{ "foveation.acuity_step_error", GZ_OPTION_DOUBLE, AT(acuity_step_error), 0.0001, 1,
	  .preset = "0.0125",
	  .help = "how much of a picture's light longer steps may change: they grow less if data "
		  "and transfer function are sharp; 1 = they grow as acuity_step_growth says" },
	{ "foveation.still_growth", GZ_OPTION_DOUBLE, AT(still_growth), 0, 4, .preset = "0",
	  .help = "acuity, contrast, table: rays that each further picture adds while nothing but "
		  "the gaze changes, as a share of the method's own, until every pixel has one; "
		  "0 = none" },
	{ "foveation.edge_contrast", GZ_OPTION_DOUBLE, AT(edge_contrast), 0.01, 1, .preset = "1",
	  .help = "acuity: rays that differ by this contrast or more from their neighbours are at "
		  "an edge, which gets finer rays; 1 = no edge does" },
	{ "foveation.edge_finest", GZ_OPTION_DOUBLE, AT(edge_finest), 0.25, 1, .preset = "0.5",
	  .help = "acuity: how near to each other rays are at such edges, as a multiple of what "
		  "the eye resolves" },
	/* The preset is Geisler and Perry's 1/64. */
	{ "foveation.contrast_threshold", GZ_OPTION_DOUBLE, AT(contrast_threshold), 0.0001, 1,
	  .preset = "0.015625", .help = "contrast: least contrast that is seen at the gaze" },
	{ "foveation.contrast_first", GZ_OPTION_DOUBLE, AT(contrast_first), 1, 8, .preset = "4",
	  .help = "contrast: how far apart the first rays are outside the fovea, as a multiple of "
		  "what the eye resolves" },
	{ "foveation.contrast_finest", GZ_OPTION_DOUBLE, AT(contrast_finest), 0.25, 1,
	  .preset = "1",
	  .help = "contrast: how near to each other rays may come at edges, as a multiple of what "
		  "the eye resolves" },
	{ "foveation.contrast_rounds", GZ_OPTION_INT, AT(contrast_rounds), 1, 4, .preset = "2",
	  .help = "contrast: most rounds of rays for a picture" },
	{ "foveation.mdc_square_px", GZ_OPTION_DOUBLE, AT(mdc_square_px), 1, GZ_IMAGE_SIDE_MAX,
	  .preset = "350", .help = "mdc, mdc3: edge of the fine square, px" },
	{ "foveation.mdc_spacing", GZ_OPTION_INT, AT(mdc_spacing), 1, GZ_SPACING_MAX, .preset = "2",
	  .help = "mdc, mdc3: spacing outside the square, px" },
	{ "foveation.mdc3_square_px", GZ_OPTION_DOUBLE, AT(mdc3_square_px), 1, GZ_IMAGE_SIDE_MAX,
	  .preset = "900",
	  .help = "mdc3: edge of the square around which the third region lies, px" },
	{ "foveation.mdc3_spacing", GZ_OPTION_INT, AT(mdc3_spacing), 1, GZ_SPACING_MAX,
	  .preset = "4", .help = "mdc3: spacing in the third region, px" },
	{ "foveation.ddc_inner_px", GZ_OPTION_DOUBLE, AT(ddc_inner_px), 1, GZ_IMAGE_SIDE_MAX,
	  .count = 2, .preset = "200 160", .help = "ddc: semi-axes of the inner ellipse, px" },
	{ "foveation.ddc_middle_px", GZ_OPTION_DOUBLE, AT(ddc_middle_px), 1, GZ_IMAGE_SIDE_MAX,
	  .count = 2, .preset = "480 380", .help = "ddc: semi-axes of the middle ellipse, px" },
	{ "foveation.ddc_spacing", GZ_OPTION_INT, AT(ddc_spacing), 1, GZ_SPACING_MAX, .count = 3,
	  .preset = "1 2 7", .help = "ddc: spacing of the inner, middle and outer region, px" },
	{ "foveation.blend_px", GZ_OPTION_DOUBLE, AT(blend_px), 0, 1000, .preset = "0",
	  .help = "mdc, mdc3, ddc: width of the band in which a region fades into the next, px; "
		  "0 = a hard border" },
	{ "foveation.uniform_spacing", GZ_OPTION_INT, AT(uniform_spacing), 1, GZ_SPACING_MAX,
	  .preset = "2", .help = "uniform: spacing everywhere, px" },
	{ "foveation.step_floor", GZ_OPTION_DOUBLE, AT(step_floor), 0.0625, 1, .preset = "0.25",
	  .help = "distance rule: least share of the scene's sampling rate" },
	{ "foveation.table", GZ_OPTION_STRING, AT(table_file), .max = GZ_PATH_SIZE, .preset = "",
	  .help = "table: file of spacings and steps by eccentricity; searched beside the scene, "
		  "then under $GAZECAST_DATA" },
};
const size_t gz_foveation_option_count =
	sizeof gz_foveation_options / sizeof gz_foveation_options[0];

struct gz_foveation gz_foveation_default(void)
{
	struct gz_foveation foveation = { 0 };
	const struct gz_option_binding binding = { gz_foveation_options, gz_foveation_option_count,
						   &foveation, NULL };
	gz_options_preset(&binding);
	return foveation;
}

bool gz_spacing_table_same(const struct gz_spacing_table *a, const struct gz_spacing_table *b)
{
	if (a->count != b->count || a->in_deg != b->in_deg)
		return false;
	for (int i = 0; i < a->count; i++) {
		const struct gz_spacing_row *one = &a->rows[i], *other = &b->rows[i];
		if (one->eccentricity_deg != other->eccentricity_deg ||
		    one->spacing != other->spacing || one->step != other->step)
			return false;
	}
	return true;
}

bool gz_foveation_same(const struct gz_foveation *a, const struct gz_foveation *b)
{
	return gz_options_same(gz_foveation_options, gz_foveation_option_count, a, b) &&
	       gz_spacing_table_same(&a->table, &b->table);
}

struct gz_foveation gz_foveation_full(void)
{
	struct gz_foveation foveation = gz_foveation_default();
	foveation.method = gz_method_full();
	return foveation;
}

bool gz_foveation_valid(const struct gz_foveation *foveation)
{
	return gz_options_hold(gz_foveation_options, gz_foveation_option_count, foveation) &&
	       (!gz_method_of(foveation)->needs_table || gz_spacing_table_valid(&foveation->table));
}

bool gz_foveation_follows_gaze(const struct gz_foveation *foveation)
{
	return gz_method_of(foveation)->follows_gaze || foveation->step_rule == GZ_STEP_DISTANCE ||
	       foveation->step_rule == GZ_STEP_ACUITY;
}

/* Tables of spacings from text. docs/scenes.md has the grammar. */

#define BLANKS    " \t\r"
#define LINE_SIZE 256
/* Chosen: ten times what GZ_SPACING_TABLE_MAX rows and their comments need. */
#define FILE_SIZE_MAX ((size_t)1 << 16)

struct spacing_table_parser {
	const char *name;
	const struct gz_log *log;
	int line;
	bool has_unit;
	struct gz_spacing_table table;
};

/* Range of each column. */
static const struct {
	const char *name;
	double min, max;
	const char *allowed;
} spacing_columns[3] = {
	{ "eccentricity", 0, 180, "out of range; allowed: 0 to 180 degrees" },
	{ "spacing", 0.001, 1000, "out of range; allowed: 0.001 to 1000" },
	{ "step", 1, 16, "out of range; allowed: 1 to 16" },
};

static enum gz_result refuse_spacing_table(const struct spacing_table_parser *parser,
					   const char *key, const char *what)
{
	gz_err(parser->log, "%s:%d: %.40s: %s", parser->name, parser->line, key, what);
	return GZ_ERR_FORMAT;
}

static enum gz_result parse_unit(struct spacing_table_parser *parser, char *rest)
{
	const char *word = gz_number_next_word(&rest, BLANKS);
	if (parser->has_unit)
		return refuse_spacing_table(parser, "unit", "given twice; keep one");
	if (!word || gz_number_next_word(&rest, BLANKS) ||
	    (strcmp(word, "px") != 0 && strcmp(word, "deg") != 0))
		return refuse_spacing_table(parser, "unit", "write px or deg");
	parser->has_unit = true;
	parser->table.in_deg = strcmp(word, "deg") == 0;
	return GZ_OK;
}

static enum gz_result append_spacing_row(struct spacing_table_parser *parser,
					 const double numbers[3])
{
	struct gz_spacing_table *table = &parser->table;
	if (table->count == GZ_SPACING_TABLE_MAX)
		return refuse_spacing_table(parser, "row", "one too many; at most 64 are read");
	if (table->count > 0) {
		const struct gz_spacing_row *above = &table->rows[table->count - 1];
		if (numbers[0] <= above->eccentricity_deg)
			return refuse_spacing_table(
				parser, "eccentricity",
				"not above the previous row's; write rows in rising order");
		if (numbers[1] < above->spacing || numbers[2] < above->step)
			return refuse_spacing_table(
				parser, numbers[1] < above->spacing ? "spacing" : "step",
				"below the previous row's; it must not fall outwards");
	}
	table->rows[table->count++] = (struct gz_spacing_row) {
		.eccentricity_deg = numbers[0],
		.spacing = numbers[1],
		.step = numbers[2],
	};
	return GZ_OK;
}

static enum gz_result parse_spacing_row(struct spacing_table_parser *parser, const char *first,
					char *rest)
{
	double numbers[3];
	if (!gz_number_parse(first, &numbers[0]))
		return refuse_spacing_table(
			parser, first,
			"unknown word; write a row \"eccentricity_deg spacing step\" or unit");
	for (int i = 1; i < 3; i++) {
		const char *word = gz_number_next_word(&rest, BLANKS);
		if (!word || !gz_number_parse(word, &numbers[i]))
			return refuse_spacing_table(
				parser, "row",
				"write three numbers: eccentricity_deg spacing step");
	}
	if (gz_number_next_word(&rest, BLANKS))
		return refuse_spacing_table(parser, "row",
					    "more than three numbers; write one row a line");
	for (int i = 0; i < 3; i++)
		if (!(numbers[i] >= spacing_columns[i].min && numbers[i] <= spacing_columns[i].max))
			return refuse_spacing_table(parser, spacing_columns[i].name,
						    spacing_columns[i].allowed);
	return append_spacing_row(parser, numbers);
}

static enum gz_result parse_spacing_line(struct spacing_table_parser *parser, const char *text,
					 size_t size)
{
	char line[LINE_SIZE];
	const char *comment = memchr(text, '#', size);
	const size_t used = comment ? (size_t)(comment - text) : size;
	if (memchr(text, '\0', used))
		return refuse_spacing_table(parser, "line", "has a NUL byte; is this a text file?");
	if (used >= LINE_SIZE)
		return refuse_spacing_table(parser, "line", "longer than 255 bytes; shorten it");
	memcpy(line, text, used);
	line[used] = '\0';
	char *rest = line;
	const char *word = gz_number_next_word(&rest, BLANKS);
	if (!word)
		return GZ_OK;
	return strcmp(word, "unit") == 0 ? parse_unit(parser, rest)
					 : parse_spacing_row(parser, word, rest);
}

enum gz_result gz_spacing_table_parse(const char *name, const char *text, size_t size,
				      const struct gz_log *log, struct gz_spacing_table *out_table)
{
	struct spacing_table_parser parser = { .name = name, .log = log };
	for (size_t at = 0; at < size;) {
		const char *end = memchr(text + at, '\n', size - at);
		const size_t length = end ? (size_t)(end - (text + at)) : size - at;
		parser.line++;
		const enum gz_result result = parse_spacing_line(&parser, text + at, length);
		if (result != GZ_OK)
			return result;
		at += length + 1;
	}
	if (parser.table.count == 0) {
		gz_err(log, "%s: no row; write at least one line \"eccentricity_deg spacing step\"",
		       name);
		return GZ_ERR_FORMAT;
	}
	*out_table = parser.table;
	return GZ_OK;
}

enum gz_result gz_spacing_table_load(const char *path, const struct gz_log *log,
				     struct gz_spacing_table *out_table)
{
	const struct gz_text_file file = { path, "table of spacings", FILE_SIZE_MAX };
	struct gz_text text = { 0 };
	enum gz_result result = gz_text_load(&text, &file, log);
	if (result == GZ_OK)
		result = gz_spacing_table_parse(path, text.bytes ? text.bytes : "", text.length,
						log, out_table);
	gz_text_free(&text);
	return result;
}

static bool spacing_row_valid(const struct gz_spacing_row *row)
{
	const double numbers[3] = { row->eccentricity_deg, row->spacing, row->step };
	for (int i = 0; i < 3; i++)
		if (!(numbers[i] >= spacing_columns[i].min && numbers[i] <= spacing_columns[i].max))
			return false;
	return true;
}

bool gz_spacing_table_valid(const struct gz_spacing_table *table)
{
	if (table->count < 1 || table->count > GZ_SPACING_TABLE_MAX)
		return false;
	for (int i = 0; i < table->count; i++) {
		const struct gz_spacing_row *row = &table->rows[i];
		if (!spacing_row_valid(row))
			return false;
		if (i > 0 && !(row->eccentricity_deg > row[-1].eccentricity_deg &&
			       row->spacing >= row[-1].spacing && row->step >= row[-1].step))
			return false;
	}
	return true;
}
