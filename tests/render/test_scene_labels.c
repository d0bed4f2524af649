/* Scenes that show labels, each with a surface and a colour of its own. */
#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/captured_log.h"
#include "render/frame/picture_maker.h"
#include "render/scene/scene.h"
#include "render/scene/scene_write.h"
#include "volume_files.h"

/* Two blocks side by side, 12 x 8 x 8 mm together: label 5 on the left and 9 on the right. */
static const char head[] = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 8 6 6\nencoding: raw\n"
			   "spacings: 2 2 2\n\n";

#define BLOCKS_MORE "[object c]\nlabels = l.nrrd\ntechnique = isosurface\n"
#define BLOCKS      "[object b]\nlabels = l.nrrd\ntechnique = isosurface\n"

/* What is lit by ambient light alone has its colour. */
#define EVEN_LIGHT "[light]\nambient = 1\ndiffuse = 0\nspecular = 0\n"

static const char *write_scene(const char *text)
{
	uint8_t voxels[8 * 6 * 6] = { 0 };
	for (int z = 1; z < 5; z++)
		for (int y = 1; y < 5; y++)
			for (int x = 1; x < 7; x++)
				voxels[(z * 6 + y) * 8 + x] = x < 4 ? 5 : 9;
	files_write_text("l.nrrd", head, voxels, sizeof voxels);
	return files_write("l.scene", text, strlen(text));
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

static void each_label_is_an_object_with_a_colour(void **state)
{
	(void)state;
	struct gz_scene scene = loaded(BLOCKS "[labels]\nsmoothing = 0\n");
	struct gz_object objects[4];
	assert_int_equal(gz_scene_list_objects(&scene, objects, 4), 2);
	assert_int_equal(objects[0].id, gz_scene_label_id(0, 0));
	assert_int_equal(objects[1].id, gz_scene_label_id(0, 1));
	assert_int_equal(objects[1].id & 255, 2);
	for (size_t i = 0; i < 2; i++) {
		float colour[3];
		gz_label_colour(i == 0 ? 5 : 9, colour);
		assert_memory_equal(objects[i].colour, colour, sizeof colour);
		assert_ptr_equal(objects[i].mesh, &scene.labels[0].items[i].mesh);
		assert_int_equal(scene.labels[0].items[i].voxels, 48);
		/* 4 x 4 faces between both */
		assert_int_equal(objects[i].mesh->shared_count, 32);
	}
	/* The box of both is the world. */
	assert_float_equal(scene.volume.dims[0] * scene.volume.spacing[0], 12, 0.3);
	assert_float_equal(scene.volume.dims[1] * scene.volume.spacing[1], 8, 0.3);
	gz_scene_free(&scene);
	assert_null(scene.labels);
}

static void hidden_labels_and_those_beside_a_volume_are_listed_right(void **state)
{
	(void)state;
	struct gz_scene scene = loaded("[volume]\nprocedural = shells\ndims = 16 16 16\n" BLOCKS
				       "[object c]\nlabels = l.nrrd\ntechnique = isosurface\n"
				       "visible = no\n");
	struct gz_object objects[8];
	assert_int_equal(scene.volume.dims[0], 16);
	assert_int_equal(gz_scene_list_objects(&scene, objects, 8), 3);
	assert_int_equal(objects[0].id, 1);
	assert_null(objects[0].colour);
	assert_int_equal(objects[2].id, gz_scene_label_id(0, 1));
	gz_scene_free(&scene);
}

static void names_of_a_file_are_those_of_objects(void **state)
{
	(void)state;
	static const char table[] = "5 left 255 0 51 0\n6 none 1 1 1 0\n";
	files_write("l.txt", table, sizeof table - 1);
	struct gz_scene scene = loaded(BLOCKS);
	struct gz_object objects[4];
	assert_int_equal(gz_scene_list_objects(&scene, objects, 4), 2);
	assert_string_equal(objects[0].name, "left");
	assert_float_equal(objects[0].colour[2], 0.2, 1e-6);
	assert_null(objects[1].name);
	assert_ptr_equal(gz_scene_label_of(&scene, objects[1].id), &scene.labels[0].items[1]);
	assert_null(gz_scene_label_of(&scene, gz_scene_label_id(0, 2)));
	assert_null(gz_scene_label_of(&scene, gz_scene_label_id(1, 0)));
	assert_null(gz_scene_label_of(&scene, 1));
	gz_scene_free(&scene);
	/* A file that is named counts more; one that only lies there need not be of names. */
	files_write("named", "9 right\n", 8);
	scene = loaded(BLOCKS "[labels]\nnames = named\n");
	assert_int_equal(gz_scene_list_objects(&scene, objects, 4), 2);
	assert_null(objects[0].name);
	assert_string_equal(objects[1].name, "right");
	gz_scene_free(&scene);
	files_write("l.txt", "notes\n", 6);
	scene = loaded(BLOCKS);
	assert_null(scene.labels[0].items[0].name[0] ? "named" : NULL);
	gz_scene_free(&scene);
	remove(files_write("l.txt", "", 0));
}

/* The farthest place from the middle. */
static double farthest(const struct gz_scene *scene)
{
	const struct gz_mesh *mesh = &scene->labels[0].items[0].mesh;
	double most = 0;
	for (size_t v = 0; v < mesh->vertex_count; v++)
		for (int axis = 0; axis < 3; axis++)
			most = fmax(most, fabs((double)mesh->positions[v][axis]));
	return most;
}

/* Make the labels of a scene with another look; what it had is freed. */
static enum gz_result make_again(struct gz_scene *scene, const char *path,
				 const struct gz_label_look *look)
{
	struct gz_scene_settings settings = scene->settings;
	const struct gz_scene_label_request request = { .name = path,
							.settings = &settings,
							.centre = scene->centre };
	struct gz_label_surfaces *made = NULL;
	settings.labels = *look;
	const enum gz_result result = gz_scene_make_labels(&request, NULL, &made);
	if (result != GZ_OK) {
		assert_null(made);
		return result;
	}
	assert_ptr_not_equal(made, scene->labels);
	gz_scene_free_labels(scene, scene->labels);
	scene->labels = made;
	return GZ_OK;
}

static void labels_are_made_again_with_another_look(void **state)
{
	(void)state;
	static const char text[] = BLOCKS "[labels]\nsmoothing = 0\n";
	struct gz_scene scene = loaded(text);
	const char *path = write_scene(text);
	struct gz_label_look look = { .smoothing = 0, .reach = 0.5 };
	const double before_mm = farthest(&scene);
	assert_int_equal(make_again(&scene, path, &look), GZ_OK);
	assert_float_equal(farthest(&scene), before_mm, 0); /* about the same centre */
	look.smoothing = 8;
	assert_int_equal(make_again(&scene, path, &look), GZ_OK);
	assert_true(fabs(farthest(&scene) - before_mm) > 0.01);
	snprintf(look.names, sizeof look.names, "nowhere");
	assert_int_equal(make_again(&scene, path, &look), GZ_ERR_NOT_FOUND);
	gz_scene_free(&scene);
	gz_scene_free_labels(&scene, NULL);
}

/* A picture of the scene by rays at surfaces; false without Embree. */
enum { PICTURE_PX = 48 };

static bool draw(const struct gz_scene *scene, struct gz_image *image)
{
	const struct gz_picture_maker_params params = { .backend = "cpu" };
	const struct gz_foveation full = gz_foveation_full();
	const struct gz_display display = gz_display_default(PICTURE_PX, PICTURE_PX);
	const struct gz_picture_request request = {
		.camera = &scene->settings.camera,
		.settings = &scene->settings.rays,
		.foveation = &full,
		.display = &display,
		.focus = gz_focus_at((struct gz_point) { 0.5F, 0.5F }),
		.width = PICTURE_PX,
		.height = PICTURE_PX,
		.image = image,
	};
	struct gz_picture_maker *maker = NULL;
	struct gz_image *made;
	struct gz_object objects[4];
	const size_t count = gz_scene_list_objects(scene, objects, 4);
	assert_int_equal(gz_picture_maker_create(&params, NULL, &maker), GZ_OK);
	const bool drawn = gz_picture_maker_show(maker, objects, count) == GZ_OK;
	if (drawn)
		assert_int_equal(gz_picture_make(maker, &request, &made, NULL), GZ_OK);
	gz_picture_maker_destroy(&maker);
	return drawn;
}

static bool has_colour(const struct gz_image *image, int x, int y, int32_t label)
{
	const uint8_t *pixel = image->pixels + 4 * (y * PICTURE_PX + x);
	float colour[3];
	gz_label_colour(label, colour);
	for (int i = 0; i < 3; i++)
		if (abs(pixel[i] - (int)(colour[i] * 255 + 0.5F)) > 1)
			return false;
	return true;
}

static void labels_are_drawn_in_their_colours(void **state)
{
	(void)state;
	struct gz_scene scene = loaded(BLOCKS EVEN_LIGHT "[camera]\neye = 0 -2.5 0\n");
	struct gz_image image = { 0 };
	if (draw(&scene, &image)) {
		for (int y = PICTURE_PX / 2 - 3; y < PICTURE_PX / 2 + 3; y++)
			for (int x = 1; x < 5; x++) {
				assert_true(has_colour(&image, PICTURE_PX / 2 - 1 - x, y, 5));
				assert_true(has_colour(&image, PICTURE_PX / 2 + x, y, 9));
			}
	}
	gz_image_free(&image);
	gz_scene_free(&scene);
}

/* Both labels have the face between them. Seen from within one it is the other. */
static void face_between_neighbours_has_the_colour_of_the_far_one(void **state)
{
	(void)state;
	static const struct {
		const char *text;
		int32_t wanted;
	} views[] = {
		{ BLOCKS EVEN_LIGHT "[camera]\neye = -2.5 0.1 0.2\n[clip]\nleast = 0.25 0 0\n", 9 },
		{ BLOCKS EVEN_LIGHT "[camera]\neye = 2.5 0.1 0.2\n[clip]\ngreatest = 0.75 1 1\n",
		  5 },
		/* An outer wall is seen from within. */
		{ BLOCKS EVEN_LIGHT "[camera]\neye = 2.5 0.1 0.2\n[clip]\ngreatest = 0.25 1 1\n",
		  5 },
	};
	for (size_t i = 0; i < sizeof views / sizeof views[0]; i++) {
		struct gz_scene scene = loaded(views[i].text);
		struct gz_image image = { 0 };
		if (draw(&scene, &image))
			for (int y = PICTURE_PX / 2 - 4; y < PICTURE_PX / 2 + 4; y++)
				for (int x = PICTURE_PX / 2 - 4; x < PICTURE_PX / 2 + 4; x++)
					if (!has_colour(&image, x, y, views[i].wanted))
						fail_msg("view %zu: pixel %d, %d is not label %d",
							 i, x, y, views[i].wanted);
		gz_image_free(&image);
		gz_scene_free(&scene);
	}
}

static void check_refusal(const char *scene_text, const char *said)
{
	struct gz_scene scene;
	struct captured_log log;
	captured_log_init(&log, "*:warn");
	const char *path = write_scene(scene_text);
	if (gz_scene_load(path, NULL, &log.log, &scene) == GZ_OK)
		fail_msg("%s is shown", scene_text);
	if (!strstr(log.last, said))
		fail_msg("%s: without \"%s\": %s", scene_text, said, log.last);
}

static void volumes_that_are_no_labels_are_refused_by_name(void **state)
{
	(void)state;
	const float values[2] = { 1, 2.5F };
	files_write_text("f.nrrd",
			 "NRRD0004\ntype: float\ndimension: 3\nsizes: 2 1 1\nencoding: raw\n"
			 "endian: little\n\n",
			 values, sizeof values);
	check_refusal("[object a]\nlabels = f.nrrd\ntechnique = isosurface\n",
		      "it has the value 2.5");
	files_write("named", "notes\n", 6);
	check_refusal(BLOCKS "[labels]\nnames = named\n", "named:1: no names of labels");
	check_refusal(BLOCKS "[labels]\nnames = nowhere\n", "labels.names: nowhere is neither");
	const uint8_t nothing[2] = { 0, 0 };
	files_write_text("n.nrrd",
			 "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 1 1\nencoding: raw\n\n",
			 nothing, sizeof nothing);
	check_refusal("[object a]\nlabels = n.nrrd\ntechnique = isosurface\n", "have no extent");
	check_refusal("[object a]\nlabels = none.nrrd\ntechnique = isosurface\n", "none.nrrd");
}

static void regions_choose_labels_by_name_and_number(void **state)
{
	(void)state;
	static const struct {
		const char *regions;
		bool left, right, nameless; /* 37 Hippocampus_L, 38 Hippocampus_R, 4 */
	} cases[] = {
		{ "", 1, 1, 1 },
		{ "Hippocampus_*", 1, 1, 0 },
		{ "37 4", 1, 0, 1 },
		{ "*_?  -*_R", 1, 0, 0 },
		{ "-38", 1, 0, 1 },
		{ "-* 38", 0, 1, 0 },
		{ "hippocampus_L", 0, 0, 0 },
		{ "3", 0, 0, 0 },
	};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		struct gz_scene_object object = { 0 };
		strcpy(object.regions, cases[i].regions);
		if (gz_scene_object_has_region(&object, 37, "Hippocampus_L") != cases[i].left ||
		    gz_scene_object_has_region(&object, 38, "Hippocampus_R") != cases[i].right ||
		    gz_scene_object_has_region(&object, 4, "") != cases[i].nameless)
			fail_msg("regions '%s'", cases[i].regions);
	}
}

static void objects_share_labels_by_regions(void **state)
{
	(void)state;
	struct gz_object objects[4];
	struct gz_scene scene =
		loaded("[object a]\nlabels = l.nrrd\ntechnique = illustrate\nregions = 9\n"
		       "importance = 1\ntemplate = vessels\n"
		       "[object b]\nlabels = l.nrrd\ntechnique = illustrate\nregions = -9\n"
		       "transparency = 0.75\n");
	assert_int_equal(gz_scene_list_objects(&scene, objects, 4), 2);
	assert_int_equal(gz_scene_label_of(&scene, objects[0].id)->number, 9);
	assert_int_equal(gz_scene_label_of(&scene, objects[1].id)->number, 5);
	assert_true(objects[0].style->importance == 1 && objects[0].style->transparency == 0);
	assert_true(objects[1].style->importance == 0.5 && objects[1].style->transparency == 0.75);
	assert_int_equal(objects[0].shading_template->edge_emphasis, GZ_TEMPLATE_LARGE);
	assert_null(objects[1].shading_template);
	assert_string_equal(objects[0].input, files_path("l.nrrd"));
	gz_scene_free(&scene);
}

static void wrong_templates_and_regions_are_refused(void **state)
{
	(void)state;
	files_write("own.template", "[template]\nforeground = +\n", 26);
	files_write("wrong.template", "[template]\nforegroundd = +\n", 27);
	struct gz_scene scene = loaded(BLOCKS "template = own.template\n");
	assert_int_equal(scene.settings.objects.items[0].shading_template.foreground,
			 GZ_TEMPLATE_LARGE);
	gz_scene_free(&scene);
	check_refusal(BLOCKS "template = wrong.template\n", "wrong.template:2: ");
	check_refusal(BLOCKS "template = bones\n",
		      "object b.template: bones is neither a template (bone-structures, ");
	check_refusal(BLOCKS "[illustration]\ntemplate = bones\n", "illustration.template: bones");
	check_refusal("[object m]\nmesh = m.ply\ntechnique = illustrate\nregions = 2\n",
		      "only labels have regions");
	struct captured_log log;
	captured_log_init(&log, "*:warn");
	assert_int_equal(gz_scene_load(write_scene(BLOCKS "regions = 7\n" BLOCKS_MORE), NULL,
				       &log.log, &scene),
			 GZ_OK);
	assert_non_null(strstr(log.last, "no label has a name or number of regions = 7"));
	gz_scene_free(&scene);
}

static void regions_are_shown_in_a_way_of_their_own(void **state)
{
	(void)state;
	struct gz_scene scene = loaded(BLOCKS "importance = 0.25\ntransparency = 0.5\n"
					      "[region 3]\nobject = b\nlabel = 9\n"
					      "importance = 1\ntemplate = organs\n"
					      "[region 4]\nobject = c\nlabel = 5\n"
					      "visible = no\n");
	struct gz_scene_settings *settings = &scene.settings;
	const struct gz_scene_object *blocks = &settings->objects.items[0];
	struct gz_object objects[4];
	assert_int_equal(gz_scene_list_objects(&scene, objects, 4), 2);
	assert_ptr_equal(objects[0].style, &blocks->style);
	assert_null(objects[0].shading_template);
	assert_true(objects[1].style->importance == 1 && objects[1].style->transparency == 0);
	assert_int_equal(objects[1].shading_template->edge_emphasis, GZ_TEMPLATE_SMALL);
	/* Another region begins as its object is, in the first section that is free. */
	assert_null(gz_scene_region_of(&settings->regions, blocks, 5));
	struct gz_scene_region *left = gz_scene_region_take(&settings->regions, blocks, 5);
	assert_ptr_equal(left, &settings->regions.items[0]);
	assert_ptr_equal(gz_scene_region_take(&settings->regions, blocks, 5), left);
	assert_true(left->style.importance == 0.25 && left->style.transparency == 0.5);
	left->visible = false;
	assert_int_equal(gz_scene_list_objects(&scene, objects, 4), 1);
	assert_int_equal(objects[0].id, gz_scene_label_id(0, 1));
	for (int i = 100; gz_scene_region_take(&settings->regions, blocks, i); i++)
		assert_true(i < 100 + GZ_SCENE_REGIONS_MAX);
	gz_scene_free(&scene);
}

static void regions_are_written_and_read_back(void **state)
{
	(void)state;
	struct gz_scene scene = loaded(BLOCKS), back;
	const char *path = files_write("l.scene", "; mine\n" BLOCKS, 7 + sizeof BLOCKS - 1);
	const struct gz_scene_saved saved = { &scene.settings, false, path };
	struct gz_scene_region *region =
		gz_scene_region_take(&scene.settings.regions, &scene.settings.objects.items[0], 9);
	region->visible = false;
	region->style.transparency = 1.0 / 3;
	assert_int_equal(gz_scene_write(&saved, path, NULL), GZ_OK);
	assert_int_equal(gz_scene_load(path, NULL, NULL, &back), GZ_OK);
	assert_true(gz_scene_settings_same(&back.settings, &scene.settings));
	back.settings.regions.items[0].style.transparency = 0;
	assert_false(gz_scene_settings_same(&back.settings, &scene.settings));
	gz_scene_free(&back);
	gz_scene_free(&scene);
}

/* What is at the middle of each half of a picture, and at its edge. */
static void check_picks(const char *technique, const char *more, uint32_t left, uint32_t edge)
{
	char text[256];
	snprintf(text, sizeof text, "[object b]\nlabels = l.nrrd\ntechnique = %s\n%s%s", technique,
		 more, "[camera]\neye = 0 -2.5 0\n");
	const struct gz_picture_maker_params params = { .backend = "cpu" };
	struct gz_scene scene = loaded(text);
	struct gz_picture_maker *maker = NULL;
	struct gz_object objects[4];
	struct gz_pick pick = { 0 };
	const size_t count = gz_scene_list_objects(&scene, objects, 4);
	struct gz_pick_request request = {
		.camera = &scene.settings.camera,
		.settings = &scene.settings.rays,
		.width = PICTURE_PX,
		.height = PICTURE_PX,
		.x = PICTURE_PX / 2.0 - 3,
		.y = PICTURE_PX / 2.0,
	};
	assert_int_equal(gz_picture_maker_create(&params, NULL, &maker), GZ_OK);
	assert_int_equal(gz_picture_maker_pick(maker, &request, &pick), GZ_ERR_INVAL);
	if (gz_picture_maker_show(maker, objects, count) == GZ_OK) {
		assert_int_equal(gz_picture_maker_pick(maker, &request, &pick), GZ_OK);
		assert_int_equal(gz_pick_most_seen(&pick), left);
		/* The front of the blocks is 4 mm before the centre, and the box is 12 mm long. */
		if (left > 0)
			assert_float_equal(pick.depths[0], 2.5 - 4.0 / 12, 0.06);
		request.x = 0.5;
		assert_int_equal(gz_picture_maker_pick(maker, &request, &pick), GZ_OK);
		assert_int_equal(gz_pick_most_seen(&pick), edge);
	}
	gz_picture_maker_destroy(&maker);
	gz_scene_free(&scene);
}

static void object_at_a_place_is_found(void **state)
{
	(void)state;
	const uint32_t left = gz_scene_label_id(0, 0);
	check_picks("isosurface", "", left, 0);
	check_picks("illustrate", "", left, 0);
	check_picks("illustrate", "transparency = 0.5\n", left, 0);
	check_picks("illustrate", "transparency = 1\n", 0, 0);
	check_picks("isosurface", "[clip]\ngreatest = 0.2 1 1\n", 0, 0);
}

static void object_that_is_seen_most_counts(void **state)
{
	(void)state;
	const struct gz_pick skin = { 2, { 7, 3 }, { 1, 2 }, { 0.2, 0.8 } };
	const struct gz_pick alike = { 2, { 7, 3 }, { 1, 2 }, { 0.5, 0.5 } };
	const struct gz_pick none = { 0 };
	assert_int_equal(gz_pick_most_seen(&skin), 3);
	assert_int_equal(gz_pick_most_seen(&alike), 7);
	assert_int_equal(gz_pick_most_seen(&none), 0);
}

TEST_SUITE(scene_labels)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(each_label_is_an_object_with_a_colour),
		cmocka_unit_test(hidden_labels_and_those_beside_a_volume_are_listed_right),
		cmocka_unit_test(names_of_a_file_are_those_of_objects),
		cmocka_unit_test(labels_are_made_again_with_another_look),
		cmocka_unit_test(labels_are_drawn_in_their_colours),
		cmocka_unit_test(face_between_neighbours_has_the_colour_of_the_far_one),
		cmocka_unit_test(volumes_that_are_no_labels_are_refused_by_name),
		cmocka_unit_test(regions_choose_labels_by_name_and_number),
		cmocka_unit_test(objects_share_labels_by_regions),
		cmocka_unit_test(wrong_templates_and_regions_are_refused),
		cmocka_unit_test(regions_are_shown_in_a_way_of_their_own),
		cmocka_unit_test(regions_are_written_and_read_back),
		cmocka_unit_test(object_at_a_place_is_found),
		cmocka_unit_test(object_that_is_seen_most_counts),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
