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

/* Elements in the making. */
struct elements {
	uint8_t bytes[8192];
	size_t size;
};

#define UNKNOWN_LENGTH 0xFFFFFFFF
#define ITEM           0xFFFEE000
#define ITEM_END       0xFFFEE00D
#define SEQUENCE_END   0xFFFEE0DD
#define SHARED_GROUPS  0x52009229 /* a sequence that the reader asks for */

static void add_bytes(struct elements *elements, const void *bytes, size_t size)
{
	assert_true(elements->size + size <= sizeof elements->bytes);
	memcpy(elements->bytes + elements->size, bytes, size);
	elements->size += size;
}

static void add_number(struct elements *elements, uint32_t value, int size)
{
	for (int i = 0; i < size; i++)
		add_bytes(elements, &(uint8_t) { (uint8_t)(value >> (8 * i)) }, 1);
}

/* Of an item or an implicit element, without vr; else of an explicit one with a length of 32 bits.
 */
static void add_head(struct elements *elements, uint32_t tag, const char *vr, size_t length)
{
	add_number(elements, tag >> 16, 2);
	add_number(elements, tag & 0xFFFF, 2);
	if (vr) {
		add_bytes(elements, vr, 2);
		add_number(elements, 0, 2);
	}
	add_number(elements, (uint32_t)length, 4);
}

/* How an element lies within an item of a sequence. */
struct nesting {
	const char *name;
	const char *vr;                /* of the sequence; NULL: an implicit file */
	const char *within;            /* of the element; NULL: it is implicit */
	bool sequence_ends, item_ends; /* they tell their lengths */
};

static const struct nesting nestings[] = {
	{ "sequence and item", "SQ", "OB", true, true },
	{ "sequence", "SQ", "OB", true, false },
	{ "item", "SQ", "OB", false, true },
	{ "neither", "SQ", "OB", false, false },
	{ "unknown kind", "UN", NULL, true, true },
	{ "unknown kind and length", "UN", NULL, false, true },
	{ "implicit", NULL, NULL, true, true },
	{ "implicit of unknown length", NULL, NULL, false, true },
};

/* Put what there is into an item of a sequence. */
static void nest(struct elements *inner, const struct nesting *how)
{
	struct elements item = { .size = 0 }, whole = { .size = 0 };
	add_head(&item, ITEM, NULL, how->item_ends ? inner->size : UNKNOWN_LENGTH);
	add_bytes(&item, inner->bytes, inner->size);
	if (!how->item_ends)
		add_head(&item, ITEM_END, NULL, 0);
	add_head(&whole, SHARED_GROUPS, how->vr, how->sequence_ends ? item.size : UNKNOWN_LENGTH);
	add_bytes(&whole, item.bytes, item.size);
	if (!how->sequence_ends)
		add_head(&whole, SEQUENCE_END, NULL, 0);
	*inner = whole;
}

/* The elements of an explicit file as those of an implicit one, without a preamble. */
static void make_implicit(struct elements *elements)
{
	const struct elements from = *elements;
	elements->size = 0;
	for (size_t at = 0; at + 8 <= from.size;) {
		const uint8_t *head = from.bytes + at;
		const bool wide = memcmp(head + 4, "OW", 2) == 0;
		const size_t size =
			wide ? (size_t)(head[8] | head[9] << 8) : (size_t)(head[6] | head[7] << 8);
		at += wide ? 12 : 8;
		add_bytes(elements, head, 4);
		add_number(elements, (uint32_t)size, 4);
		add_bytes(elements, from.bytes + at, size);
		at += size;
	}
}

/* An image with further elements before its pixels. */
static enum gz_result load_with(const struct elements *more, bool implicit,
				struct gz_volume *out_volume)
{
	const int16_t pixels[6] = { 5, 6, 7, 8, 9, 10 };
	struct dicom_sample sample = dicom_sample_make("1.2.3.4.5", 1, pixels);
	struct elements file = { .size = 0 };
	sample.bare = true;
	if (!implicit) {
		sample.more = more->bytes;
		sample.more_bytes = more->size;
	}
	FILE *in = fopen(dicom_sample_write(&sample, "nested.dcm"), "rb");
	assert_non_null(in);
	file.size = fread(file.bytes, 1, sizeof file.bytes, in);
	fclose(in);
	if (implicit) {
		const size_t pixel_element = 12 + sizeof pixels;
		struct elements last = { .size = 0 };
		add_bytes(&last, file.bytes + file.size - pixel_element, pixel_element);
		file.size -= pixel_element;
		make_implicit(&file);
		make_implicit(&last);
		add_bytes(&file, more->bytes, more->size);
		add_bytes(&file, last.bytes, last.size);
	}
	return load_bytes(file.bytes, file.size, out_volume);
}

/* Memory that the process had at most so far, KiB. */
static long memory_peak_kib(void)
{
	struct rusage usage;
	assert_int_equal(getrusage(RUSAGE_SELF, &usage), 0);
	return usage.ru_maxrss;
}

/* The library takes the memory that an element claims before it reads. Here that is 768 MiB, and
 * 64 are more than the reader needs. */
static void length_beyond_what_encloses_it_takes_no_memory(void **state)
{
	(void)state;
	const uint32_t claims[] = { 4, 0x30000000 };
	for (size_t i = 0; i < 2 * sizeof nestings / sizeof nestings[0]; i++) {
		const struct nesting *how = &nestings[i / 2];
		const uint32_t claimed = claims[i % 2];
		struct elements more = { .size = 0 };
		struct gz_volume volume = { 0 };
		add_head(&more, 0x00420011, how->within, claimed);
		add_bytes(&more, "abcd", 4);
		nest(&more, how);
		const long before = memory_peak_kib();
		const enum gz_result result = load_with(&more, !how->vr, &volume);
		const long taken = memory_peak_kib() - before;
		if ((result == GZ_OK) != (claimed == 4) || taken > 64 * 1024)
			fail_msg("%s, %u bytes: result %d, %ld KiB", how->name, claimed, result,
				 taken);
		gz_volume_free(&volume);
	}
}

/* Where the kind of value is none of the standard's, the library guesses what follows it. */
static void length_of_a_value_of_no_kind_takes_no_memory(void **state)
{
	(void)state;
	const char *const kinds[] = { "??", "zz", "@F", "ox" };
	const uint32_t claims[] = { 0x50000000, 0xF0000000, 0xFFFFFFFE };
	for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++)
		for (size_t k = 0; k < sizeof claims / sizeof claims[0]; k++) {
			struct elements more = { .size = 0 };
			struct gz_volume volume = { 0 };
			add_number(&more, 0x0011, 2);
			add_number(&more, 0x1001, 2);
			add_bytes(&more, kinds[i], 2);
			add_number(&more, 0, 2);
			add_number(&more, claims[k], 4);
			add_bytes(&more, "abcd", 4);
			const long before = memory_peak_kib();
			load_with(&more, false, &volume);
			const long taken = memory_peak_kib() - before;
			if (taken > 64 * 1024)
				fail_msg("%s, %u bytes: %ld KiB", kinds[i], claims[k], taken);
			gz_volume_free(&volume);
		}
}

/* What fits into the file need not fit into the sequence. */
static void length_beyond_its_sequence_is_refused(void **state)
{
	(void)state;
	static const uint8_t padding[64];
	for (size_t i = 0; i < sizeof nestings / sizeof nestings[0]; i++) {
		const struct nesting *how = &nestings[i];
		struct elements more = { .size = 0 };
		struct gz_volume volume = { 0 };
		if (!how->sequence_ends)
			continue;
		add_head(&more, 0x00420011, how->within, 40);
		add_bytes(&more, "abcd", 4);
		nest(&more, how);
		add_head(&more, 0x7FDF0010, how->vr ? "OB" : NULL, sizeof padding);
		add_bytes(&more, padding, sizeof padding);
		if (load_with(&more, !how->vr, &volume) != GZ_ERR_FORMAT)
			fail_msg("%s: 40 bytes in a sequence of 12", how->name);
	}
}

static void sequences_within_each_other_have_a_limit(void **state)
{
	(void)state;
	for (int depth = 2; depth <= 162; depth += 40) {
		const struct nesting how = { .vr = "SQ", .sequence_ends = true, .item_ends = true };
		struct elements more = { .size = 0 };
		struct gz_volume volume = { 0 };
		for (int i = 0; i < depth; i++)
			nest(&more, &how);
		const enum gz_result result = load_with(&more, false, &volume);
		if ((result == GZ_OK) != (depth <= 128))
			fail_msg("%d sequences: result %d", depth, result);
		gz_volume_free(&volume);
	}
}

/* The fragments of a small picture within a sequence are no data sets. */
static void fragments_within_a_sequence_are_passed_over(void **state)
{
	(void)state;
	for (size_t i = 0; i < 4; i++) {
		struct elements more = { .size = 0 };
		struct gz_volume volume = { 0 };
		add_head(&more, 0x7FE00010, "OB", UNKNOWN_LENGTH);
		add_head(&more, ITEM, NULL, 0);
		add_head(&more, ITEM, NULL, 12);
		add_bytes(&more, "\x01\x02\x03\x04OB\0\0\xff\xff\xff\x7f", 12);
		add_head(&more, SEQUENCE_END, NULL, 0);
		nest(&more, &nestings[i]);
		if (load_with(&more, false, &volume) != GZ_OK)
			fail_msg("%s", nestings[i].name);
		gz_volume_free(&volume);
	}
}

TEST_SUITE(dicom_load)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(length_beyond_what_encloses_it_takes_no_memory),
		cmocka_unit_test(length_of_a_value_of_no_kind_takes_no_memory),
		cmocka_unit_test(length_beyond_its_sequence_is_refused),
		cmocka_unit_test(sequences_within_each_other_have_a_limit),
		cmocka_unit_test(fragments_within_a_sequence_are_passed_over),
		cmocka_unit_test(file_cut_anywhere_is_refused),
		cmocka_unit_test(file_with_a_wrong_byte_is_refused_or_read),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
