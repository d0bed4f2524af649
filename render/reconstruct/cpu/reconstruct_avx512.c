/* The row filters for one instruction set; compiled with its flags. The vocabulary comes before the
 * filters that speak it. */
#include "render/reconstruct/cpu/points_avx512.h"

#include "render/reconstruct/cpu/reconstruct_rows.h"
#include "render/reconstruct/cpu/reconstruct_spans.h"

const struct gz_row_filters gz_row_filters_avx512 = GZ_ROW_FILTERS("avx512");
