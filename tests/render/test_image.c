#include "suite.h"

#include <dirent.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "base/captured_log.h"
#include "render/picture/image.h"
#include "volume_files.h"

static struct gz_image image_make(int width, int height)
{
	struct gz_image image = { 0 };
	assert_int_equal(gz_image_resize(&image, width, height), GZ_OK);
	for (int i = 0; i < width * height; i++) {
		image.pixels[4 * i] = (uint8_t)(i * 7);
		image.pixels[4 * i + 1] = (uint8_t)(i * 13 + 5);
		image.pixels[4 * i + 2] = (uint8_t)(255 - i);
		image.pixels[4 * i + 3] = 255;
	}
	return image;
}

static int files_in_folder(void)
{
	int count = 0;
	DIR *folder = opendir(files_folder());
	for (struct dirent *entry; (entry = readdir(folder));)
		count += entry->d_name[0] != '.';
	closedir(folder);
	return count;
}

static void resize_keeps_the_buffer_that_fits_and_refuses_bad_sizes(void **state)
{
	(void)state;
	struct gz_image image = { 0 };
	assert_int_equal(gz_image_resize(&image, 30, 20), GZ_OK);
	uint8_t *pixels = image.pixels;
	assert_int_equal((uintptr_t)pixels % 64, 0);
	assert_int_equal(gz_image_resize(&image, 20, 30), GZ_OK);
	assert_ptr_equal(image.pixels, pixels);
	assert_int_equal(image.width, 20);
	assert_int_equal(gz_image_resize(&image, 0, 5), GZ_ERR_INVAL);
	assert_int_equal(gz_image_resize(&image, 5, -1), GZ_ERR_INVAL);
	assert_int_equal(gz_image_resize(&image, GZ_IMAGE_SIDE_MAX + 1, 5), GZ_ERR_INVAL);
	assert_int_equal(image.width, 20);
	assert_int_equal(image.height, 30);
	gz_image_free(&image);
	assert_null(image.pixels);
	gz_image_free(&image);
}

static void png_written_and_read_is_the_same_picture(void **state)
{
	(void)state;
	struct gz_image image = image_make(33, 17), back = { 0 };
	for (int i = 0; i < 33 * 17; i++)
		image.pixels[4 * i + 3] = (uint8_t)i; /* alpha must not travel */
	const char *path = files_path("a.png");
	assert_int_equal(gz_image_write_png(&image, path, NULL), GZ_OK);
	assert_int_equal(gz_image_read_png(path, NULL, &back), GZ_OK);
	assert_int_equal(back.width, 33);
	assert_int_equal(back.height, 17);
	for (int i = 0; i < 33 * 17; i++) {
		assert_memory_equal(back.pixels + 4 * i, image.pixels + 4 * i, 3);
		assert_int_equal(back.pixels[4 * i + 3], 255);
	}
	gz_image_free(&image);
	gz_image_free(&back);
}

static void full_disk_is_refused_and_leaves_no_file(void **state)
{
	(void)state;
	struct captured_log log;
	struct stat status;
	captured_log_init(&log, NULL);
	if (stat("/dev/full", &status) != 0 || !S_ISCHR(status.st_mode)) {
		print_message("no /dev/full here\n");
		skip();
	}
	struct gz_image image = image_make(64, 64);
	assert_int_equal(gz_image_write_png(&image, "/dev/full", &log.log), GZ_ERR_IO);
	assert_int_equal(log.messages, 1);
	assert_non_null(strstr(log.last, "/dev/full: cannot write the picture: No space left"));
	assert_int_equal(stat("/dev/full", &status), 0);
	assert_true(S_ISCHR(status.st_mode));
	gz_image_free(&image);
}

static void folder_that_is_not_there_is_refused(void **state)
{
	(void)state;
	struct captured_log log;
	captured_log_init(&log, NULL);
	struct gz_image image = image_make(4, 4), empty = { 0 };
	int before = files_in_folder();
	assert_int_equal(gz_image_write_png(&image, files_path("no/such/a.png"), &log.log),
			 GZ_ERR_IO);
	assert_non_null(strstr(log.last, "No such file or directory"));
	assert_int_equal(gz_image_write_png(&image, files_folder(), &log.log), GZ_ERR_IO);
	assert_int_equal(gz_image_write_png(&empty, files_path("e.png"), &log.log), GZ_ERR_INVAL);
	assert_int_equal(files_in_folder(), before);
	gz_image_free(&image);
}

static void writing_again_replaces_the_file_whole(void **state)
{
	(void)state;
	struct gz_image large = image_make(200, 200), small = image_make(3, 3), back = { 0 };
	const char *path = files_path("again.png");
	assert_int_equal(gz_image_write_png(&large, path, NULL), GZ_OK);
	int files = files_in_folder();
	assert_int_equal(gz_image_write_png(&small, path, NULL), GZ_OK);
	assert_int_equal(files_in_folder(), files);
	assert_int_equal(gz_image_read_png(path, NULL, &back), GZ_OK);
	assert_int_equal(back.width, 3);
	gz_image_free(&large);
	gz_image_free(&small);
	gz_image_free(&back);
}

static void what_is_no_png_is_refused(void **state)
{
	(void)state;
	struct captured_log log;
	captured_log_init(&log, NULL);
	struct gz_image image = image_make(50, 50), back = { 0 };
	const char *path = files_path("cut.png");
	char bytes[4096];
	assert_int_equal(gz_image_write_png(&image, path, NULL), GZ_OK);
	FILE *file = fopen(path, "rb");
	size_t size = fread(bytes, 1, sizeof bytes, file);
	fclose(file);
	files_write("cut.png", bytes, size / 2);
	assert_int_equal(gz_image_read_png(path, &log.log, &back), GZ_ERR_FORMAT);
	assert_int_equal(gz_image_read_png(files_write("t.png", "text", 4), &log.log, &back),
			 GZ_ERR_FORMAT);
	assert_int_equal(gz_image_read_png(files_path("none.png"), &log.log, &back),
			 GZ_ERR_NOT_FOUND);
	assert_int_equal(log.messages, 3);
	assert_null(back.pixels);
	gz_image_free(&image);
}

/* A head of 16384 x 16384 pixels of one bit, and no pixels: with its sum, libpng believes it. */
static void few_bytes_that_claim_many_pixels_take_no_memory(void **state)
{
	(void)state;
	static const unsigned char claims[] =
		"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0@\0\0\0@\0\1\0\0\0\0\x81\xb3\x2d\x29"
		"\0\0\0\0IDAT\x35\xaf\x06\x1e";
	struct captured_log log;
	captured_log_init(&log, NULL);
	struct gz_image back = { 0 };
	int size[2];
	const char *path = files_write("claims.png", (const char *)claims, sizeof claims - 1);
	assert_int_equal(gz_image_read_png(path, &log.log, &back), GZ_ERR_FORMAT);
	assert_non_null(strstr(log.last, "too short for 16384 x 16384 pixels"));
	assert_int_equal(gz_image_measure_png(path, &log.log, size), GZ_ERR_FORMAT);
	assert_null(back.pixels);
}

static void resample_to_the_same_size_changes_nothing(void **state)
{
	(void)state;
	struct gz_image image = image_make(9, 7), copy = { 0 };
	assert_int_equal(gz_image_resize(&copy, 9, 7), GZ_OK);
	gz_image_resample(&image, &copy);
	assert_memory_equal(copy.pixels, image.pixels, 9 * 7 * 4);
	gz_image_free(&image);
	gz_image_free(&copy);
}

static void shrinking_averages_each_box(void **state)
{
	(void)state;
	struct gz_image image = { 0 }, half = { 0 };
	assert_int_equal(gz_image_resize(&image, 4, 2), GZ_OK);
	assert_int_equal(gz_image_resize(&half, 2, 1), GZ_OK);
	static const uint8_t red[8] = { 0, 100, 10, 20, 200, 100, 30, 40 };
	memset(image.pixels, 255, 32);
	for (int i = 0; i < 8; i++)
		image.pixels[4 * i] = red[i];
	gz_image_resample(&image, &half);
	assert_int_equal(half.pixels[0], 100);
	assert_int_equal(half.pixels[4], 25);
	assert_int_equal(half.pixels[1], 255);
	assert_int_equal(half.pixels[3], 255);
	gz_image_free(&image);
	gz_image_free(&half);
}

static void growing_is_bilinear_between_centres(void **state)
{
	(void)state;
	struct gz_image image = { 0 }, wide = { 0 };
	assert_int_equal(gz_image_resize(&image, 2, 1), GZ_OK);
	assert_int_equal(gz_image_resize(&wide, 4, 1), GZ_OK);
	memset(image.pixels, 0, 8);
	image.pixels[4] = 200;
	gz_image_resample(&image, &wide);
	static const uint8_t expected[4] = { 0, 50, 150, 200 };
	for (int i = 0; i < 4; i++)
		assert_int_equal(wide.pixels[4 * i], expected[i]);
	gz_image_free(&image);
	gz_image_free(&wide);
}

TEST_SUITE(image)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(resize_keeps_the_buffer_that_fits_and_refuses_bad_sizes),
		cmocka_unit_test(png_written_and_read_is_the_same_picture),
		cmocka_unit_test(full_disk_is_refused_and_leaves_no_file),
		cmocka_unit_test(folder_that_is_not_there_is_refused),
		cmocka_unit_test(writing_again_replaces_the_file_whole),
		cmocka_unit_test(what_is_no_png_is_refused),
		cmocka_unit_test(few_bytes_that_claim_many_pixels_take_no_memory),
		cmocka_unit_test(resample_to_the_same_size_changes_nothing),
		cmocka_unit_test(shrinking_averages_each_box),
		cmocka_unit_test(growing_is_bilinear_between_centres),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
