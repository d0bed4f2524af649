/* Volumes that must be refused: with which result, and a line that says what is wrong. */
#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zstd.h>

#include "base/captured_log.h"
#include "render/data/volume.h"
#include "volume_files.h"

static const uint8_t zeros[4096];

static struct gz_raw_layout layout_of(int x, int y, int z, enum gz_raw_type type)
{
	return (struct gz_raw_layout) { .dims = { x, y, z }, .type = type, .spacing = { 1, 1, 1 } };
}

/* One line, an error, with `words` in it; nothing is given out. */
static void check_refused(const char *path, const struct gz_raw_layout *raw, enum gz_result result,
			  const char *words)
{
	struct captured_log log;
	struct gz_volume volume = { .slope = 42 };
	captured_log_init(&log, "*:error");
	enum gz_result got = gz_volume_load(path, raw, NULL, &log.log, &volume);
	if (got != result || log.messages != 1 || !strstr(log.last, words) ||
	    strchr(log.last, '\n'))
		fail_msg("%s: result %d instead of %d, %d lines, \"%s\" lacks \"%s\"", path, got,
			 result, log.messages, log.last, words);
	assert_true(volume.slope == 42);
	assert_null(volume.voxels);
}

static void file_that_is_none_is_refused(void **state)
{
	(void)state;
	struct gz_raw_layout raw = layout_of(2, 2, 2, GZ_RAW_UINT8);
	check_refused(files_path("none.raw"), &raw, GZ_ERR_NOT_FOUND, "No such file");
	check_refused(files_path("none.nii.gz"), NULL, GZ_ERR_NOT_FOUND, "No such file");
	check_refused(files_path("none.nrrd"), NULL, GZ_ERR_NOT_FOUND, "No such file");
	check_refused(files_path("none.mhd"), NULL, GZ_ERR_NOT_FOUND, "No such file");
	mkdir(files_path("folder.raw"), 0700);
	check_refused(files_path("folder.raw"), &raw, GZ_ERR_FORMAT, "not a regular file");
	rmdir(files_path("folder.raw"));
	assert_int_equal(mkfifo(files_path("pipe.raw"), 0600), 0);
	check_refused(files_path("pipe.raw"), &raw, GZ_ERR_FORMAT, "not a regular file");
	if (geteuid() != 0) { /* root may read everything */
		const char *path = files_write("secret.raw", zeros, 8);
		chmod(path, 0);
		check_refused(path, &raw, GZ_ERR_IO, "Permission denied");
	}
}

static void kind_must_be_known_and_fit_the_layout(void **state)
{
	(void)state;
	struct gz_raw_layout raw = layout_of(2, 2, 2, GZ_RAW_UINT8);
	check_refused("a.txt", &raw, GZ_ERR_UNSUPPORTED, "unknown format");
	check_refused("raw", &raw, GZ_ERR_UNSUPPORTED, "unknown format");
	check_refused("a.nii.gz", &raw, GZ_ERR_INVAL, "has a header");
	check_refused("a.raw", NULL, GZ_ERR_INVAL, "raw data without a header");
	raw.type = GZ_RAW_TYPE_COUNT;
	check_refused(files_write("t.raw", zeros, 8), &raw, GZ_ERR_INVAL, "unknown type");
}

static void raw_of_impossible_layout_is_refused(void **state)
{
	(void)state;
	static const double spacings[] = { -1, -INFINITY, NAN };
	const char *path = files_write("b.raw", zeros, sizeof zeros);
	struct gz_raw_layout raw = layout_of(0, 2, 2, GZ_RAW_UINT8);
	check_refused(path, &raw, GZ_ERR_FORMAT, "0 voxels along axis 1; allowed: 1 to 16384");
	raw = layout_of(2, 16385, 2, GZ_RAW_UINT8);
	check_refused(path, &raw, GZ_ERR_FORMAT, "16385 voxels along axis 2");
	raw = layout_of(2, 2, -2147483647 - 1, GZ_RAW_UINT8);
	check_refused(path, &raw, GZ_ERR_FORMAT, "-2147483648 voxels along axis 3");
	for (size_t i = 0; i < 3; i++) {
		raw = layout_of(2, 2, 2, GZ_RAW_UINT8);
		raw.spacing[2] = spacings[i];
		check_refused(path, &raw, GZ_ERR_FORMAT, "along axis 3; it must be above 0");
	}
	raw = layout_of(2, 2, 2, GZ_RAW_UINT8);
	raw.spacing[0] = raw.spacing[1] = raw.spacing[2] = 1e308;
	check_refused(path, &raw, GZ_ERR_FORMAT, "along axis 1; it must be above 0, and the edge");
}

/* A ray along the long side would take more steps than can be counted. */
static void raw_of_spacing_too_uneven_is_refused(void **state)
{
	(void)state;
	const char *path = files_write("u.raw", zeros, sizeof zeros);
	struct gz_raw_layout raw = layout_of(2, 2, 2, GZ_RAW_UINT8);
	raw.spacing[0] = 1e-5;
	check_refused(path, &raw, GZ_ERR_FORMAT, "makes the longest edge 200000 times");
	raw.spacing[0] = 2.0 / 65537;
	check_refused(path, &raw, GZ_ERR_FORMAT, "allowed: 65536; correct the spacing");
	raw.spacing[0] = 2.0 / GZ_VOLUME_EDGE_LENGTHS_MAX;
	struct captured_log log;
	struct gz_volume volume;
	captured_log_init(&log, "*:error");
	assert_int_equal(gz_volume_load(path, &raw, NULL, &log.log, &volume), GZ_OK);
	gz_volume_free(&volume);
}

static void raw_shorter_than_its_layout_is_refused_before_memory_is_taken(void **state)
{
	(void)state;
	struct gz_raw_layout raw = layout_of(16, 16, 17, GZ_RAW_UINT8);
	const char *path = files_write("s.raw", zeros, sizeof zeros);
	check_refused(path, &raw, GZ_ERR_FORMAT,
		      "truncated: 16 x 16 x 17 voxels of uint8 are 4352 bytes, the file can hold "
		      "4096");
	raw = layout_of(16384, 16384, 16384, GZ_RAW_FLOAT64);
	check_refused(path, &raw, GZ_ERR_FORMAT, "are 35184372088832 bytes");
	check_refused(files_write("e.raw", NULL, 0), &raw, GZ_ERR_FORMAT, "truncated");
}

/* A few hundred bytes of gzip that claim terabytes. */
static void compressed_claim_beyond_the_best_ratio_is_refused(void **state)
{
	(void)state;
	uint8_t packed[8192];
	struct gz_raw_layout raw = layout_of(16384, 16384, 16384, GZ_RAW_UINT8);
	size_t size = files_deflate(zeros, sizeof zeros, 31, packed, sizeof packed);
	check_refused(files_write("c.raw.gz", packed, size), &raw, GZ_ERR_FORMAT, "truncated");
	size = ZSTD_compress(packed, sizeof packed, zeros, sizeof zeros, 3);
	check_refused(files_write("c.raw.zst", packed, size), &raw, GZ_ERR_FORMAT, "truncated");
}

/* The layout takes a part of the data only, and what lies behind does not match the checksum. */
static void damage_behind_the_last_voxel_is_refused(void **state)
{
	(void)state;
	uint8_t packed[8192];
	struct gz_raw_layout raw = layout_of(16, 16, 15, GZ_RAW_UINT8);
	size_t size = files_deflate(zeros, sizeof zeros, 31, packed, sizeof packed);
	packed[size - 5] ^= 1; /* gzip ends in the sum and the length, 4 bytes each */
	check_refused(files_write("d.raw.gz", packed, size), &raw, GZ_ERR_FORMAT, "damaged");
}

static void compressed_data_cut_anywhere_are_refused(void **state)
{
	(void)state;
	uint8_t bytes[512], packed[2048];
	struct gz_raw_layout raw = layout_of(8, 8, 8, GZ_RAW_UINT8);
	for (size_t i = 0; i < sizeof bytes; i++)
		bytes[i] = (uint8_t)(i * i >> 4);
	for (int zstd = 0; zstd < 2; zstd++) {
		const char *name = zstd ? "cut.raw.zst" : "cut.raw.gz";
		size_t size = zstd ? ZSTD_compress(packed, sizeof packed, bytes, sizeof bytes, 3)
				   : files_deflate(bytes, sizeof bytes, 31, packed, sizeof packed);
		for (size_t cut = 0; cut < size; cut++) {
			struct gz_volume v = { 0 };
			struct captured_log log;
			captured_log_init(&log, "*:error");
			files_write(name, packed, cut);
			enum gz_result got =
				gz_volume_load(files_path(name), &raw, NULL, &log.log, &v);
			if (got != GZ_ERR_FORMAT || log.messages != 1)
				fail_msg("%s cut at %zu of %zu: result %d, \"%s\"", name, cut, size,
					 got, log.last);
		}
	}
}

static void damaged_compressed_data_are_refused(void **state)
{
	(void)state;
	uint8_t packed[8192];
	struct gz_raw_layout raw = layout_of(16, 16, 16, GZ_RAW_UINT8);
	size_t size = files_deflate(zeros, sizeof zeros, 31, packed, sizeof packed);
	packed[size - 5] ^= 1; /* of the checksum */
	check_refused(files_write("d.raw.gz", packed, size), &raw, GZ_ERR_FORMAT,
		      "damaged compressed data");
	check_refused(files_write("d.raw.zst", zeros, 64), &raw, GZ_ERR_FORMAT,
		      "damaged compressed data");
	check_refused(files_write("e.raw.gz", "hello, world", 12), &raw, GZ_ERR_FORMAT,
		      "damaged compressed data");
}

static void values_without_a_finite_one_are_refused(void **state)
{
	(void)state;
	static const uint32_t nan = 0x7fc00000;
	struct gz_raw_layout raw = layout_of(1, 1, 1, GZ_RAW_FLOAT32);
	check_refused(files_write("n.raw", &nan, 4), &raw, GZ_ERR_FORMAT, "no finite value");
}

static void check_nifti(const struct nifti_sample *sample, enum gz_result result, const char *words)
{
	uint8_t bytes[352 + 64] = { 0 };
	nifti_sample_bytes(sample, bytes);
	check_refused(files_write("a.nii", bytes, sizeof bytes), NULL, result, words);
}

static void nifti_header_that_is_wrong_is_refused(void **state)
{
	(void)state;
	const struct nifti_sample good = nifti_sample_make(4, 4, 4);
	struct nifti_sample s = good;
	s.dim[0] = 0;
	check_nifti(&s, GZ_ERR_FORMAT, "0 dimensions");
	s.dim[0] = 2;
	check_nifti(&s, GZ_ERR_FORMAT, "2 dimensions");
	s.dim[0] = 8;
	check_nifti(&s, GZ_ERR_FORMAT, "8 dimensions");
	s = good;
	s.dim[2] = -4;
	check_nifti(&s, GZ_ERR_FORMAT, "-4 voxels along axis 2");
	s = good;
	s.dim[3] = 32767;
	check_nifti(&s, GZ_ERR_FORMAT, "32767 voxels along axis 3");
	s = good;
	s.dim[0] = 4;
	s.dim[4] = 0;
	check_nifti(&s, GZ_ERR_FORMAT, "0 voxels along axis 4");
	s = good;
	s.dim[3] = 5;
	check_nifti(&s, GZ_ERR_FORMAT, "truncated");
	s = good;
	s.datatype = 32; /* complex */
	check_nifti(&s, GZ_ERR_UNSUPPORTED, "voxels of type COMPLEX64 are not read");
	s.datatype = 1024; /* 64-bit integers */
	check_nifti(&s, GZ_ERR_UNSUPPORTED, "INT64");
	s.datatype = 12345;
	check_nifti(&s, GZ_ERR_UNSUPPORTED, "not read");
	s = good;
	s.magic = "ni1";
	check_nifti(&s, GZ_ERR_FORMAT, "the header of a pair; name it .hdr");
	s.magic = "xyz"; /* which an ANALYZE header may have there */
	check_nifti(&s, GZ_ERR_FORMAT, "the header of a pair; name it .hdr");
	s.bitpix = 16;
	check_nifti(&s, GZ_ERR_FORMAT, "no NIfTI magic word");
}

static void nifti_numbers_that_make_no_sense_are_refused(void **state)
{
	(void)state;
	const struct nifti_sample good = nifti_sample_make(4, 4, 4);
	struct nifti_sample s = good;
	s.pixdim[2] = 0;
	check_nifti(&s, GZ_ERR_FORMAT, "spacing 0 along axis 2");
	s.pixdim[2] = NAN;
	check_nifti(&s, GZ_ERR_FORMAT, "along axis 2; it must be above 0");
	s = good;
	s.sform_code = 1; /* and a matrix of zeros */
	check_nifti(&s, GZ_ERR_FORMAT, "spacing 0 along axis 1");
	for (int i = 0; i < 3; i++)
		s.srow[i][0] = s.srow[i][1] = s.srow[i][2] = 1;
	check_nifti(&s, GZ_ERR_FORMAT, "do not span space");
	static const float offsets[] = { 0, 351.5f, -352, 3e9f, 1e30f };
	for (size_t i = 0; i < 5; i++) {
		s = good;
		s.vox_offset = offsets[i];
		check_nifti(&s, GZ_ERR_FORMAT, "voxels at byte");
	}
	s = good;
	s.vox_offset = NAN;
	check_nifti(&s, GZ_ERR_FORMAT, "voxels at byte");
	s = good;
	s.vox_offset = 100000;
	check_nifti(&s, GZ_ERR_FORMAT, "truncated");
}

static void nifti_of_another_kind_is_refused(void **state)
{
	(void)state;
	static const uint8_t second[4] = { 0x1c, 0x02, 0, 0 }; /* sizeof_hdr of NIfTI-2: 540 */
	check_refused(files_write("2.nii", second, 4), NULL, GZ_ERR_FORMAT, "truncated");
	uint8_t bytes[600] = { 0x1c, 0x02 };
	check_refused(files_write("2.nii", bytes, 500), NULL, GZ_ERR_FORMAT, "truncated");
	check_refused(files_write("2.nii", bytes, sizeof bytes), NULL, GZ_ERR_FORMAT,
		      "no NIfTI header");
	check_refused(files_write("0.nii", zeros, 600), NULL, GZ_ERR_FORMAT, "no NIfTI header");
	check_refused(files_write("0.nii.gz", zeros, 600), NULL, GZ_ERR_FORMAT, "no NIfTI header");
	check_refused(files_write("0.nii.gz", "\x1f\x8b", 2), NULL, GZ_ERR_FORMAT,
		      "damaged compressed data");
}

struct refusal {
	const char *text;
	enum gz_result result;
	const char *words;
};

static void check_texts(const char *name, const struct refusal *refusals, size_t count)
{
	for (size_t i = 0; i < count; i++)
		check_refused(files_write_text(name, refusals[i].text, zeros, 8), NULL,
			      refusals[i].result, refusals[i].words);
}

#define NRRD "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\n"

static void nrrd_headers_that_are_wrong_are_refused_by_line(void **state)
{
	(void)state;
	static const struct refusal refusals[] = {
		{ "NRRX0004\n\n", GZ_ERR_FORMAT, ":1: NRRD: no magic word" },
		{ "NRRD0009\n\n", GZ_ERR_UNSUPPORTED, ":1: NRRD: versions 1 to 5" },
		{ "NRRD0004\n\n", GZ_ERR_FORMAT, "must be given" },
		{ "NRRD0004\ntype: long long\n\n", GZ_ERR_UNSUPPORTED, ":2: type: not read" },
		{ "NRRD0004\nsizes: 2 2 2\n\n", GZ_ERR_FORMAT, ":2: sizes: comes before" },
		{ "NRRD0004\ndimension: 17\n\n", GZ_ERR_FORMAT, ":2: dimension: must be" },
		{ "NRRD0004\ndimension: x\n\n", GZ_ERR_FORMAT, ":2: dimension: must be" },
		{ "NRRD0004\ndimension: 2\n\n", GZ_ERR_UNSUPPORTED, "not a volume" },
		{ "NRRD0004\ndimension: 3\nsizes: 2 2\n\n", GZ_ERR_FORMAT, ":3: sizes: write" },
		{ "NRRD0004\ndimension: 3\nsizes: 2 2 2 2\n\n", GZ_ERR_FORMAT, ":3: sizes" },
		{ "NRRD0004\ndimension: 3\nsizes: 2 2 99999999999999\n\n", GZ_ERR_FORMAT,
		  ":3: sizes" },
		{ NRRD "encoding: zrl\n\n", GZ_ERR_UNSUPPORTED, ":5: encoding: not read" },
		{ NRRD "encoding: bzip2\n\n", GZ_ERR_FORMAT, "damaged compressed data" },
		{ NRRD "encoding: ascii\n\n1 2 3 4 5 6 7 8x", GZ_ERR_FORMAT, "number 8, \"8x" },
		{ NRRD "encoding: ascii\n\n1 2 3 4 5 6 7 256", GZ_ERR_FORMAT,
		  ", does not fit uint8" },
		{ NRRD "encoding: ascii\n\n1 2 3 4 5 6 7 -1", GZ_ERR_FORMAT,
		  ", does not fit uint8" },
		{ NRRD "encoding: ascii\n\n1 2 3 4 5 6 7 1.5", GZ_ERR_FORMAT,
		  ", does not fit uint8" },
		{ NRRD "encoding: ascii\n\n1 2 3 4 5 6 7 nan", GZ_ERR_FORMAT,
		  ", does not fit uint8" },
		{ NRRD "encoding: ascii\n\n1 2 3 4 5 6 7", GZ_ERR_FORMAT, "number 7, \"7" },
		{ NRRD "encoding: hex\n\n01020304050607 0g", GZ_ERR_FORMAT, "byte 8: not two hex" },
		{ NRRD "encoding: hex\nbyte skip: -1\n\n", GZ_ERR_FORMAT, "from the end" },
		{ NRRD "no field\n\n", GZ_ERR_FORMAT, ":5: no field: neither a field" },
		{ NRRD "spacings: 1 1\n\n", GZ_ERR_FORMAT, ":5: spacings: write one number" },
		{ NRRD "spacings: 1 1 1 1\n\n", GZ_ERR_FORMAT, ":5: spacings: more" },
		{ NRRD "spacings: 1 0 1\nencoding: raw\n\n", GZ_ERR_FORMAT, "spacing 0" },
		{ NRRD "spacings: 1 nan 1\nencoding: raw\n\n", GZ_ERR_FORMAT, "spacing nan" },
		{ NRRD "space: scanner\n\n", GZ_ERR_UNSUPPORTED, ":5: space: not read" },
		{ NRRD "space: RAST\n\n", GZ_ERR_UNSUPPORTED, ":5: space: not read" },
		{ NRRD "space dimension: 4\n\n", GZ_ERR_UNSUPPORTED, "only 3 is read" },
		{ NRRD "space directions: (1,0,0) (0,1,0)\n\n", GZ_ERR_FORMAT, ":5: space dir" },
		{ NRRD "space directions: (1,0,0) (0,1,0) (0,0)\n\n", GZ_ERR_FORMAT, ":5: space" },
		{ NRRD "space directions: (1,0,0) (0,1,0) (0,0,x)\n\n", GZ_ERR_FORMAT, ":5: sp" },
		{ NRRD "space directions: (1,0,0) (0,1,0) (0,0,1\n\n", GZ_ERR_FORMAT, ":5: space" },
		{ NRRD "space directions: (1,0,0) (1,0,0) (0,0,1)\nencoding: raw\n\n",
		  GZ_ERR_FORMAT, "do not span space" },
		{ NRRD "space directions: (1,0,0) (0,0,0) (0,0,1)\nencoding: raw\n\n",
		  GZ_ERR_FORMAT, "spacing 0" },
		{ NRRD "space directions: none (0,1,0) (0,0,1)\nencoding: raw\n\n",
		  GZ_ERR_UNSUPPORTED, "several numbers a voxel" },
		{ NRRD "kinds: RGB-color domain domain\nencoding: raw\n\n", GZ_ERR_UNSUPPORTED,
		  "several numbers a voxel" },
		{ NRRD "endian: middle\n\n", GZ_ERR_FORMAT, ":5: endian: write little or big" },
		{ NRRD "type: short\nencoding: raw\n\n", GZ_ERR_FORMAT, "endian must be given" },
		{ NRRD "data file: LIST\n\n", GZ_ERR_FORMAT, ":7: data file: no names follow" },
		{ NRRD "data file: LIST x\n\n", GZ_ERR_FORMAT, "data file: after LIST" },
		{ NRRD "encoding: raw\ndata file: LIST\na\nb\nc\n", GZ_ERR_FORMAT,
		  "3 files of 2 axes do not make up the sizes" },
		{ NRRD "encoding: raw\ndata file: LIST 4\na\nb\n", GZ_ERR_FORMAT,
		  "2 files of 4 axes do not make up the sizes" },
		{ NRRD "encoding: raw\ndata file: LIST\ngone1\ngone2\n", GZ_ERR_NOT_FOUND,
		  "gone1" },
		{ NRRD "encoding: raw\ndata file: a%d.raw 1 9 1\n\n", GZ_ERR_FORMAT,
		  "9 files of 2 axes do not make up the sizes" },
		{ NRRD "encoding: raw\ndata file: gone%03d.raw 7 8 1\n\n", GZ_ERR_NOT_FOUND,
		  "gone007.raw" },
		{ NRRD "data file: a%s.raw 1 2 1\n\n", GZ_ERR_FORMAT, "data file: write LIST" },
		{ NRRD "data file: a%n.raw 1 2 1\n\n", GZ_ERR_FORMAT, "data file: write LIST" },
		{ NRRD "data file: a%d%d.raw 1 2 1\n\n", GZ_ERR_FORMAT, "data file: write LIST" },
		{ NRRD "data file: a%099d.raw 1 2 1\n\n", GZ_ERR_FORMAT, "data file: write LIST" },
		{ NRRD "data file: a%d.raw 1 2\n\n", GZ_ERR_FORMAT, "data file: write LIST" },
		{ NRRD "data file: a%d.raw 1 2 0\n\n", GZ_ERR_FORMAT, "data file: write LIST" },
		{ NRRD "data file: a%d.raw 2 1 1\n\n", GZ_ERR_FORMAT, "data file: write LIST" },
		{ NRRD "data file: a%d.raw 1 2000000000 1\n\n", GZ_ERR_FORMAT, "write LIST" },
		{ NRRD "data file: a%d.raw -1 0 1\n\n", GZ_ERR_FORMAT, "data file: write LIST" },
		{ NRRD "data file: \n\n", GZ_ERR_FORMAT, ":5: data file: no name" },
		{ NRRD "encoding: raw\ndata file: gone.raw\n\n", GZ_ERR_NOT_FOUND, "gone.raw" },
		{ NRRD "line skip: -1\n\n", GZ_ERR_FORMAT, ":5: line skip" },
		{ NRRD "byte skip: -2\n\n", GZ_ERR_FORMAT, ":5: byte skip" },
		{ NRRD "byte skip: 1 2\n\n", GZ_ERR_FORMAT, ":5: byte skip" },
		{ NRRD "byte skip: 100\nencoding: raw\n\n", GZ_ERR_FORMAT, "truncated" },
		{ NRRD "line skip: 100\nencoding: raw\n\n", GZ_ERR_FORMAT, "more lines" },
		{ NRRD "byte skip: -1\nencoding: gzip\n\n", GZ_ERR_FORMAT, "from the end" },
		{ NRRD "encoding: gzip\n\n", GZ_ERR_FORMAT, "damaged compressed data" },
		{ NRRD "dimension: 3\nsizes: 2 2 3\nencoding: raw\n\n", GZ_ERR_FORMAT,
		  "truncated" },
		{ NRRD "dimension: 3\nsizes: 2 2 -3\nencoding: raw\n\n", GZ_ERR_FORMAT,
		  "-3 voxels" },
		{ NRRD "dimension: 3\nsizes: 20000 1 1\nencoding: raw\n\n", GZ_ERR_FORMAT,
		  "20000 voxels" },
	};
	check_texts("r.nrrd", refusals, sizeof refusals / sizeof refusals[0]);
}

static void nrrd_header_without_end_is_refused(void **state)
{
	(void)state;
	check_refused(files_write_text("e.nrrd", NRRD "encoding: raw\n", NULL, 0), NULL,
		      GZ_ERR_FORMAT, "no blank line ends it");
	char *endless = malloc(1 << 20);
	memset(endless, '#', 1 << 20);
	check_refused(files_write_text("l.nrrd", NRRD, endless, 1 << 20), NULL, GZ_ERR_FORMAT,
		      "no blank line ends it");
	check_refused(files_write("z.nrrd", NULL, 0), NULL, GZ_ERR_FORMAT, "no magic word");
	free(endless);
}

#define META "NDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\n"

static void metaimage_headers_that_are_wrong_are_refused_by_line(void **state)
{
	(void)state;
	static const struct refusal refusals[] = {
		{ "", GZ_ERR_FORMAT, "must be given" },
		{ "NDims = 3\n", GZ_ERR_FORMAT, "must be given" },
		{ META, GZ_ERR_FORMAT, "must be given" },
		{ "NDims = 11\n", GZ_ERR_FORMAT, ":1: NDims: must be" },
		{ "NDims = 2\n", GZ_ERR_UNSUPPORTED, "not a volume" },
		{ "DimSize = 2 2 2\n", GZ_ERR_FORMAT, ":1: DimSize: comes before" },
		{ "NDims = 3\nDimSize = 2 2\n", GZ_ERR_FORMAT, ":2: DimSize: write" },
		{ "NDims = 3\nDimSize = 2 2 nan\n", GZ_ERR_FORMAT, ":2: DimSize: write" },
		{ "ElementType = MET_STRING\n", GZ_ERR_UNSUPPORTED, ":1: ElementType: not read" },
		{ META "nonsense\n", GZ_ERR_FORMAT, ":4: nonsense: no tag" },
		{ META "ElementSpacing = 1 1\n", GZ_ERR_FORMAT, ":4: ElementSpacing: write" },
		{ META "ElementSpacing = 1 nan 1\n", GZ_ERR_FORMAT, ":4: ElementSpacing: write" },
		{ META "ElementSize = x\n", GZ_ERR_FORMAT, ":4: ElementSize: write" },
		{ META "TransformMatrix = 1 0 0\n", GZ_ERR_FORMAT, ":4: TransformMatrix" },
		{ META "ElementByteOrderMSB = maybe\n", GZ_ERR_FORMAT, ":4: ElementByteOrder" },
		{ META "BinaryData = False\nElementDataFile = LOCAL\n1 2 3 4 5 6 7 x",
		  GZ_ERR_FORMAT, "number 8, \"x" },
		{ META "BinaryData = 7\n", GZ_ERR_FORMAT, ":4: BinaryData" },
		{ META "CompressedData = 7\n", GZ_ERR_FORMAT, ":4: CompressedData" },
		{ META "ElementNumberOfChannels = 5\n", GZ_ERR_UNSUPPORTED, ":4: ElementNumber" },
		{ META "HeaderSize = -2\n", GZ_ERR_FORMAT, ":4: HeaderSize" },
		{ META "ElementDataFile = LIST\n", GZ_ERR_FORMAT, "no names follow the LIST" },
		{ META "ElementDataFile = LIST 2D\na\n", GZ_ERR_FORMAT, "1 files of 2 axes" },
		{ META "ElementDataFile = a%03d.raw 1 9 1\n", GZ_ERR_FORMAT, "9 files of 2 axes" },
		{ META "ElementDataFile = a%03x.raw 1 9 1\n", GZ_ERR_FORMAT, "write LIST" },
		{ META "ElementDataFile =\n", GZ_ERR_FORMAT, ":4: ElementDataFile: no name" },
		{ META "ElementDataFile = gone.raw\n", GZ_ERR_NOT_FOUND, "gone.raw" },
		{ META "ElementDataFile = .\n", GZ_ERR_FORMAT, "not a regular file" },
		{ META "AnatomicalOrientation = XYZ\nElementDataFile = LOCAL\n", GZ_ERR_FORMAT,
		  "AnatomicalOrientation: write" },
		{ META "AnatomicalOrientation = RRR\nElementDataFile = LOCAL\n", GZ_ERR_FORMAT,
		  "do not span space" },
		{ META "ElementSpacing = 1 0 1\nElementDataFile = LOCAL\n", GZ_ERR_FORMAT,
		  "spacing 0" },
		{ META "DimSize = 2 2 3\nElementDataFile = LOCAL\n", GZ_ERR_FORMAT, "truncated" },
		{ META "DimSize = 0 2 3\nElementDataFile = LOCAL\n", GZ_ERR_FORMAT, "0 voxels" },
		{ META "HeaderSize = 9\nElementDataFile = LOCAL\n", GZ_ERR_FORMAT, "truncated" },
		{ META "CompressedData = True\nElementDataFile = LOCAL\n", GZ_ERR_FORMAT,
		  "damaged compressed data" },
	};
	check_texts("r.mha", refusals, sizeof refusals / sizeof refusals[0]);
}

TEST_SUITE(volume_refused)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(file_that_is_none_is_refused),
		cmocka_unit_test(kind_must_be_known_and_fit_the_layout),
		cmocka_unit_test(raw_of_impossible_layout_is_refused),
		cmocka_unit_test(raw_of_spacing_too_uneven_is_refused),
		cmocka_unit_test(raw_shorter_than_its_layout_is_refused_before_memory_is_taken),
		cmocka_unit_test(compressed_claim_beyond_the_best_ratio_is_refused),
		cmocka_unit_test(damage_behind_the_last_voxel_is_refused),
		cmocka_unit_test(compressed_data_cut_anywhere_are_refused),
		cmocka_unit_test(damaged_compressed_data_are_refused),
		cmocka_unit_test(values_without_a_finite_one_are_refused),
		cmocka_unit_test(nifti_header_that_is_wrong_is_refused),
		cmocka_unit_test(nifti_numbers_that_make_no_sense_are_refused),
		cmocka_unit_test(nifti_of_another_kind_is_refused),
		cmocka_unit_test(nrrd_headers_that_are_wrong_are_refused_by_line),
		cmocka_unit_test(nrrd_header_without_end_is_refused),
		cmocka_unit_test(metaimage_headers_that_are_wrong_are_refused_by_line),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
