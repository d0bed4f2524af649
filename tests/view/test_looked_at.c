/* Values of a volume that are looked at, as frames follow them. */
#include "suite.h"

#include <math.h>
#include <stdio.h>

#include "made_frames.h"
#include "place.h"
#include "render/data/format.h"

enum { EDGE = 16, FRONT = 100, BACK = 200 };

/* Values of the function: 0 to 1 are the data. */
#define FRONT_SHARE ((double)FRONT / BACK)
#define BACK_SHARE  1.0

#define FRAME_NS INT64_C(20000000)

/* A scene of a file of the volume. */
#define HALVES_SCENE(file)                                          \
	"[volume]\nfile = " file "\n[transfer]\nfile = halves.tf\n" \
	"[camera]\neye = 0 -2.5 0\nlook_at = 0 0 0\nup = 0 0 1\n"   \
	"fov_deg = 30\n[render]\ntechnique = raycast\n"

/* A frame maker over a volume whose back half has one value, and of whose front half the left side
 * has another. */
struct looking {
	struct made_frames made;
	struct gz_attention_params attention;
	int64_t now_ns;
};

static const char *write_halves(void)
{
	FILE *file = fopen(write_in_place("halves.nrrd", ""), "wb");
	assert_non_null(file);
	fputs("NRRD0004\ntype: uchar\ndimension: 3\nsizes: 16 16 16\nencoding: raw\n\n", file);
	for (int i = 0; i < EDGE * EDGE * EDGE; i++) {
		const int x = i % EDGE, y = i / EDGE % EDGE;
		const int front = x < EDGE / 2 ? FRONT : 0;
		fputc(y < EDGE / 2 ? front : BACK, file);
	}
	fclose(file);
	write_in_place("halves.tf", "0 0 0 0 0\n0.4 1 0 0 0\n0.5 1 0 0 0.25\n0.6 1 0 0 0\n"
				    "0.9 0 0 1 0.5\n1 0 0 1 0.5\n");
	return write_in_place("halves.scene", HALVES_SCENE("halves.nrrd"));
}

/* The same volume in a file of bricks. */
static const char *write_bricked_halves(void)
{
	struct gz_volume volume;
	(void)write_halves();
	assert_int_equal(gz_volume_load(in_place("halves.nrrd"), NULL, NULL, NULL, &volume), GZ_OK);
	assert_int_equal(gz_bricks_write(&volume, in_place("halves.gzb"), NULL, NULL), GZ_OK);
	gz_volume_free(&volume);
	return write_in_place("bricked.scene", HALVES_SCENE("halves.gzb"));
}

static void begin_looking(struct looking *all, const char *path)
{
	create_frames(&all->made, path, "cpu");
	assert_int_equal(gz_frame_maker_start(all->made.maker, &all->made.options, NULL), GZ_OK);
	all->attention = gz_attention_default();
	all->attention.importance = 1;
}

/* Look at a place for a second. @return what is raised then */
static struct gz_raised look_at_place(struct looking *all, float x)
{
	const struct gz_display display = gz_display_default(WIDTH, HEIGHT);
	const struct gz_gaze_reading reading = { .known = true,
						 .point = { x, 0.5F },
						 .noise_deg = NAN };
	for (int i = 0; i < 50; i++) {
		(void)gz_frame_attend(all->made.maker, &all->attention, &reading, &display,
				      all->now_ns);
		draw_frame(&all->made, NULL);
		all->now_ns += FRAME_NS;
	}
	return gz_frame_raised(all->made.maker);
}

static bool holds_value(const struct gz_raised *raised, double value)
{
	return raised->id != 0 && raised->least <= value && value <= raised->greatest;
}

/* What stands out makes all else fade: the left front would be looked through for ever. */
static void check_front_and_back(const char *path)
{
	struct looking all = { 0 };
	begin_looking(&all, path);
	const struct gz_raised back = look_at_place(&all, 0.6F);
	assert_true(holds_value(&back, BACK_SHARE) && !holds_value(&back, FRONT_SHARE));
	assert_float_equal(back.share, 1, 1e-12);
	const struct gz_raised front = look_at_place(&all, 0.4F);
	assert_true(holds_value(&front, FRONT_SHARE) && !holds_value(&front, BACK_SHARE));
	assert_float_equal(front.share, 1, 1e-12);
	gz_frame_maker_destroy(&all.made.maker);
}

static void the_gaze_finds_what_is_in_front_of_raised_values(void **state)
{
	(void)state;
	check_front_and_back(write_halves());
}

static void values_of_bricks_are_found_and_raised(void **state)
{
	(void)state;
	check_front_and_back(write_bricked_halves());
}

/* Values that looked alike by another function are not raised in the new one. */
static void another_function_raises_nothing_of_the_old_one(void **state)
{
	struct looking all = { 0 };
	(void)state;
	begin_looking(&all, write_halves());
	const struct gz_raised before = look_at_place(&all, 0.6F);
	assert_true(before.share > 0);
	assert_true(gz_frame_transfer(all.made.maker)->emphasis.share > 0);
	struct gz_transfer other = gz_frame_maker_scene(all.made.maker)->transfer;
	other.points[other.count - 2].value = 0.7;
	assert_int_equal(gz_frame_set_transfer(all.made.maker, &other), GZ_OK);
	assert_int_equal(gz_frame_raised(all.made.maker).id, 0);
	assert_true(gz_transfer_same(gz_frame_transfer(all.made.maker), &other));
	/* It is found anew, with the new function's range. */
	const struct gz_raised after = look_at_place(&all, 0.6F);
	assert_true(holds_value(&after, BACK_SHARE) && after.share > 0);
	gz_frame_maker_destroy(&all.made.maker);
}

static int open_place(void **state)
{
	(void)state;
	return create_place();
}

TEST_SUITE(looked_at)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_gaze_finds_what_is_in_front_of_raised_values),
		cmocka_unit_test(values_of_bricks_are_found_and_raised),
		cmocka_unit_test(another_function_raises_nothing_of_the_old_one),
	};
	return cmocka_run_group_tests(tests, open_place, remove_place);
}
