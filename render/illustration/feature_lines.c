#include "render/illustration/feature_lines.h"

#include "render/illustration/plane_kernels.h"

bool gz_feature_lines(const struct gz_line_window *window, int rows, enum gz_line_filter filter,
		      float threshold, float *out_lines)
{
	return gz_plane_kernels_find()->find_lines(window, rows, filter, threshold, out_lines);
}
