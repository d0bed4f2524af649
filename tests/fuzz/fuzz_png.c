/* Pictures from anywhere, such as the faces of surroundings: whatever the bytes, a picture that is
 * read has as many pixels as its file says, all of them opaque, and one that is refused leaves what
 * was there. The sums of chunks are put right in a second reading, so that the fuzzer gets past
 * them. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

#include "fuzz/fuzz_folder.h"
#include "render/picture/image.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Bytes of a PNG before its first chunk, and of a chunk before and after its content. */
enum { SIGNATURE_BYTES = 8, CHUNK_HEAD = 8, CHUNK_SUM = 4 };

static char folder[64], path[80];

static void require(bool holds)
{
	if (!holds)
		abort();
}

static void remove_folder(void)
{
	unlink(path);
	rmdir(folder);
}

static void make_folder(void)
{
	if (folder[0])
		return;
	fuzz_folder_make(folder);
	snprintf(path, sizeof path, "%s/a.png", folder);
	atexit(remove_folder);
}

static void check_picture(const uint8_t *data, size_t size)
{
	struct gz_image image = { 0 };
	int measured[2] = { 0, 0 };
	FILE *file = fopen(path, "wb");
	require(file != NULL);
	require(fwrite(data, 1, size, file) == size);
	require(fclose(file) == 0);
	require(gz_image_resize(&image, 1, 1) == GZ_OK);
	const uint8_t *before = image.pixels;
	const bool has_size = gz_image_measure_png(path, NULL, measured) == GZ_OK;
	if (gz_image_read_png(path, NULL, &image) == GZ_OK) {
		require(has_size && image.width == measured[0] && image.height == measured[1]);
		const size_t count = (size_t)image.width * (size_t)image.height;
		for (size_t i = 0; i < count; i++)
			require(image.pixels[4 * i + 3] == 255);
	} else {
		require(image.pixels == before && image.width == 1 && image.height == 1);
	}
	gz_image_free(&image);
}

static uint32_t big_endian(const uint8_t *bytes)
{
	return (uint32_t)bytes[0] << 24 | (uint32_t)bytes[1] << 16 | (uint32_t)bytes[2] << 8 |
	       bytes[3];
}

/* Put the sums of all whole chunks right. */
static void correct_sums(uint8_t *bytes, size_t size)
{
	size_t at = SIGNATURE_BYTES;
	while (at + CHUNK_HEAD + CHUNK_SUM <= size) {
		const size_t length = big_endian(bytes + at);
		if (length > size - at - CHUNK_HEAD - CHUNK_SUM)
			return;
		uint8_t *end = bytes + at + CHUNK_HEAD + length;
		/* of the type and the content */
		const uint32_t sum = (uint32_t)crc32(0, bytes + at + 4, (uInt)(4 + length));
		for (int i = 0; i < CHUNK_SUM; i++)
			end[i] = (uint8_t)(sum >> (24 - 8 * i));
		at += CHUNK_HEAD + length + CHUNK_SUM;
	}
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	make_folder();
	check_picture(data, size);
	uint8_t *corrected = size > 0 ? malloc(size) : NULL;
	if (!corrected)
		return 0;
	memcpy(corrected, data, size);
	correct_sums(corrected, size);
	if (memcmp(corrected, data, size) != 0)
		check_picture(corrected, size);
	free(corrected);
	return 0;
}
