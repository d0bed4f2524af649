/* Projects of InVesalius: members in any order, orientation, types, and what is refused. */
#include "suite.h"

#include <stdio.h>
#include <string.h>

#include "base/captured_log.h"
#include "render/data/format.h"
#include "render/data/tar_member.h"
#include "volume_files.h"

/* What a test's property list says, and what its matrix holds. */
struct inv3_sample {
	const char *type, *shape, *modality, *more;
	int orientation;
	size_t matrix_bytes;
};

enum { COUNT = 12 };

/* Voxel (x, y, z) is 100 z + 10 y + x - 50, 3 x 2 x 2 of them. */
static const int16_t matrix[COUNT] = { -50, -49, -48, -40, -39, -38, 50, 51, 52, 60, 61, 62 };

static struct inv3_sample inv3_sample_make(void)
{
	return (struct inv3_sample) {
		.type = "int16",
		.shape = "<integer>2</integer><integer>2</integer><integer>3</integer>",
		.modality = "CT",
		.more = "",
		.orientation = 1,
		.matrix_bytes = sizeof matrix,
	};
}

/* A tar file that grows. */
struct tar {
	uint8_t bytes[16 * GZ_TAR_BLOCK];
	size_t size;
};

static void tar_add(struct tar *tar, const char *name, char type, const void *content, size_t size)
{
	uint8_t *block = tar->bytes + tar->size;
	unsigned sum = 0;
	assert_true(tar->size + GZ_TAR_BLOCK + gz_tar_padded_size(size) <= sizeof tar->bytes);
	memset(block, 0, GZ_TAR_BLOCK + gz_tar_padded_size(size));
	snprintf((char *)block, 100, "%s", name);
	snprintf((char *)block + 124, 12, "%011o", (unsigned)size);
	memset(block + 148, ' ', 8);
	block[156] = (uint8_t)type;
	memcpy(block + 257, "ustar\00000", 8);
	for (size_t i = 0; i < GZ_TAR_BLOCK; i++)
		sum += block[i];
	snprintf((char *)block + 148, 8, "%06o", sum);
	memcpy(block + GZ_TAR_BLOCK, content, size);
	tar->size += GZ_TAR_BLOCK + gz_tar_padded_size(size);
}

static void add_list(struct tar *tar, const struct inv3_sample *sample)
{
	char list[2048];
	snprintf(list, sizeof list,
		 "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
		 "<!DOCTYPE plist PUBLIC \"-//Apple//DTD PLIST 1.0//EN\" \"http://x.invalid\">\n"
		 "<plist version=\"1.0\">\n<dict>\n<key>annotations</key><dict></dict>\n"
		 "<key>matrix</key><dict>\n<key>dtype</key><string>%s</string>\n"
		 "<key>filename</key><string>matrix.dat</string>\n"
		 "<key>shape</key><array>%s</array></dict>\n"
		 "<key>masks</key><dict><key>modality</key><string>XX</string></dict>\n"
		 "<key>modality</key><string>%s</string>\n"
		 "<key>orientation</key><integer>%d</integer>\n%s"
		 "<key>spacing</key><array><real>0.5</real><real>0.75</real><integer>2</integer>"
		 "</array>\n</dict></plist>\n",
		 sample->type, sample->shape, sample->modality, sample->orientation, sample->more);
	tar_add(tar, "tmp1/main.plist", '0', list, strlen(list));
}

/* list_first: as older versions do; later ones also put a header of pax before each member. */
static const char *write_inv3(const char *name, const struct inv3_sample *sample, bool list_first)
{
	static uint8_t packed[sizeof(struct tar)];
	static struct tar tar;
	tar = (struct tar) { 0 };
	if (list_first)
		add_list(&tar, sample);
	else
		tar_add(&tar, "././@PaxHeader", 'x', "20 mtime=17.5\n", 14);
	tar_add(&tar, "tmp1/matrix.dat", '0', matrix, sample->matrix_bytes);
	tar_add(&tar, "tmp1/mask_0.dat", '0', "mask", 4);
	if (!list_first)
		add_list(&tar, sample);
	tar.size += 2 * GZ_TAR_BLOCK;
	if (!list_first)
		return files_write(name, tar.bytes, tar.size);
	return files_write(name, packed,
			   files_deflate(tar.bytes, tar.size, 31, packed, sizeof packed));
}

static double value_at(const struct gz_volume *v, size_t index)
{
	return v->slope * gz_voxel_stored(v->type, v->voxels, index) + v->intercept;
}

static struct gz_volume load_inv3(const struct inv3_sample *sample, const char *name,
				  bool list_first)
{
	struct captured_log log;
	struct gz_volume v = { 0 };
	captured_log_init(&log, "*:warn");
	const char *path = write_inv3(name, sample, list_first);
	if (gz_volume_load(path, NULL, NULL, &log.log, &v) != GZ_OK || log.messages > 0)
		fail_msg("%s: %s", path, log.last);
	return v;
}

static void members_may_stand_in_any_order_and_be_packed(void **state)
{
	(void)state;
	const struct inv3_sample sample = inv3_sample_make();
	for (int i = 0; i < 4; i++) {
		struct gz_volume v =
			load_inv3(&sample, i / 2 ? "project.inv3" : "unnamed", i % 2 == 0);
		assert_true(v.oriented && v.modality == GZ_MODALITY_CT && !v.spacing_assumed);
		assert_true(v.dims[0] == 3 && v.dims[1] == 2 && v.dims[2] == 2);
		assert_true(v.spacing[0] == 0.5 && v.spacing[1] == 0.75 && v.spacing[2] == 2);
		/* x runs to the left. */
		for (size_t k = 0; k < COUNT; k++)
			assert_true(value_at(&v, k) == matrix[k - k % 3 + 2 - k % 3]);
		gz_volume_free(&v);
	}
}

static void sagittal_series_and_those_of_nifti_are_turned(void **state)
{
	(void)state;
	struct inv3_sample samples[] = { inv3_sample_make(), inv3_sample_make() };
	samples[0].orientation = 3;
	samples[1].orientation = 2;
	samples[1].more = "<key>affine</key><array><array><real>1.0</real></array></array>\n";
	for (int i = 0; i < 2; i++) {
		struct gz_volume v = load_inv3(&samples[i], "turned.inv3", true);
		/* y runs to the back. */
		assert_true(value_at(&v, 0) == -40 && value_at(&v, 3) == -50);
		assert_true(value_at(&v, 8) == 62 && value_at(&v, 11) == 52);
		gz_volume_free(&v);
	}
	samples[1].more = "<key>affine</key><string></string>\n";
	struct gz_volume v = load_inv3(&samples[1], "not.inv3", true);
	assert_true(value_at(&v, 0) == -48);
	gz_volume_free(&v);
}

static void types_and_modalities_are_those_of_the_list(void **state)
{
	(void)state;
	struct inv3_sample sample = inv3_sample_make();
	sample.type = "uint8";
	sample.modality = "MR";
	sample.matrix_bytes = COUNT;
	struct gz_volume v = load_inv3(&sample, "bytes.inv3", true);
	assert_true(v.type == GZ_VOXEL_U8 && v.modality == GZ_MODALITY_MR);
	gz_volume_free(&v);
	static const struct {
		const char *term;
		enum gz_modality modality;
	} rows[] = { { "CT", GZ_MODALITY_CT },           { "MR", GZ_MODALITY_MR },
		     { "", GZ_MODALITY_UNKNOWN },        { "OT", GZ_MODALITY_UNKNOWN },
		     { "UNKNOWN", GZ_MODALITY_UNKNOWN }, { "PT", GZ_MODALITY_OTHER } };
	for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++)
		assert_int_equal(gz_modality_of_term(rows[i].term), rows[i].modality);
}

static void check_refused_file(const char *path, enum gz_result expected, const char *words)
{
	struct captured_log log;
	struct gz_volume v = { 0 };
	captured_log_init(&log, "*:error");
	const enum gz_result result = gz_volume_load(path, NULL, NULL, &log.log, &v);
	if (result != expected || log.messages != 1 || !strstr(log.last, words))
		fail_msg("result %d, \"%s\" lacks \"%s\"", result, log.last, words);
}

static void projects_that_are_wrong_are_refused_with_a_line(void **state)
{
	(void)state;
	const struct inv3_sample good = inv3_sample_make();
	static const struct {
		const char *type, *shape;
		size_t matrix_bytes;
		enum gz_result result;
		const char *words;
	} rows[] = {
		{ "complex64", NULL, 24, GZ_ERR_UNSUPPORTED, "type \"complex64\" are not read" },
		{ NULL, "<integer>2</integer>", 24, GZ_ERR_FORMAT, "lacks the file, the shape" },
		{ NULL, "<integer>-2</integer><integer>2</integer><integer>3</integer>", 24,
		  GZ_ERR_FORMAT, "matrix has 24" },
		{ NULL, "<real>1e99</real><real>2</real><string>3</string><integer>1</integer>", 24,
		  GZ_ERR_FORMAT, "matrix has 24" },
		{ NULL, NULL, 22, GZ_ERR_FORMAT, "3 x 2 x 2 voxels are 24 bytes" },
		{ NULL, "<integer>2</wrong>", 24, GZ_ERR_FORMAT, "main.plist is damaged: line 9" },
		{ NULL, "&lol;<integer>3</integer>", 24, GZ_ERR_FORMAT, "lacks the file" },
	};
	for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
		struct inv3_sample sample = good;
		sample.type = rows[i].type ? rows[i].type : good.type;
		sample.shape = rows[i].shape ? rows[i].shape : good.shape;
		sample.matrix_bytes = rows[i].matrix_bytes;
		check_refused_file(write_inv3("wrong.inv3", &sample, i % 2 == 0), rows[i].result,
				   rows[i].words);
	}
	struct tar tar = { 0 };
	add_list(&tar, &good);
	tar.size += GZ_TAR_BLOCK;
	check_refused_file(files_write("alone.inv3", tar.bytes, tar.size), GZ_ERR_FORMAT,
			   "has no matrix.dat; is it really a project");
	tar = (struct tar) { 0 };
	tar_add(&tar, "tmp1/matrix.dat", '0', matrix, sizeof matrix);
	check_refused_file(files_write("listless.inv3", tar.bytes, tar.size), GZ_ERR_FORMAT,
			   "has no main.plist");
	check_refused_file(files_write("short.inv3", tar.bytes, 700), GZ_ERR_FORMAT, "");
	check_refused_file(files_write("text.inv3", "no tar file at all", 18), GZ_ERR_FORMAT,
			   "damaged, or not a tar file");
}

static void header_with_any_byte_changed_is_read_or_refused(void **state)
{
	(void)state;
	const struct inv3_sample sample = inv3_sample_make();
	static const uint8_t changes[] = { 0x01, 0x80, 0xff };
	struct tar tar = { 0 };
	add_list(&tar, &sample);
	tar_add(&tar, "tmp1/matrix.dat", '0', matrix, sizeof matrix);
	for (size_t at = 100; at < tar.size; at += 3) {
		struct tar bad = tar;
		struct gz_volume v = { 0 };
		bad.bytes[at] ^= changes[at / 3 % sizeof changes];
		const char *path = files_write("any.inv3", bad.bytes, bad.size);
		if (gz_volume_load(path, NULL, NULL, NULL, &v) != GZ_OK)
			continue;
		assert_true(gz_volume_voxel_count(&v) <= 2 * COUNT);
		gz_volume_free(&v);
	}
}

TEST_SUITE(inv3)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(members_may_stand_in_any_order_and_be_packed),
		cmocka_unit_test(sagittal_series_and_those_of_nifti_are_turned),
		cmocka_unit_test(types_and_modalities_are_those_of_the_list),
		cmocka_unit_test(projects_that_are_wrong_are_refused_with_a_line),
		cmocka_unit_test(header_with_any_byte_changed_is_read_or_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
