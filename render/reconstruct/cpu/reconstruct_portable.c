/* The row filters for one instruction set; compiled with its flags. The vocabulary comes before the
 * filters that speak it. */
#include "render/reconstruct/cpu/points_portable.h"

#include "render/reconstruct/cpu/reconstruct_rows.h"
#include "render/reconstruct/cpu/reconstruct_spans.h"

const struct gz_row_filters gz_row_filters_portable = GZ_ROW_FILTERS("portable");
