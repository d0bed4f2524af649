/* Tables of spacings: what is read, and what is refused with which heard.last. */
#include "suite.h"

#include <stddef.h>
#include <stdint.h>

#include <stdio.h>
#include <string.h>

#include "base/captured_log.h"
#include "render/plan/method.h"
#include "render/scene/scene.h"
#include "volume_files.h"

static struct captured_log heard;

static enum gz_result parse(const char *text, size_t size, struct gz_spacing_table *out)
{
	captured_log_init(&heard, NULL);
	return gz_spacing_table_parse("t", text, size, &heard.log, out);
}

static void rows_unit_and_comments_are_read(void **state)
{
	(void)state;
	static const char text[] = "# mine\n unit deg # angles\r\n0 0.01 1\n\n5\t0.05 1.5\n60 1 4";
	struct gz_spacing_table table;
	assert_int_equal(parse(text, strlen(text), &table), GZ_OK);
	assert_true(table.in_deg);
	assert_int_equal(table.count, 3);
	assert_true(table.rows[1].eccentricity_deg == 5 && table.rows[1].spacing == 0.05 &&
		    table.rows[1].step == 1.5);
	assert_true(gz_spacing_table_valid(&table));
}

static void pixels_are_the_default_unit(void **state)
{
	(void)state;
	struct gz_spacing_table table;
	assert_int_equal(parse("0 1 1\n", 6, &table), GZ_OK);
	assert_false(table.in_deg);
	assert_int_equal(table.count, 1);
}

static void errors_are_refused_with_their_line(void **state)
{
	(void)state;
	static const struct {
		const char *text, *says;
	} cases[] = {
		{ "", "t: no row" },
		{ "# nothing\n", "t: no row" },
		{ "0 1\n", "t:1: row: write three numbers" },
		{ "0 1 1 1\n", "t:1: row: more than three" },
		{ "0 1 1x\n", "t:1: row: write three numbers" },
		{ "0 nan 1\n", "t:1: row: write three numbers" },
		{ "0 0x2 1\n", "t:1: row: write three numbers" },
		{ "zero 1 1\n", "t:1: zero: unknown word" },
		{ "unit mm\n", "t:1: unit: write px or deg" },
		{ "unit\n", "t:1: unit: write px or deg" },
		{ "unit px\nunit px\n", "t:2: unit: given twice" },
		{ "0 1 1\n0 2 1\n", "t:2: eccentricity: not above" },
		{ "0 2 1\n5 1 1\n", "t:2: spacing: below" },
		{ "0 1 2\n5 1 1\n", "t:2: step: below" },
		{ "-1 1 1\n", "t:1: eccentricity: out of range" },
		{ "181 1 1\n", "t:1: eccentricity: out of range" },
		{ "0 0 1\n", "t:1: spacing: out of range" },
		{ "0 1001 1\n", "t:1: spacing: out of range" },
		{ "0 1 0.5\n", "t:1: step: out of range" },
		{ "0 1 17\n", "t:1: step: out of range" },
	};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		struct gz_spacing_table table = { .count = 77 };
		assert_int_equal(parse(cases[i].text, strlen(cases[i].text), &table),
				 GZ_ERR_FORMAT);
		assert_int_equal(table.count, 77);
		if (strncmp(heard.last, cases[i].says, strlen(cases[i].says)) != 0)
			fail_msg("\"%s\": said \"%s\", not \"%s\"", cases[i].text, heard.last,
				 cases[i].says);
	}
}

static void binary_bytes_are_refused(void **state)
{
	(void)state;
	char text[400];
	struct gz_spacing_table table;
	assert_int_equal(parse("0 1\0001", 6, &table), GZ_ERR_FORMAT);
	assert_non_null(strstr(heard.last, "NUL"));
	memset(text, ' ', sizeof text);
	assert_int_equal(parse(text, sizeof text, &table), GZ_ERR_FORMAT);
	assert_non_null(strstr(heard.last, "longer than 255"));
}

static void sixty_five_rows_are_one_too_many(void **state)
{
	(void)state;
	char text[65 * 16];
	size_t used = 0, full = 0;
	struct gz_spacing_table table;
	for (int i = 0; i < GZ_SPACING_TABLE_MAX + 1; i++) {
		full = used;
		used += (size_t)snprintf(text + used, sizeof text - used, "%d 1 1\n", i);
	}
	assert_int_equal(parse(text, full, &table), GZ_OK);
	assert_int_equal(table.count, GZ_SPACING_TABLE_MAX);
	assert_int_equal(parse(text, used, &table), GZ_ERR_FORMAT);
	assert_non_null(strstr(heard.last, "t:65: row: one too many"));
}

static void scene_finds_its_table_beside_itself(void **state)
{
	(void)state;
	struct gz_foveation foveation = gz_foveation_default();
	char scene[GZ_PATH_SIZE];
	files_write_text("mine.txt", "0 1 1\n20 8 3\n", NULL, 0);
	snprintf(scene, sizeof scene, "%s", files_path("a.scene"));
	captured_log_init(&heard, NULL);
	foveation.method = GZ_METHOD_TABLE;
	assert_int_equal(gz_scene_load_table(scene, &heard.log, &foveation), GZ_ERR_FORMAT);
	assert_non_null(strstr(heard.last, "foveation.table: not given"));
	strcpy(foveation.table_file, "mine.txt");
	assert_int_equal(gz_scene_load_table(scene, &heard.log, &foveation), GZ_OK);
	assert_int_equal(foveation.table.count, 2);
	strcpy(foveation.table_file, "other.txt");
	assert_int_equal(gz_scene_load_table(scene, &heard.log, &foveation), GZ_ERR_NOT_FOUND);
	assert_non_null(strstr(heard.last, "foveation.table: other.txt is neither"));
	foveation.method = GZ_METHOD_ACUITY;
	foveation.table_file[0] = '\0';
	assert_int_equal(gz_scene_load_table(scene, &heard.log, &foveation), GZ_OK);
}

static void file_that_cannot_be_read_is_refused(void **state)
{
	(void)state;
	static char blanks[(1 << 16) + 1];
	struct gz_spacing_table table;
	memset(blanks, '\n', sizeof blanks);
	captured_log_init(&heard, NULL);
	assert_int_equal(gz_spacing_table_load(files_path("no.txt"), &heard.log, &table),
			 GZ_ERR_NOT_FOUND);
	assert_non_null(strstr(heard.last, "no.txt: cannot open the table of spacings: "));
	assert_int_equal(gz_spacing_table_load(files_folder(), &heard.log, &table), GZ_ERR_IO);
	assert_non_null(strstr(heard.last, "cannot read the table of spacings: "));
	const char *path = files_write("long.txt", blanks, sizeof blanks);
	assert_int_equal(gz_spacing_table_load(path, &heard.log, &table), GZ_ERR_FORMAT);
	assert_non_null(strstr(heard.last, "longer than 64 KiB; is this a table of spacings?"));
	path = files_write("blank.txt", blanks, sizeof blanks - 1);
	assert_int_equal(gz_spacing_table_load(path, &heard.log, &table), GZ_ERR_FORMAT);
	assert_non_null(strstr(heard.last, "blank.txt: no row"));
	path = files_write("empty.txt", "", 0);
	assert_int_equal(gz_spacing_table_load(path, &heard.log, &table), GZ_ERR_FORMAT);
	assert_int_equal(heard.messages, 5);
}

TEST_SUITE(spacing_table)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(rows_unit_and_comments_are_read),
		cmocka_unit_test(pixels_are_the_default_unit),
		cmocka_unit_test(errors_are_refused_with_their_line),
		cmocka_unit_test(binary_bytes_are_refused),
		cmocka_unit_test(sixty_five_rows_are_one_too_many),
		cmocka_unit_test(scene_finds_its_table_beside_itself),
		cmocka_unit_test(file_that_cannot_be_read_is_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
