/* MINC 2, which is HDF5. A process of its own reads it (render/decode/minc/). */
#include "render/data/decoded_volume.h"
#include "render/data/format.h"

/* HDF5 File Format Specification 3.0, II.A: the signature. One behind a user block is not looked
 * for, because MINC has none. */
static bool minc_knows_start(const struct gz_file_start *start)
{
	return start->coding == GZ_CODING_PLAIN &&
	       gz_file_start_has(start, 0, "\211HDF\r\n\032\n", 8);
}

static enum gz_result load_minc_by_decoder(const struct gz_volume_file *file,
					   struct gz_volume *out_volume)
{
	return gz_volume_decode(file, "minc", NULL, out_volume);
}

const struct gz_volume_format gz_format_minc = {
	.name = "MINC 2",
	.endings = { ".mnc" },
	.layout = GZ_LAYOUT_IN_FILE,
	.knows_start = minc_knows_start,
	.load = load_minc_by_decoder,
	.limits = "one number a voxel, integers of up to 32 bits, regular samples",
};
