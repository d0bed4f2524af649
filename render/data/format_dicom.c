/* DICOM series: a folder, one file of it, or a file with several frames. A process of its own reads
 * them (render/decode/dicom/). */
#include <ctype.h>
#include <stdint.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "render/data/decoded_volume.h"
#include "render/data/dicom_name.h"
#include "render/data/format.h"

/* The first elements of a file without a preamble are that short, bytes (chosen: UIDs have 64). */
#define ELEMENT_MAX 128

#define ELEMENTS_NEEDED 3

static unsigned number_u16(const uint8_t *bytes)
{
	return bytes[0] | (unsigned)bytes[1] << 8;
}

/* Bytes of the element at the beginning of `bytes`, explicit or implicit (PS3.5, 7.1); 0 if it is
 * not one that a file begins with. */
static size_t element_length(const uint8_t *bytes, size_t size)
{
	if (size < 8)
		return 0;
	const bool explicit_vr = isupper(bytes[4]) && isupper(bytes[5]);
	if (explicit_vr && memcmp(bytes + 4, "OB", 2) == 0) /* the version in the meta header */
		return size >= 12 && number_u16(bytes + 10) == 0 &&
				       number_u16(bytes + 8) <= ELEMENT_MAX
			       ? 12 + (size_t)number_u16(bytes + 8)
			       : 0;
	const size_t value = number_u16(bytes + (explicit_vr ? 6 : 4));
	if (!explicit_vr && number_u16(bytes + 6) != 0)
		return 0;
	return value <= ELEMENT_MAX ? 8 + value : 0;
}

static bool begins_with_elements(const uint8_t *bytes, size_t size)
{
	unsigned before = 0;
	size_t at = 0;
	for (int i = 0; i < ELEMENTS_NEEDED; i++) {
		const size_t length = element_length(bytes + at, size - at);
		if (length == 0 || length > size - at)
			return false;
		const unsigned group = number_u16(bytes + at), element = number_u16(bytes + at + 2);
		const unsigned tag = group << 16 | element;
		if ((group != 2 && group != 8) || (i > 0 && tag <= before))
			return false;
		before = tag;
		at += length;
	}
	return true;
}

static bool is_directory_name(const char *path)
{
	const char *slash = strrchr(path, '/');
	return strcasecmp(slash ? slash + 1 : path, "DICOMDIR") == 0;
}

/* The preamble may be the head of another format, of TIFF for one (PS3.10, 7.1). */
static bool dicom_knows_start(const struct gz_file_start *start)
{
	return start->coding == GZ_CODING_PLAIN && gz_file_start_has(start, 128, "DICM", 4);
}

bool gz_dicom_is(const char *path)
{
	struct gz_file_start start;
	struct stat status;
	if (stat(path, &status) == 0 && S_ISDIR(status.st_mode))
		return true;
	return gz_file_start_read(path, &start) &&
	       (is_directory_name(path) || dicom_knows_start(&start) ||
		(start.coding == GZ_CODING_PLAIN && begins_with_elements(start.bytes, start.size)));
}

static enum gz_result load_dicom(const struct gz_volume_file *file, struct gz_volume *out_volume)
{
	const char *series = file->loading ? file->loading->series_uid : NULL;
	const bool chosen = series && series[0];
	const bool listed = !chosen && file->loading && file->loading->series_list;
	return gz_volume_decode(file, listed ? "dicom-choose" : "dicom", series, out_volume);
}

const struct gz_volume_format gz_format_dicom = {
	.name = "DICOM",
	.endings = { ".dcm" },
	.layout = GZ_LAYOUT_IN_FILE,
	.knows_start = dicom_knows_start,
	.recognise = gz_dicom_is,
	.load = load_dicom,
	.limits = "integers of 8, 16 and 32 bits, colours of 8 bits, parallel slices, evenly "
		  "spaced unless --resample is given; also dose (RTDOSE) and segmentations (SEG)",
};
