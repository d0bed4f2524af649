/* Names and colours of labels. */
#include "suite.h"

#include <stdio.h>
#include <string.h>

#include "base/captured_log.h"
#include "render/mesh/label_names.h"
#include "volume_files.h"

static struct gz_label_names names_of(const char *text)
{
	struct gz_label_names names = { 0 };
	struct captured_log log;
	captured_log_init(&log, "*:warn");
	if (gz_label_names_parse("n.txt", text, strlen(text), &log.log, &names) != GZ_OK)
		fail_msg("%s: %s", text, log.last);
	return names;
}

static void each_format_gives_names_and_colours(void **state)
{
	(void)state;
	static const struct {
		const char *text;
		int32_t number;
		const char *name;
		bool coloured;
	} files[] = {
		/* FreeSurfer, 3D Slicer */
		{ "#No. Name  R G B A\n\n0 Unknown 0 0 0 0\n17  Left-Hippocampus  255 51 0 0\n", 17,
		  "Left-Hippocampus", true },
		{ "# Color table\n1 left lobe of the liver 255 51 0 255\r\n", 1,
		  "left lobe of the liver", true },
		/* ITK-SNAP */
		{ "#IDX -R- -G- -B- -A-- VIS MSH LABEL\n"
		  "  0  0  0  0  0 0 0 \"Clear Label\"\n"
		  "  5  255  51  0  0.5  1  1  \"left 12\"\n",
		  5, "left 12", true },
		/* BIDS */
		{ "index\tname\tmapping\tcolor\n1\tGray Matter\t1\t#FF3300\n2\tw\t2\tn/a\n", 1,
		  "Gray Matter", true },
		{ "index\tname\tcolor\n1\tGray Matter\t#ff3300\n2\tw\tn/a\n", 2, "w", false },
		/* MRIcron */
		{ "1 Precentral_L 2001\r\n2 Precentral_R 2002\r\n", 2, "Precentral_R", false },
		{ "0\tUnclassified\n1\tFornix_(cres)\n", 1, "Fornix_(cres)", false },
		{ "\xef\xbb\xbf"
		  "17 Area 17\n18 Area 18 a\n",
		  17, "Area 17", false },
	};
	for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
		struct gz_label_names names = names_of(files[i].text);
		const struct gz_label_name *found = gz_label_names_find(&names, files[i].number);
		assert_non_null(found);
		assert_string_equal(found->name, files[i].name);
		assert_int_equal(found->has_colour, files[i].coloured);
		if (found->has_colour) {
			assert_float_equal(found->colour[0], 1, 0);
			assert_float_equal(found->colour[1], 0.2, 1e-6);
			assert_float_equal(found->colour[2], 0, 0);
		}
		assert_null(gz_label_names_find(&names, 99));
		gz_label_names_free(&names);
		assert_null(names.items);
	}
}

static void rows_come_in_any_order_and_the_first_of_a_number_counts(void **state)
{
	(void)state;
	struct gz_label_names names = { 0 };
	struct captured_log log;
	static const char text[] = "9 nine\n-3 minus\n9 again\n2147483647 most\n";
	captured_log_init(&log, "*:warn");
	assert_int_equal(gz_label_names_parse("n.txt", text, sizeof text - 1, &log.log, &names),
			 GZ_OK);
	assert_int_equal(names.count, 3);
	assert_int_equal(names.items[0].number, -3);
	assert_string_equal(gz_label_names_find(&names, 9)->name, "nine");
	assert_string_equal(gz_label_names_find(&names, INT32_MAX)->name, "most");
	assert_non_null(strstr(log.last, "n.txt:3: label 9 is named in line 1"));
	gz_label_names_free(&names);
}

static void wrong_rows_are_refused_with_their_line(void **state)
{
	(void)state;
	static const struct {
		const char *text, *said;
	} files[] = {
		{ "", "no row names a label" },
		{ "# nothing\n\n", "no row names a label" },
		{ "This atlas was made by hand.\n", "n.txt:1: no names of labels" },
		{ "1 a\nb 2\n", "n.txt:2: a row begins with" },
		{ "1 a\n2147483648 b\n", "n.txt:2: a row begins with" },
		{ "1 a 0 0 0 0\n2 b 0 0 256 0\n", "n.txt:2: a colour is" },
		{ "1 a 0 0 0 0\n2 0 0 0 0\n", "n.txt:2: a row of a colour table" },
		{ "1 0 0 0 1 1 0 \"open\n", "n.txt:1: a label description" },
		{ "index\tname\tcolor\n1\ta\tred\n", "n.txt:2: column color" },
		{ "index\tname\n1\n", "n.txt:2: the row has fewer" },
		{ "1 a\x01\n", "n.txt:1: a name has" },
	};
	for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
		struct gz_label_names names;
		struct captured_log log;
		captured_log_init(&log, "*:warn");
		assert_int_equal(gz_label_names_parse("n.txt", files[i].text, strlen(files[i].text),
						      &log.log, &names),
				 GZ_ERR_FORMAT);
		if (!strstr(log.last, files[i].said))
			fail_msg("%s: without \"%s\": %s", files[i].text, files[i].said, log.last);
	}
	char text[200] = "1 ";
	struct gz_label_names names;
	memset(text + 2, 'a', GZ_LABEL_NAME_SIZE - 1);
	assert_int_equal(gz_label_names_parse("n.txt", text, strlen(text), NULL, &names), GZ_OK);
	gz_label_names_free(&names);
	text[2 + GZ_LABEL_NAME_SIZE - 1] = 'a';
	assert_int_equal(gz_label_names_parse("n.txt", text, strlen(text), NULL, &names),
			 GZ_ERR_FORMAT);
}

static void file_beside_a_volume_is_found(void **state)
{
	(void)state;
	static const struct {
		const char *volume, *file;
	} pairs[] = {
		{ "p.nii.gz", "p.nii.txt" }, { "q.nii.gz", "q.txt" },
		{ "r.nii", "r.label" },      { "s_dseg.nii.gz", "s_dseg.tsv" },
		{ "t.nrrd", "t.ctbl" },      { "u.mgz", "FreeSurferColorLUT.txt" },
	};
	char found[GZ_PATH_SIZE], volume[GZ_PATH_SIZE];
	for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++) {
		const char *path = files_write(pairs[i].file, "1 a\n", 4);
		assert_int_equal(snprintf(volume, sizeof volume, "%.*s%s",
					  (int)(strrchr(path, '/') + 1 - path), path,
					  pairs[i].volume) > 0,
				 1);
		assert_true(gz_label_names_beside(volume, found));
		assert_string_equal(strrchr(found, '/') + 1, pairs[i].file);
	}
	assert_false(gz_label_names_beside("/nowhere/p.nii.gz", found));
}

TEST_SUITE(label_names)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(each_format_gives_names_and_colours),
		cmocka_unit_test(rows_come_in_any_order_and_the_first_of_a_number_counts),
		cmocka_unit_test(wrong_rows_are_refused_with_their_line),
		cmocka_unit_test(file_beside_a_volume_is_found),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
