#include "suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

#include "base/captured_log.h"
#include "render/picture/image.h"
#include "render/scene/scene_picture.h"
#include "scene_text.h"
#include "volume_files.h"

#define SCENE                                                                                     \
	"[volume]\nprocedural = shells\ndims = 12 10 8\n[camera]\nfov_deg = 31.25\n[foveation]\n" \
	"method = mdc\n"

static const struct gz_transfer ramp = {
	.count = 2, .points = { { 0.1, { 0, 0, 1.0 / 3 }, 0 }, { 1, { 1, 0.5, 0 }, 0.7 } }
};

static struct gz_image grey(int width, int height)
{
	struct gz_image image = { 0 };
	assert_int_equal(gz_image_resize(&image, width, height), GZ_OK);
	memset(image.pixels, 128, (size_t)width * (size_t)height * 4);
	return image;
}

static void made_volume(struct gz_volume *out_volume)
{
	const int dims[3] = { 12, 10, 8 };
	const double spacing[3] = { 1, 1, 1 };
	assert_int_equal(
		gz_volume_generate(&(struct gz_procedural_request) { GZ_PROCEDURAL_SHELLS, dims,
								     spacing, GZ_VOXEL_U8 },
				   NULL, NULL, out_volume),
		GZ_OK);
}

static void picture_holds_its_scene_and_transfer_function(void **state)
{
	(void)state;
	struct gz_image image = grey(5, 4), back = { 0 };
	struct gz_scene_settings settings = scene_of_text(SCENE, NULL);
	const struct gz_scene_saved saved = { &settings, false, "" };
	struct gz_scene_picture picture;
	struct gz_volume volume;
	struct captured_log log;
	captured_log_init(&log, NULL);
	made_volume(&volume);
	const char *path = files_path("told.png");
	assert_int_equal(gz_scene_picture_write(&image, &saved, &ramp, &volume, path, &log.log),
			 GZ_OK);
	if (gz_scene_picture_read(path, &log.log, &picture) != GZ_OK)
		fail_msg("%s", log.last);
	assert_true(picture.settings.camera.fov_deg == 31.25);
	assert_int_equal(picture.settings.foveation.method, settings.foveation.method);
	assert_true(picture.has_transfer);
	assert_memory_equal(&picture.transfer.points, &ramp.points, 2 * sizeof ramp.points[0]);
	assert_true(gz_scene_picture_check(&picture, &volume, path, &log.log));
	assert_int_equal(log.messages, 0);
	/* It is still a picture. */
	assert_int_equal(gz_image_read_png(path, NULL, &back), GZ_OK);
	assert_int_equal(back.width, 5);
	((unsigned char *)volume.voxels)[100] ^= 1;
	assert_false(gz_scene_picture_check(&picture, &volume, path, &log.log));
	assert_non_null(strstr(log.last, "was made from other data"));
	gz_volume_free(&volume);
	gz_image_free(&image);
	gz_image_free(&back);
}

static void file_names_in_a_picture_are_absolute(void **state)
{
	(void)state;
	struct gz_image image = grey(2, 2);
	struct gz_scene_picture picture;
	struct gz_scene_settings settings = scene_of_text("[volume]\nfile = v.nii\n", NULL);
	char scene[GZ_PATH_SIZE];
	files_write("v.nii", "x", 1);
	snprintf(scene, sizeof scene, "%s", files_path("a.scene"));
	const struct gz_scene_saved saved = { &settings, false, scene };
	const char *path = files_path("absolute.png");
	assert_int_equal(gz_scene_picture_write(&image, &saved, NULL, NULL, path, NULL), GZ_OK);
	assert_int_equal(gz_scene_picture_read(path, NULL, &picture), GZ_OK);
	assert_true(picture.settings.volume_file[0] == '/');
	assert_int_equal(access(picture.settings.volume_file, F_OK), 0);
	assert_false(picture.has_transfer);
	assert_string_equal(picture.mark, "");
	gz_image_free(&image);
}

static void picture_is_saved_without_a_scene_that_cannot_be_printed(void **state)
{
	(void)state;
	struct gz_image image = grey(2, 2);
	struct gz_scene_picture picture;
	struct captured_log log;
	struct gz_scene_settings settings = scene_of_text(SCENE, NULL);
	const struct gz_scene_saved saved = { &settings, false, "" };
	captured_log_init(&log, NULL);
	settings.camera.fov_deg = -1;
	const char *path = files_path("untold.png");
	assert_int_equal(gz_scene_picture_write(&image, &saved, NULL, NULL, path, &log.log), GZ_OK);
	assert_non_null(strstr(log.last, "without its scene"));
	assert_int_equal(gz_scene_picture_read(path, &log.log, &picture), GZ_ERR_NOT_FOUND);
	assert_non_null(strstr(log.last, "holds no scene"));
	gz_image_free(&image);
}

static void files_that_are_not_pictures_are_refused(void **state)
{
	(void)state;
	struct gz_scene_picture picture;
	struct captured_log log;
	captured_log_init(&log, NULL);
	assert_int_equal(gz_scene_picture_read(files_path("none.png"), &log.log, &picture),
			 GZ_ERR_NOT_FOUND);
	assert_int_equal(
		gz_scene_picture_read(files_write("text.png", "hello", 5), &log.log, &picture),
		GZ_ERR_FORMAT);
	assert_int_equal(log.messages, 2);
}

/* Every way to cut or to flip a byte of a picture's texts: refused, or as it was. */
static void damaged_picture_is_refused_or_read_as_it_was(void **state)
{
	(void)state;
	struct gz_image image = grey(1, 1);
	const struct gz_image_text texts[] = { { "gazecast.scene", SCENE } };
	const char *path = files_path("whole.png");
	struct gz_text bytes = { 0 };
	assert_int_equal(gz_image_write_png_with(&image, texts, 1, path, NULL), GZ_OK);
	assert_int_equal(gz_text_add_file(&bytes, path), GZ_OK);
	size_t refused = 0;
	for (size_t i = 0; i < 2 * bytes.length; i++) {
		const size_t at = i / 2, size = i % 2 ? bytes.length : at;
		struct gz_text text = { 0 };
		bytes.bytes[at] ^= i % 2 ? 0x40 : 0;
		FILE *file = fmemopen(bytes.bytes, size ? size : 1, "rb");
		const enum gz_result result = gz_image_find_text(file, "gazecast.scene", &text);
		refused += result != GZ_OK;
		if (result == GZ_OK)
			assert_string_equal(text.bytes, SCENE);
		fclose(file);
		bytes.bytes[at] ^= i % 2 ? 0x40 : 0;
		gz_text_free(&text);
	}
	assert_true(refused > bytes.length);
	gz_text_free(&bytes);
	gz_image_free(&image);
}

static void put_chunk(FILE *file, const char *type, const void *data, size_t size)
{
	const unsigned char length[4] = { (unsigned char)(size >> 24), (unsigned char)(size >> 16),
					  (unsigned char)(size >> 8), (unsigned char)size };
	uLong crc = crc32(crc32(0, (const Bytef *)type, 4), data, (uInt)size);
	fwrite(length, 1, 4, file);
	fwrite(type, 1, 4, file);
	fwrite(data, 1, size, file);
	for (int shift = 24; shift >= 0; shift -= 8)
		fputc((int)(crc >> shift & 255), file);
}

/* A chunk's data: what stands before the text, and the text, compressed or not. */
static void put_text(FILE *file, const char *type, const char *before, size_t size,
		     const char *plain, bool compressed)
{
	unsigned char data[1024];
	uLongf length = sizeof data - size;
	memcpy(data, before, size);
	if (compressed)
		assert_int_equal(
			compress(data + size, &length, (const Bytef *)plain, strlen(plain)), Z_OK);
	else
		memcpy(data + size, plain, length = strlen(plain));
	put_chunk(file, type, data, size + length);
}

/* Chunks as other programs write them. */
static void texts_of_all_kinds_are_read(void **state)
{
	(void)state;
	const char *path = files_path("kinds.png");
	FILE *file = fopen(path, "w+b");
	fwrite("\x89PNG\r\n\x1a\n", 1, 8, file);
	put_chunk(file, "IHDR", "\0\0\0\1\0\0\0\1\10\0\0\0\0", 13); /* one grey pixel */
	put_text(file, "tEXt", "a\0", 2, "plain", false);
	put_text(file, "zTXt", "b\0\0", 3, "packed", true);
	put_text(file, "iTXt", "c\0\0\0en\0x\0", 9, "told", false);
	put_text(file, "iTXt", "d\0\1\0\0\0", 6, "packed and told", true);
	put_text(file, "IDAT", "", 0, "\1\1", true);
	put_text(file, "tEXt", "h\0", 2, "behind the pixels", false);
	put_text(file, "zTXt", "e\0\0", 3, "no stream", false);
	put_text(file, "iTXt", "f\0\0\0en", 6, "no end", false);
	put_chunk(file, "IEND", "", 0);
	static const struct {
		const char *keyword;
		enum gz_result result;
		const char *text;
	} rows[] = {
		{ "a", GZ_OK, "plain" },      { "b", GZ_OK, "packed" },
		{ "c", GZ_OK, "told" },       { "d", GZ_OK, "packed and told" },
		{ "e", GZ_ERR_FORMAT, NULL }, { "f", GZ_ERR_FORMAT, NULL },
		{ "g", GZ_ERR_FORMAT, NULL }, { "h", GZ_OK, "behind the pixels" },
	};
	for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
		struct gz_text text = { 0 };
		rewind(file);
		assert_int_equal(gz_image_find_text(file, rows[i].keyword, &text), rows[i].result);
		if (rows[i].text)
			assert_string_equal(text.bytes, rows[i].text);
		gz_text_free(&text);
	}
	fclose(file);
}

/* A text of @p length bytes behind a large chunk of another kind. */
static enum gz_result find_long_text(size_t length)
{
	const char *path = files_path("long.png");
	FILE *file = fopen(path, "w+b");
	char *data = malloc(2 + length);
	struct gz_text text = { 0 };
	memcpy(data, "k\0", 2);
	memset(data + 2, 'y', length);
	fwrite("\x89PNG\r\n\x1a\n", 1, 8, file);
	put_chunk(file, "IHDR", "\0\0\0\1\0\0\0\1\10\0\0\0\0", 13);
	put_chunk(file, "eXIf", data, 2 + length);
	put_chunk(file, "tEXt", data, 2 + length);
	put_text(file, "IDAT", "", 0, "\1\1", true);
	put_chunk(file, "IEND", "", 0);
	rewind(file);
	const enum gz_result result = gz_image_find_text(file, "k", &text);
	if (result == GZ_OK)
		assert_int_equal(text.length, length);
	else
		assert_null(text.bytes);
	gz_text_free(&text);
	free(data);
	fclose(file);
	return result;
}

static void text_above_the_limit_is_refused(void **state)
{
	(void)state;
	assert_int_equal(find_long_text(GZ_IMAGE_TEXT_MAX), GZ_OK);
	assert_int_equal(find_long_text(GZ_IMAGE_TEXT_MAX + 1), GZ_ERR_FORMAT);
	assert_int_equal(find_long_text(2 * GZ_IMAGE_TEXT_MAX), GZ_ERR_FORMAT);
}

TEST_SUITE(scene_picture)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(picture_holds_its_scene_and_transfer_function),
		cmocka_unit_test(file_names_in_a_picture_are_absolute),
		cmocka_unit_test(picture_is_saved_without_a_scene_that_cannot_be_printed),
		cmocka_unit_test(files_that_are_not_pictures_are_refused),
		cmocka_unit_test(damaged_picture_is_refused_or_read_as_it_was),
		cmocka_unit_test(texts_of_all_kinds_are_read),
		cmocka_unit_test(text_above_the_limit_is_refused),
	};
	unsetenv("GAZECAST_DATA");
	return cmocka_run_group_tests(tests, NULL, NULL);
}
