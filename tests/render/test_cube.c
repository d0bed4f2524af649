/* Surroundings of six pictures: which direction sees which pixel of which face, without seams; what
 * a face may be, and what is refused. */
#include "suite.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "base/captured_log.h"
#include "base/vector.h"
#include "mesh_fields.h"
#include "render/light/cube.h"
#include "render/plan/method.h"
#include "render/scene/scene.h"
#include "render/surface/cpu/surface_caster.h"
#include "small_scene.h"
#include "volume_files.h"

enum { EDGE = 16 };

static const char *const names[GZ_CUBE_FACES] = { "right.png", "left.png", "front.png",
						  "back.png",  "up.png",   "down.png" };

static struct captured_log heard;

static void put_u32be(uint32_t value, uint8_t *out)
{
	for (int i = 0; i < 4; i++)
		out[i] = (uint8_t)(value >> (24 - 8 * i));
}

static size_t put_chunk(const char *type, const uint8_t *data, size_t size, uint8_t *out)
{
	put_u32be((uint32_t)size, out);
	memcpy(out + 4, type, 4);
	if (size > 0)
		memcpy(out + 8, data, size);
	put_u32be((uint32_t)crc32(0, out + 4, (uInt)size + 4), out + 8 + size);
	return size + 12;
}

/* What a PNG says about its pixels. */
struct png_layout {
	int width, height, depth, colour; /* as in its chunk IHDR */
};

/* Write a PNG whose rows are given without their filters. */
static void write_png(const char *name, struct png_layout layout, const uint8_t *rows,
		      size_t row_bytes)
{
	static uint8_t bytes[1 << 16], raw[1 << 15], packed[1 << 15];
	uint8_t head[13] = { 0 };
	size_t size = 8, raw_size = 0;
	memcpy(bytes, "\x89PNG\r\n\x1a\n", 8);
	put_u32be((uint32_t)layout.width, head);
	put_u32be((uint32_t)layout.height, head + 4);
	head[8] = (uint8_t)layout.depth;
	head[9] = (uint8_t)layout.colour;
	size += put_chunk("IHDR", head, sizeof head, bytes + size);
	if (layout.colour == 3) {
		static const uint8_t palette[6] = { 10, 20, 30, 200, 150, 100 };
		size += put_chunk("PLTE", palette, sizeof palette, bytes + size);
	}
	for (int y = 0; y < layout.height; y++) {
		raw[raw_size++] = 0;
		memcpy(raw + raw_size, rows + (size_t)y * row_bytes, row_bytes);
		raw_size += row_bytes;
	}
	const size_t packed_size = files_deflate(raw, raw_size, 15, packed, sizeof packed);
	size += put_chunk("IDAT", packed, packed_size, bytes + size);
	size += put_chunk("IEND", NULL, 0, bytes + size);
	files_write(name, bytes, size);
}

/* A face of RGB noise, the same each time. */
static void noise_face(int face, uint8_t rgb[EDGE * EDGE * 3])
{
	uint32_t state = 17U * (uint32_t)face + 5;
	for (int i = 0; i < EDGE * EDGE * 3; i++) {
		state = state * 1664525 + 1013904223;
		rgb[i] = (uint8_t)(state >> 24);
	}
}

static void write_noise_faces(void)
{
	uint8_t rgb[EDGE * EDGE * 3];
	for (int face = 0; face < GZ_CUBE_FACES; face++) {
		noise_face(face, rgb);
		write_png(names[face], (struct png_layout) { EDGE, EDGE, 8, 2 }, rgb, EDGE * 3);
	}
}

/* Which way a picture of nothing but surroundings is taken. */
struct look {
	double ahead[3], up[3];
	double fov_deg;
};

static struct gz_surface_caster *caster_with(const char *simd)
{
	const struct gz_backend_params params = { .threads = 1, .simd = simd };
	struct gz_surface_caster *caster = NULL;
	assert_int_equal(gz_surface_caster_create(&params, NULL, &caster), GZ_OK);
	return caster;
}

/* Draw a square picture from the middle of an empty box. */
static void draw_surroundings(struct gz_surface_caster *caster, const struct look *look,
			      const double top[3], int side, struct gz_image *image)
{
	const struct gz_foveation full = gz_foveation_full();
	const struct gz_display display = gz_display_default(side, side);
	struct gz_volume volume = field_volume(field_ball, (const int[3]) { 8, 8, 8 },
					       (const double[3]) { 1, 1, 1 }, GZ_VOXEL_F32);
	const struct gz_object object = { .id = 1, .volume = &volume };
	struct gz_ray_params rays = gz_ray_params_default();
	struct gz_camera camera = { .fov_deg = look->fov_deg };
	struct gz_plan plan = { 0 };
	const struct gz_surface_shot shot = { .camera = &camera, .rays = &rays, .plan = &plan };
	memcpy(camera.look_at, look->ahead, sizeof camera.look_at);
	memcpy(camera.up, look->up, sizeof camera.up);
	rays.surface.isovalue = 1e6;
	rays.environment.kind = GZ_SURROUNDINGS_CUBE;
	memcpy(rays.environment.up, top, 3 * sizeof(double));
	snprintf(rays.environment.cube_path, sizeof rays.environment.cube_path, "%s",
		 files_folder());
	assert_int_equal(
		gz_plan_make(&full, &display, (struct gz_point) { 0.5F, 0.5F }, side, side, &plan),
		GZ_OK);
	assert_int_equal(gz_surface_caster_show(caster, &object, 1), GZ_OK);
	assert_int_equal(gz_surface_caster_draw(caster, &shot, image, NULL, NULL), GZ_OK);
	gz_plan_free(&plan);
	gz_volume_free(&volume);
}

static void assert_shows_face(const struct gz_image *image, int face, const char *simd)
{
	uint8_t rgb[EDGE * EDGE * 3];
	noise_face(face, rgb);
	for (int i = 0; i < EDGE * EDGE; i++)
		for (int channel = 0; channel < 3; channel++)
			if (abs(image->pixels[4 * i + channel] - rgb[3 * i + channel]) > 1)
				fail_msg("%s, %s, pixel %d: %d, not %d", simd, names[face], i,
					 image->pixels[4 * i + channel], rgb[3 * i + channel]);
}

static void eye_turned_to_a_face_by_90_degrees_sees_its_picture(void **state)
{
	(void)state;
	static const struct look looks[GZ_CUBE_FACES] = {
		{ { 1, 0, 0 }, { 0, 0, 1 }, 90 },  { { -1, 0, 0 }, { 0, 0, 1 }, 90 },
		{ { 0, 1, 0 }, { 0, 0, 1 }, 90 },  { { 0, -1, 0 }, { 0, 0, 1 }, 90 },
		{ { 0, 0, 1 }, { 0, -1, 0 }, 90 }, { { 0, 0, -1 }, { 0, 1, 0 }, 90 },
	};
	static const double top[3] = { 0, 0, 2 };
	struct gz_image image = { 0 };
	write_noise_faces();
	for (const char *const *set = small_scene_simd_sets(); *set; set++) {
		struct gz_surface_caster *caster = caster_with(*set);
		for (int face = 0; face < GZ_CUBE_FACES; face++) {
			draw_surroundings(caster, &looks[face], top, EDGE, &image);
			assert_shows_face(&image, face, *set);
		}
		gz_surface_caster_destroy(&caster);
	}
	gz_image_free(&image);
}

static void cube_with_another_top_is_turned_the_shortest_way(void **state)
{
	(void)state;
	/* z to y takes front, which was y, to -z; upside down is half a turn about x */
	static const struct {
		double top[3];
		struct look front, right;
	} cases[] = {
		{ { 0, 3, 0 },
		  { { 0, 0, -1 }, { 0, 1, 0 }, 90 },
		  { { 1, 0, 0 }, { 0, 1, 0 }, 90 } },
		{ { 0, 0, -1 },
		  { { 0, -1, 0 }, { 0, 0, -1 }, 90 },
		  { { 1, 0, 0 }, { 0, 0, -1 }, 90 } },
	};
	struct gz_surface_caster *caster = caster_with(NULL);
	struct gz_image image = { 0 };
	write_noise_faces();
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		draw_surroundings(caster, &cases[i].front, cases[i].top, EDGE, &image);
		assert_shows_face(&image, GZ_CUBE_FRONT, "auto");
		draw_surroundings(caster, &cases[i].right, cases[i].top, EDGE, &image);
		assert_shows_face(&image, GZ_CUBE_RIGHT, "auto");
	}
	gz_surface_caster_destroy(&caster);
	gz_image_free(&image);
}

static void axes_are_right_front_and_up(void **state)
{
	(void)state;
	static const double tops[][3] = {
		{ 0, 0, 5 },     { 0.3, -0.2, 0.9 },     { 1, 0, 0 },
		{ -1, 2, -3 },   { 1e-9, 0, -1 },        { 0, 0, -2 },
		{ 0, 1e-5, -1 }, { 1e-200, 0, -1e-200 }, { 0, 1e200, 0 }
	};
	for (size_t i = 0; i < sizeof tops / sizeof tops[0]; i++) {
		double axes[3][3], across[3], up[3] = { tops[i][0], tops[i][1], tops[i][2] };
		gz_cube_axes(tops[i], axes);
		assert_true(gz_normalise3(up));
		gz_cross3(axes[0], axes[1], across);
		for (int axis = 0; axis < 3; axis++) {
			assert_true(fabs(axes[2][axis] - up[axis]) < 1e-6);
			assert_true(fabs(axes[2][axis] - across[axis]) < 1e-6);
			assert_true(fabs(gz_length3(axes[axis]) - 1) < 1e-6);
		}
	}
}

/* A picture of a thousandth of a pixel of a face has one colour, also across edges and corners. */
static void faces_meet_without_a_seam(void **state)
{
	(void)state;
	static const double top[3] = { 0, 0, 1 };
	struct gz_surface_caster *caster = caster_with(NULL);
	struct gz_image image = { 0 };
	int edges = 0, corners = 0;
	write_noise_faces();
	for (int i = 0; i < 27; i++) {
		const double sides[3] = { i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1 };
		const int on_sides = (sides[0] != 0) + (sides[1] != 0) + (sides[2] != 0);
		const int places = on_sides == 3 ? 1 : on_sides == 2 ? 3 : 0;
		for (int place = 0; place < places; place++) {
			struct look look = { .up = { 0.3, 0.4, 0.5 }, .fov_deg = 0.005 };
			for (int axis = 0; axis < 3; axis++)
				look.ahead[axis] =
					sides[axis] != 0 ? sides[axis] : 0.9 * place - 0.83;
			draw_surroundings(caster, &look, top, 12, &image);
			for (int k = 1; k < 144; k++)
				for (int channel = 0; channel < 3; channel++)
					if (abs(image.pixels[4 * k + channel] -
						image.pixels[channel]) > 1)
						fail_msg("a seam towards %g %g %g", look.ahead[0],
							 look.ahead[1], look.ahead[2]);
			edges += on_sides == 2;
			corners += on_sides == 3;
		}
	}
	assert_int_equal(edges, 36);
	assert_int_equal(corners, 8);
	gz_surface_caster_destroy(&caster);
	gz_image_free(&image);
}

/* The inner texel (0, 0) of the face to the right. */
static uint32_t first_texel_of_folder(void)
{
	struct gz_cube cube = { 0 };
	captured_log_init(&heard, NULL);
	if (gz_cube_load(files_folder(), &heard.log, &cube) != GZ_OK)
		fail_msg("refused: %s", heard.last);
	const uint32_t texel = cube.texels[cube.edge + 3];
	gz_cube_free(&cube);
	assert_null(cube.texels);
	return texel;
}

static void write_all_faces(struct png_layout layout, const uint8_t *rows, size_t row_bytes)
{
	for (int face = 0; face < GZ_CUBE_FACES; face++)
		write_png(names[face], layout, rows, row_bytes);
}

static void faces_of_any_kind_of_png_are_read(void **state)
{
	(void)state;
	static const uint8_t grey8[1] = { 77 }, bit[1] = { 0x80 };
	static const uint8_t grey16[2] = { 0x4D, 0x4D }, grey_alpha[2] = { 9, 128 };
	static const uint8_t rgb16[6] = { 1, 1, 2, 2, 3, 3 }, rgba[4] = { 4, 5, 6, 255 };
	static const struct {
		struct png_layout layout;
		const uint8_t *row;
		size_t row_bytes;
		uint32_t texel;
	} cases[] = {
		{ { 1, 1, 8, 0 }, grey8, 1, 0xFF4D4D4D },
		{ { 1, 1, 1, 0 }, bit, 1, 0xFFFFFFFF },
		{ { 1, 1, 1, 3 }, bit, 1, 0xFF6496C8 }, /* the palette's second colour */
		{ { 1, 1, 16, 0 }, grey16, 2, 0xFF4D4D4D },
		{ { 1, 1, 8, 4 }, grey_alpha, 2, 0xFF090909 },
		{ { 1, 1, 16, 2 }, rgb16, 6, 0xFF030201 },
		{ { 1, 1, 8, 6 }, rgba, 4, 0xFF060504 },
	};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		write_all_faces(cases[i].layout, cases[i].row, cases[i].row_bytes);
		const uint32_t texel = first_texel_of_folder();
		if (texel != cases[i].texel)
			fail_msg("case %zu: %08x, not %08x", i, texel, cases[i].texel);
	}
}

/* Load what is in the folder, and check that it is refused with one line that says this. */
static void assert_cube_refused(enum gz_result expected, const char *face, const char *says,
				bool checked)
{
	struct gz_cube cube = { .edge = -7 };
	captured_log_init(&heard, NULL);
	assert_int_equal(gz_cube_load(files_folder(), &heard.log, &cube), expected);
	assert_int_equal(cube.edge, -7);
	assert_int_equal(heard.messages, 1);
	if (!strstr(heard.last, face) || !strstr(heard.last, says))
		fail_msg("said \"%s\", not %s: %s", heard.last, face, says);
	assert_int_equal(gz_cube_check(files_folder(), NULL), checked ? expected : GZ_OK);
}

static void bad_faces_are_refused_by_name(void **state)
{
	(void)state;
	static uint8_t rows[3 * (GZ_CUBE_EDGE_MAX / 8 + 2)];
	const struct png_layout good = { 8, 8, 8, 0 };
	write_all_faces(good, rows, 8);
	(void)first_texel_of_folder();

	remove(files_path("up.png"));
	assert_cube_refused(GZ_ERR_NOT_FOUND, "up.png", "cannot open", true);
	files_write("up.png", "text", 4);
	assert_cube_refused(GZ_ERR_FORMAT, "up.png", "not a PNG", true);
	files_write("up.png", "", 0);
	assert_cube_refused(GZ_ERR_FORMAT, "up.png", "not a PNG", true);
	write_png("up.png", (struct png_layout) { 8, 7, 8, 0 }, rows, 8);
	assert_cube_refused(GZ_ERR_FORMAT, "up.png", "8 x 7 pixels; the face of a cube is square",
			    true);
	write_png("up.png", (struct png_layout) { 7, 7, 8, 0 }, rows, 7);
	assert_cube_refused(GZ_ERR_FORMAT, "up.png", "7 x 7 pixels, but right.png has 8 x 8", true);

	/* Claims more rows than it has: only who reads the pixels can know. */
	static const uint8_t head[] = { 0, 0, 0, 8, 0, 0, 0, 8, 8, 0, 0, 0, 0 };
	uint8_t bytes[128], row[9] = { 0 }, packed[1100];
	memcpy(bytes, "\x89PNG\r\n\x1a\n", 8);
	size_t size = 8 + put_chunk("IHDR", head, sizeof head, bytes + 8);
	const size_t packed_size = files_deflate(row, sizeof row, 15, packed, sizeof packed);
	size += put_chunk("IDAT", packed, packed_size, bytes + size);
	size += put_chunk("IEND", NULL, 0, bytes + size);
	files_write("up.png", bytes, size);
	assert_cube_refused(GZ_ERR_FORMAT, "up.png", "damaged PNG", false);

	write_png("right.png", (struct png_layout) { GZ_CUBE_EDGE_MAX + 1, 1, 1, 0 }, rows,
		  GZ_CUBE_EDGE_MAX / 8 + 1);
	assert_cube_refused(GZ_ERR_FORMAT, "right.png", "is square", true);
}

static enum gz_result find_cube(const char *scene, int kind, const char *folder,
				struct gz_environment *environment)
{
	struct gz_ray_params rays = gz_ray_params_default();
	*environment = rays.environment;
	environment->kind = kind;
	snprintf(environment->cube, sizeof environment->cube, "%s", folder);
	captured_log_init(&heard, NULL);
	return gz_scene_find_cube(scene, &heard.log, environment);
}

static void scene_finds_its_folder_and_says_what_is_missing(void **state)
{
	(void)state;
	struct gz_environment environment;
	char scene[GZ_PATH_SIZE];
	snprintf(scene, sizeof scene, "%s/a.scene", files_folder());
	write_noise_faces();
	assert_int_equal(find_cube(scene, GZ_SURROUNDINGS_CUBE, ".", &environment), GZ_OK);
	assert_int_equal(gz_cube_check(environment.cube_path, NULL), GZ_OK);
	assert_int_equal(find_cube(scene, GZ_SURROUNDINGS_SKY, "", &environment), GZ_OK);
	assert_string_equal(environment.cube_path, "");
	assert_int_equal(find_cube(scene, GZ_SURROUNDINGS_CUBE, "", &environment), GZ_ERR_FORMAT);
	assert_non_null(strstr(heard.last, "environment.cube: not given"));
	assert_int_equal(find_cube(scene, GZ_SURROUNDINGS_CUBE, "none", &environment),
			 GZ_ERR_NOT_FOUND);
	assert_non_null(strstr(heard.last, "environment.cube: none is neither"));
	remove(files_path("down.png"));
	assert_int_equal(find_cube(scene, GZ_SURROUNDINGS_SKY, ".", &environment),
			 GZ_ERR_NOT_FOUND);
	assert_non_null(strstr(heard.last, "down.png"));
}

TEST_SUITE(cube)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(eye_turned_to_a_face_by_90_degrees_sees_its_picture),
		cmocka_unit_test(cube_with_another_top_is_turned_the_shortest_way),
		cmocka_unit_test(axes_are_right_front_and_up),
		cmocka_unit_test(faces_meet_without_a_seam),
		cmocka_unit_test(faces_of_any_kind_of_png_are_read),
		cmocka_unit_test(bad_faces_are_refused_by_name),
		cmocka_unit_test(scene_finds_its_folder_and_says_what_is_missing),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
