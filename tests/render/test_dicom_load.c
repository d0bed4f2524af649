/* The DICOM reader without the process that protects the viewer: damaged files, one after the
 * other. */
#include "suite.h"

#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "dicom_files.h"
#include "render/decode/dicom/dicom_load.h"
#include "volume_files.h"

/* A file of 16 signed bits, read into memory; its size. */
static size_t whole_file(uint8_t *bytes, size_t room, bool bare)
{
	const int16_t pixels[6] = { 5, 6, 7, 8, 9, 10 };
	struct dicom_sample sample = dicom_sample_make("1.2.3.4.5", 1, pixels);
	sample.bare = bare;
	const char *path = dicom_sample_write(&sample, "whole.dcm");
	FILE *in = fopen(path, "rb");
	assert_non_null(in);
	const size_t size = fread(bytes, 1, room, in);
	fclose(in);
	unlink(path);
	assert_true(size > 200 && size < room);
	return size;
}

static enum gz_result load_bytes(const uint8_t *bytes, size_t size, struct gz_volume *out_volume)
{
	const struct gz_volume_file file = { .path = files_write("changed.dcm", bytes, size) };
	return gz_dicom_load(&file, NULL, out_volume);
}

static void file_cut_anywhere_is_refused(void **state)
{
	(void)state;
	uint8_t bytes[4096];
	for (int bare = 0; bare < 2; bare++) {
		const size_t size = whole_file(bytes, sizeof bytes, bare);
		for (size_t cut = 0; cut < size; cut++) {
			struct gz_volume volume = { 0 };
			if (load_bytes(bytes, cut, &volume) == GZ_OK)
				fail_msg("%zu of %zu bytes made a volume", cut, size);
		}
		struct gz_volume volume = { 0 };
		assert_int_equal(load_bytes(bytes, size, &volume), GZ_OK);
		gz_volume_free(&volume);
	}
}

/* Address space for a file of a wrong byte, bytes: the library takes up to 4 GiB for a length that
 * it believes. The decoder process has such a limit too. */
#define SPACE_BYTES ((rlim_t)1 << 30)

static bool limit_address_space(void)
{
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
	return false;
#else
	const struct rlimit limit = { SPACE_BYTES, SPACE_BYTES };
	return setrlimit(RLIMIT_AS, &limit) == 0;
#endif
}

/* Whatever byte is wrong, the process goes on; what is loaded has a size that the file can fill. */
static void file_with_a_wrong_byte_is_refused_or_read(void **state)
{
	(void)state;
	uint8_t bytes[4096];
	static const uint8_t changes[] = { 0x01, 0x80, 0xff };
	const size_t size = whole_file(bytes, sizeof bytes, false);
	int loaded = 0;
	if (!limit_address_space()) {
		print_message("a sanitizer needs more address space than the limit\n");
		skip();
	}
	for (size_t at = 128; at < size; at++)
		for (size_t i = 0; i < sizeof changes; i++) {
			struct gz_volume volume = { 0 };
			bytes[at] ^= changes[i];
			if (load_bytes(bytes, size, &volume) == GZ_OK) {
				loaded++;
				assert_true(gz_volume_voxel_count(&volume) <= 12);
				gz_volume_free(&volume);
			}
			bytes[at] ^= changes[i];
		}
	assert_true(loaded > 100); /* most bytes are not those of the picture */
}

TEST_SUITE(dicom_load)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(file_cut_anywhere_is_refused),
		cmocka_unit_test(file_with_a_wrong_byte_is_refused_or_read),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
