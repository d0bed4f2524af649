/* The row filters for one instruction set; compiled with its flags. */
#include "render/cpu/reconstruct_rows.h"

const struct gz_row_filters gz_row_filters_avx512 = GZ_ROW_FILTERS("avx512");
