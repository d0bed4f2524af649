/* gazeview's command line: what it accepts, and its messages about what it refuses. */
#include "suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/captured_log.h"
#include "render/plan/method.h"
#include "render/scene/techniques.h"
#include "view/options/options.h"

enum { ARGUMENTS_MAX = 24 };

static struct captured_log captured;
static struct gz_view_options options;

/* A command line of words separated by single blanks; an @ is a blank within a word. */
static enum gz_result read_line(const char *line)
{
	static char text[4096];
	static char name[] = "gazeview";
	char *argv[ARGUMENTS_MAX] = { name };
	int argc = 1;
	snprintf(text, sizeof text, "%s", line);
	for (char *word = strtok(text, " "); word && argc < ARGUMENTS_MAX;
	     word = strtok(NULL, " ")) {
		for (char *at = strchr(word, '@'); at; at = strchr(at, '@'))
			*at = ' ';
		argv[argc++] = word;
	}
	captured_log_init(&captured, "*:debug");
	return gz_view_options_read(argc, argv, &captured.log, &options);
}

/* Check that a command line is refused with one message that contains @p word. */
static void assert_refused(const char *line, const char *word)
{
	assert_int_equal(read_line(line), GZ_ERR_INVAL);
	assert_int_equal(captured.messages, 1);
	assert_int_equal(captured.level, GZ_LOG_ERROR);
	assert_null(strchr(captured.last, '\n'));
	if (!strstr(captured.last, word))
		fail_msg("\"%s\": the message lacks \"%s\": %s", line, word, captured.last);
}

static void command_line_of_the_manual_is_read(void **state)
{
	(void)state;
	assert_int_equal(
		read_line("--headless --scene a.scene --size 640x360 --gaze 0.25,0.75 "
			  "--fps 60 --method mdc --backend cpu --frames 9 --out f-%04d.png "
			  "--stats s.json --turn 0.01"),
		GZ_OK);
	assert_true(options.headless);
	assert_string_equal(options.scene, "a.scene");
	assert_int_equal(options.size_px[0], 640);
	assert_int_equal(options.size_px[1], 360);
	assert_int_equal(options.gaze.kind, GZ_GAZE_FIXED);
	assert_true(options.gaze.point.x == 0.25f && options.gaze.point.y == 0.75f);
	assert_int_equal(options.method, GZ_METHOD_MDC);
	assert_int_equal(options.frames, 9);
	assert_true(options.turn_deg == 0.01);
	assert_int_equal(captured.messages, 0);
}

static void scene_may_stand_alone(void **state)
{
	(void)state;
	assert_int_equal(read_line("a.scene --headless"), GZ_OK);
	assert_string_equal(options.scene, "a.scene");
	assert_refused("a.scene b.scene --headless", "b.scene");
	assert_refused("a.scene --scene b.scene", "a.scene");
	assert_refused("--headless", "--scene");
}

static void technique_and_isovalue_are_short_for_scene_keys(void **state)
{
	(void)state;
	struct gz_scene_settings settings;
	assert_int_equal(gz_scene_settings_preset(&settings), GZ_OK);
	assert_int_equal(read_line("a.scene"), GZ_OK);
	assert_int_equal(gz_view_options_apply(&options, &settings), GZ_OK);
	assert_int_equal(settings.technique, 0);
	settings.technique = 1;
	settings.rays.surface.isovalue = 9;
	assert_int_equal(gz_view_options_apply(&options, &settings), GZ_OK);
	assert_int_equal(settings.technique, 1);
	assert_true(settings.rays.surface.isovalue == 9);
	assert_int_equal(read_line("--technique isosurface --isovalue -2.5 a.scene"), GZ_OK);
	assert_int_equal(gz_view_options_apply(&options, &settings), GZ_OK);
	assert_string_equal(gz_technique_choices[settings.technique], "isosurface");
	assert_true(settings.rays.surface.isovalue == -2.5);
	assert_refused("--technique isosurface --render.technique raycast a.scene",
		       "--render.technique");
	assert_refused("--isovalue 3 --isosurface.isovalue 3 a.scene", "--isosurface.isovalue");
	assert_refused("--technique slices --slices.count 0 a.scene", "1 to 4096");
	assert_refused("--slices.count 4097 a.scene", "1 to 4096");
	assert_refused("--technique slabs a.scene", "technique");
	assert_refused("--replay a.session --technique raycast", "--technique");
	assert_refused("--experiment a.experiment --isovalue 3", "--isovalue");
	assert_refused("--experiment a.experiment --technique raycast", "--technique");
}

static void mesh_needs_its_isovalue_and_no_other_work(void **state)
{
	(void)state;
	assert_int_equal(read_line("--write-mesh a.ply --isovalue -500 a.scene"), GZ_OK);
	assert_string_equal(options.write_mesh, "a.ply");
	assert_true(options.isovalue == -500);
	assert_int_equal(read_line("--write-mesh a.ply --isovalue 0 a.scene"), GZ_OK);
	assert_int_equal(read_line("--write-mesh a.ply a.scene"), GZ_OK); /* of its labels */
	assert_false(gz_view_option_given(&options, "isovalue"));
	assert_refused("--write-mesh a.ply --isovalue 3", "no scene");
	assert_refused("--write-mesh a.ply --isovalue nan a.scene", "isovalue");
	assert_refused("--write-mesh a.ply --isovalue 3 --write-volume a.gzb a.scene",
		       "--write-volume");
	assert_refused("--replay a.session --write-mesh a.ply --isovalue 3", "--write-mesh");
	assert_refused("--replay a.session --isovalue 3", "--isovalue");
	assert_refused("--targets 5 --write-mesh a.ply --isovalue 3", "--write-mesh");
	assert_refused("--experiment a.experiment --write-mesh a.ply --isovalue 3", "--write-mesh");
}

static void default_gaze_is_centre_headless_and_daemon_in_a_window(void **state)
{
	(void)state;
	assert_int_equal(read_line("a.scene --headless"), GZ_OK);
	assert_int_equal(options.gaze.kind, GZ_GAZE_CENTRE);
	assert_int_equal(read_line("a.scene"), GZ_OK);
	assert_int_equal(options.gaze.kind, GZ_GAZE_LATEST);
	assert_string_equal(options.gaze.text, "");
}

static void gaze_texts_choose_their_sources(void **state)
{
	(void)state;
	const struct {
		const char *text;
		enum gz_gaze_kind kind;
	} cases[] = {
		{ "centre", GZ_GAZE_CENTRE },
		{ "mouse", GZ_GAZE_MOUSE },
		{ "pointer", GZ_GAZE_POINTER },
		{ "daemon", GZ_GAZE_LATEST },
		{ "ipc:///tmp/x/latest", GZ_GAZE_LATEST },
		{ "tcp://127.0.0.1:5000", GZ_GAZE_LATEST },
		{ "a/b.gzl", GZ_GAZE_LOG },
		{ "0,1", GZ_GAZE_FIXED },
		{ "-0.5,1.5", GZ_GAZE_FIXED },
		{ "1e-3,.5", GZ_GAZE_FIXED },
	};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		struct gz_gaze_choice choice;
		assert_int_equal(gz_gaze_choice_parse(cases[i].text, NULL, &choice), GZ_OK);
		if (choice.kind != cases[i].kind)
			fail_msg("%s: kind %d, expected %d", cases[i].text, (int)choice.kind,
				 (int)cases[i].kind);
	}
}

static void gaze_that_is_not_a_finite_pair_is_refused(void **state)
{
	(void)state;
	const char *const bad[] = { "nan,0.5", "0.5,nan",  "inf,0",     "0,-inf",  "0.5",
				    "0.5,",    ",0.5",     "0.5,0.5,",  "0.5;0.5", "0x1,0.5",
				    "1e99,0",  "a,b",      "0.5,0.5 x", "",        "udp://1",
				    "center",  "log.gzl2", "960,540",   "0.5,-11" };
	for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
		struct gz_gaze_choice choice = { .kind = GZ_GAZE_LOG };
		captured_log_init(&captured, "*:debug");
		if (gz_gaze_choice_parse(bad[i], &captured.log, &choice) != GZ_ERR_INVAL)
			fail_msg("\"%s\" was taken", bad[i]);
		assert_int_equal(captured.messages, 1);
		assert_non_null(strstr(captured.last, "--gaze"));
		assert_int_equal(choice.kind, GZ_GAZE_LOG);
	}
}

static void values_outside_their_range_are_refused(void **state)
{
	(void)state;
	assert_refused("a.scene --size 0x100", "size");
	assert_refused("a.scene --size 640", "size");
	assert_refused("a.scene --size 640x480x2", "size");
	assert_refused("a.scene --size 99999x100", "size");
	assert_refused("a.scene --fps 0", "fps");
	assert_refused("a.scene --fps nan", "fps");
	assert_refused("a.scene --frames 0", "frames");
	assert_refused("a.scene --frames 12abc", "frames");
	assert_refused("a.scene --method blur", "acuity");
	assert_refused("a.scene --turn 400", "turn");
	assert_refused("a.scene --threads 1000", "threads");
	assert_refused("a.scene --distance-mm -1", "distance");
	assert_refused("a.scene --no-such-thing", "no-such-thing");
	assert_refused("a.scene --frames 2 --frames 3", "frames");
}

static void contradictory_options_are_refused(void **state)
{
	(void)state;
	assert_refused("a.scene --headless --gaze mouse", "mouse");
	assert_refused("a.scene --headless --gaze pointer", "pointer");
	assert_refused("a.scene --out a.png", "--headless");
	assert_refused("a.scene --stats a.json", "--headless");
	assert_refused("a.scene --headless --method mdc --foveation.method ddc",
		       "foveation.method");
}

static void data_of_a_scene_cannot_be_overridden(void **state)
{
	(void)state;
	assert_refused("a.scene --volume.file b.nii", "volume.file");
	assert_refused("a.scene --transfer.also b.tf", "transfer.also");
}

static void raw_file_gets_the_layout_in_the_options(void **state)
{
	(void)state;
	struct gz_raw_layout raw;
	assert_int_equal(read_line("a.raw"), GZ_OK);
	assert_false(gz_view_options_raw(&options, &raw));
	assert_int_equal(read_line("a.raw --volume.dims=2@3@4 --volume.type uint8"), GZ_OK);
	assert_true(gz_view_options_raw(&options, &raw));
	assert_int_equal(raw.dims[2], 4);
	assert_int_equal(raw.type, GZ_RAW_UINT8);
	assert_false(raw.big_endian);
	assert_true(raw.spacing[0] == 0); /* not known */
	assert_int_equal(read_line("a.raw --volume.dims=2@3@4 --volume.type int16 --volume.endian "
				   "big --volume.spacing=1@1@2.5"),
			 GZ_OK);
	assert_true(gz_view_options_raw(&options, &raw));
	assert_true(raw.big_endian);
	assert_true(raw.spacing[2] == 2.5);
	assert_int_equal(
		read_line("a.raw --volume.dims=2@3@4 --volume.type uint8 --volume.channels 3"),
		GZ_OK);
	assert_true(gz_view_options_raw(&options, &raw));
	assert_int_equal(raw.channels, 3);
}

static void opacity_of_colours_replaces_the_scenes(void **state)
{
	(void)state;
	static struct gz_scene_settings settings;
	assert_int_equal(gz_scene_settings_preset(&settings), GZ_OK);
	settings.opacity = GZ_OPACITY_ALPHA;
	assert_int_equal(read_line("a.nii"), GZ_OK);
	assert_int_equal(gz_view_options_apply(&options, &settings), GZ_OK);
	assert_int_equal(settings.opacity, GZ_OPACITY_ALPHA);
	assert_int_equal(read_line("a.nii --volume.opacity luminance"), GZ_OK);
	assert_int_equal(gz_view_options_apply(&options, &settings), GZ_OK);
	assert_int_equal(settings.opacity, GZ_OPACITY_LUMINANCE);
	assert_refused("a.nii --volume.opacity red", "auto, luminance or alpha");
}

static void particle_keys_replace_the_scenes(void **state)
{
	(void)state;
	static struct gz_scene_settings settings;
	assert_int_equal(gz_scene_settings_preset(&settings), GZ_OK);
	settings.particles.cells = 100;
	settings.particles.radius = 0.5;
	assert_int_equal(read_line("a.bgeo --particles.grid nearest --particles.radius 0.025"),
			 GZ_OK);
	assert_int_equal(gz_view_options_apply(&options, &settings), GZ_OK);
	assert_int_equal(settings.particles.gridding, GZ_GRIDDING_NEAREST);
	assert_int_equal(settings.particles.value, GZ_PARTICLE_FILL);
	assert_int_equal(settings.particles.cells, 100);
	assert_true(settings.particles.radius == 0.025 && settings.particles.smoothing == 2);
	assert_refused("a.bgeo --particles.grid octree", "sph or nearest");
	assert_refused("a.bgeo --particles.cells 4", "8 to 16384");
	assert_refused("--experiment a.exp --participant p --particles.cells 64",
		       "a key of a scene");
}

static void resampling_replaces_the_scenes(void **state)
{
	(void)state;
	static const struct {
		const char *line;
		enum gz_resampling expected;
	} lines[] = {
		{ "a.scene", GZ_RESAMPLING_NEAREST },
		{ "a.scene --resample", GZ_RESAMPLING_LINEAR },
		{ "a.scene --volume.resample off", GZ_RESAMPLING_OFF },
		{ "a.scene --volume.resample nearest --resample", GZ_RESAMPLING_NEAREST },
	};
	static struct gz_scene_settings settings;
	for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
		assert_int_equal(gz_scene_settings_preset(&settings), GZ_OK);
		assert_int_equal(settings.resample, GZ_RESAMPLING_OFF);
		settings.resample = GZ_RESAMPLING_NEAREST;
		assert_int_equal(read_line(lines[i].line), GZ_OK);
		assert_int_equal(gz_view_options_apply(&options, &settings), GZ_OK);
		assert_int_equal(settings.resample, lines[i].expected);
	}
	assert_refused("a.scene --volume.resample cubic", "off, linear or nearest");
	assert_refused("--experiment a.exp --participant p --resample", "--resample");
	assert_refused("--experiment a.exp --participant p --volume.resample off",
		       "--volume.resample");
}

static void half_a_layout_is_refused(void **state)
{
	(void)state;
	assert_refused("a.raw --volume.dims=2@3@4", "volume.type: missing");
	assert_refused("a.raw --volume.type uint8", "volume.dims: missing");
	assert_refused("a.raw --volume.endian big", "volume.dims: missing");
	assert_refused("a.raw --volume.spacing=1@1@1", "volume.dims: missing");
	assert_refused("a.raw --volume.channels 3", "volume.dims: missing");
}

static void transfer_function_on_the_command_line_is_made_absolute(void **state)
{
	(void)state;
	static struct gz_scene_settings settings;
	strcpy(settings.transfer_file, "of-the-scene.tf");
	assert_int_equal(read_line("a.scene --transfer.file ."), GZ_OK);
	assert_int_equal(gz_view_options_apply(&options, &settings), GZ_OK);
	assert_int_equal(settings.transfer_file[0], '/');
	assert_int_equal(read_line("a.scene --transfer.file none.tf"), GZ_OK);
	assert_int_equal(gz_view_options_apply(&options, &settings), GZ_OK);
	assert_string_equal(settings.transfer_file, "none.tf");
}

static void given_scene_keys_override_the_scene(void **state)
{
	(void)state;
	static struct gz_scene_settings settings;
	settings.camera.fov_deg = 40;
	settings.camera.height = 7;
	settings.foveation = gz_foveation_default();
	settings.foveation.method = GZ_METHOD_DDC;
	double floor = settings.foveation.step_floor;
	assert_int_equal(read_line("a.scene --headless --camera.fov_deg 33.25 "
				   "--foveation.mdc_square_px 123 --method acuity"),
			 GZ_OK);
	assert_int_equal(gz_view_options_apply(&options, &settings), GZ_OK);
	assert_true(settings.camera.fov_deg == 33.25);
	assert_true(settings.foveation.mdc_square_px == 123);
	assert_int_equal(settings.foveation.method, GZ_METHOD_ACUITY);
	assert_true(settings.camera.height == 7);
	assert_true(settings.foveation.step_floor == floor);
}

static void scene_without_overrides_is_unchanged(void **state)
{
	(void)state;
	static struct gz_scene_settings settings, before;
	settings.camera.fov_deg = 40;
	settings.foveation.method = GZ_METHOD_MDC;
	before = settings;
	assert_int_equal(read_line("a.scene --headless"), GZ_OK);
	assert_int_equal(gz_view_options_apply(&options, &settings), GZ_OK);
	assert_memory_equal(&settings, &before, sizeof settings);
}

static void pattern_inserts_the_number(void **state)
{
	(void)state;
	const struct {
		const char *pattern;
		int number;
		const char *expected;
	} cases[] = {
		{ "f-%04d.png", 7, "f-0007.png" },
		{ "f-%d.png", 12345, "f-12345.png" },
		{ "%3d", 5, "  5" },
		{ "%01d%%.png", 3, "3%.png" },
		{ "plain.png", 9, "plain.png" },
		{ "%%d.png", 9, "%d.png" },
		{ "%02d/x", 123, "123/x" },
	};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		char path[64];
		assert_int_equal(
			gz_pattern_format(cases[i].pattern, cases[i].number, path, sizeof path),
			GZ_OK);
		assert_string_equal(path, cases[i].expected);
	}
}

static void pattern_with_anything_but_one_number_is_refused(void **state)
{
	(void)state;
	const char *const bad[] = {
		"%s.png",   "%n.png", "%ld.png", "%-4d.png", "%10d.png", "%",
		"%d%d.png", "a%.png", "%*d",     "%4$d",     "%0x",      "% d"
	};
	for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
		char path[64] = "untouched";
		captured_log_init(&captured, "*:debug");
		if (gz_pattern_check(bad[i], 1, &captured.log) != GZ_ERR_INVAL)
			fail_msg("\"%s\" was taken", bad[i]);
		assert_int_equal(captured.messages, 1);
		assert_int_equal(gz_pattern_format(bad[i], 1, path, sizeof path), GZ_ERR_INVAL);
		assert_string_equal(path, "untouched");
	}
	assert_int_equal(gz_pattern_check("one.png", 2, NULL), GZ_ERR_INVAL);
	assert_int_equal(gz_pattern_check("one.png", 1, NULL), GZ_OK);
	assert_int_equal(gz_pattern_check("%d.png", 2, NULL), GZ_OK);
	assert_refused("a.scene --headless --frames 2 --out one.png", "one.png");
	assert_refused("a.scene --headless --out one.jpg", "end the name in .png");
}

static void pattern_that_does_not_fit_is_refused(void **state)
{
	(void)state;
	char path[8];
	assert_int_equal(gz_pattern_format("1234567", 0, path, sizeof path), GZ_OK);
	assert_int_equal(gz_pattern_format("12345678", 0, path, sizeof path), GZ_ERR_FULL);
	assert_int_equal(gz_pattern_format("1234%d", 1000, path, sizeof path), GZ_ERR_FULL);
	assert_int_equal(gz_pattern_format("%9d", 1, path, sizeof path), GZ_ERR_FULL);
}

static void given_display_fields_override_known_ones(void **state)
{
	(void)state;
	const struct gz_display known = { .px = { 800, 600 },
					  .mm = { 400, 300 },
					  .distance_mm = 700 };
	assert_int_equal(read_line("a.scene --headless --distance-mm 500"), GZ_OK);
	struct gz_display display = gz_view_display(&options, &known, 640, 480);
	assert_true(display.distance_mm == 500);
	assert_true(display.mm[0] == 400 && display.mm[1] == 300);
	display = gz_view_display(&options, NULL, 640, 480);
	struct gz_display preset = gz_display_default(640, 480);
	assert_true(display.distance_mm == 500);
	assert_true(display.mm[0] == preset.mm[0]);
}

/* Print the help into memory. */
static char *help_text(void)
{
	char *text = NULL;
	size_t size = 0;
	FILE *out = open_memstream(&text, &size);
	assert_non_null(out);
	gz_view_options_print_help(out);
	fclose(out);
	return text;
}

static void help_lists_all_options_and_scene_keys(void **state)
{
	(void)state;
	char *text = help_text();
	for (size_t i = 0; i < gz_view_option_count; i++)
		assert_non_null(strstr(text, gz_view_option_table[i].key));
	struct gz_scene_settings settings;
	struct gz_option_binding tables[GZ_SCENE_TABLE_COUNT];
	gz_scene_bind(&settings, tables);
	int hidden = 0;
	for (size_t i = 0; i < GZ_SCENE_TABLE_COUNT; i++) {
		for (size_t k = 0; k < tables[i].count; k++) {
			const char *key = tables[i].options[k].key;
			bool taken = strncmp(key, "volume.", 7) != 0 &&
				     strncmp(key, "transfer.", 9) != 0 &&
				     strncmp(key, "display.", 8) != 0;
			for (size_t own = 0; own < gz_view_option_count; own++)
				taken = taken || strcmp(key, gz_view_option_table[own].key) == 0;
			if (taken != (strstr(text, key) != NULL))
				fail_msg("--help and %s disagree", key);
			hidden += !taken;
		}
	}
	assert_true(hidden > 0);
	free(text);
}

static void help_version_and_formats_need_no_scene(void **state)
{
	(void)state;
	assert_int_equal(read_line("--help"), GZ_OK);
	assert_true(options.help);
	assert_int_equal(read_line("--version"), GZ_OK);
	assert_true(options.version);
	assert_int_equal(read_line("--formats"), GZ_OK);
	assert_true(options.formats);
}

TEST_SUITE(options)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(command_line_of_the_manual_is_read),
		cmocka_unit_test(scene_may_stand_alone),
		cmocka_unit_test(technique_and_isovalue_are_short_for_scene_keys),
		cmocka_unit_test(mesh_needs_its_isovalue_and_no_other_work),
		cmocka_unit_test(default_gaze_is_centre_headless_and_daemon_in_a_window),
		cmocka_unit_test(gaze_texts_choose_their_sources),
		cmocka_unit_test(gaze_that_is_not_a_finite_pair_is_refused),
		cmocka_unit_test(values_outside_their_range_are_refused),
		cmocka_unit_test(contradictory_options_are_refused),
		cmocka_unit_test(data_of_a_scene_cannot_be_overridden),
		cmocka_unit_test(raw_file_gets_the_layout_in_the_options),
		cmocka_unit_test(opacity_of_colours_replaces_the_scenes),
		cmocka_unit_test(particle_keys_replace_the_scenes),
		cmocka_unit_test(resampling_replaces_the_scenes),
		cmocka_unit_test(half_a_layout_is_refused),
		cmocka_unit_test(transfer_function_on_the_command_line_is_made_absolute),
		cmocka_unit_test(given_scene_keys_override_the_scene),
		cmocka_unit_test(scene_without_overrides_is_unchanged),
		cmocka_unit_test(pattern_inserts_the_number),
		cmocka_unit_test(pattern_with_anything_but_one_number_is_refused),
		cmocka_unit_test(pattern_that_does_not_fit_is_refused),
		cmocka_unit_test(given_display_fields_override_known_ones),
		cmocka_unit_test(help_lists_all_options_and_scene_keys),
		cmocka_unit_test(help_version_and_formats_need_no_scene),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
