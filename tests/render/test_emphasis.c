/* A range of values that stands out: what it does to opacity, and which values are one thing. */
#include "suite.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/transfer/emphasis.h"
#include "render/transfer/transfer_table.h"

/* Skin, as a hump, then nothing, then bone of two shades, then metal of another colour. */
static const struct gz_transfer body = {
	.count = 8,
	.points = {
		{ 0.1, { 0.9, 0.6, 0.5 }, 0 },
		{ 0.2, { 0.9, 0.6, 0.5 }, 0.2 },
		{ 0.3, { 0.9, 0.6, 0.5 }, 0.05 },
		{ 0.35, { 0.9, 0.8, 0.7 }, 0.3 },
		{ 0.5, { 0.95, 0.9, 0.8 }, 0.8 },
		{ 0.7, { 1, 0.95, 0.9 }, 1 },
		{ 0.8, { 0.4, 0.5, 0.9 }, 1 },
		{ 1, { 0.4, 0.5, 0.9 }, 1 },
	},
};

static double opacity_of(const struct gz_transfer *transfer, double value)
{
	double rgba[4];
	gz_transfer_evaluate(transfer, value, rgba);
	return rgba[3];
}

static struct gz_transfer with_emphasis(double share, double least, double greatest)
{
	struct gz_transfer transfer = body;
	transfer.emphasis = (struct gz_transfer_emphasis) { share, least, greatest };
	return transfer;
}

static void range_becomes_denser_and_the_rest_fades(void **state)
{
	(void)state;
	const struct gz_transfer whole = with_emphasis(1, 0.3, 0.7);
	const struct gz_transfer half = with_emphasis(0.5, 0.3, 0.7);
	/* That of twice the length. */
	assert_float_equal(opacity_of(&whole, 0.5), 1 - 0.2 * 0.2, 1e-12);
	assert_float_equal(opacity_of(&whole, 0.3), 1 - 0.95 * 0.95, 1e-12);
	assert_float_equal(opacity_of(&whole, 0.7), 1, 1e-12);
	assert_float_equal(opacity_of(&whole, 0.2), 0.2 / 8, 1e-12);
	assert_float_equal(opacity_of(&whole, 0.8), 1.0 / 8, 1e-12);
	assert_float_equal(opacity_of(&half, 0.5), 1 - pow(0.2, 1.5), 1e-12);
	assert_float_equal(opacity_of(&half, 0.2), 0.2 * (1 - 0.5 * 7 / 8), 1e-12);
	/* Beyond the ends the first and the last value hold. */
	assert_float_equal(opacity_of(&whole, 3), 1.0 / 8, 1e-12);
	assert_float_equal(opacity_of(&whole, -3), 0, 1e-12);
}

static void emphasis_ends_smoothly_beside_its_range(void **state)
{
	(void)state;
	const struct gz_transfer even = {
		.count = 1,
		.points = { { 0, { 1, 1, 1 }, 0.5 } },
		.emphasis = { 1, 0.4, 0.6 },
	};
	double before = opacity_of(&even, 0.6);
	assert_float_equal(before, 0.75, 1e-12);
	for (int i = 1; i <= 20; i++) {
		const double now = opacity_of(&even, 0.6 + i * 0.001);
		assert_true(now < before && before - now < 0.06);
		before = now;
	}
	assert_float_equal(opacity_of(&even, 0.6201), 0.5 / 8, 1e-12);
	assert_float_equal(opacity_of(&even, 0.61), opacity_of(&even, 0.39), 1e-12);
	/* A label's neighbours are a whole label away. */
	struct gz_transfer label = even;
	label.emphasis = (struct gz_transfer_emphasis) { 1, 4.5 / 116, 5.5 / 116 };
	assert_float_equal(opacity_of(&label, 5.0 / 116), 0.75, 1e-12);
	assert_float_equal(opacity_of(&label, 4.0 / 116), 0.5 / 8, 1e-12);
	assert_float_equal(opacity_of(&label, 6.0 / 116), 0.5 / 8, 1e-12);
}

static struct gz_transfer_emphasis alike(const struct gz_transfer *transfer, double value)
{
	struct gz_transfer_emphasis found;
	gz_transfer_find_alike(transfer, value, &found);
	assert_true(found.share == 0 && found.least <= value && found.greatest >= value);
	assert_true(found.least < found.greatest);
	return found;
}

static void values_are_one_thing_up_to_valleys_gaps_and_other_colours(void **state)
{
	(void)state;
	const double step = 1.0 / 1024 + 1e-9;
	const struct gz_transfer_emphasis skin = alike(&body, 0.22), bone = alike(&body, 0.6);
	assert_float_equal(skin.least, 0.1, step);
	assert_float_equal(skin.greatest, 0.3, step); /* where opacity is least */
	/* Towards skin the colour of bone ends first. */
	assert_true(bone.least > 0.3 && bone.least < 0.35);
	assert_float_equal(alike(&body, 0.36).least, 0.3, step);
	/* Towards metal the colour changes by 0.3 after about four tenths of the way. */
	assert_true(bone.greatest > 0.71 && bone.greatest < 0.76);
	assert_float_equal(alike(&body, 0.9).greatest, 1, 0);
	assert_float_equal(alike(&body, 1).greatest, 1, 0);
	/* All values of a thing have nearly its range. */
	assert_float_equal(alike(&body, 0.15).greatest, skin.greatest, step);
	assert_float_equal(alike(&body, 0.25).least, skin.least, step);
	/* A shallow dip is no border. */
	struct gz_transfer dip = body;
	dip.points[2].opacity = 0.15;
	assert_true(alike(&dip, 0.15).greatest > 0.35);
	/* An emphasis does not change what is one thing. */
	const struct gz_transfer raised = with_emphasis(1, skin.least, skin.greatest);
	assert_float_equal(alike(&raised, 0.22).greatest, skin.greatest, 0);
}

static void what_was_visible_stays_visible_in_tables(void **state)
{
	(void)state;
	const struct gz_volume volume = { .type = GZ_VOXEL_U8, .slope = 1, .stored_max = 255 };
	const struct gz_transfer none = with_emphasis(0, 0.3, 0.7);
	const struct gz_transfer all = with_emphasis(1, 0.3, 0.7);
	struct gz_transfer_table *tables = calloc(3, sizeof *tables);
	assert_non_null(tables);
	gz_transfer_table_bake(&body, &volume, &tables[0]);
	gz_transfer_table_bake(&none, &volume, &tables[1]);
	gz_transfer_table_bake(&all, &volume, &tables[2]);
	assert_memory_equal(&tables[0], &tables[1], sizeof tables[0]);
	assert_int_equal(tables[0].count, tables[2].count);
	assert_memory_equal(tables[0].visible_before, tables[2].visible_before,
			    sizeof tables[0].visible_before);
	assert_true(memcmp(tables[0].entries, tables[2].entries, sizeof tables[0].entries) != 0);
	free(tables);
}

static void narrow_range_gets_a_finer_table(void **state)
{
	(void)state;
	const struct gz_volume volume = { .type = GZ_VOXEL_U16, .slope = 1, .stored_max = 65535 };
	const struct gz_transfer transfer = {
		.count = 1,
		.points = { { 0, { 1, 1, 1 }, 0.5 } },
		.emphasis = { 1, 1000.5 / 65535, 1001.5 / 65535 },
	};
	struct gz_transfer_table *table = calloc(1, sizeof *table);
	assert_non_null(table);
	gz_transfer_table_bake(&transfer, &volume, table);
	const float label = table->entries[gz_transfer_table_nearest(table, 1001)].extinction;
	const float next = table->entries[gz_transfer_table_nearest(table, 1002)].extinction;
	assert_float_equal(label, -2, 1e-6);
	assert_float_equal(next, log2(1 - 0.5 / 8), 1e-6);
	free(table);
}

static void functions_with_another_emphasis_differ(void **state)
{
	(void)state;
	const struct gz_transfer one = with_emphasis(0.5, 0.1, 0.3);
	const struct gz_transfer others[] = { with_emphasis(0.4, 0.1, 0.3),
					      with_emphasis(0.5, 0.2, 0.3),
					      with_emphasis(0.5, 0.1, 0.4), body };
	assert_true(gz_transfer_same(&one, &one));
	for (size_t i = 0; i < sizeof others / sizeof others[0]; i++)
		assert_false(gz_transfer_same(&one, &others[i]));
}

TEST_SUITE(emphasis)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(range_becomes_denser_and_the_rest_fades),
		cmocka_unit_test(emphasis_ends_smoothly_beside_its_range),
		cmocka_unit_test(values_are_one_thing_up_to_valleys_gaps_and_other_colours),
		cmocka_unit_test(what_was_visible_stays_visible_in_tables),
		cmocka_unit_test(narrow_range_gets_a_finer_table),
		cmocka_unit_test(functions_with_another_emphasis_differ),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
