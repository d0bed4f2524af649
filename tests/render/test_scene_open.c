#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/captured_log.h"
#include "render/mesh/mesh_read.h"
#include "render/scene/scene_open.h"
#include "render/scene/scene_picture.h"
#include "render/transfer/content.h"
#include "render/transfer/transfer_presets.h"
#include "volume_files.h"

static unsigned char voxels[4 * 4 * 8];

static struct gz_scene opened(const char *path, const struct gz_raw_layout *raw)
{
	struct gz_scene scene = { 0 };
	struct captured_log log;
	const struct gz_scene_request request = { .path = path, .raw = raw };
	captured_log_init(&log, NULL);
	if (gz_scene_open(&request, &log.log, &scene) != GZ_OK)
		fail_msg("%s: %s", path, log.last);
	return scene;
}

static void assert_refused(const char *path, const struct gz_raw_layout *raw,
			   enum gz_result expected, const char *words)
{
	struct gz_scene scene = { .has_display = true };
	struct captured_log log;
	const struct gz_scene_request request = { .path = path, .raw = raw };
	captured_log_init(&log, NULL);
	const enum gz_result result = gz_scene_open(&request, &log.log, &scene);
	if (result != expected || !strstr(log.last, words))
		fail_msg("%s: result %d, \"%s\" lacks \"%s\"", path, result, log.last, words);
	assert_true(scene.has_display);
}

static const char *write_nrrd(const char *name)
{
	for (size_t i = 0; i < sizeof voxels; i++)
		voxels[i] = (unsigned char)(i * 2);
	return files_write_text(name,
				"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4 4 8\n"
				"spacings: 1 1 1\nencoding: raw\n\n",
				voxels, sizeof voxels);
}

static void kind_of_a_file_follows_from_its_name(void **state)
{
	(void)state;
	static const struct {
		const char *name;
		enum gz_file_kind kind;
	} rows[] = {
		{ "a.scene", GZ_FILE_SCENE },       { "a.PNG", GZ_FILE_PICTURE },
		{ "a.tf", GZ_FILE_TRANSFER },       { "a.gzl", GZ_FILE_GAZE_LOG },
		{ "a.nii.gz", GZ_FILE_VOLUME },     { "a.mhd", GZ_FILE_VOLUME },
		{ "a.gzb", GZ_FILE_VOLUME },        { "a.dcm", GZ_FILE_VOLUME },
		{ "a.raw", GZ_FILE_RAW },           { "a.raw.zst", GZ_FILE_RAW },
		{ "a_u8.dat.gz", GZ_FILE_RAW },     { "a.bin", GZ_FILE_RAW },
		{ "a.bgeo", GZ_FILE_VOLUME },       { "a.particles", GZ_FILE_VOLUME },
		{ "a.ply", GZ_FILE_VOLUME },        { "a.xyz.gz", GZ_FILE_VOLUME },
		{ "nothing known", GZ_FILE_OTHER }, { "a.ini", GZ_FILE_OTHER },
	};
	for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++)
		if (gz_file_kind_of(rows[i].name) != rows[i].kind)
			fail_msg("%s: %d", rows[i].name, gz_file_kind_of(rows[i].name));
	assert_int_equal(gz_file_kind_of(files_folder()), GZ_FILE_VOLUME);
}

/* Of a scene nobody expects zero bytes: such a file is refused as a volume, with all endings. */
static void binary_file_is_no_scene(void **state)
{
	(void)state;
	assert_int_equal(gz_file_kind_of(files_write("unknown", "a\0b", 3)), GZ_FILE_VOLUME);
	assert_refused(files_path("unknown"), NULL, GZ_ERR_UNSUPPORTED, "unknown format");
	assert_int_equal(gz_file_kind_of(files_write("unknown", "[a]\n", 4)), GZ_FILE_OTHER);
}

static void volume_is_no_scene_to_load(void **state)
{
	(void)state;
	struct gz_scene scene = { 0 };
	struct captured_log log;
	captured_log_init(&log, NULL);
	assert_int_equal(gz_scene_load(write_nrrd("alone.nrrd"), NULL, &log.log, &scene),
			 GZ_ERR_FORMAT);
	assert_non_null(strstr(log.last, "alone.nrrd: not a scene; open it in gazeview"));
	assert_int_equal(gz_scene_load(files_path("missing.nrrd"), NULL, &log.log, &scene),
			 GZ_ERR_NOT_FOUND);
	assert_non_null(strstr(log.last, "no such file"));
}

/* How far from the picture's middle the corners of a box are at most, as a share of the picture. */
static double widest_corner(const struct gz_camera *camera, const struct gz_volume *volume,
			    const struct gz_clip_region *box)
{
	double half[3], widest = 0;
	gz_volume_half_extent(volume, half);
	for (int corner = 0; corner < 8; corner++) {
		double at[3];
		struct gz_point point;
		for (int i = 0; i < 3; i++)
			at[i] = (2 * (corner >> i & 1 ? box->greatest[i] : box->least[i]) - 1) *
				half[i];
		assert_true(gz_camera_project(camera, 300, 300, at, &point));
		widest = fmax(widest, fmax(fabs(point.x - 0.5), fabs(point.y - 0.5)));
	}
	return widest;
}

/* Below, the test's volume is background. */
static void volume_without_a_scene_is_lit_and_what_is_seen_of_it_fills_the_view(void **state)
{
	(void)state;
	struct gz_scene scene = opened(write_nrrd("v.nrrd"), NULL);
	struct gz_clip_region content;
	assert_true(scene.settings.volume_file[0] == '/');
	assert_true(scene.transfer.count >= 1);
	assert_int_equal(scene.settings.rays.shading, GZ_SHADING_GRADIENT);
	gz_content_find(&scene.volume, &scene.transfer, &gz_clip_whole, &content);
	assert_true(content.least[2] >= 0.25 && content.greatest[2] == 1);
	const double widest = widest_corner(&scene.settings.camera, &scene.volume, &content);
	if (!(widest > 0.44 && widest < 0.46))
		fail_msg("the content takes %g of half the picture", 2 * widest);
	gz_scene_free(&scene);
}

static enum gz_result ask_for_ct_bone_unlit(void *user, struct gz_scene_settings *settings)
{
	(void)user;
	settings->rays.shading = GZ_SHADING_NONE;
	settings->transfer_preset = 1 + GZ_PRESET_CT_BONE;
	return GZ_OK;
}

static void shading_and_preset_of_the_request_are_kept(void **state)
{
	(void)state;
	struct gz_scene asked, usual = opened(write_nrrd("v.nrrd"), NULL);
	const struct gz_scene_request request = { .path = files_path("v.nrrd"),
						  .change = ask_for_ct_bone_unlit };
	assert_int_equal(gz_scene_open(&request, NULL, &asked), GZ_OK);
	assert_int_equal(asked.settings.rays.shading, GZ_SHADING_NONE);
	assert_false(gz_transfer_same(&asked.transfer, &usual.transfer));
	gz_scene_free(&asked);
	gz_scene_free(&usual);
}

static enum gz_result count_and_ask_for_lit_xray(void *user, struct gz_scene_settings *settings)
{
	++*(int *)user;
	settings->rays.shading = GZ_SHADING_GRADIENT;
	settings->transfer_preset = 1 + GZ_PRESET_XRAY;
	return GZ_OK;
}

static void request_changes_a_volume_once(void **state)
{
	(void)state;
	int calls = 0;
	struct gz_scene scene;
	const struct gz_scene_request request = { .path = write_nrrd("v.nrrd"),
						  .change = count_and_ask_for_lit_xray,
						  .user = &calls };
	assert_int_equal(gz_scene_open(&request, NULL, &scene), GZ_OK);
	assert_int_equal(calls, 1);
	assert_int_equal(scene.settings.rays.shading, GZ_SHADING_GRADIENT);
	gz_scene_free(&scene);
}

static enum gz_result take_transfer_of_others(void *user, struct gz_scene_settings *settings)
{
	snprintf(settings->transfer_file, sizeof settings->transfer_file, "%s", (const char *)user);
	return GZ_OK;
}

static enum gz_result ask_for_xray(void *user, struct gz_scene_settings *settings)
{
	(void)user;
	settings->transfer_preset = GZ_PRESET_XRAY + 1;
	return GZ_OK;
}

static void preset_that_shows_no_surfaces_is_not_lit(void **state)
{
	(void)state;
	const struct gz_scene_request request = { .path = write_nrrd("v.nrrd"),
						  .change = ask_for_xray };
	struct gz_scene scene;
	assert_int_equal(gz_scene_open(&request, NULL, &scene), GZ_OK);
	assert_int_equal(scene.settings.rays.shading, GZ_SHADING_NONE);
	gz_scene_free(&scene);
}

static void transfer_function_for_other_data_is_told(void **state)
{
	(void)state;
	static const char *const texts[] = { "range 1000 2000\n0.1 0 0 0 0\n0.2 1 1 1 1\n",
					     "range 0 2000\n0.1 0 0 0 0\n0.2 1 1 1 1\n" };
	for (int i = 0; i < 2; i++) {
		struct gz_scene scene;
		struct captured_log log;
		char file[GZ_PATH_SIZE];
		snprintf(file, sizeof file, "%s",
			 files_write("other.tf", texts[i], strlen(texts[i])));
		const struct gz_scene_request request = { .path = write_nrrd("v.nrrd"),
							  .change = take_transfer_of_others,
							  .user = file };
		captured_log_init(&log, NULL);
		assert_int_equal(gz_scene_open(&request, &log.log, &scene), GZ_OK);
		/* The data are 0 to 254. */
		assert_int_equal(strstr(log.last, "shows nothing of this volume") != NULL, i == 0);
		gz_scene_free(&scene);
	}
}

/* Two steps of 27 particles, which lie on a lattice and then closer together. */
static const char *write_liquid(const char *name)
{
	static unsigned char bytes[8 + 2 * 27 * 44];
	const uint32_t head[2] = { 2, 27 };
	memcpy(bytes, head, sizeof head); /* tests run on little-endian machines */
	for (int i = 0; i < 2 * 27; i++) {
		const float scale = i < 27 ? 0.1F : 0.05F;
		float numbers[11] = { 0 };
		numbers[0] = 0.5F + scale * (float)(i % 3);
		numbers[1] = 0.5F + scale * (float)(i / 3 % 3);
		numbers[2] = 0.5F + scale * (float)(i / 9 % 3);
		memcpy(bytes + 8 + 44 * i, numbers, sizeof numbers);
	}
	return files_write(name, bytes, sizeof bytes);
}

#define PLY_POINTS                                                    \
	"ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\n" \
	"property float y\nproperty float z\n"
#define PLY_NUMBERS "0 0 0\n8 0 0\n0 4 0\n0 0 2\n"

static void mesh_opens_without_a_scene(void **state)
{
	(void)state;
	struct gz_object object;
	const char *path =
		files_write_text("face.ply",
				 PLY_POINTS "element face 1\nproperty list uchar int "
					    "vertex_indices\nend_header\n" PLY_NUMBERS "3 1 2 3\n",
				 NULL, 0);
	assert_true(gz_mesh_has_faces(path));
	struct gz_scene scene = opened(path, NULL);
	assert_false(gz_scene_has_volume(&scene.settings));
	assert_int_equal(gz_scene_list_objects(&scene, &object, 1), 1);
	assert_string_equal(object.technique->name, "isosurface");
	assert_int_equal(object.mesh->triangle_count, 1);
	assert_true(scene.settings.objects.items[0].mesh[0] == '/');
	assert_true(scene.settings.camera.eye[1] > 0.5); /* y points to the front */
	gz_scene_free(&scene);
	/* Its points still make a volume for those who ask for one. */
	const struct gz_scene_request alone = { .path = path, .volume_alone = true };
	assert_int_equal(gz_scene_open(&alone, NULL, &scene), GZ_OK);
	assert_true(gz_scene_has_volume(&scene.settings));
	gz_scene_free(&scene);
	path = files_write_text("points.ply", PLY_POINTS "end_header\n" PLY_NUMBERS, NULL, 0);
	assert_false(gz_mesh_has_faces(path));
	scene = opened(path, NULL);
	assert_true(gz_scene_has_volume(&scene.settings));
	gz_scene_free(&scene);
	path = files_write_text("face.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n", NULL, 0);
	assert_int_equal(gz_file_kind_of(path), GZ_FILE_VOLUME);
	scene = opened(path, NULL);
	assert_int_equal(scene.meshes[0].triangle_count, 1);
	gz_scene_free(&scene);
	assert_false(gz_mesh_has_faces("none.ply"));
	path = files_write_text("broken.ply",
				PLY_POINTS "element face 1\nproperty list uchar int "
					   "vertex_indices\nend_header\n" PLY_NUMBERS "3 1 2 9\n",
				NULL, 0);
	assert_refused(path, NULL, GZ_ERR_FORMAT, "a corner that is not a vertex");
}

static void particles_open_as_a_volume(void **state)
{
	static const char *const texts[] = {
		"[volume]\nfile = a.particles\n[particles]\ncells = 40\n",
		"[object water]\nparticles = a.particles\n[particles]\ncells = 40\n",
	};
	(void)state;
	struct gz_scene scene = opened(write_liquid("a.particles"), NULL);
	assert_int_equal(scene.volume.dims[0], 256);
	assert_int_equal(scene.volume.time_points, 2);
	assert_true(scene.volume.stored_min == 0 && scene.volume.stored_max == 2);
	assert_true(scene.transfer.count >= 1);
	gz_scene_free(&scene);
	for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
		struct gz_object object;
		struct gz_volume second;
		const char *path = files_write("a.scene", texts[i], strlen(texts[i]));
		scene = opened(path, NULL);
		assert_int_equal(scene.volume.dims[2], 40);
		assert_int_equal(gz_scene_list_objects(&scene, &object, 1), 1);
		assert_ptr_equal(object.volume, &scene.volume);
		const struct gz_scene_time_point which = {
			.name = path,
			.settings = &scene.settings,
			.time_point = 1,
			.number_range = scene.volume.number_range,
		};
		assert_int_equal(gz_scene_load_time_point(&which, NULL, NULL, &second), GZ_OK);
		assert_memory_equal(second.spacing, scene.volume.spacing, sizeof second.spacing);
		assert_true(memcmp(second.voxels, scene.volume.voxels, gz_volume_bytes(&second)) !=
			    0);
		gz_volume_free(&second);
		gz_scene_free(&scene);
	}
	/* Without a name of its own a file is known by its content; of another content it is not.
	 */
	assert_int_equal(gz_file_kind_of(write_liquid("unnamed")), GZ_FILE_VOLUME);
	const char text[] = "[object water]\nparticles = n.nrrd\n";
	write_nrrd("n.nrrd");
	assert_refused(files_write("a.scene", text, sizeof text - 1), NULL, GZ_ERR_UNSUPPORTED,
		       "unknown kind of particles");
	assert_refused(files_write_text("g.vtk",
					"# vtk DataFile Version 3.0\na grid\nASCII\nDATASET "
					"STRUCTURED_POINTS\n",
					NULL, 0),
		       NULL, GZ_ERR_UNSUPPORTED, "VTK is not read");
}

static void fitted_camera_sees_the_box_in_either_projection(void **state)
{
	(void)state;
	struct gz_scene scene = opened(write_nrrd("v.nrrd"), NULL);
	struct gz_camera camera = scene.settings.camera;
	camera.projection = GZ_PROJECTION_ORTHOGRAPHIC;
	gz_camera_fit(&camera, &scene.volume, NULL);
	const double widest = widest_corner(&camera, &scene.volume, &gz_clip_whole);
	if (!(widest > 0.44 && widest < 0.46))
		fail_msg("the box takes %g of half the picture", 2 * widest);
	gz_scene_free(&scene);
}

static enum gz_result look_from_below(void *user, struct gz_scene_settings *settings)
{
	(void)user;
	settings->camera.eye[2] = -3;
	return GZ_OK;
}

static void camera_of_the_request_is_kept(void **state)
{
	(void)state;
	struct gz_scene scene;
	const struct gz_scene_request request = { .path = write_nrrd("v.nrrd"),
						  .change = look_from_below };
	assert_int_equal(gz_scene_open(&request, NULL, &scene), GZ_OK);
	assert_true(scene.settings.camera.eye[2] == -3 && scene.settings.camera.eye[1] == -2);
	gz_scene_free(&scene);
}

static void raw_file_opens_with_a_given_or_a_certain_layout(void **state)
{
	(void)state;
	const struct gz_raw_layout layout = { .dims = { 8, 4, 2 },
					      .type = GZ_RAW_INT16,
					      .big_endian = true,
					      .spacing = { 1, 1, 2 } };
	const char *told = files_write("told.raw", voxels, sizeof voxels);
	struct gz_scene scene = opened(told, &layout);
	assert_int_equal(scene.volume.dims[0], 8);
	assert_int_equal(scene.settings.endian, 1);
	assert_true(scene.settings.spacing[2] == 2);
	gz_scene_free(&scene);
	scene = opened(files_write("a_4x4x8_uint8.raw", voxels, sizeof voxels), NULL);
	assert_int_equal(scene.volume.dims[2], 8);
	gz_scene_free(&scene);
	assert_refused(told, NULL, GZ_ERR_INVAL,
		       "told.raw: raw data without a header; give its layout");
	assert_refused(files_write("cut_2048x2048x2048_uint8.raw", voxels, sizeof voxels), NULL,
		       GZ_ERR_INVAL, "2048 x 2048 x 2048 uint8, which is 8589934592 bytes");
	assert_refused(files_write("a_4x4x4.raw", voxels, sizeof voxels), NULL, GZ_ERR_INVAL,
		       "--volume.dims \"4 4 4\" --volume.type uint16 would fit");
}

static void layout_for_a_file_with_a_header_is_refused(void **state)
{
	(void)state;
	const struct gz_raw_layout layout = { .dims = { 4, 4, 8 }, .spacing = { 1, 1, 1 } };
	assert_refused(write_nrrd("v.nrrd"), &layout, GZ_ERR_INVAL, "not a raw file");
	assert_refused("a.scene", &layout, GZ_ERR_INVAL, "not a raw file");
}

static void layout_for_a_raw_file_beats_its_content(void **state)
{
	(void)state;
	const struct gz_raw_layout layout = { .dims = { 4, 4, 4 }, .spacing = { 1, 1, 1 } };
	struct gz_scene scene = opened(write_nrrd("n.raw"), &layout);
	assert_int_equal(scene.volume.dims[2], 4);
	assert_memory_equal(scene.volume.voxels, "NRRD0004", 8);
	gz_scene_free(&scene);
}

static void files_that_show_nothing_are_refused(void **state)
{
	(void)state;
	assert_refused("a.tf", NULL, GZ_ERR_INVAL, "a transfer function shows nothing by itself");
	assert_refused("a.gzl", NULL, GZ_ERR_INVAL, "a gaze log shows nothing by itself");
	assert_refused(files_path("none.nii"), NULL, GZ_ERR_NOT_FOUND, "check the path");
	assert_refused(files_path("none.scene"), NULL, GZ_ERR_NOT_FOUND, "no such file");
	assert_refused(files_write("notes.txt", "milk\n", 5), NULL, GZ_ERR_FORMAT,
		       "notes.txt: neither a scene nor a volume");
	assert_refused(files_write("late.txt", "; a\n# b\n \nx\n[a]\n", 16), NULL, GZ_ERR_FORMAT,
		       "neither");
	/* What begins like a scene is read as one. */
	assert_refused(files_write("some.ini", "; a\n\n[a]\nb\n", 11), NULL, GZ_ERR_FORMAT,
		       "some.ini:4: ");
}

static void picture_opens_the_scene_that_it_shows(void **state)
{
	(void)state;
	struct gz_scene scene = opened(write_nrrd("v.nrrd"), NULL);
	struct gz_image image = { 0 };
	struct captured_log log;
	captured_log_init(&log, NULL);
	const char *path = files_path("p.png");
	assert_int_equal(gz_image_resize(&image, 4, 4), GZ_OK);
	memset(image.pixels, 0, (size_t)4 * 4 * 4);
	scene.settings.camera.fov_deg = 33;
	scene.transfer.points[0].opacity = 0.375;
	const struct gz_scene_saved saved = { &scene.settings, false, "" };
	assert_int_equal(
		gz_scene_picture_write(&image, &saved, &scene.transfer, &scene.volume, path, NULL),
		GZ_OK);
	gz_scene_free(&scene);
	scene = opened(path, NULL);
	assert_true(scene.settings.camera.fov_deg == 33);
	assert_true(scene.transfer.points[0].opacity == 0.375);
	gz_scene_free(&scene);
	/* The volume becomes another. */
	voxels[5] ^= 255;
	files_write_text("v.nrrd",
			 "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4 4 8\nspacings: 1 1 1\n"
			 "encoding: raw\n\n",
			 voxels, sizeof voxels);
	const struct gz_scene_request request = { .path = path };
	assert_int_equal(gz_scene_open(&request, &log.log, &scene), GZ_OK);
	assert_non_null(strstr(log.last, "was made from other data"));
	gz_scene_free(&scene);
	unlink(files_path("v.nrrd"));
	assert_refused(path, NULL, GZ_ERR_NOT_FOUND, "volume.file");
	gz_image_free(&image);
}

static void scene_without_a_transfer_function_gets_one(void **state)
{
	(void)state;
	struct gz_scene scene =
		opened(files_write_text("bare.scene",
					"[volume]\nprocedural = shells\ndims = 8 8 8\n", "", 0),
		       NULL);
	assert_true(scene.transfer.count > 1);
	assert_string_equal(scene.settings.transfer_file, "");
	gz_scene_free(&scene);
}

TEST_SUITE(scene_open)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(kind_of_a_file_follows_from_its_name),
		cmocka_unit_test(binary_file_is_no_scene),
		cmocka_unit_test(volume_is_no_scene_to_load),
		cmocka_unit_test(
			volume_without_a_scene_is_lit_and_what_is_seen_of_it_fills_the_view),
		cmocka_unit_test(transfer_function_for_other_data_is_told),
		cmocka_unit_test(shading_and_preset_of_the_request_are_kept),
		cmocka_unit_test(preset_that_shows_no_surfaces_is_not_lit),
		cmocka_unit_test(request_changes_a_volume_once),
		cmocka_unit_test(mesh_opens_without_a_scene),
		cmocka_unit_test(particles_open_as_a_volume),
		cmocka_unit_test(fitted_camera_sees_the_box_in_either_projection),
		cmocka_unit_test(camera_of_the_request_is_kept),
		cmocka_unit_test(raw_file_opens_with_a_given_or_a_certain_layout),
		cmocka_unit_test(layout_for_a_file_with_a_header_is_refused),
		cmocka_unit_test(layout_for_a_raw_file_beats_its_content),
		cmocka_unit_test(files_that_show_nothing_are_refused),
		cmocka_unit_test(picture_opens_the_scene_that_it_shows),
		cmocka_unit_test(scene_without_a_transfer_function_gets_one),
	};
	unsetenv("GAZECAST_DATA");
	return cmocka_run_group_tests(tests, NULL, NULL);
}
