#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/captured_log.h"
#include "base/text.h"
#include "render/plan/method.h"
#include "render/scene/scene.h"
#include "scene_text.h"
#include "volume_files.h"

#define VOLUME   "[volume]\nprocedural = shells\ndims = 12 10 8\n"
#define TRANSFER "[transfer]\nfile = ramp.tf\n"
#define SCENE    VOLUME TRANSFER

static void every_preset_parses(void **state)
{
	(void)state;
	struct gz_scene_settings settings = { 0 };
	struct gz_option_binding bindings[GZ_SCENE_TABLE_COUNT];
	gz_scene_bind(&settings, bindings);
	for (size_t i = 0; i < GZ_SCENE_TABLE_COUNT; i++)
		assert_int_equal(gz_options_preset(&bindings[i]), GZ_OK);
	assert_true(settings.camera.eye[1] == -2 && settings.camera.up[2] == 1);
	assert_true(settings.camera.fov_deg == 40 && settings.image_sampling_rate == 1);
	assert_true(settings.rays.ray_sampling_rate == 1.5);
	assert_int_equal(settings.camera.projection, GZ_PROJECTION_PERSPECTIVE);
	assert_int_equal(settings.foveation.method, gz_foveation_default().method);
}

/* Each choice's index must be the enum it stands for. */
static void choices_are_in_the_order_of_their_enums(void **state)
{
	(void)state;
	bool display;
	struct gz_scene_settings s = scene_of_text(
		"[volume]\nprocedural = supernova\n" TRANSFER
		"[camera]\nprojection = orthographic\n[render]\ninterpolation = nearest\n",
		&display);
	assert_int_equal(s.volume_procedural, GZ_PROCEDURAL_SUPERNOVA + 1);
	assert_int_equal(s.camera.projection, GZ_PROJECTION_ORTHOGRAPHIC);
	assert_int_equal(s.rays.interpolation, GZ_INTERPOLATION_NEAREST);
	s = scene_of_text("[volume]\nfile = a.raw\ndims = 1 2 3\ntype = float64\nendian = big\n"
			  "channels = 4\nopacity = alpha\n" TRANSFER,
			  &display);
	assert_int_equal(s.type, GZ_RAW_FLOAT64);
	assert_int_equal(s.channels, 4);
	assert_int_equal(s.opacity, GZ_OPACITY_ALPHA);
	assert_int_equal(s.endian, 1);
	assert_int_equal(s.dims[2], 3);
	assert_false(display);
}

static void every_section_is_read(void **state)
{
	(void)state;
	bool display = false;
	struct gz_scene_settings s = scene_of_text(
		SCENE "[camera]\neye = 1 2 3 ; a comment\nlook_at = 0.5 0 0\nup = 0 1 0\n"
		      "fov_deg = 30.5\nheight = 2\n[render]\nbackground = 0.1 0.2 0.3\n"
		      "ray_sampling_rate = 2\nimage_sampling_rate = 0.5\nshading = none\n"
		      "[foveation]\nmethod = acuity\n"
		      "[display]\npx = 1920 1080\nmm = 520 290\ndistance_mm = 650\n",
		&display);
	assert_true(s.camera.eye[2] == 3 && s.camera.look_at[0] == 0.5 && s.camera.up[1] == 1);
	assert_true(s.camera.fov_deg == 30.5 && s.camera.height == 2);
	assert_true(s.rays.background[2] == 0.3 && s.rays.ray_sampling_rate == 2);
	assert_true(s.image_sampling_rate == 0.5);
	assert_int_equal(s.foveation.method, GZ_METHOD_ACUITY);
	assert_true(display);
	assert_int_equal(s.display.px[0], 1920);
	assert_true(s.display.mm[1] == 290 && s.display.distance_mm == 650);
}

struct refusal {
	const char *text, *words;
};

static const struct refusal refusals[] = {
	{ "", "s.scene: volume.file: not given; name a volume" },
	{ TRANSFER, "s.scene: volume.file: not given; name a volume" },
	{ "[volume]\nfile = a.nii\nprocedural = shells\n" TRANSFER,
	  "s.scene: volume.file: given with volume.procedural; keep one" },
	{ "[volume]\nprocedural = shells\nendian = big\n" TRANSFER,
	  "s.scene: volume.procedural: takes dims, type and spacing only" },
	{ "[volume]\nprocedural = shells\nchannels = 3\n" TRANSFER,
	  "s.scene: volume.procedural: takes dims, type and spacing only" },
	{ "[volume]\nfile = a.nii\nchannels = 3\n" TRANSFER,
	  "s.scene: volume.dims: a raw file needs both dims and type" },
	{ "[volume]\nprocedural = shells\ntype = int16\n" TRANSFER,
	  "s.scene: volume.type: a procedural volume has uint8, uint16 or float32" },
	{ "[volume]\nfile = a.raw\ndims = 1 1 1\n" TRANSFER,
	  "s.scene: volume.dims: a raw file needs both dims and type" },
	{ "[volume]\nfile = a.nii\nspacing = 1 1 1\n" TRANSFER,
	  "s.scene: volume.dims: a raw file needs both dims and type" },
	{ SCENE "[camera]\neye = 0 0 0\n", "s.scene: camera.eye: is where camera.look_at is" },
	{ SCENE "[display]\npx = 10 10\n", "s.scene: display.mm: not given; px, mm and" },
	{ SCENE "[display]\nmm = 10 10\ndistance_mm = 1\n", "s.scene: display.px: not given" },
	{ SCENE "[camera]\nfov_deg = 180\n", "s.scene:7: camera.fov_deg: 180 is outside" },
	{ SCENE "[camera]\nfov_deg = nan\n", "s.scene:7: camera.fov_deg: nan is not a number" },
	{ SCENE "[camera]\neye = 1 2\n", "s.scene:7: camera.eye: 3 numbers expected, 2 given" },
	{ SCENE "[camera]\nfov = 40\n", "s.scene:7: camera.fov: " },
	{ SCENE "[clip]\nx = 1\n", "s.scene:7: clip.x: " },
	{ SCENE "[render]\nray_sampling_rate = 0\n", "s.scene:7: render.ray_sampling_rate: 0 is" },
	{ SCENE "[render]\nbackground = 0 0 1.5\n", "s.scene:7: render.background: 1.5 is" },
	{ SCENE "[clip]\nleast = 0 0.5 0\ngreatest = 1 0.5 1\n",
	  "s.scene: clip.least must be below clip.greatest" },
	{ SCENE "[clip]\nnormal = 0 0 0\n", "s.scene: clip.normal must not be 0 0 0" },
	{ SCENE "[clip]\noffset = 1.1\n", "s.scene:7: clip.offset: 1.1 is outside" },
	{ SCENE "[light]\ndirection = 0 0 0\n", "light.direction must not be 0 0 0" },
	{ SCENE "[render]\nshading = phong\n", "s.scene:7: render.shading: phong is not" },
	{ SCENE "[render]\nray_sampling_rate = 1\nray_sampling_rate = 1\n", "s.scene:8: " },
	{ "[volume]\ndims = 0 1 1\n", "s.scene:2: volume.dims: 0 is outside 1 to 16384" },
	{ "[volume]\ndims = 1 1 99999\n", "s.scene:2: volume.dims: 99999 is outside" },
	{ "[volume]\nspacing = 1 1 -1\n", "s.scene:2: volume.spacing: -1 is outside" },
	{ "[volume]\ntype = int64\n", "s.scene:2: volume.type: int64 is not uint8" },
	{ "nonsense\n", "s.scene:1: " },
	{ "[object]\nvolume = a.nii\n", "s.scene:1: an object has a name" },
	{ "[object a.b]\nvolume = a.nii\n", "s.scene:1: an object has a name" },
	{ "[object a]\n", "s.scene: object a: give one of volume, labels, mesh and particles" },
	{ "[object a]\nvolume = a.nii\nmesh = a.ply\n", "s.scene: object a: give one of" },
	{ "[object a]\nmesh = a.ply\n", "s.scene: object a: the technique raycast does not show "
					"mesh; set technique = isosurface" },
	{ "[object a]\nlabels = a.nii\n", "s.scene: object a: the technique raycast does not show "
					  "labels; set technique = isosurface" },
	{ SCENE "[labels]\nsmoothing = 61\n",
	  "s.scene:7: labels.smoothing: 61 is outside 0 to 60" },
	{ "[object a]\nparticles = a.ply\n[object b]\nvolume = b.nii\n",
	  "s.scene: 2 volumes are given" },
	{ SCENE "[particles]\ngrid = octree\n", "s.scene:7: particles.grid: octree is not sph" },
	{ SCENE "[particles]\ncells = 7\n", "s.scene:7: particles.cells: 7 is outside 8 to 16384" },
	{ SCENE "[particles]\nsmoothing = 0\n", "s.scene:7: particles.smoothing: 0 is outside" },
	{ "[object a]\nvolume = a.raw\n[volume]\ndims = 1 2 3\n",
	  "s.scene: volume.dims: a raw file needs both dims and type" },
	{ "[object a]\nvolume = a.raw\n[volume]\nendian = big\n", "a raw file needs both dims" },
	{ "[object a]\nvolume = a.nii\nvolume = b.nii\n", "s.scene:3: object a.volume: " },
	{ "[object a]\nmesh = a.ply\ntransfer = a.tf\n",
	  "only a volume and particles have a transfer function" },
	{ "[object a]\nvolume = a.nii\nimportance = 2\n",
	  "s.scene:3: object a.importance: 2 is outside 0 to 1" },
	{ "[object a]\nvolume = a.nii\ntechnique = magic\n",
	  "s.scene:3: object a.technique: magic is not raycast" },
	{ "[object a]\nvolume = a.nii\ncolour = red\n", "s.scene:3: object a.colour: unknown key" },
	{ "[object a]\nvolume = a.nii\n[object b]\nvolume = b.nii\n",
	  "s.scene: 2 volumes are given, and a scene shows one" },
	{ SCENE "[object a]\nvolume = a.nii\n", "s.scene: 2 volumes are given" },
	{ "[object a]\nvolume = a.nii\n[object b]\nvolume = a.nii\n",
	  "s.scene: [object a] and [object b] show one volume by one technique; remove one" },
	{ "[object a]\nvolume = a.nii\ntransfer = a.tf\n"
	  "[object b]\nvolume = a.nii\ntransfer = b.tf\ntechnique = isosurface\n",
	  "s.scene: object b: transfer: not that of [object a]" },
	{ "[object a]\nvolume = a.nii\n[object b]\nvolume = b.nii\ntechnique = isosurface\n",
	  "s.scene: 2 volumes are given" },
};

static void each_refusal_names_place_and_remedy(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof refusals / sizeof refusals[0]; i++) {
		struct gz_scene_settings s = { .rays.shading = 42 };
		struct captured_log log;
		bool display = true;
		const char *text = refusals[i].text;
		captured_log_init(&log, NULL);
		enum gz_result result =
			gz_scene_parse("s.scene", text, strlen(text), &log.log, &s, &display);
		if (result != GZ_ERR_FORMAT || log.messages != 1 ||
		    !strstr(log.last, refusals[i].words))
			fail_msg("result %d, %d lines, \"%s\" lacks \"%s\"", result, log.messages,
				 log.last, refusals[i].words);
		assert_int_equal(s.rays.shading, 42);
		assert_true(display);
	}
}

static void object_sections_are_read_with_their_presets(void **state)
{
	(void)state;
	bool display;
	const struct gz_scene_settings s =
		scene_of_text("[object the head]\nvolume = a.nii\nimportance = 0.75\nvisible = no\n"
			      "template = bones\n",
			      &display);
	assert_int_equal(s.objects.count, 1);
	const struct gz_scene_object *object = &s.objects.items[0];
	assert_string_equal(gz_scene_object_name(object), "the head");
	assert_string_equal(object->volume, "a.nii");
	assert_string_equal(object->template_name, "bones");
	assert_true(object->style.importance == 0.75 && !object->visible);
	assert_int_equal(object->technique, 0);
	struct gz_scene_settings other = s;
	assert_true(gz_scene_settings_same(&s, &other));
	other.objects.items[0].style.importance = 0.5;
	assert_false(gz_scene_settings_same(&s, &other));
}

static void object_with_a_volume_is_loaded_and_listed(void **state)
{
	(void)state;
	struct gz_scene scene;
	struct captured_log log;
	struct gz_object objects[2];
	const uint8_t voxels[4] = { 0, 1, 2, 3 };
	captured_log_init(&log, NULL);
	files_write_text("ramp.tf", "0 0 0 0 0\n1 1 1 1 1\n", NULL, 0);
	files_write_text("v.nrrd",
			 "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 1\nencoding: raw\n\n",
			 voxels, sizeof voxels);
	const char *path = files_write_text(
		"o.scene", "[object tiny]\nvolume = v.nrrd\ntransfer = ramp.tf\n", NULL, 0);
	if (gz_scene_load(path, NULL, &log.log, &scene) != GZ_OK)
		fail_msg("%s", log.last);
	assert_int_equal(gz_scene_list_objects(&scene, objects, 2), 1);
	assert_ptr_equal(objects[0].volume, &scene.volume);
	assert_ptr_equal(objects[0].transfer, &scene.transfer);
	assert_string_equal(objects[0].technique->name, "raycast");
	assert_int_equal(scene.volume.dims[1], 2);
	assert_int_equal(scene.transfer.count, 2);
	scene.settings.objects.items[0].visible = false;
	assert_int_equal(gz_scene_list_objects(&scene, objects, 2), 0);
	gz_scene_free(&scene);
	path = files_write_text("p.scene", "[object tiny]\nvolume = none.nrrd\n", NULL, 0);
	assert_int_equal(gz_scene_load(path, NULL, &log.log, &scene), GZ_ERR_NOT_FOUND);
	assert_non_null(strstr(log.last, "object tiny: none.nrrd is neither beside the scene"));
}

static void two_objects_show_one_volume_by_two_techniques(void **state)
{
	(void)state;
	struct gz_scene scene;
	struct captured_log log;
	struct gz_object objects[3];
	const uint8_t voxels[4] = { 0, 1, 2, 3 };
	captured_log_init(&log, NULL);
	files_write_text("ramp.tf", "0 0 0 0 0\n1 1 1 1 1\n", NULL, 0);
	files_write_text("v.nrrd",
			 "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 1\nencoding: raw\n\n",
			 voxels, sizeof voxels);
	const char *path =
		files_write_text("o.scene",
				 "[object bone]\nvolume = v.nrrd\ntechnique = isosurface\n"
				 "[object skin]\nvolume = v.nrrd\ntransfer = ramp.tf\n",
				 NULL, 0);
	if (gz_scene_load(path, NULL, &log.log, &scene) != GZ_OK)
		fail_msg("%s", log.last);
	assert_int_equal(scene.transfer.count, 2); /* of the second object */
	assert_int_equal(gz_scene_list_objects(&scene, objects, 3), 2);
	assert_string_equal(objects[0].technique->name, "isosurface");
	assert_string_equal(objects[1].technique->name, "raycast");
	assert_true(objects[0].id == 1 && objects[1].id == 3);
	assert_ptr_equal(objects[1].volume, &scene.volume);
	scene.settings.objects.items[0].visible = false;
	assert_int_equal(gz_scene_list_objects(&scene, objects, 3), 1);
	assert_string_equal(objects[0].technique->name, "raycast");
	scene.settings.objects.items[0].visible = true;
	scene.settings.technique = 1; /* one draws both */
	assert_int_equal(gz_scene_list_objects(&scene, objects, 3), 1);
	assert_string_equal(objects[0].technique->name, "raycast");
	gz_scene_free(&scene);
}

static void transfer_file_replaces_that_of_the_object(void **state)
{
	(void)state;
	bool display;
	struct gz_scene_settings s =
		scene_of_text("[object a]\nvolume = a.nii\ntransfer = own.tf\n", &display);
	assert_string_equal(gz_scene_transfer_name(&s), "own.tf");
	strcpy(s.transfer_file, "other.tf");
	assert_string_equal(gz_scene_transfer_name(&s), "other.tf");
	s = scene_of_text("[object a]\nvolume = a.nii\n[transfer]\nfile = b.tf\n", &display);
	assert_string_equal(gz_scene_transfer_name(&s), "b.tf");
	s = scene_of_text("[object a]\nvolume = a.nii\n", &display);
	assert_string_equal(gz_scene_transfer_name(&s), "");
}

static void settings_differ_by_every_key(void **state)
{
	(void)state;
	bool display;
	const struct gz_scene_settings s = scene_of_text(SCENE, &display);
	struct gz_scene_settings other;
	struct gz_option_binding bindings[GZ_SCENE_TABLE_COUNT];
	for (size_t table = 0; table < GZ_SCENE_TABLE_COUNT; table++) {
		gz_scene_bind(&other, bindings);
		for (size_t i = 0; i < bindings[table].count; i++) {
			const struct gz_option *option = &bindings[table].options[i];
			unsigned char *value;
			memcpy(&other, &s, sizeof other);
			assert_true(gz_scene_settings_same(&s, &other));
			value = (unsigned char *)bindings[table].target + option->offset;
			if (option->type == GZ_OPTION_STRING)
				value[0] = value[0] == 'z' ? 'y' : 'z', value[1] = '\0';
			else if (option->type == GZ_OPTION_BOOL)
				*(bool *)value = !*(bool *)value;
			else if (option->type == GZ_OPTION_DOUBLE)
				*(double *)(void *)value += 0.25;
			else
				*(int *)(void *)value += 1;
			if (gz_scene_settings_same(&s, &other))
				fail_msg("%s is not compared", option->key);
		}
	}
}

static void assert_documented(const struct gz_text *document, const char *key)
{
	char quoted[128];
	snprintf(quoted, sizeof quoted, "`%s`", key);
	if (!strstr(document->bytes, quoted))
		fail_msg("docs/scenes.md lacks %s", key);
}

static void every_key_is_documented(void **state)
{
	(void)state;
	struct gz_scene_settings settings = { 0 };
	struct gz_option_binding bindings[GZ_SCENE_TABLE_COUNT];
	struct gz_text document = { 0 };
	assert_int_equal(gz_text_add_file(&document, SCENES_DOCUMENT), GZ_OK);
	gz_scene_bind(&settings, bindings);
	for (size_t table = 0; table < GZ_SCENE_TABLE_COUNT; table++)
		for (size_t i = 0; i < bindings[table].count; i++) {
			const char *key = bindings[table].options[i].key;
			if (strncmp(key, "views.", 6) != 0) /* documented as 1 to 8 */
				assert_documented(&document, key);
		}
	for (size_t i = 0; i < GZ_SCENE_OBJECT_OPTIONS; i++)
		assert_documented(&document, strchr(gz_scene_object_options[i].key, '.') + 1);
	for (size_t i = 0; i < GZ_SCENE_REGION_OPTIONS; i++)
		assert_documented(&document, strchr(gz_scene_region_options[i].key, '.') + 1);
	gz_text_free(&document);
}

static void scene_is_loaded_with_what_it_names(void **state)
{
	(void)state;
	struct gz_scene scene;
	struct captured_log log;
	captured_log_init(&log, NULL);
	files_write_text("ramp.tf", "0 0 0 0 0\n1 1 1 1 1\n", NULL, 0);
	const char *path = files_write_text("a.scene", SCENE, NULL, 0);
	assert_int_equal(gz_scene_load(path, NULL, &log.log, &scene), GZ_OK);
	assert_int_equal(scene.volume.dims[0], 12);
	assert_int_equal(scene.volume.dims[2], 8);
	assert_int_equal(scene.transfer.count, 2);
	assert_false(scene.has_display);
	gz_scene_free(&scene);
	assert_null(scene.volume.voxels);
	gz_scene_free(&scene);
	assert_int_equal(log.messages, 0);
}

static void procedural_volume_without_dims_has_128_a_side(void **state)
{
	(void)state;
	struct gz_scene scene;
	files_write_text("ramp.tf", "0 0 0 0 0\n1 1 1 1 1\n", NULL, 0);
	const char *path =
		files_write_text("p.scene", "[volume]\nprocedural = shells\n" TRANSFER, NULL, 0);
	assert_int_equal(gz_scene_load(path, NULL, NULL, &scene), GZ_OK);
	for (int i = 0; i < 3; i++)
		assert_int_equal(scene.volume.dims[i], 128);
	gz_scene_free(&scene);
}

static void scene_without_its_data_says_where_they_are_to_be_had(void **state)
{
	(void)state;
	static const char text[] =
		"[volume]\nfile = absent.nrrd\nsource = https://data.example/v.nrrd\n";
	struct gz_scene scene;
	struct captured_log log;
	captured_log_init(&log, NULL);
	const char *path = files_write_text("sourced.scene", text, NULL, 0);
	assert_int_equal(gz_scene_load(path, NULL, &log.log, &scene), GZ_ERR_NOT_FOUND);
	assert_int_equal(log.messages, 2);
	assert_non_null(strstr(log.last, "get its data here: https://data.example/v.nrrd"));
}

static void file_is_searched_beside_the_scene_then_under_the_data_folder(void **state)
{
	(void)state;
	static const char text[] = "[volume]\nfile = v.raw\ndims = 2 2 1\ntype = uint8\n"
				   "spacing = 1 1 2\n" TRANSFER;
	char data[512];
	struct gz_scene scene;
	struct captured_log log;
	captured_log_init(&log, NULL);
	snprintf(data, sizeof data, "%s", files_folder());
	files_write_text("ramp.tf", "0 0 0 0 0\n1 1 1 1 1\n", NULL, 0);
	const char *path = files_write_text("d.scene", text, NULL, 0);
	unsetenv("GAZECAST_DATA");
	assert_int_equal(gz_scene_load(path, NULL, &log.log, &scene), GZ_ERR_NOT_FOUND);
	assert_non_null(strstr(log.last, "d.scene: volume.file: v.raw is neither beside the scene "
					 "nor under GAZECAST_DATA (not set)"));
	files_write("v.raw", "abcd", 4);
	assert_int_equal(gz_scene_load(path, NULL, &log.log, &scene), GZ_OK);
	assert_true(scene.volume.spacing[2] == 2);
	gz_scene_free(&scene);

	/* The same scene from elsewhere finds both under the variable. */
	char elsewhere[] = "/tmp/gazecast-scene-XXXXXX";
	int fd = mkstemp(elsewhere);
	assert_true(fd >= 0);
	assert_int_equal(write(fd, text, strlen(text)), (ssize_t)strlen(text));
	close(fd);
	setenv("GAZECAST_DATA", data, 1);
	enum gz_result result = gz_scene_load(elsewhere, NULL, &log.log, &scene);
	unlink(elsewhere);
	unsetenv("GAZECAST_DATA");
	assert_int_equal(result, GZ_OK);
	gz_scene_free(&scene);
}

static void missing_files_are_named_with_a_remedy(void **state)
{
	(void)state;
	struct gz_scene scene;
	struct captured_log log;
	captured_log_init(&log, NULL);
	assert_int_equal(gz_scene_load(files_path("none.scene"), NULL, &log.log, &scene),
			 GZ_ERR_NOT_FOUND);
	assert_non_null(strstr(log.last, "none.scene"));
	const char *path =
		files_write_text("n.scene", VOLUME "[transfer]\nfile = no.tf\n", NULL, 0);
	assert_int_equal(gz_scene_load(path, NULL, &log.log, &scene), GZ_ERR_NOT_FOUND);
	assert_non_null(strstr(log.last, "transfer.file: no.tf is neither beside the scene"));
	path = files_write_text("n.scene", "[volume]\nfile = /no/where.nii\n" TRANSFER, NULL, 0);
	files_write_text("ramp.tf", "0 0 0 0 0\n1 1 1 1 1\n", NULL, 0);
	assert_int_equal(gz_scene_load(path, NULL, &log.log, &scene), GZ_ERR_NOT_FOUND);
	assert_non_null(strstr(log.last, "volume.file: no file /no/where.nii; install it"));
	assert_int_equal(log.messages, 3);
}

static void broken_parts_break_the_scene_with_one_line(void **state)
{
	(void)state;
	struct gz_scene scene;
	struct captured_log log;
	captured_log_init(&log, NULL);
	files_write_text("bad.tf", "0 0 0 0\n", NULL, 0);
	const char *path =
		files_write_text("b.scene", VOLUME "[transfer]\nfile = bad.tf\n", NULL, 0);
	assert_int_equal(gz_scene_load(path, NULL, &log.log, &scene), GZ_ERR_FORMAT);
	assert_non_null(strstr(log.last, "bad.tf:1: point: write five numbers"));
	files_write_text("ramp.tf", "0 0 0 0 0\n1 1 1 1 1\n", NULL, 0);
	files_write("short.raw", "abc", 3);
	path = files_write_text("b.scene",
				"[volume]\nfile = short.raw\ndims = 2 2 1\ntype = uint8\n" TRANSFER,
				NULL, 0);
	assert_int_equal(gz_scene_load(path, NULL, &log.log, &scene), GZ_ERR_FORMAT);
	assert_non_null(strstr(log.last, "short.raw: truncated"));
	assert_int_equal(log.messages, 2);
}

TEST_SUITE(scene)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_preset_parses),
		cmocka_unit_test(choices_are_in_the_order_of_their_enums),
		cmocka_unit_test(every_section_is_read),
		cmocka_unit_test(each_refusal_names_place_and_remedy),
		cmocka_unit_test(object_sections_are_read_with_their_presets),
		cmocka_unit_test(object_with_a_volume_is_loaded_and_listed),
		cmocka_unit_test(two_objects_show_one_volume_by_two_techniques),
		cmocka_unit_test(transfer_file_replaces_that_of_the_object),
		cmocka_unit_test(settings_differ_by_every_key),
		cmocka_unit_test(every_key_is_documented),
		cmocka_unit_test(scene_is_loaded_with_what_it_names),
		cmocka_unit_test(procedural_volume_without_dims_has_128_a_side),
		cmocka_unit_test(scene_without_its_data_says_where_they_are_to_be_had),
		cmocka_unit_test(file_is_searched_beside_the_scene_then_under_the_data_folder),
		cmocka_unit_test(missing_files_are_named_with_a_remedy),
		cmocka_unit_test(broken_parts_break_the_scene_with_one_line),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
