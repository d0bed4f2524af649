#include "render/raycast/shared/slicing.h"

#define AT(field) offsetof(struct gz_slicing, field)

const struct gz_option gz_slicing_options[] = {
	{ "slices.count", GZ_OPTION_INT, AT(count), 1, GZ_SLICES_MAX, .preset = "512",
	  .help = "slices from the nearest to the farthest corner of the volume's box" },
};
const size_t gz_slicing_option_count = sizeof gz_slicing_options / sizeof gz_slicing_options[0];
