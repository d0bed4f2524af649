#include "dicom_files.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

#include "volume_files.h"

#define EXPLICIT_LITTLE "1.2.840.10008.1.2.1"

/* Bytes of a file in the making. */
struct writer {
	uint8_t bytes[1 << 16];
	size_t size;
};

static void put(struct writer *writer, const void *bytes, size_t size)
{
	assert(writer->size + size <= sizeof writer->bytes);
	memcpy(writer->bytes + writer->size, bytes, size);
	writer->size += size;
}

static void put_number(struct writer *writer, uint32_t value, int size)
{
	for (int i = 0; i < size; i++) {
		const uint8_t byte = (uint8_t)(value >> (8 * i));
		put(writer, &byte, 1);
	}
}

static void put_tag(struct writer *writer, uint32_t tag, const char vr[2])
{
	put_number(writer, tag >> 16, 2);
	put_number(writer, tag & 0xFFFF, 2);
	put(writer, vr, 2);
}

static void put_text(struct writer *writer, uint32_t tag, const char *vr, const char *text)
{
	if (!text)
		return;
	const size_t size = strlen(text), even = (size + 1) & ~(size_t)1;
	put_tag(writer, tag, vr);
	put_number(writer, (uint32_t)even, 2);
	put(writer, text, size);
	if (even > size)
		put(writer, memcmp(vr, "UI", 2) == 0 ? "" : " ", 1);
}

static void put_short(struct writer *writer, uint32_t tag, int value)
{
	put_tag(writer, tag, "US");
	put_number(writer, 2, 2);
	put_number(writer, (uint32_t)value, 2);
}

static void put_long_head(struct writer *writer, uint32_t tag, const char *vr, size_t size)
{
	put_tag(writer, tag, vr);
	put_number(writer, 0, 2);
	put_number(writer, (uint32_t)size, 4);
}

static void put_meta(struct writer *writer, const char *instance, const char *transfer_syntax)
{
	static const uint8_t preamble[128];
	static const uint8_t version[2] = { 0, 1 };
	put(writer, preamble, sizeof preamble);
	put(writer, "DICM", 4);
	put_tag(writer, 0x00020000, "UL");
	put_number(writer, 4, 2);
	const size_t length_at = writer->size;
	put_number(writer, 0, 4);
	put_long_head(writer, 0x00020001, "OB", 2);
	put(writer, version, 2);
	put_text(writer, 0x00020002, "UI", "1.2.840.10008.5.1.4.1.1.2"); /* CT image */
	put_text(writer, 0x00020003, "UI", instance);
	put_text(writer, 0x00020010, "UI", transfer_syntax);
	put_text(writer, 0x00020012, "UI", "1.2.3.4");
	const uint32_t length = (uint32_t)(writer->size - length_at - 4);
	for (int i = 0; i < 4; i++)
		writer->bytes[length_at + (size_t)i] = (uint8_t)(length >> (8 * i));
}

struct dicom_sample dicom_sample_make(const char *series, int number, const int16_t pixels[6])
{
	return (struct dicom_sample) {
		.series = series,
		.number = number,
		.columns = 3,
		.rows = 2,
		.bits_allocated = 16,
		.bits_stored = 16,
		.high_bit = 15,
		.is_signed = 1,
		.samples_per_pixel = 1,
		.position = "0\\0\\0",
		.orientation = "1\\0\\0\\0\\1\\0",
		.spacing = "1\\1",
		.thickness = "1",
		.pixels = pixels,
		.pixel_bytes = 12,
	};
}

static void put_pixels(struct writer *writer, const struct dicom_sample *sample)
{
	put_long_head(writer, 0x7FE00010, sample->bits_allocated == 8 ? "OB" : "OW",
		      sample->claimed_bytes ? sample->claimed_bytes : sample->pixel_bytes);
	put(writer, sample->pixels, sample->pixel_bytes);
}

static void put_item(struct writer *writer, uint32_t tag, size_t size)
{
	put_number(writer, tag >> 16, 2);
	put_number(writer, tag & 0xFFFF, 2);
	put_number(writer, (uint32_t)size, 4);
}

/* An empty table of offsets, and one fragment (PS3.5, A.4). */
static void put_fragment(struct writer *writer, const struct dicom_sample *sample)
{
	put_long_head(writer, 0x7FE00010, "OB", 0xFFFFFFFF);
	put_item(writer, 0xFFFEE000, 0);
	put_item(writer, 0xFFFEE000, sample->pixel_bytes);
	put(writer, sample->pixels, sample->pixel_bytes);
	put_item(writer, 0xFFFEE0DD, 0);
}

/* Descriptors of three tables, then the tables (PS3.3, C.7.6.3.1.5). */
static void put_palette(struct writer *writer, const struct dicom_sample *sample)
{
	for (uint32_t i = 0; i < 3; i++) {
		put_number(writer, 0x0028, 2);
		put_number(writer, 0x1101 + i, 2);
		put(writer, "US", 2);
		put_number(writer, 6, 2);
		put_number(writer, (uint32_t)sample->palette_count & 0xFFFF, 2);
		put_number(writer, (uint32_t)sample->palette_first & 0xFFFF, 2);
		put_number(writer, (uint32_t)sample->palette_bits, 2);
	}
	const size_t count = (size_t)sample->palette_count;
	for (uint32_t i = 0; i < 3; i++) {
		put_long_head(writer, 0x00281201 + i, "OW", 2 * count);
		for (size_t k = 0; k < count; k++)
			put_number(writer, sample->palette[i * count + k], 2);
	}
}

const char *dicom_sample_write(const struct dicom_sample *sample, const char *name)
{
	static struct writer writer;
	char instance[96], number[16], frames[16];
	writer.size = 0;
	snprintf(instance, sizeof instance, "%s.%d", sample->series, sample->number);
	snprintf(number, sizeof number, "%d", sample->number);
	snprintf(frames, sizeof frames, "%d", sample->frames);
	if (!sample->bare)
		put_meta(&writer, instance,
			 sample->transfer_syntax ? sample->transfer_syntax : EXPLICIT_LITTLE);
	put_text(&writer, 0x00080008, "CS", sample->image_type);
	put_text(&writer, 0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.2");
	put_text(&writer, 0x00080018, "UI", instance);
	put_text(&writer, 0x00080060, "CS", "CT");
	put_text(&writer, 0x0008103E, "LO", sample->description);
	put_text(&writer, 0x00180050, "DS", sample->thickness);
	put_text(&writer, 0x0020000E, "UI", sample->series);
	put_text(&writer, 0x00200013, "IS", number);
	put_text(&writer, 0x00200032, "DS", sample->position);
	put_text(&writer, 0x00200037, "DS", sample->orientation);
	put_short(&writer, 0x00280002, sample->samples_per_pixel);
	put_text(&writer, 0x00280004, "CS",
		 sample->photometric              ? sample->photometric
		 : sample->samples_per_pixel == 1 ? "MONOCHROME2"
						  : "RGB");
	if (sample->samples_per_pixel > 1)
		put_short(&writer, 0x00280006, sample->planar);
	if (sample->frames)
		put_text(&writer, 0x00280008, "IS", frames);
	put_short(&writer, 0x00280010, sample->rows);
	put_short(&writer, 0x00280011, sample->columns);
	put_text(&writer, 0x00280030, "DS", sample->spacing);
	put_short(&writer, 0x00280100, sample->bits_allocated);
	put_short(&writer, 0x00280101, sample->bits_stored);
	put_short(&writer, 0x00280102, sample->high_bit);
	put_short(&writer, 0x00280103, sample->is_signed);
	put_text(&writer, 0x00281052, "DS", sample->intercept);
	put_text(&writer, 0x00281053, "DS", sample->slope);
	if (sample->palette)
		put_palette(&writer, sample);
	if (sample->csa) {
		put_text(&writer, 0x00290010, "LO", "SIEMENS CSA HEADER");
		put_long_head(&writer, 0x00291010, "OB", sample->csa_bytes);
		put(&writer, sample->csa, sample->csa_bytes);
	}
	if (sample->more)
		put(&writer, sample->more, sample->more_bytes);
	if (sample->encapsulated)
		put_fragment(&writer, sample);
	else
		put_pixels(&writer, sample);
	return files_write(name, writer.bytes, writer.size);
}
