/* Plans that grow while nothing but the gaze changes, picture by picture. */
#include "suite.h"

#include <math.h>

#include "render/frame/growth.h"

enum { METHOD_RAYS = 10000, PIXELS = 200000 };

/* A plan of one tile whose rays are counted as if density went with the square of `finer`. */
struct fake {
	struct gz_tile tile;
	struct gz_plan plan;
};

static void make_fake(struct fake *fake, double finer)
{
	const double rays = fmin(METHOD_RAYS * finer * finer, PIXELS);
	*fake = (struct fake) { .tile = { .layer = rays < PIXELS } };
	fake->plan.tiles = &fake->tile;
	fake->plan.tile_count = 1;
	fake->plan.ray_count = (uint64_t)rays;
	fake->plan.layers[0].spacing = 1;
	fake->plan.layers[1].spacing = 2;
	fake->plan.steps[0] = 1;
}

struct making {
	struct gz_growth growth;
	struct gz_growth_view view;
	double share;
	bool refines;
	int pictures;
};

/* Make a picture; the first of a view is never kept. */
static double make_picture(struct making *m, bool keeps)
{
	struct fake fake;
	const double finer = gz_growth_begin(&m->growth, &m->view);
	make_fake(&fake, finer);
	const struct gz_growth_picture picture = { .plan = &fake.plan,
						   .keeps = keeps && m->pictures > 0,
						   .refines = m->refines && finer <= 1,
						   .share = m->share };
	gz_growth_end(&m->growth, &picture);
	m->pictures++;
	return finer;
}

static struct making making_of(double share)
{
	return (struct making) { .view = { .width = 640, .height = 480, .serial = 1 },
				 .share = share };
}

static void third_picture_is_finer(void **state)
{
	(void)state;
	struct making m = making_of(0.5);
	assert_false(gz_growth_settling(&m.growth));
	assert_true(make_picture(&m, true) == 1);
	assert_true(gz_growth_settling(&m.growth));
	assert_true(make_picture(&m, true) == 1);
	assert_true(gz_growth_settling(&m.growth));
	assert_true(make_picture(&m, true) == sqrt(1.5));
}

/* Each adds as many rays, within a factor, and the last one is whole. */
static void pictures_add_their_share_until_all_pixels_have_rays(void **state)
{
	(void)state;
	static const double shares[] = { 1e-6, 1e-3, 0.05, 0.5, 4 };
	for (size_t i = 0; i < sizeof shares / sizeof shares[0]; i++) {
		struct making m = making_of(shares[i]);
		const double wanted = fmax(shares[i] * METHOD_RAYS, 16);
		double before = METHOD_RAYS;
		while (m.pictures == 0 || gz_growth_settling(&m.growth)) {
			const double finer = make_picture(&m, true);
			const double rays = fmin(METHOD_RAYS * finer * finer, PIXELS);
			assert_true(rays >= before);
			if (rays - before > 2.1 * wanted)
				fail_msg("share %g: picture %d adds %g rays", shares[i], m.pictures,
					 rays - before);
			before = rays;
			if (m.pictures > 20000)
				fail_msg("share %g: not whole", shares[i]);
		}
		assert_true(before == PIXELS);
		assert_true(make_picture(&m, true) == GZ_PLAN_FINER_MAX);
	}
}

static void what_keeps_nothing_comes_to_rest(void **state)
{
	(void)state;
	struct making m = making_of(0.5);
	for (int i = 0; i < 5; i++)
		assert_true(make_picture(&m, false) == 1);
	assert_false(gz_growth_settling(&m.growth));
}

/* Also where the backend still keeps tiles of the same view: a recording may begin there. */
static void growth_begins_with_each_view(void **state)
{
	(void)state;
	for (int change = 0; change < 5; change++) {
		struct making m = making_of(0.5);
		while (m.pictures < 8)
			make_picture(&m, true);
		if (change == 0)
			m.view.camera.eye[1] = 1;
		else if (change == 1)
			m.view.serial++;
		else if (change == 2)
			m.view.width++;
		else if (change == 3)
			m.view.display.distance_mm = 500;
		else
			m.growth = (struct gz_growth) { 0 };
		assert_true(make_picture(&m, true) == 1);
		assert_true(gz_growth_settling(&m.growth));
		assert_true(make_picture(&m, true) == 1);
		assert_true(make_picture(&m, true) > 1);
	}
}

/* A change that only the backend noticed. */
static void lost_tiles_start_growth_again(void **state)
{
	(void)state;
	struct making m = making_of(0.5);
	while (m.pictures < 8 || gz_growth_settling(&m.growth))
		make_picture(&m, true);
	make_picture(&m, false);
	assert_true(gz_growth_settling(&m.growth));
	assert_true(make_picture(&m, true) == 1);
	assert_true(make_picture(&m, true) > 1);
}

static void plan_of_rounds_first_becomes_one_round(void **state)
{
	(void)state;
	struct making m = making_of(0.5);
	m.refines = true;
	make_picture(&m, true);
	make_picture(&m, true);
	const double finer = make_picture(&m, true);
	assert_true(finer > 1 && finer < 1.001);
	assert_true(make_picture(&m, true) > 1.2);
}

static void failed_picture_changes_nothing(void **state)
{
	(void)state;
	struct making m = making_of(0.5);
	while (m.pictures < 4)
		make_picture(&m, true);
	const double finer = gz_growth_begin(&m.growth, &m.view);
	assert_true(gz_growth_begin(&m.growth, &m.view) == finer);
	assert_true(make_picture(&m, true) == finer);
}

TEST_SUITE(growth)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(third_picture_is_finer),
		cmocka_unit_test(pictures_add_their_share_until_all_pixels_have_rays),
		cmocka_unit_test(what_keeps_nothing_comes_to_rest),
		cmocka_unit_test(growth_begins_with_each_view),
		cmocka_unit_test(lost_tiles_start_growth_again),
		cmocka_unit_test(plan_of_rounds_first_becomes_one_round),
		cmocka_unit_test(failed_picture_changes_nothing),
	};
	return cmocka_run_group_tests_name("growth", tests, NULL, NULL);
}
