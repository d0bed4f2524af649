/* The technique changes between two frames, as the settings panel does it. */
#include "suite.h"

#include <string.h>

#include "made_frames.h"
#include "place.h"
#include "render/scene/techniques.h"

static void create_switching(struct made_frames *all, const char *backend)
{
	const char *path =
		write_in_place("shells.scene", "[volume]\nprocedural = shells\ndims = 32 32 32\n"
					       "[isosurface]\nisovalue = 90\n");
	create_frames(all, path, backend);
}

static void begin_switching(struct made_frames *all)
{
	create_switching(all, "cpu");
	assert_int_equal(gz_frame_maker_start(all->maker, &all->options, NULL), GZ_OK);
}

/* The picture with a technique of gz_technique_choices. */
static void make_with(struct made_frames *all, int technique, uint8_t out_pixels[BYTES])
{
	all->settings.technique = technique;
	draw_frame(all, out_pixels);
}

static int choice_of(const char *name)
{
	int choice = 0;
	while (strcmp(gz_technique_choices[choice], name) != 0)
		choice++;
	return choice;
}

static void technique_follows_the_settings_and_a_refused_one_changes_nothing(void **state)
{
	(void)state;
	static uint8_t first[BYTES], second[BYTES], third[BYTES];
	struct made_frames all = { 0 };
	begin_switching(&all);
	const struct gz_backend_params params = { 0 };
	const int surface = choice_of("isosurface");
	const bool there = gz_techniques[surface - 1]->check("cpu", &params, NULL) == GZ_OK;
	make_with(&all, 0, first);
	make_with(&all, surface, second);
	make_with(&all, choice_of("raycast"), third);
	assert_memory_equal(first, third, sizeof first);
	if (there) {
		assert_int_equal(all.captured.messages, 0);
		assert_memory_not_equal(first, second, sizeof first);
		make_with(&all, surface, third);
		assert_memory_equal(second, third, sizeof first);
		/* the budget does not pay for the surface, which is made once */
		assert_true(all.record.prepare_ms > 0);
		assert_true(all.record.prepare_ms < all.record.total_ms);
		make_with(&all, surface, third);
		assert_true(all.record.prepare_ms == 0);
	} else {
		assert_memory_equal(first, second, sizeof first);
		const int told = all.captured.messages;
		make_with(&all, surface, second);
		make_with(&all, surface, second);
		assert_in_range(all.captured.messages, told, told + 3); /* not in each frame */
	}
	gz_frame_maker_destroy(&all.maker);
}

static void slices_are_refused_once_in_a_picture_on_cpu(void **state)
{
	(void)state;
	static uint8_t first[BYTES], second[BYTES];
	struct made_frames all = { 0 };
	begin_switching(&all);
	make_with(&all, 0, first);
	assert_true(gz_frame_cpu_suffices(all.maker));
	make_with(&all, choice_of("slices"), second);
	assert_memory_equal(first, second, sizeof first);
	assert_non_null(strstr(all.captured.last, "slices: refused"));
	const int told = all.captured.messages;
	make_with(&all, choice_of("slices"), second);
	assert_int_equal(all.captured.messages, told);
	assert_int_equal(gz_frame_maker_scene(all.maker)->settings.technique, 0);
	/* Who chooses it again is told again. */
	make_with(&all, 0, second);
	make_with(&all, choice_of("slices"), second);
	assert_true(all.captured.messages > told);
	gz_frame_maker_destroy(&all.maker);
}

/* A window without a GPU prepares its renderer of cpu on a thread. */
static void slices_make_cpu_give_way_where_the_backend_may_be_chosen(void **state)
{
	(void)state;
	static uint8_t first[BYTES], second[BYTES];
	struct made_frames all = { 0 };
	const int slices = choice_of("slices");
	const struct gz_backend_params params = { 0 };
	const bool there = gz_techniques[slices - 1]->check("gl", &params, NULL) == GZ_OK;
	create_switching(&all, "auto");
	assert_int_equal(gz_frame_maker_start_cpu(all.maker, &all.options), GZ_OK);
	gz_frame_maker_let_choose(all.maker, &all.options, NULL);
	make_with(&all, 0, first);
	assert_string_equal(gz_frame_backend(all.maker), "cpu");
	make_with(&all, slices, second);
	if (there) {
		assert_string_equal(all.record.backend, "gl");
		assert_memory_not_equal(first, second, sizeof first);
		assert_int_equal(gz_frame_maker_scene(all.maker)->settings.technique, slices);
	} else {
		assert_non_null(strstr(all.captured.last, "slices: refused"));
	}
	if (gz_frame_takes_cpu(&all.options, NULL, NULL)) {
		make_with(&all, choice_of("raycast"), second);
		assert_string_equal(all.record.backend, "cpu");
		assert_memory_equal(first, second, sizeof first);
	}
	gz_frame_maker_destroy(&all.maker);
}

/* Who named cpu keeps it: as without a choice. */
static void slices_are_refused_where_the_options_name_cpu(void **state)
{
	(void)state;
	static uint8_t first[BYTES], second[BYTES];
	struct made_frames all = { 0 };
	begin_switching(&all);
	gz_frame_maker_let_choose(all.maker, &all.options, NULL);
	make_with(&all, 0, first);
	for (int i = 0; i < 2; i++) {
		make_with(&all, choice_of("slices"), second);
		assert_non_null(strstr(all.captured.last, "slices: refused"));
		assert_memory_equal(first, second, sizeof first);
		make_with(&all, 0, second);
	}
	gz_frame_maker_destroy(&all.maker);
}

/* What a session of the window does while its isovalue moves and then rests. */
static void triangles_are_made_beside_the_frames(void **state)
{
	(void)state;
	static uint8_t waited[BYTES], ready[BYTES];
	struct made_frames all = { 0 };
	const int isosurface = choice_of("isosurface");
	begin_switching(&all);
	struct gz_frame_maker *maker = all.maker;
	all.settings.technique = isosurface;
	assert_int_equal(gz_frame_prepare(maker, &all.settings, NULL), GZ_FRAME_CANNOT_WAIT);
	make_with(&all, isosurface, waited);
	assert_true(all.record.prepare_ms > 0);
	all.settings.rays.surface.isovalue = 120;
	make_with(&all, isosurface, waited);
	assert_true(all.record.prepare_ms > 0);
	/* One that is given up, and the one that counts. */
	all.settings.rays.surface.isovalue = 100;
	assert_int_equal(gz_frame_prepare(maker, &all.settings, NULL), GZ_FRAME_PREPARING);
	all.settings.rays.surface.isovalue = 90;
	make_with(&all, isosurface, ready);
	all.settings.rays.surface.isovalue = 120;
	enum gz_frame_ready far;
	while ((far = gz_frame_prepare(maker, &all.settings, NULL)) == GZ_FRAME_PREPARING) {
		all.settings.rays.surface.source = GZ_SURFACE_VOXELS;
		make_with(&all, isosurface, ready);
		all.settings.rays.surface.source = GZ_SURFACE_TRIANGLES;
	}
	assert_int_equal(far, GZ_FRAME_READY);
	make_with(&all, isosurface, ready);
	assert_true(all.record.prepare_ms == 0);
	assert_memory_equal(ready, waited, sizeof ready);
	/* Other techniques still follow, and a thread that runs is waited for at the end. */
	make_with(&all, choice_of("raycast"), ready);
	make_with(&all, isosurface, ready);
	assert_memory_equal(ready, waited, sizeof ready);
	all.settings.rays.surface.isovalue = 60;
	assert_int_equal(gz_frame_prepare(maker, &all.settings, NULL), GZ_FRAME_PREPARING);
	gz_frame_maker_destroy(&all.maker);
}

static int open_place(void **state)
{
	(void)state;
	return create_place();
}

TEST_SUITE(technique_switch)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(technique_follows_the_settings_and_a_refused_one_changes_nothing),
		cmocka_unit_test(slices_are_refused_once_in_a_picture_on_cpu),
		cmocka_unit_test(slices_make_cpu_give_way_where_the_backend_may_be_chosen),
		cmocka_unit_test(slices_are_refused_where_the_options_name_cpu),
		cmocka_unit_test(triangles_are_made_beside_the_frames),
	};
	return cmocka_run_group_tests(tests, open_place, remove_place);
}
