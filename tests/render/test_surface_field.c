/* The surface of a volume that rays find in its voxels: against following them in small steps,
 * against formulas, and against triangles. */
#include "suite.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/captured_log.h"
#include "mesh_fields.h"
#include "oracle.h"
#include "render/plan/method.h"
#include "render/raycast/shared/macrocells.h"
#include "render/surface/cpu/surface_caster.h"
#include "small_scene.h"

enum { WIDTH = 60, HEIGHT = 44, PIXELS = WIDTH * HEIGHT };

/* What a test draws, and what it gets. */
struct field_stage {
	struct gz_volume volume;
	struct gz_camera camera;
	struct gz_ray_params rays;
	struct gz_image image;
	struct gz_plane depth, ids;
};

static void set_up_field(struct gz_volume volume, struct field_stage *stage)
{
	memset(stage, 0, sizeof *stage);
	stage->volume = volume;
	stage->camera =
		(struct gz_camera) { .eye = { 0.9, -1.4, 0.7 }, .up = { 0, 0, 1 }, .fov_deg = 35 };
	stage->rays = gz_ray_params_default();
	stage->rays.surface.source = GZ_SURFACE_VOXELS;
}

static void take_down_field(struct field_stage *stage)
{
	gz_volume_free(&stage->volume);
	gz_image_free(&stage->image);
	gz_plane_free(&stage->depth);
	gz_plane_free(&stage->ids);
}

static struct gz_surface_caster *field_caster(const struct field_stage *stage, int threads,
					      const char *simd, const struct gz_log *log)
{
	const struct gz_backend_params params = { .threads = threads, .simd = simd };
	const struct gz_object object = { .id = 7, .volume = &stage->volume };
	struct gz_surface_caster *caster = NULL;
	assert_int_equal(gz_surface_caster_create(&params, log, &caster), GZ_OK);
	assert_int_equal(gz_surface_caster_show(caster, &object, 1), GZ_OK);
	return caster;
}

static void cast_field(struct gz_surface_caster *caster, struct field_stage *stage)
{
	const struct gz_foveation full = gz_foveation_full();
	const struct gz_display display = gz_display_default(WIDTH, HEIGHT);
	const struct gz_surface_planes planes = { &stage->depth, &stage->ids };
	struct gz_plan plan = { 0 };
	const struct gz_surface_shot shot = { .camera = &stage->camera,
					      .rays = &stage->rays,
					      .plan = &plan };
	assert_int_equal(gz_plan_make(&full, &display, (struct gz_point) { 0.5F, 0.5F }, WIDTH,
				      HEIGHT, &plan),
			 GZ_OK);
	assert_int_equal(gz_surface_caster_draw(caster, &shot, &stage->image, &planes, NULL),
			 GZ_OK);
	gz_plan_free(&plan);
}

static void draw_field(struct field_stage *stage, int threads, const char *simd)
{
	struct gz_surface_caster *caster = field_caster(stage, threads, simd, NULL);
	cast_field(caster, stage);
	gz_surface_caster_destroy(&caster);
}

/* Where the ray of a pixel is after a distance in world units, which are world_mm long; mm. */
static void point_of(const struct field_stage *stage, int pixel, double distance, double out[3])
{
	struct gz_ray_frame frame;
	double half[3], direction[3], length2 = 0;
	const double x = pixel % WIDTH, y = pixel / WIDTH;
	gz_volume_half_extent(&stage->volume, half);
	const double world_mm = stage->volume.dims[0] * stage->volume.spacing[0] / (2 * half[0]);
	assert_int_equal(gz_camera_rays(&stage->camera, WIDTH, HEIGHT, &frame), GZ_OK);
	for (int axis = 0; axis < 3; axis++) {
		direction[axis] = frame.direction00[axis] + x * frame.direction_dx[axis] +
				  y * frame.direction_dy[axis];
		length2 += direction[axis] * direction[axis];
	}
	for (int axis = 0; axis < 3; axis++)
		out[axis] = world_mm * (frame.origin00[axis] + x * frame.origin_dx[axis] +
					y * frame.origin_dy[axis] +
					distance * direction[axis] / sqrt(length2));
}

/* Whether a place lies above the isovalue: -1 where no surface can be. */
static int side_at(const struct field_stage *stage, const double place[3])
{
	const struct gz_volume *volume = &stage->volume;
	double at[3];
	for (int axis = 0; axis < 3; axis++) {
		at[axis] = place[axis] / volume->spacing[axis] + 0.5 * volume->dims[axis];
		if (at[axis] < 0.5 || at[axis] > volume->dims[axis] - 0.5)
			return -1;
	}
	const double stored = oracle_sample(volume, GZ_INTERPOLATION_TRILINEAR, at);
	return volume->slope * stored + volume->intercept > stage->rays.surface.isovalue;
}

/* Follow the ray of a pixel in small steps. Returns the distance to the first crossing. */
static double follow(const struct field_stage *stage, int pixel, double step)
{
	int before = -1;
	for (double distance = 0.4; distance < 3.2; distance += step) {
		double place[3];
		point_of(stage, pixel, distance, place);
		const int here = side_at(stage, place);
		if (here >= 0 && before >= 0 && here != before)
			return distance - 0.5 * step;
		before = here;
	}
	return INFINITY;
}

/* Noise has sheets and threads thinner than any step. */
static void noise_is_met_where_small_steps_meet_it(void **state)
{
	(void)state;
	static const double spacing[3] = { 1, 0.8, 1.5 };
	static const double isovalues[] = { 40, 128 };
	const double step = 0.001; /* world units: 1/30 of a voxel */
	struct field_stage stage;
	set_up_field(field_noise((const int[3]) { 19, 20, 11 }, GZ_VOXEL_U8, 5, 0), &stage);
	int hits = 0, apart = 0;
	for (size_t i = 0; i < 2; i++) {
		stage.rays.surface.isovalue = isovalues[i];
		memcpy(stage.volume.spacing, spacing, sizeof spacing);
		const char *const *set = small_scene_simd_sets();
		double followed[PIXELS];
		for (int pixel = 0; pixel < PIXELS; pixel += 11)
			followed[pixel] = follow(&stage, pixel, step);
		for (; *set; set++) {
			draw_field(&stage, 2, *set);
			for (int pixel = 0; pixel < PIXELS; pixel += 11) {
				float depth;
				memcpy(&depth, &stage.depth.words[pixel], sizeof depth);
				/* small steps miss the thinnest, and rims go either way */
				const bool nearer = (double)depth < followed[pixel] - step;
				apart += (isfinite(depth) || isfinite(followed[pixel])) &&
					 !(fabs((double)depth - followed[pixel]) <= 2 * step);
				hits += isfinite(depth);
				if (!nearer)
					continue;
				double before[3], behind[3];
				point_of(&stage, pixel, (double)depth - 2e-5, before);
				point_of(&stage, pixel, (double)depth + 2e-5, behind);
				if (side_at(&stage, before) == 1 && side_at(&stage, behind) == 1)
					fail_msg("%s: pixel %d at %g crosses nothing", *set, pixel,
						 (double)depth);
			}
		}
	}
	if (hits < 200 || apart > hits / 50)
		fail_msg("%d of %d hits are not those of small steps", apart, hits);
	take_down_field(&stage);
}

static void bodies_are_met_where_their_formulas_have_them(void **state)
{
	(void)state;
	static field_formula *const formulas[] = { field_ball, field_ring };
	for (int type = 0; type < GZ_VOXEL_TYPE_COUNT; type++)
		for (int i = 0; i < 2; i++) {
			struct field_stage stage;
			int hits = 0;
			set_up_field(field_volume(formulas[i], (const int[3]) { 40, 64, 50 },
						  (const double[3]) { 1.6, 1, 1.3 },
						  (enum gz_voxel_type)type),
				     &stage);
			draw_field(&stage, 2, NULL);
			for (int pixel = 0; pixel < PIXELS; pixel++) {
				float depth;
				double place[3];
				memcpy(&depth, &stage.depth.words[pixel], sizeof depth);
				assert_int_equal(stage.ids.words[pixel], isfinite(depth) ? 7 : 0);
				if (!isfinite(depth))
					continue;
				point_of(&stage, pixel, (double)depth, place);
				if (fabs(formulas[i](place)) > 0.12)
					fail_msg("body %d, type %d, pixel %d: %.3f mm off", i, type,
						 pixel, formulas[i](place));
				hits++;
			}
			assert_true(hits > 200);
			take_down_field(&stage);
		}
}

/* How many pixels differ by more than some grey levels. */
static int count_apart(const struct gz_image *a, const struct gz_image *b, int levels)
{
	int apart = 0;
	for (int i = 0; i < PIXELS; i++) {
		int most = 0;
		for (int channel = 0; channel < 3; channel++) {
			const int off =
				abs(a->pixels[4 * i + channel] - b->pixels[4 * i + channel]);
			most = off > most ? off : most;
		}
		apart += most > levels;
	}
	return apart;
}

static void picture_is_that_of_triangles(void **state)
{
	(void)state;
	for (int shadows = 0; shadows < 2; shadows++)
		for (int clipped = 0; clipped < 3; clipped++) { /* by nothing, box, plane */
			struct field_stage stage;
			struct gz_image triangles = { 0 };
			set_up_field(field_volume(field_ring, (const int[3]) { 70, 70, 40 },
						  (const double[3]) { 0.9, 0.9, 1 }, GZ_VOXEL_F32),
				     &stage);
			stage.rays.surface.shadows = shadows;
			stage.rays.clip.greatest[0] = clipped == 1 ? 0.7 : 1;
			stage.rays.clip.plane = clipped == 2;
			memcpy(stage.rays.clip.normal, (double[3]) { 0.5, -0.4, 0.7 },
			       3 * sizeof(double));
			stage.rays.clip.offset = 0.6;
			stage.rays.light.frame = GZ_LIGHT_WORLD;
			memcpy(stage.rays.light.direction, (double[3]) { 1, 0.2, 0.6 },
			       3 * sizeof(double));
			stage.rays.surface.source = GZ_SURFACE_TRIANGLES;
			struct gz_surface_caster *caster = field_caster(&stage, 2, NULL, NULL);
			cast_field(caster, &stage);
			triangles = stage.image;
			stage.image = (struct gz_image) { 0 };
			stage.rays.surface.source = GZ_SURFACE_VOXELS;
			cast_field(caster, &stage);
			/* rims and borders of shadows */
			const int apart = count_apart(&triangles, &stage.image, 3);
			if (apart > PIXELS / 60)
				fail_msg("shadows %d, clipped %d: %d pixels differ", shadows,
					 clipped, apart);
			gz_surface_caster_destroy(&caster);
			gz_image_free(&triangles);
			take_down_field(&stage);
		}
}

static void field_has_the_same_bits_for_any_threads_and_near_ones_for_any_set(void **state)
{
	(void)state;
	for (int material = GZ_MATERIAL_MATTE; material <= GZ_MATERIAL_GLASS; material++) {
		struct field_stage one, other;
		set_up_field(field_noise((const int[3]) { 30, 30, 30 }, GZ_VOXEL_U16, 3, 1), &one);
		one.rays.surface.isovalue = 30000;
		one.rays.surface.shadows = true;
		one.rays.surface.material = material;
		one.rays.environment.kind = GZ_SURROUNDINGS_SKY;
		memcpy(&other, &one, sizeof other);
		draw_field(&one, 1, NULL);
		draw_field(&other, 3, NULL);
		assert_memory_equal(one.image.pixels, other.image.pixels, (size_t)PIXELS * 4);
		assert_memory_equal(one.depth.words, other.depth.words, (size_t)PIXELS * 4);
		for (const char *const *set = small_scene_simd_sets();
		     material == GZ_MATERIAL_MATTE && *set; set++) {
			draw_field(&other, 2, *set);
			/* a rounded place can fall to another sheet of noise */
			assert_true(count_apart(&one.image, &other.image, 1) < PIXELS / 100);
		}
		other.volume = (struct gz_volume) { 0 };
		take_down_field(&one);
		take_down_field(&other);
	}
}

static void isovalue_moves_without_a_mesh(void **state)
{
	(void)state;
	struct field_stage stage;
	struct captured_log heard;
	captured_log_init(&heard, NULL);
	set_up_field(field_volume(field_ball, (const int[3]) { 50, 50, 50 },
				  (const double[3]) { 1, 1, 1 }, GZ_VOXEL_U8),
		     &stage);
	struct gz_surface_caster *caster = field_caster(&stage, 2, NULL, &heard.log);
	int before = PIXELS;
	for (int isovalue = -4; isovalue <= 4; isovalue += 4) {
		int hits = 0;
		stage.rays.surface.isovalue = isovalue;
		cast_field(caster, &stage);
		for (int pixel = 0; pixel < PIXELS; pixel++)
			hits += stage.ids.words[pixel] == 7;
		assert_true(hits > 100 && hits < before);
		before = hits;
		assert_int_equal(gz_surface_caster_size(caster).triangles, 0);
	}
	assert_int_equal(heard.messages, 0);
	stage.rays.surface.isovalue = 9;
	cast_field(caster, &stage);
	for (int pixel = 0; pixel < PIXELS; pixel++)
		assert_int_equal(stage.ids.words[pixel], 0);
	assert_int_equal(heard.messages, 1);
	assert_non_null(strstr(heard.last, "isovalue 9 does not separate any voxels"));
	gz_surface_caster_destroy(&caster);
	take_down_field(&stage);
}

static void thin_volumes_have_no_surface(void **state)
{
	(void)state;
	static const int dims[][3] = { { 1, 9, 9 }, { 9, 1, 9 }, { 9, 9, 1 }, { 1, 1, 1 } };
	for (size_t i = 0; i < sizeof dims / sizeof dims[0]; i++) {
		struct field_stage stage;
		set_up_field(field_noise(dims[i], GZ_VOXEL_U8, 9, 0), &stage);
		stage.rays.surface.isovalue = 100;
		draw_field(&stage, 1, NULL);
		for (int pixel = 0; pixel < PIXELS; pixel++)
			assert_int_equal(stage.ids.words[pixel], 0);
		take_down_field(&stage);
	}
}

static void cells_show_where_their_range_holds_the_isovalue(void **state)
{
	(void)state;
	struct gz_volume volume = field_noise((const int[3]) { 40, 24, 17 }, GZ_VOXEL_U8, 1, 0);
	struct gz_macrocells cells = { 0 };
	uint8_t *voxels = volume.voxels;
	for (int i = 0; i < 40 * 24 * 17; i++)
		voxels[i] = i % 40 < 20 ? 10 : 200;
	assert_int_equal(gz_macrocells_build(&volume, &cells), GZ_OK);
	gz_macrocells_classify_surface(&cells, 100);
	/* cells reach a voxel beyond their own eight: 20 is in [15, 24] alone */
	static const uint8_t distance[5] = { 2, 1, 0, 1, 2 };
	for (int i = 0; i < 5 * 3 * 3; i++)
		assert_int_equal(cells.distance[i], distance[i % 5]);
	gz_macrocells_classify_surface(&cells, 201);
	assert_int_equal(cells.distance[2], 255);
	gz_macrocells_free(&cells);
	gz_volume_free(&volume);
}

TEST_SUITE(surface_field)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(noise_is_met_where_small_steps_meet_it),
		cmocka_unit_test(bodies_are_met_where_their_formulas_have_them),
		cmocka_unit_test(picture_is_that_of_triangles),
		cmocka_unit_test(field_has_the_same_bits_for_any_threads_and_near_ones_for_any_set),
		cmocka_unit_test(isovalue_moves_without_a_mesh),
		cmocka_unit_test(thin_volumes_have_no_surface),
		cmocka_unit_test(cells_show_where_their_range_holds_the_isovalue),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
