/* Scenes that show meshes of files, alone and beside a volume. */
#include "suite.h"

#include <stdio.h>
#include <string.h>

#include "base/captured_log.h"
#include "render/frame/picture_maker.h"
#include "render/scene/scene.h"
#include "volume_files.h"

/* A pyramid with its base at z = 10, whose box is 40 x 20 x 30 mm round (120, 10, 25). */
static const char pyramid[] =
	"ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n"
	"property float z\nelement face 5\nproperty list uchar int vertex_indices\nend_header\n"
	"100 0 10\n140 0 10\n140 20 10\n100 20 10\n120 10 40\n"
	"4 3 2 1 0\n3 0 1 4\n3 1 2 4\n3 2 3 4\n3 3 0 4\n";

#define PYRAMID "[object p]\nmesh = p.ply\ntechnique = isosurface\n"

static const char *write_scene(const char *text)
{
	files_write("p.ply", pyramid, sizeof pyramid - 1);
	return files_write("m.scene", text, strlen(text));
}

static struct gz_scene loaded(const char *text)
{
	struct gz_scene scene = { 0 };
	struct captured_log log;
	captured_log_init(&log, "*:warn");
	if (gz_scene_load(write_scene(text), NULL, &log.log, &scene) != GZ_OK)
		fail_msg("%s: %s", text, log.last);
	return scene;
}

static void scene_of_a_mesh_alone_has_its_box(void **state)
{
	(void)state;
	struct gz_scene scene = loaded(PYRAMID);
	struct gz_object objects[4];
	double half[3];
	gz_volume_half_extent(&scene.volume, half);
	assert_float_equal(half[0], 0.5, 1e-9);
	assert_float_equal(half[1], 0.25, 1e-9);
	assert_float_equal(half[2], 0.375, 1e-9);
	assert_float_equal(scene.volume.dims[0] * scene.volume.spacing[0], 40, 1e-9);
	assert_int_equal(gz_scene_list_objects(&scene, objects, 4), 1);
	assert_ptr_equal(objects[0].mesh, &scene.meshes[0]);
	assert_ptr_equal(objects[0].volume, &scene.volume);
	assert_int_equal(objects[0].id, 2);
	assert_string_equal(objects[0].technique->name, "isosurface");
	assert_int_equal(scene.meshes[0].triangle_count, 6);
	assert_true(scene.meshes[0].positions[4][0] == 0 && scene.meshes[0].positions[4][2] == 15);
	gz_scene_free(&scene);
	assert_null(scene.meshes);
}

static void mesh_beside_a_volume_keeps_its_place(void **state)
{
	(void)state;
	struct gz_scene scene = loaded("[volume]\nprocedural = shells\ndims = 16 16 16\n"
				       "[render]\ntechnique = isosurface\n" PYRAMID
				       "[object q]\nmesh = p.ply\ntechnique = isosurface\n"
				       "visible = no\n");
	struct gz_object objects[4];
	assert_int_equal(scene.volume.dims[0], 16);
	assert_int_equal(gz_scene_list_objects(&scene, objects, 4), 2);
	assert_null(objects[0].mesh);
	assert_int_equal(objects[0].id, 1);
	assert_string_equal(objects[0].technique->name, "isosurface");
	assert_ptr_equal(objects[1].mesh, &scene.meshes[0]);
	assert_int_equal(objects[1].id, 2);
	assert_true(scene.meshes[0].positions[4][0] == 120);
	assert_int_equal(gz_scene_list_objects(&scene, objects, 1), 2); /* the rest is counted */
	gz_scene_free(&scene);
}

static void flat_mesh_has_a_box_too(void **state)
{
	(void)state;
	static const char flat[] = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
				   "property float y\nproperty float z\nelement face 1\n"
				   "property list uchar int vertex_indices\nend_header\n"
				   "0 0 0\n8 0 0\n0 4 0\n3 0 1 2\n";
	files_write("flat.ply", flat, sizeof flat - 1);
	struct gz_scene scene = loaded("[object f]\nmesh = flat.ply\ntechnique = isosurface\n");
	double half[3];
	gz_volume_half_extent(&scene.volume, half);
	assert_float_equal(half[1], 0.25, 1e-9);
	assert_true(half[2] > 0);
	gz_scene_free(&scene);
}

static void broken_meshes_break_the_scene_with_one_line(void **state)
{
	(void)state;
	static const struct {
		const char *text, *words;
		enum gz_result result;
	} cases[] = {
		{ "[object p]\nmesh = none.ply\ntechnique = isosurface\n",
		  "object p: none.ply is neither beside the scene", GZ_ERR_NOT_FOUND },
		{ "[object p]\nmesh = bad.ply\ntechnique = isosurface\n", "does not begin with ply",
		  GZ_ERR_FORMAT },
		{ "[object p]\nmesh = point.ply\ntechnique = isosurface\n",
		  "its meshes have no extent", GZ_ERR_FORMAT },
		{ "[object p]\nmesh = m.scene\ntechnique = isosurface\n",
		  "read from .ply, .obj or .stl files", GZ_ERR_UNSUPPORTED },
		{ "[object p]\nmesh = p.ply\n", "does not show mesh; set technique = isosurface",
		  GZ_ERR_FORMAT },
		{ PYRAMID "[render]\ntechnique = raycast\n",
		  "render.technique: raycast does not show what [object p] has; set it to auto",
		  GZ_ERR_FORMAT },
	};
	static const char bad[] = "solid\n";
	static const char point[] = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
				    "property float y\nproperty float z\nend_header\n1 2 3\n";
	files_write("bad.ply", bad, sizeof bad - 1);
	files_write("point.ply", point, sizeof point - 1);
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		struct gz_scene scene = { .has_display = true };
		struct captured_log log;
		captured_log_init(&log, "*:warn");
		const enum gz_result result =
			gz_scene_load(write_scene(cases[i].text), NULL, &log.log, &scene);
		if (result != cases[i].result || log.messages != 1 ||
		    !strstr(log.last, cases[i].words))
			fail_msg("%s: result %d, %d lines, \"%s\"", cases[i].text, (int)result,
				 log.messages, log.last);
		assert_true(scene.has_display);
	}
}

static void trying_a_scene_finds_a_missing_mesh(void **state)
{
	(void)state;
	struct gz_scene_settings settings;
	struct gz_scene_source source = { .path = write_scene(PYRAMID) };
	assert_int_equal(gz_scene_try(&source, NULL, &settings), GZ_OK);
	source.path = write_scene("[object p]\nmesh = none.ply\ntechnique = isosurface\n");
	assert_int_equal(gz_scene_try(&source, NULL, &settings), GZ_ERR_NOT_FOUND);
}

static void mesh_of_a_file_is_drawn(void **state)
{
	(void)state;
	enum { WIDTH = 60, HEIGHT = 40 };
	struct gz_scene scene = loaded(PYRAMID "[camera]\neye = 0 -2 0\n[isosurface]\n"
					       "colour = 0 1 0\n[light]\nambient = 1\n");
	const struct gz_picture_maker_params params = { .backend = "cpu" };
	const struct gz_foveation full = gz_foveation_full();
	const struct gz_display display = gz_display_default(WIDTH, HEIGHT);
	const struct gz_picture_request request = {
		.camera = &scene.settings.camera,
		.settings = &scene.settings.rays,
		.foveation = &full,
		.display = &display,
		.focus = gz_focus_at((struct gz_point) { 0.5F, 0.5F }),
		.width = WIDTH,
		.height = HEIGHT,
	};
	struct gz_picture_maker *maker = NULL;
	struct gz_image *image = NULL;
	struct gz_object objects[2];
	const size_t count = gz_scene_list_objects(&scene, objects, 2);
	assert_int_equal(gz_picture_maker_create(&params, NULL, &maker), GZ_OK);
	if (objects[0].technique->check("cpu", NULL, NULL) == GZ_OK) {
		assert_int_equal(gz_picture_maker_show(maker, objects, count), GZ_OK);
		assert_int_equal(gz_picture_make(maker, &request, &image, NULL), GZ_OK);
		const uint8_t *middle = image->pixels + 4 * (HEIGHT / 2 * WIDTH + WIDTH / 2);
		assert_true(middle[1] == 255 && middle[0] < 80);
		assert_int_equal(image->pixels[1], 0);
	} else {
		assert_int_equal(gz_picture_maker_show(maker, objects, count), GZ_ERR_UNSUPPORTED);
	}
	gz_picture_maker_destroy(&maker);
	gz_scene_free(&scene);
}

TEST_SUITE(scene_mesh)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(scene_of_a_mesh_alone_has_its_box),
		cmocka_unit_test(mesh_beside_a_volume_keeps_its_place),
		cmocka_unit_test(flat_mesh_has_a_box_too),
		cmocka_unit_test(broken_meshes_break_the_scene_with_one_line),
		cmocka_unit_test(trying_a_scene_finds_a_missing_mesh),
		cmocka_unit_test(mesh_of_a_file_is_drawn),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
