/* Illustrations of awkward input: one label, hundreds and thousands, objects without triangles,
 * volumes whose surface vanishes at an isovalue, and broken meshes, each grey, stippled and
 * hatched. */
#include "suite.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/captured_log.h"
#include "mesh_fields.h"
#include "mesh_shapes.h"
#include "render/illustration/cpu/illustrate_caster.h"
#include "render/mesh/label_surfaces.h"

enum { WIDTH = 128, HEIGHT = 96, PIXELS = WIDTH * HEIGHT };

/* What is drawn, and the picture of it. */
struct sketch {
	struct gz_volume volume; /* its box is the world */
	struct gz_object *objects;
	size_t count;
	double isovalue;
	struct gz_illustrate_caster *caster;
	struct gz_image image;
	struct gz_plane ids;
};

static void open_sketch(struct sketch *sketch)
{
	const struct gz_backend_params params = { .threads = 2, .wait_for_bricks = true };
	assert_int_equal(gz_illustrate_caster_create(&params, NULL, &sketch->caster), GZ_OK);
	assert_int_equal(gz_illustrate_caster_show(sketch->caster, sketch->objects, sketch->count),
			 GZ_OK);
}

static void close_sketch(struct sketch *sketch)
{
	gz_illustrate_caster_destroy(&sketch->caster);
	gz_volume_free(&sketch->volume);
	gz_image_free(&sketch->image);
	gz_plane_free(&sketch->ids);
}

static void draw_sketch(struct sketch *sketch, enum gz_illustration_drawing drawing)
{
	const struct gz_display display = gz_display_default(WIDTH, HEIGHT);
	const struct gz_foveation full = gz_foveation_full();
	const struct gz_point gaze = { 0.5F, 0.5F };
	const struct gz_camera camera = { .eye = { 0.4, -1.7, 0.5 },
					  .up = { 0, 0, 1 },
					  .fov_deg = 36 };
	struct gz_illustration_look look = { 0 };
	struct gz_option_binding bindings[GZ_ILLUSTRATION_BINDINGS];
	struct gz_plan plan = { 0 };
	gz_illustration_look_bind(&look, bindings);
	for (int i = 0; i < GZ_ILLUSTRATION_BINDINGS; i++)
		assert_int_equal(gz_options_preset(&bindings[i]), GZ_OK);
	look.drawing = (int)drawing;
	assert_int_equal(gz_plan_make(&full, &display, gaze, WIDTH, HEIGHT, &plan), GZ_OK);
	const struct gz_illustrate_planes planes = { .ids = &sketch->ids };
	const struct gz_illustrate_shot shot = {
		.camera = &camera, .plan = &plan, .look = &look, .isovalue = sketch->isovalue
	};
	assert_int_equal(
		gz_illustrate_caster_draw(sketch->caster, &shot, &sketch->image, &planes, NULL),
		GZ_OK);
	gz_plan_free(&plan);
}

/* Pixels that are not white, and the different objects in the picture. */
static int inked_pixels(struct sketch *sketch)
{
	int count = 0;
	for (int i = 0; i < PIXELS; i++)
		count += (gz_image_words(&sketch->image)[i] & 255) != 255;
	return count;
}

static size_t seen_objects(const struct sketch *sketch)
{
	bool *seen = calloc(sketch->count + 2, sizeof *seen);
	size_t count = 0;
	assert_non_null(seen);
	for (int i = 0; i < PIXELS; i++) {
		const uint32_t id = sketch->ids.words[i];
		assert_true(id <= sketch->count + 1);
		count += id > 0 && !seen[id];
		seen[id] = true;
	}
	free(seen);
	return count;
}

/* A volume whose blocks of some voxels are labels with numbers far apart; around it there is none.
 */
static struct gz_volume label_volume(int edge, int block)
{
	struct gz_volume volume = { .dims = { edge, edge, edge },
				    .spacing = { 1, 1, 1 },
				    .type = GZ_VOXEL_U16,
				    .slope = 1 };
	assert_int_equal(gz_volume_allocate(&volume), GZ_OK);
	uint16_t *voxels = volume.voxels;
	const int blocks = edge / block;
	for (int i = 0; i < edge * edge * edge; i++) {
		const int x = i % edge, y = i / edge % edge, z = i / edge / edge;
		voxels[i] = (uint16_t)(7 + 3 * (x / block +
						blocks * (y / block + blocks * (z / block))));
	}
	gz_volume_find_range(&volume);
	return volume;
}

/* Draw all labels of a volume. @return how many there are */
static size_t check_labels(int edge, int block, size_t seen_least)
{
	struct sketch sketch = { .volume = label_volume(edge, block) };
	const struct gz_label_look look = { .smoothing = 12, .reach = 0.5 };
	const struct gz_label_request request = { .volume = &sketch.volume,
						  .name = "labels",
						  .look = &look };
	struct gz_label_surfaces surfaces;
	assert_int_equal(gz_label_surfaces_make(&request, NULL, NULL, &surfaces), GZ_OK);
	sketch.count = surfaces.count;
	sketch.objects = calloc(surfaces.count, sizeof *sketch.objects);
	assert_non_null(sketch.objects);
	for (size_t i = 0; i < surfaces.count; i++)
		sketch.objects[i] = (struct gz_object) { .id = 1 + (uint32_t)i,
							 .volume = &sketch.volume,
							 .mesh = &surfaces.items[i].mesh };
	open_sketch(&sketch);
	for (int drawing = GZ_DRAWING_GREY; drawing <= GZ_DRAWING_HATCHES; drawing++) {
		draw_sketch(&sketch, (enum gz_illustration_drawing)drawing);
		assert_true(inked_pixels(&sketch) > 300);
		if (seen_objects(&sketch) < seen_least)
			fail_msg("%zu objects are seen", seen_objects(&sketch));
	}
	close_sketch(&sketch);
	free(sketch.objects);
	gz_label_surfaces_free(&surfaces);
	return sketch.count;
}

static void volume_of_one_label_is_drawn(void **state)
{
	(void)state;
	assert_int_equal(check_labels(16, 16, 1), 1);
}

static void volume_of_hundreds_of_labels_is_drawn(void **state)
{
	(void)state;
	assert_int_equal(check_labels(18, 2, 60), 9 * 9 * 9);
}

/* More than GZ_LABELS_MAX labels are no atlas, but an ordinary volume. */
static void volume_of_thousands_of_labels_is_refused(void **state)
{
	(void)state;
	struct gz_volume volume = label_volume(26, 2);
	const struct gz_label_look look = { .smoothing = 12, .reach = 0.5 };
	const struct gz_label_request request = { .volume = &volume,
						  .name = "labels",
						  .look = &look };
	struct gz_label_surfaces surfaces;
	struct captured_log log;
	captured_log_init(&log, NULL);
	assert_true(gz_label_surfaces_make(&request, NULL, &log.log, &surfaces) != GZ_OK);
	assert_int_equal(log.messages, 1);
	assert_non_null(strstr(log.last, "labels"));
	gz_volume_free(&volume);
}

/* As a label without voxels: it is no hindrance to the others. */
static void object_without_triangles_is_no_hindrance(void **state)
{
	(void)state;
	static const int dims[3] = { 4, 4, 4 };
	static const double spacing[3] = { 10, 10, 10 };
	struct gz_mesh ball = mesh_ball(12, 4), empty = { 0 };
	struct sketch sketch = { .volume = field_volume(field_ball, dims, spacing, GZ_VOXEL_F32) };
	struct gz_object objects[3] = { { .id = 1, .mesh = &empty },
					{ .id = 2, .mesh = &ball },
					{ .id = 3, .mesh = &empty } };
	for (int i = 0; i < 3; i++)
		objects[i].volume = &sketch.volume;
	sketch.objects = objects;
	sketch.count = 3;
	open_sketch(&sketch);
	for (int drawing = GZ_DRAWING_GREY; drawing <= GZ_DRAWING_HATCHES; drawing++) {
		draw_sketch(&sketch, (enum gz_illustration_drawing)drawing);
		assert_true(inked_pixels(&sketch) > 300);
		assert_int_equal(seen_objects(&sketch), 1);
	}
	close_sketch(&sketch);
	gz_mesh_free(&ball);
}

/* The surface is there, is gone, and is there again as it was. */
static void surface_that_vanishes_at_an_isovalue_comes_back(void **state)
{
	(void)state;
	static const int dims[3] = { 40, 40, 40 };
	static const double spacing[3] = { 1, 1, 1 };
	struct gz_object object = { .id = 1, .name = "ball" };
	struct sketch sketch = { .volume = field_volume(field_ball, dims, spacing, GZ_VOXEL_F32),
				 .objects = &object,
				 .count = 1 };
	const double within = 0, beyond = 1e6; /* of what field_ball() has */
	object.volume = &sketch.volume;
	open_sketch(&sketch);
	for (int drawing = GZ_DRAWING_GREY; drawing <= GZ_DRAWING_HATCHES; drawing++) {
		struct gz_image before = { 0 };
		sketch.isovalue = within;
		draw_sketch(&sketch, (enum gz_illustration_drawing)drawing);
		assert_true(inked_pixels(&sketch) > 100);
		before = sketch.image;
		sketch.image = (struct gz_image) { 0 };
		sketch.isovalue = beyond;
		draw_sketch(&sketch, (enum gz_illustration_drawing)drawing);
		assert_int_equal(inked_pixels(&sketch), 0);
		sketch.isovalue = within;
		draw_sketch(&sketch, (enum gz_illustration_drawing)drawing);
		assert_memory_equal(sketch.image.pixels, before.pixels, 4 * (size_t)PIXELS);
		gz_image_free(&before);
	}
	close_sketch(&sketch);
}

/* A ball with a hole, every third triangle turned, every fifth without area, and no normals. */
static void broken_mesh_takes_marks(void **state)
{
	(void)state;
	static const int dims[3] = { 4, 4, 4 };
	static const double spacing[3] = { 10, 10, 10 };
	struct gz_mesh ball = mesh_ball(12, 4);
	struct gz_object object = { .id = 1, .mesh = &ball };
	struct sketch sketch = { .volume = field_volume(field_ball, dims, spacing, GZ_VOXEL_F32),
				 .objects = &object,
				 .count = 1 };
	object.volume = &sketch.volume;
	ball.triangle_count -= 40;
	for (size_t i = 0; i < ball.triangle_count; i++) {
		const uint32_t first = ball.triangles[i][0];
		if (i % 3 == 0) {
			ball.triangles[i][0] = ball.triangles[i][1];
			ball.triangles[i][1] = first;
		}
		if (i % 5 == 0)
			ball.triangles[i][2] = ball.triangles[i][1];
	}
	memset(ball.normals, 0, ball.vertex_count * sizeof *ball.normals);
	open_sketch(&sketch);
	for (int drawing = GZ_DRAWING_GREY; drawing <= GZ_DRAWING_HATCHES; drawing++) {
		draw_sketch(&sketch, (enum gz_illustration_drawing)drawing);
		assert_true(inked_pixels(&sketch) > 200);
		assert_int_equal(seen_objects(&sketch), 1);
	}
	close_sketch(&sketch);
	gz_mesh_free(&ball);
}

TEST_SUITE(illustrate_inputs)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(volume_of_one_label_is_drawn),
		cmocka_unit_test(volume_of_hundreds_of_labels_is_drawn),
		cmocka_unit_test(volume_of_thousands_of_labels_is_refused),
		cmocka_unit_test(object_without_triangles_is_no_hindrance),
		cmocka_unit_test(surface_that_vanishes_at_an_isovalue_comes_back),
		cmocka_unit_test(broken_mesh_takes_marks),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
