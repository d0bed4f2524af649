#include "volume_files.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

static char folder[64];

static void remove_folder(void)
{
	DIR *listing = opendir(folder);
	for (struct dirent *entry; listing && (entry = readdir(listing));)
		if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0)
			unlink(files_path(entry->d_name));
	if (listing)
		closedir(listing);
	rmdir(folder);
}

const char *files_folder(void)
{
	if (!folder[0]) {
		strcpy(folder, "/tmp/gazecast-volume-XXXXXX");
		if (!mkdtemp(folder))
			abort();
		atexit(remove_folder);
	}
	return folder;
}

const char *files_path(const char *name)
{
	static char paths[8][512];
	static int next;
	char *path = paths[next++ % 8];
	snprintf(path, sizeof paths[0], "%s/%s", files_folder(), name);
	return path;
}

const char *files_write(const char *name, const void *bytes, size_t size)
{
	return files_write_text(name, "", bytes, size);
}

const char *files_write_text(const char *name, const char *text, const void *bytes, size_t size)
{
	const char *path = files_path(name);
	FILE *file = fopen(path, "wb");
	if (!file || fputs(text, file) < 0 || (size && fwrite(bytes, 1, size, file) != size) ||
	    fclose(file) != 0)
		abort();
	return path;
}

size_t files_deflate(const void *bytes, size_t size, int window_bits, void *out, size_t room)
{
	z_stream z = { .next_in = (Bytef *)(uintptr_t)bytes,
		       .avail_in = (uInt)size,
		       .next_out = out,
		       .avail_out = (uInt)room };
	if (deflateInit2(&z, 6, Z_DEFLATED, window_bits, 8, Z_DEFAULT_STRATEGY) != Z_OK ||
	    deflate(&z, Z_FINISH) != Z_STREAM_END)
		abort();
	size_t used = room - z.avail_out;
	deflateEnd(&z);
	return used;
}

struct nifti_sample nifti_sample_make(int x, int y, int z)
{
	return (struct nifti_sample) {
		.dim = { 3, (int16_t)x, (int16_t)y, (int16_t)z, 1, 1, 1, 1 },
		.datatype = 2,
		.bitpix = 8,
		.pixdim = { 1, 1, 1, 1, 1, 1, 1, 1 },
		.vox_offset = 352,
		.magic = "n+1",
	};
}

static void put(uint8_t *out, const void *value, size_t size, bool swapped)
{
	for (size_t i = 0; i < size; i++)
		out[i] = ((const uint8_t *)value)[swapped ? size - 1 - i : i];
}

/* Offsets are those of nifti1.h. */
void nifti_sample_bytes(const struct nifti_sample *s, uint8_t out[352])
{
	int32_t header_size = 348;
	memset(out, 0, 352);
	put(out, &header_size, 4, s->swapped);
	for (size_t i = 0; i < 8; i++)
		put(out + 40 + 2 * i, &s->dim[i], 2, s->swapped);
	put(out + 70, &s->datatype, 2, s->swapped);
	put(out + 72, &s->bitpix, 2, s->swapped);
	for (size_t i = 0; i < 8; i++)
		put(out + 76 + 4 * i, &s->pixdim[i], 4, s->swapped);
	put(out + 108, &s->vox_offset, 4, s->swapped);
	put(out + 112, &s->slope, 4, s->swapped);
	put(out + 116, &s->intercept, 4, s->swapped);
	put(out + 252, &s->qform_code, 2, s->swapped);
	put(out + 254, &s->sform_code, 2, s->swapped);
	for (size_t i = 0; i < 3; i++)
		put(out + 256 + 4 * i, &s->quatern[i], 4, s->swapped);
	for (size_t i = 0; i < 12; i++)
		put(out + 280 + 4 * i, &s->srow[i / 4][i % 4], 4, s->swapped);
	memcpy(out + 344, s->magic, 4);
}

static void put_double(uint8_t *out, float value, bool swapped)
{
	const double wide = (double)value;
	put(out, &wide, sizeof wide, swapped);
}

static void put_wide(uint8_t *out, int64_t value, bool swapped)
{
	put(out, &value, sizeof value, swapped);
}

static void put_code(uint8_t *out, int32_t value, bool swapped)
{
	put(out, &value, sizeof value, swapped);
}

/* Offsets are those of nifti2.h. */
void nifti2_sample_bytes(const struct nifti_sample *s, bool pair, uint8_t out[544])
{
	memset(out, 0, 544);
	put_code(out, 540, s->swapped);
	memcpy(out + 4, pair ? "ni2\0\r\n\032\n" : "n+2\0\r\n\032\n", 8);
	put(out + 12, &s->datatype, 2, s->swapped);
	put(out + 14, &s->bitpix, 2, s->swapped);
	for (size_t i = 0; i < 8; i++)
		put_wide(out + 16 + 8 * i, s->dim[i], s->swapped);
	for (size_t i = 0; i < 8; i++)
		put_double(out + 104 + 8 * i, s->pixdim[i], s->swapped);
	put_wide(out + 168, pair ? 0 : 544, s->swapped);
	put_double(out + 176, s->slope, s->swapped);
	put_double(out + 184, s->intercept, s->swapped);
	put_code(out + 344, s->qform_code, s->swapped);
	put_code(out + 348, s->sform_code, s->swapped);
	for (size_t i = 0; i < 3; i++)
		put_double(out + 352 + 8 * i, s->quatern[i], s->swapped);
	for (size_t i = 0; i < 12; i++)
		put_double(out + 400 + 8 * i, s->srow[i / 4][i % 4], s->swapped);
}
