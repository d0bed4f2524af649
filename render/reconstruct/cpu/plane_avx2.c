/* The filters of planes for one instruction set: plane_loops.h. */
#include "render/reconstruct/cpu/plane_loops.h"

const struct gz_plane_filters gz_plane_filters_avx2 = { "avx2", &value_filters, &id_filters };
